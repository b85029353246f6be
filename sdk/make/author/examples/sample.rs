//! Writes a texture report with invented data to the given path.
//!
//! `cargo run -p htex-author --example sample -- report.html`

use htex_author::report::{
    Measure, ModelResult, Texture, TextureReport, model_color, texture_report,
};

/// Name, peak frequency (hertz), width (natural log units), height (newtons).
const TEXTURES: [(&str, f64, f64, f64); 5] = [
    ("Vinyl", 60.0, 0.9, 0.0021),
    ("Denim", 130.0, 0.5, 0.0124),
    ("Sandpaper, P80 (coarse)", 240.0, 0.8, 0.0262),
    ("Oak", 90.0, 1.1, 0.0048),
    ("Ribbed silicone", 180.0, 0.25, 0.0410),
];

fn main() -> std::io::Result<()> {
    let path = std::env::args().nth(1).unwrap_or_else(|| "report.html".to_owned());
    std::fs::write(path, texture_report(&report()))
}

/// Caption, whether the measure is a correlation, and whether an error is compared with the
/// repeatability.
const MEASURES: [(&str, bool, bool); 4] = [
    ("Spectral correlation with the recording (1 is the best, dark)", true, false),
    ("Nine-band error of the fitted magnitude, RMS in dB (0 is the best, light)", false, true),
    ("Nine-band error of the rendered samples, RMS in dB (0 is the best, light)", false, true),
    ("Third-octave error of the fitted magnitude, RMS in dB (0 is the best, light)", false, false),
];

fn measure((caption, is_correlation, repeats): (&str, bool, bool)) -> Measure {
    Measure { caption: caption.to_owned(), is_correlation, repeats }
}

fn report() -> TextureReport {
    TextureReport {
        title: "Sample report: five invented textures".to_owned(),
        intro: vec![
            "Every number on this page is invented, to show what a report looks like.".to_owned(),
        ],
        measures: MEASURES.map(measure).to_vec(),
        textures: (0..TEXTURES.len()).map(texture).collect(),
        shares: Vec::new(),
        pictures: Vec::new(),
        command: "cargo run -p htex-author --example sample -- report.html".to_owned(),
    }
}

fn texture(index: usize) -> Texture {
    let (name, peak_hz, width, height_n) = TEXTURES[index];
    let frequency_hz: Vec<f64> = (4..=200).map(|bin| 5.0 * f64::from(bin)).collect();
    let envelope =
        |f: f64| height_n * (-((f / peak_hz).ln() / width).powi(2) / 2.0).exp() + 0.04 * height_n;
    let ripple = |f: f64| 1.0 + 0.35 * (f * 0.71 + index as f64).sin() * (f * 0.113).cos();
    let recorded: Vec<f64> = frequency_hz.iter().map(|f| envelope(*f) * ripple(*f)).collect();
    let model = |spec: &Spec| model(spec, &frequency_hz, &recorded, envelope, peak_hz, index);
    Texture {
        name: name.to_owned(),
        simulated: true,
        unit: "N".to_owned(),
        condition: "80 mm/s, 0.40 N".to_owned(),
        law: "contact: finger; outside the recorded motions: frequency over speed ^1.00 (assumed)"
            .to_owned(),
        fluctuation: "fluctuation in time: 3.00 dB at 0.5 to 8 Hz and 1.53 dB at 8 to 32 Hz"
            .to_owned(),
        recording_bytes: 1_600_044 + 40_000 * index as u64,
        asset_bytes: 2_810 + 7 * index as u64,
        repeatability_rms_db: (index != 3).then_some(1.1 + 0.2 * index as f64),
        models: SPECS.iter().map(model).collect(),
        warnings: match index {
            0 => vec!["the level is 6 dB above the sensor's noise".to_owned()],
            _ => Vec::new(),
        },
        frequency_hz,
        recorded,
    }
}

/// Name, sharpness relative to the envelope, correlation, error (dB), bytes.
struct Spec(&'static str, f64, f64, f64, usize);

const SPECS: [Spec; 5] = [
    Spec("AR", 1.15, 0.94, 0.9, 56),
    Spec("MFCC", 0.9, 0.68, 1.9, 80),
    Spec("sPeak", 1.0, 0.75, 8.4, 160),
    Spec("sBeta", 0.75, 0.71, 3.2, 16),
    Spec("sSlope", 0.5, 0.42, 5.9, 24),
];

fn model(
    spec: &Spec,
    frequency_hz: &[f64],
    recorded: &[f64],
    envelope: impl Fn(f64) -> f64,
    peak_hz: f64,
    index: usize,
) -> ModelResult {
    let Spec(name, sharpness, correlation, error_db, bytes) = *spec;
    let top = envelope(peak_hz);
    let shape = |f: &f64| top * (envelope(*f) / top).powf(sharpness);
    let band_error = |band: i32| error_db * (f64::from(band) * 1.7 + index as f64).sin() * 1.4;
    ModelResult {
        model: name.to_owned(),
        color: model_color(name, &SPECS.map(|spec| spec.0)).to_owned(),
        short_name: name.to_ascii_lowercase(),
        magnitude: frequency_hz.iter().map(shape).collect(),
        measured: vec![
            Some(correlation - 0.03 * index as f64),
            Some(error_db),
            Some(error_db + 0.2),
            Some(1.4 * error_db),
        ],
        note: format!("error {error_db:.1} dB RMS"),
        band_error_db: (0..9).map(band_error).collect(),
        payload_bytes: bytes,
        lines: (name == "sPeak").then(|| strongest(frequency_hz, recorded)),
    }
}

/// Up to ten local maxima, each as (hertz, newtons).
fn strongest(frequency_hz: &[f64], recorded: &[f64]) -> Vec<(f64, f64)> {
    let inner = 1..recorded.len() - 1;
    let is_peak = |i: &usize| recorded[*i] > recorded[*i - 1] && recorded[*i] > recorded[*i + 1];
    let mut peaks: Vec<_> = inner.filter(is_peak).map(|i| (frequency_hz[i], recorded[i])).collect();
    peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
    peaks.truncate(10);
    peaks
}
