//! Reference data for players: the models' descriptors, assets with parameters of every model, and
//! the values that players should read from them.

mod parameters;
mod rules;

use htex::Texture;
use htex::play::exploration::{CEILING, slides};
use htex_author::stored_fields;
use htex_dsp::grid::Band;
use htex_host::{LoadedModel, Registry};
use serde_json::{Value, json};
use xtask::generated::File;

use parameters::parameters;

/// An asset to make: its band, its conditions, and the motions at which it is read.
struct Plan {
    name: &'static str,
    band_hz: [f64; 2],
    /// Speed, mm/s, and force, newtons.
    conditions: &'static [[f64; 2]],
    motions: &'static [[f64; 2]],
    contact: &'static str,
    /// Exponents of the law, if it has one: frequency over speed, level over speed, level over
    /// force.
    law: Option<[f64; 3]>,
    /// Stored triangles, as indices of its conditions.
    triangles: &'static [[usize; 3]],
    /// Levels, newtons, if they differ from the condition's number. The asset is then also read
    /// without a motion.
    levels: Option<&'static [f64]>,
}

impl Plan {
    fn band(&self) -> Band {
        let [low_hz, high_hz] = self.band_hz;
        Band { low_hz, high_hz }
    }
}

/// The speed, mm/s, and the force, newtons, at which an asset is read, if they are given.
type Given = [Option<f64>; 2];

const NO_MOTION: Given = [None, None];

const TACTILE_HZ: [f64; 2] = [20.0, 1000.0];

/// The conditions of assets with three to five are far from a line and from a circle. The
/// conditions of `grid`, as measured by hand, are in neither of a grid's orders. The conditions of
/// `circle` have positions on a circle.
const PLANS: [Plan; 9] = [
    Plan {
        name: "one_condition",
        contact: "finger",
        law: None,
        levels: None,
        triangles: &[],
        band_hz: TACTILE_HZ,
        conditions: &[[80.0, 0.4]],
        motions: &[[160.0, 0.8], [7.0, 0.1], [900.0, 19.0]],
    },
    Plan {
        name: "two_speeds",
        contact: "tool",
        law: None,
        levels: None,
        triangles: &[],
        band_hz: TACTILE_HZ,
        conditions: &[[40.0, 0.4], [160.0, 0.4]],
        motions: &[[70.0, 0.4], [100.0, 0.4], [20.0, 0.9], [400.0, 0.1]],
    },
    Plan {
        name: "three_conditions",
        contact: "unknown",
        law: Some([0.3, -0.6, 0.9]),
        levels: None,
        triangles: &[],
        band_hz: TACTILE_HZ,
        conditions: &[[50.0, 0.2], [150.0, 0.3], [90.0, 0.9]],
        motions: &[[95.0, 0.45], [60.0, 0.3], [100.0, 0.1], [150.0, 0.9], [10.0, 0.1]],
    },
    Plan {
        name: "narrow_band",
        contact: "unknown",
        law: None,
        levels: None,
        triangles: &[],
        band_hz: [32.5, 437.5],
        conditions: &[[50.0, 0.2], [170.0, 0.25], [60.0, 0.8], [140.0, 0.9]],
        motions: &[[100.0, 0.5], [75.0, 0.3], [130.0, 0.4], [200.0, 0.6]],
    },
    Plan {
        name: "five_conditions",
        contact: "finger",
        law: Some([1.0, 0.25, 0.0]),
        levels: None,
        triangles: &[],
        band_hz: TACTILE_HZ,
        conditions: &[[40.0, 0.2], [170.0, 0.25], [90.0, 0.6], [50.0, 1.1], [190.0, 1.0]],
        motions: &[[80.0, 0.3], [60.0, 0.7], [120.0, 0.9], [150.0, 0.6], [300.0, 2.0]],
    },
    Plan {
        name: "grid",
        contact: "finger",
        law: None,
        levels: None,
        triangles: &[],
        band_hz: TACTILE_HZ,
        conditions: &[
            [161.0, 1.01],
            [40.0, 1.0],
            [80.0, 0.4],
            [39.6, 0.41],
            [79.0, 1.02],
            [160.0, 0.4],
        ],
        motions: &[
            [60.0, 0.7],
            [50.0, 0.8],
            [70.0, 0.5],
            [120.0, 0.9],
            [79.7, 0.405],
            [320.0, 0.7],
        ],
    },
    Plan {
        name: "circle",
        contact: "tool",
        law: None,
        levels: None,
        triangles: &[],
        band_hz: [32.5, 437.5],
        conditions: &[
            [140.0, 0.2],
            [200.0, 0.7],
            [40.0, 0.7],
            [100.0, 1.0],
            [40.0, 0.5],
            [200.0, 0.5],
            [100.0, 0.2],
            [140.0, 1.0],
        ],
        motions: &[[120.0, 0.6], [60.0, 0.62], [150.0, 0.4], [110.0, 0.95]],
    },
    Plan {
        name: "triangles",
        contact: "tool",
        law: None,
        levels: None,
        // Uses the diagonal opposite to the fan from the slow and light condition, with both senses
        // of turning. By its force, the last condition would be grouped with the lower edge; here
        // it is the corner of a narrow triangle.
        triangles: &[[3, 2, 1], [4, 1, 3], [0, 4, 1], [0, 3, 4]],
        band_hz: TACTILE_HZ,
        conditions: &[[40.0, 0.4], [40.0, 1.2], [160.0, 1.2], [160.0, 0.4], [100.0, 0.41]],
        motions: &[
            [100.0, 0.8],
            [120.0, 1.0],
            [100.0, 0.405],
            [110.0, 0.3],
            [200.0, 2.0],
            [20.0, 0.7],
        ],
    },
    Plan {
        name: "silent_first",
        contact: "tool",
        law: None,
        // As in files of the Penn Haptic Texture Toolkit: nothing is felt at rest. The strongest
        // level is stored where no finger presses.
        levels: Some(&[0.0, 0.09, 0.02, 0.05, 0.03]),
        triangles: &[],
        band_hz: TACTILE_HZ,
        conditions: &[[0.0, 0.0], [150.0, 0.0], [60.0, 0.5], [150.0, 0.5], [60.0, 1.2]],
        motions: &[[100.0, 0.6], [30.0, 0.2]],
    },
];

/// Further frequencies for magnitudes, off the grid and outside the band, hertz.
const BESIDE_HZ: [f64; 8] = [10.0, 19.99, 33.3, 101.25, 317.7, 437.5, 998.5, 1_000.5];

/// The folder of the models' descriptors.
pub const MODELS: &str = "spec/models";

/// The folder of the assets and their numbers.
pub const CASES: &str = "spec/playing-conformance";

/// All files of both folders.
pub fn files() -> Vec<File> {
    let registry = Registry::builtin();
    let mut files: Vec<File> = registry.models().iter().map(descriptor).collect();
    for (number, plan) in PLANS.iter().enumerate() {
        let bytes = asset(&registry, number, plan);
        let texture = Texture::from_bytes(&bytes).unwrap();
        let given = plan.conditions.iter().chain(plan.motions);
        let given =
            given.filter(|motion| slides(motion[0], motion[1])).map(|motion| motion.map(Some));
        let motions: Vec<_> = given.chain(plan.levels.map(|_| NO_MOTION)).collect();
        let mut frequency_hz = texture.band().grid_hz();
        frequency_hz.extend(BESIDE_HZ);
        files.extend(pair(plan.name, bytes, &motions, &frequency_hz));
    }
    for small in rules::small() {
        let bytes = small.bytes(&registry);
        files.extend(pair(small.name, bytes, &small.motions, &rules::FEW_HZ));
    }
    files
}

/// An asset's file, and the file of the values read from it.
fn pair(name: &str, bytes: Vec<u8>, motions: &[Given], frequency_hz: &[f64]) -> [File; 2] {
    let numbers = numbers(name, &Texture::from_bytes(&bytes).unwrap(), motions, frequency_hz);
    let path = |ending: &str| format!("{CASES}/{name}.{ending}");
    [(path("htex"), bytes), (path("json"), numbers.into_bytes())]
}

/// A model's descriptor in the form that crosses the ABI, and its path.
fn descriptor(model: &LoadedModel) -> File {
    let text = serde_json::to_string_pretty(model.descriptor()).unwrap() + "\n";
    (format!("{MODELS}/{}.json", model.id()), text.into_bytes())
}

fn asset(registry: &Registry, number: usize, plan: &Plan) -> Vec<u8> {
    let conditions: Vec<Value> = plan
        .conditions
        .iter()
        .map(|[speed, force]| json!({"speed_mm_s": speed, "force_n": force}))
        .collect();
    let mut representations = Vec::new();
    let mut all = Vec::new();
    for model in registry.models() {
        let fields = stored_fields(model.descriptor());
        let sets: Vec<Vec<f64>> = (0..conditions.len())
            .map(|i| parameters(model.short_name(), plan.band(), number, i))
            .map(|flat| htex_format::round_parameters(&fields, &flat).unwrap())
            .collect();
        let at: Vec<Value> = (0..sets.len())
            .map(|i| {
                let level_rms = plan.levels.map_or(0.01 * (1 + i + number) as f64, |all| all[i]);
                json!({"condition": i, "level_rms": level_rms})
            })
            .collect();
        representations.push(json!({
            "model": model.id(),
            "model_version": model.descriptor().version,
            "fields": fields,
            "at": at,
            "triangles": plan.triangles,
            "parameters": format!("parameters/{}.bin", model.id()),
        }));
        all.push(sets);
    }
    let mut manifest = json!({
        "htex": "1.0",
        "name": plan.name,
        "license": "CC0-1.0",
        "quantity": "lateral_force",
        "unit": "N",
        "band": {"low_hz": plan.band_hz[0], "high_hz": plan.band_hz[1]},
        "contact": plan.contact,
        "conditions": conditions,
        "representations": representations,
    });
    let given = |exponent: f64| json!({ "exponent": exponent, "source": "given" });
    if let Some([a, b, c]) = plan.law {
        manifest["law"] = json!({
            "frequency_speed": given(a), "level_speed": given(b), "level_force": given(c),
        });
    }
    let asset = htex_format::Asset {
        manifest: serde_json::from_value(manifest).unwrap(),
        parameters: all,
        reference: None,
        plugins: Vec::new(),
        notes: Vec::new(),
    };
    asset.to_bytes().unwrap()
}

/// The values read from an asset, one line of JSON per case.
fn numbers(name: &str, asset: &Texture, motions: &[Given], frequency_hz: &[f64]) -> String {
    let mut cases = Vec::new();
    for representation in &asset.manifest().representations {
        let model = &representation.model;
        for motion in motions {
            let read = values(asset, model, *motion, frequency_hz);
            let mut case = read.unwrap_or_else(|_| json!({ "refused": true }));
            case["model"] = model[..].into();
            for (key, value) in ["speed_mm_s", "force_n"].into_iter().zip(*motion) {
                if let Some(value) = value {
                    case[key] = value.into();
                }
            }
            cases.push(case);
        }
    }
    let cases: Vec<String> = cases.iter().map(Value::to_string).collect();
    format!(
        "{{\"asset\":\"{name}.htex\",\n\"frequency_hz\":{},\n\"cases\":[\n{}\n]}}\n",
        json!(frequency_hz),
        cases.join(",\n")
    )
}

/// The values read from a representation at a motion.
fn values(
    asset: &Texture,
    model: &str,
    motion: Given,
    frequency_hz: &[f64],
) -> Result<Value, htex::Error> {
    let playable = asset.representation(model)?;
    // The direction of a motion has no effect.
    let motion =
        (motion != NO_MOTION).then(|| playable.motion(motion[0], motion[1]).without_direction());
    let (parameters, _) = playable.parameters(motion)?;
    let factor = match motion {
        Some(motion) if !playable.model()?.follows_motion() => {
            playable.conditions()?.scaling(motion, CEILING).frequency
        }
        _ => 1.0,
    };
    Ok(json!({
        "parameters": parameters,
        "frequency_factor": factor,
        "level_rms": playable.level_rms(motion)?,
        "magnitude": rounded(&playable.magnitude(motion, frequency_hz)?),
    }))
}

/// Rounded to twelve digits, more than players must match.
fn rounded(values: &[f64]) -> Vec<f64> {
    let round = |x: &f64| format!("{x:.11e}").parse().unwrap();
    values.iter().map(round).collect()
}
