//! A depth camera looks down at a floor: from its own frame to the world, with errors, absences and labels.

use terrace_types::{Frame, Plane, PlaneId, Pose, Scan, Sigma};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The camera hangs 2 m above the floor and looks straight down: half a turn about x.
    let camera = Pose::from_quaternion([5.0, 1.0, 2.0], [1.0, 0.0, 0.0, 0.0])?;
    // Four pixels. One saw nothing; one saw a box of 30 cm. Depth is known worse than the two other axes.
    let pixels = vec![[-0.5, 0.0, 2.001], [0.0, 0.0, 1.999], [f64::NAN; 3], [0.5, 0.0, 1.7]];
    let errors = vec![[0.001, 0.001, 0.006]; 4];
    let scan = Scan::new(pixels, Sigma::PerAxis(errors), Frame::Sensor { pose: camera })?;

    let floor = Plane::through([0.0; 3], [0.0, 0.0, 1.0])?;
    let id = PlaneId::from_index(0);

    println!("{} pixels, {} of them measured", scan.len(), scan.present());
    println!("{:>5}  {:>22}  {:>11}  {:>10}  label", "pixel", "world position (m)", "height (m)", "sigma z");
    for (pixel, point) in scan.world_points().enumerate() {
        let Some(point) = point else {
            println!("{pixel:>5}  {:>22}  {:>11}  {:>10}  {}", "nothing seen", "", "", PlaneId::label(None));
            continue;
        };
        let height = floor.signed_distance(point.position);
        let sigma = point.sigma.map_or(f64::NAN, |s| s[2]);
        // Of the floor when within three standard errors.
        let label = if height.abs() <= 3.0 * sigma { id } else { None };
        let [x, y, z] = point.position;
        println!(
            "{pixel:>5}  {:>22}  {height:>11.3}  {sigma:>10.3}  {}",
            format!("({x:.3}, {y:.3}, {z:.3})"),
            PlaneId::label(label)
        );
    }

    let wrong = Pose::new([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]], [0.0; 3]);
    println!("\nWhat cannot be meant is refused where it enters:");
    match wrong {
        Ok(pose) => println!("  {pose:?}"),
        Err(error) => println!("  {error}"),
    }
    Ok(())
}
