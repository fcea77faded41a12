//! threecrate: the plane of most points by RANSAC, again and again among the points that are left.
//!
//! `terrace-threecrate points.npy labels.npy costs.json [NAME=VALUE...]`; files and costs are those of the C++ programs.
//!
//! * `dist`: of points to their plane
//! * `iters`: places that are tried for a plane
//! * `min`: points of a plane
//! * `planes`: how many at most

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;

use npyz::WriterBuilder as _;
use serde_json::json;
use threecrate_algorithms::segmentation::segment_plane;
use threecrate_core::{Point3f, PointCloud};

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [points, labels, costs, words @ ..] = arguments.as_slice() else {
        return Err("points.npy labels.npy costs.json [NAME=VALUE...]".into());
    };
    let mut settings =
        BTreeMap::from([("dist", 0.03_f32), ("iters", 1000.0), ("min", 500.0), ("planes", 40.0)]);
    for word in words {
        let (name, value) = word.split_once('=').ok_or("NAME=VALUE")?;
        *settings.get_mut(name).ok_or_else(|| format!("unknown setting {word}"))? = value.parse()?;
    }
    let points = read(points)?;
    let (loaded, begin) = (peak()?, cpu()?);
    let found = planes(points, &settings);
    let (end, peak) = (cpu()?, peak()?);
    write(labels, &found)?;
    let used = json!({"cpu_seconds": end - begin, "cpu_normals": 0.0, "loaded_mb": loaded, "peak_mb": peak});
    Ok(fs::write(costs, used.to_string())?)
}

#[allow(clippy::cast_possible_truncation)] // The library has f32 only.
fn read(path: &str) -> Outcome<Vec<Point3f>> {
    let numbers: Vec<f64> = npyz::NpyFile::new(std::io::BufReader::new(fs::File::open(path)?))?.into_vec()?;
    let point = |p: &[f64]| Point3f::new(p[0] as f32, p[1] as f32, p[2] as f32);
    Ok(numbers.chunks_exact(3).map(point).collect())
}

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // Settings are small and not negative.
fn planes(points: Vec<Point3f>, settings: &BTreeMap<&str, f32>) -> Vec<i32> {
    let whole = |name| settings[name] as usize;
    let mut labels = vec![0; points.len()];
    let mut rest: Vec<usize> = (0..points.len()).collect();
    let mut cloud = PointCloud::from_points(points);
    for label in (1..).take(whole("planes")) {
        // It has no plane where too few points are left.
        let Ok(plane) = segment_plane(&cloud, settings["dist"], whole("iters")) else { break };
        if plane.inliers.len() < whole("min") {
            break;
        }
        for &inlier in &plane.inliers {
            labels[rest[inlier]] = label;
        }
        let kept: Vec<usize> = (0..rest.len()).filter(|&k| labels[rest[k]] == 0).collect();
        cloud = PointCloud::from_points(kept.iter().map(|&k| cloud.points[k]).collect());
        rest = kept.into_iter().map(|k| rest[k]).collect();
    }
    labels
}

fn write(path: &str, labels: &[i32]) -> Outcome<()> {
    let mut array = npyz::WriteOptions::new()
        .default_dtype()
        .shape(&[labels.len() as u64])
        .writer(std::io::BufWriter::new(fs::File::create(path)?))
        .begin_nd()?;
    array.extend(labels)?;
    Ok(array.finish()?)
}

/// CPU seconds of all threads, in hundredths.
fn cpu() -> Outcome<f64> {
    let stat = fs::read_to_string("/proc/self/stat")?;
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(2);
    let ticks: Vec<f64> = fields.map(str::parse).collect::<Result<_, _>>()?;
    Ok(ticks.iter().sum::<f64>() / 100.0)
}

/// The most memory in use so far, in MiB.
fn peak() -> Outcome<f64> {
    let status = fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).ok_or("no VmHWM")?;
    Ok(line.trim().trim_end_matches(" kB").parse::<f64>()? / 1024.0)
}
