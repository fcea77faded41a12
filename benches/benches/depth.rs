//! Depth images to labels: CPU time of each image, from decoded pixels to planes and the label of each pixel, on one thread.
//!
//! `cargo bench -p terrace-benches --bench depth [-- --unknown]`
//!
//! Images are `roomframe0`, `roomframe1`, 100 frames of `sevenscenes` and `evops_icl` of the data folder, each on its own, with the
//! default settings and the errors of a Kinect; of `evops_icl`, and of all with `--unknown`, errors are found from the image. `image` is
//! the way of images (`terrace_depth`), `cells` that of points (`terrace::Mapper`) for the same pixels. Of five runs on an image the
//! fastest counts, and one for `cells`: what others do on the machine only adds. The median is of `roomframe` and `sevenscenes`.

use std::error::Error;
use std::path::{Path, PathBuf};

use terrace::{Mapper, Params, PlaneId, Scan};
use terrace_benches::{Usage, scenes};
use terrace_depth::{Camera, PlaneFinder, Settings};
use terrace_eval::{Contingency, Evaluation};
use terrace_io::depth::DepthImage;
use terrace_io::{ErrorSource, FieldChoice, Intrinsics, ReadOptions, find_sources, npy, read_scan};
use terrace_noise::SensorNoise;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

const RUNS: usize = 5;
/// Raw units per metre.
const MILLIMETRES: f64 = 1000.0;
const ICL: f64 = 5000.0;

/// Where an image, its camera and its true labels are, and what is known of its depths.
struct Entry {
    name: String,
    image: PathBuf,
    camera: PathBuf,
    truth: Option<PathBuf>,
    units_per_metre: f64,
    noise: Option<SensorNoise>,
}

/// Of an image, by the way of images and that of cells.
struct Row {
    seconds: [f64; 2],
    planes: [usize; 2],
    scores: [Option<Evaluation>; 2],
}

fn main() -> Outcome<()> {
    if !std::env::args().any(|a| a == "--bench") {
        println!("nothing is measured without `cargo bench`");
        return Ok(());
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(board)
}

fn board() -> Outcome<()> {
    let noise = if std::env::args().any(|a| a == "--unknown") { None } else { Some("kinect".parse()?) };
    println!("| image | image ms | cells ms | planes | by cells | F1@.8 | by cells | wcov | by cells |");
    println!("|---|---|---|---|---|---|---|---|---|");
    let mut timed: Vec<[f64; 2]> = Vec::new();
    for entry in entries(noise)? {
        let row = row(&entry)?;
        if entry.units_per_metre.total_cmp(&MILLIMETRES).is_eq() {
            timed.push(row.seconds);
        }
        if entry.truth.is_some() {
            print(&entry.name, &row);
        }
    }
    for (name, at) in [("median", timed.len() / 2), ("slowest", timed.len().saturating_sub(1))] {
        let of = [0, 1].map(|way| {
            timed.sort_by(|a, b| a[way].total_cmp(&b[way]));
            timed.get(at).map_or(f64::NAN, |row| 1e3 * row[way])
        });
        println!("| {name} of {} | {:.2} | {:.1} | | | | | | |", timed.len(), of[0], of[1]);
    }
    Ok(())
}

fn print(name: &str, row: &Row) {
    let score = |of: &dyn Fn(&Evaluation) -> Option<f64>| {
        let told = row.scores.each_ref().map(|score| score.as_ref().and_then(of));
        told.map(|value| value.map_or(String::new(), |value| format!("{value:.3}"))).join(" | ")
    };
    let measure = |wanted: &'static str| {
        score(&|e: &Evaluation| e.measures().iter().find(|m| m.name == wanted).and_then(|m| m.value))
    };
    println!(
        "| {name} | {:.2} | {:.1} | {} | {} | {} | {} |",
        1e3 * row.seconds[0],
        1e3 * row.seconds[1],
        row.planes[0],
        row.planes[1],
        measure("f1_80"),
        measure("weighted_cover"),
    );
}

/// The images that are there.
fn entries(noise: Option<SensorNoise>) -> Outcome<Vec<Entry>> {
    let mut entries = Vec::new();
    for name in ["roomframe0", "roomframe1"] {
        let Some(folder) = scenes::path(&format!("scenes/{name}")) else { continue };
        entries.push(Entry {
            name: name.to_owned(),
            image: folder.join("depth_mm.png"),
            camera: folder.join("intrinsics.json"),
            truth: Some(folder.join("organized_labels.npy")),
            units_per_metre: MILLIMETRES,
            noise,
        });
    }
    if let Some(folder) = scenes::path("sevenscenes") {
        let mut files: Vec<PathBuf> =
            std::fs::read_dir(&folder)?.filter_map(|file| Some(file.ok()?.path())).collect();
        files.retain(|file| file.to_string_lossy().ends_with(".depth.png"));
        files.sort();
        entries.extend(files.into_iter().map(|image| Entry {
            name: image.display().to_string(),
            image,
            camera: folder.join("camera-intrinsics.txt"),
            truth: None,
            units_per_metre: MILLIMETRES,
            noise,
        }));
    }
    if let Some(folder) = scenes::path("evops_icl") {
        entries.push(Entry {
            name: "evops_icl".to_owned(),
            image: folder.join("depth_0.png"),
            camera: folder.join("ICL_living_room.K"),
            truth: Some(folder.join("icl_lr_frame0_evops.labels.npy")),
            units_per_metre: ICL,
            noise: None,
        });
    }
    Ok(entries)
}

fn row(entry: &Entry) -> Outcome<Row> {
    let image = DepthImage::read(&std::fs::read(&entry.image)?)?;
    let camera = entry.camera(&image)?;
    let truth = match &entry.truth {
        Some(file) => Some(npy::read_labels(&std::fs::read(file)?)?),
        None => None,
    };
    let scan = entry.scan()?;
    let mut finder = PlaneFinder::new(camera, entry.noise, Settings::default())?;
    let mut row = Row { seconds: [f64::INFINITY; 2], planes: [0; 2], scores: [None, None] };
    for _ in 0..RUNS {
        let begin = Usage::cpu_now()?;
        let found = finder.find(&image.raw)?;
        row.seconds[0] = row.seconds[0].min(Usage::cpu_now()? - begin);
        row.planes[0] = found.planes.len();
        row.scores[0] = score(truth.as_deref(), &found.labels)?;
    }
    let begin = Usage::cpu_now()?;
    let mut mapper = Mapper::new(Params::default())?;
    mapper.insert(&scan)?;
    let map = mapper.extract()?;
    row.seconds[1] = Usage::cpu_now()? - begin;
    row.planes[1] = map.planes.len();
    row.scores[1] = score(truth.as_deref(), &map.labels)?;
    Ok(row)
}

impl Entry {
    fn camera(&self, image: &DepthImage) -> Outcome<Camera> {
        let [fx, fy, cx, cy] = Intrinsics::open(&self.camera)?.entries();
        let size = [usize::try_from(image.width)?, usize::try_from(image.height)?];
        Ok(Camera::new(size, [fx, fy], [cx, cy], self.units_per_metre)?)
    }

    /// The same pixels as points.
    fn scan(&self) -> Outcome<Scan> {
        let errors = match self.noise {
            Some(noise) => ErrorSource::Model(noise),
            None => ErrorSource::FromFile(FieldChoice::Ignore),
        };
        let options = ReadOptions {
            intrinsics: Some(Intrinsics::open(Path::new(&self.camera))?),
            depth_scale: self.units_per_metre,
            errors,
        };
        let sources = find_sources(std::slice::from_ref(&self.image), None)?;
        Ok(read_scan(sources.first().ok_or("no image")?, &options)?)
    }
}

fn score(truth: Option<&[i32]>, labels: &[Option<PlaneId>]) -> Outcome<Option<Evaluation>> {
    let Some(truth) = truth else { return Ok(None) };
    let number = |label: &Option<PlaneId>| label.map_or(Ok(0), |id| i32::try_from(id.get()));
    let found = labels.iter().map(number).collect::<Result<Vec<i32>, _>>()?;
    Ok(Some(Evaluation::of(&Contingency::of_numbers(truth, &found)?)))
}
