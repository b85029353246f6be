//! Checks that a newer version of a model renders the same samples as an older version.

use htex_model::{Descriptor, Field, Kind};
use semver::Version;

use crate::harness::{CheckResult, Finding};
use crate::model::case::{Case, Settings};
use crate::model::checks::twin::SAMPLES;

/// Compares the model with an older version, if the user named one.
pub(crate) fn keeps(case: &Case) -> CheckResult {
    let Some(file) = &case.against else {
        return Ok(Finding::skipped("no older version was named to compare with"));
    };
    let settings = Settings { seed: case.seed, ..Settings::default() };
    let old = Case::load(file, settings)
        .map_err(|error| Finding::failed(format!("the other file: {error}")))?;
    let (ours, theirs) = (case.model.descriptor(), old.model.descriptor());
    if ours.id != theirs.id {
        return Err(Finding::failed(format!("the other file is another model, {}", theirs.id)));
    }
    let [new_version, old_version] = [ours, theirs].map(|one| Version::parse(&one.version));
    let (Ok(new_version), Ok(old_version)) = (new_version, old_version) else {
        return Err(Finding::failed("a version is not a semantic version"));
    };
    if new_version == old_version {
        return Ok(Finding::skipped("the other file has the same version"));
    }
    if new_version < old_version {
        let message = format!("{new_version} is older than {old_version}, the other file's");
        return Err(Finding::failed(message));
    }
    if new_version.major > old_version.major {
        return Ok(Finding::passed(format!(
            "{new_version} is another major version than {old_version}, so everything may differ"
        )));
    }
    let must_rise = format!("keep it, or call this version {}.0.0", old_version.major + 1);
    if let Some(problem) = other_fields(ours, theirs) {
        return Err(Finding::failed(format!("{problem}; {must_rise}")));
    }
    let mut difference: f64 = 0.0;
    for fitted in old.fitted()? {
        let values = old.lists(&fitted.parameters)?;
        let lists: Vec<Vec<f64>> =
            ours.fields.iter().map(|field| of(field, theirs, &values)).collect();
        let play =
            |case: &Case, parameters: &[f64]| case.samples(parameters, case.seed, 20_000, 256);
        let (x, y) = (play(case, &case.flat(&lists))?, play(&old, &fitted.parameters)?);
        let furthest = x.iter().zip(&y).map(|(x, y)| f64::from((x - y).abs()));
        difference = furthest.fold(difference, f64::max);
    }
    let message = format!("samples within {difference:.1e} of {old_version}");
    let finding = if difference > SAMPLES {
        Finding::failed(format!("the same parameters sound different: {message}; {must_rise}"))
    } else if difference > 0.0 {
        Finding::warning(message + ", not bit-identical")
    } else {
        Finding::passed(message)
    };
    Ok(finding.with("sample_difference", difference))
}

/// Returns a sentence about a field that the newer version does not accept as the older version
/// did.
fn other_fields(new: &Descriptor, old: &Descriptor) -> Option<String> {
    let changed = old.fields.iter().find_map(|before| {
        let name = &before.name;
        let Some(now) = new.fields.iter().find(|now| now.name == *name) else {
            return Some(format!("the field `{name}` is gone"));
        };
        let takes = match (now.kind, before.kind) {
            (Kind::Scalar, Kind::Scalar) => true,
            (Kind::List { max_len: now }, Kind::List { max_len: before }) => now >= before,
            _ => false,
        };
        if !takes {
            return Some(format!("the field `{name}` no longer takes as many numbers"));
        }
        if now.unit != before.unit {
            return Some(format!("the field `{name}` has another unit"));
        }
        let is_within = now.min <= before.min && before.max <= now.max;
        (!is_within).then(|| format!("the field `{name}` has a smaller range"))
    });
    changed.or_else(|| {
        let is_new = |field: &&Field| old.fields.iter().all(|before| before.name != field.name);
        let needed = new.fields.iter().filter(is_new).find(|field| field.default.is_none())?;
        Some(format!("the new field `{}` has no default", needed.name))
    })
}

/// Returns the numbers of a field: those of the older version, or the default.
fn of(field: &Field, old: &Descriptor, values: &[Vec<f64>]) -> Vec<f64> {
    let before = old.fields.iter().position(|before| before.name == field.name);
    match before {
        Some(index) => values[index].clone(),
        None => field.default.into_iter().collect(),
    }
}
