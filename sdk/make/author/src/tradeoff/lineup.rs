//! The contenders of a sweep, and the key under which the sweep's results are stored.

use std::path::Path;

use htex_host::{LoadedModel, Origin, Synthesis};

use crate::AuthorError;
use crate::tradeoff::contender::{Contender, ContenderKind};
use crate::tradeoff::point::{QUANTISED, RECORDING};
use crate::tradeoff::request::{Model, Request};
use crate::tradeoff::settings::{fit_settings, playing_settings};
use crate::tradeoff::{Machine, Setting, Subject};

/// Returns all contenders: the settings of every model, and the baselines.
pub(crate) fn lineup(request: &Request) -> Result<Vec<Contender>, AuthorError> {
    let mut all = Vec::new();
    for Model { ways } in &request.models {
        let Some((_, first)) = ways.first() else {
            continue;
        };
        let model = first.short_name().to_owned();
        let mut add = |setting: Setting, loaded: &LoadedModel| {
            let given: Vec<(&str, &str)> =
                setting.options.iter().map(|(n, v)| (&n[..], &v[..])).collect();
            let options = loaded.options(&given)?;
            let kind = ContenderKind::Model(loaded.clone(), options);
            all.push(Contender { model: model.clone(), setting, kind });
            Ok::<(), AuthorError>(())
        };
        let played = playing_settings(request.quick)?;
        for setting in fit_settings(first, request.quick).into_iter().chain(played) {
            add(setting, first)?;
        }
        for (loader, loaded) in &ways[1..] {
            add(Setting { loader: loader.clone(), ..Setting::default() }, loaded)?;
        }
    }
    let baseline = |model: &str, kind: ContenderKind, synthesis| Contender {
        model: model.to_owned(),
        setting: Setting { synthesis, ..Setting::default() },
        kind,
    };
    let looped = Synthesis::Loop { seconds: 2.0 };
    all.push(baseline(QUANTISED, ContenderKind::Quantised, Synthesis::Streamed));
    all.push(baseline(QUANTISED, ContenderKind::Quantised, looped));
    all.push(baseline(RECORDING, ContenderKind::Recording, Synthesis::Streamed));
    Ok(all)
}

/// Returns a BLAKE3 hash of everything that the results of a sweep depend on.
pub(crate) fn key(subjects: &[Subject], contenders: &[Contender], request: &Request) -> String {
    let mut hasher = blake3::Hasher::new();
    let mut add = |text: &str| {
        hasher.update(&(text.len() as u64).to_le_bytes());
        hasher.update(text.as_bytes());
    };
    add(&build(&request.program));
    add(&format!("{:?} {}", Machine::here(), request.quick));
    for subject in subjects {
        add(&subject.name);
        add(subject.digest.to_hex().as_str());
    }
    for one in contenders {
        add(&one.id());
        if let ContenderKind::Model(model, options) = &one.kind {
            let descriptor = model.descriptor();
            add(&format!(
                "{} {} {} {options:?}",
                descriptor.id,
                descriptor.version,
                model.origin()
            ));
            if let Origin::Native(file) | Origin::Wasm(file) = model.origin() {
                add(&build(file));
            }
        }
    }
    hasher.finalize().to_hex().to_string()
}

/// Identifies the build of a program by the size and time of its file. Empty if they cannot be
/// read.
fn build(file: &Path) -> String {
    let read = || {
        let about = file.metadata().ok()?;
        Some(format!("{} {:?}", about.len(), about.modified().ok()?))
    };
    read().unwrap_or_default()
}
