//! Models of noise from text and back.

use std::fmt;
use std::str::FromStr;

use crate::keys::{number, numbers, values};
use crate::parameter::deviation;
use crate::{Kinect, Lidar, ParameterError, PerAxis, SensorNoise, Stereo, StereoParameters, Uniform};

/// Why a text names no noise model, or no noise of a pose.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParseNoiseError {
    /// There is no such model.
    #[error(
        "there is no sensor '{found}'; allowed are uniform:0.01, axes:0.01,0.01,0.02, kinect, \
         stereo:fb=80,disparity=0.2,focal=700 and lidar:range=0.02,angle=0.1deg"
    )]
    UnknownModel {
        /// What stands before the colon.
        found: String,
    },
    /// The model has no such key, or there is something that is no `key=value`.
    #[error("{model} has no key '{found}'; allowed are {allowed}")]
    UnknownKey {
        /// The model.
        model: &'static str,
        /// What stands before the equals sign.
        found: String,
        /// The keys of the model.
        allowed: String,
    },
    /// A key stands twice.
    #[error("{model} has the key '{key}' twice, the second time with the value '{value}'")]
    RepeatedKey {
        /// The model.
        model: &'static str,
        /// The key.
        key: &'static str,
        /// Its second value.
        value: String,
    },
    /// A key that has no default is missing.
    #[error("{model} needs the key '{key}'; allowed are {allowed}")]
    MissingKey {
        /// The model.
        model: &'static str,
        /// The key.
        key: &'static str,
        /// The keys of the model.
        allowed: String,
    },
    /// There are more or fewer values than the model has.
    #[error("{model} takes {needed} value(s) in metres, separated by commas; found '{found}'")]
    WrongCount {
        /// The model.
        model: &'static str,
        /// How many values it has.
        needed: usize,
        /// What stands behind the colon.
        found: String,
    },
    /// A value is not a number.
    #[error("{name} is '{found}'; allowed is {allowed}")]
    NotANumber {
        /// The key, or the model when its values have none.
        name: &'static str,
        /// The value as it stands.
        found: String,
        /// What may stand there.
        allowed: &'static str,
    },
    /// The standard deviations of a pose are not two.
    #[error(
        "'{found}' is not T,R: metres, and a rotation with deg, mrad or rad behind it, such as 0.02,0.3deg"
    )]
    NotAPoseSigma {
        /// The text.
        found: String,
    },
    /// A number is out of its bounds.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

impl FromStr for SensorNoise {
    type Err = ParseNoiseError;

    fn from_str(text: &str) -> Result<Self, ParseNoiseError> {
        let (name, rest) = text.split_once(':').map_or((text, ""), |(name, rest)| (name, rest.trim()));
        Ok(match name.trim() {
            "uniform" => {
                let [sigma] = numbers("uniform", rest)?;
                Self::Uniform(Uniform::from_metres(sigma)?)
            }
            "axes" => Self::PerAxis(PerAxis::from_metres(numbers("axes", rest)?)?),
            "kinect" => Self::Kinect(kinect(rest)?),
            "stereo" => Self::Stereo(stereo(rest)?),
            "lidar" => Self::Lidar(lidar(rest)?),
            found => return Err(ParseNoiseError::UnknownModel { found: found.to_owned() }),
        })
    }
}

fn kinect(text: &str) -> Result<Kinect, ParseNoiseError> {
    let keys = values("kinect", ["focal"], text)?;
    match keys.get("focal") {
        Some(focal) => Ok(Kinect::from_focal_pixels(number("focal", focal)?)?),
        None => Ok(Kinect::default()),
    }
}

fn stereo(text: &str) -> Result<Stereo, ParseNoiseError> {
    let keys = values("stereo", ["fb", "disparity", "focal", "pixel"], text)?;
    Ok(Stereo::new(StereoParameters {
        focal_times_baseline: number("fb", keys.required("fb")?)?,
        disparity: number("disparity", keys.required("disparity")?)?,
        focal: number("focal", keys.required("focal")?)?,
        pixel: keys
            .get("pixel")
            .map_or(Ok(StereoParameters::DEFAULT_PIXEL), |pixel| number("pixel", pixel))?,
    })?)
}

fn lidar(text: &str) -> Result<Lidar, ParseNoiseError> {
    let keys = values("lidar", ["range", "angle", "proportional"], text)?;
    let range = number("range", keys.required("range")?)?;
    let lidar = Lidar::from_radians(range, angle("angle", keys.required("angle")?)?)?;
    match keys.get("proportional") {
        Some(proportional) => Ok(lidar.with_proportional(number("proportional", proportional)?)?),
        None => Ok(lidar),
    }
}

/// An angle in radians from a number with `deg`, `mrad`, `rad` or nothing behind it.
pub(crate) fn angle(name: &'static str, text: &str) -> Result<f64, ParseNoiseError> {
    let value = |digits: &str| {
        digits.trim().parse::<f64>().map_err(|_| ParseNoiseError::NotANumber {
            name,
            found: text.to_owned(),
            allowed: "a number with deg, mrad or rad behind it (radians without)",
        })
    };
    // Checked here too, so that an error names the value as it stands. "mrad" ends in "rad" too.
    if let Some(degrees) = text.strip_suffix("deg") {
        Ok(deviation(name, value(degrees)?)?.to_radians())
    } else if let Some(thousandths) = text.strip_suffix("mrad") {
        Ok(deviation(name, value(thousandths)?)? / 1000.0)
    } else {
        value(text.strip_suffix("rad").unwrap_or(text))
    }
}

/// Whether a unit of an angle stands behind a number.
pub(crate) fn has_unit(text: &str) -> bool {
    text.ends_with("deg") || text.ends_with("rad")
}

impl fmt::Display for SensorNoise {
    /// The text that reads back as this model; keys that have their default are left out.
    #[allow(clippy::float_cmp)] // Only the default itself may be left out.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Uniform(model) => write!(f, "uniform:{}", model.sigma()),
            Self::PerAxis(model) => {
                let [x, y, z] = model.sigma();
                write!(f, "axes:{x},{y},{z}")
            }
            Self::Kinect(model) if *model == Kinect::default() => f.write_str("kinect"),
            Self::Kinect(model) => write!(f, "kinect:focal={}", model.focal()),
            Self::Stereo(model) => {
                let StereoParameters { focal_times_baseline, disparity, focal, pixel } = model.parameters();
                write!(f, "stereo:fb={focal_times_baseline},disparity={disparity},focal={focal}")?;
                if pixel == StereoParameters::DEFAULT_PIXEL { Ok(()) } else { write!(f, ",pixel={pixel}") }
            }
            Self::Lidar(model) => {
                write!(f, "lidar:range={},angle={}rad", model.range(), model.angle())?;
                if model.proportional() == 0.0 {
                    Ok(())
                } else {
                    write!(f, ",proportional={}", model.proportional())
                }
            }
        }
    }
}
