//! Instructions of the hot loops, counted by callgrind: unlike times they hardly change from run to run, whatever else the machine does.
//!
//! `cargo bench -p terrace-benches --bench instructions [-- --check | --record]`
//!
//! * without an option: the counts beside those of `benches/instructions.json`.
//! * `--check`: an error when a loop takes more instructions than its stored count and the tolerance: [`Conditions::tolerance`].
//! * `--record`: stores the counts anew.
//!
//! Each loop runs in a process of its own (`--loop NAME`) under valgrind, which has to be installed. The C library's part is counted too.

mod loops;

use std::error::Error;
use std::path::Path;
use std::process::{Command, ExitCode};

use rayon::prelude::*;
use terrace_benches::instructions::{Conditions, Count, Counts};

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

const STORED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/instructions.json");

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let bench = std::env::args().any(|a| a == "--bench");
    let done = match args[..] {
        ["--loop", name] => run_loop(name),
        _ if !bench => {
            println!("nothing is measured without `cargo bench`");
            Ok(true)
        }
        [] => compare(false),
        ["--check"] => compare(true),
        ["--record"] => record(),
        _ => Err("the options are --check or --record".into()),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Inside valgrind: one loop, then what it did and on what processor.
fn run_loop(name: &str) -> Outcome<bool> {
    let one = loops::ALL.iter().find(|one| one.name == name).ok_or("no such loop")?;
    // The work is then done by the thread that enters the counted function.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let done = pool.install(|| (one.run)())?;
    println!("{done}\n{}\n{}", one.of, processor());
    Ok(true)
}

/// The vectors that `pulp` chose: valgrind lets programs see those of this processor that it knows.
fn processor() -> String {
    let arch = format!("{:?}", pulp::Arch::new());
    let vectors = arch.split('(').next().unwrap_or_default();
    format!("{}, vectors: {vectors}", std::env::consts::ARCH)
}

fn compare(check: bool) -> Outcome<bool> {
    let stored = Counts::read(Path::new(STORED))?;
    let now = count_all()?;
    let comparison = stored.compare(&now);
    print!("{comparison}");
    Ok(!check || comparison.passes())
}

fn record() -> Outcome<bool> {
    let counts = count_all()?;
    counts.write(Path::new(STORED))?;
    print!("{}", counts.compare(&counts));
    Ok(true)
}

fn count_all() -> Outcome<Counts> {
    let counted: Vec<(Count, String)> =
        loops::ALL.par_iter().map(|one| count(one.name)).collect::<Outcome<_>>()?;
    let processor = counted.first().map(|(_, processor)| processor.clone()).unwrap_or_default();
    let compiler = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let conditions = Conditions {
        compiler: output(Command::new(compiler).arg("--version"))?,
        // Without glibc there is no such number.
        c_library: output(Command::new("getconf").arg("GNU_LIBC_VERSION")).unwrap_or_default(),
        processor,
    };
    Ok(Counts { conditions, loops: counted.into_iter().map(|(count, _)| count).collect() })
}

/// The instructions of a loop, and the processor it saw.
fn count(name: &str) -> Outcome<(Count, String)> {
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null", "--collect-atstart=no"]);
    valgrind.arg(format!("--toggle-collect=*{}*", loops::COUNTED));
    valgrind.arg(std::env::current_exe()?).args(["--loop", name]);
    let ended = valgrind.output().map_err(|error| format!("valgrind cannot be run: {error}"))?;
    let (said, counted) = (String::from_utf8(ended.stdout)?, String::from_utf8_lossy(&ended.stderr));
    let instructions =
        counted.lines().find_map(|line| line.split_once("Collected : ")?.1.trim().parse().ok());
    let mut said = said.lines();
    match (instructions, said.next(), said.next(), said.next()) {
        (Some(instructions), Some(done), Some(of), Some(processor)) if instructions > 0 => {
            let count = Count { name: name.to_owned(), instructions, done: done.parse()?, of: of.to_owned() };
            Ok((count, processor.to_owned()))
        }
        _ => Err(format!("{name}: {}, nothing was counted:\n{counted}", ended.status).into()),
    }
}

fn output(command: &mut Command) -> Outcome<String> {
    Ok(String::from_utf8(command.output()?.stdout)?.trim().to_owned())
}
