//! Measures as tables for people.

use terrace_eval::Measure;

use crate::commands::eval::compare::Compared;

enum Unit {
    Planes,
    Share,
    Degrees,
    Millimetres,
}

/// A heading, the name of its measure, and how it is shown.
type Column = (&'static str, &'static str, Unit);

const PLANES: [Column; 13] = [
    ("true", "true_planes", Unit::Planes),
    ("found", "found_planes", Unit::Planes),
    ("precision", "precision_50", Unit::Share),
    ("recall", "recall_50", Unit::Share),
    ("F1", "f1_50", Unit::Share),
    ("precision", "precision_80", Unit::Share),
    ("recall", "recall_80", Unit::Share),
    ("F1", "f1_80", Unit::Share),
    ("correct", "correct", Unit::Planes),
    ("over", "over", Unit::Planes),
    ("under", "under", Unit::Planes),
    ("missed", "missed", Unit::Planes),
    ("noise", "noise", Unit::Planes),
];

/// What stands above the columns of [`PLANES`].
const GROUPS: &str = "             planes              IoU above 0.5              IoU above 0.8                       at 80 % of points\n";

const POINTS: [Column; 9] = [
    ("wcov", "weighted_cover", Unit::Share),
    ("cov", "cover", Unit::Share),
    ("mean IoU", "mean_iou", Unit::Share),
    ("all", "mean_iou_all", Unit::Share),
    ("Dice", "mean_dice", Unit::Share),
    ("accuracy", "point_accuracy", Unit::Share),
    ("claimed", "non_planar_claimed", Unit::Share),
    ("angle deg", "angle_degrees_median", Unit::Degrees),
    ("offset mm", "offset_median", Unit::Millimetres),
];

/// All pairs, and their mean when there are several.
pub fn of_pairs(compared: &[Compared], means: &[Measure]) -> String {
    let rows: Vec<Vec<Measure>> = compared.iter().map(Compared::measures).collect();
    let mut text = String::from("pair\n");
    for (number, one) in compared.iter().enumerate() {
        let (pred, truth) = (one.pair.pred.display(), one.pair.truth.display());
        text += &format!("{:>4}  {pred} against {truth}: {} points\n", number + 1, one.evaluation.points);
    }
    text += "\n";
    text += GROUPS;
    text += &block(&PLANES, &rows, means);
    text += "\n";
    text += &block(&POINTS, &rows, means);
    text
}

fn block(columns: &[Column], rows: &[Vec<Measure>], means: &[Measure]) -> String {
    let mut text = String::from("pair");
    for (heading, ..) in columns {
        text += &format!("  {heading:>0$}", width(heading));
    }
    text += "\n";
    for (number, row) in rows.iter().enumerate() {
        text += &line(&(number + 1).to_string(), columns, row, 0);
    }
    if rows.len() > 1 {
        text += &line("mean", columns, means, 1);
    }
    text
}

fn line(name: &str, columns: &[Column], measures: &[Measure], decimals_of_counts: usize) -> String {
    let mut text = format!("{name:>4}");
    for (heading, name, unit) in columns {
        let value = measures.iter().find(|measure| measure.name == *name).and_then(|measure| measure.value);
        let shown = match unit {
            Unit::Planes => number(value, decimals_of_counts),
            Unit::Share => number(value, 4),
            Unit::Degrees => number(value, 3),
            Unit::Millimetres => number(value.map(|metres| 1000.0 * metres), 2),
        };
        text += &format!("  {shown:>0$}", width(heading));
    }
    text + "\n"
}

/// Room for a share with four decimals, and for a small number of planes.
fn width(heading: &str) -> usize {
    match heading {
        "true" | "over" => 5,
        _ => heading.len().max(6),
    }
}

fn number(value: Option<f64>, decimals: usize) -> String {
    value.map_or("-".to_owned(), |value| format!("{value:.decimals$}"))
}

/// Each true plane of one pair.
pub fn of_planes(pair: usize, compared: &Compared) -> String {
    let mut text = format!(
        "\npair {pair}, true planes\nplane      points  best IoU  found  angle deg  offset mm  name\n"
    );
    for plane in &compared.evaluation.planes {
        let deviation = compared.deviations.iter().find(|d| d.truth == plane.truth);
        let named = compared.true_planes.get(&plane.truth);
        let row = format!(
            "{:>5}  {:>10}  {:>8.4}  {:>5}  {:>9}  {:>9}  {}",
            plane.truth,
            plane.points,
            plane.best_iou,
            plane.found.map_or("-".to_owned(), |found| found.to_string()),
            number(deviation.map(|d| d.angle.to_degrees()), 3),
            number(deviation.and_then(|d| d.offset).map(|metres| 1000.0 * metres), 2),
            named.and_then(|n| n.name.as_deref()).unwrap_or_default(),
        );
        text += row.trim_end();
        text += "\n";
    }
    text
}
