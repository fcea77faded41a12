//! Recorded costs taken together: those of one scene, and all.

use crate::comparison::Row;

/// What comes before this in a name is the family of the cost.
const MEMBER: &str = ", cluster";

const OURS: &str = "CertifiedSearch";
/// Who is compared with, and by which factor more evaluations it should need.
const OTHERS: [(&str, usize); 2] = [("NLopt CRS2-LM", 2), ("Fig. 2, no steps", 3)];

/// The rows of each family as one, as if all its costs were seeds of one; then those of all costs.
pub fn pooled(rows: &[Row]) -> Vec<Row> {
    let mut pooled: Vec<Row> = Vec::new();
    for row in rows {
        let family = row.cost.split(MEMBER).next().unwrap_or_default();
        for name in [family, "all"] {
            let place = pooled.iter().position(|p| p.cost == name && p.method == row.method);
            if let Some(sum) = place.and_then(|place| pooled.get_mut(place)) {
                sum.steps += row.steps;
                sum.success.extend(&row.success);
            } else {
                pooled.push(Row { cost: name.into(), ..row.clone() });
            }
        }
    }
    // Families in the order in which they came, each in one piece, and all of them at the end.
    let families: Vec<String> = pooled.iter().map(|row| row.cost.clone()).collect();
    pooled.sort_by_key(|row| (row.cost == "all", families.iter().position(|name| *name == row.cost)));
    pooled
}

/// The pooled table, and on how many costs the certified search needs the wanted part of what others need, each for
/// 95 % of the seeds.
pub fn report(rows: &[Row], table: impl Fn(&[Row]) -> String) -> String {
    let mut text = table(&pooled(rows));
    let of = |method: &str, cost: &str| {
        rows.iter().find(|row| row.cost == cost && row.method == method).map(|row| row.quantile(95))
    };
    for (method, factor) in OTHERS {
        let pairs: Vec<(Option<usize>, Option<usize>)> = rows
            .iter()
            .filter(|row| row.method == OURS)
            .filter_map(|row| Some((row.quantile(95), of(method, &row.cost)?)))
            .collect();
        // Without success within the cap the other needs more than any number we know.
        let enough = |(ours, other): &&(Option<usize>, Option<usize>)| match (ours, other) {
            (Some(ours), Some(other)) => factor * ours <= *other,
            (Some(_), None) => true,
            (None, _) => false,
        };
        let count = pairs.iter().filter(enough).count();
        let hopeless = pairs.iter().filter(|(ours, _)| ours.is_some_and(|ours| ours < 2)).count();
        text += &format!(
            "\n{OURS} needs at most 1/{factor} of the evaluations of {method} for 95 % of the seeds on {count} of {} costs; \
             on {hopeless} costs it needs one.\n",
            pairs.len()
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(cost: &str, method: &str, success: Vec<Option<usize>>) -> Row {
        Row { cost: cost.into(), dimension: 1, steps: 10.0, method: method.into(), success }
    }

    #[test]
    fn costs_of_a_scene_are_taken_together_and_all_at_the_end() {
        let rows = [
            row("a, cluster 0", "m", vec![Some(1)]),
            row("b, cluster 0", "m", vec![Some(2)]),
            row("a, cluster 1", "m", vec![None]),
        ];
        let pooled = pooled(&rows);
        let names: Vec<&str> = pooled.iter().map(|row| &*row.cost).collect();
        assert_eq!(names, ["a", "b", "all"]);
        assert_eq!(pooled[0].success, [Some(1), None]);
        assert_eq!(pooled[2].success, [Some(1), Some(2), None]);
        assert_eq!(pooled[0].steps, 20.0);
    }

    #[test]
    fn the_parts_are_counted() {
        let ours = |n| row("a, cluster 0", OURS, vec![n]);
        let count = |ours: Row, nlopt| {
            let rows = [ours, row("a, cluster 0", "NLopt CRS2-LM", vec![nlopt])];
            report(&rows, |_| String::new()).contains("on 1 of 1 costs")
        };
        assert!(count(ours(Some(10)), Some(20)) && count(ours(Some(10)), None));
        assert!(!count(ours(Some(11)), Some(20)) && !count(ours(None), None));
    }
}
