//! The limit on the numbers from a file takes effect before they are read.

use crate::common::files;

use std::path::Path;

use files::{npy, npy_header, spec, wav};
use htex_recording::{MOST_VALUES, ReadOptions, recording_from_bytes};

fn read(name: &str, bytes: &[u8], most_values: Option<usize>) -> Result<usize, String> {
    let rate_hz = (!name.ends_with("wav")).then_some(1_000.0);
    let options = ReadOptions::default().with_rate_hz(rate_hz).with_most_values(most_values);
    let read = recording_from_bytes(Path::new(name), bytes, &options);
    read.map(|r| r.samples()).map_err(|error| error.to_string())
}

/// With a limit equal to its numbers, the whole file is read. With a lower limit, nothing beyond
/// the limit is parsed, such as the invalid text at the end of `more`.
fn check_limit(name: &str, whole: &[u8], more: &[u8], most_values: usize, samples: usize) {
    assert_eq!(read(name, whole, Some(most_values)), Ok(samples));
    let broken = read(name, more, None).unwrap_err();
    for (bytes, most) in [(whole, most_values - 1), (more, most_values)] {
        let refused = read(name, bytes, Some(most)).unwrap_err();
        assert!(
            refused != broken && refused.contains(&format!("more than {most} numbers")),
            "{refused}"
        );
        assert!(refused.contains("raise the limit"), "{refused}");
    }
}

#[test]
fn numbers_beyond_the_limit_are_refused_before_they_are_read() {
    // Longer than a block, with an unused column. The start of the rows and each gap between them
    // take as much memory as two numbers.
    let rows = "1,2,oiled\n".repeat(40_000);
    let csv = format!("lateral_n,normal_n,what\n{rows}\n1,2,dry\n");
    let values = 2 * 40_001 + 2;
    let more = format!("{csv}1,2,dry\n1,nonsense,dry\n");
    check_limit("r.csv", csv.as_bytes(), more.as_bytes(), values, 40_001);

    let whole = wav(spec(2, 8), &[0.5; 40]);
    let more = wav(spec(2, 8), &[0.5; 42]);
    check_limit("r.wav", &whole, &more[..50], 40, 20);

    let data = [0; 160];
    let whole = npy(&npy_header("<f4", "False", "(20, 2)"), &data);
    let more = npy(&npy_header("<f4", "False", "(21, 2)"), &data);
    check_limit("r.npy", &whole, &more, 40, 20);
    let endless = npy(&npy_header("<f4", "False", "(4000000000,)"), &data);
    let refused = read("r.npy", &endless, None).unwrap_err();
    assert!(refused.contains(&MOST_VALUES.to_string()), "{refused}");
}
