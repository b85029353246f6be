//! Laws of simulated surfaces, with and without a relief: what the recordings determine, and what
//! plays outside of the recorded motions.

use htex_author::simulate::{Departures, FreeMotion, SimulationOptions, Surface, simulate};
use htex_author::{AssetRequest, Exploration, ModelRequest, SpectrumOptions, Take, fit_asset};
use htex_dsp::fidelity::third_octave_error_rms_db;
use htex_format::{Contact, Law};
use htex_host::Registry;
use htex_play::{Motion, Texture};

/// A free motion at one speed and force, whose true spectrum is known.
fn steady(surface: Surface, departures: Departures, motion: Motion) -> SimulationOptions {
    let free = FreeMotion::default()
        .with_speed_mm_s([motion.speed_mm_s; 2])
        .with_force_n([motion.force_n; 2]);
    SimulationOptions::new(surface)
        .with_free_motion(free)
        .with_departures(departures)
        .with_rate_hz(5_000.0)
}

/// Fits an asset to recordings at several motions, with the rig's response divided out.
fn recorded(
    surface: Surface,
    departures: Departures,
    contact: Contact,
    motions: &[Motion],
) -> Texture {
    let take = |motion: &Motion| {
        let simulation = simulate(&steady(surface, departures, *motion)).unwrap();
        let mut recording = simulation.to_recording("steady.csv").unwrap();
        recording.simulated = contact == Contact::Finger;
        let given =
            Exploration { speed_mm_s: Some(motion.speed_mm_s), force_n: Some(motion.force_n) };
        Take { recording, given }
    };
    let takes: Vec<Take> = motions.iter().map(take).collect();
    let response = steady(surface, departures, motions[0]).setup_response();
    let registry = Registry::builtin();
    let request = AssetRequest::new("law")
        .with_models([ModelRequest::new(registry.find("bands").unwrap())])
        .with_spectrum(SpectrumOptions::default().with_response(response.unwrap()));
    let fitted = fit_asset(&takes, &request).unwrap();
    // A computed condition has no recording, so no felt difference is stored for it.
    let conditions = fitted.asset.manifest.conditions.iter();
    let is_recorded = conditions.map(|condition| condition.segments != Some(0));
    assert!(is_recorded.eq(fitted.felt[0].iter().map(Option::is_some)));
    Texture::new(fitted.asset)
}

fn law(asset: &Texture) -> Law {
    asset.manifest().law()
}

fn motions<const N: usize>(motions: [(f64, f64); N]) -> [Motion; N] {
    motions.map(|(speed, force)| Motion::new(speed, force))
}

/// A relief, whose frequencies follow the speed and whose level follows the force, and a surface
/// whose frequencies stay the same. Each comes with its exponents and with a contact for which
/// other exponents are assumed.
fn kinds() -> [(&'static str, Departures, [f64; 3], Contact); 2] {
    let relief = Departures::default();
    let other = relief.with_frequency_speed(0.0).with_level_speed(0.5).with_level_force(0.3);
    [
        ("relief", relief, [1.0, 0.0, 1.0], Contact::Unknown),
        ("other", other, [0.0, 0.5, 0.3], Contact::Finger),
    ]
}

/// Three speeds and two forces determine the exponents on every surface, although the contact's
/// assumed exponents are different.
#[test]
fn exponents_of_simulated_surfaces_are_found() {
    let recorded_at = motions([(40.0, 0.3), (80.0, 0.3), (160.0, 0.3), (40.0, 1.2), (160.0, 1.2)]);
    for surface in Surface::ALL {
        for (kind, departures, [a, b, c], contact) in kinds() {
            let law = law(&recorded(surface, departures, contact, &recorded_at));
            println!("{surface}, {kind}, {contact:?}: {law:?}");
            // Skin and sensor do not follow the speed.
            assert!((law.frequency_speed.exponent - a).abs() < 0.17, "{a}");
            let [level_speed, level_force] =
                [law.level_speed, law.level_force].map(|x| x.estimate.unwrap());
            assert!((level_speed - b).abs() < 0.17 && (level_force - c).abs() < 0.05);
            // The exponent that plays is pulled towards the one assumed with these frequencies.
            assert!((law.level_speed.exponent - b).abs() < 0.2);
        }
    }
}

/// The true magnitudes at a motion, with the rig's response divided out, and their frequencies.
fn true_spectrum(surface: Surface, departures: Departures, motion: Motion) -> (Vec<f64>, Vec<f64>) {
    let options = steady(surface, departures, motion);
    let truth = options.truth().unwrap();
    let (grid, rig) = (truth.frequency_hz(), options.setup_response().unwrap());
    let there = truth.magnitude(motion.speed_mm_s, motion.force_n).unwrap();
    let at_finger = there.iter().zip(&grid).map(|(magnitude, f)| {
        let (re, im) = rig.value_at(*f);
        magnitude / re.hypot(im)
    });
    (grid.clone(), at_finger.collect())
}

/// The asset without the conditions that were computed between recorded ones.
fn without_computed(asset: &Texture) -> Texture {
    // Computed conditions come after the recorded ones, so cutting off the end removes them.
    let mut data = asset.data().clone();
    let recorded = |c: &&htex_format::Condition| c.segments != Some(0);
    let count = data.manifest.conditions.iter().filter(recorded).count();
    data.manifest.conditions.truncate(count);
    for representation in &mut data.manifest.representations {
        representation.at.truncate(count);
    }
    for parameters in &mut data.parameters {
        parameters.truncate(count);
    }
    Texture::new(data)
}

/// Between recorded speeds, the lines of a relief move instead of fading into each other. Where
/// frequencies stay the same, no condition is computed.
#[test]
fn lines_move_between_recorded_speeds() {
    let recorded_at = motions([(40.0, 0.4), (80.0, 0.4), (160.0, 0.4)]);
    for surface in Surface::ALL {
        for (kind, departures, [a, ..], contact) in kinds() {
            let asset = recorded(surface, departures, contact, &recorded_at);
            let plain = without_computed(&asset);
            let count = |asset: &Texture| asset.manifest().conditions.len();
            assert_eq!([count(&plain), count(&asset)], [3, if a == 1.0 { 9 } else { 3 }]);
            for between in motions([(57.0, 0.4), (113.0, 0.4)]) {
                let (grid, truth) = true_spectrum(surface, departures, between);
                let error_db = |asset: &Texture| {
                    let played = asset.magnitude(Some(between), &grid).unwrap();
                    third_octave_error_rms_db(&grid, &truth, &played).unwrap()
                };
                let (moved, mixed) = (error_db(&asset), error_db(&plain));
                let speed = between.speed_mm_s;
                println!("{surface}, {kind}, {speed} mm/s: {moved:.2} dB, unmoved {mixed:.2} dB");
                assert!(moved < 1.8 && moved < mixed + 1.3, "{moved} {mixed}");
                let lines = surface == Surface::CorrugatedPaper || surface == Surface::CoarseFabric;
                assert!(a == 0.0 || !lines || moved < mixed - 1.0, "{moved} {mixed}");
            }
        }
    }
}

/// With recordings at two speeds, what plays an octave beyond them is nearer to the truth than the
/// nearest recording, on both kinds of surface.
#[test]
fn what_plays_outside_is_nearer_than_the_nearest_recording() {
    let recorded_at = motions([(40.0, 0.4), (80.0, 0.4)]);
    let beyond = Motion::new(160.0, 0.4);
    for surface in Surface::ALL {
        for (kind, departures, _, contact) in kinds() {
            let (grid, truth) = true_spectrum(surface, departures, beyond);
            // The recording at 80 mm/s shows nothing below 20 Hz, which would be below 40 Hz here.
            let known = grid.partition_point(|hz| *hz < 40.0);
            let asset = recorded(surface, departures, contact, &recorded_at);
            let of = |motion| asset.magnitude(Some(motion), &grid).unwrap();
            let error_db = |played: Vec<f64>| {
                third_octave_error_rms_db(&grid[known..], &truth[known..], &played[known..])
            };
            let follows = error_db(of(beyond)).unwrap();
            let clamped = error_db(of(recorded_at[1])).unwrap();
            println!(
                "{surface}, {kind}, {contact:?}: {follows:.2} dB, the nearest recording {clamped:.2} dB"
            );
            assert!(follows < 2.1 && follows < clamped - 0.5, "{follows} {clamped}");
        }
    }
}

/// A recording at one speed, of noise whose spectrum is flat, with an unknown contact.
fn one_speed(request: impl Fn(AssetRequest) -> AssetRequest) -> Texture {
    let mut state = 1u32;
    let sample = |_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX) - 0.5
    };
    let samples = (0..20_000).map(sample).collect();
    let recording = htex_author::Recording::new("noise.csv", 4_000.0, vec![samples]).unwrap();
    let given = Exploration { speed_mm_s: Some(60.0), force_n: Some(0.5) };
    let registry = Registry::builtin();
    let models = ["bands", "ar"].map(|name| ModelRequest::new(registry.find(name).unwrap()));
    let request = request(AssetRequest::new("noise").with_models(models));
    Texture::new(fit_asset(&[Take { recording, given }], &request).unwrap().asset)
}

/// Beside a single speed, an asset has a slower and a faster condition. In them, the level follows
/// the law, and the spectrum is tilted by 0.14 per octave. The models that fit samples see the tilt
/// too.
#[test]
fn one_speed_of_an_unknown_contact_is_tilted() {
    let texture = one_speed(|request| request);
    let manifest = texture.manifest();
    let speeds: Vec<f64> = manifest.conditions.iter().filter_map(|c| c.speed_mm_s).collect();
    assert_eq!(speeds, [60.0, 20.0, 180.0]);
    // Bands rounds to 1 dB.
    for (model, tolerance_db) in [("bands", 1.0), ("ar", 0.6)] {
        let representation = texture.representation(model).unwrap();
        let at = |speed| {
            let motion = Some(Motion::new(speed, 0.5));
            representation.magnitude(motion, &[125.0, 500.0]).unwrap()
        };
        let level = |place: usize| representation.data().at[place].level_rms;
        for (place, ratio) in [(1, 1.0 / 3.0), (2, 3.0f64)] {
            assert!((level(place) / level(0) / ratio.powf(0.75) - 1.0).abs() < 0.02, "{model}");
            // From 125 to 500 Hz, two octaves.
            let [own, other] = [at(60.0), at(60.0 * ratio)].map(|of| of[1] / of[0]);
            let tilt_db = 20.0 * (other / own).log10();
            let expected_db = 20.0 * 0.28 * ratio.log10();
            assert!(
                (tilt_db - expected_db).abs() < tolerance_db,
                "{model}: {tilt_db}, {expected_db}"
            );
        }
    }
}

/// Nothing is added where more is known, or where the user asks for recorded conditions only.
#[test]
fn other_assets_have_only_recorded_conditions() {
    let conditions = |set: &dyn Fn(&mut AssetRequest)| {
        let texture = one_speed(|mut request| {
            set(&mut request);
            request
        });
        texture.manifest().conditions.len()
    };
    assert_eq!(conditions(&|request| request.contact = Some(Contact::Tool)), 1);
    assert_eq!(conditions(&|request| request.contact = Some(Contact::Finger)), 1);
    assert_eq!(conditions(&|request| request.recorded_only = true), 1);
    assert_eq!(conditions(&|request| request.law = "frequency-speed=0.3".parse().ok()), 1);
}
