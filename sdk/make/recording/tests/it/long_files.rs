//! Files longer than one block of 256 KiB are read like shorter ones, with the same line numbers in
//! errors.

use std::path::Path;

use htex_recording::Recording;
use htex_recording::{ReadOptions, recording_from_bytes};

const BLOCK: usize = 256 << 10;

fn read(text: impl AsRef<[u8]>) -> Result<Recording, String> {
    let options = ReadOptions::default().with_rate_hz(1_000.0);
    let read = recording_from_bytes(Path::new("long.csv"), text.as_ref(), &options);
    read.map_err(|error| error.to_string())
}

/// A row of 16 bytes.
fn row(n: usize) -> String {
    format!("{:07},{:07}\n", n % 9_973, n % 131)
}

const ROWS: usize = 60_000;

#[test]
fn all_rows_are_read_and_lines_are_counted_through() {
    let mut text = String::from("\u{feff}lateral_n,normal_n\n");
    let mut lines = 1;
    for n in 0..ROWS {
        text += &row(n);
        lines += 1;
        if n % 1_000 == 17 {
            text += "\n# Simulated, in the end\n";
            lines += 2;
        }
    }
    let recording = read(&text).unwrap();
    assert!(recording.simulated);
    let expected: Vec<f64> = (0..ROWS).map(|n| (n % 9_973) as f64).collect();
    assert_eq!(recording.axes, [expected]);
    let error = read(format!("{text}1,nonsense\n1,1\n")).unwrap_err();
    assert!(error.contains(&format!("line {}", lines + 1)), "{error}");
    let mut bytes = text.clone().into_bytes();
    bytes.extend(b"1,1\n1,\xff\n");
    let error = read(&bytes).unwrap_err();
    assert!(error.contains(&format!("line {}", lines + 2)), "{error}");
    let timed: String = (0..ROWS)
        .map(|n| format!("{:.3},{:07}\n", n as f64 * 1e-3 + f64::from(n >= 50_000), n % 131))
        .collect();
    let gap = read(format!("t_s,lateral_n\n\n{timed}")).unwrap();
    let told = gap.clock_findings.iter().any(|found| found.message.contains("line 50003"));
    assert!(told, "{:?}", gap.clock_findings);
}

/// A short row is reported as truncated only at the end of the file, wherever the blocks end.
#[test]
fn a_short_row_is_cut_off_at_the_end_alone() {
    for pad in 0..16 {
        let mut text = format!("#{}\nlateral_n,normal_n\n", "-".repeat(pad));
        let before = (BLOCK - text.len() - 8) / 16;
        (0..before).for_each(|n| text += &row(n));
        let line = before + 3;
        text += "1234567\n";
        let cut = read(&text).unwrap_err();
        assert!(cut.contains("truncated") && cut.contains(&format!("{line}")), "{cut}");
        for behind in ["1,1\n", "\n# Notes\n\n1,1\n"] {
            let ragged = read(format!("{text}{behind}")).unwrap_err();
            assert!(!ragged.contains("truncated"), "{ragged}");
            assert!(ragged.contains(&format!("{line}")), "{ragged}");
        }
    }
}

#[test]
fn comments_and_lines_may_be_longer_than_a_block() {
    let comments = "# a long story\n".repeat(60_000);
    let recording = read(format!("{comments}lateral_n\n1\n2\n3\n")).unwrap();
    assert_eq!(recording.axes, [[1.0, 2.0, 3.0]]);
    for long in ["1".repeat(3 * BLOCK), "é".repeat(2 * BLOCK)] {
        let error = read(format!("lateral_n\n1\n2\n{long}\n3\n")).unwrap_err();
        assert!(error.contains("line 4") && error.contains("long"), "{error}");
    }
}
