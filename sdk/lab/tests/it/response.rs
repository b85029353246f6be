//! Responses of simulated setups: a resonance through noise, hits that must not be used, and what
//! cannot be measured.

use std::f64::consts::PI;

use crate::rig::{RATE_HZ, Rig, pulses};

use htex_author::recording::response_from_bytes;
use htex_dsp::noise::GaussianNoise;
use htex_lab::LabError;
use htex_lab::response::{
    Channel, Estimator, MeasuredResponse, Reason, Record, ResponseSettings, measure,
};

/// Adds normal noise with this power relative to the signal's power.
fn noisy(signal: &[f64], relative_db: f64, seed: u64) -> Vec<f64> {
    let power = signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64;
    let rms = (power * 10_f64.powf(relative_db / 10.0)).sqrt();
    let mut noise = GaussianNoise::new(seed);
    signal.iter().map(|x| x + rms * f64::from(noise.next_sample())).collect()
}

/// Returns the default settings with a change.
fn with(change: impl FnOnce(&mut ResponseSettings)) -> ResponseSettings {
    let mut settings = ResponseSettings::default();
    change(&mut settings);
    settings
}

/// Records ten hits of a rig, with noise 30 dB below the signal on both channels.
fn ten_hits(rig: &Rig, seed: u64) -> Record {
    let times: Vec<(f64, f64)> =
        (0..10).map(|i| (0.3 + 1.237 * f64::from(i), 12.0 + f64::from(i % 4))).collect();
    let input = pulses(13.0, &times);
    let output = rig.filter(&input);
    let input = noisy(&input, -30.0, seed);
    Record::new("hits.csv", RATE_HZ, input, noisy(&output, -30.0, seed + 1000)).unwrap()
}

/// The resonance is found within 0.1 dB and 1 Hz by every estimator, on the grid and between its
/// points, with separate hits and with hit windows.
#[test]
fn a_resonance_is_recovered_through_noise() {
    let (mut worst_db, mut worst_hz) = (0.0_f64, 0.0_f64);
    for (seed, frequency_hz) in [(1, 180.0), (2, 180.5), (3, 181.27)] {
        let rig = Rig::new(frequency_hz, 0.02);
        let (peak_hz, peak) = rig.peak();
        let record = ten_hits(&rig, seed);
        for estimator in [Estimator::H1, Estimator::H2, Estimator::Hv] {
            for force_window_s in [None, Some(0.005)] {
                let options =
                    ResponseSettings { estimator, force_window_s, ..ResponseSettings::default() };
                let measured = measure(std::slice::from_ref(&record), &options).unwrap();
                assert_eq!((measured.averages, measured.resolution_hz), (10, 1.0));
                let found = measured.peak.unwrap();
                worst_db = worst_db.max((found.magnitude_db - 20.0 * peak.log10()).abs());
                worst_hz = worst_hz.max((found.frequency_hz - peak_hz).abs());
            }
        }
    }
    println!("largest errors {worst_db:.4} dB, {worst_hz:.4} Hz");
    assert!(worst_db < 0.1 && worst_hz < 1.0, "{worst_db} dB, {worst_hz} Hz");
}

#[test]
fn without_noise_the_coherence_is_one_and_the_file_is_read_back() {
    let rig = Rig::new(180.0, 0.02);
    let input = pulses(4.0, &[(0.2, 10.0), (1.4, 12.0), (2.6, 9.0)]);
    let output = rig.filter(&input);
    let record = Record::new("clean.csv", RATE_HZ, input, output).unwrap();
    let measured = measure(&[record], &ResponseSettings::default()).unwrap();
    assert!(measured.coherence.iter().all(|c| (c - 1.0).abs() < 1e-9));
    assert!(measured.relative_error.iter().all(|e| *e < 1e-4));
    // The phase of a resonance turns by half a turn, and crosses -90 degrees at its frequency.
    let at_180 = measured.phase_rad[160];
    assert!((at_180 + PI / 2.0).abs() < 0.01, "{at_180}");
    let mut csv = Vec::new();
    measured.setup_response().write_csv(&mut csv).unwrap();
    let read = response_from_bytes("response.csv", &csv).unwrap();
    assert_eq!(
        (&read.frequency_hz, &read.magnitude),
        (&measured.frequency_hz, &measured.magnitude)
    );
    assert_eq!(read.phase_rad, measured.phase_rad);
}

#[test]
fn double_hits_and_overloads_are_thrown_out_with_their_time() {
    let rig = Rig::new(180.0, 0.02);
    let good = [(0.3, 10.0), (4.2, 9.0), (5.5, 11.0)];
    // A bounce 25 ms after the second hit, a third hit beyond the range of the converter, and a
    // last hit that is cut off.
    let all = [&good[..], &[(1.6, 10.0), (1.625, 2.0), (2.9, 30.0), (6.8, 10.0)]].concat();
    let input = pulses(7.5, &all);
    let output = noisy(&rig.filter(&input), -30.0, 7);
    let input: Vec<f64> = noisy(&input, -40.0, 8).iter().map(|x| x.min(15.0)).collect();
    let record = Record::new("hits.csv", RATE_HZ, input, output).unwrap();
    let measured = measure(std::slice::from_ref(&record), &ResponseSettings::default()).unwrap();
    let reasons: Vec<(f64, Option<&Reason>)> =
        measured.pieces.iter().map(|piece| (piece.time_s, piece.thrown_out.as_ref())).collect();
    assert_eq!(reasons.len(), 6, "{reasons:?}");
    let expected_s = [0.3, 1.6, 2.9, 4.2, 5.5, 6.8];
    assert!(reasons.iter().zip(expected_s).all(|((s, _), expected)| (s - expected).abs() < 0.002));
    assert_eq!([0, 3, 4].map(|at: usize| reasons[at].1), [None; 3]);
    let Some(Reason::DoubleHit { second_s }) = reasons[1].1 else { panic!("{reasons:?}") };
    assert!((second_s - 1.625).abs() < 0.002, "{second_s}");
    let Some(Reason::Overload { channel: Channel::Input, at_s, value }) = reasons[2].1 else {
        panic!("{reasons:?}")
    };
    assert!((at_s - 2.9).abs() < 0.002 && *value == 15.0, "{at_s}");
    assert!(matches!(reasons[5].1, Some(Reason::EndsEarly { .. })));
    assert_eq!(measured.averages, 3);

    // With a limit for the input, hits that reach it are also thrown out.
    let options = with(|settings| settings.input_limit = Some(10.5));
    let limited = measure(&[record], &options).unwrap();
    assert_eq!(limited.averages, 2);
    let reason = &limited.pieces[4].thrown_out;
    assert!(matches!(reason, Some(Reason::Overload { .. })), "{reason:?}");
}

/// White noise drives a gain of 3, with added noise of a quarter of the signal's power. According
/// to the formulas, H1 is too low by 1/1.25 with noise in the input, H2 is too high by 1.25 with
/// noise in the output, and Hv is right with both.
#[test]
fn estimators_are_biased_as_their_theory_says() {
    let mut drive = GaussianNoise::new(5);
    let clean: Vec<f64> = (0..400_000).map(|_| f64::from(drive.next_sample())).collect();
    let gained: Vec<f64> = clean.iter().map(|x| 3.0 * x).collect();
    let quarter = 10.0 * 0.25_f64.log10();
    let (rough_in, rough_out) = (noisy(&clean, quarter, 11), noisy(&gained, quarter, 12));
    let gain = |input: &Vec<f64>, output: &Vec<f64>, estimator| {
        let record = Record::new("drive.csv", RATE_HZ, input.clone(), output.clone()).unwrap();
        let options = with(|settings| {
            (settings.continuous, settings.estimator, settings.window_s) = (true, estimator, 0.2);
        });
        let measured: MeasuredResponse = measure(&[record], &options).unwrap();
        assert!(measured.pieces.iter().all(|piece| piece.thrown_out.is_none()));
        measured.magnitude.iter().sum::<f64>() / measured.magnitude.len() as f64
    };
    use Estimator::{H1, H2, Hv};
    for (input, output, estimator, expected) in [
        (&clean, &gained, H1, 3.0),
        (&clean, &rough_out, H1, 3.0),
        (&clean, &rough_out, H2, 3.75),
        (&rough_in, &gained, H1, 2.4),
        (&rough_in, &gained, H2, 3.0),
        (&rough_in, &rough_out, H1, 2.4),
        (&rough_in, &rough_out, Hv, 3.0),
        (&rough_in, &rough_out, H2, 3.75),
    ] {
        let found = gain(input, output, estimator);
        assert!((found / expected - 1.0).abs() < 0.01, "{estimator}: {found}, not {expected}");
    }
}

/// Multiplying both channels by the same exponential gives the response with its damping raised by
/// `1/τ`.
#[test]
fn an_exponential_window_raises_the_damping_by_its_inverse() {
    let rig = Rig::new(180.0, 0.002);
    // One file for each hit, so that no hit is still sounding when the next one comes.
    let record = |force: f64| {
        let input = pulses(1.5, &[(0.2, force)]);
        let output = rig.filter(&input);
        Record::new("long.csv", RATE_HZ, input, output).unwrap()
    };
    let records = [10.0, 12.0].map(record);
    let plain = measure(&records, &ResponseSettings::default()).unwrap();
    assert!(plain.warnings.iter().any(|w| w.contains("has not died out")), "{:?}", plain.warnings);
    let windowed = measure(&records, &with(|settings| settings.exponential_s = Some(0.1))).unwrap();
    let damping = 0.002 + 10.0 / (2.0 * PI * 180.0);
    let expected = 1.0 / (2.0 * damping * (1.0 - damping * damping).sqrt());
    let found = windowed.peak.unwrap().magnitude;
    assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    assert!(windowed.warnings.iter().any(|w| w.contains("10.0000 1/s")), "{:?}", windowed.warnings);
    assert!(!windowed.warnings.iter().any(|w| w.contains("has not died out")));
}

#[test]
fn what_cannot_be_measured_is_named() {
    let pulse = |hits: &[(f64, f64)]| pulses(3.0, hits);
    let record = |input: Vec<f64>| Record::new("a.csv", RATE_HZ, input.clone(), input);
    let fails = |input: Vec<f64>, options: ResponseSettings| {
        measure(&[record(input).unwrap()], &options).unwrap_err().to_string()
    };
    let default = ResponseSettings::default;

    let few = fails(pulse(&[(0.5, 10.0)]), default());
    assert!(few.starts_with("1 of 1 hits can be used, and coherence needs at least 2"), "{few}");
    let cut_off = fails(pulse(&[(0.5, 10.0), (2.5, 10.0)]), default());
    assert!(cut_off.contains("a.csv at 2.5001 s, cut off: the recording ends"), "{cut_off}");
    let mut noise = GaussianNoise::new(3);
    let noise = (0..30_000).map(|_| f64::from(noise.next_sample())).collect();
    let none = fails(noise, default());
    assert!(none.starts_with("a.csv: no hit found: the largest input is"), "{none}");
    let short = fails(pulse(&[(0.5, 10.0)]), with(|settings| settings.window_s = 5.0));
    assert!(short.starts_with("a.csv lasts 3.000 s, less than one window of 5 s"), "{short}");

    let constant = record(vec![0.5; 100]).unwrap_err().to_string();
    assert!(constant.starts_with("a.csv: the input is 0.5 at every sample"), "{constant}");
    let lengths = Record::new("a.csv", RATE_HZ, vec![0.0, 1.0], vec![0.0]).unwrap_err();
    assert!(matches!(lengths, LabError::Lengths { input: 2, output: 1, .. }));
    let missing = Record::new("a.csv", RATE_HZ, vec![0.0, 1.0], vec![0.0, f64::NAN]).unwrap_err();
    assert!(matches!(missing, LabError::Sample { channel: Channel::Output, sample: 1, .. }));
    let input = pulse(&[(0.5, 10.0), (1.7, 10.0)]);
    let two = [5_000.0, RATE_HZ]
        .map(|rate| Record::new("r.csv", rate, input.clone(), input.clone()).unwrap());
    assert!(matches!(measure(&two, &default()), Err(LabError::Rates { .. })));
    assert!(matches!(measure(&[], &default()), Err(LabError::NoRecord)));

    for options in [
        with(|settings| settings.window_s = f64::NAN),
        with(|settings| settings.window_s = 1e-4),
        with(|settings| settings.low_hz = -1.0),
        with(|settings| (settings.low_hz, settings.high_hz) = (6000.0, 7000.0)),
        with(|settings| settings.high_hz = 20.5),
        with(|settings| settings.input_limit = Some(0.0)),
        with(|settings| settings.trigger = Some(1.0)),
        with(|settings| settings.pre_trigger_s = Some(0.5)),
        with(|settings| settings.force_window_s = Some(f64::INFINITY)),
    ] {
        let result = measure(&two[1..], &options);
        assert!(matches!(result, Err(LabError::Option { .. })), "{options:?}: {result:?}");
    }
    let tiny: Vec<f64> = input.iter().map(|x| x * 1e-11).collect();
    let tiny = Record::new("t.csv", RATE_HZ, input, tiny).unwrap();
    assert!(matches!(measure(&[tiny], &default()), Err(LabError::Magnitude { .. })));
}
