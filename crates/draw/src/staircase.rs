//! The chart of a cost that is constant on intervals.

use crate::axis::Axis;
use crate::canvas::{Anchor, Canvas};
use crate::error::DrawError;
use crate::image::Image;
use crate::pen::{GRID, INK, Pen, TEXT, TITLE};
use crate::raster::Raster;
use crate::svg::Svg;

/// An interval on which the cost is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Where it begins.
    pub low: f64,
    /// Where it ends.
    pub high: f64,
    /// The cost on it.
    pub value: f64,
}

/// A point at which the cost was asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// The point.
    pub x: f64,
    /// The cost there.
    pub value: f64,
    /// Whether the cost was evaluated; otherwise it was known from a step.
    pub evaluated: bool,
}

/// A chart of a staircase: its steps, the samples of a search on it, and the best point found.
///
/// Where no step is given the cost is unknown and the chart has a gap. Steps and samples that are not finite or outside the
/// range of x are left out; steps that cross its border are cut there.
///
/// ```
/// use terrace_draw::{Staircase, Step};
///
/// let chart = Staircase {
///     title: "cost of a threshold".into(),
///     steps: vec![Step { low: 0.0, high: 0.4, value: 2.0 }, Step { low: 0.4, high: 1.0, value: 1.0 }],
///     ..Staircase::new("φ", "β", [0.0, 1.0])
/// };
/// assert!(chart.svg(640, 400)?.contains("cost of a threshold"));
/// assert_eq!(&chart.png(640, 400)?[1..4], b"PNG");
/// # Ok::<(), terrace_draw::DrawError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Staircase {
    /// Above the chart; may be empty.
    pub title: String,
    /// What x is.
    pub x_label: String,
    /// What the cost is.
    pub y_label: String,
    /// The range of x shown.
    pub range: [f64; 2],
    /// Where x has ticks, such as the only values it can take; empty: at round numbers. A label that would touch the one
    /// before is left out.
    pub ticks: Vec<f64>,
    /// Where the cost is known.
    pub steps: Vec<Step>,
    /// Where it was asked for.
    pub samples: Vec<Sample>,
    /// The best point, as x and cost.
    pub best: Option<[f64; 2]>,
}

const STEP: [u8; 3] = [38, 99, 166];
const EVALUATED: [u8; 3] = [214, 96, 36];
const KNOWN: [u8; 3] = [140, 146, 158];
const BEST: [u8; 3] = [30, 140, 70];

/// A chart is laid out on a sheet of this size and scaled to its canvas: all lengths below are in its units.
const SHEET: [f64; 2] = [800.0, 480.0];

impl Staircase {
    /// A chart without content.
    pub fn new(x_label: &str, y_label: &str, range: [f64; 2]) -> Self {
        Self {
            title: String::new(),
            x_label: x_label.to_owned(),
            y_label: y_label.to_owned(),
            range,
            ticks: Vec::new(),
            steps: Vec::new(),
            samples: Vec::new(),
            best: None,
        }
    }

    /// The chart as the text of an SVG file.
    ///
    /// # Errors
    /// [`DrawError::Size`] for an impossible size, [`DrawError::Range`] for an empty range of x.
    pub fn svg(&self, width: usize, height: usize) -> Result<String, DrawError> {
        let mut svg = Svg::new(width, height)?;
        self.draw(&mut svg)?;
        Ok(svg.finish())
    }

    /// The chart as the bytes of a PNG file.
    ///
    /// # Errors
    /// As for [`Staircase::svg`], and [`DrawError::Png`] when the encoder fails.
    pub fn png(&self, width: usize, height: usize) -> Result<Vec<u8>, DrawError> {
        self.image(width, height)?.png()
    }

    /// The chart as a picture, to be put together with others.
    ///
    /// # Errors
    /// As for [`Staircase::svg`].
    pub fn image(&self, width: usize, height: usize) -> Result<Image, DrawError> {
        let mut raster = Raster::new(width, height)?;
        self.draw(&mut raster)?;
        Ok(raster.into_image())
    }

    /// Draws the chart over the whole of a canvas.
    ///
    /// # Errors
    /// [`DrawError::Range`] for an empty range of x.
    pub fn draw<C: Canvas>(&self, canvas: &mut C) -> Result<(), DrawError> {
        let [low, high] = self.range;
        if !(low.is_finite() && high.is_finite() && low < high) {
            return Err(DrawError::Range { low, high });
        }
        let [width, height] = canvas.size();
        let unit = (width / SHEET[0]).min(height / SHEET[1]);
        let (left, right, top, bottom) =
            (76.0 * unit, width - 24.0 * unit, 66.0 * unit, height - 52.0 * unit);
        let steps: Vec<Step> = self.steps.iter().filter_map(|step| within(step, self.range)).collect();
        let samples: Vec<Sample> =
            self.samples.iter().copied().filter(|s| shown(s.x, s.value, self.range)).collect();
        let best = self.best.filter(|[x, value]| shown(*x, *value, self.range));
        let values = || {
            let steps = steps.iter().map(|step| step.value);
            steps.chain(samples.iter().map(|s| s.value)).chain(best.map(|[_, value]| value))
        };
        let (least, most) = values().fold((f64::MAX, -f64::MAX), |(a, b), v| (a.min(v), b.max(v)));
        let (least, most) = if least <= most { (least, most) } else { (0.0, 1.0) };
        let x = Axis::new(low, high, left, right);
        // Room below and above, so that no mark lies on the frame.
        let y = Axis::new(least, most, bottom - 14.0 * unit, top + 14.0 * unit);
        let pen = &mut Pen { canvas, unit };

        self.frame(pen, [left, top], [right, bottom], [&x, &y]);
        for pair in steps.windows(2) {
            if let [a, b] = pair
                && (b.low - a.high).abs() <= (high - low).abs() * 1e-9
            {
                pen.line([x.place(b.low), y.place(a.value)], [x.place(b.low), y.place(b.value)], 1.0, STEP);
            }
        }
        for step in &steps {
            pen.line(
                [x.place(step.low), y.place(step.value)],
                [x.place(step.high), y.place(step.value)],
                2.5,
                STEP,
            );
        }
        // Evaluated samples are the fewer and lie on top.
        for sample in samples.iter().filter(|s| !s.evaluated) {
            known(pen, [x.place(sample.x), y.place(sample.value)]);
        }
        for sample in samples.iter().filter(|s| s.evaluated) {
            pen.disc([x.place(sample.x), y.place(sample.value)], 4.0, EVALUATED);
        }
        if let Some([at, value]) = best {
            star(pen, [x.place(at), y.place(value)]);
        }
        self.legend(pen, left, 46.0 * unit);
        Ok(())
    }

    /// Title, grid, ticks and labels of the axes.
    fn frame<C: Canvas>(
        &self,
        pen: &mut Pen<'_, C>,
        [left, top]: [f64; 2],
        [right, bottom]: [f64; 2],
        axes: [&Axis; 2],
    ) {
        let ([x, y], unit) = (axes, pen.unit);
        pen.text([f64::midpoint(left, right), 20.0 * unit], &self.title, TITLE, Anchor::Middle);
        let mut free = f64::MIN;
        for (value, label) in self.x_ticks(x) {
            let at = x.place(value);
            pen.line([at, top], [at, bottom], 1.0, GRID);
            let half = pen.canvas.text_width(&label, TEXT * unit) / 2.0;
            if at - half > free {
                pen.text([at, bottom + 14.0 * unit], &label, TEXT, Anchor::Middle);
                free = at + half + 6.0 * unit;
            }
        }
        for (value, label) in y.ticks(7) {
            let at = y.place(value);
            pen.line([left, at], [right, at], 1.0, GRID);
            pen.text([left - 8.0 * unit, at], &label, TEXT, Anchor::End);
        }
        pen.line([left, bottom], [right, bottom], 1.0, INK);
        pen.line([left, top], [left, bottom], 1.0, INK);
        pen.text([f64::midpoint(left, right), bottom + 36.0 * unit], &self.x_label, TEXT, Anchor::Middle);
        pen.text([left, top - 12.0 * unit], &self.y_label, TEXT, Anchor::End);
    }

    /// The ticks of x with their labels, in rising order.
    fn x_ticks(&self, x: &Axis) -> Vec<(f64, String)> {
        if self.ticks.is_empty() {
            return x.ticks(10);
        }
        let [low, high] = self.range;
        let mut ticks: Vec<f64> = self.ticks.iter().copied().filter(|x| (low..=high).contains(x)).collect();
        ticks.sort_by(f64::total_cmp);
        ticks.into_iter().map(|value| (value, short(value))).collect()
    }

    /// What the marks mean, those that occur.
    fn legend<C: Canvas>(&self, pen: &mut Pen<'_, C>, left: f64, at: f64) {
        let unit = pen.unit;
        let mut place = left + 24.0 * unit;
        let mut entry = |pen: &mut Pen<'_, C>, text: &str, mark: &dyn Fn(&mut Pen<'_, C>, [f64; 2])| {
            mark(pen, [place, at]);
            pen.text([place + 14.0 * unit, at], text, TEXT, Anchor::Start);
            place += 44.0 * unit + pen.canvas.text_width(text, TEXT * unit);
        };
        if !self.steps.is_empty() {
            entry(pen, "cost, where known", &|p, [x, y]| {
                p.line([x - 8.0 * unit, y], [x + 8.0 * unit, y], 2.5, STEP);
            });
        }
        if self.samples.iter().any(|s| s.evaluated) {
            entry(pen, "evaluated", &|p, centre| p.disc(centre, 4.0, EVALUATED));
        }
        if self.samples.iter().any(|s| !s.evaluated) {
            entry(pen, "known from a step", &|p, centre| known(p, centre));
        }
        if self.best.is_some() {
            entry(pen, "best", &|p, centre| star(p, centre));
        }
    }
}

/// The mark of a sample that needed no evaluation.
fn known<C: Canvas>(pen: &mut Pen<'_, C>, centre: [f64; 2]) {
    pen.ring(centre, 3.5, 1.5, KNOWN);
}

/// The mark of the best point: a ring on a cross.
fn star<C: Canvas>(pen: &mut Pen<'_, C>, centre: [f64; 2]) {
    let [x, y] = centre;
    for [dx, dy] in [[9.0, 0.0], [0.0, 9.0]].map(|d| d.map(|d: f64| d * pen.unit)) {
        pen.line([x - dx, y - dy], [x + dx, y + dy], 1.5, BEST);
    }
    pen.ring(centre, 6.0, 3.0, BEST);
}

/// A number with at most four significant digits.
fn short(value: f64) -> String {
    let rounded = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e6).contains(&rounded.abs()) {
        rounded.to_string()
    } else {
        format!("{rounded:e}")
    }
}

fn shown(x: f64, value: f64, [low, high]: [f64; 2]) -> bool {
    value.is_finite() && (low..=high).contains(&x)
}

/// The part of a step within the range; `None` when there is none.
fn within(step: &Step, [low, high]: [f64; 2]) -> Option<Step> {
    let cut = Step { low: step.low.max(low), high: step.high.min(high), value: step.value };
    let known = !step.low.is_nan() && !step.high.is_nan() && step.value.is_finite();
    (known && cut.low <= cut.high).then_some(cut)
}
