//! Recorded loops, read again as recordings.

use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{
    AuthorError, Exploration, RecordedLoop, Recording, SegmentChoice, SpectrumOptions, Take,
    TextureSpectrum, agreement, segment_spectra,
};
use htex_format::Measure;

const RATE_HZ: f64 = 48_000.0;

fn take(surface: Surface) -> Take {
    let simulation = simulate(&SimulationOptions::new(surface)).unwrap();
    Take { recording: simulation.to_recording("surface").unwrap(), given: Exploration::default() }
}

fn spectrum(recording: &Recording, options: &SpectrumOptions) -> TextureSpectrum {
    let part = segment_spectra(recording, options).unwrap();
    TextureSpectrum::average(&[part], options.averaging).unwrap()
}

/// Largest nine-band errors in dB. The first is for windows, which share their signal with their
/// neighbours. The second is for the eight segments of four sweeps. Every second segment fades into
/// another stretch, and a window across the seam reads both stretches at once.
const WITHIN_DB: [f64; 2] = [0.5, 0.6];

/// Two turns of a loop have the spectrum and the level of its recording, whether it is cut into
/// windows or sweeps.
#[test]
fn a_loop_has_the_spectrum_of_its_recording() {
    for surface in [Surface::Vinyl, Surface::Sandpaper, Surface::CorrugatedPaper] {
        let choices = [SegmentChoice::Windows, SegmentChoice::Auto];
        for (choice, within_db) in choices.into_iter().zip(WITHIN_DB) {
            let options = SpectrumOptions::default().with_segments(choice);
            let take = take(surface);
            let made = RecordedLoop::new(&take, &options, false, RATE_HZ).unwrap();
            let twice = made.samples.repeat(2);
            let again = Recording::new("loop", RATE_HZ, vec![twice]).unwrap();
            let windows = SpectrumOptions::default().with_segments(SegmentChoice::Windows);
            let (first, second) = (spectrum(&take.recording, &options), spectrum(&again, &windows));
            let found = agreement(first.as_ref(), &second.magnitude);
            let error_db = found.get(Measure::NineBand).unwrap();
            println!("{surface} {choice:?}: {error_db:.3} dB, {} segments", made.segments);
            assert!(error_db < within_db, "{surface} {choice:?}: {error_db} dB");
        }
    }
}

/// The loop has the recording's own samples: a sinusoid stays a sinusoid through all segments, and
/// there is no step at the seam.
#[test]
fn a_loop_is_the_recorded_signal() {
    let hertz = 150.0;
    let sample = |i: usize| 0.2 * (std::f64::consts::TAU * hertz * i as f64 / 8000.0).sin();
    let samples: Vec<f64> = (0..24_000).map(sample).collect();
    let take = Take {
        recording: Recording::new("tone", 8000.0, vec![samples.clone()]).unwrap(),
        given: Exploration::default(),
    };
    let options = SpectrumOptions::default().with_segments(SegmentChoice::Windows);
    let made = RecordedLoop::new(&take, &options, false, 8000.0).unwrap();
    assert_eq!(made.samples.len(), made.segments * 800);
    // Only between the first half segment and the seam. The level comes from the spectrum and
    // agrees to within the same error.
    let inside = made.samples.iter().zip(&samples).skip(800);
    let worst = inside.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 0.004, "{worst}");
    let step = |i: usize| (made.samples[(i + 1) % made.samples.len()] - made.samples[i]).abs();
    let largest = (800..made.samples.len() - 1).map(step).fold(0.0, f64::max);
    assert!(step(made.samples.len() - 1) < 1.5 * largest);
}

#[test]
fn rates_that_do_not_fit_are_refused() {
    let take = take(Surface::Vinyl);
    for rate_hz in [0.0, -10.0, 2000.0, 8005.0, 1e6, f64::NAN] {
        let made = RecordedLoop::new(&take, &SpectrumOptions::default(), false, rate_hz);
        assert!(matches!(made, Err(AuthorError::LoopRate { .. })), "{rate_hz}");
    }
}
