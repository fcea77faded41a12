//! Properties of the pictures of clouds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::float_cmp, reason = "tests")]

use proptest::prelude::*;
use terrace_draw::{Bounds, CloudPicture, DrawError, Image, MAX_SIDE, View};

const RED: [u8; 3] = [220, 20, 20];
const BLUE: [u8; 3] = [20, 20, 220];

fn unit_box() -> Bounds {
    Bounds::new([-1.0; 3], [1.0; 3]).unwrap()
}

/// Seen from the +x side: y to the right, z up.
fn from_front(width: usize, height: usize) -> CloudPicture {
    CloudPicture::new(width, height, View::from_degrees(0.0, 0.0).unwrap(), unit_box()).unwrap()
}

fn is_red([r, _, b]: [u8; 3]) -> bool {
    r > b.saturating_add(40)
}

fn is_blue([r, _, b]: [u8; 3]) -> bool {
    b > r.saturating_add(40)
}

/// Columns and rows of the pixels that a test holds for.
fn places(image: &Image, test: impl Fn([u8; 3]) -> bool) -> Vec<(usize, usize)> {
    let all = (0..image.height()).flat_map(|y| (0..image.width()).map(move |x| (x, y)));
    all.filter(|(x, y)| image.pixel(*x, *y).is_some_and(&test)).collect()
}

/// A square of points across the view at a depth, around a place of the picture.
fn patch(picture: &mut CloudPicture, x: f64, [y, z]: [f64; 2], half: f64, colour: [u8; 3]) {
    for i in -20..=20 {
        for j in -20..=20 {
            picture.add([x, y + half * f64::from(i) / 20.0, z + half * f64::from(j) / 20.0], colour);
        }
    }
}

fn decoded(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    (info.width, info.height, pixels)
}

#[test]
fn the_png_decodes_to_the_picture() {
    let mut picture = from_front(61, 47).with_title("a title");
    patch(&mut picture, 0.0, [0.0, 0.0], 0.5, RED);
    let (width, height, pixels) = decoded(&picture.png().unwrap());
    assert_eq!((width, height), (61, 47));
    let image = picture.image();
    for (at, pixel) in pixels.chunks_exact(3).enumerate() {
        assert_eq!(image.pixel(at % 61, at / 61).unwrap(), pixel);
    }
}

#[test]
fn what_is_in_front_hides_what_is_behind_in_any_order() {
    for front_first in [true, false] {
        let mut picture = from_front(80, 80);
        let patches = [(0.5, RED, 0.4), (-0.5, BLUE, 0.3)];
        for (x, colour, half) in if front_first { patches } else { [patches[1], patches[0]] } {
            patch(&mut picture, x, [0.0; 2], half, colour);
        }
        let image = picture.image();
        assert!(places(&image, is_red).len() > 200);
        assert_eq!(places(&image, is_blue), []);
    }
}

#[test]
fn a_sparse_surface_in_front_is_closed_over_a_dense_one() {
    let mut picture = from_front(100, 100);
    patch(&mut picture, 0.9, [0.0; 2], 0.9, RED);
    for i in 0..400 {
        for j in 0..400 {
            picture.add([-0.9, f64::from(i) / 250.0 - 0.8, f64::from(j) / 250.0 - 0.8], BLUE);
        }
    }
    assert_eq!(places(&picture.image(), is_blue), []);
}

#[test]
fn left_is_left_and_up_is_up() {
    // From the +x side, +y is to the right; from the −x side to the left.
    for (azimuth, up, right) in
        [(0.0, [0.0, 0.0, 1.0], true), (180.0, [0.0, 0.0, 1.0], false), (0.0, [0.0, 0.0, -1.0], false)]
    {
        for perspective in [false, true] {
            let mut view = View::from_degrees(azimuth, 0.0).unwrap().with_up(up).unwrap();
            if perspective {
                view = view.with_perspective_degrees(60.0).unwrap();
            }
            let mut picture = CloudPicture::new(90, 90, view, unit_box()).unwrap();
            patch(&mut picture, 0.0, [0.6, 0.0], 0.2, RED);
            patch(&mut picture, 0.0, [0.0, 0.6], 0.2, BLUE);
            let image = picture.image();
            let (red, blue) = (places(&image, is_red), places(&image, is_blue));
            assert!(!red.is_empty() && red.iter().all(|(x, _)| (*x > 45) == right), "{azimuth} {up:?}");
            assert!(
                !blue.is_empty() && blue.iter().all(|(_, y)| (*y < 45) == (up[2] > 0.0)),
                "{azimuth} {up:?}"
            );
        }
    }
}

#[test]
fn an_empty_cloud_is_a_blank_picture() {
    let image = from_front(20, 10).image();
    assert_eq!(places(&image, |colour| colour == [255; 3]).len(), 200);
}

#[test]
fn points_that_are_not_finite_are_passed_over() {
    let blank = from_front(20, 20);
    let mut picture = blank.clone();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
        for axis in 0..3 {
            let mut point = [0.0; 3];
            point[axis] = bad;
            if bad != f64::MAX || axis != 0 {
                picture.add(point, RED);
            }
        }
    }
    assert_eq!(picture.image(), blank.image());
}

#[test]
fn what_lies_above_the_cut_is_left_out() {
    let mut picture = from_front(80, 80).with_cut_above(0.0);
    patch(&mut picture, 0.5, [0.0, 0.5], 0.3, BLUE);
    patch(&mut picture, 0.0, [0.0, -0.5], 0.3, RED);
    let image = picture.image();
    assert_eq!(places(&image, is_blue), []);
    assert!(!places(&image, is_red).is_empty());
}

#[test]
fn pictures_stand_side_by_side() {
    let mut left = from_front(30, 40);
    patch(&mut left, 0.0, [0.0; 2], 0.5, RED);
    let both = Image::beside(&left.image(), &from_front(20, 50).image()).unwrap();
    assert_eq!((both.width(), both.height()), (50, 50));
    assert!(places(&both, is_red).iter().all(|(x, y)| *x < 30 && *y < 40));
    assert!(!places(&both, is_red).is_empty());
}

#[test]
fn what_cannot_be_drawn_is_an_error() {
    let view = View::from_degrees(0.0, 0.0).unwrap();
    for (width, height) in [(0, 10), (10, 0), (MAX_SIDE + 1, 10), (10, usize::MAX)] {
        let refused = CloudPicture::new(width, height, view, unit_box());
        assert!(matches!(refused, Err(DrawError::Size { width: w, height: h }) if (w, h) == (width, height)));
    }
    assert!(matches!(Bounds::new([0.0; 3], [1.0, f64::NAN, 1.0]), Err(DrawError::Bounds { .. })));
    assert!(matches!(Bounds::new([0.0, 2.0, 0.0], [1.0; 3]), Err(DrawError::Bounds { .. })));
    assert!(Bounds::of([[f64::NAN; 3]]).is_none());
    assert!(matches!(View::from_degrees(f64::NAN, 0.0), Err(DrawError::Angle { .. })));
    assert!(matches!(view.with_perspective_degrees(180.0), Err(DrawError::Angle { .. })));
    assert!(matches!(view.with_perspective_degrees(f64::NAN), Err(DrawError::Angle { .. })));
    assert!(matches!(view.with_up([0.0; 3]), Err(DrawError::Up { .. })));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_cloud_from_anywhere_gives_a_picture_of_its_size(
        points in prop::collection::vec(prop::array::uniform3(prop_oneof![8 => -2.0..2.0_f64, 2 => any::<f64>(), 1 => Just(f64::NAN), 1 => Just(f64::NEG_INFINITY)]), 0..200),
        corners in prop::array::uniform2(prop::array::uniform3(prop_oneof![-2.0..2.0_f64, -1e300..1e300, Just(0.0)])),
        (width, height) in (1..40_usize, 1..40_usize),
        (azimuth, elevation) in (-400.0..400.0_f64, -100.0..100.0_f64),
        perspective in prop::option::of(1.0..179.0_f64),
        up in prop::array::uniform3(-1.0..1.0_f64),
        title: String,
        cut in prop::option::of(any::<f64>()),
    ) {
        let [a, b] = corners;
        let bounds = Bounds::new([0, 1, 2].map(|i| a[i].min(b[i])), [0, 1, 2].map(|i| a[i].max(b[i]))).unwrap();
        let mut view = View::from_degrees(azimuth, elevation).unwrap();
        if let Ok(turned) = view.with_up(up) {
            view = turned;
        }
        if let Some(angle) = perspective {
            view = view.with_perspective_degrees(angle).unwrap();
        }
        let mut picture = CloudPicture::new(width, height, view, bounds).unwrap().with_title(&title);
        if let Some(cut) = cut {
            picture = picture.with_cut_above(cut);
        }
        for point in &points {
            picture.add(*point, RED);
        }
        let (w, h, pixels) = decoded(&picture.png().unwrap());
        prop_assert_eq!((w as usize, h as usize), (width, height));
        prop_assert_eq!(pixels.len(), width * height * 3);
        // The same again: the same bytes.
        prop_assert_eq!(picture.png().unwrap(), picture.clone().png().unwrap());
    }

    #[test]
    fn the_bounds_fill_the_picture_and_no_more(
        size in prop::array::uniform3(1.0..10.0_f64), (azimuth, elevation) in (-180.0..180.0_f64, -80.0..80.0_f64),
        perspective in prop::option::of(10.0..120.0_f64),
    ) {
        let bounds = Bounds::new([0.0; 3], size).unwrap();
        let mut view = View::from_degrees(azimuth, elevation).unwrap();
        if let Some(angle) = perspective {
            view = view.with_perspective_degrees(angle).unwrap();
        }
        let mut picture = CloudPicture::new(400, 400, view, bounds).unwrap();
        for k in 0..8 {
            picture.add([0, 1, 2].map(|i| if (k >> i) & 1 == 0 { 0.0 } else { size[i] }), RED);
        }
        let red = places(&picture.image(), |colour| colour != [255; 3]);
        let span = |of: fn(&(usize, usize)) -> usize| {
            let (low, high) = (red.iter().map(of).min().unwrap(), red.iter().map(of).max().unwrap());
            (low, high, high - low)
        };
        let (columns, rows) = (span(|p| p.0), span(|p| p.1));
        prop_assert!(columns.0 > 0 && columns.1 < 399 && rows.0 > 0 && rows.1 < 399);
        prop_assert!(columns.2.max(rows.2) >= 370);
    }
}
