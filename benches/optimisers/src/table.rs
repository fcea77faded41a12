//! The printed table.

use crate::comparison::Row;

/// Evaluations for each axis at which the share of success is told.
pub const BUDGETS: [usize; 5] = [25, 50, 100, 200, 400];

/// The rows as a table in Markdown.
pub fn markdown(rows: &[Row]) -> String {
    let mut text = String::from("| cost | d | steps | method |");
    for budget in BUDGETS {
        text += &format!(" {budget} d |");
    }
    text += " median | 95 % |\n| --- | ---: | ---: | --- |";
    text += &" ---: |".repeat(BUDGETS.len() + 2);
    text.push('\n');
    for row in rows {
        text += &line(row);
    }
    text
}

/// One row of it.
fn line(row: &Row) -> String {
    let steps = if row.steps < 1e6 { format!("{}", row.steps) } else { format!("{:.1e}", row.steps) };
    let mut text = format!("| {} | {} | {steps} | {} |", row.cost, row.dimension, row.method);
    for budget in BUDGETS {
        text += &format!(" {:.0} |", 100.0 * row.rate(budget * row.dimension));
    }
    for percent in [50, 95] {
        text += &row.quantile(percent).map_or(" - |".into(), |number| format!(" {number} |"));
    }
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_tells_rates_in_percent_and_numbers_or_dashes() {
        let success = vec![Some(50), Some(51), None];
        let row = Row { cost: "c".into(), dimension: 2, steps: 1.5e6, method: "m".into(), success };
        assert_eq!(line(&row), "| c | 2 | 1.5e6 | m | 33 | 67 | 67 | 67 | 67 | 51 | - |\n");
        let table = markdown(&[row]);
        let bars: Vec<usize> = table.lines().map(|line| line.matches('|').count()).collect();
        assert_eq!(bars, [12, 12, 12]);
    }
}
