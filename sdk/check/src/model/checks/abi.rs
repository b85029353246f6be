//! Checks the marker, exports, descriptor and extensions of a native model library or a WASM
//! module.

use htex_host::{Descriptor, Field, FitOption, HostError, Kind, Scale, Store};

use crate::harness::{CheckResult, Finding, Owner, made_up_extensions};
use crate::model::case::Case;

/// Returns the check to which a loading error belongs, and whether the checks before it passed.
pub(crate) fn owner(error: &HostError) -> Owner {
    match error {
        HostError::Broken { call, .. } if *call == "htex_model_abi_version" => {
            Owner::reached("marker")
        }
        HostError::Broken { call, .. } if *call == "htex_model_descriptor" => {
            Owner::reached("descriptor")
        }
        HostError::NoFunction { name, .. } if name == "htex_model_abi_version" => {
            Owner::reached("marker")
        }
        HostError::NoFunction { .. } => Owner::reached("exports"),
        // A file that cannot be loaded has no marker to check.
        _ => Owner::not_reached("exports"),
    }
}

/// Always passes, because a model that could be loaded has the marker and the exports.
pub(crate) fn loaded(case: &Case) -> CheckResult {
    let file = case.file.display();
    Ok(Finding::passed(format!("{file} was loaded")))
}

/// Checks the parts of the descriptor that loading does not check.
pub(crate) fn descriptor(case: &Case) -> CheckResult {
    let descriptor = case.model.descriptor();
    if let Some(wrong) = wrong_in(descriptor) {
        return Err(Finding::failed(wrong));
    }
    let text = || -> Result<Vec<u8>, HostError> {
        let mut text = vec![0; case.model.descriptor_into(&mut [])?];
        case.model.descriptor_into(&mut text)?;
        Ok(text)
    };
    if text()? != text()? {
        return Err(Finding::failed("the text differs from call to call"));
    }
    let (fields, options) = (descriptor.fields.len(), descriptor.options.len());
    let identity = format!("{} {}", descriptor.id, descriptor.version);
    Ok(Finding::passed(format!("{identity}: {fields} fields, {options} fit options"))
        .with("fields", fields as f64)
        .with("options", options as f64))
}

fn wrong_in(descriptor: &Descriptor) -> Option<String> {
    if descriptor.name.trim().is_empty() || descriptor.summary.trim().is_empty() {
        return Some("`name` and `summary` must not be empty".to_owned());
    }
    let fields = descriptor.fields.iter().map(|f| (&f.name, &f.unit));
    let options = descriptor.options.iter().map(|o| (&o.name, &o.unit));
    for (name, unit) in fields.chain(options) {
        let plain = |b: u8| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_';
        if name.is_empty() || !name.bytes().all(plain) {
            return Some(format!("`{name}`: names consist of a-z, 0-9 and _"));
        }
        if unit.is_empty() {
            return Some(format!("`{name}` has no unit; `1` is the unit of a pure number"));
        }
    }
    let field = descriptor.fields.iter();
    field
        .clone()
        .find(|f| !store_works(f))
        .map(|f| {
            format!(
                "`{}`: the store needs a finite, positive step, and only lists can be packed",
                f.name
            )
        })
        .or_else(|| twice(descriptor.options.iter().map(|o| o.name.as_str())))
        .or_else(|| descriptor.options.iter().find_map(wrong_default))
        .or_else(|| wrong_hint(descriptor))
}

/// Returns a description of a usual range or a sweep value that is not allowed, if there is one.
fn wrong_hint(descriptor: &Descriptor) -> Option<String> {
    let usual_works = |field: &&Field| {
        field.usual.is_none_or(|usual| {
            let starts = if usual.scale == Scale::Log { usual.min > 0.0 } else { true };
            starts && field.min <= usual.min && usual.min < usual.max && usual.max <= field.max
        })
    };
    if let Some(field) = descriptor.fields.iter().find(|field| !usual_works(field)) {
        let (name, min, max) = (&field.name, field.min, field.max);
        return Some(format!(
            "`{name}`: the usual range must ascend within {min} to {max}, above 0 if it is logarithmic"
        ));
    }
    let options = &descriptor.options;
    for option in options {
        let mut values = option.sweep.iter().chain(&option.sweep_alone);
        if let Some(value) = values.find(|value| option.text(**value).is_none()) {
            return Some(format!("`{}`: the option cannot be {value} in a sweep", option.name));
        }
        let other = option.not_above.as_ref();
        let is_missing = |name: &&String| !options.iter().any(|o| o.name == **name);
        if let Some(other) = other.filter(is_missing) {
            return Some(format!("`{}`: there is no option `{other}` above it", option.name));
        }
    }
    None
}

fn store_works(field: &Field) -> bool {
    let works = |scale: f64, offset: f64| scale.is_finite() && scale > 0.0 && offset.is_finite();
    match field.store {
        Store::F64 | Store::F32 => true,
        Store::U16 { scale, offset, .. } | Store::U8 { scale, offset, .. } => works(scale, offset),
        Store::Packed { scale, offset, .. } => {
            matches!(field.kind, Kind::List { .. }) && works(scale, offset)
        }
    }
}

fn twice<'a>(names: impl Iterator<Item = &'a str>) -> Option<String> {
    let mut names: Vec<&str> = names.collect();
    names.sort_unstable();
    let pair = names.windows(2).find(|pair| pair[0] == pair[1])?;
    Some(format!("two options are named `{}`", pair[0]))
}

fn wrong_default(option: &FitOption) -> Option<String> {
    let FitOption { name, default, .. } = option;
    if !(option.min..=option.max).contains(default) {
        let (min, max) = (option.min, option.max);
        return Some(format!("`{name}`: the default {default} is not in {min} to {max}"));
    }
    if option.integer && default.fract() != 0.0 {
        return Some(format!("`{name}`: the default {default} is not an integer"));
    }
    let last = option.choices.len().saturating_sub(1) as f64;
    let counted = option.choices.is_empty() || (option.min == 0.0 && option.max == last);
    (!counted).then(|| format!("`{name}`: the range of its choices must be 0 to {last}"))
}

/// Checks that made-up extensions are absent.
pub(crate) fn extensions(case: &Case) -> CheckResult {
    made_up_extensions(|id| case.model.has_extension(id))
}
