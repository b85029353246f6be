//! Checks of representations.

use std::collections::BTreeSet;
use std::fmt::Arguments;

use htex_model::is_model_id;

use crate::manifest::{AtCondition, Condition, Manifest, Representation, Steps, StoredAs};
use crate::measure::MeasureKind;
use crate::quality_json::{BAND_COUNT, Content, Entries, Entry};
use crate::quantity::Quantity;
use crate::rules as rule;
use crate::triangles::{TrianglesError, check_corners, check_triangles};
use htex_base::finding::Findings;

/// Smallest allowed ratio of a step to the largest magnitude to which it is added. At a smaller
/// ratio, rounding can change the step.
// `EPSILON` is 2^-52, so this number is the 2^-50 of the specification.
const FINEST: f64 = 4.0 * f64::EPSILON;

/// Checks all representations. `are_sound` says whether the manifest's conditions follow all rules.
pub(crate) fn check_representations(manifest: &Manifest, are_sound: bool, findings: &mut Findings) {
    let some = !manifest.representations.is_empty();
    findings.require(some, rule::REPRESENTATIONS_EMPTY, "/representations", || {
        "there is no representation; fit a model".to_owned()
    });
    let mut models = BTreeSet::new();
    for (i, representation) in manifest.representations.iter().enumerate() {
        let at = format_args!("/representations/{i}");
        let model = &representation.model;
        findings.require(
            models.insert(model),
            rule::MODEL_DUPLICATE,
            format_args!("{at}/model"),
            || format!("two representations are of model {model:?}; merge them"),
        );
        check_model(representation, at, findings);
        check_fields(representation, manifest.is_coded(), at, findings);
        let are_sound = check_conditions(representation, manifest, at, findings) && are_sound;
        if let Err(error) = check_triangles_of(representation, &manifest.conditions, are_sound) {
            let triangle = error.triangle().map(|i| format!("/{i}")).unwrap_or_default();
            let pointer = format!("{at}/triangles{triangle}");
            findings.add(rule::TRIANGLES_INVALID, pointer, error.to_string());
        }
    }
}

/// Checks the triangles of a representation. If a condition, or an index of a condition, breaks a
/// rule, `are_sound` is false. In this case the function checks only the corners, and whether the
/// speed and force of each condition are known. Other errors could be mere consequences of the
/// broken rule.
fn check_triangles_of(
    representation: &Representation,
    conditions: &[Condition],
    are_sound: bool,
) -> Result<(), TrianglesError> {
    let Representation { at, triangles, .. } = representation;
    if triangles.is_empty() {
        return Ok(());
    }
    check_corners(at.len(), triangles)?;
    let mut places = Vec::with_capacity(at.len());
    for (condition, fitted) in at.iter().enumerate() {
        // If the index does not exist, the check of conditions reports this.
        let Some(there) = conditions.get(fitted.condition) else { continue };
        let place = there.speed_mm_s.zip(there.force_n);
        places.push(place.ok_or(TrianglesError::Unknown { condition })?.into());
    }
    if are_sound { check_triangles(&places, triangles) } else { Ok(()) }
}

fn check_model(representation: &Representation, at: Arguments<'_>, findings: &mut Findings) {
    let Representation { model, model_version, .. } = representation;
    findings.require(
        is_model_id(model),
        rule::MODEL_ID_INVALID,
        format_args!("{at}/model"),
        || format!("{model:?} is not a model id; write one like org.example.mymodel"),
    );
    let semantic = semver::Version::parse(model_version).is_ok();
    let pointer = format_args!("{at}/model_version");
    findings.require(semantic, rule::MODEL_VERSION_INVALID, pointer, || {
        format!("{model_version:?} is not a semantic version; write one like 1.0.0")
    });
}

fn check_fields(
    representation: &Representation,
    is_coded: bool,
    at: Arguments<'_>,
    findings: &mut Findings,
) {
    let mut names = BTreeSet::new();
    for (i, field) in representation.fields.iter().enumerate() {
        let at = format_args!("{at}/fields/{i}");
        let name = &field.name;
        findings.require(
            !name.is_empty(),
            rule::FIELD_NAME_EMPTY,
            format_args!("{at}/name"),
            || "the field has no name; write the model's".to_owned(),
        );
        findings.require(
            names.insert(name),
            rule::FIELD_DUPLICATE,
            format_args!("{at}/name"),
            || format!("an earlier field has the name {name:?}; rename one"),
        );
        let valid = match field.store {
            StoredAs::F64 | StoredAs::F32 => true,
            StoredAs::U16(steps) => steps.are_valid(u16::MAX),
            StoredAs::U8(steps) => steps.are_valid(u8::MAX.into()),
            StoredAs::Packed(steps) => field.list && steps.are_valid(u8::MAX.into()),
            StoredAs::Coded(steps) => is_coded && steps.are_valid(u8::MAX.into()),
        };
        findings.require(valid, rule::STORE_INVALID, format_args!("{at}/store"), || {
            "the steps are invalid: scale is not above 0, a step's value is not finite (with log: \
             below 2^-1022), scale is too small for the offset, a scalar is packed, or a field is coded \
             in an asset that does not require org.htex.coded/1"
                .to_owned()
        });
    }
}

impl Steps {
    /// Returns whether each step's value is quantised to the same step again.
    pub(crate) fn are_valid(&self, last: u16) -> bool {
        let positive = self.scale > 0.0 && self.scale.is_finite() && self.offset.is_finite();
        let far_end = self.offset + self.scale * f64::from(last);
        let mut furthest = self.offset.abs().max(far_end.abs());
        if self.log {
            // The absolute error of a logarithm is at least the relative error of its argument.
            furthest = furthest.max(1.0);
        }
        // Values below the smallest normal number have fewer bits, so the logarithm of such a value
        // no longer gives its step.
        let least = if self.log { f64::MIN_POSITIVE } else { f64::MIN };
        positive
            && self.value(last).is_finite()
            && self.value(0) >= least
            && self.scale >= FINEST * furthest
    }
}

/// Checks the elements of `at`. Returns whether no two of them have the same index.
fn check_conditions(
    representation: &Representation,
    manifest: &Manifest,
    at: Arguments<'_>,
    findings: &mut Findings,
) -> bool {
    findings.require(
        !representation.at.is_empty(),
        rule::AT_EMPTY,
        format_args!("{at}/at"),
        || "the model is fitted at no condition; fit it or remove it".to_owned(),
    );
    let conditions = manifest.conditions.len();
    let mut seen = BTreeSet::new();
    let mut are_sound = true;
    for (i, fitted) in representation.at.iter().enumerate() {
        let at = format_args!("{at}/at/{i}");
        let index = fitted.condition;
        let pointer = format_args!("{at}/condition");
        let (exists, is_new) = (index < conditions, seen.insert(index));
        findings.require(exists, rule::CONDITION_INDEX_INVALID, pointer, || {
            format!("there is no condition {index}; there are {conditions}, counted from 0")
        });
        findings.require(is_new, rule::CONDITION_INDEX_DUPLICATE, pointer, || {
            format!("condition {index} is listed twice; keep one")
        });
        are_sound &= exists && is_new;
        check_fit(fitted, manifest.quantity, at, findings);
    }
    are_sound
}

fn check_fit(fitted: &AtCondition, quantity: Quantity, at: Arguments<'_>, findings: &mut Findings) {
    let (level, largest, unit) = (fitted.level_rms, quantity.largest_level(), quantity.unit());
    findings.require(
        is_size(level) && level <= largest,
        rule::LEVEL_INVALID,
        format_args!("{at}/level_rms"),
        || format!("{level} {unit} is not a valid level; write a value from 0 to {largest}"),
    );
    if let Some(quality) = &fitted.quality {
        let at = format_args!("{at}/quality");
        check_entries(quality, "measure again", at, findings);
    }
    if let Some(left_out) = &fitted.left_out {
        let at = format_args!("{at}/left_out");
        check_entries(left_out, "fit again", at, findings);
    }
}

/// Adds a finding for each number that is out of its measure's range.
fn check_entries(
    object: &impl Entries,
    what_to_do: &str,
    at: Arguments<'_>,
    findings: &mut Findings,
) {
    for Entry { key, content, .. } in object.entries() {
        let message = match content {
            Content::Bands(errors) if !are_bands(errors) => {
                format!("there are {} band errors; write {BAND_COUNT} finite numbers", errors.len())
            }
            Content::Number(Some(number), judged) if !judged.accepts(number) => match judged {
                MeasureKind::Correlation => {
                    format!("{number} is not a valid correlation; write a value from -1 to 1")
                }
                _ => format!("{number} is negative or not finite; {what_to_do} or remove {key}"),
            },
            _ => continue,
        };
        findings.add(rule::QUALITY_INVALID, format!("{at}/{key}"), message);
    }
}

fn are_bands(errors: &[f64]) -> bool {
    errors.len() == BAND_COUNT && errors.iter().all(|error| error.is_finite())
}

/// Returns whether a number is finite and not negative.
pub(crate) fn is_size(number: f64) -> bool {
    number.is_finite() && number >= 0.0
}
