//! Properties of the charts.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::float_cmp, reason = "tests")]

mod common;

use common::{any_value, attribute, elements};
use proptest::prelude::*;
use terrace_draw::{Canvas, DrawError, Sample, Staircase, Step, Svg};

prop_compose! {
    fn any_chart()(
        title: String, x_label in ".{0,8}", y_label in ".{0,8}",
        range in (any_value(), any_value()).prop_filter_map("no range", |(a, b)| (a.is_finite() && b.is_finite() && a < b).then_some([a, b])),
        steps in prop::collection::vec((any_value(), any_value(), any_value()), 0..20),
        samples in prop::collection::vec((any_value(), any_value(), any::<bool>()), 0..20),
        best in prop::option::of(prop::array::uniform2(any_value())),
    ) -> Staircase {
        Staircase {
            title,
            steps: steps.into_iter().map(|(low, high, value)| Step { low, high, value }).collect(),
            samples: samples.into_iter().map(|(x, value, evaluated)| Sample { x, value, evaluated }).collect(),
            best,
            ..Staircase::new(&x_label, &y_label, range)
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn every_chart_is_well_formed_and_stays_on_its_sheet(chart in any_chart(), width in 200..2_000_usize, height in 200..2_000_usize) {
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
        prop_assert!(!svg.contains("NaN") || chart.title.contains("NaN") || chart.x_label.contains("NaN"));
    }

    #[test]
    fn every_chart_can_be_drawn_as_png_of_its_size(chart in any_chart(), width in 1..200_usize, height in 1..200_usize) {
        let bytes = chart.png(width, height).unwrap();
        let reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        prop_assert_eq!((reader.info().width as usize, reader.info().height as usize), (width, height));
    }

    #[test]
    fn text_survives_escaping(text in "[a-z<>&\"' ]{1,20}") {
        let mut svg = Svg::new(100, 100).unwrap();
        svg.text([50.0, 50.0], &text, 10.0, terrace_draw::Anchor::Middle, [0; 3]);
        let document = svg.finish();
        elements(&document);
        let start = document.find("<text").map(|at| at + document[at..].find('>').unwrap() + 1).unwrap();
        let shown = &document[start..document.find("</text>").unwrap()];
        let plain = shown.replace("&lt;", "<").replace("&gt;", ">").replace("&quot;", "\"").replace("&amp;", "&");
        prop_assert_eq!(plain, text);
    }
}

/// The horizontal thick lines of a chart, as their ends and height.
fn drawn_steps(svg: &str) -> Vec<[f64; 3]> {
    let lines = elements(svg).into_iter().filter(|(name, pairs)| {
        name == "line" && pairs.iter().any(|(k, v)| k == "stroke-width" && v == "2.50")
    });
    lines.map(|(_, pairs)| ["x1", "x2", "y1"].map(|key| attribute(&pairs, key).unwrap())).collect()
}

#[test]
fn every_step_is_drawn_at_its_place() {
    let values = [3.0, 1.0, 2.0];
    let steps = [(0.0, 0.25), (0.25, 0.5), (0.75, 1.0)];
    let chart = Staircase {
        steps: steps
            .iter()
            .zip(values)
            .map(|((low, high), value)| Step { low: *low, high: *high, value })
            .collect(),
        ..Staircase::new("x", "cost", [0.0, 1.0])
    };
    let drawn = drawn_steps(&chart.svg(800, 480).unwrap());
    // Three steps and the legend.
    assert_eq!(drawn.len(), 4);
    let place = |x: f64| 76.0 + x * 700.0;
    for ([from, to, _], (low, high)) in drawn.iter().zip(steps) {
        assert!((from - place(low)).abs() < 0.01 && (to - place(high)).abs() < 0.01);
    }
    // Lower costs are drawn lower, and in proportion.
    assert!(drawn[0][2] < drawn[2][2] && drawn[2][2] < drawn[1][2]);
    assert!((drawn[0][2] + drawn[1][2] - 2.0 * drawn[2][2]).abs() < 0.03);
}

#[test]
fn steps_are_cut_at_the_range_and_left_out_beyond_it() {
    let step = |low, high| Step { low, high, value: 1.0 };
    let chart = Staircase {
        steps: vec![step(-1.0, 0.5), step(2.0, 3.0), step(f64::NAN, 1.0), step(0.5, f64::INFINITY)],
        ..Staircase::new("x", "cost", [0.0, 1.0])
    };
    let drawn = drawn_steps(&chart.svg(800, 480).unwrap());
    let ends: Vec<_> = drawn.iter().take(drawn.len() - 1).map(|[from, to, _]| [*from, *to]).collect();
    assert_eq!(ends, [[76.0, 426.0], [426.0, 776.0]]);
}

#[test]
fn samples_have_marks_of_two_kinds() {
    let sample = |x, evaluated| Sample { x, value: 1.0, evaluated };
    let chart = Staircase {
        samples: vec![sample(0.2, true), sample(0.7, false)],
        ..Staircase::new("x", "y", [0.0, 1.0])
    };
    let svg = chart.svg(800, 480).unwrap();
    let discs: Vec<_> = elements(&svg).into_iter().filter(|(name, _)| name == "circle").collect();
    let at =
        |x: f64| discs.iter().filter(|(_, pairs)| attribute(pairs, "cx") == Some(76.0 + 700.0 * x)).count();
    assert_eq!([at(0.2), at(0.7)], [1, 2]);
    assert!(svg.contains(">evaluated<") && svg.contains(">known from a step<") && !svg.contains(">best<"));
}

#[test]
fn an_empty_range_is_an_error() {
    for range in [[1.0, 1.0], [1.0, 0.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
        assert!(matches!(Staircase::new("x", "y", range).svg(100, 100), Err(DrawError::Range { .. })));
    }
    assert!(matches!(Staircase::new("x", "y", [0.0, 1.0]).png(0, 5), Err(DrawError::Size { .. })));
}

#[test]
fn ticks_stand_at_the_values_given_and_do_not_touch() {
    let chart = |ticks: &[f64]| {
        let chart = Staircase { ticks: ticks.to_vec(), ..Staircase::new("depth", "cost", [0.5, 3.5]) };
        chart.svg(640, 400).unwrap()
    };
    let labels =
        |svg: &str, of: &[&str]| of.iter().filter(|label| svg.contains(&format!(">{label}<"))).count();
    let svg = chart(&[3.0, 1.0, 2.0, 7.0, f64::NAN]);
    assert_eq!(labels(&svg, &["1", "2", "3"]), 3);
    assert_eq!(labels(&svg, &["7", "NaN", "1.5", "2.5"]), 0);
    let svg = chart(&[1.0, 1.000_1, 2.123_456, 3.5]);
    assert_eq!(labels(&svg, &["1", "2.123", "3.5"]), 3);
    assert_eq!(labels(&svg, &["1.0001", "2.123456"]), 0);
}
