//! CPU time and memory of this process.

use std::fs;
use std::io;

/// Why the usage of the process is not known.
#[derive(Debug)]
pub enum UsageError {
    /// `/proc` cannot be read: the system is not Linux, or hides it.
    Io(io::Error),
    /// A line or number is missing.
    Format {
        /// What was looked for.
        missing: &'static str,
    },
}

impl std::fmt::Display for UsageError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Io(error) => write!(f, "/proc cannot be read: {error}"),
            Self::Format { missing } => write!(f, "/proc has no {missing}"),
        }
    }
}

impl std::error::Error for UsageError {}

impl From<io::Error> for UsageError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// In a second: what Linux tells programs, whatever it counts in itself.
const TICKS: f64 = 100.0;

/// What this process has used so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Usage {
    /// Seconds its living threads have run on a CPU, from the scheduler's nanoseconds.
    pub cpu: f64,
    /// Memory in use, in MiB.
    pub resident: f64,
    /// The most memory that was in use at once, in MiB.
    pub peak: f64,
}

impl Usage {
    /// The usage up to now.
    ///
    /// # Errors
    /// [`UsageError`] where there is no `/proc` with scheduler statistics.
    pub fn now() -> Result<Self, UsageError> {
        let cpu = Self::cpu_now()?;
        let status = fs::read_to_string("/proc/self/status")?;
        Ok(Self { cpu, resident: mebibytes(&status, "VmRSS:")?, peak: mebibytes(&status, "VmHWM:")? })
    }

    /// [`cpu`](Self::cpu) alone: asked before and after something, for it takes less time itself.
    ///
    /// # Errors
    /// As [`now`](Self::now).
    pub fn cpu_now() -> Result<f64, UsageError> {
        // The scheduler counts in ticks until a thread lets go of its CPU.
        std::thread::yield_now();
        cpu()
    }

    /// Seconds that the system has worked for this process: handed out memory, read files. To a hundredth, of all threads that there were.
    ///
    /// # Errors
    /// As [`now`](Self::now).
    pub fn system_now() -> Result<f64, UsageError> {
        let stat = fs::read_to_string("/proc/self/stat")?;
        // Behind the name, which may hold anything, the 13th number.
        let numbers = stat.rsplit_once(')').map(|(_, numbers)| numbers.split_whitespace().nth(12));
        Ok(number(numbers.flatten(), "system time in stat")? / TICKS)
    }

    /// From here on the peak is that of the memory in use from here on.
    ///
    /// # Errors
    /// When the system does not allow it.
    pub fn forget_peak() -> io::Result<()> {
        fs::write("/proc/self/clear_refs", "5")
    }
}

/// Over all threads: `/proc/self/schedstat` would tell of the first alone.
fn cpu() -> Result<f64, UsageError> {
    let mut nanoseconds = 0.0;
    for task in fs::read_dir("/proc/self/task")? {
        // A thread that has just ended took its file with it.
        let Ok(line) = fs::read_to_string(task?.path().join("schedstat")) else { continue };
        nanoseconds += number(line.split_whitespace().next(), "run time in schedstat")?;
    }
    Ok(nanoseconds / 1e9)
}

fn mebibytes(status: &str, name: &'static str) -> Result<f64, UsageError> {
    let line = status.lines().find_map(|line| line.strip_prefix(name));
    Ok(number(line.and_then(|rest| rest.split_whitespace().next()), name)? / 1024.0)
}

fn number(text: Option<&str>, missing: &'static str) -> Result<f64, UsageError> {
    text.and_then(|t| t.parse().ok()).ok_or(UsageError::Format { missing })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_and_memory_are_seen() {
        if !fs::exists("/proc/self/schedstat").unwrap() {
            return;
        }
        let before = Usage::now().unwrap();
        let block = std::hint::black_box(vec![1_u8; 64 << 20]);
        while Usage::now().unwrap().cpu < before.cpu + 0.02 {
            std::hint::black_box(block.iter().map(|b| u64::from(*b)).sum::<u64>());
        }
        // Each look is work of the system.
        let system = Usage::system_now().unwrap();
        let looks = (0..1_000_000).take_while(|_| Usage::system_now().unwrap() < system + 0.02).count();
        assert!(looks < 1_000_000);
        let after = Usage::now().unwrap();
        assert!(
            after.resident > before.resident + 50.0 && after.peak > before.resident + 50.0,
            "{before:?} {after:?}"
        );
    }
}
