//! A signal's texture spectrum, and every model operation on it.

use htex_dsp::grid::level_rms;
use htex_dsp::spectrum::SegmentAnalyzer;
use htex_host::{Band, Fit, FitCondition, FitInput, HostError, LoadedModel, Registry, Stream};

use crate::signals::{self, RATE_HZ};

const SEGMENT: usize = 4_000;
const BAND: Band = Band::TACTILE;

/// Mean magnitude of a signal's segments on the grid of the band, newtons.
pub fn spectrum(signal: &[f64]) -> Vec<f64> {
    let mut analyzer = SegmentAnalyzer::new(SEGMENT);
    let mut bins = analyzer.make_bins();
    let mut sum = vec![0.0; BAND.bins()];
    let segments = signal.chunks_exact(SEGMENT);
    let scale = analyzer.amplitude_scale() / segments.len() as f64;
    for segment in segments {
        analyzer.analyze(segment, &mut bins).unwrap();
        let in_band = &bins[BAND.first_bin()..];
        sum.iter_mut().zip(in_band).for_each(|(s, x)| *s += scale * x.norm());
    }
    sum
}

/// The built-in models.
pub fn models() -> Vec<LoadedModel> {
    Registry::builtin().models().to_vec()
}

/// A model by its short name.
pub fn model(name: &str) -> LoadedModel {
    Registry::builtin().find(name).unwrap().clone()
}

/// Fits a model, with options, to a spectrum on the grid of the tactile band and to a signal.
///
/// # Errors
/// The model refuses.
pub fn fit_with(
    model: &LoadedModel,
    magnitude: &[f64],
    signal: &[f64],
    options: &[(&str, &str)],
) -> Result<Fit, HostError> {
    model.fit(&FitInput {
        band: BAND,
        frequency_hz: &BAND.grid_hz(),
        magnitude,
        signal,
        signal_rate_hz: RATE_HZ,
        options: &model.options(options)?,
        condition: FitCondition::default(),
    })
}

/// Fits a model, with its defaults, to a spectrum on the grid of the tactile band.
///
/// # Errors
/// The model refuses.
pub fn fit(model: &LoadedModel, magnitude: &[f64]) -> Result<Fit, HostError> {
    fit_with(model, magnitude, &[], &[])
}

/// Fits every model except those named, and runs every operation on the parameters. Returns the
/// largest sample relative to its RMS. If anything fails, returns NaN and prints a line to standard
/// output.
pub(crate) fn every_model_but(refusing: &[&str], signal: &[f64]) -> f64 {
    let magnitude = spectrum(signal);
    let (mut largest, mut failed) = (0.0, false);
    for model in models() {
        if refusing.contains(&model.short_name()) {
            continue;
        }
        match whole_life(&model, &magnitude) {
            Ok(peak) => largest = f64::max(largest, peak),
            Err(what) => {
                println!("{}: {what}", model.short_name());
                failed = true;
            }
        }
    }
    if failed { f64::NAN } else { largest }
}

/// As [`every_model_but`], without exceptions.
pub(crate) fn every_model(signal: &[f64]) -> f64 {
    every_model_but(&[], signal)
}

/// The error with which a model refuses to fit a signal; a text if it does not refuse.
pub fn refusal(name: &str, signal: &[f64]) -> String {
    outcome_text(fit(&model(name), &spectrum(signal)))
}

/// The models' refusals, if all refuse with the same status.
pub(crate) fn refusal_of_all(signal: &[f64]) -> String {
    let magnitude = spectrum(signal);
    let said = |model: &LoadedModel| outcome_text(fit(model, &magnitude));
    let all: Vec<String> = models().iter().map(said).collect();
    match all.iter().find(|text| !text.contains("CannotFit")) {
        Some(other) => other.clone(),
        None => all[0].clone(),
    }
}

/// Status and message of an error; a text if there was none.
pub fn outcome_text<T>(result: Result<T, HostError>) -> String {
    match result {
        Ok(_) => "it was done".to_owned(),
        Err(HostError::Call { status, message, .. }) => format!("{status:?}: {message}"),
        Err(other) => other.to_string(),
    }
}

/// Runs fit, magnitude, interpolation, voice and retunes, and returns the largest sample.
fn whole_life(model: &LoadedModel, magnitude: &[f64]) -> Result<f64, String> {
    let say = |what: &'static str| move |e: HostError| format!("{what}: {e}");
    let fitted = fit(model, magnitude).map_err(say("fit"))?;
    check_shape(model, &fitted.parameters)?;
    let other = fit(model, &spectrum(&signals::friction())).map_err(say("fit of friction"))?;
    let sets = [&fitted.parameters[..], &other.parameters[..]];
    let half = model.interpolate(&sets, &[0.5, 0.5]).map_err(say("interpolate"))?;
    check_shape(model, &half)?;
    let mut peak = play(model, &fitted.parameters, &[]).map_err(say("render"))?;
    // From the longer set to the shorter ones, because an AR voice keeps its order.
    let turns: [&[f64]; 3] = [&half, &other.parameters, &fitted.parameters];
    peak = peak.max(play(model, &fitted.parameters, &turns).map_err(say("retune"))?);
    if peak.is_finite() { Ok(peak) } else { Err("a sample is subnormal".to_owned()) }
}

/// Checks that a magnitude is finite and has unit RMS.
fn check_shape(model: &LoadedModel, parameters: &[f64]) -> Result<(), String> {
    let magnitude =
        model.magnitude(parameters, BAND, &BAND.grid_hz()).map_err(|e| e.to_string())?;
    let level = level_rms(&magnitude);
    // sPeak's lines are seen through a window, and reach beyond the band.
    let off = if model.short_name() == "speak" { 0.5 } else { 1e-9 };
    if (level - 1.0).abs() > off {
        return Err(format!("the magnitude's RMS is {level}"));
    }
    Ok(())
}

/// The largest of some samples of a voice, which is retuned before each of the first ones; NaN if a
/// sample is subnormal.
fn play(model: &LoadedModel, start: &[f64], turns: &[&[f64]]) -> Result<f64, HostError> {
    let mut stream = Stream::new(model, start, BAND, RATE_HZ, 1)?;
    let mut out = [0.0f32; 4_000];
    let changing = if turns.is_empty() { 0 } else { 200 };
    for (i, sample) in out[..changing].iter_mut().enumerate() {
        stream.retune(turns[i % turns.len()])?;
        stream.render(std::slice::from_mut(sample))?;
    }
    stream.render(&mut out[changing..])?;
    let subnormal = out.iter().any(|x| x.is_subnormal());
    let peak = out.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
    Ok(if subnormal { f64::NAN } else { peak.into() })
}
