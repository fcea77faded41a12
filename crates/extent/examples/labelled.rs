//! Outlines and meshes of labelled points: `labelled points.npy labels.npy spacing folder`. Writes `planes.json`,
//! `planes.ply`, `planes.obj`, `planes.glb` and `planes.svg`.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::Path;

use terrace_extent::{
    Footprint, Mesh, OutlineOptions, PlaneExtent, PlaneFrame, Polygon, suggested_resolution,
};
use terrace_types::Plane;

type Error = Box<dyn std::error::Error>;

/// Points of each label, and where they are.
fn read(points: &str, labels: &str) -> Result<BTreeMap<i32, Vec<[f64; 3]>>, Error> {
    let points = npyz::NpyFile::new(BufReader::new(File::open(points)?))?.into_vec::<f32>()?;
    let labels = npyz::NpyFile::new(BufReader::new(File::open(labels)?))?.into_vec::<i32>()?;
    let mut planes: BTreeMap<i32, Vec<[f64; 3]>> = BTreeMap::new();
    for (point, label) in points.as_chunks::<3>().0.iter().zip(labels) {
        if label > 0 {
            planes.entry(label).or_default().push(point.map(f64::from));
        }
    }
    Ok(planes)
}

/// The plane through the middle of the points and the two that span the largest triangle with it: good enough to look at.
fn plane_of(points: &[[f64; 3]]) -> Result<(Plane, [f64; 3]), Error> {
    let middle = [0, 1, 2].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64);
    let arms = points.iter().map(|p| [0, 1, 2].map(|i| p[i] - middle[i]));
    let length = |a: &[f64; 3]| a[0].hypot(a[1]).hypot(a[2]);
    let first = arms.clone().max_by(|a, b| length(a).total_cmp(&length(b))).ok_or("no points")?;
    let cross = |b: [f64; 3]| {
        [
            first[1] * b[2] - first[2] * b[1],
            first[2] * b[0] - first[0] * b[2],
            first[0] * b[1] - first[1] * b[0],
        ]
    };
    let normal = arms.map(cross).max_by(|a, b| length(a).total_cmp(&length(b))).ok_or("no points")?;
    Ok((Plane::through(middle, normal)?, middle))
}

fn colour(k: usize) -> [u8; 3] {
    [0.0, 2.1, 4.2].map(|phase| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "from 80 to 240")]
        let channel = (160.0 + 80.0 * (2.4 * k as f64 + phase).sin()) as u8;
        channel
    })
}

/// All planes below each other in rows, 100 pixels a metre.
fn svg(out: &mut dyn Write, planes: &[(i32, PlaneExtent)]) -> Result<(), Error> {
    let mut body = String::new();
    let (mut left, mut top, mut height) = (20.0, 40.0, 0.0_f64);
    for (k, (label, extent)) in planes.iter().enumerate() {
        let points = || extent.polygons().iter().flat_map(Polygon::outer);
        let low = [0, 1].map(|i| points().fold(f64::INFINITY, |low, p| low.min(p[i])));
        let high = [0, 1].map(|i| points().fold(f64::NEG_INFINITY, |high, p| high.max(p[i])));
        if !low[0].is_finite() {
            continue;
        }
        if left + 100.0 * (high[0] - low[0]) > 1600.0 {
            (left, top, height) = (20.0, top + height + 50.0, 0.0);
        }
        let mut path = String::new();
        for ring in extent.polygons().iter().flat_map(Polygon::rings) {
            for (at, p) in ring.iter().enumerate() {
                let sign = if at == 0 { 'M' } else { 'L' };
                let (x, y) = (left + 100.0 * (p[0] - low[0]), top + 100.0 * (high[1] - p[1]));
                path += &format!("{sign}{x:.2} {y:.2} ");
            }
            path += "Z ";
        }
        let [r, g, b] = colour(k);
        body += &format!(
            "<path d=\"{path}\" fill=\"rgb({r},{g},{b})\" fill-rule=\"evenodd\" stroke=\"black\" stroke-width=\"1\"/>\n\
             <text x=\"{left:.0}\" y=\"{:.0}\" font-size=\"14\">{label}: {:.3} m²</text>\n",
            top - 8.0,
            extent.area()
        );
        left += (100.0 * (high[0] - low[0])).max(120.0) + 30.0;
        height = height.max(100.0 * (high[1] - low[1]));
    }
    let height = top + height + 20.0;
    writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1700\" height=\"{height:.0}\">\n\
         <rect width=\"1700\" height=\"{height:.0}\" fill=\"white\"/>\n{body}</svg>"
    )?;
    Ok(())
}

fn main() -> Result<(), Error> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [points, labels, spacing, folder] = arguments.as_slice() else {
        return Err("labelled points.npy labels.npy spacing folder".into());
    };
    let spacing: f64 = spacing.parse()?;
    let options = OutlineOptions::for_spacing(spacing);
    let (mut planes, mut mesh) = (Vec::new(), Mesh::new());
    for (k, (label, points)) in read(points, labels)?.into_iter().enumerate() {
        let (plane, middle) = plane_of(&points)?;
        let mut footprint = Footprint::new(PlaneFrame::new(&plane, middle)?, suggested_resolution(spacing))?;
        for point in &points {
            footprint.add(*point)?;
        }
        let extent = PlaneExtent::of(&footprint, &options)?;
        let holes: usize = extent.polygons().iter().map(|p| p.holes().len()).sum();
        let vertices = extent.polygons().iter().flat_map(Polygon::rings).flatten().count();
        println!(
            "plane {label}: {} points, {} polygons, {holes} holes, {vertices} vertices, {:.3} m²",
            points.len(),
            extent.polygons().len(),
            extent.area()
        );
        mesh.add(&extent, colour(k))?;
        planes.push((label, extent));
    }
    let create = |name: &str| File::create(Path::new(folder).join(name)).map(BufWriter::new);
    svg(&mut create("planes.svg")?, &planes)?;
    let extents: BTreeMap<i32, &PlaneExtent> =
        planes.iter().map(|(label, extent)| (*label, extent)).collect();
    serde_json::to_writer(create("planes.json")?, &extents)?;
    mesh.write_ply(&mut create("planes.ply")?)?;
    mesh.write_obj(&mut create("planes.obj")?)?;
    mesh.write_glb(&mut create("planes.glb")?)?;
    Ok(())
}
