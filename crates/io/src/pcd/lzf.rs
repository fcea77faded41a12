//! Unpacking LZF, the compression of PCD's `binary_compressed`.
//!
//! A stream is a sequence of runs. A byte `c` below 32 starts `c + 1` literal bytes. Any other starts a copy of earlier
//! output: its upper three bits are the length minus 2 (7 says that the next byte is to be added), its lower five bits
//! and the last byte of the run the distance minus 1. A copy may overlap its own output. (LibLZF by Marc Lehmann.)

/// Why an LZF stream was refused. Offsets are in bytes from its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LzfError {
    /// The stream ends within a run.
    #[error("the stream ends within the run that starts at its byte {at}")]
    Truncated {
        /// Where the run starts.
        at: usize,
    },
    /// A copy reaches back before the first byte of the output.
    #[error(
        "the run at byte {at} of the stream copies from {distance} bytes back, but only {unpacked} are there"
    )]
    BeforeStart {
        /// Where the run starts.
        at: usize,
        /// How far it reaches back.
        distance: usize,
        /// Bytes unpacked so far.
        unpacked: usize,
    },
    /// The stream yields another number of bytes than announced.
    #[error("the stream yields {unpacked} bytes instead of {announced}")]
    Size {
        /// Bytes it yields, counted up to the first run beyond the announced size.
        unpacked: usize,
        /// Bytes announced.
        announced: usize,
    },
}

/// One run of a stream.
enum Run<'a> {
    Literal(&'a [u8]),
    Copy { distance: usize, length: usize },
}

/// Unpacks a stream that yields exactly `announced` bytes. The stream is measured first, so that no memory is asked for
/// that it does not fill.
///
/// # Errors
/// [`LzfError`] when the stream is cut or damaged, or yields another number of bytes.
pub(super) fn unpack(stream: &[u8], announced: usize) -> Result<Vec<u8>, LzfError> {
    let mut unpacked = 0;
    each_run(stream, |at, run| {
        unpacked += match run {
            Run::Literal(bytes) => bytes.len(),
            Run::Copy { distance, .. } if distance > unpacked => {
                return Err(LzfError::BeforeStart { at, distance, unpacked });
            }
            Run::Copy { length, .. } => length,
        };
        if unpacked > announced { Err(LzfError::Size { unpacked, announced }) } else { Ok(()) }
    })?;
    if unpacked != announced {
        return Err(LzfError::Size { unpacked, announced });
    }

    let mut output = Vec::with_capacity(announced);
    each_run(stream, |_, run| {
        match run {
            Run::Literal(bytes) => output.extend_from_slice(bytes),
            Run::Copy { distance, length } => copy(&mut output, distance, length),
        }
        Ok(())
    })?;
    Ok(output)
}

/// Appends `length` bytes from `distance` back, each of which may be one just appended.
fn copy(output: &mut Vec<u8>, distance: usize, length: usize) {
    let start = output.len().saturating_sub(distance);
    if distance >= length {
        output.extend_from_within(start..start + length);
        return;
    }
    // The bytes from `start` on repeat with the distance as period, so that each round can copy all there are.
    let end = output.len() + length;
    while output.len() < end {
        let piece = (output.len() - start).min(end - output.len());
        output.extend_from_within(start..start + piece);
    }
}

/// Calls `take` with the start and content of each run.
fn each_run<'a>(
    stream: &'a [u8],
    mut take: impl FnMut(usize, Run<'a>) -> Result<(), LzfError>,
) -> Result<(), LzfError> {
    let mut at = 0;
    while let Some((&control, rest)) = stream.get(at..).and_then(<[u8]>::split_first) {
        let (run, size) = run(control, rest).ok_or(LzfError::Truncated { at })?;
        take(at, run)?;
        at += 1 + size;
    }
    Ok(())
}

/// The run that starts with `control`, and how many bytes it has beyond that one.
fn run(control: u8, rest: &[u8]) -> Option<(Run<'_>, usize)> {
    let (high, low) = (usize::from(control >> 5), usize::from(control & 31));
    match high {
        0 => Some((Run::Literal(rest.get(..=low)?), low + 1)),
        7 => {
            let [more, near] = rest.first_chunk()?;
            Some((
                Run::Copy { distance: (low << 8) + usize::from(*near) + 1, length: 9 + usize::from(*more) },
                2,
            ))
        }
        _ => {
            let near = rest.first()?;
            Some((Run::Copy { distance: (low << 8) + usize::from(*near) + 1, length: high + 2 }, 1))
        }
    }
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn literal_vectors() {
        assert_eq!(unpack(&[], 0), Ok(vec![]));
        assert_eq!(unpack(&[2, b'a', b'b', b'c'], 3), Ok(b"abc".to_vec()));
        // "ab", then 5 bytes from 2 back: the copy overlaps itself.
        assert_eq!(unpack(&[1, b'a', b'b', 3 << 5, 1], 7), Ok(b"abababa".to_vec()));
        // "z", then the longest copy there is: 264 bytes from 1 back.
        assert_eq!(unpack(&[0, b'z', 0xe0, 255, 0], 265), Ok(vec![b'z'; 265]));
        // Two literals, a copy of 17 with its length in two bytes, and a literal.
        assert_eq!(unpack(&[1, 97, 97, 224, 8, 0, 0, 97], 20), Ok(vec![b'a'; 20]));
        // The farthest copy: 3 bytes from 8192 back.
        let mut stream = Vec::new();
        let output: Vec<u8> = (0..8192_u16).map(|i| (i % 251) as u8).collect();
        for literal in output.chunks(32) {
            stream.push(31);
            stream.extend_from_slice(literal);
        }
        stream.extend([0x3f, 255]);
        let expected = [&output[..], &[0, 1, 2]].concat();
        assert_eq!(unpack(&stream, 8195), Ok(expected));
    }

    #[test]
    fn damaged_streams() {
        assert_eq!(unpack(&[2, b'a', b'b'], 3), Err(LzfError::Truncated { at: 0 }));
        assert_eq!(unpack(&[0, b'a', 0xe0, 1], 11), Err(LzfError::Truncated { at: 2 }));
        assert_eq!(unpack(&[0, b'a', 0x20], 4), Err(LzfError::Truncated { at: 2 }));
        assert_eq!(
            unpack(&[0, b'a', 0x20, 1], 4),
            Err(LzfError::BeforeStart { at: 2, distance: 2, unpacked: 1 })
        );
        assert_eq!(unpack(&[0, b'a'], 2), Err(LzfError::Size { unpacked: 1, announced: 2 }));
        assert_eq!(unpack(&[1, b'a', b'b'], 1), Err(LzfError::Size { unpacked: 2, announced: 1 }));
        // Nothing near the announced size is asked for: this would be refused by any allocator.
        assert_eq!(
            unpack(&[0, b'a'], usize::MAX),
            Err(LzfError::Size { unpacked: 1, announced: usize::MAX })
        );
    }

    /// Packs greedily: the longest earlier match, else a literal.
    fn pack(input: &[u8]) -> Vec<u8> {
        let (mut stream, mut literal, mut at) = (Vec::new(), Vec::new(), 0);
        let flush = |stream: &mut Vec<u8>, literal: &mut Vec<u8>| {
            for piece in literal.chunks(32) {
                stream.push((piece.len() - 1) as u8);
                stream.extend_from_slice(piece);
            }
            literal.clear();
        };
        while at < input.len() {
            let matched = |start: usize| {
                input[start..].iter().zip(&input[at..]).take(264).take_while(|(a, b)| a == b).count()
            };
            let best = (at.saturating_sub(8192)..at).map(|s| (matched(s), s)).max().unwrap_or((0, 0));
            let length = best.0;
            if length < 3 {
                literal.push(input[at]);
                at += 1;
                continue;
            }
            flush(&mut stream, &mut literal);
            let distance = at - best.1 - 1;
            let high = (distance >> 8) as u8;
            match length - 2 {
                short @ ..7 => stream.push((short as u8) << 5 | high),
                long => stream.extend([7 << 5 | high, (long - 7) as u8]),
            }
            stream.push(distance as u8);
            at += length;
        }
        flush(&mut stream, &mut literal);
        stream
    }

    proptest! {
        #[test]
        fn what_was_packed_comes_back(
            input in prop_oneof![
                prop::collection::vec(0_u8..4, 0..600),
                prop::collection::vec(any::<u8>(), 0..600),
                (any::<u8>(), 0_usize..3000).prop_map(|(byte, n)| vec![byte; n]),
            ]
        ) {
            let stream = pack(&input);
            prop_assert_eq!(unpack(&stream, input.len()), Ok(input.clone()));
            if let Some((_, cut)) = stream.split_last() {
                prop_assert!(unpack(cut, input.len()).is_err());
            }
        }

        #[test]
        fn any_bytes_are_unpacked_or_refused(stream in prop::collection::vec(any::<u8>(), 0..200), size in 0_usize..2000) {
            if let Ok(output) = unpack(&stream, size) {
                prop_assert_eq!(output.len(), size);
                prop_assert!(size <= 88 * stream.len());
            }
        }
    }
}
