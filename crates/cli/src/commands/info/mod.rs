//! `terrace info`: what files hold.

#[cfg(feature = "parquet")]
mod map_info;

use std::path::Path;

use terrace_io::{Info, ReadOptions, inspect};

use crate::args::{InfoArgs, ReadArgs};
use crate::commands::extract::read_options;
use crate::error::CliError;

/// Prints what each file holds; files that cannot be read are reported, and the rest go on.
pub fn run(args: &InfoArgs) -> Result<(), CliError> {
    let options = read_options(&args.read)?;
    let mut last = None;
    for path in &args.files {
        match told(path, &options, &args.read) {
            Ok(text) => out!("{}\n{text}", path.display()),
            Err(error) => {
                eprintln!("terrace: {error}");
                last = Some(error);
            }
        }
    }
    last.map_or(Ok(()), Err)
}

fn told(path: &Path, options: &ReadOptions, args: &ReadArgs) -> Result<String, CliError> {
    #[cfg(feature = "parquet")]
    if terrace_checkpoint::is_parquet(path) {
        return map_info::told(path);
    }
    Ok(text(&inspect(path, options)?, args))
}

fn text(info: &Info, args: &ReadArgs) -> String {
    let mut lines = vec![("format", info.format.to_owned())];
    if let Some([width, height]) = info.image_size {
        lines.push(("image", format!("{width} x {height} pixels")));
    }
    lines.push(("points", info.points.to_string()));
    lines.push(("absent", format!("{} (not finite or not measured)", info.absent())));
    match info.bounds {
        Some([min, max]) => {
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                let (lo, hi) = (min[axis], max[axis]);
                lines.push((name, format!("{lo:.4} to {hi:.4} m ({:.4} m)", hi - lo)));
            }
        }
        None if info.image_size.is_some() => {
            lines.push(("bounds", "unknown without --intrinsics".to_owned()));
        }
        None => {}
    }
    if let Some(spacing) = info.spacing {
        lines.push(("spacing", format!("{spacing:.4} m to the nearest point (median)")));
    }
    lines.push(match (info.sigma, args.sigma, args.sensor) {
        (_, Some(sigma), _) => ("sigma", format!("{sigma} m, as given")),
        (_, None, Some(noise)) => ("sigma", format!("by {noise}, as given")),
        (Some([lo, hi]), ..) => ("sigma", format!("{lo:.5} to {hi:.5} m")),
        (None, ..) => ("sigma", "not in the file".to_owned()),
    });
    if let Some(pose) = info.viewpoint {
        let [x, y, z] = pose.translation();
        lines.push(("viewpoint", format!("{x:.4} {y:.4} {z:.4} m")));
    }
    aligned(lines)
}

fn aligned(lines: Vec<(&str, String)>) -> String {
    lines.into_iter().map(|(name, value)| format!("  {name:<10} {value}\n")).collect()
}
