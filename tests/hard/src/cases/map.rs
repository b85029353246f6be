//! Maps of all sizes, and fingers that jump.

use htex_host::{Band, ModelVoice, Motion};

use crate::seen::{model, outcome_text};
use crate::{Bound, Case, Section, failures, none, refused, within};

pub(crate) const SECTION: Section = Section {
    title: "Friction maps",
    about: "Maps of one pixel to the largest, without differences, and places, speeds and forces at the ends of their ranges.",
    cases: CASES,
};

const BAND: Band = Band::TACTILE;
const RATE_HZ: f64 = 4_000.0;
const SPEED_MM_S: f64 = 80.0;
/// The largest coordinate that a host may pass.
const FARTHEST_MM: f64 = 1e12;
const FASTEST_MM_S: f64 = 1e6;
const STRONGEST_N: f64 = 1e6;

/// Parameters for grey values, with their own RMS, or 1 if they have none.
fn map(width: usize, pitch_mm: f64, grey: &[f64]) -> Vec<f64> {
    let rms = htex_map::rms(width, pitch_mm, SPEED_MM_S, grey, BAND).unwrap_or(1.0);
    let scalars = [width as f64, pitch_mm, SPEED_MM_S, 0.5, rms, grey.len() as f64];
    [&scalars[..], grey].concat()
}

/// A number of grey values in a fixed pattern, whose neighbours differ strongly.
fn rough(count: usize) -> Vec<f64> {
    let value = |i: usize| ((i * i * 7919 + i * 104_729) % 256) as f64;
    (0..count).map(value).collect()
}

fn voice(parameters: &[f64]) -> ModelVoice {
    model("map").voice(parameters, BAND, RATE_HZ, 1).unwrap()
}

fn motion(speed_mm_s: f64, force_n: f64, [x_mm, y_mm]: [f64; 2]) -> Motion {
    Motion { speed_mm_s, force_n, position_mm: 0.0, x_mm, y_mm }
}

/// The largest sample of a voice that receives motions 10 ms apart; NaN if a sample is not finite.
fn largest(parameters: &[f64], motions: &[Motion]) -> f64 {
    let (mut voice, mut largest) = (voice(parameters), 0.0);
    for motion in motions {
        voice.set_motion(*motion).unwrap();
        let mut samples = [0.0f32; 40];
        voice.render(&mut samples).unwrap();
        largest = samples.iter().fold(largest, |most, x| crate::worse(most, f64::from(x.abs())));
    }
    largest
}

/// Whether a map plays, without motions and with them, within what its grey values allow at 16
/// times the force.
fn is_bounded(parameters: &[f64]) -> bool {
    let magnitude = model("map").magnitude(parameters, BAND, &BAND.grid_hz());
    let places = [[0.0; 2], [0.3, -0.2], [FARTHEST_MM; 2], [-FARTHEST_MM, 0.0], [0.0; 2]];
    let motions: Vec<Motion> = places
        .into_iter()
        .flat_map(|place| {
            [
                motion(SPEED_MM_S, 0.5, place),
                motion(-FASTEST_MM_S, STRONGEST_N, place),
                motion(0.0, 0.0, place),
            ]
        })
        .collect();
    let mut untold = [0.0f32; 4_000];
    voice(parameters).render(&mut untold).unwrap();
    // The cubic overshoots by a fourth along each axis, and the filters at the edges by less than a
    // factor of two.
    let most = 16.0 * 2.0 * 1.25 * 1.25 * 255.0 / parameters[4];
    let told = largest(parameters, &motions);
    magnitude.is_ok() && untold.iter().all(|x| f64::from(x.abs()) <= most) && told <= most
}

/// How grey values are refused, by magnitude and by voice.
fn said_of(parameters: &[f64]) -> String {
    let magnitude = outcome_text(model("map").magnitude(parameters, BAND, &[100.0]));
    let voice = outcome_text(model("map").voice(parameters, BAND, RATE_HZ, 1));
    if magnitude == voice { voice } else { format!("by magnitude {magnitude}; by voice {voice}") }
}

const CASES: &[Case] = &[
    within(
        "2 x 1, 3 x 1, 1 row of 255, 255 x 255; rough, one pixel of 255, one that differs by 1; told motions to the ends of their ranges",
        "map",
        "magnitude, render",
        none("finite and within the grey values"),
        || {
            let one = |most: f64| -> Vec<f64> {
                (0..64).map(|i| if i == 9 { most } else { 0.0 }).collect()
            };
            let sets = [
                map(2, 1.0, &[0.0, 255.0]),
                map(3, 0.9, &[0.0, 255.0, 7.0]),
                map(255, 0.02, &rough(255)),
                map(255, 0.1, &rough(255 * 255)),
                map(16, 0.1, &one(255.0)),
                map(16, 0.1, &one(1.0)),
            ];
            failures(sets.map(|set| is_bounded(&set)))
        },
    ),
    within(
        "a finger that rests on a rough map",
        "map",
        "render",
        Bound(1e-3, "of the RMS", "silence after half a second"),
        || {
            let parameters = map(100, 0.1, &rough(100));
            let mut voice = voice(&parameters);
            voice.set_motion(motion(0.0, 0.5, [3.0, 2.0])).unwrap();
            let mut samples = [0.0f32; 4_000];
            voice.render(&mut samples).unwrap();
            samples[2_000..].iter().fold(0.0, |most, x| most.max(f64::from(x.abs())))
        },
    ),
    refused(
        "grey values without differences",
        "map",
        "magnitude and voice",
        "the map has nothing between 20 and 1000 Hz",
        || said_of(&map(8, 0.1, &[77.0; 32])),
    ),
    refused(
        "differences across the rows alone",
        "map",
        "magnitude and voice",
        "the map has nothing between 20 and 1000 Hz",
        || {
            let rows: Vec<f64> = (0..32).map(|i| f64::from(i / 8 * 60)).collect();
            said_of(&map(8, 0.1, &rows))
        },
    ),
    refused(
        "grey values that are no rows",
        "map",
        "magnitude and voice",
        "it has 1 to 255 rows of `width`",
        || said_of(&map(8, 0.1, &rough(31))),
    ),
    refused(
        "an RMS that is not that of the grey values",
        "map",
        "magnitude and voice",
        "and that of `grey` is",
        || {
            let mut parameters = map(8, 0.1, &rough(32));
            parameters[4] *= 1.000_01;
            said_of(&parameters)
        },
    ),
];
