//! What the terrace crates hand to each other: scans with point errors, poses, planes, labels
