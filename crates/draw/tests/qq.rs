//! Properties of Q-Q plots.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::float_cmp, reason = "tests")]

mod common;

use common::{any_value, attribute, elements};
use proptest::prelude::*;
use terrace_draw::{DrawError, QqPlot, QqSeries};

fn series(name: &str, points: &[[f64; 2]]) -> QqSeries {
    QqSeries { name: name.into(), points: points.to_vec() }
}

prop_compose! {
    fn any_chart()(
        title: String,
        series in prop::collection::vec((".{0,8}", prop::collection::vec(prop::array::uniform2(any_value()), 0..20)), 0..4),
        band in prop::collection::vec(prop::array::uniform3(any_value()), 0..8),
        range in prop::option::of((any_value(), any_value()).prop_filter_map("no range", |(a, b)| (a.is_finite() && b.is_finite() && a < b).then_some([a, b]))),
    ) -> QqPlot {
        let series = series.into_iter().map(|(name, points)| QqSeries { name, points }).collect();
        QqPlot { title, series, band, range }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn every_plot_is_well_formed_and_stays_on_its_sheet(chart in any_chart(), width in 200..2_000_usize, height in 200..2_000_usize) {
        let svg = chart.svg(width, height).unwrap();
        for (name, pairs) in elements(&svg) {
            for (keys, limit) in [(["x", "x1", "x2", "cx"], width), (["y", "y1", "y2", "cy"], height)] {
                for key in keys {
                    if let Some(value) = attribute(&pairs, key) {
                        prop_assert!((0.0..=limit as f64).contains(&value), "{name} {key} {value}");
                    }
                }
            }
        }
    }

    #[test]
    fn every_plot_can_be_drawn_as_png_of_its_size(chart in any_chart(), width in 1..200_usize, height in 1..200_usize) {
        let bytes = chart.png(width, height).unwrap();
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        prop_assert_eq!((reader.info().width as usize, reader.info().height as usize), (width, height));
    }
}

/// Places of the discs with this radius.
fn discs(svg: &str, radius: f64) -> Vec<[f64; 2]> {
    let circles = elements(svg).into_iter().filter(|(name, _)| name == "circle").map(|(_, pairs)| pairs);
    let of_size = circles.filter(|pairs| attribute(pairs, "r") == Some(radius));
    of_size.map(|pairs| ["cx", "cy"].map(|key| attribute(&pairs, key).unwrap())).collect()
}

/// The square of the axes on a sheet of 800 × 640: left, top and side.
const SQUARE: [f64; 3] = [76.0, 60.0, 528.0];

#[test]
fn both_axes_have_one_scale_and_equal_distances_are_on_the_diagonal() {
    let points = [[0.0, 0.0], [1.0, 1.0], [2.0, 1.0], [1.0, 2.0], [4.0, 4.0]];
    let chart = QqPlot { series: vec![series("a", &points)], range: Some([0.0, 4.0]), ..QqPlot::default() };
    let [left, top, side] = SQUARE;
    let drawn = discs(&chart.svg(800, 640).unwrap(), 3.0);
    assert_eq!(drawn.len(), points.len());
    for ([x, y], [expected, observed]) in drawn.iter().zip(points) {
        assert!((x - (left + side * expected / 4.0)).abs() < 0.01);
        assert!((y - (top + side * (1.0 - observed / 4.0))).abs() < 0.01);
    }
    // On any other sheet the axes are still a square.
    for (width, height) in [(1_600, 500), (500, 900)] {
        let drawn = discs(
            &chart.svg(width, height).unwrap(),
            3.0 * (width as f64 / 800.0).min(height as f64 / 640.0),
        );
        if let [[x0, y0], .., [x4, y4]] = drawn[..] {
            assert!(((x4 - x0) - (y0 - y4)).abs() < 0.02);
        }
    }
}

#[test]
fn what_is_beyond_the_axes_stands_open_on_the_border_and_is_counted() {
    let chart = QqPlot {
        series: vec![series("walls", &[[1.0, 1.0], [1.5, 7.0], [9.0, 1.0]]), series("floor", &[[1.0, 1.2]])],
        range: Some([0.0, 2.0]),
        ..QqPlot::default()
    };
    let svg = chart.svg(800, 640).unwrap();
    let [left, top, side] = SQUARE;
    // The third is the legend's.
    assert_eq!(discs(&svg, 4.5)[..2], [[left + 0.75 * side, top], [left + side, top + side / 2.0]]);
    assert_eq!((discs(&svg, 4.5).len(), discs(&svg, 3.0).len()), (3, 5));
    assert!(svg.contains(">walls<") && svg.contains(">2 beyond the axes<") && svg.contains(">floor<"));
}

#[test]
fn one_outlier_does_not_make_the_rest_small() {
    let chart =
        |worst: f64| QqPlot { series: vec![series("a", &[[1.0, 1.0], [2.0, worst]])], ..QqPlot::default() };
    // Up to twice the expected all is shown, beyond it is cut.
    assert!(!chart(3.9).svg(800, 640).unwrap().contains("beyond"));
    assert!(!chart(4.0).svg(800, 640).unwrap().contains("beyond"));
    assert!(chart(1e9).svg(800, 640).unwrap().contains(">1 beyond the axes<"));
    let place = |chart: QqPlot| discs(&chart.svg(800, 640).unwrap(), 3.0)[0];
    assert_eq!(place(chart(1e9)), place(chart(4.0)));
}

#[test]
fn a_plot_without_points_has_axes_and_says_so() {
    let chart =
        QqPlot { series: vec![series("none", &[]), series("nan", &[[f64::NAN, 1.0]])], ..QqPlot::default() };
    let svg = chart.svg(800, 640).unwrap();
    assert!(svg.contains(">none, no points<") && svg.contains(">nan, no points<") && !svg.contains("beyond"));
    assert!(svg.contains(">expected (standard deviations)<") && svg.contains(">observed<"));
    assert!(QqPlot::default().png(100, 100).is_ok());
}

#[test]
fn a_band_is_cut_at_the_axes_and_where_it_is_not_known() {
    let line = |svg: &str| {
        let lines = elements(svg).into_iter().filter(|(name, pairs)| {
            name == "line" && pairs.iter().any(|(k, v)| k == "stroke" && v == "#a0a6b4")
        });
        lines
            .map(|(_, pairs)| ["x1", "y1", "x2", "y2"].map(|key| attribute(&pairs, key).unwrap()))
            .collect::<Vec<_>>()
    };
    let chart = QqPlot {
        band: vec![[0.0, 0.0, 1.0], [2.0, 1.0, 5.0], [3.0, 2.0, f64::INFINITY]],
        range: Some([0.0, 3.0]),
        ..QqPlot::default()
    };
    let lines = line(&chart.svg(800, 640).unwrap());
    let [left, top, side] = SQUARE;
    // Lower, upper cut at 3, lower; the last upper one is not known. The fourth is the legend's.
    assert_eq!(lines.len(), 4);
    assert_eq!(lines[1], [left, top + side * 2.0 / 3.0, left + side / 3.0, top]);
}

#[test]
fn an_empty_range_is_an_error() {
    for range in [[1.0, 1.0], [1.0, 0.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
        let chart = QqPlot { range: Some(range), ..QqPlot::default() };
        assert!(matches!(chart.svg(100, 100), Err(DrawError::Range { .. })));
    }
}
