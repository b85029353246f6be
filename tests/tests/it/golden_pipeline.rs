//! The recording pipeline against the closed-form recording of the golden vectors.

use htex_author::{
    Averaging, Recording, SegmentChoice, SetupResponse, SpectrumOptions, TextureSpectrum,
    choose_segments, segment_spectra,
};
use htex_dsp::spectrum::Complex;
use htex_tests::Golden;

const RATE_HZ: f64 = 20_000.0;

/// Back-and-forth sweeps with four sinusoids, by the case's formula.
fn closed_form() -> Recording {
    let lines = [(50.0, 0.01, 0.3), (137.5, 0.006, 1.1), (400.0, 0.004, 2.0), (905.0, 0.002, 0.7)];
    let raised_cosine = |t: f64| 0.5 * (1.0 - (std::f64::consts::PI * t).cos());
    let force = |n: usize| {
        let tau = n % 25_000;
        let sign = if (n / 25_000).is_multiple_of(2) { 1.0 } else { -1.0 };
        let envelope = match tau {
            0..2_000 => raised_cosine(tau as f64 / 2_000.0),
            2_000..21_000 => 1.0,
            21_000..23_000 => raised_cosine(1.0 - (tau - 21_000) as f64 / 2_000.0),
            _ => 0.0,
        };
        let t = n as f64 / RATE_HZ;
        let texture: f64 =
            lines.iter().map(|(f, a, p)| a * (std::f64::consts::TAU * f * t + p).cos()).sum();
        sign * 0.2 * envelope + envelope * texture
    };
    let all: Vec<f64> = (0..200_000).map(force).collect();
    let axis = |part: f64| all.iter().map(|f| part * f).collect();
    Recording::new("closed form", RATE_HZ, vec![axis(0.05), axis(0.998_749_217_771_909)]).unwrap()
}

/// Response of a force sensor's mount as a damped resonator, `1 / (1 - (f/f₀)² + 2 i ζ f/f₀)`.
fn resonator_response(f_hz: f64, resonance_hz: f64, damping_ratio: f64) -> Complex<f64> {
    let r = f_hz / resonance_hz;
    Complex::new(1.0, 0.0) / Complex::new(1.0 - r * r, 2.0 * damping_ratio * r)
}

/// The case's setup response, on a grid fine enough to be read back at the bins.
fn response() -> SetupResponse {
    let frequency_hz: Vec<f64> = (0..=200).map(|k| f64::from(k) * 5.0).collect();
    let values: Vec<_> = frequency_hz.iter().map(|&f| resonator_response(f, 620.0, 0.06)).collect();
    SetupResponse {
        magnitude: values.iter().map(|h| h.norm()).collect(),
        phase_rad: values.iter().map(|h| h.arg()).collect(),
        frequency_hz,
    }
}

#[test]
fn the_response_of_the_case_is_the_resonators() {
    let case = Golden::case("pipeline", "hrec");
    let [f0_hz, zeta] = ["f0_hz", "zeta"].map(|name| case.input(name)[0]);
    let frequencies = case.input("f_hz");
    let response = |f: &f64| resonator_response(*f, f0_hz, zeta);
    let got: Vec<_> = frequencies.iter().map(response).collect();
    case.hold("/re", &got.iter().map(|h| h.re).collect::<Vec<_>>());
    case.hold("/im", &got.iter().map(|h| h.im).collect::<Vec<_>>());
    case.hold("/abs", &got.iter().map(|h| h.norm()).collect::<Vec<_>>());
}

fn hold(name: &str, response: Option<SetupResponse>) {
    let case = Golden::case("pipeline", name);
    let recording = closed_form();
    let segments = choose_segments(&recording, SegmentChoice::Auto);
    assert!(segments.from_sweeps);
    assert_eq!(segments.sweeps.len() as f64, case.expected("/n_sweeps")[0]);
    case.hold("/threshold_n", &[segments.threshold]);
    let near = |got: Vec<usize>, pointer: &str| {
        for (got, expected) in got.iter().zip(case.expected(pointer)) {
            assert!((*got as f64 - expected).abs() <= 2.0, "{pointer}: {got} {expected}");
        }
    };
    near(segments.sweeps.iter().map(|s| s.start).collect(), "/starts");
    near(segments.sweeps.iter().map(|s| s.end).collect(), "/ends_exclusive");
    near(segments.starts.clone(), "/segment_starts");

    let options = SpectrumOptions::default().with_response(response);
    let part = segment_spectra(&recording, &options).unwrap();
    assert_eq!(part.warnings, [""; 0]);
    let spectrum = TextureSpectrum::average(&[part], Averaging::Magnitude).unwrap();
    assert_eq!(spectrum.magnitude.len(), 197);
    let at = |f: &f64| spectrum.magnitude[(f / 5.0) as usize - 4];
    let picked: Vec<f64> = case.expected("/mag_f_hz").iter().map(at).collect();
    case.hold("/mag_n", &picked);
    case.hold("/mag_sum", &[spectrum.magnitude.iter().sum()]);
    case.hold("/mag_sum_sq", &[spectrum.magnitude.iter().map(|m| m * m).sum()]);
}

#[test]
fn raw() {
    hold("closed_form_raw", None);
}

#[test]
fn compensated() {
    hold("closed_form_compensated", Some(response()));
}

#[test]
fn overlap_added_segments_keep_the_spectrum() {
    // Spectrum of the segments' signal at the lines, relative to the texture spectrum. Windowed
    // segments added with half overlap give the segments in step, up to their differing phases.
    let part = segment_spectra(&closed_form(), &SpectrumOptions::default()).unwrap();
    let spectrum = TextureSpectrum::average(&[part], Averaging::Magnitude).unwrap();
    let rms = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
    let lines = [0.01f64, 0.006, 0.004, 0.002];
    let expected = lines.iter().map(|a| a * a / 2.0).sum::<f64>().sqrt();
    // Windowed power is 3/8 of the whole, and two windows overlap: 0.87 of the RMS if phases
    // differ.
    let ratio = rms(&spectrum.signal) / expected;
    assert!((0.7..1.05).contains(&ratio), "{ratio}");
    assert_eq!(spectrum.signal_rate_hz, 4_000.0);
}
