//! Choice of the segments of a recording.

use crate::common::recordings::noise;

use htex_author::recording::Recording;
use htex_author::simulate::{SimulationOptions, Surface, simulate};
use htex_author::{
    AuthorError, Exploration, SegmentChoice, SegmentedTake, SpectrumOptions, Take, choose_segments,
    segment_take,
};

const RATE_HZ: f64 = 1000.0;

/// Friction with texture at 1 kHz, in sweeps given by their start and end in seconds.
fn friction(seconds: f64, sweeps: &[(f64, f64)]) -> Vec<f64> {
    let force = |at: usize| {
        let t = at as f64 / RATE_HZ;
        let slides = sweeps.iter().any(|(from, to)| (*from..*to).contains(&t));
        f64::from(u8::from(slides)) * (0.2 + 0.02 * noise(at)) + 1e-4 * noise(at + 7)
    };
    (0..(seconds * RATE_HZ) as usize).map(force).collect()
}

fn read(recording: &Recording, given: Exploration) -> Result<SegmentedTake, AuthorError> {
    let take = Take { recording: recording.clone(), given };
    segment_take(&take, &SpectrumOptions::default(), false)
}

#[test]
fn a_sweep_that_the_end_cuts_off_is_left_out() {
    // In the middle of the recorded part the finger stops, at 25 mm/s instead of 80.
    let options = SimulationOptions::new(Surface::CorrugatedPaper);
    let recording = simulate(&options).unwrap().to_recording("paper").unwrap();
    let reading = read(&recording, Exploration::default()).unwrap();
    let segments = &reading.spectra.segments;
    assert_eq!((segments.sweeps.len(), segments.cut_off), (9, 1));
    assert_eq!(segments.sweeps[8].end, recording.samples());
    assert_eq!(segments.starts.len(), 8);
    let [slowest, fastest] = reading.spread.speed_mm_s.unwrap();
    assert!(slowest > 72.0 && fastest < 88.0, "{slowest} {fastest}");
    let codes: Vec<&str> = reading.findings.iter().map(|f| f.code.as_str()).collect();
    assert_eq!(codes, ["RECORDING_SWEEPS_CUT_OFF"]);
    assert!(reading.notes[0].contains("1 of 9 sweeps left out"), "{:?}", reading.notes);
    // The same, cut at the beginning.
    let cut = recording.between(Some(0.6), None).unwrap();
    assert_eq!(choose_segments(&cut, SegmentChoice::Sweeps).cut_off, 2);
}

#[test]
fn with_a_target_a_segment_counts_within_ten_percent_and_without_one_always() {
    let sweeps: Vec<(f64, f64)> =
        (0..6).map(|n| (1.3 * f64::from(n) + 0.2, 1.3 * f64::from(n) + 1.2)).collect();
    let lateral = friction(8.0, &sweeps);
    // The first sweep is at 65 mm/s, the second at 80 except for a moment at 95, the others at 80.
    let speed = |at: usize| match at {
        0..1300 => 65.0,
        1950..2050 => 95.0,
        _ => 80.0,
    };
    let speed: Vec<f64> = (0..lateral.len()).map(speed).collect();
    let recording = Recording::new("r", RATE_HZ, vec![lateral]).unwrap().with_speed(speed).unwrap();
    let at = |speed_mm_s| Exploration { speed_mm_s, force_n: Some(0.4) };
    let near = read(&recording, at(Some(81.0))).unwrap();
    assert_eq!(near.spectra.spectra.len(), 4);
    assert_eq!(near.spectra.segments.off_target.len(), 2);
    assert_eq!(near.findings[0].code, "RECORDING_OFF_TARGET");
    assert!(near.warnings[1].contains("2 of 6 segments left out"), "{:?}", near.warnings);
    assert_eq!(near.motion.speed_mm_s, Some(81.0));
    let all = read(&recording, at(None)).unwrap();
    assert_eq!(all.spectra.spectra.len(), 6);
    assert_eq!(all.motion.speed_mm_s, Some(80.0));
    assert_eq!(all.spread.speed_mm_s, Some([65.0, 95.0]));
    assert_eq!(all.findings[0].code, "RECORDING_UNSTEADY");
    let none = read(&recording, at(Some(200.0))).unwrap_err().to_string();
    assert!(none.contains("all 6 segments") && none.contains("10 %"), "{none}");
}

#[test]
fn a_long_stroke_is_read_all_along_and_sweeps_in_their_middles() {
    let read_in = |sweeps: &[(f64, f64)]| {
        let recording = Recording::new("r", RATE_HZ, vec![friction(9.0, sweeps)]).unwrap();
        choose_segments(&recording, SegmentChoice::Auto)
    };
    let stroke = read_in(&[(0.3, 8.7)]);
    assert!(!stroke.from_sweeps && stroke.starts.len() == 89);
    let unread = stroke.unread.unwrap();
    assert!((unread.represented_s - 2.0).abs() < 0.01 && (unread.sliding_s - 8.4).abs() < 0.1);
    // Two complete sweeps of a second each, next to a long one that is cut off.
    assert!(!read_in(&[(0.3, 1.3), (1.6, 2.6), (3.0, 9.0)]).from_sweeps);
    let three = read_in(&[(0.3, 1.8), (2.3, 5.3), (5.7, 8.0)]);
    assert!(three.from_sweeps && three.starts.len() == 3 && three.unread.is_none());
}

#[test]
fn readings_that_no_finger_makes_do_not_move_the_condition() {
    let lateral = friction(3.0, &[(0.2, 1.2), (1.5, 2.5)]);
    let mut normal: Vec<f64> = (0..lateral.len()).map(|at| 1.0 + 0.02 * noise(at)).collect();
    normal[700] = 36_870.0;
    let recording =
        Recording::new("r", RATE_HZ, vec![lateral]).unwrap().with_normal(normal).unwrap();
    let reading = read(&recording, Exploration::default()).unwrap();
    let force_n = reading.motion.force_n.unwrap();
    assert!((force_n - 1.0).abs() < 0.01, "{force_n}");
    let outlier = reading.findings.iter().find(|f| f.code == "RECORDING_FORCE_OUTLIER").unwrap();
    assert!(outlier.message.contains("36870.0000 N at 0.7000 s"), "{outlier}");
    assert_eq!(outlier.pointer, "/normal/700");
}
