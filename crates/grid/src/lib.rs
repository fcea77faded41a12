//! A sparse, growing voxel grid of additive point statistics with neighbourhoods along dense cells
