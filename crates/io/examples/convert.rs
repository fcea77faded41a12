//! Tells what is in a file of points, or writes scans as one PLY in world coordinates, one colour for each scan:
//!
//! ```sh
//! cargo run -p terrace-io --example convert -- info FILE [fx,fy,cx,cy]
//! cargo run -p terrace-io --example convert -- INPUT OUT.ply [fx,fy,cx,cy]
//! ```

use std::error::Error;
use std::path::Path;

use terrace_io::{
    Info, LabelledPoint, PlyExtent, ReadOptions, find_sources, inspect, read_scan, write_labelled_ply,
};
use terrace_types::{PlaneId, Scan};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let mut options = ReadOptions::default();
    if let Some(camera) = arguments.get(2) {
        options.intrinsics = Some(camera.parse()?);
    }
    match arguments[..] {
        ["info", file, ..] => tell(&inspect(Path::new(file), &options)?),
        [input, out, ..] => {
            let scans: Result<Vec<Scan>, _> =
                find_sources(&[input], None)?.iter().map(|source| read_scan(source, &options)).collect();
            convert(&scans?, Path::new(out))?;
        }
        _ => eprintln!("usage: convert info FILE [fx,fy,cx,cy] | convert INPUT OUT.ply [fx,fy,cx,cy]"),
    }
    Ok(())
}

fn tell(info: &Info) {
    println!("{}: {} points, {} present", info.format, info.points, info.present);
    if let Some([low, high]) = info.bounds {
        println!("bounds {low:.3?} to {high:.3?} m");
    }
    if let Some(spacing) = info.spacing {
        println!("spacing {spacing:.4} m");
    }
    if let Some([low, high]) = info.sigma {
        println!("sigma {low:.4} to {high:.4} m");
    }
}

fn convert(scans: &[Scan], out: &Path) -> Result<(), Box<dyn Error>> {
    let points = || {
        scans.iter().enumerate().flat_map(|(index, scan)| {
            let plane = PlaneId::from_index(index);
            scan.world_points().flatten().map(move |p| LabelledPoint { position: p.position, plane })
        })
    };
    let extent = PlyExtent::of(points().map(|p| p.position));
    write_labelled_ply(out, extent, points())?;
    println!("{}: {} points", out.display(), extent.points);
    Ok(())
}
