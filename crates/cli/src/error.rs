//! What can go wrong, and the exit code it ends with.

use std::path::PathBuf;

use terrace_trials::TrialError;

/// An error that ends the program.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// An argument does not make sense.
    #[error("{0}")]
    Usage(String),
    /// A parameter is out of its range.
    #[error(transparent)]
    Params(#[from] terrace::ParamsError),
    /// There is no map that forgets its points.
    #[error(transparent)]
    Streaming(#[from] terrace::StreamingError),
    /// The intrinsics cannot be read.
    #[error("--intrinsics: {0}")]
    Intrinsics(String),
    /// Inputs or their poses cannot be found.
    #[error(transparent)]
    Source(#[from] terrace_io::SourceError),
    /// None of the inputs could be used.
    #[error("nothing usable: none of {inputs} inputs could be read; the last: {last}")]
    NothingUsable {
        /// Number of inputs.
        inputs: usize,
        /// What was wrong with the last of them.
        last: String,
    },
    /// A file cannot be read.
    #[error(transparent)]
    Read(#[from] terrace_io::ReadError),
    /// A file is no map.
    #[cfg(feature = "parquet")]
    #[error("{}: {error}", path.display())]
    MapFile {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        error: terrace_checkpoint::MapFileError,
    },
    /// A map does not fit those before it.
    #[cfg(feature = "parquet")]
    #[error("{}: {error}: {advice}", path.display())]
    Merge {
        /// The file of the map.
        path: PathBuf,
        /// What does not fit.
        error: terrace::MergeError,
        /// What to do about it.
        advice: &'static str,
    },
    /// A file that was read before cannot be read again, or changed in between.
    #[error("{path}: the file changed while it was worked on")]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// A depth image cannot be used.
    #[error(transparent)]
    Depth(#[from] terrace_depth::DepthError),
    /// The pixels of a depth image are no points.
    #[error(transparent)]
    DepthImage(#[from] terrace_io::depth::DepthError),
    /// Points are no scan.
    #[error(transparent)]
    Scan(#[from] terrace_types::ScanError),
    /// No planes could be extracted.
    #[error(transparent)]
    Extract(#[from] terrace::ExtractError),
    /// An argument of the tuning does not make sense.
    #[error("{option}: {error}")]
    TuneOption {
        /// The option.
        option: String,
        /// What is wrong with it.
        error: terrace::tune::TuneError,
    },
    /// The settings could not be tuned.
    #[error(transparent)]
    Tune(terrace::tune::TuneError),
    /// True labels cannot be read.
    #[error("--labels: {path}: {reason}")]
    Labels {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Pairs of labelings could not be compared; each was reported.
    #[error("{failed} of {pairs} pairs could not be compared")]
    EvalPairs {
        /// Number of these.
        failed: usize,
        /// Number of all.
        pairs: usize,
    },
    /// Covariances could not be tested.
    #[error(transparent)]
    Trial(#[from] TrialError),
    /// A result cannot be written.
    #[error(transparent)]
    Write(#[from] terrace_io::WriteError),
    /// A synthetic scene cannot be made.
    #[error(transparent)]
    Synth(#[from] terrace_synth::SynthError),
    /// A picture cannot be drawn.
    #[error("the picture cannot be drawn: {0}")]
    Draw(#[from] terrace_draw::DrawError),
    /// The threads cannot be started.
    #[error("{0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

impl CliError {
    /// 2 for wrong arguments, 1 for everything else.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_)
            | Self::Params(_)
            | Self::Streaming(_)
            | Self::Intrinsics(_)
            | Self::Synth(_)
            | Self::TuneOption { .. }
            | Self::Trial(TrialError::NoErrors | TrialError::Synth(_) | TrialError::Params(_)) => 2,
            _ => 1,
        }
    }
}
