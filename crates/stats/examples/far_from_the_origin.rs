//! The scatter of a flat patch, once from plain sums and once relative to an anchor, ever further from the origin.

use terrace_stats::{Moments, Stats, UncertainVector};

/// 400 points of a tile of 20 cm, each 1 mm above or below it.
fn tile() -> impl Iterator<Item = [f64; 3]> {
    (0u32..400).map(|i| {
        let (column, row) = (i % 20, i / 20);
        let height = if (column + row) % 2 == 0 { 0.001 } else { -0.001 };
        [0.01 * f64::from(column), 0.01 * f64::from(row), height]
    })
}

fn main() {
    println!("Standard deviation of the heights of a tile; 1 mm is true.\n");
    println!("{:>16}  {:>16}  {:>16}", "height (m)", "plain sums (mm)", "anchored (mm)");
    for height in [0.0, 1e3, 1e5, 1e6, 1e7] {
        let mut plain = Moments::EMPTY;
        let mut anchored = Stats::new([0.1, 0.1, height]);
        for [x, y, z] in tile() {
            let point = UncertainVector::isotropic([x, y, z + height], 0.001);
            plain.push(&point);
            anchored.push(&point);
        }
        let [plain, anchored] = [plain.covariance(), anchored.covariance()]
            .map(|covariance| covariance.map_or(f64::NAN, |c| 1000.0 * c.get(2, 2).sqrt()));
        println!("{height:>16.0}  {plain:>16.4}  {anchored:>16.4}");
    }

    // Parts add up, whatever their anchors: the two halves of the tile, taken by two machines.
    let mut halves = [Stats::new([0.1, 0.05, 1e6]), Stats::new([0.1, 0.15, 1e6])];
    for [x, y, z] in tile() {
        halves[usize::from(y >= 0.1)].push(&UncertainVector::isotropic([x, y, z + 1e6], 0.001));
    }
    let [mut whole, other] = halves;
    whole.merge(&other);
    println!("\nTwo halves merged: {} points", whole.count());
    if let (Some([_, _, height]), Some(covariance), Some(of_mean)) =
        (whole.mean(), whole.covariance(), whole.covariance_of_mean())
    {
        println!("  mean height       {height:.6} m");
        println!("  scatter           {:.4} mm", 1000.0 * covariance.get(2, 2).sqrt());
        println!("  sure of the mean  {:.4} mm", 1000.0 * of_mean.get(2, 2).sqrt());
    }
    println!("  memory            {} bytes", size_of::<Stats>());
}
