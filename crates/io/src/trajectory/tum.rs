//! TUM RGB-D: `t tx ty tz qx qy qz qw`.

use terrace_types::Pose;

use super::rows::Rows;
use super::{StampedPose, TrajectoryError, TrajectoryFormat};

pub(super) fn read(rows: &mut Rows) -> Result<Vec<StampedPose>, TrajectoryError> {
    let mut poses = Vec::new();
    while let Some(row) = rows.next()? {
        let line = row.line();
        let [time, tx, ty, tz, qx, qy, qz, qw] = row.exactly(TrajectoryFormat::Tum)?;
        if !time.is_finite() {
            return Err(TrajectoryError::Time { line, time });
        }
        let pose = Pose::from_quaternion([tx, ty, tz], [qx, qy, qz, qw])
            .map_err(|error| TrajectoryError::Pose { line, error })?;
        poses.push(StampedPose { time: Some(time), pose });
    }
    Ok(poses)
}
