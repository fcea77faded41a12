//! What is written is there whole, or not at all, and the readers of this crate read it back.
#![allow(
    clippy::unwrap_used,
    clippy::cast_possible_truncation,
    clippy::float_cmp,
    reason = "a test may fail, and compares exactly"
)]

use std::io::Write;
use std::path::Path;

use proptest::prelude::*;
use terrace_io::{
    FieldChoice, LabelledPoint, LabelsWriter, MeasuredPoint, PlyExtent, PlyWriter, WriteErrorKind, npy,
    palette, ply, write_atomically, write_labelled_ply, write_labels_npy, write_measured_ply,
};
use terrace_types::{PlaneId, Sigma};

fn files(folder: &Path) -> usize {
    std::fs::read_dir(folder).unwrap().count()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn labels_there_and_back(labels in prop::collection::vec(0..i32::MAX as u32, 0..50)) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("labels.npy");
        write_labels_npy(&path, labels.iter().map(|l| PlaneId::new(*l)), labels.len() as u64).unwrap();
        let back = npy::read_labels(&std::fs::read(&path).unwrap()).unwrap();
        prop_assert_eq!(back, labels.iter().map(|l| l.cast_signed()).collect::<Vec<_>>());
    }

    #[test]
    fn points_there_and_back(
        positions in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 0..30),
        size in prop::sample::select(vec![1.0, 900.0, 5e6]),
        sigma in 0.0..1.0_f64,
    ) {
        let positions: Vec<_> = positions.iter().map(|p| p.map(|x| x * size)).collect();
        let plane = PlaneId::new(3);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("points.ply");
        let extent = PlyExtent::of(positions.iter().copied());
        write_measured_ply(&path, extent, positions.iter().map(|p| MeasuredPoint { position: *p, plane, sigma })).unwrap();
        let cloud = ply::read(&std::fs::read(&path).unwrap(), &FieldChoice::Automatic).unwrap();
        prop_assert_eq!(cloud.points.len(), positions.len());
        for (a, b) in cloud.points.iter().flatten().zip(positions.iter().flatten()) {
            prop_assert!((a - b).abs() <= 5e-5);
        }
        match cloud.sigma {
            Sigma::PerPoint(all) => prop_assert!(all.iter().all(|s| (s - sigma).abs() < 1e-7)),
            other => prop_assert!(positions.is_empty(), "{:?}", other),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn chunks_make_the_same_file(
        // More than a block of either writer.
        labels in prop::collection::vec(0..40_u32, 0..40_000),
        mut cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..5),
        size in prop::sample::select(vec![1.0, 5e3]),
    ) {
        cuts.sort_by_key(|cut| cut.index(labels.len() + 1));
        let places = cuts.iter().map(|cut| cut.index(labels.len() + 1));
        let places: Vec<usize> = std::iter::once(0).chain(places).chain([labels.len()]).collect();
        let chunks = || places.windows(2).map(|ends| ends[0]..ends[1]);
        let planes: Vec<_> = labels.iter().map(|label| PlaneId::new(*label)).collect();
        let point = |i: usize| MeasuredPoint { position: [i as f64 * size, 0.5, -1.0], plane: planes[i], sigma: 0.25 };
        let points: Vec<_> = (0..planes.len()).map(point).collect();
        let bare = |p: &MeasuredPoint| LabelledPoint { position: p.position, plane: p.plane };
        let extent = PlyExtent::of(points.iter().map(|p| p.position));
        let folder = tempfile::tempdir().unwrap();
        let path = |name| folder.path().join(name);
        let same = |a, b| std::fs::read(path(a)).unwrap() == std::fs::read(path(b)).unwrap();

        write_labels_npy(&path("a"), planes.iter().copied(), planes.len() as u64).unwrap();
        let mut writer = LabelsWriter::create(&path("b"), planes.len() as u64).unwrap();
        chunks().for_each(|chunk| writer.push(planes[chunk].iter().copied()).unwrap());
        prop_assert!(!path("b").exists());
        writer.finish().unwrap();
        prop_assert!(same("a", "b"));
        let read = npy::read_labels(&std::fs::read(path("b")).unwrap()).unwrap();
        prop_assert_eq!(read, labels.iter().map(|l| l.cast_signed()).collect::<Vec<_>>());

        write_measured_ply(&path("c"), extent, points.iter().copied()).unwrap();
        let mut writer = PlyWriter::create(&path("d"), extent).unwrap();
        chunks().for_each(|chunk| writer.push(points[chunk].iter().copied()).unwrap());
        writer.finish().unwrap();
        prop_assert!(same("c", "d"));

        write_labelled_ply(&path("e"), extent, points.iter().map(bare)).unwrap();
        let mut writer = PlyWriter::create(&path("f"), extent).unwrap();
        chunks().for_each(|chunk| writer.push(points[chunk].iter().map(bare)).unwrap());
        writer.finish().unwrap();
        prop_assert!(same("e", "f"));
        let cloud = ply::read(&std::fs::read(path("f")).unwrap(), &FieldChoice::Automatic).unwrap();
        prop_assert_eq!(cloud.points, points.iter().map(|p| p.position).collect::<Vec<_>>());
    }
}

#[test]
fn an_unfinished_writer_leaves_the_older_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("labels.npy");
    std::fs::write(&path, b"old").unwrap();
    let mut writer = LabelsWriter::create(&path, 2).unwrap();
    writer.push([None]).unwrap();
    assert_eq!(files(folder.path()), 2);
    assert!(writer.push([None, None]).unwrap_err().to_string().contains("3 records"));
    drop(writer);
    let mut writer = PlyWriter::create(&path, PlyExtent { points: 2, largest: 0.0 }).unwrap();
    writer.push([LabelledPoint { position: [0.0; 3], plane: None }]).unwrap();
    assert!(writer.finish().unwrap_err().to_string().contains("1 records were given where 2"));
    assert_eq!(files(folder.path()), 1);
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
}

#[test]
fn layout_of_the_ply() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("planes.ply");
    let points = [
        LabelledPoint { position: [1.0, 2.0, 3.0], plane: PlaneId::new(7) },
        LabelledPoint { position: [0.0, 0.0, 2000.0], plane: None },
    ];
    write_labelled_ply(&path, PlyExtent::of(points.iter().map(|p| p.position)), points).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    assert!(header.contains("element vertex 2\nproperty double x\n"), "{header}");
    assert_eq!(bytes.len() - end, 2 * (3 * 8 + 3 + 4));
    assert_eq!(
        &bytes[end + 24..end + 31],
        [&palette::colour(PlaneId::new(7).unwrap())[..], &[7, 0, 0, 0]].concat()
    );
    assert_eq!(&bytes[end + 55..], [128, 128, 128, 0, 0, 0, 0]);
}

#[test]
fn more_or_fewer_records_than_announced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("labels.npy");
    for given in [1, 3] {
        let error = write_labels_npy(&path, vec![None; given], 2).unwrap_err();
        assert!(matches!(error.kind, WriteErrorKind::Count { expected: 2, found } if found == given as u64));
        let extent = PlyExtent { points: 2, largest: 1.0 };
        let points = vec![LabelledPoint { position: [0.0; 3], plane: None }; given];
        let error = write_labelled_ply(&path, extent, points).unwrap_err();
        assert!(matches!(error.kind, WriteErrorKind::Count { expected: 2, .. }));
    }
    assert_eq!(files(folder.path()), 0);
}

#[test]
fn point_not_finite() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("points.ply");
    let point = LabelledPoint { position: [0.0, f64::NAN, 0.0], plane: None };
    let error = write_labelled_ply(&path, PlyExtent { points: 1, largest: 0.0 }, [point]).unwrap_err();
    assert!(error.to_string().contains("point 0 holds NaN"), "{error}");
    let point = MeasuredPoint { position: [0.0; 3], plane: None, sigma: f64::INFINITY };
    assert!(write_measured_ply(&path, PlyExtent { points: 1, largest: 0.0 }, [point]).is_err());
    assert_eq!(files(folder.path()), 0);
}

#[test]
fn failure_leaves_the_older_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("result.txt");
    write_atomically(&path, |out| Ok(out.write_all(b"old")?)).unwrap();
    let error = write_atomically(&path, |out| {
        out.write_all(&vec![b'x'; 1 << 20])?;
        Err(WriteErrorKind::Io(std::io::Error::other("disk full")))
    });
    let error = error.unwrap_err().to_string();
    assert!(error.contains("result.txt") && error.contains("disk full"), "{error}");
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
    assert_eq!(files(folder.path()), 1);
    write_atomically(&path, |out| Ok(out.write_all(b"new")?)).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"new");
}

#[test]
fn folder_that_cannot_be_made() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    std::fs::File::create(&file).unwrap().write_all(b"x").unwrap();
    let error = write_labels_npy(&file.join("labels.npy"), [], 0).unwrap_err();
    assert!(matches!(error.kind, WriteErrorKind::Io(_)));
}

#[cfg(unix)]
#[test]
fn outputs_are_as_readable_as_other_files() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (ours, plain) = (folder.path().join("ours"), folder.path().join("plain"));
    write_atomically(&ours, |out| Ok(out.write_all(b"x")?)).unwrap();
    std::fs::write(&plain, b"x").unwrap();
    let mode = |path| std::fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(ours), mode(plain));
}

#[test]
fn colours_of_planes_differ() {
    let colours: Vec<[u8; 3]> = (0..500).filter_map(PlaneId::from_index).map(palette::colour).collect();
    let apart = |a: [u8; 3], b: [u8; 3]| (0..3).map(|i| i32::from(a[i].abs_diff(b[i]))).sum::<i32>();
    for (index, colour) in colours.iter().enumerate() {
        assert!(apart(*colour, palette::UNLABELLED) > 60, "{colour:?} is nearly grey");
        for near in colours[..index].iter().rev().take(8) {
            assert!(apart(*colour, *near) > 40, "plane {}: {colour:?} like {near:?}", index + 1);
        }
    }
    assert_eq!(palette::colour_of(None), palette::UNLABELLED);
}
