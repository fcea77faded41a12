//! KITTI odometry: the upper three rows of a 4×4 matrix in one line.

use terrace_types::Pose;

use super::rows::Rows;
use super::{StampedPose, TrajectoryError, TrajectoryFormat};

pub(super) fn read(rows: &mut Rows) -> Result<Vec<StampedPose>, TrajectoryError> {
    let mut poses = Vec::new();
    while let Some(row) = rows.next()? {
        let line = row.line();
        let [a, b, c, x, d, e, f, y, g, h, i, z] = row.exactly(TrajectoryFormat::Kitti)?;
        let pose = Pose::new([[a, b, c], [d, e, f], [g, h, i]], [x, y, z])
            .map_err(|error| TrajectoryError::Pose { line, error })?;
        poses.push(pose.into());
    }
    Ok(poses)
}
