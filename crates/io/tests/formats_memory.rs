//! Memory asked for by files whose headers promise too much. A binary of its own, because the peak is that of the
//! process; one test in it, because tests run side by side.

#![allow(clippy::unwrap_used, clippy::panic, clippy::float_cmp)]
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

mod formats_support;

use formats_support::{Format, good_files, npy_bytes};
use terrace_io::npy;

/// Peak of the address space asked for so far, in bytes; `None` where the system does not tell.
fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmPeak:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}

/// The peak, and memory that brings the process within a mebibyte of it: what the start of a thread reserved and gave
/// back would otherwise hide what is asked for later.
fn close_to_the_peak() -> Option<(u64, Vec<Vec<u8>>)> {
    let before = peak()?;
    let mut filler = Vec::new();
    while peak()? == before {
        filler.push(std::hint::black_box(Vec::with_capacity(1 << 20)));
    }
    Some((peak()?, filler))
}

/// Every file made from a good one by multiplying one of the numbers in its header.
fn multiplied(bytes: &[u8], body: usize) -> Vec<Vec<u8>> {
    let mut files = Vec::new();
    let mut at = 0;
    while at < body {
        let digits = bytes[at..body].iter().take_while(|b| b.is_ascii_digit()).count();
        if digits == 0 {
            at += 1;
            continue;
        }
        let number: u128 = std::str::from_utf8(&bytes[at..at + digits]).unwrap().parse().unwrap();
        let factors = [2, 1000, 1_000_000_000_000].map(|factor| (number * factor).to_string());
        for text in factors.into_iter().chain([u64::MAX.to_string(), "-1".into()]) {
            files.push([&bytes[..at], text.as_bytes(), &bytes[at + digits..]].concat());
        }
        at += digits;
    }
    files
}

/// The two sizes that stand before compressed points, as if there were 4 GB.
fn bombs(bytes: &[u8], body: usize, points: usize) -> Vec<Vec<u8>> {
    let set = |at: usize, value: u32| {
        let mut bytes = bytes.to_vec();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        bytes
    };
    // The header agrees with the announced size: 22 bytes for each of 195 000 000 points.
    let many = 195_000_000_usize;
    let text =
        String::from_utf8_lossy(&bytes[..body]).replace(&format!(" {points}\n"), &format!(" {many}\n"));
    let mut agreeing = [text.as_bytes(), &bytes[body..]].concat();
    let size = text.len() + 4;
    agreeing[size..size + 4].copy_from_slice(&(many as u32 * 22).to_le_bytes());
    vec![set(body, u32::MAX), set(body + 4, u32::MAX), agreeing]
}

#[test]
fn promises_are_not_believed() {
    const POINTS: usize = 3000;
    const MOST: u64 = 16 << 20;
    let files = good_files(POINTS);
    let mut damaged = Vec::new();
    for good in &files {
        assert_eq!(good.format.read(&good.bytes).unwrap().points.len(), POINTS, "{}", good.name);
        damaged.extend(multiplied(&good.bytes, good.body).into_iter().map(|b| (good, b)));
        if good.name == "PCD Compressed" {
            damaged.extend(bombs(&good.bytes, good.body, POINTS).into_iter().map(|b| (good, b)));
        }
    }
    for shape in ["(0, 99999999999999999, 3)", "(99999999999999999, 0, 3)", "(99999999999999999, 0)"] {
        let file = npy_bytes("<f4", true, shape, &[]);
        assert!(npy::read(&file).map_or(true, |cloud| cloud.points.is_empty()));
        assert!(npy::read_scalars(&file).map_or(true, |scalars| scalars.is_empty()));
    }
    let Some((before, _filler)) = close_to_the_peak() else {
        eprintln!("skipped: no /proc/self/status");
        return;
    };
    let mut errors = 0;
    for (good, bytes) in &damaged {
        let read = good.format.read(bytes);
        if good.format == Format::Npy {
            let _ = (npy::read_labels(bytes), npy::read_scalars(bytes));
        }
        errors += usize::from(read.is_err());
        // Version numbers and viewpoints may change freely, but points never come from nothing.
        assert!(read.is_err() || read.unwrap().points.len() <= POINTS, "{}", good.name);
        let asked = peak().unwrap() - before;
        assert!(
            asked < MOST,
            "{}: {asked} bytes for {:?}",
            good.name,
            String::from_utf8_lossy(&bytes[..good.body])
        );
    }
    assert!(errors > damaged.len() / 2, "{errors} errors of {}", damaged.len());

    // The measure itself: memory that is asked for and never touched counts.
    let room: Vec<u8> = Vec::with_capacity(MOST as usize + (1 << 20));
    std::hint::black_box(&room);
    assert!(peak().unwrap() - before >= MOST, "the peak does not count untouched memory");
}
