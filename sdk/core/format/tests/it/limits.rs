//! Each limit takes effect at exactly its value.

use crate::common;

use common::{asset, five};
use htex_format::{Limits, validate};

/// Returns the codes of findings with a limit exactly at what the asset needs, and one below it.
fn around(limit: impl Fn(usize) -> Limits, takes: usize) -> [Vec<String>; 2] {
    let bytes = asset(1, five(1)).to_bytes().unwrap();
    let codes = |limits| validate(&bytes, &limits).findings.into_iter().map(|f| f.code).collect();
    [codes(limit(takes)), codes(limit(takes - 1))]
}

fn bites(code: &str, takes: usize, limit: impl Fn(usize) -> Limits) {
    assert_eq!(around(limit, takes), [vec![], vec![code.to_owned()]]);
}

#[test]
fn each_limit_bites_where_it_says() {
    let default = Limits::default();
    let asset = asset(1, five(1));
    let (file, json) = (
        asset.to_bytes().unwrap().len(),
        serde_json::to_vec(&asset.manifest.rounded()).unwrap().len(),
    );
    let payload: usize = (0..5).map(|i| asset.payload_bytes(i)).sum();
    bites("FILE_TOO_LARGE", file, |n| Limits { file_bytes: n as u64, ..default });
    bites("ARCHIVE_TOO_MANY_ENTRIES", 7, |n| Limits { entries: n, ..default });
    bites("ENTRY_TOO_LARGE", json, |n| Limits { entry_bytes: n as u64, ..default });
    let total = "application/vnd.htex+zip".len() + json + payload;
    bites("ARCHIVE_TOO_LARGE", total, |n| Limits { total_bytes: n as u64, ..default });
    // {, representations, {, at, {, quality, band_error_db
    bites("JSON_TOO_DEEP", 7, |n| Limits { json_depth: n, ..default });
    let text = serde_json::to_string(&asset.manifest.rounded()).unwrap();
    // No text of this manifest has a bracket, and two have a comma.
    let nodes = text.matches(['[', '{', ',']).count() - 2;
    bites("JSON_TOO_LARGE", nodes, |n| Limits { json_nodes: n, ..default });
    bites("CONDITIONS_TOO_MANY", 1, |n| Limits { conditions: n, ..default });
    bites("VALUES_TOO_MANY", 7 + 12 + 21 + 2 + 3, |n| Limits { values: n, ..default });
    // 5 kB of manifest in less than 1 kB.
    let least = (1..)
        .find(|&n| around(|ratio| Limits { ratio: ratio as u64, ..default }, n + 1)[0].is_empty());
    bites("ENTRY_RATIO", least.unwrap() + 1, |n| Limits { ratio: n as u64, ..default });
}

#[test]
fn a_list_cannot_claim_more_than_the_block_holds() {
    use common::parts::{manifest, parts};
    let mut manifest = manifest();
    manifest["representations"][0]["fields"][0]["list"] = serde_json::json!(true);
    // A length of 2^64 - 1.
    let block = [&[0xFD][..], &[0xFF; 8]].concat();
    let bytes = common::raw_zip::archive(&parts(manifest.to_string().as_bytes(), &block));
    let report = validate(&bytes, &Limits::default());
    assert_eq!(report.findings[0].code, "PARAMETERS_INVALID");
}
