//! Random parameters for each model, in ranges that cover its cases.

use htex_dsp::grid::Band;
use htex_dsp::line_spectrum::line_spectral_frequencies_of_reflection;
use htex_dsp::linear_prediction::reflection_to_coefficients;
use htex_dsp::uniform::Uniform;
use htex_host::{Field, Kind, Registry};

/// A model's flat array for one condition of an asset.
pub fn parameters(model: &str, band: Band, asset: usize, condition: usize) -> Vec<f64> {
    let seed = model.bytes().fold(7, |sum, byte| 31 * sum + u64::from(byte));
    let mut draw = Draw(Uniform::new(seed + (100 * asset + condition) as u64));
    match model {
        "ar" => ar(&mut draw, asset, condition),
        "arma" => arma(&mut draw, asset, condition),
        "mfcc" => mfcc(&mut draw, asset),
        "speak" => speak(&mut draw, asset, condition),
        "sbeta" => vec![draw.within(0.5, 8.0), draw.within(0.5, 8.0)],
        "sslope" => vec![draw.within(10.0, 1_200.0), draw.within(0.3, 4.0), draw.within(0.3, 4.0)],
        "bands" => bands(&mut draw, asset),
        "map" => map(&mut draw, band, asset, condition),
        other => usual(&mut draw, other),
    }
}

/// Numbers in the usual ranges of a model's fields; lists have five.
fn usual(draw: &mut Draw, model: &str) -> Vec<f64> {
    let registry = Registry::builtin();
    let number = |draw: &mut Draw, field: &Field| match field.usual {
        Some(usual) => draw.within(usual.min, usual.max),
        None => draw.within(field.min, field.max),
    };
    let mut flat = Vec::new();
    for field in &registry.find(model).unwrap().descriptor().fields {
        let count = match field.kind {
            Kind::Scalar => 1,
            Kind::List { max_len } => max_len.min(5),
        };
        if field.kind != Kind::Scalar {
            flat.push(f64::from(count));
        }
        flat.extend((0..count).map(|_| number(draw, field)));
    }
    flat
}

struct Draw(Uniform);

impl Draw {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.next_unit()
    }

    fn list(&mut self, count: usize, low: f64, high: f64) -> Vec<f64> {
        (0..count).map(|_| self.within(low, high)).collect()
    }
}

/// A list after its length.
fn list(values: &[f64]) -> Vec<f64> {
    [&[values.len() as f64], values].concat()
}

/// Orders 0 to 12, also different ones within an asset, at rates that reach above the band, up to
/// it, and not up to it.
fn ar(draw: &mut Draw, asset: usize, condition: usize) -> Vec<f64> {
    let order = [0, 2, 4, 6, 8][asset % 5] + 2 * (condition % 3);
    let rate_hz = [2_000.0, 2_000.0, 4_000.0, 1_000.0, 1_500.0][asset % 5];
    let reflection = draw.list(order, -0.8, 0.8);
    [list(&reflection_to_coefficients(&reflection)), vec![rate_hz]].concat()
}

/// Orders 0 to 12 of poles and 0 to 6 of zeros, also different ones within an asset.
fn arma(draw: &mut Draw, asset: usize, condition: usize) -> Vec<f64> {
    let poles = [0, 2, 4, 6, 8][asset % 5] + 2 * (condition % 3);
    let zeros = [0, 1, 3, 4, 2][asset % 5] + condition % 3;
    let rate_hz = [2_000.0, 2_000.0, 4_000.0, 1_000.0, 1_500.0][asset % 5];
    let mut lines = |count: usize| {
        let reflection = draw.list(count, -0.8, 0.8);
        line_spectral_frequencies_of_reflection(&reflection)
    };
    [list(&lines(poles)), list(&lines(zeros)), vec![rate_hz]].concat()
}

/// All four inverses; fewer coefficients than bands, and more.
fn mfcc(draw: &mut Draw, asset: usize) -> Vec<f64> {
    let (count, bands, inverse) =
        [(10, 26.0, 0.0), (10, 26.0, 1.0), (13, 40.0, 2.0), (12, 9.0, 3.0), (5, 12.0, 0.0)]
            [asset % 5];
    let mut cepstrum = draw.list(count, -1.0, 1.0);
    cepstrum[0] = draw.within(-40.0, -20.0);
    cepstrum[1] = draw.within(0.0, 6.0);
    [list(&cepstrum), vec![bands, inverse]].concat()
}

/// The same number of lines at all conditions of an asset, or different numbers; some lines lie
/// outside the band.
fn speak(draw: &mut Draw, asset: usize, condition: usize) -> Vec<f64> {
    let count = 3 + asset + if asset.is_multiple_of(2) { 0 } else { condition };
    let mut frequency_hz = draw.list(count, 35.0, 430.0);
    frequency_hz[count - 1] = draw.within(5.0, 1_200.0);
    let amplitude = draw.list(count, 0.05, 1.0);
    let random = (asset % 2) as f64;
    [list(&frequency_hz), list(&amplitude), vec![random]].concat()
}

/// Both layouts, one knot to many; the same layout and count at all conditions of an asset.
fn bands(draw: &mut Draw, asset: usize) -> Vec<f64> {
    let (count, step_db, layout) =
        [(9, 0.5, 0.0), (30, 1.0, 1.0), (5, 0.5, 1.0), (7, 0.25, 0.0), (64, 0.5, 1.0)][asset % 5];
    let below: Vec<f64> = draw.list(count, 0.0, 30.0);
    let below: Vec<f64> = below.iter().map(|db| (db / step_db).round()).collect();
    [list(&below), vec![step_db, layout]].concat()
}

/// Odd and even widths, one row and several, and waves whose frequencies are a fundamental of 12 to
/// 30 Hz apart.
fn map(draw: &mut Draw, band: Band, asset: usize, condition: usize) -> Vec<f64> {
    let width = [40, 17, 64, 31, 8][asset % 5] + condition;
    let rows = [1, 3, 2, 4, 5][asset % 5];
    let stored = |x: f64| f64::from(x as f32);
    let speed_mm_s = stored(draw.within(40.0, 120.0));
    let pitch_mm = stored(speed_mm_s / (width as f64 * draw.within(12.0, 30.0)));
    let grey: Vec<f64> = draw.list(width * rows, 0.0, 255.0);
    let grey: Vec<f64> = grey.iter().map(|grey| grey.round()).collect();
    let rms = htex_map::rms(width, pitch_mm, speed_mm_s, &grey, band).unwrap();
    let scalars = vec![width as f64, pitch_mm, speed_mm_s, 0.5, stored(rms)];
    [scalars, list(&grey)].concat()
}
