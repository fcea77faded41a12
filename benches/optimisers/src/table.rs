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

/// A line for each cost, a column for each method: percentage of success within 100 evaluations for each axis, and
/// the evaluations for half and for 95 percent of the seeds.
pub fn wide(rows: &[Row]) -> String {
    let mut methods: Vec<&str> = Vec::new();
    for row in rows {
        if !methods.contains(&&*row.method) {
            methods.push(&row.method);
        }
    }
    let mut text = format!("| cost | d | steps | {} |\n| --- | ---: | ---: |", methods.join(" | "));
    text += &" --- |".repeat(methods.len());
    for of_cost in rows.chunk_by(|a, b| (&a.cost, a.dimension) == (&b.cost, b.dimension)) {
        let Some(first) = of_cost.first() else { continue };
        text += &format!("\n| {} | {} | {} |", first.cost, first.dimension, steps(first));
        for method in &methods {
            let cell = of_cost.iter().find(|row| row.method == *method).map_or(String::new(), |row| {
                let number = |percent| row.quantile(percent).map_or("-".into(), |n: usize| n.to_string());
                let rate = 100.0 * row.rate(100 * row.dimension);
                format!("{rate:.0} %, {} / {}", number(50), number(95))
            });
            text += &format!(" {cell} |");
        }
    }
    text + "\n"
}

fn steps(row: &Row) -> String {
    if row.steps < 1e6 { format!("{}", row.steps) } else { format!("{:.1e}", row.steps) }
}

/// One row of the long table.
fn line(row: &Row) -> String {
    let mut text = format!("| {} | {} | {} | {} |", row.cost, row.dimension, steps(row), row.method);
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

    #[test]
    fn the_wide_table_has_a_line_for_each_cost_and_blanks_for_methods_that_do_not_take_it() {
        let row = |cost: &str, method: &str| Row {
            cost: cost.into(),
            dimension: 1,
            steps: 7.0,
            method: method.into(),
            success: vec![Some(3), None],
        };
        let table = wide(&[row("a", "m"), row("a", "n"), row("b", "n")]);
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines[0], "| cost | d | steps | m | n |");
        assert_eq!(lines[2], "| a | 1 | 7 | 50 %, 3 / - | 50 %, 3 / - |");
        assert_eq!(lines[3], "| b | 1 | 7 |  | 50 %, 3 / - |");
    }
}
