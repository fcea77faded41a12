//! Memory that a process asks for, and files that ask for too much.

/// Peak of the address space asked for so far, in bytes; `None` where the system does not tell.
pub fn peak() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmPeak:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib * 1024)
}

/// The peak, and memory that brings the process within a mebibyte of it: what the start of a thread reserved and gave
/// back would otherwise hide what is asked for later.
pub fn close_to_the_peak() -> Option<(u64, Vec<Vec<u8>>)> {
    let before = peak()?;
    let mut filler = Vec::new();
    while peak()? == before {
        filler.push(std::hint::black_box(Vec::with_capacity(1 << 20)));
    }
    Some((peak()?, filler))
}

/// Every file made from a good one by multiplying one of the numbers in its header.
pub fn multiplied(bytes: &[u8], body: usize) -> Vec<Vec<u8>> {
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
pub fn bombs(bytes: &[u8], body: usize, points: usize) -> Vec<Vec<u8>> {
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
