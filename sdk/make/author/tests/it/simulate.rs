//! The simulator is repeatable, its files can be read, and hands and spectra have the properties of
//! their surfaces.

use std::path::Path;

use htex_author::AuthorError;
use htex_author::simulate::{
    Departures, FreeMotion, Simulation, SimulationOptions, Surface, simulate,
};
use htex_author::{SetupResponse, SpectrumOptions, TextureSpectrum, segment_spectra};
use htex_recording::response_from_bytes;
use htex_recording::{ReadOptions, read_recording};

fn paper(surface: Surface) -> Simulation {
    simulate(&SimulationOptions::new(surface)).unwrap()
}

fn csv(simulation: &Simulation) -> Vec<u8> {
    let mut bytes = Vec::new();
    simulation.write_csv(&mut bytes).unwrap();
    bytes
}

/// FNV-1a hash of a whole file.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[test]
fn written_and_read_back_it_is_the_same_recording() {
    let simulation = paper(Surface::CoarseFabric);
    let bytes = csv(&simulation);
    assert!((10_500_000..11_500_000).contains(&bytes.len()), "{} bytes", bytes.len());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("coarse.csv");
    std::fs::write(&path, bytes).unwrap();
    let mut read = read_recording(Path::new(&path), &ReadOptions::default()).unwrap();
    assert!(read.simulated);
    // The recording that was read has its file's hash.
    assert!(std::mem::take(&mut read.file).blake3().is_some());
    assert_eq!(read, simulation.to_recording("coarse.csv").unwrap());
}

#[test]
fn same_options_give_the_same_bytes_everywhere() {
    let short = |seed| {
        let options =
            SimulationOptions::new(Surface::Sandpaper).with_seed(seed).with_duration_s(0.5);
        csv(&simulate(&options).unwrap())
    };
    assert_eq!(short(7), short(7));
    assert_ne!(short(7), short(8));
}

/// Hash of the rows of a short simulation. The first line of the file is left out because it
/// contains the version.
fn hash_of_rows(options: SimulationOptions) -> u64 {
    let bytes = csv(&simulate(&options.with_duration_s(0.5)).unwrap());
    let first_row = bytes.iter().position(|byte| *byte == b'\n').unwrap();
    hash(&bytes[first_row..])
}

/// Detects machines, compilers, and changes of filters or generators that give different results.
#[test]
fn simulations_are_bit_identical_everywhere() {
    let seven = |surface| SimulationOptions::new(surface).with_seed(7);
    let of_surfaces = Surface::ALL.map(|surface| hash_of_rows(seven(surface)));
    assert_eq!(
        of_surfaces,
        [
            0x75f2_fa7d_cfcc_8f48,
            0x752e_e377_4914_454a,
            0x3299_60d7_4f77_e814,
            0x2433_15ee_24a6_1977,
            0x0461_b28a_c539_2653
        ]
    );
    // Faster and harder; slower and lighter; and a sample rate that needs the anti-aliasing filter.
    let of_motions = [(20_000.0, 240.0, 2.5), (20_000.0, 3.0, 0.05), (2_000.0, 80.0, 0.4)].map(
        |(rate_hz, speed_mm_s, force_n)| {
            hash_of_rows(
                seven(Surface::Sandpaper)
                    .with_rate_hz(rate_hz)
                    .with_speed_mm_s(speed_mm_s)
                    .with_force_n(force_n),
            )
        },
    );
    assert_eq!(of_motions, [0x7582_9557_4748_7781, 0x59d5_ef30_9a60_fc85, 0x20ea_cb8b_6839_e74b]);
}

/// The rig's response at a sample rate that needs the anti-aliasing filter.
#[test]
fn the_setup_response_is_bit_identical_everywhere() {
    let options = SimulationOptions::new(Surface::Vinyl).with_rate_hz(2_000.0);
    let response = options.setup_response().unwrap();
    let numbers = response.magnitude.iter().chain(&response.phase_rad);
    let bytes: Vec<u8> = numbers.flat_map(|x| x.to_bits().to_le_bytes()).collect();
    assert_eq!(hash(&bytes), 0x7c06_18d6_a273_20e4);
}

#[test]
fn the_hand_keeps_within_the_papers_tolerance() {
    for surface in Surface::ALL {
        let simulation = paper(surface);
        let turns = simulation
            .fy_n
            .windows(2)
            .filter(|pair| pair[0] < 0.1 && pair[1] >= 0.1)
            .count()
            + simulation.fy_n.windows(2).filter(|pair| pair[0] > -0.1 && pair[1] <= -0.1).count();
        assert!((8..=9).contains(&turns), "{surface}: {turns} sweeps");
        assert!(simulation.fz_n.iter().all(|force| (force / 0.4 - 1.0).abs() < 0.1), "{surface}");
        assert!(simulation.y_mm.iter().chain(&simulation.x_mm).all(|place| place.abs() < 50.0));
        let speeds = simulation.to_recording("").unwrap().speed_mm_s.unwrap();
        let sliding: Vec<f64> = speeds.into_iter().filter(|speed| *speed > 60.0).collect();
        let mean = sliding.iter().sum::<f64>() / sliding.len() as f64;
        assert!((mean - 80.0).abs() < 4.0, "{surface}: {mean} mm/s");
    }
}

/// Amplitude of the lateral force at a frequency, measured in the middle of each sweep (Goertzel).
fn amplitude_n(simulation: &Simulation, frequency_hz: f64) -> f64 {
    let n = 4000;
    let mut sum = 0.0;
    let mut count = 0.0;
    for start in (0..simulation.y_mm.len() - n).step_by(n / 2) {
        let end = start + n;
        let middle = simulation.y_mm[start].abs().max(simulation.y_mm[end].abs()) < 30.0;
        if !middle {
            continue;
        }
        let (mut re, mut im) = (0.0, 0.0);
        for (k, force) in simulation.fy_n[start..end].iter().enumerate() {
            let window = 1.0 - (std::f64::consts::TAU * k as f64 / n as f64).cos();
            let angle = std::f64::consts::TAU * frequency_hz * k as f64 / simulation.rate_hz;
            re += window * force * angle.cos();
            im += window * force * angle.sin();
        }
        sum += (re * re + im * im) * 4.0 / (n * n) as f64;
        count += 1.0;
    }
    (sum / count).sqrt()
}

/// RMS amplitude over a band, newtons.
fn band_n(simulation: &Simulation, from_hz: usize, to_hz: usize) -> f64 {
    let power = |hz| amplitude_n(simulation, f64::from(hz as u32)).powi(2);
    (from_hz..to_hz).step_by(20).map(power).sum::<f64>().sqrt()
}

#[test]
fn spectra_lie_as_in_the_paper() {
    let [sandpaper, fine, coarse, corrugated, vinyl] = Surface::ALL.map(|surface| {
        let simulation = paper(surface);
        (band_n(&simulation, 20, 200), band_n(&simulation, 300, 600))
    });
    let level = |(low, high): (f64, f64)| low.hypot(high);
    for weak in [fine, coarse, vinyl] {
        assert!(level(weak) < 0.6 * level(sandpaper) && level(weak) < 0.6 * level(corrugated));
    }
    for (low, high) in [coarse, corrugated, vinyl] {
        assert!(low > 4.0 * high, "mostly low: {low} against {high} N");
    }
    for (low, high) in [sandpaper, fine] {
        assert!(high > 0.4 * low, "broad: {low} against {high} N");
    }
}

#[test]
fn texture_follows_speed_and_force() {
    let paper_conditions = SimulationOptions::new(Surface::CorrugatedPaper);
    let slow = simulate(&paper_conditions.clone().with_speed_mm_s(40.0)).unwrap();
    let light = simulate(&paper_conditions.clone().with_force_n(0.2)).unwrap();
    let normal = simulate(&paper_conditions).unwrap();
    // Flutes 2 mm apart.
    assert!(amplitude_n(&normal, 40.0) > 3.0 * amplitude_n(&normal, 20.0));
    assert!(amplitude_n(&slow, 20.0) > 3.0 * amplitude_n(&slow, 30.0));
    let ratio = amplitude_n(&normal, 40.0) / amplitude_n(&light, 40.0);
    assert!((1.6..2.4).contains(&ratio), "{ratio}");
}

#[test]
fn low_rates_are_not_aliased() {
    let options = SimulationOptions::new(Surface::CorrugatedPaper).with_rate_hz(1000.0);
    let simulation = simulate(&options).unwrap();
    assert_eq!(simulation.t_s.len(), 10_000);
    assert!(simulation.to_recording("low").is_ok());
    let rms = |range: std::ops::Range<usize>| {
        let still = &simulation.fy_n[range];
        (still.iter().map(|x| x * x).sum::<f64>() / still.len() as f64).sqrt()
    };
    assert!(rms(0..40) < 1e-3, "at rest there is only noise");
}

#[test]
fn options_out_of_range_are_refused_and_names_go_round() {
    let good = SimulationOptions::new(Surface::Vinyl);
    for bad in [
        good.clone().with_rate_hz(f64::NAN),
        good.clone().with_rate_hz(0.0),
        good.clone().with_duration_s(f64::INFINITY),
        good.clone().with_speed_mm_s(-80.0),
        good.clone().with_force_n(0.0),
        good.with_rate_hz(200_000.0).with_duration_s(600.0),
    ] {
        assert!(simulate(&bad).is_err(), "{bad:?}");
    }
    for surface in Surface::ALL {
        assert_eq!(surface.to_string().parse().ok(), Some(surface));
    }
    assert!("velvet".parse::<Surface>().unwrap_err().to_string().contains("fine-fabric"));
}

#[test]
fn dividing_by_the_rigs_response_gives_the_force_at_the_finger() {
    let options = SimulationOptions::new(Surface::Sandpaper);
    let response = options.setup_response().unwrap();
    let written = {
        let mut bytes = Vec::new();
        response.write_csv(&mut bytes).unwrap();
        response_from_bytes("rig.csv", &bytes).unwrap()
    };
    assert_eq!(written.frequency_hz, response.frequency_hz);
    assert_eq!(written.magnitude, response.magnitude);
    let recording = simulate(&options).unwrap().to_recording("rec").unwrap();
    let spectrum = |response: Option<SetupResponse>| {
        let options = SpectrumOptions::default().with_response(response);
        let part = segment_spectra(&recording, &options).unwrap();
        assert_eq!(part.warnings, [""; 0]);
        TextureSpectrum::average(&[part], options.averaging).unwrap()
    };
    let (raw, at_finger) = (spectrum(None), spectrum(Some(written)));
    // The spectrum of sandpaper falls smoothly from 500 to 740 Hz, but the rig's resonance does
    // not.
    let step_db = |s: &TextureSpectrum| {
        let level = |low: f64, high: f64| {
            let bins = s.frequency_hz.iter().zip(&s.magnitude);
            let inside: Vec<f64> =
                bins.filter(|(f, _)| (low..high).contains(*f)).map(|(_, m)| m * m).collect();
            10.0 * (inside.iter().sum::<f64>() / inside.len() as f64).log10()
        };
        level(590.0, 650.0) - level(680.0, 740.0)
    };
    let (raw_db, finger_db) = (step_db(&raw), step_db(&at_finger));
    println!("590-650 over 680-740 Hz: {raw_db:.1} dB recorded, {finger_db:.1} dB at the finger");
    assert!(raw_db > 9.0 && finger_db < 5.0, "{raw_db} {finger_db}");
}

fn free(surface: Surface) -> SimulationOptions {
    SimulationOptions::new(surface).with_free_motion(FreeMotion::default())
}

#[test]
fn free_motion_fills_its_ranges_and_turns() {
    let options = free(Surface::Vinyl).with_duration_s(30.0).with_rate_hz(1000.0);
    let simulation = simulate(&options).unwrap();
    assert_eq!(simulation, simulate(&options).unwrap());
    assert_ne!(simulation.y_mm, simulate(&options.clone().with_seed(2)).unwrap().y_mm);
    // The anti-aliasing filter starts from 0.
    let mut forces = simulation.fz_n.iter().skip(20);
    assert!(forces.all(|force| (0.14..3.9).contains(force)));
    assert!(simulation.y_mm.iter().all(|place| place.abs() < 149.0));
    let speeds = simulation.to_recording("free").unwrap().speed_mm_s.unwrap();
    assert!(speeds.iter().all(|speed| *speed < 285.0));
    let part = |values: &[f64], low: f64, high: f64| {
        let inside = values.iter().filter(|x| (low..high).contains(*x)).count();
        inside as f64 / values.len() as f64
    };
    // The ranges are cut into thirds of their logarithms.
    for (values, edges) in
        [(&speeds, [36.0, 71.4, 141.4, 280.0]), (&simulation.fz_n, [0.15, 0.441, 1.293, 3.8])]
    {
        for pair in edges.windows(2) {
            let part = part(values, pair[0], pair[1]);
            assert!((0.15..0.55).contains(&part), "{part} in {pair:?}");
        }
    }
    // A place every 0.1 s, since near a turn the position is constant to its four decimals.
    let places: Vec<f64> = simulation.y_mm.iter().step_by(100).copied().collect();
    let turns = places.windows(3).filter(|y| (y[1] - y[0]) * (y[2] - y[1]) < 0.0).count();
    assert!(turns > 15, "{turns} turns");
}

/// RMS of the force along the strokes above 20 Hz, newtons: the difference to the mean of the 50 ms
/// around it. Only stretches at full speed count.
fn texture_n(simulation: &Simulation, from_s: f64, to_s: f64) -> f64 {
    let [from, to] = [from_s, to_s].map(|s| (s * simulation.rate_hz) as usize);
    let around = (0.05 * simulation.rate_hz) as usize;
    let full_mm = 0.95 * 80.0 * 0.05;
    let squares = (from..to - around).filter_map(|start| {
        let moved = simulation.y_mm[start + around] - simulation.y_mm[start];
        let part = &simulation.fy_n[start..start + around];
        let mean = part.iter().sum::<f64>() / part.len() as f64;
        (moved.abs() > full_mm).then(|| (part[around / 2] - mean).powi(2))
    });
    let squares: Vec<f64> = squares.collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// A drifting texture fades, a finger lifts for the requested fraction of the time, and the file
/// says what departs.
#[test]
fn hands_drift_and_lift() {
    let steady = FreeMotion::default().with_speed_mm_s([80.0; 2]).with_force_n([0.4; 2]);
    let with = |departures: Departures| {
        let options = SimulationOptions::new(Surface::Sandpaper)
            .with_free_motion(steady)
            .with_rate_hz(4_000.0)
            .with_duration_s(60.0)
            .with_departures(departures);
        (simulate(&options).unwrap(), options)
    };
    let (plain, _) = with(Departures::default());
    let (fading, options) = with(Departures::default().with_drift_db_per_min(-12.0));
    let lost_db = |from_s: f64, to_s: f64| {
        20.0 * (texture_n(&fading, from_s, to_s) / texture_n(&plain, from_s, to_s)).log10()
    };
    // The drift at the middles of the first and the last 20 s.
    let [early, late] = [lost_db(0.0, 20.0), lost_db(40.0, 60.0)];
    println!("{early:.1} and {late:.1} dB");
    assert!((early + 2.0).abs() < 0.7 && (late + 10.0).abs() < 0.7, "{early} {late}");
    assert!(matches!(options.truth(), Err(AuthorError::UnsteadyTruth)));

    let (lifting, _) = with(Departures::default().with_lifted(0.3));
    let off = lifting.fz_n.iter().filter(|force| **force < 0.02).count();
    let part = off as f64 / lifting.fz_n.len() as f64;
    assert!((0.22..0.36).contains(&part), "{part}");
    let first_line = String::from_utf8(csv(&lifting)[..200].to_vec()).unwrap();
    assert!(first_line.contains(", lifted 0.3 of the time, 4000 Hz"), "{first_line}");
}

/// The frequencies of sweeps over one piece stay the same if the surface says so.
#[test]
fn frequencies_of_sweeps_follow_the_speed_by_the_exponent() {
    let line_hz = |speed: f64, exponent: f64| {
        let departures = Departures::default().with_frequency_speed(exponent);
        let options = SimulationOptions::new(Surface::CorrugatedPaper)
            .with_speed_mm_s(speed)
            .with_departures(departures);
        let simulation = simulate(&options).unwrap();
        let at = |hz: &i32| amplitude_n(&simulation, f64::from(*hz));
        let strongest = (30..200).max_by(|a, b| at(a).total_cmp(&at(b))).unwrap();
        f64::from(strongest)
    };
    let usual = line_hz(80.0, 1.0);
    assert!((line_hz(120.0, 1.0) / usual - 1.5).abs() < 0.1);
    assert!((line_hz(120.0, 0.0) / usual - 1.0).abs() < 0.1);
    assert!((line_hz(40.0, 0.0) / usual - 1.0).abs() < 0.1);
}
