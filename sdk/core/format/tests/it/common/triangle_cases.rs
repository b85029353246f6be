//! Assets that store triangles. Most of them cannot be interpolated in.

use serde_json::{Value, json};

use super::cases::Named;
use super::parts::parts;
use super::raw_zip::archive;
use super::{asset, sbeta};

/// Speeds, mm/s, and forces, newtons: the corners of a rectangle, and one on its lower edge.
pub(super) const RECTANGLE: [[f64; 2]; 5] =
    [[40.0, 0.4], [160.0, 0.4], [160.0, 1.2], [40.0, 1.2], [100.0, 0.4]];

/// Triangles that are not a Delaunay triangulation, with both orientations.
pub(super) const FLIPPED: [[usize; 3]; 3] = [[0, 3, 4], [4, 1, 3], [1, 2, 3]];

/// Five corners of a star around the last.
const STAR: [[f64; 2]; 6] =
    [[160.0, 0.6], [119.0, 1.17], [51.0, 0.95], [51.0, 0.25], [119.0, 0.03], [100.0, 0.6]];

/// The corners of a rectangle, and one inside.
const PEAK: [[f64; 2]; 5] = [[40.0, 0.4], [160.0, 0.4], [160.0, 1.2], [40.0, 1.2], [100.0, 0.7]];

/// Assets whose triangles each break one rule.
pub(super) fn triangles() -> Vec<Named> {
    let of =
        |conditions: &[[f64; 2]], triangles: &[[usize; 3]]| with_triangles(conditions, triangles);
    vec![
        ("triangles_invalid_corner", of(&RECTANGLE, &[[0, 3, 4], [4, 5, 3], [1, 2, 3]])),
        ("triangles_invalid_two_equal", of(&RECTANGLE, &[[0, 3, 4], [4, 1, 3], [1, 2, 1]])),
        (
            "triangles_invalid_unknown_force",
            changed(&RECTANGLE, &FLIPPED, |manifest| {
                let condition = manifest["conditions"][2].as_object_mut();
                condition.unwrap().remove("force_n");
            }),
        ),
        ("triangles_invalid_flat", of(&RECTANGLE, &[[0, 3, 4], [0, 4, 1], [4, 1, 3], [1, 2, 3]])),
        (
            "triangles_invalid_overlap",
            of(&RECTANGLE, &[[0, 3, 4], [4, 1, 3], [4, 2, 1], [1, 2, 3]]),
        ),
        ("triangles_invalid_gap", of(&RECTANGLE, &[[0, 3, 4], [1, 2, 3]])),
        ("triangles_invalid_unreached", of(&RECTANGLE, &[[0, 3, 4], [4, 1, 3]])),
        ("triangles_invalid_not_convex", of(&PEAK, &[[0, 4, 3], [3, 4, 2], [2, 4, 1]])),
        (
            "triangles_invalid_apart",
            of(
                &[&RECTANGLE[..4], &[[400.0, 0.4], [500.0, 0.4], [400.0, 1.2]]].concat(),
                &[[0, 1, 2], [0, 2, 3], [4, 5, 6]],
            ),
        ),
        (
            "triangles_invalid_twice_around",
            of(&STAR, &[[5, 0, 2], [5, 2, 4], [5, 4, 1], [5, 1, 3], [5, 3, 0]]),
        ),
        // Of triangles between such conditions only the corners are checked, and that speeds and
        // forces are known.
        (
            "condition_duplicate_with_triangles",
            bare(&RECTANGLE, &FLIPPED, |manifest| {
                manifest["conditions"][4] = manifest["conditions"][0].clone();
            }),
        ),
        (
            "condition_index_duplicate_with_triangles",
            bare(&RECTANGLE, &FLIPPED, |manifest| {
                manifest["representations"][0]["at"][4]["condition"] = json!(0);
            }),
        ),
        (
            "condition_index_invalid_with_triangles",
            bare(&RECTANGLE, &FLIPPED, |manifest| {
                manifest["representations"][0]["at"][4]["condition"] = json!(9);
            }),
        ),
        (
            "triangles_invalid_unknown_and_index",
            bare(&RECTANGLE, &FLIPPED, |manifest| {
                manifest["representations"][0]["at"][0]["condition"] = json!(9);
                manifest["conditions"][2].as_object_mut().unwrap().remove("force_n");
            }),
        ),
        // Another representation's index has no effect.
        (
            "triangles_invalid_second",
            bare(&RECTANGLE, &[[0, 3, 4], [1, 2, 3]], |manifest| {
                let mut first = manifest["representations"][0].clone();
                first["model"] = json!("org.example.first");
                first["at"][4]["condition"] = json!(9);
                first["parameters"] = json!("absent.bin");
                manifest["representations"].as_array_mut().unwrap().insert(0, first);
            }),
        ),
        (
            "triangles_invalid_corner_and_unknown",
            bare(&RECTANGLE, &[[0, 3, 4], [4, 1, 5], [1, 2, 3]], |manifest| {
                manifest["conditions"][2].as_object_mut().unwrap().remove("force_n");
            }),
        ),
        (
            "triangles_invalid_two_equal_and_unknown",
            bare(&RECTANGLE, &[[0, 3, 4], [4, 1, 3], [1, 2, 1]], |manifest| {
                manifest["conditions"][2].as_object_mut().unwrap().remove("force_n");
            }),
        ),
        // Twice the area is 4.7e-10 of the square of the longest side, of scaled positions.
        (
            "triangles_invalid_flat_scaled",
            bare(
                &[[100.0, 0.4], [100.0 + 5e-8, 0.8], [100.0, 1.2], [160.0, 0.8]],
                &[[0, 1, 2], [0, 1, 3], [1, 2, 3]],
                |_| (),
            ),
        ),
        (
            "triangles_invalid_touching",
            bare(
                &[[100.0, 0.8], [40.0, 0.4], [40.0, 1.2], [160.0, 0.4], [160.0, 1.2]],
                &[[0, 1, 2], [0, 3, 4]],
                |_| (),
            ),
        ),
        (
            "condition_invalid_with_triangles",
            changed(&RECTANGLE, &FLIPPED, |manifest| {
                manifest["conditions"][2]["force_n"] = json!(-1);
            }),
        ),
    ]
}

/// An asset that stores triangles between conditions.
pub(super) fn with_triangles(conditions: &[[f64; 2]], triangles: &[[usize; 3]]) -> Vec<u8> {
    changed(conditions, triangles, |_| ())
}

/// An asset with triangles that are next to flat.
pub(super) fn narrow() -> Vec<u8> {
    bare(
        &[[100.0, 0.4], [100.0 + 5e-5, 0.8], [100.0, 1.2], [160.0, 0.8]],
        &[[0, 1, 2], [0, 1, 3], [1, 2, 3]],
        |_| (),
    )
}

/// An asset with triangles whose outline turns inwards at a corner that is flat.
pub(super) fn dented() -> Vec<u8> {
    bare(
        &[[40.0, 0.4], [100.0, 0.4 + 1e-11], [160.0, 0.4], [100.0, 1.2]],
        &[[0, 1, 3], [1, 2, 3]],
        |_| (),
    )
}

/// An asset with an empty list of triangles, which is none.
pub(super) fn without() -> Vec<u8> {
    bare(&RECTANGLE, &[], |manifest| {
        manifest["conditions"][2].as_object_mut().unwrap().remove("force_n");
    })
}

/// The same without keys that may be absent, before a change.
fn bare(conditions: &[[f64; 2]], triangles: &[[usize; 3]], change: impl Fn(&mut Value)) -> Vec<u8> {
    changed(conditions, triangles, |manifest| {
        for key in ["author", "tags", "provenance"] {
            manifest.as_object_mut().unwrap().remove(key);
        }
        for fitted in manifest["representations"][0]["at"].as_array_mut().unwrap() {
            fitted.as_object_mut().unwrap().remove("quality");
        }
        change(manifest);
    })
}

fn changed(
    conditions: &[[f64; 2]],
    triangles: &[[usize; 3]],
    change: impl Fn(&mut Value),
) -> Vec<u8> {
    let count = conditions.len();
    let mut manifest = serde_json::to_value(asset(count, vec![sbeta(count)]).manifest).unwrap();
    let condition = |[speed, force]: &[f64; 2]| json!({ "speed_mm_s": speed, "force_n": force });
    manifest["conditions"] = conditions.iter().map(condition).collect();
    manifest["representations"][0]["triangles"] = json!(triangles);
    change(&mut manifest);
    let block = [1.5f32, 2.5].repeat(count);
    let block: Vec<u8> = block.iter().flat_map(|x| x.to_le_bytes()).collect();
    archive(&parts(manifest.to_string().as_bytes(), &block))
}
