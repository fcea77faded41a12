//! Least-squares planes of uncertain points with the uncertainty of their normals, and a symmetric 3x3 eigen-solver
