//! The catalogue: a web page on which users search and sort the textures of a library and listen to
//! them.

use serde_json::{Value, json};

use crate::findings::FindingShare;
use crate::removed::named_briefly;
use crate::report::{Report, TextureReport};

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("style.css");
const SCRIPT: &str = include_str!("script.js");

/// Returns the page. If the browser package is next to the page, in `browser`, the package plays
/// the textures. Otherwise the page plays the files in `sounds`.
pub(crate) fn catalogue(report: &Report, browser_package: bool) -> String {
    let textures: Vec<Value> = report.textures.iter().map(texture).collect();
    let data = json!({
        "library": report.library,
        "textures": textures,
        "findings": findings(report),
        "removed": removed(report),
        "browserPackage": browser_package,
    });
    // Inside a script element, only `<` could end the data.
    let data = data.to_string().replace('<', "\\u003c");
    // The data is inserted last, because its texts may contain the other marks. The title contains
    // no marks.
    PAGE.replace("@STYLE@", STYLE)
        .replace("@SCRIPT@", SCRIPT)
        .replace("@TITLE@", &escaped(&report.library.name).replace('@', "&#64;"))
        .replace("@DATA@", &data)
}

/// Returns a text that states how many textures were removed, and which; empty if there are none.
fn removed(report: &Report) -> String {
    match report.removed.len() {
        0 => String::new(),
        count => format!("{count} removed ({})", named_briefly(&report.removed)),
    }
}

/// Returns findings by code, the most severe first: code, severity, number of textures, first
/// names.
fn findings(report: &Report) -> Vec<Value> {
    let mut all: Vec<_> = report.findings.iter().collect();
    all.sort_by_key(|(code, share)| (share.severity, *code));
    let line = |(code, share): (&String, &FindingShare)| {
        json!({
            "code": code, "severity": share.severity, "textures": share.textures, "inLibrary": share.in_library, "first": share.first,
        })
    };
    all.into_iter().map(line).collect()
}

fn texture(texture: &TextureReport) -> Value {
    let missed: Vec<(&str, &str)> =
        texture.missed.iter().map(|m| (&m.gate[..], &m.reason[..])).collect();
    let Some(asset) = &texture.asset else {
        return json!({
            "name": texture.name, "tags": [], "license": "", "author": "", "errors": [], "levels": [], "findings": [],
            "missed": missed,
        });
    };
    let errors = asset.band_error_rms_db.iter();
    let errors =
        errors.map(|(id, error)| (id.rsplit('.').next().unwrap_or(id), hundredths(*error)));
    json!({
        "name": texture.name,
        "tags": asset.tags,
        "license": asset.license.as_deref().unwrap_or_default(),
        "author": asset.author.as_deref().unwrap_or_default(),
        "errors": errors.collect::<Vec<_>>(),
        "repeatability": asset.repeatability_rms_db.map(hundredths),
        "bytes": asset.bytes,
        "levels": asset.spectrum,
        "findings": asset.findings.iter().map(|f| (&f.code, f.severity, &f.message)).collect::<Vec<_>>(),
        "missed": missed,
    })
}

fn hundredths(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
