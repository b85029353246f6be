use std::path::{Path, PathBuf};

use clap::{Args, Parser};
use htex::play::exploration::CEILING;
use htex::{Motion, Representation, Texture};
use htex_base::files::{AtFile, read_regular};
use htex_base::finding::Report;
use htex_check::conformance::Part;
use htex_format::library::{Limits as LibraryLimits, LocalFile, validate_source};
use htex_format::{Limits, validate_with};
use htex_host::Registry;
use htex_player::{Block, OpenError, Player};
use serde::Deserialize;
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};

use crate::assets::read_asset;
use crate::failure::{Exit, Failure, Result, for_file};
use crate::located;
use crate::output::{print_json, shown};
use crate::recordings::RecordingArgs;
use crate::scenes::SceneArgs;

/// Largest question or block that is read, bytes.
const MOST_BYTES: u64 = 16 << 20;

/// Largest number of samples that a question asks for.
const MOST_SAMPLES: usize = 1 << 24;

/// Answer for one conformance file, as a program that `htex conformance run` tests
///
/// Prints htex's own answer for the file, as the JSON object that `spec/conformance-protocol.md`
/// specifies. Compare this answer with the answer of your program.
#[derive(Args)]
pub(crate) struct Answer {
    /// Kind of the file: assets, libraries, scenes, recordings, baked, playing
    part: Part,

    /// The file; for baked and playing, the question
    #[arg(value_parser = located::RECORDING)]
    file: PathBuf,

    /// Limits and arguments, a JSON object
    #[arg(long, default_value = "{}", value_name = "JSON", value_parser = options)]
    options: Asked,
}

/// The options of a file.
#[derive(Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Asked {
    #[serde(default)]
    limits: Map<String, Value>,
    #[serde(default)]
    arguments: Vec<String>,
}

fn options(text: &str) -> Result<Asked, String> {
    serde_json::from_str(text).map_err(|error| error.to_string())
}

/// Arguments for reading a recording.
#[derive(Parser)]
#[command(no_binary_name = true)]
struct Reading {
    #[command(flatten)]
    reading: RecordingArgs,
}

impl Answer {
    pub(crate) fn run(self) -> Result {
        let file = &self.file;
        let limits = &self.options.limits;
        let answer = match self.part {
            Part::Assets => reported(&asset(file, limits)?),
            Part::Libraries => reported(&library(file, limits)?),
            Part::Scenes => reported(&SceneArgs::validate(file, None)?),
            Part::Recordings => {
                let given = Reading::try_parse_from(&self.options.arguments);
                let given = given.map_err(|error| Failure::Usage(error.to_string()))?;
                reported(&given.reading.validate(file)?)
            }
            Part::Baked => baked(question(file)?)?,
            Part::Playing => playing(&question(file)?)?,
        };
        print_json(&answer)?;
        Ok(Exit::SUCCESS)
    }
}

fn reported(report: &Report) -> Value {
    let findings = report.findings.iter();
    let findings = findings.map(|one| json!({ "code": one.code, "pointer": one.pointer }));
    json!({
        "verdict": if report.valid { "valid" } else { "invalid" },
        "findings": findings.collect::<Vec<_>>(),
    })
}

/// Sets the limits that a question names, in a struct of limits.
macro_rules! limited {
    ($limits:expr, $given:expr; $($name:ident),*) => {{
        let mut limits = $limits;
        for (name, value) in $given {
            let number = value.as_u64().and_then(|number| number.try_into().ok());
            match (&name[..], number) {
                $((stringify!($name), Some(number)) => limits.$name = limit(number)?,)*
                _ => return Err(Failure::Usage(format!("--options: limit {name}: {value}"))),
            }
        }
        limits
    }};
}

fn limit<T: TryFrom<u64>>(number: u64) -> Result<T> {
    number.try_into().map_err(|_| Failure::usage("--options: a limit is too large"))
}

fn asset(file: &Path, given: &Map<String, Value>) -> Result<Report> {
    let limits = limited!(Limits::default(), given;
        file_bytes, entries, entry_bytes, total_bytes, ratio, json_depth, json_nodes, conditions,
        values);
    let models = Registry::builtin();
    let known = |representation: &htex_format::Representation| {
        Some(htex::play::model_of(&models, representation).ok()?.descriptor())
    };
    Ok(validate_with(&read_asset(file)?, &limits, &known))
}

fn library(file: &Path, given: &Map<String, Value>) -> Result<Report> {
    let limits = limited!(LibraryLimits::default(), given;
        entries, leaves, root_bytes, leaf_bytes, asset_bytes, objects, ratio);
    let source = LocalFile::open(file).map_err(for_file(file))?;
    validate_source(source, &limits).map_err(for_file(file))
}

fn question<T: for<'de> Deserialize<'de>>(file: &Path) -> Result<T> {
    let bytes = read_regular(file, MOST_BYTES).reading(file)?;
    let question = serde_json::from_slice(&bytes);
    question.map_err(|error| Failure::Other(format!("{}: {error}", shown(file))))
}

#[derive(Deserialize)]
struct PlayingQuestion {
    asset: PathBuf,
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
}

fn playing(question: &PlayingQuestion) -> Result<Value> {
    let texture = match Texture::open(&question.asset) {
        Ok(texture) => texture,
        Err(error) => return Ok(json!({ "verdict": "invalid", "problem": error.to_string() })),
    };
    // `null` means that htex refuses the case.
    let cases: Vec<Value> = question
        .cases
        .iter()
        .map(|case| played(&texture, case, &question.frequency_hz).unwrap_or_default())
        .collect();
    Ok(json!({ "verdict": "valid", "values": { "cases": cases } }))
}

fn played(texture: &Texture, case: &PlayingCase, hz: &[f64]) -> Result<Value, htex::Error> {
    let representation = texture.representation(&case.model[..])?;
    let is_given = case.speed_mm_s.is_some() || case.force_n.is_some();
    // The sign of a speed is only its direction.
    let motion =
        is_given.then(|| representation.motion(case.speed_mm_s, case.force_n).without_direction());
    let (parameters, _) = representation.parameters(motion)?;
    Ok(json!({
        "parameters": parameters,
        "frequency_factor": frequency_factor(&representation, motion)?,
        "level_rms": representation.level_rms(motion)?,
        "magnitude": representation.magnitude(motion, hz)?,
    }))
}

/// Returns the factor of frequencies. A model that follows the motion gets the motion instead of a
/// factor, so its factor is 1.
fn frequency_factor(
    representation: &Representation<'_>,
    motion: Option<Motion>,
) -> Result<f64, htex::Error> {
    match motion {
        Some(motion) if !representation.model()?.follows_motion() => {
            Ok(representation.conditions()?.scaling(motion, CEILING).frequency)
        }
        _ => Ok(1.0),
    }
}

#[derive(Deserialize)]
struct BakedQuestion {
    block: PathBuf,
    #[serde(default)]
    seed: Option<u32>,
    #[serde(default)]
    steps: Option<Vec<Step>>,
}

/// A call of a player. The bits of each number (binary32) are written as hexadecimal digits,
/// because some numbers are not finite.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum Step {
    SetMotion { speed_bits: String, force_bits: String },
    Render(usize),
}

fn baked(question: BakedQuestion) -> Result<Value> {
    let bytes = read_regular(&question.block, MOST_BYTES).reading(&question.block)?;
    let block = match Block::open(&bytes) {
        Ok(block) => block,
        Err(error) => {
            let finding = json!({ "code": rule(&error), "pointer": "" });
            return Ok(json!({ "verdict": "invalid", "findings": [finding] }));
        }
    };
    let seed = question.seed.unwrap_or_default();
    let full_scale = block.full_scale();
    let mut floats = Player::new(block, seed);
    let mut integers = Player::new(block, seed);
    let (mut of_floats, mut of_integers) = (Sha256::new(), Sha256::new());
    let mut left = MOST_SAMPLES;
    for step in question.steps.unwrap_or_default() {
        match step {
            Step::SetMotion { speed_bits, force_bits } => {
                let (speed, force) = (float(&speed_bits)?, float(&force_bits)?);
                floats.set_motion(speed, force);
                integers.set_motion(speed, force);
            }
            Step::Render(count) => {
                left = left.checked_sub(count).ok_or_else(|| {
                    Failure::Other(format!("it asks for more than {MOST_SAMPLES} samples"))
                })?;
                let (mut samples, mut steps) = (vec![0.0f32; count], vec![0i16; count]);
                floats.render(&mut samples);
                integers.render_i16(&mut steps, full_scale);
                samples.iter().for_each(|x| of_floats.update(x.to_le_bytes()));
                steps.iter().for_each(|x| of_integers.update(x.to_le_bytes()));
            }
        }
    }
    Ok(json!({
        "verdict": "valid",
        "findings": [],
        "values": {
            "samples_sha256": hex(&of_floats.finalize()),
            "integers_sha256": hex(&of_integers.finalize()),
        },
    }))
}

fn float(bits: &str) -> Result<f32> {
    let bits = u32::from_str_radix(bits, 16);
    bits.map(f32::from_bits)
        .map_err(|error| Failure::Other(format!("the bits of a number: {error}")))
}

/// Returns the rule that a block breaks, by its name in the specification.
fn rule(error: &OpenError) -> &'static str {
    match error {
        OpenError::TooShort => "too_short",
        OpenError::NotABlock => "not_a_block",
        OpenError::Version => "version",
        OpenError::Length => "length",
        OpenError::Checksum => "checksum",
        OpenError::Header => "header",
        OpenError::Axes => "axes",
        _ => "values",
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
