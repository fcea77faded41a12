//! A cell size from a scan that comes in chunks.

use terrace_noise::PoseNoise;
use terrace_types::{Frame, Scan, Sigma};

use crate::CellSizeChoice;
use crate::cell_size::choose_by_share;
use crate::close_up::{BATCH, CloseUp};

/// So many points are kept at most.
const MOST: usize = 1 << 20;

/// Chooses a cell size from a scan that comes in chunks, in bounded memory: about the one that
/// [`choose_cell_size`](crate::choose_cell_size) chooses from all of it, and the very same up to 2²⁰ points.
///
/// Of more points a share is kept, half a million to a million, which are drawn by their numbers: not every so-many-th, which of a scan in rows may
/// all be in one column. The spacing of all is that of the share times its root, for points lie on surfaces; the noise is what the
/// share shows, so it is found to about twice the spacing of the share. In a large place the points of a share are as far apart as walls,
/// and these are not noise: of some small parts of the place all points are kept, too, and spacing and noise are theirs, or those of one in
/// four of them, where the noise is well below the spacing.
///
/// ```
/// use terrace::{CellSizeSample, Frame, Scan, Sigma, choose_cell_size};
///
/// let floor = |from: u32, to: u32| {
///     let point = |k: u32| [0.02 * f64::from(k % 100), 0.02 * f64::from(k / 100), 0.0];
///     Scan::new((from..to).map(point).collect(), Sigma::Unknown, Frame::World { sensor: None })
/// };
/// let mut sample = CellSizeSample::new(None);
/// sample.push(&floor(0, 6000)?);
/// sample.push(&floor(6000, 10_000)?);
/// assert_eq!(sample.choose(), choose_cell_size(&floor(0, 10_000)?));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct CellSizeSample {
    pose: Option<PoseNoise>,
    frame: Option<Frame>,
    /// Points whose scrambled numbers are below a threshold, which is halved when there are too many.
    threshold: u64,
    numbers: Vec<u64>,
    points: Vec<[f64; 3]>,
    sigma: Sigma,
    /// Points so far, absent ones included, and those that are not.
    seen: u64,
    present: usize,
    /// From the first point on that is not kept.
    close_up: Option<CloseUp>,
}

impl CellSizeSample {
    /// Of a scan whose pose is known to within `pose`, as for [`Mapper::insert_from`](crate::Mapper::insert_from).
    pub fn new(pose: Option<PoseNoise>) -> Self {
        Self {
            pose,
            frame: None,
            threshold: u64::MAX,
            numbers: Vec::new(),
            points: Vec::new(),
            sigma: Sigma::Unknown,
            seen: 0,
            present: 0,
            close_up: None,
        }
    }

    /// Adds the next points. All chunks have the frame of the first; where their errors are of several kinds, those of the first kind
    /// alone are looked at.
    pub fn push(&mut self, chunk: &Scan) {
        if self.frame.is_none() {
            self.frame = Some(chunk.frame());
            self.sigma = match chunk.sigma() {
                Sigma::PerPoint(_) => Sigma::PerPoint(Vec::new()),
                Sigma::PerAxis(_) => Sigma::PerAxis(Vec::new()),
                Sigma::Covariance(_) => Sigma::Covariance(Vec::new()),
                same => same.clone(),
            };
        }
        for (batch, points) in chunk.points().chunks(BATCH).enumerate() {
            // One of these may be the first that is not kept.
            let one_by_one = self.close_up.is_none() && self.points.len() + points.len() > MOST;
            if let Some(close_up) = &mut self.close_up {
                close_up.push_all(points);
            }
            let mut numbers = [0; BATCH];
            // The same instructions, for more numbers at a time where the processor can.
            let look = Look { points, seen: self.seen, numbers: &mut numbers };
            self.present += pulp::Arch::new().dispatch(look);
            self.seen += points.len() as u64;
            if one_by_one {
                for (at, point) in points.iter().enumerate() {
                    if let Some(close_up) = &mut self.close_up {
                        close_up.push(*point);
                    }
                    self.keep_drawn(numbers[at], *point, chunk.sigma(), batch * BATCH + at);
                }
                continue;
            }
            // Which are drawn cannot be predicted: they are picked without a branch. Fewer may be drawn since then.
            let (mut drawn, mut count) = ([0; BATCH], 0);
            for (at, number) in numbers.iter().enumerate().take(points.len()) {
                drawn[count] = at;
                count += usize::from(*number <= self.threshold);
            }
            for at in &drawn[..count] {
                self.keep_drawn(numbers[*at], points[*at], chunk.sigma(), batch * BATCH + at);
            }
        }
    }

    /// Points so far that are not absent.
    pub fn present(&self) -> usize {
        self.present
    }

    /// The choice; `None` when there are too few points, or most are in one place.
    pub fn choose(self) -> Option<CellSizeChoice> {
        let Self { pose, frame, points, sigma, present, close_up, .. } = self;
        let scan = Scan::new(points, sigma, frame?).ok()?;
        let share = scan.present() as f64 / present as f64;
        choose_by_share(&scan, pose.as_ref(), share, close_up.as_ref())
    }

    /// Keeps a point, if it is drawn by its number: that at a place of its chunk.
    fn keep_drawn(&mut self, number: u64, point: [f64; 3], errors: &Sigma, at: usize) {
        if number > self.threshold {
            return;
        }
        match (&mut self.sigma, errors) {
            (Sigma::PerPoint(kept), Sigma::PerPoint(all)) => kept.extend(all.get(at)),
            (Sigma::PerAxis(kept), Sigma::PerAxis(all)) => kept.extend(all.get(at)),
            (Sigma::Covariance(kept), Sigma::Covariance(all)) => kept.extend(all.get(at)),
            (Sigma::Unknown | Sigma::Uniform(_), _) => {}
            _ => return,
        }
        self.numbers.push(number);
        self.points.push(point);
        if self.points.len() > MOST && self.close_up.is_none() {
            self.close_up = Some(CloseUp::of(&self.points));
        }
        while self.points.len() > MOST {
            self.halve();
        }
    }

    /// Half of the share: what is left is as if it had been drawn so from the first point on.
    fn halve(&mut self) {
        self.threshold /= 2;
        let stays: Vec<bool> = self.numbers.iter().map(|number| *number <= self.threshold).collect();
        retain(&mut self.points, &stays);
        match &mut self.sigma {
            Sigma::Unknown | Sigma::Uniform(_) => {}
            Sigma::PerPoint(kept) => retain(kept, &stays),
            Sigma::PerAxis(kept) => retain(kept, &stays),
            Sigma::Covariance(kept) => retain(kept, &stays),
        }
        retain(&mut self.numbers, &stays);
    }
}

/// Scrambles the numbers of some points, of which that of the first is `seen`, and counts those that are not absent.
struct Look<'a> {
    points: &'a [[f64; 3]],
    seen: u64,
    numbers: &'a mut [u64; BATCH],
}

impl pulp::WithSimd for Look<'_> {
    type Output = usize;

    // Into what it is dispatched to.
    #[allow(clippy::inline_always)]
    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> usize {
        for (number, seen) in self.numbers.iter_mut().zip(self.seen..) {
            *number = scrambled(seen);
        }
        let is_present = |[x, y, z]: &[f64; 3]| x.is_finite() & y.is_finite() & z.is_finite();
        self.points.iter().map(|point| usize::from(is_present(point))).sum()
    }
}

/// Leaves those in the list that stay.
fn retain<T: Copy>(list: &mut Vec<T>, stays: &[bool]) {
    // Which stay cannot be predicted: there is no branch.
    let mut kept = 0;
    for (at, stays) in stays.iter().enumerate().take(list.len()) {
        list[kept] = list[at];
        kept += usize::from(*stays);
    }
    list.truncate(kept);
}

/// A number that looks drawn at random, and is the same for the same number (the finaliser of SplitMix64).
// Into what it is dispatched to.
#[allow(clippy::inline_always)]
#[inline(always)]
pub(crate) fn scrambled(number: u64) -> u64 {
    let mix = number.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mix = (mix ^ mix >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let mix = (mix ^ mix >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    mix ^ mix >> 31
}
