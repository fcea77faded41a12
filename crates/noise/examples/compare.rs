//! How sure sensors are of a wall, straight ahead and at a slant: prints the standard deviation along its normal, in mm.
//!
//! Run with models of your own: `cargo run --example compare -- kinect lidar:range=0.01,angle=0.05deg`

use std::error::Error;

use terrace_noise::{ScanNoise, SensorNoise};

const DEFAULT: [&str; 4] =
    ["uniform:0.01", "kinect", "stereo:fb=32,disparity=0.1,focal=640", "lidar:range=0.02,angle=0.1deg"];

fn main() -> Result<(), Box<dyn Error>> {
    let mut texts: Vec<String> = std::env::args().skip(1).collect();
    if texts.is_empty() {
        texts = DEFAULT.map(str::to_owned).to_vec();
    }
    let depths = [0.5, 1.0, 2.0, 4.0, 8.0];
    for text in &texts {
        let noise: SensorNoise = text.parse()?;
        println!("{noise}, made for depths of {:?} m", noise.valid_depths());
        let scan = ScanNoise::new(noise, Some([0.0; 3]))?.with_axis([0.0, 0.0, 1.0])?;
        for slant in [0.0_f64, 30.0, 60.0] {
            let (sine, cosine) = slant.to_radians().sin_cos();
            let normal = [sine, 0.0, -cosine];
            print!("  {slant:2}° ");
            for z in depths {
                let variance = scan.covariance_on([0.0, 0.0, z], normal).and_then(|c| c.along(normal));
                match variance {
                    Some(variance) => print!("  {z} m: {:6.2}", 1000.0 * variance.sqrt()),
                    None => print!("  {z} m:   none"),
                }
            }
            println!();
        }
    }
    Ok(())
}
