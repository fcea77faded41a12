//! Damaged files of every format: an error, never a panic.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod formats_support;

use formats_support::{Format, Good, apply, damage, good_files, same};
use proptest::prelude::*;

/// Whether what was cut away is nothing but white space.
fn cut_nothing(good: &Good, cut: usize) -> bool {
    good.bytes[cut..].iter().all(u8::is_ascii_whitespace)
}

/// Whether the cut file ends within the last word of the whole: what remains of a number is a number.
fn cut_last_word(good: &Good, cut: usize) -> bool {
    let end = good.bytes.trim_ascii_end().len();
    let start = good.bytes[..end].iter().rposition(u8::is_ascii_whitespace).map_or(0, |i| i + 1);
    good.is_text && cut > start && cut < end
}

#[test]
fn truncated_at_every_byte() {
    for good in good_files(3) {
        let whole = good.format.read(&good.bytes).unwrap();
        assert_eq!(whole.points.len(), 3, "{}", good.name);
        let mut errors = 0;
        for cut in 0..good.bytes.len() {
            let Ok(cloud) = good.format.read(&good.bytes[..cut]) else {
                errors += 1;
                continue;
            };
            let name = format!("{} cut at {cut} of {}", good.name, good.bytes.len());
            if cut_nothing(&good, cut) {
                assert!(same(&cloud.points, &whole.points), "{name}");
            } else if good.format == Format::Text && !good.name.contains("counted") {
                // Nothing says how many lines there should be: the whole lines come first, the last may have lost digits.
                let (_, sure) = cloud.points.split_last().unwrap();
                assert!(same(sure, &whole.points[..sure.len()]), "{name}");
            } else {
                assert!(cut_last_word(&good, cut), "{name}");
                assert!(same(&cloud.points[..2], &whole.points[..2]) && cloud.points.len() == 3, "{name}");
            }
        }
        assert!(errors > good.body / 2, "{}: {errors} errors", good.name);
    }
}

#[test]
fn empty_files() {
    for format in [Format::Ply, Format::Pcd, Format::Text, Format::Npy] {
        for bytes in [&b""[..], b"\n", b"\r\n \n", b"\0", &[0; 1000], &[0xff; 1000]] {
            assert!(format.read(bytes).is_err(), "{format:?} {bytes:?}");
        }
    }
}

#[test]
fn header_only() {
    for good in good_files(3) {
        assert!(good.format.read(&good.bytes[..good.body]).is_err(), "{}", good.name);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn damaged_files_never_panic(which in any::<prop::sample::Index>(), all in prop::collection::vec(damage(), 1..6)) {
        let files = good_files(4);
        let good = &files[which.index(files.len())];
        let mut bytes = good.bytes.clone();
        for damage in &all {
            apply(&mut bytes, damage);
        }
        let _ = good.format.read(&bytes);
        let _ = terrace_io::npy::read_labels(&bytes);
        let _ = terrace_io::npy::read_scalars(&bytes);
    }

    #[test]
    fn any_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), which in any::<prop::sample::Index>()) {
        let files = good_files(1);
        let good = &files[which.index(files.len())];
        for format in [Format::Ply, Format::Pcd, Format::Text, Format::Npy] {
            let _ = format.read(&bytes);
            // And behind the start of a good file, so that more than the first check is met.
            let start = which.index(good.body + 1);
            let _ = format.read(&[&good.bytes[..start], &bytes].concat());
            let _ = format.read(&[&good.bytes[..good.body], &bytes].concat());
        }
    }
}
