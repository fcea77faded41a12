//! From a file to a scan: format, errors and frame.

use std::path::PathBuf;

use terrace_noise::{ScanNoiseError, SensorNoise};
use terrace_types::{Scan, ScanError};

use crate::depth::{DEFAULT_DEPTH_SCALE, DepthError};
use crate::npy::NpyError;
use crate::pcd::PcdError;
use crate::ply::PlyError;
use crate::text::TextError;
use crate::{FieldChoice, Intrinsics, ScanReader, Source};

/// Where the errors of points come from.
#[derive(Debug, Clone, PartialEq)]
pub enum ErrorSource {
    /// From fields of the file; [`Sigma::Unknown`](terrace_types::Sigma::Unknown) when it has none and none was asked for by name.
    FromFile(FieldChoice),
    /// From the noise model of the sensor; fields of the file are not looked at.
    ///
    /// * [`Uniform`](SensorNoise::Uniform) gives [`Sigma::Uniform`](terrace_types::Sigma::Uniform).
    /// * [`PerAxis`](SensorNoise::PerAxis) is along the axes of the *world*. Where the points are in the world, or the
    ///   frames of sensor and world are parallel, it gives [`Sigma::PerAxis`](terrace_types::Sigma::PerAxis); where a pose turns them,
    ///   [`Sigma::Covariance`](terrace_types::Sigma::Covariance) in the frame of the sensor.
    /// * The others give [`Sigma::Covariance`](terrace_types::Sigma::Covariance). They need the place of the sensor: with a pose it is the origin of the
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
    let mut reader = ScanReader::open(source, options, usize::MAX)?;
    let scan = reader.take()?;
    Ok(Counted { scan, not_measured: reader.not_measured() })
}
