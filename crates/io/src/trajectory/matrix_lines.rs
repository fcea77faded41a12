//! A 4×4 matrix in one line, row by row.

use terrace_types::Pose;

use super::rows::Rows;
use super::{StampedPose, TrajectoryError, TrajectoryFormat};

pub(super) fn read(rows: &mut Rows) -> Result<Vec<StampedPose>, TrajectoryError> {
    let mut poses = Vec::new();
    while let Some(row) = rows.next()? {
        let line = row.line();
        let m: [f64; 16] = row.exactly(TrajectoryFormat::MatrixLines)?;
        let matrix = [0, 4, 8, 12].map(|i| [m[i], m[i + 1], m[i + 2], m[i + 3]]);
        let pose = Pose::from_matrix(matrix).map_err(|error| TrajectoryError::Pose { line, error })?;
        poses.push(pose.into());
    }
    Ok(poses)
}
