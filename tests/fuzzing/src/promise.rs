//! The promises that hold for any input.

use std::fmt::Display;

use htex::Texture;
use htex_base::finding::{Finding, Rule};
use htex_host::{HostError, Status};

/// Longest error text. Quotations from the input are bounded.
const LONGEST: usize = 20_000;
/// Samples in a block.
const BLOCK: usize = 64;

/// Asserts that an error is a sentence: one line of text without control characters.
pub(crate) fn sentence(error: &impl Display) {
    let text = error.to_string();
    assert!(!text.trim().is_empty(), "an error without words");
    assert!(text.len() <= LONGEST, "an error of {} bytes", text.len());
    let control = text.chars().find(|c| c.is_control());
    assert!(control.is_none(), "{control:?} in the error {text:?}");
}

const RULES: [&[Rule]; 4] =
    [htex_format::RULES, htex_format::library::RULES, htex_scene::RULES, htex_lab::study::RULES];

/// Asserts that findings have an explained code, and a sentence.
pub(crate) fn findings(findings: &[Finding]) {
    for finding in findings {
        let mut rules = RULES.iter().copied().flatten();
        assert!(rules.any(|rule| rule.code == finding.code), "{}", finding.code);
        sentence(finding);
    }
}

/// A built-in model may refuse but must not panic.
pub(crate) fn refusal(error: &htex::Error) {
    sentence(error);
    if let htex::Error::Model(error) = error {
        host_refusal(error);
    }
}

/// As [`refusal`].
pub(crate) fn host_refusal(error: &HostError) {
    sentence(error);
    match error {
        HostError::Call { status, .. } => assert_ne!(*status, Status::Panicked, "{error}"),
        HostError::Broken { .. } => panic!("{error}"),
        _ => {}
    }
}

pub(crate) fn finite(what: &str, numbers: impl IntoIterator<Item = f64>) {
    for (i, number) in numbers.into_iter().enumerate() {
        assert!(number.is_finite(), "{what}[{i}] is {number}");
    }
}

/// Plays each representation of an asset with the built-in models, moves the finger, and computes
/// magnitudes.
pub(crate) fn play(asset: &Texture) {
    let band = asset.band();
    let edges = [band.low_hz, 0.5 * (band.low_hz + band.high_hz), band.high_hz];
    for representation in &asset.manifest().representations {
        let representation =
            asset.representation(representation.model.as_str()).expect("it is listed");
        match representation.magnitude(None, &edges) {
            Ok(magnitude) => finite("magnitude", magnitude),
            Err(error) => refusal(&error),
        }
        match representation.voice(&htex::VoiceOptions::default().with_rate_hz(8000.0)) {
            Ok(mut voice) => listen(&mut voice),
            Err(error) => refusal(&error),
        }
    }
}

fn listen(voice: &mut htex::Voice) {
    let mut block = [f32::NAN; BLOCK];
    for motion in [None, Some((80.0, 0.4)), Some((1e6, 0.0)), Some((0.0, 1e6))] {
        if let Some((speed, force)) = motion
            && let Err(error) = voice.set_motion(htex::Motion::new(speed, force))
        {
            refusal(&error);
        }
        if let Err(error) = voice.render(&mut block) {
            refusal(&error);
        }
        finite("sample", block.map(f64::from));
    }
}

/// An asset that was read can be written, and reads back the same.
pub(crate) fn round_trip(asset: &htex_format::Asset) {
    let bytes = asset.to_bytes().unwrap_or_else(|e| panic!("opens, and cannot be written: {e}"));
    let again = htex_format::Asset::from_bytes(&bytes).expect("what is written can be read");
    assert_eq!(again.manifest, asset.manifest.rounded());
    assert_eq!(again.parameters, asset.parameters);
    assert_eq!(again.reference, asset.reference);
    assert_eq!(again.plugins, asset.plugins);
    let once_more = again.to_bytes().expect("what was written can be written");
    assert!(once_more == bytes, "the same asset gives other bytes");
}
