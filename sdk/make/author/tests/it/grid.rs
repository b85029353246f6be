//! Grids of conditions from one recording of a free motion, compared with the simulator's true
//! spectra.

use htex_author::simulate::{Departures, FreeMotion, SimulationOptions, Surface, simulate};
use htex_author::{
    AssetRequest, CellStatus, Exploration, FittedAsset, Grid, ModelRequest, Recording,
    SpectrumOptions, Take, fit_asset,
};
use htex_dsp::fidelity::third_octave_error_rms_db;
use htex_dsp::normal::Normal;
use htex_format::{AtCondition, Measure};
use htex_host::Registry;
use htex_play::{Mesh, Motion, Texture};

fn free(surface: Surface, seconds: f64) -> SimulationOptions {
    SimulationOptions::new(surface)
        .with_free_motion(FreeMotion::default())
        .with_duration_s(seconds)
        .with_rate_hz(5_000.0)
}

fn take(options: &SimulationOptions) -> Take {
    Take {
        recording: simulate(options).unwrap().to_recording("free.csv").unwrap(),
        given: Exploration::default(),
    }
}

/// Fits a recording that is divided by the rig's response, as with the option `--frf`.
fn fit_at_finger(options: &SimulationOptions, models: &[&str]) -> FittedAsset {
    let spectrum = SpectrumOptions::default().with_response(options.setup_response().unwrap());
    fit_with(&[take(options)], models, Grid::default(), spectrum)
}

fn fit(takes: &[Take], models: &[&str], grid: Grid) -> FittedAsset {
    fit_with(takes, models, grid, SpectrumOptions::default())
}

fn fit_with(takes: &[Take], models: &[&str], grid: Grid, spectrum: SpectrumOptions) -> FittedAsset {
    let registry = Registry::builtin();
    let of = |name: &&str| ModelRequest::new(registry.find(name).unwrap());
    let request = AssetRequest::new("grid")
        .with_models(models.iter().map(of))
        .with_spectrum(spectrum)
        .with_grid(grid);
    fit_asset(takes, &request).unwrap()
}

/// Third-octave errors of what a player interpolates at random motions inside the mesh.
fn errors_db(asset: &Texture, model: &str, options: &SimulationOptions, count: usize) -> Vec<f64> {
    let truth = options.truth().unwrap();
    let rig = options.setup_response().unwrap();
    let conditions = &asset.manifest().conditions;
    let points: Vec<[f64; 2]> =
        conditions.iter().map(|c| [c.speed_mm_s.unwrap(), c.force_n.unwrap()]).collect();
    let mesh = Mesh::new(&points);
    let mut random = Normal::new(99);
    let mut errors = Vec::new();
    while errors.len() < count {
        let log = |low: f64, high: f64, part: f64| low * (high / low).powf(part);
        let speed = log(36.0, 280.0, random.next_unit());
        let force = log(0.15, 3.8, random.next_unit());
        if !mesh.surrounds(speed, force) {
            continue;
        }
        let motion = Motion::new(speed, force);
        let grid = truth.frequency_hz();
        let recorded = truth.magnitude(speed, force).unwrap();
        let at_finger = recorded.iter().zip(&grid).map(|(magnitude, f)| {
            let (re, im) = rig.value_at(*f);
            magnitude / re.hypot(im)
        });
        let truth_at: Vec<f64> = at_finger.collect();
        let played = asset.representation(model).unwrap().magnitude(Some(motion), &grid).unwrap();
        errors.push(third_octave_error_rms_db(&grid, &truth_at, &played).unwrap());
    }
    errors.sort_by(f64::total_cmp);
    errors
}

fn thirds(options: &SimulationOptions, fitted: FittedAsset) -> Vec<f64> {
    errors_db(&Texture::new(fitted.asset), "bands", options, 200)
}

/// Inside the mesh a player is within 1 dB of the truth in third octaves (RMS over the bands).
#[test]
fn one_free_recording_gives_the_truth_inside_the_mesh() {
    let options = free(Surface::Sandpaper, 120.0);
    let fitted = fit_at_finger(&options, &["bands"]);
    let report = fitted.grid.clone().unwrap();
    let conditions = &fitted.asset.manifest.conditions;
    assert!(conditions.len() >= 18 && conditions.len() == fitted.spectra.len());
    assert!(conditions.iter().all(|c| c.segments.is_some_and(|n| n >= 8)));
    assert!(!report.triangles.is_empty() && report.steady < report.windows);
    assert!(fitted.findings.is_empty(), "{:?}", fitted.findings);
    assert!(report.one_condition_rms_db.unwrap() > 2.0 * report.left_out_rms_db.unwrap());
    // Each cell names its condition, and the mesh covers most of the motions.
    for cell in report.cells.iter().filter(|c| c.status != CellStatus::Thin) {
        let condition = &conditions[cell.condition.unwrap()];
        assert_eq!(condition.speed_mm_s, Some(cell.speed_mm_s));
        assert_eq!(condition.force_n, Some(cell.force_n));
    }
    let [slow, fast] = [0, report.speed_mm_s.len() - 1].map(|i| report.speed_mm_s[i]);
    assert!(slow < 45.0 && fast > 220.0, "{slow} to {fast} mm/s");
    assert_eq!(fitted.asset.manifest.provenance.recordings[0].segments, report.steady as u64);
    // The held-out error needs no knowledge of the truth, and it bounds the error of what a player
    // makes.
    let at = &fitted.asset.manifest.representations[0].at;
    let left: Vec<f64> = at.iter().filter_map(left_out_db).collect();
    assert!(left.len() * 2 > at.len(), "{} of {}", left.len(), at.len());
    let left_db = root_mean_square(left.iter().copied());
    let errors = thirds(&options, fitted);
    let [half, most, all] = [0.5, 0.95, 1.0].map(|part| {
        let last = errors.len() as f64 - 1.0;
        errors[(part * last) as usize]
    });
    println!("median {half:.2}, 95 % {most:.2}, worst {all:.2} dB; left out {left_db:.2} dB");
    assert!(half < 0.7 && most < 1.0 && all < 1.3, "{half}, {most}, {all} dB");
    assert!(left_db < 1.2 && left_db > half);
}

/// The same holds where frequencies stay, the level rises with the speed, and the finger leaves the
/// surface a fifth of the time.
#[test]
fn a_hand_that_lifts_over_no_relief_gives_the_truth_inside_the_mesh() {
    let departures =
        Departures::default().with_frequency_speed(0.0).with_level_speed(0.5).with_level_force(0.3);
    let in_contact = free(Surface::Sandpaper, 120.0).with_departures(departures);
    let lifting = in_contact.clone().with_departures(departures.with_lifted(0.2));
    let errors = thirds(&in_contact, fit_at_finger(&lifting, &["bands"]));
    let [half, most] = [0.5, 0.95].map(|part| errors[(part * errors.len() as f64) as usize]);
    println!("median {half:.2}, 95 % {most:.2} dB");
    assert!(half < 0.7 && most < 1.0, "{half}, {most} dB");
}

/// Noise over a motion whose speed and force vary by a quarter. Its level follows the law assumed
/// for an unknown contact, and rises over time by some decibels.
fn noise(seconds: f64, rise_db: f64) -> Take {
    const RATE_HZ: f64 = 2000.0;
    let times: Vec<f64> = (0..(seconds * RATE_HZ) as usize).map(|at| at as f64 / RATE_HZ).collect();
    let speed = |t: &f64| 100.0 * (0.25 * (2.0 * t).sin()).exp();
    let normal = |t: &f64| (0.25 * (2.7 * t).sin()).exp();
    let mut random = Normal::new(5);
    let force = |t: &f64| {
        let gain = 10f64.powf(rise_db * t / seconds / 20.0);
        0.1 * gain * (speed(t) / 100.0).powf(0.75) * normal(t).sqrt() * random.next_normal()
    };
    let lateral = times.iter().map(force).collect();
    let recording = Recording::new("noise.csv", RATE_HZ, vec![lateral])
        .unwrap()
        .with_speed(times.iter().map(speed).collect())
        .unwrap();
    Take {
        recording: recording.with_normal(times.iter().map(normal).collect()).unwrap(),
        given: Exploration::default(),
    }
}

/// The left-out blocks are from another time, so a texture that drifts has a larger held-out error
/// than noise has.
#[test]
fn what_drifts_is_in_the_left_out_error() {
    let [still, drifting] = [0.0, 8.0].map(|rise_db| {
        let fitted = fit(&[noise(40.0, rise_db)], &["bands"], Grid::default());
        let at = &fitted.asset.manifest.representations[0].at;
        root_mean_square(at.iter().filter_map(left_out_db))
    });
    println!("left out {still:.2} dB, with a drift {drifting:.2} dB");
    assert!(still < 1.5 && drifting > 2.0, "{still} {drifting}");
}

#[test]
fn a_grid_that_is_no_better_than_one_condition_is_found() {
    let fitted = fit(&[noise(8.0, 0.0)], &["bands"], Grid::default());
    let report = fitted.grid.unwrap();
    let (grid, one) = (report.left_out_rms_db, report.one_condition_rms_db);
    assert!(one.unwrap() <= grid.unwrap(), "{one:?} {grid:?}");
    let found = fitted.findings.iter().find(|f| f.finding.code == "GRID_NOT_BETTER");
    assert_eq!(found.unwrap().recording, "noise.csv");
    let warnings = &fitted.asset.manifest.provenance.warnings;
    assert!(warnings.iter().any(|w| w.contains("GRID_NOT_BETTER")));
}

#[test]
fn given_lines_are_the_conditions_and_far_lines_stay_empty() {
    let options = free(Surface::Vinyl, 30.0);
    let takes = [take(&options)];
    let grid = Grid::parse(["speed=60,90,135,1000", "force=0.5,1.5"]).unwrap();
    let fitted = fit(&takes, &["bands"], grid);
    let speeds: Vec<f64> =
        fitted.asset.manifest.conditions.iter().map(|c| c.speed_mm_s.unwrap()).collect();
    assert_eq!(speeds, [60.0, 60.0, 90.0, 90.0, 135.0, 135.0]);
    let report = fitted.grid.unwrap();
    let at = |speed, force| report.cell(speed, force).unwrap().status;
    assert_eq!([at(3, 0), at(3, 1)], [CellStatus::Thin; 2]);
    // Cut into two parts, the recording gives nearly the same windows and the same conditions.
    let half = |from: Option<f64>, to: Option<f64>| Take {
        recording: takes[0].recording.clone().between(from, to).unwrap(),
        given: Exploration::default(),
    };
    let halves = [half(None, Some(15.0)), half(Some(15.0), None)];
    let grid = Grid::parse(["speed=60,90,135", "force=0.5,1.5"]).unwrap();
    assert_eq!(fit(&halves, &["bands"], grid).asset.manifest.conditions.len(), 6);
}

#[test]
fn recordings_without_a_free_motion_are_refused_with_what_to_do() {
    let registry = Registry::builtin();
    let bands = [ModelRequest::new(registry.find("bands").unwrap())];
    let refused = |recording: Recording, given: Exploration, grid: &str| {
        let request = AssetRequest::new("x")
            .with_models(bands.clone())
            .with_grid(grid.parse::<Grid>().unwrap());
        let take = Take { recording, given };
        fit_asset(&[take], &request).unwrap_err().to_string()
    };
    let one = Exploration::default();
    let moving = take(&free(Surface::Vinyl, 10.0)).recording;
    let still = Recording { speed_mm_s: None, ..moving.clone() };
    assert!(refused(still, one, "auto").contains("the speed is not in the file"));
    let constant = SimulationOptions::new(Surface::Vinyl).with_rate_hz(5_000.0);
    let constant = simulate(&constant).unwrap().to_recording("sweeps").unwrap();
    assert!(refused(constant, one, "auto").contains("the motion is constant"));
    let text = refused(moving.clone(), one, "speed=900,950");
    assert!(text.contains("no cell") && text.contains("mm/s"), "{text}");
    let short = moving.clone().between(None, Some(1.0)).unwrap();
    assert!(refused(short, one, "auto").contains("record for longer"));
    let restless = Recording {
        speed_mm_s: Some((0..moving.samples()).map(|i| (i / 200 % 2) as f64 * 100.0).collect()),
        ..moving.clone()
    };
    assert!(refused(restless, one, "auto").contains("stroke more evenly"));
    // A given force replaces a missing column, so the grid has only lines of speed.
    let unpressed = Recording { normal_n: None, ..moving };
    let given = Exploration { force_n: Some(0.5), ..one };
    assert!(refused(unpressed.clone(), one, "auto").contains("the normal force"));
    let request = AssetRequest::new("x").with_models(bands).with_grid(Grid::default());
    let take = Take { recording: unpressed, given };
    let fitted = fit_asset(&[take], &request).unwrap();
    assert_eq!(fitted.grid.unwrap().force_n, [0.5]);
    for (text, why) in [
        ("speed", "neither"),
        ("speed=", "not a number"),
        ("speed=0", "not above 0"),
        ("force=NaN", "not above 0"),
        ("speed=80,82", "5 %"),
    ] {
        let error = text.parse::<Grid>().unwrap_err().to_string();
        assert!(error.contains(why), "{error}");
    }
    assert!(Grid::parse(["speed=1", "speed=2"]).is_err());
}

/// The numbers of `docs/free-motion.md`. `cargo xtask prove grids` covers all models and surfaces,
/// a plain test only Bands on vinyl.
#[test]
fn errors_inside_the_mesh_stay_small() {
    let (models, surfaces) = if xtask::prove::whole() {
        (Registry::builtin_names(), Surface::ALL.to_vec())
    } else {
        (vec!["bands"], vec![Surface::Vinyl])
    };
    for surface in surfaces {
        let options = free(surface, 120.0);
        let fitted = fit_at_finger(&options, &models);
        let report = fitted.grid.unwrap();
        let [speeds, forces] = [&report.speed_mm_s, &report.force_n].map(Vec::len);
        println!("{surface}: {speeds} x {forces} lines");
        let asset = Texture::new(fitted.asset);
        for representation in &asset.manifest().representations {
            let model = representation.model.as_str();
            let left_out_db = root_mean_square(representation.at.iter().filter_map(left_out_db));
            let errors = errors_db(&asset, model, &options, 500);
            let [median, most, worst] = [errors[250], errors[475], errors[499]];
            println!(
                "  {model}: median {median:.2}, 95 % {most:.2}, worst {worst:.2}, left out {left_out_db:.2} dB"
            );
            let bands = model == "org.htex.bands";
            assert!(!bands || (median < 0.7 && most < 1.1 && worst < 2.5));
        }
    }
}

fn left_out_db(at: &AtCondition) -> Option<f64> {
    at.left_out?.0.get(Measure::ThirdOctave)
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, n), x| (sum + x * x, n + 1));
    (sum / f64::from(count)).sqrt()
}
