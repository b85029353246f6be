//! Small assets, each of which shows rules that the others of `playing-conformance` do not. Their
//! numbers are those of `tests/peers/mutants`: a player with a changed rule gets others.

use htex_author::stored_fields;
use htex_dsp::grid::Band;
use htex_format::{Asset, Manifest, round_parameters};
use htex_host::Registry;
use serde_json::{Value, json};

use super::parameters::parameters;
use super::{Given, NO_MOTION, TACTILE_HZ};

/// An asset of a few models.
pub(super) struct Small {
    pub name: &'static str,
    pub quantity: &'static str,
    pub contact: &'static str,
    pub law: Option<[f64; 3]>,
    /// Speed and force; `None` if unknown.
    pub conditions: Vec<[Option<f64>; 2]>,
    /// Levels, if they are not the condition's number times 0.01.
    pub levels: Option<Vec<f64>>,
    pub triangles: Vec<[usize; 3]>,
    /// Short names of models, and a flat array for each condition.
    pub models: Vec<(&'static str, Vec<Vec<f64>>)>,
    /// Motions at which it is read.
    pub motions: Vec<Given>,
    /// A change of the manifest.
    pub change: fn(&mut Value),
}

/// Frequencies of magnitudes: the band's edges, some on the grid and some not.
pub(super) const FEW_HZ: [f64; 8] = [20.0, 22.5, 40.0, 101.25, 317.7, 640.0, 1_000.0, 1_000.5];

impl Small {
    fn new(name: &'static str, conditions: &[[f64; 2]], motions: &[[f64; 2]]) -> Self {
        Self {
            name,
            quantity: "lateral_force",
            contact: "unknown",
            law: None,
            conditions: conditions.iter().map(|c| c.map(Some)).collect(),
            levels: None,
            triangles: Vec::new(),
            models: vec![("sslope", (0..conditions.len()).map(slopes).collect())],
            motions: motions.iter().map(|motion| motion.map(Some)).collect(),
            change: |_| (),
        }
    }

    /// One condition of 80 mm/s and 0.4 N.
    fn of_models(name: &'static str, models: Vec<(&'static str, Vec<f64>)>) -> Self {
        let models = models.into_iter().map(|(model, flat)| (model, vec![flat])).collect();
        Self { models, ..Self::new(name, &[[80.0, 0.4]], &[[80.0, 0.4]]) }
    }

    /// Sets of one model at speeds from 40 mm/s on, 40 mm/s apart, and motions at and between them.
    fn of_sets(name: &'static str, model: &'static str, sets: Vec<Vec<f64>>) -> Self {
        let speeds = (1..=sets.len()).map(|i| 40.0 * i as f64);
        let conditions: Vec<[f64; 2]> = speeds.map(|speed| [speed, 0.4]).collect();
        let between = conditions.windows(2).map(|pair| [0.5 * (pair[0][0] + pair[1][0]), 0.4]);
        let motions: Vec<[f64; 2]> = conditions.iter().copied().chain(between).collect();
        Self { models: vec![(model, sets)], ..Self::new(name, &conditions, &motions) }
    }

    pub(super) fn bytes(&self, registry: &Registry) -> Vec<u8> {
        let condition = |[speed, force]: &[Option<f64>; 2]| {
            let mut condition = json!({});
            for (key, value) in [("speed_mm_s", speed), ("force_n", force)] {
                if let Some(value) = value {
                    condition[key] = json!(value);
                }
            }
            condition
        };
        let (mut representations, mut all) = (Vec::new(), Vec::new());
        for (name, sets) in &self.models {
            let descriptor = registry.find(name).unwrap().descriptor();
            let mut fields = stored_fields(descriptor);
            // Numbers of eight bytes, so that there may be any.
            if *name != "map" {
                fields.iter_mut().for_each(|field| field.store = htex_format::StoredAs::F64);
            }
            let level = |i: usize| self.levels.as_ref().map_or(0.01 * (1 + i) as f64, |all| all[i]);
            let at = (0..sets.len()).map(|i| json!({ "condition": i, "level_rms": level(i) }));
            let mut representation = json!({
                "model": descriptor.id,
                "model_version": descriptor.version,
                "fields": fields,
                "at": at.collect::<Vec<_>>(),
                "parameters": format!("{name}.bin"),
            });
            if !self.triangles.is_empty() {
                representation["triangles"] = json!(self.triangles);
            }
            representations.push(representation);
            let rounded = |flat: &Vec<f64>| round_parameters(&fields, flat).unwrap();
            all.push(sets.iter().map(rounded).collect::<Vec<_>>());
        }
        let unit = match self.quantity {
            "velocity" => "m/s",
            "acceleration" => "m/s2",
            _ => "N",
        };
        let [low_hz, high_hz] = TACTILE_HZ;
        let mut manifest = json!({
            "htex": "1.0",
            "name": self.name,
            "license": "CC0-1.0",
            "quantity": self.quantity,
            "unit": unit,
            "band": { "low_hz": low_hz, "high_hz": high_hz },
            "contact": self.contact,
            "conditions": self.conditions.iter().map(condition).collect::<Vec<_>>(),
            "representations": representations,
        });
        let given = |exponent: f64| json!({ "exponent": exponent, "source": "given" });
        if let Some([a, b, c]) = self.law {
            manifest["law"] = json!({
                "frequency_speed": given(a), "level_speed": given(b), "level_force": given(c),
            });
        }
        (self.change)(&mut manifest);
        let manifest: Manifest = serde_json::from_value(manifest).unwrap();
        let asset = Asset {
            manifest,
            parameters: all,
            reference: None,
            plugins: Vec::new(),
            notes: Vec::new(),
        };
        asset.to_bytes().unwrap()
    }
}

/// Slopes that differ in all numbers, so that a mix shows its weights.
fn slopes(i: usize) -> Vec<f64> {
    let i = i as f64;
    vec![100.0 + 7.0 * i * i, 0.5 + 0.1 * i, 1.0 + 0.3 * ((i * i) % 7.0)]
}

fn list(values: &[f64]) -> Vec<f64> {
    [&[values.len() as f64], values].concat()
}

/// All small assets.
pub(super) fn small() -> Vec<Small> {
    let groups = [meshes(), laws(), defaults(), mixtures(), shapes(), refused()];
    groups.into_iter().flatten().collect()
}

/// Groups of values, cells, and conditions at edges of the hull.
fn meshes() -> Vec<Small> {
    let law = Some([0.3, -0.6, 0.9]);
    let mesh = |name, conditions: &[[f64; 2]], motions: &[[f64; 2]]| Small {
        law,
        ..Small::new(name, conditions, motions)
    };
    vec![
        mesh(
            "close_values",
            &[
                [44.4, 1.1],
                [125.0, 0.745],
                [155.0, 0.656],
                [163.0, 0.538],
                [168.0, 0.56],
                [177.0, 0.556],
                [213.0, 0.348],
            ],
            &[[155.0, 0.394], [49.0, 1.08]],
        ),
        // In binary64, 1 - 0.95 is more than 5 % of 1, and 100 - 95 is 5 % of 100.
        mesh(
            "five_percent",
            &[[50.0, 1.0], [100.0, 0.95], [150.0, 1.0], [95.0, 0.4]],
            &[[75.0, 1.0], [97.0, 0.7], [120.0, 0.97]],
        ),
        // Two conditions would have the same position, so that no values are grouped. Two edges
        // could take the same triangle.
        mesh(
            "close_conditions",
            &[
                [164.0, 1.38],
                [178.0, 1.42],
                [186.0, 1.43],
                [161.0, 1.42],
                [183.0, 1.4],
                [166.0, 1.4],
                [164.0, 1.41],
            ],
            &[[175.0, 0.852], [172.0, 1.41], [165.0, 1.395], [181.0, 1.415]],
        ),
        // On a circle, but for the rounding of their positions.
        mesh(
            "rounded_circle",
            &[
                [171.0, 1.86],
                [201.0, 1.26],
                [81.0, 1.86],
                [186.0, 1.71],
                [66.0, 1.71],
                [126.0, 2.01],
                [147.0, 0.54],
            ],
            &[[164.0, 1.63]],
        ),
        mesh(
            "wedge",
            &[[72.8, 1.46], [201.0, 0.455], [154.0, 1.22], [198.0, 1.5]],
            &[[199.0, 0.273], [150.0, 1.2]],
        ),
        mesh(
            "flat_edges",
            &[
                [71.5, 1.31],
                [102.0, 1.02],
                [141.0, 0.793],
                [177.0, 0.465],
                [41.2, 0.431],
                [76.6, 0.534],
                [112.0, 0.608],
                [158.0, 0.726],
                [193.0, 0.399],
            ],
            &[[158.0, 0.413], [90.0, 1.14], [60.0, 0.49]],
        ),
        mesh(
            "close_groups",
            &[
                [70.0, 0.841],
                [142.0, 0.671],
                [67.9, 0.837],
                [144.0, 0.864],
                [142.0, 0.864],
                [32.0, 0.845],
                [143.0, 0.833],
            ],
            &[[144.0, 0.853]],
        ),
        mesh(
            "row_of_values",
            &[[179.0, 1.15], [181.0, 1.09], [189.0, 1.1], [191.0, 1.53], [197.0, 1.19]],
            &[[199.0, 1.25], [187.0, 1.11]],
        ),
        Small {
            triangles: vec![[2, 1, 0]],
            ..mesh(
                "slanted_triangle",
                &[[40.0, 0.4], [160.0, 0.9], [120.0, 1.3]],
                &[[200.0, 0.5], [30.0, 1.4], [100.0, 0.8]],
            )
        },
    ]
}

/// What follows the motion outside the conditions.
fn laws() -> Vec<Small> {
    let far = [
        [160.0, 0.8],
        [-160.0, 0.8],
        [1.0, 0.4],
        [4.0, 0.02],
        [320.0, 0.4],
        [900.0, 0.4],
        [900.0, 0.02],
        [80.0, 19.0],
        [80.0, 0.001],
        [0.4, 0.4],
        [80.0, 0.0],
        // The same speed but for rounding: no bin leaves the band.
        [80.000_000_04, 0.4],
    ];
    let one = |name, law| Small { law: Some(law), ..Small::new(name, &[[80.0, 0.4]], &far) };
    let of = |name, contact, quantity| Small {
        contact,
        quantity,
        ..Small::new(name, &[[80.0, 0.4]], &[[100.0, 0.5]])
    };
    let mut absent =
        Small::new("absent_force", &[[40.0, 0.0], [160.0, 0.4]], &[[300.0, 0.8], [90.0, 0.4]]);
    absent.conditions[0][1] = None;
    vec![
        one("law_rises", [2.0, 1.0, 1.0]),
        one("law_falls", [-2.0, -0.5, -1.0]),
        one("law_is_gentle", [0.5, 0.75, 0.5]),
        Small {
            law: Some([0.0, 2.0, 1.0]),
            levels: Some(vec![0.02, 0.1]),
            ..Small::new(
                "two_levels",
                &[[40.0, 0.4], [80.0, 0.4]],
                &[[40.0, 2.0], [40.0, 4.0], [40.0, 12.0], [60.0, 8.0], [300.0, 0.4]],
            )
        },
        of("finger_velocity", "finger", "velocity"),
        of("finger_acceleration", "finger", "acceleration"),
        of("tool_acceleration", "tool", "acceleration"),
        absent,
        // The nearest speed is 0.
        Small {
            law: Some([0.5, 0.5, 0.5]),
            ..Small::new("from_rest", &[[0.0, 1.0], [100.0, 1.2]], &[[5.0, 0.1], [50.0, 0.9]])
        },
    ]
}

/// Assets whose default condition is another one by each of its rules.
fn defaults() -> Vec<Small> {
    let of = |name, conditions: &[[Option<f64>; 2]], levels: &[f64]| {
        let known: Vec<[f64; 2]> =
            conditions.iter().map(|c| c.map(Option::unwrap_or_default)).collect();
        Small {
            conditions: conditions.to_vec(),
            levels: Some(levels.to_vec()),
            motions: if conditions.as_flattened().contains(&None) {
                vec![NO_MOTION]
            } else {
                vec![NO_MOTION, [Some(100.0), None], [None, Some(0.6)]]
            },
            ..Small::new(name, &known, &[])
        }
    };
    let known = |speed: f64, force: f64| [Some(speed), Some(force)];
    vec![
        of("default_first", &[known(80.0, 0.4), known(160.0, 0.4)], &[0.01, 0.05]),
        of(
            "default_slow",
            &[known(80.0, 0.4), known(0.0, 0.5), known(0.6, 0.5), known(60.0, 0.5)],
            &[0.0, 0.09, 0.07, 0.05],
        ),
        of(
            "default_without_speed",
            &[known(80.0, 0.0), [None, Some(0.4)], known(160.0, 0.4)],
            &[0.03, 0.07, 0.05],
        ),
        of(
            "default_without_force",
            &[known(120.0, 0.0), [Some(80.0), None], known(160.0, 0.4)],
            &[0.03, 0.07, 0.07],
        ),
    ]
}

/// Sets of which some cannot be mixed.
fn mixtures() -> Vec<Small> {
    let cepstrum = |count: usize, bands: f64, inverse: f64| {
        let values: Vec<f64> =
            (0..count).map(|i| [-25.0, 3.0, 0.5][i.min(2)] / (1 + i) as f64).collect();
        [list(&values), vec![bands, inverse]].concat()
    };
    let knots = |count: usize, step: f64, layout: f64| {
        let values: Vec<f64> = (0..count).map(|i| ((7 * i) % 12) as f64).collect();
        [list(&values), vec![step, layout]].concat()
    };
    let lines = |count: usize, random_phase: f64| {
        let at = |i: usize| 30.0 + 900.0 * i as f64 / count as f64;
        let frequencies: Vec<f64> = (0..count).map(at).collect();
        let amplitudes: Vec<f64> = (0..count).map(|i| 1.0 / (1 + i) as f64).collect();
        [list(&frequencies), list(&amplitudes), vec![random_phase]].concat()
    };
    let filter = |coefficients: &[f64], rate: f64| [list(coefficients), vec![rate]].concat();
    let poles_and_zeros =
        |poles: &[f64], zeros: &[f64], rate: f64| [list(poles), list(zeros), vec![rate]].concat();
    let [low_hz, high_hz] = TACTILE_HZ;
    let map = |i: usize| parameters("map", Band { low_hz, high_hz }, 0, i);
    vec![
        Small::of_sets(
            "mixed_ar",
            "ar",
            vec![filter(&[0.5], 2_000.0), filter(&[0.4, -0.3], 4_000.0), filter(&[], 4_000.0)],
        ),
        Small::of_sets(
            "mixed_mfcc",
            "mfcc",
            vec![
                cepstrum(10, 26.0, 2.0),
                cepstrum(12, 26.0, 2.0),
                cepstrum(12, 30.0, 2.0),
                cepstrum(12, 30.0, 3.0),
                cepstrum(12, 30.0, 3.0),
            ],
        ),
        Small::of_sets(
            "mixed_bands",
            "bands",
            vec![
                knots(8, 0.5, 0.0),
                knots(9, 0.5, 0.0),
                knots(9, 1.0, 0.0),
                knots(9, 1.0, 1.0),
                knots(9, 1.0, 1.0),
            ],
        ),
        Small {
            motions: [40.0, 60.0, 80.0, 100.0, 120.0, 150.0, 160.0, 40.000_000_01, 159.999_999_99]
                .map(|speed| [Some(speed), Some(0.4)])
                .to_vec(),
            ..Small::of_sets(
                "mixed_speak",
                "speak",
                vec![lines(30, 1.0), lines(34, 0.0), lines(31, 1.0), lines(31, 0.0)],
            )
        },
        Small::of_sets(
            "mixed_arma",
            "arma",
            vec![
                poles_and_zeros(&[0.5, 1.0], &[1.0, 1.0], 2_000.0),
                poles_and_zeros(&[0.6, 1.2], &[1.0, 2.0], 2_000.0),
                poles_and_zeros(&[0.6, 1.2], &[0.0], 2_000.0),
                poles_and_zeros(&[0.6, 1.2], &[1.0], 2_000.0),
                poles_and_zeros(&[0.6, 1.2, 2.0], &[1.0, 1.5], 2_000.0),
                poles_and_zeros(&[0.6, 1.2, 2.0], &[1.0, 1.5], 4_000.0),
            ],
        ),
        Small {
            motions: [60.0, 60.000_000_01, 60.000_001, 59.999_999, 100.0]
                .map(|speed| [Some(speed), Some(0.4)])
                .to_vec(),
            ..Small::of_sets("mixed_map", "map", (0..3).map(map).collect())
        },
    ]
}

/// Shapes at the edges of their rules.
fn shapes() -> Vec<Small> {
    let cepstrum =
        |values: &[f64], bands: f64, inverse: f64| [list(values), vec![bands, inverse]].concat();
    let mut wild = vec![0.0; 24];
    (wild[0], wild[23]) = (-25.0, 12.0);
    let tilted = [-20.0, 6.0, -1.0, 2.0];
    vec![
        Small::of_models(
            "edges_of_shapes",
            vec![
                // A line midway between two bins, near the edge of the band.
                (
                    "speak",
                    [list(&[22.5, 37.5, 990.0]), list(&[1.0, 0.5, 0.25]), vec![1.0]].concat(),
                ),
                ("sbeta", vec![1.0, 2.0]),
                ("bands", [list(&[3.0, 0.0, 9.0]), vec![1.0, 0.5]].concat()),
                ("mfcc", cepstrum(&tilted, 26.5, 1.5)),
                ("arma", [list(&[]), list(&[0.9, 0.9]), vec![2_000.0]].concat()),
            ],
        ),
        // Means that rounding would put out of their range.
        Small {
            models: vec![("sslope", vec![vec![100.0, 20.0, 0.05]; 3])],
            ..Small::new(
                "ends_of_ranges",
                &[[50.0, 0.2], [150.0, 0.3], [90.0, 0.9]],
                &[[75.0, 0.6], [80.0, 0.55], [80.0, 0.6]],
            )
        },
        // Lines that do not ascend are mixed to lines that do; a filter that is not stable is not.
        Small {
            models: vec![
                (
                    "arma",
                    [[1.0, 0.9], [1.0, 2.0]]
                        .map(|poles| [list(&poles), list(&[]), vec![2_000.0]].concat())
                        .to_vec(),
                ),
                ("ar", [2.0, 0.5].map(|a| [list(&[a]), vec![2_000.0]].concat()).to_vec()),
            ],
            ..Small::new(
                "refused_rules_of_sets",
                &[[40.0, 0.4], [80.0, 0.4]],
                &[[60.0, 0.4], [40.0, 0.4]],
            )
        },
        // Filters of different orders, of which the lower one has lines that do not ascend.
        of_orders("refused_poles_of_lower_order", |lines| {
            [list(lines), list(&[]), vec![2_000.0]].concat()
        }),
        of_orders("refused_zeros_of_lower_order", |lines| {
            [list(&[]), list(lines), vec![2_000.0]].concat()
        }),
        // Narrower than what is left out where alpha or beta is below 1.
        Small {
            change: |m| m["band"]["high_hz"] = json!(21.25),
            ..Small::of_sets("narrow_beta", "sbeta", vec![vec![0.5, 1.0], vec![0.5, 0.5]])
        },
        Small::of_models("clipped_cepstrum", vec![("mfcc", cepstrum(&wild, 26.0, 0.0))]),
        Small::of_models("narrow_filters", vec![("mfcc", cepstrum(&tilted, 128.0, 0.0))]),
        Small::of_models("filters_without_weight", vec![("mfcc", cepstrum(&tilted, 128.0, 2.0))]),
        // The smallest singular value is 9e-17 of the largest, and counts as zero. In the second it
        // is 1.1e-7, and does not.
        Small {
            change: |m| m["band"]["high_hz"] = json!(120.0),
            ..Small::of_models("dependent_filters", vec![("mfcc", cepstrum(&tilted, 20.0, 0.0))])
        },
        Small {
            change: |m| m["band"]["high_hz"] = json!(220.0),
            ..Small::of_models("close_filters", vec![("mfcc", cepstrum(&tilted, 38.0, 0.0))])
        },
        Small {
            change: |m| {
                let fields = m["representations"][0]["fields"].as_array_mut();
                fields.unwrap().swap(0, 1);
            },
            ..Small::of_models("other_order_of_fields", vec![("sbeta", vec![2.5, 1.5])])
        },
    ]
}

/// Two sets of lines, of which the first breaks a rule, and a mix of both.
fn of_orders(name: &'static str, set: fn(&[f64]) -> Vec<f64>) -> Small {
    Small {
        models: vec![("arma", vec![set(&[1.0, 0.9]), set(&[0.5, 1.0, 2.0])])],
        ..Small::new(name, &[[40.0, 0.4], [80.0, 0.4]], &[[60.0, 0.4], [80.0, 0.4]])
    }
}

/// Parameters that a player refuses.
fn refused() -> Vec<Small> {
    let lines = |lines: [&[f64]; 2]| [list(lines[0]), list(lines[1]), vec![2_000.0]].concat();
    let [low_hz, high_hz] = TACTILE_HZ;
    let map = |change: fn(&mut Vec<f64>)| {
        let mut flat = parameters("map", Band { low_hz, high_hz }, 0, 0);
        change(&mut flat);
        flat
    };
    vec![
        Small::of_models(
            "refused_parameters",
            vec![
                ("ar", [list(&[2.0]), vec![2_000.0]].concat()),
                ("arma", lines([&[1.0, 1.0], &[]])),
                ("map", map(|flat| flat[4] *= 1.01)),
                ("mfcc", [list(&[200_000.0]), vec![26.0, 2.0]].concat()),
                ("sbeta", vec![0.0005, 2.0]),
                ("speak", [list(&[100.0, 200.0]), list(&[1.0]), vec![0.0]].concat()),
                ("sslope", vec![100.0, 21.0, 1.0]),
            ],
        ),
        Small::of_models(
            "refused_lists",
            vec![
                ("ar", [list(&[0.0; 65]), vec![2_000.0]].concat()),
                ("arma", lines([&[1.0], &[2.0, 1.0]])),
                (
                    "map",
                    map(|flat| {
                        flat.pop();
                        flat[5] -= 1.0;
                    }),
                ),
                ("bands", [list(&[]), vec![1.0, 0.0]].concat()),
                ("speak", [list(&[10.0]), list(&[1.0]), vec![0.0]].concat()),
            ],
        ),
        // One set is out of range: the motions of its mixes are refused, and the others are not.
        Small::of_sets(
            "refused_set",
            "sslope",
            vec![slopes(0), slopes(1), vec![100.0, 21.0, 1.0], slopes(3)],
        ),
        Small {
            change: |m| m["representations"][0]["model_version"] = json!("2.0.0"),
            ..Small::of_models("refused_major_version", vec![("sbeta", vec![2.5, 1.5])])
        },
    ]
}
