//! The chart of observed against expected distances.

use crate::axis::Axis;
use crate::canvas::{Anchor, Canvas};
use crate::error::DrawError;
use crate::image::Image;
use crate::palette::label_colour;
use crate::pen::{GRID, INK, Pen, TEXT, TITLE};
use crate::raster::Raster;
use crate::svg::Svg;
use terrace_types::PlaneId;

/// Points of one kind in a [`QqPlot`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct QqSeries {
    /// What they are; some 25 letters fit into the legend.
    pub name: String,
    /// Expected and observed distance of each, in standard deviations.
    pub points: Vec<[f64; 2]>,
}

/// A quantile-quantile plot: how large errors are against how large they should be, in standard deviations.
///
/// Both axes have the same scale. Points on the diagonal are as expected; a line above it belongs to errors that are
/// larger than was claimed, a curve that turns upwards at its end to outliers. Points outside the range of the axes stand on
/// its border as open marks, and the legend tells their number. Points that are not finite are left out.
///
/// ```
/// use terrace_draw::{QqPlot, QqSeries};
///
/// let chart = QqPlot {
///     title: "planes of a room".into(),
///     series: vec![QqSeries { name: "walls".into(), points: vec![[0.5, 0.6], [1.0, 1.3], [2.0, 9.0]] }],
///     ..QqPlot::default()
/// };
/// assert!(chart.svg(800, 640)?.contains("1 beyond the axes"));
/// assert_eq!(&chart.png(800, 640)?[1..4], b"PNG");
/// # Ok::<(), terrace_draw::DrawError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct QqPlot {
    /// Above the chart; may be empty.
    pub title: String,
    /// What is compared, each with its colour; later ones are drawn on top.
    pub series: Vec<QqSeries>,
    /// Where observed distances may lie by chance, as expected distance, lower and upper end, in rising order; may be
    /// empty. Drawn as two lines, which end where one of the numbers is not finite.
    pub band: Vec<[f64; 3]>,
    /// The range of both axes. `None`: from zero to the greatest distance, though not beyond twice the greatest expected
    /// one, so that a single outlier does not make all else small.
    pub range: Option<[f64; 2]>,
}

const BAND: [u8; 3] = [160, 166, 180];

/// A chart is laid out on a sheet of this size and scaled to its canvas: all lengths below are in its units.
const SHEET: [f64; 2] = [800.0, 640.0];

/// What is kept free around the square of the axes; the legend stands on the right.
const LEFT: f64 = 76.0;
const TOP: f64 = 60.0;
const RIGHT: f64 = 196.0;
const BOTTOM: f64 = 52.0;

impl QqPlot {
    /// The chart as the text of an SVG file.
    ///
    /// # Errors
    /// [`DrawError::Size`] for an impossible size, [`DrawError::Range`] for an empty range.
    pub fn svg(&self, width: usize, height: usize) -> Result<String, DrawError> {
        let mut svg = Svg::new(width, height)?;
        self.draw(&mut svg)?;
        Ok(svg.finish())
    }

    /// The chart as the bytes of a PNG file.
    ///
    /// # Errors
    /// As for [`QqPlot::svg`], and [`DrawError::Png`] when the encoder fails.
    pub fn png(&self, width: usize, height: usize) -> Result<Vec<u8>, DrawError> {
        self.image(width, height)?.png()
    }

    /// The chart as a picture, to be put together with others.
    ///
    /// # Errors
    /// As for [`QqPlot::svg`].
    pub fn image(&self, width: usize, height: usize) -> Result<Image, DrawError> {
        let mut raster = Raster::new(width, height)?;
        self.draw(&mut raster)?;
        Ok(raster.into_image())
    }

    /// Draws the chart over the whole of a canvas.
    ///
    /// # Errors
    /// [`DrawError::Range`] for an empty range.
    pub fn draw<C: Canvas>(&self, canvas: &mut C) -> Result<(), DrawError> {
        let range @ [low, high] = self.range.unwrap_or_else(|| self.whole_range());
        if !(low.is_finite() && high.is_finite() && low < high) {
            return Err(DrawError::Range { low, high });
        }
        let [width, height] = canvas.size();
        let unit = (width / SHEET[0]).min(height / SHEET[1]);
        // A square as large as it fits; what is left of a wide sheet is divided between the sides.
        let side = (width - (LEFT + RIGHT) * unit).min(height - (TOP + BOTTOM) * unit);
        let left = LEFT * unit + (width - (LEFT + RIGHT) * unit - side) / 2.0;
        let top = TOP * unit + (height - (TOP + BOTTOM) * unit - side) / 2.0;
        let x = Axis::new(low, high, left, left + side);
        let y = Axis::new(low, high, top + side, top);
        let pen = &mut Pen { canvas, unit };

        self.frame(pen, [left, top], side, [&x, &y]);
        for pair in self.band.windows(2) {
            if let [a, b] = pair {
                for end in [1, 2] {
                    if let Some([from, to]) = within([[a[0], a[end]], [b[0], b[end]]], range) {
                        let place = |[e, o]: [f64; 2]| [x.place(e), y.place(o)];
                        pen.line(place(from), place(to), 1.5, BAND);
                    }
                }
            }
        }
        let mut counts = Vec::new();
        for (number, series) in self.series.iter().enumerate() {
            let finite = || series.points.iter().filter(|p| p.iter().all(|v| v.is_finite()));
            let place = |[e, o]: &[f64; 2]| [x.place(*e), y.place(*o)];
            let inside = |p: &&[f64; 2]| p.iter().all(|v| (low..=high).contains(v));
            for point in finite().filter(inside) {
                pen.disc(place(point), 3.0, series_colour(number));
            }
            counts.push((finite().count(), finite().filter(|p| !inside(p)).count()));
        }
        // Over the points: honest ones would hide it.
        pen.line([left, top + side], [left + side, top], 1.0, INK);
        // Those on the border lie on top of all: there are few, and none may be overlooked.
        for (number, series) in self.series.iter().enumerate() {
            let out = |p: &&[f64; 2]| {
                p.iter().all(|v| v.is_finite()) && !p.iter().all(|v| (low..=high).contains(v))
            };
            for [expected, observed] in series.points.iter().filter(out) {
                pen.ring([x.place(*expected), y.place(*observed)], 4.5, 1.5, series_colour(number));
            }
        }
        self.legend(pen, left + side + 20.0 * unit, top + 8.0 * unit, &counts);
        Ok(())
    }

    /// From zero to the greatest distance, but not beyond twice the greatest expected one.
    fn whole_range(&self) -> [f64; 2] {
        let points = || {
            let points = self.series.iter().flat_map(|series| &series.points);
            points.filter(|point| point.iter().all(|v| v.is_finite()))
        };
        let expected = points().map(|[expected, _]| *expected).fold(0.0, f64::max);
        let greatest = points().map(|[_, observed]| *observed).fold(expected, f64::max);
        // Halves, for the largest numbers there are; a little more than the greatest keeps it off the frame.
        let high = (greatest / 2.0).min(expected).min(f64::MAX / 4.0) * 2.1;
        if high > f64::MIN_POSITIVE * 1e6 { [0.0, high] } else { [0.0, 3.0] }
    }

    /// Title, grid, ticks and labels of the axes.
    fn frame<C: Canvas>(&self, pen: &mut Pen<'_, C>, [left, top]: [f64; 2], side: f64, [x, y]: [&Axis; 2]) {
        let (unit, right, bottom) = (pen.unit, left + side, top + side);
        let middle = f64::midpoint(left, right);
        pen.text([middle, top - 40.0 * unit], &self.title, TITLE, Anchor::Middle);
        for (value, label) in x.ticks(8) {
            let at = x.place(value);
            pen.line([at, top], [at, bottom], 1.0, GRID);
            pen.text([at, bottom + 14.0 * unit], &label, TEXT, Anchor::Middle);
        }
        for (value, label) in y.ticks(8) {
            let at = y.place(value);
            pen.line([left, at], [right, at], 1.0, GRID);
            pen.text([left - 8.0 * unit, at], &label, TEXT, Anchor::End);
        }
        pen.line([left, bottom], [right, bottom], 1.0, INK);
        pen.line([left, top], [left, bottom], 1.0, INK);
        pen.text([middle, bottom + 36.0 * unit], "expected (standard deviations)", TEXT, Anchor::Middle);
        pen.text([left, top - 14.0 * unit], "observed", TEXT, Anchor::End);
    }

    /// The names, each with its mark, and how many points are beyond the axes; `counts` are of all points and of these.
    fn legend<C: Canvas>(&self, pen: &mut Pen<'_, C>, left: f64, top: f64, counts: &[(usize, usize)]) {
        let unit = pen.unit;
        let mut row = top;
        let mut entry = |pen: &mut Pen<'_, C>, text: &str, mark: &dyn Fn(&mut Pen<'_, C>, [f64; 2])| {
            mark(pen, [left, row]);
            pen.text([left + 14.0 * unit, row], text, TEXT, Anchor::Start);
            row += 22.0 * unit;
        };
        for (number, (series, (all, beyond))) in self.series.iter().zip(counts).enumerate() {
            let name = if *all == 0 { &format!("{}, no points", series.name) } else { &series.name };
            entry(pen, name, &|p, centre| p.disc(centre, 4.0, series_colour(number)));
            if *beyond > 0 {
                let text = format!("{beyond} beyond the axes");
                entry(pen, &text, &|p, centre| p.ring(centre, 4.5, 1.5, series_colour(number)));
            }
        }
        let dash = |p: &mut Pen<'_, C>, [x, y]: [f64; 2], thick, colour| {
            p.line([x - 7.0 * unit, y], [x + 7.0 * unit, y], thick, colour);
        };
        entry(pen, "as expected", &|p, centre| dash(p, centre, 1.0, INK));
        if self.band.len() > 1 {
            entry(pen, "by chance", &|p, centre| dash(p, centre, 1.5, BAND));
        }
    }
}

/// The colour of a series: that of the plane with its number.
fn series_colour(number: usize) -> [u8; 3] {
    label_colour(PlaneId::from_index(number))
}

/// The part of a line within a square of this range on both axes; `None` when there is none.
fn within([from, to]: [[f64; 2]; 2], [low, high]: [f64; 2]) -> Option<[[f64; 2]; 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let (a, b) = (from[axis], to[axis]);
        let step = b - a;
        if !step.is_finite() {
            return None;
        }
        if step == 0.0 {
            if !(low..=high).contains(&a) {
                return None;
            }
            continue;
        }
        let (s, t) = ((low - a) / step, (high - a) / step);
        enter = enter.max(s.min(t));
        leave = leave.min(s.max(t));
    }
    let at = |share: f64| [0, 1].map(|i| from[i] + share * (to[i] - from[i]));
    (enter < leave).then(|| [at(enter), at(leave)])
}
