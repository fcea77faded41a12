//! The command that extracts planes with the settings found.

use terrace::tune::Settings;

use crate::args::TuneArgs;

/// The option that sets a parameter.
pub fn option(parameter: &str) -> String {
    match parameter {
        "cell_size" => "--cell".to_owned(),
        other => format!("--{}", other.replace('_', "-")),
    }
}

/// `terrace extract` with the same inputs and the settings found, as a line for a shell.
pub fn command(args: &TuneArgs, best: &Settings) -> String {
    let mut words = vec!["terrace".to_owned(), "extract".to_owned()];
    words.extend(args.inputs.iter().cloned());
    let mut set = |name: &str, value: String| words.extend([name.to_owned(), value]);
    set("--out", args.out.join("planes").display().to_string());
    set("--preset", args.preset.name().to_owned());
    set("--cell", best.cell_size.to_string());
    set("--depth", best.depth.to_string());
    set("--tau", best.tau.to_string());
    set("--omega", best.omega.to_string());
    set("--phi", best.phi.to_string());
    if let Some(min_cells) = args.min_cells {
        set("--min-cells", min_cells.to_string());
    }
    if args.seed != 0 {
        set("--seed", args.seed.to_string());
    }
    if let Some(poses) = &args.poses {
        set("--poses", poses.display().to_string());
    }
    if let Some(sigma) = args.read.sigma {
        set("--sigma", sigma.to_string());
    }
    if let Some(noise) = args.read.sensor {
        set("--sensor", noise.to_string());
    }
    if let Some(field) = &args.read.sigma_field {
        set("--sigma-field", field.clone());
    }
    if let Some(intrinsics) = &args.read.intrinsics {
        set("--intrinsics", intrinsics.clone());
    }
    // It means nothing without the intrinsics of depth images, or with the default.
    if args.read.intrinsics.is_some() {
        set("--depth-scale", args.read.depth_scale.to_string());
    }
    // Settings are judged without a search for the phi of single clusters.
    words.push("--no-optimise".to_owned());
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// A word as a shell takes it literally.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_survive_a_shell() {
        assert_eq!(quoted("scans/a-1.ply"), "scans/a-1.ply");
        assert_eq!(quoted("my scans/*.ply"), "'my scans/*.ply'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted(""), "''");
    }

    #[test]
    fn parameters_have_options() {
        assert_eq!(
            ["cell_size", "weight_clusters", "phi"].map(option),
            ["--cell", "--weight-clusters", "--phi"]
        );
    }
}
