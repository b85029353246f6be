//! Hours of voices: steady power, finite samples, no repetition. Checks the same bounds as the
//! example `long_runs`, for a length that fits here.

use htex_hard_cases::long::{Blocks, drift_db, phase_error_cycles, run};
use htex_hard_cases::seen::models;

/// An hour in parts of ten minutes. Ten minutes of noise with 1 kHz bandwidth contain 1.2 million
/// independent values, so the standard error of a part is 0.0056 dB. Shapes with narrow bands
/// contain a fraction of these values.
#[test]
fn an_hour_is_steady() {
    for model in models() {
        let run = run(&model, 1, 3_600.0, 600.0, None);
        let drift = drift_db(&run.power);
        let off = 10.0 * (run.power.iter().sum::<f64>() / run.power.len() as f64).log10();
        println!(
            "{:8} {} samples at {} Hz: drift {drift:.4} dB, level {off:+.4} dB, broken {}",
            model.short_name(),
            run.samples,
            run.rate_hz,
            run.broken
        );
        assert_eq!(run.power.len(), 6);
        assert_eq!(run.broken, 0, "{}", model.short_name());
        assert!(drift < 0.1, "{}: {drift} dB", model.short_name());
        // Above 0 by the power that the band's bins miss at its edges. A map's lines next to the
        // edges are weaker because of the filters.
        assert!((-0.1..0.15).contains(&off), "{}: {off} dB", model.short_name());
    }
}

/// Six minutes with four seeds contain no two equal blocks of 64 samples. Lines repeat: sPeak's
/// lines lie on a 5 Hz grid, and a map is crossed again.
#[test]
fn seeds_never_repeat_a_block() {
    for model in models().iter().filter(|m| !m.has_lines()) {
        let mut blocks = Blocks::new();
        let mut samples = 0;
        for seed in [0, 1, 2, u64::MAX] {
            let run = run(model, seed, 360.0, 360.0, Some(&mut blocks));
            assert_eq!(run.repeated, 0, "{}, seed {seed}", model.short_name());
            samples += run.samples;
        }
        assert!(blocks.len() as u64 >= samples / 65);
    }
}

/// Frequencies that are not a binary fraction of the rate, after 20 million samples: a day at 230
/// Hz, and one step of the way to a day at 20 kHz.
#[test]
fn phases_do_not_drift() {
    for (frequency_hz, rate_hz) in [(317.3, 2_000.0), (0.1 + 20.0, 20_000.0), (999.9, 44_100.0)] {
        let off = phase_error_cycles(frequency_hz, rate_hz, 20_000_000);
        println!("{frequency_hz} Hz at {rate_hz} Hz: {off:.2e} cycles");
        assert!(off < 1e-7, "{frequency_hz} Hz: {off} cycles");
    }
}
