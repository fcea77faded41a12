//! Readers and writers of scans, trajectories and plane maps: PLY, PCD, XYZ, NPY, depth PNG, TUM, KITTI
