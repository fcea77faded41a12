//! What a file holds, for people.

use std::path::Path;

use terrace_types::{Pose, Sigma};

use crate::content::Content;
use crate::spacing::{bounds, spacing};
use crate::{ReadError, ReadErrorKind, ReadOptions};

/// What is in a file of points. See [`inspect`].
#[derive(Debug, Clone, PartialEq)]
pub struct Info {
    /// Format and encoding, such as `PCD binary_compressed`.
    pub format: &'static str,
    /// Points or pixels, absent ones included.
    pub points: usize,
    /// Points with finite coordinates, or pixels with a depth.
    pub present: usize,
    /// Least and greatest coordinates of the present points as they stand in the file, in metres; `None` when there is
    /// no present point, and for depth images without intrinsics.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// Median distance to the nearest neighbour in metres, from at most 2000 points; `None` where `bounds` is, and when
    /// all points are at one place.
    pub spacing: Option<f64>,
    /// Least and greatest standard error of present points in metres, when the file has them.
    pub sigma: Option<[f64; 2]>,
    /// The pose of the sensor, when the file has one.
    pub viewpoint: Option<Pose>,
    /// Columns and rows of a depth image.
    pub image_size: Option<[u32; 2]>,
}

impl Info {
    /// Points without finite coordinates, or pixels without a depth.
    pub fn absent(&self) -> usize {
        self.points - self.present
    }
}

/// Looks into a file of points: format, count, bounds, spacing and what else it holds. Coordinates are told as they
/// stand in the file; intrinsics, if given, place the pixels of depth images, and fields for errors are those of
/// `options`, noise models aside.
///
/// # Errors
/// [`ReadError`] naming the file.
pub fn inspect(path: &Path, options: &ReadOptions) -> Result<Info, ReadError> {
    let info = || {
        Ok(match Content::open(path, &options.errors)? {
            Content::Cloud(points) => {
                let cloud = points.cloud()?;
                Info {
                    sigma: sigma_range(&cloud.sigma, &cloud.points),
                    viewpoint: cloud.viewpoint,
                    ..of_points(cloud.format, &cloud.points)
                }
            }
            Content::Depth(image) => {
                let format = "PNG 16-bit depth";
                let placed = match options.intrinsics {
                    Some(camera) => of_points(format, &image.points(&camera, options.depth_scale)?),
                    None => of_points(format, &[]),
                };
                Info {
                    points: image.raw.len(),
                    present: image.raw.iter().filter(|raw| crate::DepthImage::is_measurement(**raw)).count(),
                    image_size: Some([image.width, image.height]),
                    ..placed
                }
            }
        })
    };
    info().map_err(|kind: ReadErrorKind| ReadError { path: path.to_owned(), kind: Box::new(kind) })
}

fn of_points(format: &'static str, points: &[[f64; 3]]) -> Info {
    Info {
        format,
        points: points.len(),
        present: points.iter().filter(|p| is_present(p)).count(),
        bounds: bounds(points),
        spacing: spacing(points),
        sigma: None,
        viewpoint: None,
        image_size: None,
    }
}

fn is_present(point: &[f64; 3]) -> bool {
    point.iter().all(|x| x.is_finite())
}

fn sigma_range(sigma: &Sigma, points: &[[f64; 3]]) -> Option<[f64; 2]> {
    let present = points.iter().enumerate().filter(|(_, p)| is_present(p));
    present.filter_map(|(index, _)| sigma.of(index)).flatten().fold(None, |range, s| {
        let [low, high] = range.unwrap_or([s, s]);
        Some([low.min(s), high.max(s)])
    })
}
