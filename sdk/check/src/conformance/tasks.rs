//! Reads the conformance files: the questions to a reader, and the expected answers.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::{Value, json};

use super::answer::{Found, Verdict};
use super::compare::{Case, Numbers};
use super::{ConformanceError, Part};

/// Largest JSON file that is read, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// The code that a reader need not report: a note that depends on what the reader assumes.
const NOT_COMPARED: &str = "RECORDING_NOTED";

/// One run of a reader.
#[derive(Debug)]
pub(super) struct Task {
    pub(super) part: Part,
    /// The file's name, without its folder.
    pub(super) name: String,
    pub(super) asked: Asked,
    /// Limits and arguments with which the file is read; an empty object if there are none.
    pub(super) options: Value,
    pub(super) expected: Expected,
}

/// The file that a reader gets.
#[derive(Debug)]
pub(super) enum Asked {
    File(PathBuf),
    /// A file that is written for the run, with this content.
    Question(Value),
}

#[derive(Debug)]
pub(super) struct Expected {
    pub(super) verdict: Verdict,
    /// `None` if the file is not a test for validators.
    pub(super) findings: Option<Vec<Found>>,
    pub(super) values: Values,
}

#[derive(Debug)]
pub(super) enum Values {
    None,
    /// The hashes of a baked block's samples.
    Hashes(Vec<(&'static str, String)>),
    /// The numbers of each case.
    Cases(Vec<Case>),
}

/// A report of `*.report.json`.
#[derive(Deserialize)]
struct ReportFile {
    file: String,
    valid: bool,
    findings: Vec<Found>,
    #[serde(default)]
    limits: Option<Value>,
    #[serde(default)]
    arguments: Vec<String>,
}

#[derive(Deserialize)]
struct BakedFile {
    block: String,
    valid: bool,
    #[serde(default)]
    rule: Option<String>,
    #[serde(default)]
    seed: Value,
    #[serde(default)]
    steps: Value,
    #[serde(default)]
    samples: Option<Hashed>,
    #[serde(default)]
    integers: Option<Hashed>,
}

#[derive(Deserialize)]
struct Hashed {
    sha256: String,
    #[serde(default)]
    full_scale_bits: Option<String>,
}

#[derive(Deserialize)]
struct PlayingFile {
    asset: String,
    frequency_hz: Vec<f64>,
    cases: Vec<PlayingCase>,
}

#[derive(Deserialize)]
struct PlayingCase {
    model: String,
    #[serde(default)]
    speed_mm_s: Option<f64>,
    #[serde(default)]
    force_n: Option<f64>,
    /// Whether a player refuses the mix, instead of playing it.
    #[serde(default)]
    refused: bool,
    #[serde(default)]
    parameters: Vec<f64>,
    #[serde(default)]
    frequency_factor: f64,
    #[serde(default)]
    level_rms: f64,
    #[serde(default)]
    magnitude: Vec<f64>,
}

/// Reads the conformance files of a part, sorted by name. A part without a folder has none.
pub(super) fn tasks(files: &Path, part: Part) -> Result<Vec<Task>, ConformanceError> {
    let folder = files.join(part.folder());
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let folder = std::path::absolute(&folder)
        .map_err(|error| ConformanceError::File { path: folder.clone(), error })?;
    let ending = match part {
        Part::Baked | Part::Playing => ".json",
        _ => ".report.json",
    };
    let failed = |error| ConformanceError::File { path: folder.clone(), error };
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&folder).map_err(failed)? {
        let name = entry.map_err(failed)?.file_name().to_string_lossy().into_owned();
        if name.ends_with(ending) {
            names.push(name);
        }
    }
    names.sort();
    names.iter().map(|name| task(&folder, part, name)).collect()
}

fn task(folder: &Path, part: Part, name: &str) -> Result<Task, ConformanceError> {
    let path = folder.join(name);
    match part {
        Part::Baked => Ok(baked(folder, read(&path)?)),
        Part::Playing => Ok(playing(folder, read(&path)?)),
        _ => Ok(reported(folder, part, read(&path)?)),
    }
}

fn reported(folder: &Path, part: Part, report: ReportFile) -> Task {
    let mut options = json!({});
    if let Some(limits) = report.limits {
        options["limits"] = limits;
    }
    if !report.arguments.is_empty() {
        options["arguments"] = report.arguments.into();
    }
    Task {
        part,
        asked: Asked::File(folder.join(&report.file)),
        name: report.file,
        options,
        expected: Expected {
            verdict: Verdict::of(report.valid),
            findings: Some(report.findings.into_iter().filter(is_compared).collect()),
            values: Values::None,
        },
    }
}

/// Returns whether a finding is compared.
pub(super) fn is_compared(found: &Found) -> bool {
    found.code != NOT_COMPARED
}

fn baked(folder: &Path, file: BakedFile) -> Task {
    let full_scale = file.integers.as_ref().and_then(|of| of.full_scale_bits.clone());
    let hash = |name, of: Option<Hashed>| of.map(|of| (name, of.sha256));
    let hashes = [hash("samples_sha256", file.samples), hash("integers_sha256", file.integers)];
    let rule = file.rule.map(|code| Found { code, pointer: String::new() });
    Task {
        part: Part::Baked,
        asked: Asked::Question(json!({
            "block": folder.join(&file.block),
            "seed": file.seed,
            "steps": file.steps,
            "full_scale_bits": full_scale,
        })),
        name: file.block,
        options: json!({}),
        expected: Expected {
            verdict: Verdict::of(file.valid),
            findings: Some(rule.into_iter().collect()),
            values: if file.valid {
                Values::Hashes(hashes.into_iter().flatten().collect())
            } else {
                Values::None
            },
        },
    }
}

fn playing(folder: &Path, file: PlayingFile) -> Task {
    let asked: Vec<Value> = file
        .cases
        .iter()
        .map(|case| {
            let mut asked = json!({ "model": case.model });
            for (key, value) in [("speed_mm_s", case.speed_mm_s), ("force_n", case.force_n)] {
                if let Some(value) = value {
                    asked[key] = value.into();
                }
            }
            asked
        })
        .collect();
    let cases = file.cases.into_iter().map(|case| Case {
        what: match (case.speed_mm_s, case.force_n) {
            (Some(speed), Some(force)) => format!("{} at {speed} mm/s, {force} N", case.model),
            (Some(speed), None) => format!("{} at {speed} mm/s", case.model),
            (None, Some(force)) => format!("{} at {force} N", case.model),
            (None, None) => format!("{} without a motion", case.model),
        },
        expected: (!case.refused).then_some(Numbers {
            parameters: case.parameters,
            frequency_factor: case.frequency_factor,
            level_rms: case.level_rms,
            magnitude: case.magnitude,
        }),
    });
    Task {
        part: Part::Playing,
        asked: Asked::Question(json!({
            "asset": folder.join(&file.asset),
            "frequency_hz": file.frequency_hz,
            "cases": asked,
        })),
        name: file.asset,
        options: json!({}),
        expected: Expected {
            verdict: Verdict::Valid,
            findings: None,
            values: Values::Cases(cases.collect()),
        },
    }
}

/// Reads a JSON file of bounded size.
fn read<T: for<'de> Deserialize<'de>>(path: &Path) -> Result<T, ConformanceError> {
    let failed = |error| ConformanceError::File { path: path.to_owned(), error };
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(MOST_BYTES).read_to_end(&mut bytes))
        .map_err(failed)?;
    serde_json::from_slice(&bytes).map_err(|error| ConformanceError::Files {
        path: path.to_owned(),
        problem: format!("it is not a conformance file of this version: {error}"),
    })
}
