//! From staircases of pixels to straight lines.

use i_overlay::i_float::int::point::IntPoint;

/// The middle of each pixel side along a ring. Through these, a slanted border is a line with as much area on either
/// side, and rings that meet in a corner of pixels come apart.
pub(crate) fn midpoints(corners: &[IntPoint<i32>]) -> Vec<[f64; 2]> {
    let mut points = Vec::new();
    for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (dx, dy) = ((b.x - a.x).signum(), (b.y - a.y).signum());
        // Sides of pixels are along one axis.
        let length = (b.x - a.x).abs().max((b.y - a.y).abs());
        points.extend((0..length).map(|k| {
            [(a.x + k * dx, dx), (a.y + k * dy, dy)].map(|(at, step)| f64::from(at) + 0.5 * f64::from(step))
        }));
    }
    points
}

/// The ring with fewer points: those that keep every point within the tolerance (Douglas and Peucker), then moved to
/// where the lines through the points between them meet, so that borders are not moved in or out.
pub(crate) fn straightened(ring: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let Some(start) = farthest(ring, mean(ring)) else { return Vec::new() };
    let mut ring = ring.to_vec();
    ring.rotate_left(start);
    // The first point once more, as the last.
    ring.extend(ring.first().copied());
    let kept = kept(&ring, tolerance);
    // Two points and the first again: smaller than the tolerance.
    if kept.len() < 4 {
        ring.pop();
        return ring;
    }
    let lines: Vec<Line> =
        kept.windows(2).filter_map(|ends| ring.get(ends[0]..=ends[1])).map(Line::through).collect();
    let before = lines.iter().cycle().skip(lines.len() - 1);
    kept.iter()
        .zip(before.zip(&lines))
        .filter_map(|(&k, (before, after))| Some(before.corner(after, *ring.get(k)?, 2.0 * tolerance)))
        .collect()
}

/// Indices of the points to keep of an open or closed line, with first and last. Without recursion: rings can be long.
fn kept(line: &[[f64; 2]], tolerance: f64) -> Vec<usize> {
    let mut kept = vec![0];
    let mut open = vec![(0, line.len() - 1)];
    while let Some((first, last)) = open.pop() {
        let Some(between) = line.get(first..=last).filter(|between| between.len() > 2) else {
            kept.push(last);
            continue;
        };
        let (a, b) = (between[0], between[between.len() - 1]);
        let mut most = (tolerance, None);
        for (k, p) in between.iter().enumerate() {
            let distance = from_segment(*p, a, b);
            if distance > most.0 {
                most = (distance, Some(first + k));
            }
        }
        match most.1 {
            // The part nearer the start is done first, so that indices come in order.
            Some(k) => open.extend([(k, last), (first, k)]),
            None => kept.push(last),
        }
    }
    kept
}

/// A line through a point along a unit vector.
#[derive(Debug, Clone, Copy)]
struct Line {
    point: [f64; 2],
    along: [f64; 2],
}

impl Line {
    /// The line with the least squared distances from these points. First and last are left out where there are others:
    /// at corners of pixels they are cut.
    fn through(points: &[[f64; 2]]) -> Self {
        let points = match points {
            [_, inner @ .., _] if inner.len() >= 2 => inner,
            all => all,
        };
        let point = mean(points);
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for p in points {
            let (x, y) = (p[0] - point[0], p[1] - point[1]);
            xx += x * x;
            xy += x * y;
            yy += y * y;
        }
        let (sin, cos) = (f64::atan2(2.0 * xy, xx - yy) / 2.0).sin_cos();
        Self { point, along: [cos, sin] }
    }

    fn foot(&self, p: [f64; 2]) -> [f64; 2] {
        let t = (p[0] - self.point[0]) * self.along[0] + (p[1] - self.point[1]) * self.along[1];
        [self.point[0] + t * self.along[0], self.point[1] + t * self.along[1]]
    }

    /// Where two lines meet, if that is near `old`; else half-way between the feet of `old` on both.
    fn corner(&self, other: &Self, old: [f64; 2], near: f64) -> [f64; 2] {
        let turn = self.along[0] * other.along[1] - self.along[1] * other.along[0];
        let apart = [other.point[0] - self.point[0], other.point[1] - self.point[1]];
        let t = (apart[0] * other.along[1] - apart[1] * other.along[0]) / turn;
        let meeting = [self.point[0] + t * self.along[0], self.point[1] + t * self.along[1]];
        // Parallel lines meet nowhere: t is not finite, and neither is the distance.
        if distance(meeting, old) <= near {
            return meeting;
        }
        let (a, b) = (self.foot(old), other.foot(old));
        [f64::midpoint(a[0], b[0]), f64::midpoint(a[1], b[1])]
    }
}

fn mean(points: &[[f64; 2]]) -> [f64; 2] {
    // From the first point: sums far from the origin would cost digits.
    let Some(&[x, y]) = points.first() else { return [0.0; 2] };
    let sum = points.iter().fold([0.0; 2], |sum, p| [sum[0] + (p[0] - x), sum[1] + (p[1] - y)]);
    let count = points.len() as f64;
    [x + sum[0] / count, y + sum[1] / count]
}

/// Index of the first of the points farthest from `centre`.
fn farthest(points: &[[f64; 2]], centre: [f64; 2]) -> Option<usize> {
    let mut most = None;
    for (k, p) in points.iter().enumerate() {
        let distance = distance(*p, centre);
        if most.is_none_or(|(_, d)| distance > d) {
            most = Some((k, distance));
        }
    }
    most.map(|(k, _)| k)
}

fn from_segment(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let squared = dx * dx + dy * dy;
    if squared == 0.0 {
        return distance(p, a);
    }
    let t = (((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / squared).clamp(0.0, 1.0);
    distance(p, [a[0] + t * dx, a[1] + t * dy])
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
