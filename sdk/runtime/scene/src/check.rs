//! Checks the contents of a scene, without reading its files or opening its device.

use htex_base::finding::{Findings, Rule};

use crate::file::{Budget, Constant, DeviceChoice, FAR_MM, Motion, Region, SceneFile, Surface};
use crate::limits::Limits;
use crate::rules as rule;

/// Checks a scene without reading its files or opening its device.
pub(crate) fn check(scene: &SceneFile, limits: &Limits, findings: &mut Findings) {
    check_surfaces(&scene.surfaces, limits, findings);
    match &scene.motion {
        Motion::Constant(constant) => check_constant(constant, &scene.surfaces, findings),
        Motion::Trace(_) | Motion::Live => {}
    }
    check_device(&scene.device, findings);
    // A missing value is valid, so it is replaced by a valid number for the check.
    let duration = scene.duration_s.unwrap_or(1.0);
    let is_length = duration > 0.0 && duration <= 1e9;
    findings.require(is_length, rule::DURATION_INVALID, "/duration_s", || {
        format!("the duration is {duration} s; it must be above 0 and at most 1e9")
    });
    check_budget(&scene.budget, findings);
}

fn check_surfaces(surfaces: &[Surface], limits: &Limits, findings: &mut Findings) {
    findings.require(!surfaces.is_empty(), rule::SURFACES_EMPTY, "/surfaces", || {
        "the scene has no surface; add one with an asset".to_owned()
    });
    if surfaces.len() > limits.surfaces {
        let (there, most) = (surfaces.len(), limits.surfaces);
        let message =
            format!("the scene has {there} surfaces and the limit is {most}; split the scene");
        findings.add(rule::SURFACES_TOO_MANY, "/surfaces", message);
        // The check of overlaps compares all pairs, so it must not see too many surfaces.
        return;
    }
    for (i, surface) in surfaces.iter().enumerate() {
        check_surface(surface, &format!("/surfaces/{i}"), findings);
    }
    check_overlaps(surfaces, findings);
}

fn check_surface(surface: &Surface, at: &str, findings: &mut Findings) {
    let range = Range(0.0, 1000.0);
    range.require(surface.gain, rule::SURFACE_GAIN_INVALID, format!("{at}/gain"), findings);
    let pointer = format!("{at}/representation");
    let is_named = !surface.representation.trim().is_empty();
    findings.require(is_named, rule::REPRESENTATION_NAME_EMPTY, pointer, || {
        "the representation has no name; write a model's, or `auto`".to_owned()
    });
    let Some(region) = &surface.region else {
        return;
    };
    for (axis, [from, to]) in [("x_mm", region.x_mm), ("y_mm", region.y_mm)] {
        let sound = from < to && from.abs() <= FAR_MM && to.abs() <= FAR_MM;
        let pointer = format!("{at}/region/{axis}");
        findings.require(sound, rule::REGION_INVALID, pointer, || {
            format!("the region extends from {from} to {to} mm; write the lower number first, both within ±{FAR_MM}")
        });
    }
}

fn check_overlaps(surfaces: &[Surface], findings: &mut Findings) {
    for (i, upper) in surfaces.iter().enumerate() {
        let overlapped = |lower: &&Surface| {
            lower.layer == upper.layer && overlap(lower.region.as_ref(), upper.region.as_ref())
        };
        if let Some(other) = surfaces[..i].iter().position(|lower| overlapped(&lower)) {
            let message = format!(
                "surfaces {other} and {i} overlap on layer {}; move one, or give one a higher layer",
                upper.layer
            );
            findings.add(rule::REGION_OVERLAP, format!("/surfaces/{i}"), message);
        }
    }
}

/// Whether two regions intersect. A region that is `None` covers everything.
fn overlap(a: Option<&Region>, b: Option<&Region>) -> bool {
    let (Some(a), Some(b)) = (a, b) else {
        return true;
    };
    // Upper edges do not belong to a region, so regions may touch.
    let share = |a: [f64; 2], b: [f64; 2]| a[0] < b[1] && b[0] < a[1];
    share(a.x_mm, b.x_mm) && share(a.y_mm, b.y_mm)
}

fn check_constant(motion: &Constant, surfaces: &[Surface], findings: &mut Findings) {
    let at = "/motion/constant";
    let place = Range(-FAR_MM, FAR_MM);
    let from = motion.from_mm.unwrap_or_default();
    let numbers = [
        ("speed_mm_s", motion.speed_mm_s, Range(0.0, 1e4)),
        ("force_n", motion.force_n, Range(0.0, 1e3)),
        ("from_mm/0", from[0], place),
        ("from_mm/1", from[1], place),
        ("direction_deg", motion.direction_deg, Range(-3600.0, 3600.0)),
    ];
    for (key, value, range) in numbers {
        range.require(value, rule::MOTION_INVALID, format!("{at}/{key}"), findings);
    }
    let everywhere = surfaces.len() < 2 && surfaces.iter().all(|s| s.region.is_none());
    let is_known = everywhere || motion.from_mm.is_some();
    findings.require(is_known, rule::REGION_UNKNOWN_POSITION, at, || {
        "with several surfaces or a region the motion needs a start; add from_mm".to_owned()
    });
}

fn check_device(device: &DeviceChoice, findings: &mut Findings) {
    let numbers = [
        ("rate_hz", device.rate_hz, Range(f64::MIN_POSITIVE, 1e7)),
        ("gain_db", device.gain_db, Range(-120.0, 120.0)),
        ("quantity_gain", device.quantity_gain, Range(1e-9, 1e9)),
        ("drive_v", device.drive_v, Range(f64::MIN_POSITIVE, 1e4)),
        ("level_dbfs", device.level_dbfs, Range(-120.0, 0.0)),
        ("reference_rms", device.reference_rms, Range(1e-12, 1e6)),
        ("pitch", device.pitch, Range(0.05, 20.0)),
        ("response_depth_db", Some(device.response_depth_db), Range(0.0, 120.0)),
    ];
    for (key, value, range) in numbers {
        let Some(value) = value else { continue };
        range.require(value, rule::DEVICE_FIELD_INVALID, format!("/device/{key}"), findings);
    }
}

fn check_budget(budget: &Budget, findings: &mut Findings) {
    let numbers = [("ns_per_sample", budget.ns_per_sample), ("max_error_db", budget.max_error_db)];
    for (key, value) in numbers {
        let range = Range(f64::MIN_POSITIVE, 1e12);
        let value = value.unwrap_or(1.0);
        range.require(value, rule::BUDGET_INVALID, format!("/budget/{key}"), findings);
    }
}

/// A range of values, both ends included.
#[derive(Clone, Copy)]
struct Range(f64, f64);

impl Range {
    fn require(self, value: f64, rule: &Rule, pointer: String, findings: &mut Findings) {
        let Self(low, high) = self;
        // A range that excludes 0 begins at the smallest positive number. The message says "above
        // 0" instead.
        findings.require((low..=high).contains(&value), rule, pointer, || match low {
            f64::MIN_POSITIVE => {
                format!("{value} is out of range; it must be above 0 and at most {high}")
            }
            _ => format!("{value} is out of range; it must be from {low} to {high}"),
        });
    }
}
