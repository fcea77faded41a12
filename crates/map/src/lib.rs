//! Planes of 3D scans with the uncertainty of their orientation, from posed scans with point errors
