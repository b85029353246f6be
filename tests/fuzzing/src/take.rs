//! Part files of takes, which a killed program leaves behind.

use std::path::{Path, PathBuf};

use htex_lab::record::{Outcome, recover};

use crate::promise::sentence;

/// First byte of an input whose chunks get their lengths and hashes here.
const BUILT: u8 = b'B';
/// Size of a value, bytes.
const VALUE: usize = 8;

/// Recovers a part file in its own folder. The input is the file itself or, after a byte `B`, the
/// header's line and pieces that become chunks: a byte for the kind, one for the number of values,
/// and the values.
pub fn take_part(input: &[u8]) -> bool {
    let bytes = match input {
        [BUILT, rest @ ..] => built(rest),
        bytes => bytes.to_vec(),
    };
    let outer = tempfile::tempdir().expect("a folder");
    let folder = outer.path().join("takes");
    std::fs::create_dir(&folder).expect("it can be written");
    let part = folder.join("seed-001.part");
    std::fs::write(&part, &bytes).expect("it can be written");
    let recovered = recover(&folder);
    let only = std::fs::read_dir(outer.path()).expect("it is there").count();
    assert_eq!(only, 1, "a file beside the folder");
    let takes = match recovered {
        Ok(takes) => takes,
        Err(error) => {
            sentence(&error);
            assert_eq!(std::fs::read(&part).ok(), Some(bytes), "it stays as it was");
            return false;
        }
    };
    assert!(!part.exists(), "a part that was recovered is removed");
    for take in &takes {
        let place = match take.outcome {
            Outcome::Kept => folder.clone(),
            Outcome::Rejected => folder.join("rejected"),
            Outcome::Incomplete => folder.join("incomplete"),
        };
        assert_eq!(take.file.parent(), Some(&place as &Path));
        assert!(take.file.is_file() && beside(&take.file).is_file());
        take.verdict.reasons.iter().for_each(sentence);
        take.verdict.findings.iter().for_each(sentence);
    }
    !takes.is_empty()
}

fn beside(file: &Path) -> PathBuf {
    file.with_extension("json")
}

/// Makes a part file with valid lengths and hashes.
pub(crate) fn built(input: &[u8]) -> Vec<u8> {
    let header = input.iter().position(|b| *b == b'\n');
    let (header, mut rest) = input.split_at(header.map_or(input.len(), |end| end + 1));
    let mut bytes = header.to_vec();
    while let [kind, count, values @ ..] = rest {
        let length = (VALUE * usize::from(*count)).min(values.len());
        let start = bytes.len();
        bytes.push(*kind);
        bytes.extend((length as u32).to_le_bytes());
        bytes.extend(&values[..length]);
        let hash = blake3::hash(&bytes[start..]);
        bytes.extend(&hash.as_bytes()[..8]);
        rest = &values[length..];
    }
    bytes
}
