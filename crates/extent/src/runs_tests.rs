//! Runs against sets of pixels.

use std::collections::BTreeSet;

use super::*;

fn pixels(runs: &Runs) -> BTreeSet<[i32; 2]> {
    runs.rows()
        .flat_map(|(row, runs)| runs.iter().flat_map(move |&(a, b)| (a..b).map(move |x| [x, row])))
        .collect()
}

/// By definition: what is in every disc that touches none of the set.
fn closed(set: &BTreeSet<[i32; 2]>, radius: f64) -> BTreeSet<[i32; 2]> {
    #[expect(clippy::cast_possible_truncation, reason = "at most five")]
    let reach = radius as i32;
    let disc: Vec<[i32; 2]> = (-reach..=reach)
        .flat_map(|x| (-reach..=reach).map(move |y| [x, y]))
        .filter(|[x, y]| f64::from(x * x + y * y) <= radius * radius)
        .collect();
    let dilated: BTreeSet<[i32; 2]> =
        set.iter().flat_map(|p| disc.iter().map(|d| [p[0] + d[0], p[1] + d[1]])).collect();
    let inside = |p: &&[i32; 2]| disc.iter().all(|d| dilated.contains(&[p[0] + d[0], p[1] + d[1]]));
    dilated.iter().filter(inside).copied().collect()
}

proptest::proptest! {
    #[test]
    fn as_by_definition(
        points in proptest::collection::vec((-12..12_i32, -12..12_i32), 0..60),
        gone in proptest::collection::vec((-12..12_i32, -12..12_i32), 0..60),
        radius in 0.0..5.0_f64,
    ) {
        // Far apart too: rows between are not looked at.
        let set: BTreeSet<[i32; 2]> =
            points.iter().map(|&(x, y)| if x > 8 { [x, y + (1 << 28)] } else { [x, y] }).collect();
        let runs = Runs::of(set.iter().copied());
        assert_eq!(pixels(&runs), set);
        assert_eq!(pixels(&runs.closed(radius)), closed(&set, radius));
        let border: BTreeSet<[i32; 2]> = set
            .iter()
            .filter(|[x, y]| {
                [[x + 1, *y], [x - 1, *y], [*x, y + 1], [*x, y - 1]].iter().any(|p| !set.contains(p))
            })
            .copied()
            .collect();
        assert_eq!(runs.border().into_iter().collect::<BTreeSet<_>>(), border);
        for (first, last) in [(-13, 13), (-4, 3), (2, 2)] {
            let columns = (first..last).filter(|x| set.contains(&[*x, 3]));
            assert!(runs.columns(3, first, last).eq(columns));
        }
        let gone: Vec<[i32; 2]> = gone.into_iter().map(|(x, y)| [x, y]).collect();
        let left: BTreeSet<[i32; 2]> = set.iter().filter(|p| !gone.contains(p)).copied().collect();
        assert_eq!(runs.without(&gone), Runs::of(left.into_iter()));
    }
}
