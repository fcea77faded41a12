//! 4×4 matrices in four lines of four numbers, each after a header line in the log of `Open3D`.

use terrace_types::Pose;

use super::rows::Rows;
use super::{StampedPose, TrajectoryError, TrajectoryFormat};

/// Reads matrices to the end; for [`TrajectoryFormat::Open3dLog`] each has a header of three whole numbers (frame,
/// frame, number of frames), which say nothing that the order does not.
pub(super) fn read(rows: &mut Rows, format: TrajectoryFormat) -> Result<Vec<StampedPose>, TrajectoryError> {
    let mut poses = Vec::new();
    while let Some(first) = rows.peek()? {
        let line = first.line();
        if format == TrajectoryFormat::Open3dLog {
            first.exactly::<3>(format)?;
            rows.next()?;
        }
        let mut matrix = [[0.0; 4]; 4];
        for place in &mut matrix {
            let Some(row) = rows.next()? else { return Err(TrajectoryError::Incomplete { line }) };
            *place = row.exactly(format)?;
        }
        let pose = Pose::from_matrix(matrix).map_err(|error| TrajectoryError::Pose { line, error })?;
        poses.push(pose.into());
    }
    Ok(poses)
}
