//! Generates `spec/scene-findings.md` from the code.

use htex_base::finding::{colophon, rules_page};

use crate::RULES;

const HEAD: &str = "\
# Findings in scenes

A finding has a code, a severity, a JSON pointer into the scene (empty for the file as a whole) and a
message. A scene can be played when no finding is an error. Codes never change their meaning.

## Order and pointers

Findings are in this order, and inside a part in the order of the checked values:

1. the file, its JSON and its version, the first only (`SCENE_VERSION_NEWER` is no error, and others follow it); each unknown effect, by name; the first value of
   a wrong type. An error among these ends the reading, and no other error does;
2. unknown keys, depth first, the keys of an object in ascending order of their bytes;
3. the number of surfaces, of which too many are not checked here; of each surface `gain`, `representation`, `x_mm`, `y_mm`; surfaces that overlap an earlier one, at the later;
4. of a constant motion `speed_mm_s`, `force_n`, `from_mm`, `direction_deg`, a missing position;
5. the ranges of `device`, in the order of its table in section 4 of [scene-1.md](scene-1.md); `duration_s`; `budget`;
6. of each surface the asset, and whether its representation can be played;
7. the trace, each assumption, a longer duration; the response;
8. the adapter; settings in ascending order of their names, then the profile and all settings together; `rate_hz`, `gain_db`, `drive_v`, `level_dbfs`, `pitch`, `levels`,
   `reference_rms`, the drive, the quantity. An adapter that is unknown, a file to load or a value that is no text, number or boolean (all of these), or else
   the first setting that the adapter does not take, ends this part;
9. if all assets could be read: other quantities than the first surface's; if there is no error so far, by surface, a constant motion beyond the recorded ones, or more than a
   tenth of the rows of a trace (of at most 20,000, evenly spaced) at which the finger slides on this surface; the response in
   the textures' band.

A value can thus have findings of several parts: a `rate_hz` of 0 is `DEVICE_FIELD_INVALID` and `DEVICE_RATE`. Without surfaces there is no `REGION_UNKNOWN_POSITION`,
and without an asset that can be read no `DEVICE_QUANTITY`, which compares the first of these; a representation whose name is empty is not looked up. `MOTION_BEYOND_RECORDED` points to `/motion`. In a scene with an error, the pointer to a key that it
leaves out is the pointer to the nearest value around it that is there: `REPRESENTATION_UNPLAYABLE` points to `representation`, or without one to the surface.
A player has other reasons to refuse a scene, which it finds as it plans (sections 4 to 6 of [scene-1.md](scene-1.md)) and which have no code.
";

/// Returns the page with all rules: `spec/scene-findings.md`.
pub fn findings_page() -> String {
    rules_page(HEAD, RULES) + &colophon("sdk/runtime/scene/src/rules.rs")
}
