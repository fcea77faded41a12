//! From a file to a scan: format, errors and frame.

use std::path::{Path, PathBuf};

use terrace_noise::{ScanNoiseError, SensorNoise};
use terrace_types::{Frame, Pose, Scan, ScanError, Sigma};

use crate::depth::{DEFAULT_DEPTH_SCALE, DepthError, DepthImage};
use crate::detect::{Format, detect};
use crate::npy::NpyError;
use crate::pcd::PcdError;
use crate::ply::PlyError;
use crate::text::TextError;
use crate::{Cloud, FieldChoice, Intrinsics, Source, by_model, npy, pcd, ply, source, text};

/// The axis along which a depth camera measures, in its own frame.
const OPTICAL_AXIS: [f64; 3] = [0.0, 0.0, 1.0];

/// Where the errors of points come from.
#[derive(Debug, Clone, PartialEq)]
pub enum ErrorSource {
    /// From fields of the file; [`Sigma::Unknown`] when it has none and none was asked for by name.
    FromFile(FieldChoice),
    /// From the noise model of the sensor; fields of the file are not looked at.
    ///
    /// * [`Uniform`](SensorNoise::Uniform) gives [`Sigma::Uniform`].
    /// * [`PerAxis`](SensorNoise::PerAxis) is along the axes of the *world*. Where the points are in the world, or the
    ///   frames of sensor and world are parallel, it gives [`Sigma::PerAxis`]; where a pose turns them,
    ///   [`Sigma::Covariance`] in the frame of the sensor.
    /// * The others give [`Sigma::Covariance`]. They need the place of the sensor: with a pose it is the origin of the
    ///   points' frame; in the world it is the translation of the VIEWPOINT of a PCD, and without one there is
    ///   [`ReadErrorKind::NoSensorPosition`]. Depth images are measured along +z of the camera's frame; of clouds the
    ///   optical axis is not known, and their depth is the straight distance from the sensor.
    ///
    /// For these others a point at the place of the sensor itself, to a nanometre, is no measurement (many recorders
    /// write 0 0 0 for none), nor is one so far away that its variance is above 10¹⁰⁰ m². Such points are made absent, as no error
    /// could be given for them; [`read_counted`] tells how many. Points outside the
    /// [`valid_depths`](SensorNoise::valid_depths) of a model stay, with what its formula gives there.
    Model(SensorNoise),
}

/// How files are read. The default asks nothing of the caller but the intrinsics of depth images.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// The camera of depth images; they cannot be read without.
    pub intrinsics: Option<Intrinsics>,
    /// Raw units of depth images per metre.
    pub depth_scale: f64,
    /// Where standard errors come from.
    pub errors: ErrorSource,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            intrinsics: None,
            depth_scale: DEFAULT_DEPTH_SCALE,
            errors: ErrorSource::FromFile(FieldChoice::Automatic),
        }
    }
}

/// Why a file could not be read as a scan.
#[derive(Debug, thiserror::Error)]
#[error("{}: {kind}", path.display())]
pub struct ReadError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub kind: Box<ReadErrorKind>,
}

/// What is wrong with a file of points.
#[derive(Debug, thiserror::Error)]
pub enum ReadErrorKind {
    /// The operating system did not hand over the file.
    #[error("{0}")]
    Io(std::io::Error),
    /// It is a folder or a device.
    #[error("not a file")]
    NotAFile,
    /// The file has no bytes.
    #[error("the file is empty")]
    Empty,
    /// A format that is known but not read.
    #[error("this is {name}, which is not read: {advice}")]
    Foreign {
        /// The format.
        name: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// Neither content nor extension tell a format.
    #[error(
        "unknown kind of file; read are PLY, PCD, NPY, 16-bit depth PNG, and text (.xyz .csv .txt .asc .pts); \
         export the clouds of a ROS bag to PCD first"
    )]
    Unknown,
    /// A damaged PLY file.
    #[error(transparent)]
    Ply(#[from] PlyError),
    /// A damaged PCD file.
    #[error(transparent)]
    Pcd(#[from] PcdError),
    /// A damaged text file.
    #[error(transparent)]
    Text(#[from] TextError),
    /// A damaged NPY file.
    #[error(transparent)]
    Npy(#[from] NpyError),
    /// A damaged PNG, or one that is no depth image.
    #[error(transparent)]
    Depth(#[from] DepthError),
    /// A depth image, and no camera to place its pixels.
    #[error("a depth image needs the camera's intrinsics fx,fy,cx,cy in pixels")]
    NoIntrinsics,
    /// Errors were asked for by the name of a field, and the format has no named fields.
    #[error("errors were asked for from the field '{field}', but a {format} file has no named fields")]
    NoNamedFields {
        /// The field asked for.
        field: String,
        /// The format.
        format: &'static str,
    },
    /// A noise model needs the place of the sensor, and it is not known.
    #[error(
        "the noise model {noise} needs to know where the sensor stood: give a pose for the scan, or a PCD with a VIEWPOINT"
    )]
    NoSensorPosition {
        /// The model.
        noise: SensorNoise,
    },
    /// A noise model does not fit the scan.
    #[error(transparent)]
    Noise(#[from] ScanNoiseError),
    /// Points, errors or position contradict what a scan may hold.
    #[error(transparent)]
    Scan(#[from] ScanError),
}

/// What a file holds, before errors and frame are settled.
pub(crate) enum Content {
    Cloud(Cloud),
    Depth(DepthImage),
}

/// Reads a file of points as a scan. The format is found from the first bytes, then from the extension.
///
/// **Frame.** With a pose from outside the file the points are in the sensor's frame. Without, they are taken to be in
/// the world, and the translation of the VIEWPOINT of a PCD is the place of the sensor, as PCL's normal estimation takes
/// it. A depth image without a pose is in its own frame, at the origin.
///
/// **Errors.** See [`ErrorSource`].
///
/// ```
/// use terrace_io::{ReadOptions, Source, read_scan, write_atomically};
///
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("three.xyz");
/// write_atomically(&path, |out| Ok(out.write_all(b"0 0 0\n1 0 0\n0 1 0\n")?))?;
/// let scan = read_scan(&Source::new(&path), &ReadOptions::default())?;
/// assert_eq!(scan.present(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ReadError`] naming the file.
pub fn read_scan(source: &Source, options: &ReadOptions) -> Result<Scan, ReadError> {
    read_counted(source, options).map(|counted| counted.scan)
}

/// A scan, and what its noise model made of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Counted {
    /// The scan.
    pub scan: Scan,
    /// Points that the file has and the scan has not: the noise model says that they are no measurements, see
    /// [`ErrorSource::Model`]. They keep their place as absent ones.
    pub not_measured: usize,
}

/// As [`read_scan`], with the number of points that were made absent.
///
/// # Errors
/// [`ReadError`] naming the file.
pub fn read_counted(source: &Source, options: &ReadOptions) -> Result<Counted, ReadError> {
    let in_file = |kind| ReadError { path: source.path.clone(), kind: Box::new(kind) };
    load(&source.path).and_then(|bytes| scan(&source.path, &bytes, source.pose, options)).map_err(in_file)
}

fn scan(
    path: &Path,
    bytes: &[u8],
    pose: Option<Pose>,
    options: &ReadOptions,
) -> Result<Counted, ReadErrorKind> {
    let (mut points, sigma, frame, axis) = match parse(path, bytes, &options.errors)? {
        Content::Depth(image) => {
            let camera = options.intrinsics.ok_or(ReadErrorKind::NoIntrinsics)?;
            let points = image.points(&camera, options.depth_scale)?;
            let frame = Frame::Sensor { pose: pose.unwrap_or(Pose::IDENTITY) };
            (points, Sigma::Unknown, frame, Some(OPTICAL_AXIS))
        }
        Content::Cloud(cloud) => {
            let frame = match pose {
                Some(pose) => Frame::Sensor { pose },
                None => Frame::World { sensor: cloud.viewpoint.map(|v| v.translation()) },
            };
            (cloud.points, cloud.sigma, frame, None)
        }
    };
    let (sigma, not_measured) = match options.errors {
        ErrorSource::FromFile(_) => (sigma, 0),
        ErrorSource::Model(noise) => by_model::errors(noise, &mut points, frame, axis)?,
    };
    Ok(Counted { scan: Scan::new(points, sigma, frame)?, not_measured })
}

/// The bytes of a file.
pub(crate) fn load(path: &Path) -> Result<Vec<u8>, ReadErrorKind> {
    // Reading a device or a pipe might never end.
    if !std::fs::metadata(path).map_err(ReadErrorKind::Io)?.is_file() {
        return Err(ReadErrorKind::NotAFile);
    }
    let bytes = std::fs::read(path).map_err(ReadErrorKind::Io)?;
    if bytes.is_empty() { Err(ReadErrorKind::Empty) } else { Ok(bytes) }
}

/// Reads what the bytes hold.
pub(crate) fn parse(path: &Path, bytes: &[u8], errors: &ErrorSource) -> Result<Content, ReadErrorKind> {
    let fields = match errors {
        ErrorSource::FromFile(fields) => fields,
        ErrorSource::Model(_) => &FieldChoice::Ignore,
    };
    let nameless = |format| match fields {
        FieldChoice::Named(field) => Err(ReadErrorKind::NoNamedFields { field: field.clone(), format }),
        FieldChoice::Automatic | FieldChoice::Ignore => Ok(()),
    };
    Ok(match detect(bytes, &source::extension(path)) {
        Format::Ply => Content::Cloud(ply::read(bytes, fields)?),
        Format::Pcd => Content::Cloud(pcd::read(bytes, fields)?),
        Format::Text => Content::Cloud(text::read(bytes, fields)?),
        Format::Npy => {
            nameless("NPY")?;
            Content::Cloud(npy::read(bytes)?)
        }
        Format::Png => {
            nameless("PNG")?;
            Content::Depth(DepthImage::read(bytes)?)
        }
        Format::Foreign(name, advice) => return Err(ReadErrorKind::Foreign { name, advice }),
        Format::Unknown => return Err(ReadErrorKind::Unknown),
    })
}
