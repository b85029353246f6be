//! Checks of the manifest's values.

use std::collections::BTreeSet;

use crate::check_plugins::check_plugins;
use crate::check_representation::{check_representations, is_size};
use crate::doi::check_doi;
use crate::error::MetadataError;
use crate::license::check_license;
use htex_model::Band;

use crate::law::{Law, MOST_EXPONENT};
use crate::manifest::{CODED, Condition, HATT, Manifest};
use crate::rules as rule;
use crate::{APPEARANCE, Fluctuation};
use htex_base::finding::Findings;
use htex_base::finding::escape;

/// Highest allowed upper edge of a band, hertz.
const HIGHEST_HZ: f64 = 20_000.0;

/// Counts the multiples of 5 Hz from the band's lower edge to its upper edge, both included: 197
/// for 20 to 1000 Hz. Returns `None` for an invalid band.
pub(crate) fn grid_points(band: Band) -> Option<usize> {
    // Only valid bands are counted, because a band up to 1e300 Hz has more points than `usize`
    // holds.
    let valid = 0.0 < band.low_hz && band.low_hz < band.high_hz && band.high_hz <= HIGHEST_HZ;
    valid.then(|| band.bins()).filter(|points| *points > 0)
}

/// Adds a finding for each rule that the manifest breaks, without looking at other entries.
pub(crate) fn check_manifest(manifest: &Manifest, findings: &mut Findings) {
    check_words(manifest, findings);
    let band = manifest.band;
    findings.require(grid_points(band).is_some(), rule::BAND_INVALID, "/band", || {
        format!("{} to {} Hz is not a valid band; write 20 to 1000", band.low_hz, band.high_hz)
    });
    check_sources(manifest, findings);
    check_made(manifest, findings);
    let are_sound = check_conditions(&manifest.conditions, findings);
    check_law(manifest, findings);
    check_fluctuation(manifest, findings);
    check_representations(manifest, are_sound, findings);
    check_plugins(manifest, findings);
    check_extensions(manifest, findings);
}

fn check_words(manifest: &Manifest, findings: &mut Findings) {
    let named = !manifest.name.trim().is_empty();
    findings
        .require(named, rule::NAME_EMPTY, "/name", || "the name is empty; write one".to_owned());
    findings.require(manifest.license.is_some(), rule::LICENSE_MISSING, "", || {
        "there is no license; add an SPDX expression".to_owned()
    });
    if let Some(Err(error)) = manifest.license.as_deref().map(check_license) {
        findings.add(error.rule(), "/license", error.to_string());
    }
    if let Some(Err(error)) = manifest.doi.as_deref().map(check_doi) {
        findings.add(error.rule(), "/doi", error.to_string());
    }
    let (unit, wanted) = (&manifest.unit, manifest.quantity.unit());
    findings.require(unit == wanted, rule::UNIT_UNKNOWN, "/unit", || {
        format!("{unit:?} is not the unit of {}; write {wanted}", manifest.quantity)
    });
}

fn check_sources(manifest: &Manifest, findings: &mut Findings) {
    for (i, source) in manifest.provenance.recordings.iter().enumerate() {
        let at = format_args!("/provenance/recordings/{i}");
        let rate = source.rate_hz;
        let positive = rate.is_finite() && rate > 0.0;
        findings.require(positive, rule::SOURCE_INVALID, format_args!("{at}/rate_hz"), || {
            format!("{rate} Hz is not a valid sampling rate; write the recording's rate")
        });
        let hash = source.blake3.as_deref();
        findings.require(
            hash.is_none_or(is_hash),
            rule::SOURCE_INVALID,
            format_args!("{at}/blake3"),
            || not_a_hash(hash.unwrap_or_default()),
        );
        let plain = !source.file.contains(['/', '\\']);
        findings.require(plain, rule::SOURCE_PATH, format_args!("{at}/file"), || {
            format!("{:?} contains a folder; write only the file name", source.file)
        });
    }
}

fn check_made(manifest: &Manifest, findings: &mut Findings) {
    let made = manifest.provenance.made.iter();
    for (i, part) in made.flat_map(|made| &made.from).enumerate() {
        let at = format_args!("/provenance/made/from/{i}");
        let weight = part.weight;
        findings.require(
            (0.0..=1.0).contains(&weight),
            rule::MADE_INVALID,
            format_args!("{at}/weight"),
            || format!("{weight} is not a part of a mixture; write a number from 0 to 1"),
        );
        findings.require(
            is_hash(&part.blake3),
            rule::MADE_INVALID,
            format_args!("{at}/blake3"),
            || not_a_hash(&part.blake3),
        );
    }
}

/// Returns whether a text is the hash of a file: 64 hexadecimal digits.
fn is_hash(text: &str) -> bool {
    text.len() == 64 && text.bytes().all(|b| b.is_ascii_hexdigit())
}

fn not_a_hash(text: &str) -> String {
    format!("{text:?} is not a hash; write the 64 hexadecimal digits of BLAKE3")
}

/// Checks the conditions. Returns whether they follow all rules.
fn check_conditions(conditions: &[Condition], findings: &mut Findings) -> bool {
    findings.require(!conditions.is_empty(), rule::CONDITIONS_EMPTY, "/conditions", || {
        "there is no condition; add one, or {} when speed and force are not known".to_owned()
    });
    let mut seen = BTreeSet::new();
    let mut are_sound = !conditions.is_empty();
    for (i, condition) in conditions.iter().enumerate() {
        let at = format_args!("/conditions/{i}");
        let numbers = [
            ("speed_mm_s", condition.speed_mm_s),
            ("force_n", condition.force_n),
            ("repeatability_rms_db", condition.repeatability_rms_db),
            ("repeatability_third_octave_rms_db", condition.repeatability_third_octave_rms_db),
        ];
        for (key, number) in numbers {
            if let Some(number) = number.filter(|number| !is_size(*number)) {
                let message =
                    format!("{number} is negative or not finite; remove {key} if it is not known");
                findings.add(rule::CONDITION_INVALID, format!("{at}/{key}"), message);
                are_sound = false;
            }
        }
        // An absent value is compared as 0. Adding zero turns -0 into 0, so that both have the same
        // bits.
        let bits = |number: Option<f64>| (number.unwrap_or(0.0) + 0.0).to_bits();
        let new = seen.insert((bits(condition.speed_mm_s), bits(condition.force_n)));
        findings.require(new, rule::CONDITION_DUPLICATE, at, || {
            "an earlier condition has the same speed and force, of which an absent one counts as 0; keep one".to_owned()
        });
        are_sound &= new;
    }
    are_sound
}

fn check_law(manifest: &Manifest, findings: &mut Findings) {
    let exponents = manifest.law.iter().flat_map(Law::exponents);
    for (key, exponent) in exponents.filter(|(_, exponent)| !exponent.is_valid()) {
        let message = format!(
            "{} is not an exponent of -{MOST_EXPONENT} to {MOST_EXPONENT}, or its error is negative; correct it, \
             or remove `law`",
            exponent.exponent
        );
        findings.add(rule::LAW_INVALID, format!("/law/{key}"), message);
    }
}

fn check_fluctuation(manifest: &Manifest, findings: &mut Findings) {
    let most = Fluctuation::MOST_ERROR_DB;
    let errors = manifest.fluctuation.iter().flat_map(Fluctuation::errors_db);
    for (key, error_db) in errors {
        if let Some(db) = error_db.filter(|db| !(0.0..=most).contains(db)) {
            let message =
                format!("{db} is not an error of 0 to {most} dB; remove {key} if it is not known");
            findings.add(rule::FLUCTUATION_INVALID, format!("/fluctuation/{key}"), message);
        }
    }
}

/// The extensions that this crate knows.
const KNOWN_EXTENSIONS: [&str; 3] = [CODED, APPEARANCE, HATT];

fn check_extensions(manifest: &Manifest, findings: &mut Findings) {
    for name in manifest.extensions.keys() {
        if let Err(error) = check_extension_name(name) {
            findings.add(error.rule(), format!("/extensions/{}", escape(name)), error.to_string());
        }
    }
    for (i, name) in manifest.extensions_required.iter().enumerate() {
        if KNOWN_EXTENSIONS.contains(&&name[..]) {
            continue;
        }
        let pointer = format!("/extensions_required/{i}");
        let message = format!("the asset needs {name:?}, which this reader does not know");
        findings.add(rule::EXTENSION_REQUIRED_UNKNOWN, pointer, message);
    }
}

/// Checks that a name has the form `com.vendor.NAME/REVISION`.
///
/// # Errors
///
/// Returns [`MetadataError::ExtensionName`] for a name of another form.
///
/// ```
/// assert!(htex_format::check_extension_name("com.example.LOOK/1").is_ok());
/// assert!(htex_format::check_extension_name("LOOK").is_err());
/// ```
pub fn check_extension_name(name: &str) -> Result<(), MetadataError> {
    let is_word = |part: &str| {
        let allowed = |b: u8| b.is_ascii_alphanumeric() || b == b'-' || b == b'_';
        !part.is_empty() && part.bytes().all(allowed)
    };
    let is_number = |text: &str| {
        text.starts_with(|c| matches!(c, '1'..='9')) && text.bytes().all(|b| b.is_ascii_digit())
    };
    let parts = |id: &str| id.split('.').try_fold(0, |n, part| is_word(part).then_some(n + 1));
    match name.split_once('/') {
        Some((id, revision)) if is_number(revision) && parts(id) >= Some(3) => Ok(()),
        _ => Err(MetadataError::ExtensionName { name: name.to_owned() }),
    }
}
