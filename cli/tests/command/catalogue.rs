//! The catalogue of a library in a browser.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::common::Place;
use serde_json::Value;

const RECIPE: &str = r#"
[library]
name = "Surfaces & sounds"
[[textures]]
recordings = "*.csv"
license = "CC0-1.0"
models = ["bands", "sbeta"]
at = { speed_mm_s = 80, force_n = 0.4 }
[[overrides]]
textures = "vinyl"
license = "MIT"
models = ["bands"]
tags = ["</script>", "smooth"]
[[overrides]]
textures = "sandpaper"
gates = { max_bytes = 10 }
"#;

/// The user's actions, and what the page shows after each step.
const STEPS: &str = include_str!("../common/catalogue.js");

#[test]
fn textures_are_found_sorted_and_heard() {
    let browser = ["chromium", "chromium-browser"].into_iter().find(|name| {
        let version = Command::new(name).arg("--version").output();
        version.is_ok_and(|run| run.status.success())
    });
    if !xtask::needs::CHROMIUM.met(browser.is_some()) {
        return;
    }
    let place = Place::new();
    for surface in ["vinyl", "sandpaper", "fine-fabric"] {
        place.recording(surface);
    }
    place.write("library.toml", RECIPE);
    let run = place.run(&["build", "library.toml", "-o", "dist"]);
    assert_eq!(run.code(), 3, "the recipe leaves one out: {}", run.error());
    let page = fs::read_to_string(place.path("dist/index.html")).unwrap();
    assert!(page.contains("<h1>Surfaces &amp; sounds</h1>"));
    let script = format!("<script type=\"module\">\n{STEPS}</script></body>");
    place.write("dist/steps.html", page.replace("</body>", &script));
    let steps = shown(browser.unwrap(), &place.path("dist/steps.html"), &place.path("profile"));
    let expected = serde_json::json!([
        ["opened", ["fine-fabric", "sandpaper", "vinyl"], "3 of 3", ""],
        ["SMOOTH mit", ["vinyl"], "1 of 3", "#q=SMOOTH+mit"],
        ["cc0 sbeta", ["fine-fabric", "sandpaper"], "2 of 3", "#q=cc0+sbeta"],
        ["</script>", ["vinyl"], "1 of 3", "#q=%3C%2Fscript%3E"],
        ["no such thing", [], "0 of 3", "#q=no+such+thing"],
        ["", ["fine-fabric", "sandpaper", "vinyl"], "3 of 3", ""],
        // Two models take more than one.
        ["bytes", sorted(&place), "3 of 3", "#sort=bytes"],
        [
            "bytes",
            sorted(&place).into_iter().rev().collect::<Vec<_>>(),
            "3 of 3",
            "#sort=bytes&descending=1"
        ],
        ["name", ["fine-fabric", "sandpaper", "vinyl"], "3 of 3", ""],
        ["left out", ["sandpaper"], "1 of 3", "#left-out=1"],
        ["played", "▶"],
    ]);
    assert_eq!(steps, expected);
}

/// The textures by the size of their assets, as the report states it.
fn sorted(place: &Place) -> Vec<String> {
    let report = fs::read(place.path("dist/build-report.json")).unwrap();
    let report: Value = serde_json::from_slice(&report).unwrap();
    let textures = report["textures"].as_array().unwrap().iter();
    let mut sizes: Vec<(u64, String)> = textures
        .map(|t| (t["asset"]["bytes"].as_u64().unwrap(), t["name"].as_str().unwrap().to_owned()))
        .collect();
    sizes.sort();
    sizes.into_iter().map(|(_, name)| name).collect()
}

/// The steps that a page noted, after its scripts ran in a browser.
fn shown(browser: &str, page: &Path, profile: &Path) -> Value {
    let run = Command::new(browser)
        .args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-background-networking",
            "--disable-audio-output",
        ])
        .args([
            "--autoplay-policy=no-user-gesture-required",
            "--virtual-time-budget=20000",
            "--dump-dom",
        ])
        .arg(format!("--user-data-dir={}", profile.display()))
        .arg(format!("file://{}", page.display()))
        .output()
        .unwrap();
    let html = String::from_utf8(run.stdout).unwrap();
    let (_, after) = html
        .split_once("id=\"result\">")
        .unwrap_or_else(|| panic!("no result: {}", String::from_utf8_lossy(&run.stderr)));
    let (encoded, _) = after.split_once('<').unwrap();
    serde_json::from_slice(&decoded(encoded)).unwrap()
}

/// Decodes percent signs with two digits.
fn decoded(text: &str) -> Vec<u8> {
    let mut parts = text.split('%');
    let mut bytes = parts.next().unwrap().as_bytes().to_vec();
    for part in parts {
        let (digits, rest) = part.split_at(2);
        bytes.push(u8::from_str_radix(digits, 16).unwrap());
        bytes.extend_from_slice(rest.as_bytes());
    }
    bytes
}
