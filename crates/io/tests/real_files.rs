//! Scans of real sensors, and simulated ones with truth. They do not come with the repository: each test passes with a
//! message when its files are absent.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::float_cmp,
    reason = "a test may fail, and compares exactly"
)]

mod common;

use common::{data, difference};
use terrace_io::trajectory::{self, TrajectoryFormat};
use terrace_io::{
    DepthImage, ErrorSource, Intrinsics, ReadOptions, Source, find_sources, inspect, npy, read_scan,
};
use terrace_types::{Frame, Pose};

fn camera(text: &str) -> ReadOptions {
    let errors = ErrorSource::Model("kinect".parse().unwrap());
    ReadOptions { intrinsics: Some(text.parse().unwrap()), errors, ..ReadOptions::default() }
}

#[test]
fn posed_sequence_of_depth_images() {
    let Some(folder) = data("sevenscenes") else { return };
    let sources = find_sources(&[&folder], None).unwrap();
    assert_eq!(sources.len(), 100);
    assert!(sources.iter().all(|s| s.pose.is_some()));
    assert!(sources[1].path.ends_with("frame-000010.depth.png"));
    let matrix = Intrinsics::open(&folder.join("camera-intrinsics.txt")).unwrap();
    assert_eq!(matrix.parameters(), [585.0, 585.0, 320.0, 240.0]);
    for source in [&sources[0], &sources[99]] {
        let scan = read_scan(source, &camera("585,585,320,240")).unwrap();
        assert_eq!(scan.len(), 307_200);
        assert!(scan.present() > 100_000);
        let inside =
            scan.world_points().flatten().filter(|p| p.position.iter().all(|x| x.abs() < 10.0)).count();
        assert!(inside as f64 > 0.99 * scan.present() as f64);
    }
    // The same poses, named as a folder.
    assert_eq!(find_sources(&[&folder], Some(&folder)).unwrap(), sources);
}

#[test]
fn lidar_scans_with_poses_by_number() {
    let Some(folder) = data("balm_real") else { return };
    let poses = folder.join("alidarPose.csv");
    let trajectory = trajectory::open(&poses).unwrap();
    assert_eq!((trajectory.format, trajectory.poses.len()), (TrajectoryFormat::MatrixBlocks, 177));
    let sources = find_sources(&[&folder], Some(&poses)).unwrap();
    let numbers: Vec<_> =
        sources.iter().map(|s| s.path.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    assert_eq!(numbers[..3], ["full0", "full16", "full32"]);
    assert_eq!(sources[1].pose, Some(trajectory.poses[16].pose));
    let scan = read_scan(&sources[1], &ReadOptions::default()).unwrap();
    assert!(scan.present() > 50_000);
    // Without poses the viewpoint of the file tells where the sensor stood.
    let alone = read_scan(&Source::new(&sources[1].path), &ReadOptions::default()).unwrap();
    assert_eq!(alone.frame(), Frame::World { sensor: Some([0.0; 3]) });
}

#[test]
fn simulated_scans_agree_with_their_merged_cloud() {
    let Some(folder) = data("balm_sim") else { return };
    let sources = find_sources(&[folder.join("scan_*.ply")], Some(&folder.join("poses.txt"))).unwrap();
    assert_eq!(sources.len(), 12);
    let merged = read_scan(&Source::new(folder.join("merged_world.ply")), &ReadOptions::default()).unwrap();
    let mut points: Vec<[f64; 3]> = Vec::new();
    for source in &sources {
        let scan = read_scan(source, &ReadOptions::default()).unwrap();
        points.extend(scan.world_points().flatten().map(|p| p.position));
    }
    assert_eq!(points.len(), merged.len());
    let worst = points.iter().flatten().zip(merged.points().iter().flatten()).map(|(a, b)| (a - b).abs());
    assert!(worst.fold(0.0, f64::max) < 1e-3);
}

#[test]
fn phone_scans_with_a_folder_of_poses() {
    let Some(folder) = data("arcore_depth") else { return };
    let sources = find_sources(&[folder.join("pcs")], Some(&folder.join("poses"))).unwrap();
    assert_eq!(sources.len(), 28);
    let expected = trajectory::open(&folder.join("poses/pose-0341.txt")).unwrap().poses[0].pose;
    assert_eq!(sources[27].pose, Some(expected));
    assert!(read_scan(&sources[27], &ReadOptions::default()).unwrap().present() > 500);
}

#[test]
fn depth_images_with_a_log() {
    let Some(folder) = data("open3d_testdata") else { return };
    let log = folder.join("RGBD/trajectory.log");
    assert_eq!(trajectory::open(&log).unwrap().format, TrajectoryFormat::Open3dLog);
    assert!(trajectory::open(&folder.join("RGBD/odometry.log")).is_ok());
    let sources = find_sources(&[folder.join("RGBD/depth")], Some(&log)).unwrap();
    assert_eq!(sources.len(), 5);
    let primesense = Intrinsics::open(&folder.join("camera_primesense.json")).unwrap();
    assert_eq!(primesense.parameters(), [525.0, 525.0, 319.5, 239.5]);
    assert!(read_scan(&sources[4], &camera("525,525,319.5,239.5")).unwrap().present() > 100_000);
    let colour = DepthImage::read(&std::fs::read(folder.join("RGBD/other_formats/TUM_color.png")).unwrap());
    assert!(colour.unwrap_err().to_string().contains("8-bit RGB"));
    // Colour images beside depth are passed over.
    let mixed = find_sources(&[folder.join("RGBD/other_formats")], None).unwrap();
    assert_eq!(mixed.len(), 2);
}

#[test]
fn depth_image_agrees_with_its_organized_points() {
    for name in ["scenes/roomframe0", "scenes/roomframe1"] {
        let Some(folder) = data(name) else { continue };
        let intrinsics = Some(Intrinsics::open(&folder.join("intrinsics.json")).unwrap());
        let options = ReadOptions { intrinsics, ..ReadOptions::default() };
        let scan = read_scan(&Source::new(folder.join("depth_mm.png")), &options).unwrap();
        let organized = npy::read(&std::fs::read(folder.join("organized.npy")).unwrap()).unwrap();
        assert_eq!(scan.len(), organized.points.len());
        assert_eq!(trajectory::open(&folder.join("pose.npy")).unwrap().poses.len(), 1);
        let (mut worst, mut compared) = (0.0_f64, 0);
        for (ours, theirs) in scan.points().iter().zip(&organized.points) {
            if ours[2].is_finite() && theirs[2].is_finite() {
                let ray = ours.iter().map(|x| x * x).sum::<f64>().sqrt() / ours[2];
                let apart = (0..3).map(|i| (ours[i] - theirs[i]).powi(2)).sum::<f64>().sqrt();
                worst = worst.max(apart / ray);
                compared += 1;
            }
        }
        // Depths were rounded to a millimetre.
        assert!(compared > 100_000 && worst < 0.000_51, "{name}: {worst} over {compared}");
    }
}

#[test]
fn poses_of_the_simulated_room() {
    let Some(file) = data("scenes/room300k/poses.npy") else { return };
    let trajectory = trajectory::open(&file).unwrap();
    assert_eq!((trajectory.format, trajectory.poses.len()), (TrajectoryFormat::Npy, 14));
    assert!(trajectory.poses.iter().all(|p| difference(&p.pose, &Pose::IDENTITY) > 0.1));
}

#[test]
fn rendered_depth_agrees_with_its_cloud() {
    let Some(folder) = data("evops_icl") else { return };
    let intrinsics = Some(Intrinsics::open(&folder.join("ICL_living_room.K")).unwrap());
    assert_eq!(intrinsics.map(|i| i.parameters()), Some([481.2, -480.0, 319.5, 239.5]));
    let options = ReadOptions { intrinsics, depth_scale: 5000.0, ..ReadOptions::default() };
    let ours = inspect(&folder.join("depth_0.png"), &options).unwrap();
    let theirs = inspect(&folder.join("icl_lr_frame0_evops.ply"), &options).unwrap();
    assert_eq!(ours.present, theirs.present);
    for (a, b) in ours.bounds.unwrap().iter().flatten().zip(theirs.bounds.unwrap().iter().flatten()) {
        assert!((a - b).abs() < 1e-3, "{ours:?} {theirs:?}");
    }
}

#[test]
fn info_of_every_cloud() {
    let Some(folder) = data("pcl_data") else { return };
    for source in find_sources(&[folder], None).unwrap() {
        let info = inspect(&source.path, &ReadOptions::default()).unwrap();
        assert!(info.present > 1000 && info.spacing.is_some_and(|s| s > 0.0 && s < 10.0), "{info:?}");
    }
}
