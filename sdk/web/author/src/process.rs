//! A recording as it is read: its columns, its signal, its spectrum, its findings.

use htex_author::recording::{Preview, PreviewColumn, preview};
use htex_author::{Reading as Read, Recording, TextureSpectrum, read_take};
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::call::{Answer, Files, parsed};
use crate::describe;
use crate::recordings::{Names, Reading};
use crate::refusal::Refusal;
use crate::settings::Settings;

/// Steps of a picture of the signals.
const STEPS: usize = 1000;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Call {
    files: Names,
    #[serde(default)]
    settings: Map<String, Value>,
}

fn reading<'a>(json: &[u8], files: Files<'a>) -> Result<Reading<'a>, Refusal> {
    let call: Call = parsed(json)?;
    let mut settings = Settings::new(call.settings);
    let reading = Reading::new(call.files, &mut settings, files)?;
    settings.finish()?;
    Ok(reading)
}

/// What the columns of a file are taken to be.
pub(crate) fn columns(json: &[u8], files: Files<'_>) -> Result<Answer, Refusal> {
    let reading = reading(json, files)?;
    let (name, bytes, options) = reading.only()?;
    Answer::new(&previewed(&preview(name, bytes, options)?), Vec::new())
}

fn previewed(preview: &Preview) -> Value {
    let column = |column: &PreviewColumn| {
        json!({
            "name": column.name,
            "role": column.role.map(|role| role.name()),
            "scale": column.scale,
            "unit": column.unit,
            "first": column.first,
        })
    };
    json!({
        "columns": preview.columns.iter().map(column).collect::<Vec<_>>(),
        "rate_hz": preview.rate_hz,
        "map": preview.map,
        "problem": preview.problem,
    })
}

/// Reads a recording; the bytes are a picture of its signals, [`Picture`].
pub(crate) fn process(json: &[u8], files: Files<'_>) -> Result<Answer, Refusal> {
    let reading = reading(json, files)?;
    let (name, bytes, options) = reading.only()?;
    let preview = preview(name, bytes, options)?;
    let take = reading.takes(&[])?.pop();
    let take = take.ok_or_else(|| Refusal::argument("give one recording"))?;
    let read = read_take(&take, &reading.spectrum, reading.strict)?;
    let parts = std::slice::from_ref(&read.part);
    let spectrum = TextureSpectrum::average(parts, reading.spectrum.averaging)?;
    let picture = Picture::of(&take.recording);
    let mut processed = processed(&take.recording, &read, &spectrum);
    let more = [
        ("columns", previewed(&preview)),
        ("picture", picture.described()),
    ];
    if let Value::Object(all) = &mut processed {
        all.extend(more.map(|(key, value)| (key.to_owned(), value)));
    }
    Answer::new(&processed, picture.bytes)
}

fn processed(recording: &Recording, read: &Read, spectrum: &TextureSpectrum) -> Value {
    let stretches = read.part.segments.stretches().into_iter();
    let read_s = stretches.map(|part| [part.start, part.end].map(|at| recording.second(at)));
    json!({
        "rate_hz": recording.rate_hz,
        "duration_s": recording.duration_s(),
        "simulated": recording.simulated,
        "spectrum": describe::spectrum(spectrum),
        "segments": spectrum.segments,
        "from_sweeps": read.part.segments.from_sweeps,
        "read_s": read_s.collect::<Vec<_>>(),
        "condition": { "speed": read.condition.speed_mm_s, "force": read.condition.force_n },
        "speed_spread": read.spread.speed_mm_s,
        "force_spread": read.spread.force_n,
        "findings": describe::findings(&read.findings),
        "warnings": describe::notices(&read.warnings),
        "notes": describe::notices(&read.notes),
    })
}

/// Signals in at most 1000 steps of time: of each the least and the greatest of each step, in single precision.
struct Picture {
    from_s: f64,
    step_s: f64,
    steps: usize,
    signals: Vec<&'static str>,
    bytes: Vec<u8>,
}

impl Picture {
    fn of(recording: &Recording) -> Self {
        let samples = recording.samples();
        let per_step = samples.div_ceil(STEPS).max(1);
        let mut picture = Self {
            from_s: recording.second(0),
            step_s: per_step as f64 / recording.rate_hz,
            steps: samples.div_ceil(per_step),
            signals: Vec::new(),
            bytes: Vec::new(),
        };
        for (name, axis) in ["signal", "signal_y", "signal_z"]
            .iter()
            .zip(&recording.axes)
        {
            picture.add(name, axis, per_step);
        }
        let motion = [
            ("normal", &recording.normal_n),
            ("speed", &recording.speed_mm_s),
        ];
        for (name, signal) in motion {
            if let Some(signal) = signal {
                picture.add(name, signal, per_step);
            }
        }
        picture
    }

    fn add(&mut self, name: &'static str, signal: &[f64], per_step: usize) {
        self.signals.push(name);
        let steps = signal.chunks(per_step);
        let least = steps
            .clone()
            .map(|step| step.iter().copied().fold(f64::INFINITY, f64::min));
        let greatest = steps.map(|step| step.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        let numbers = least.chain(greatest).map(|x| (x as f32).to_le_bytes());
        self.bytes.extend(numbers.flatten());
    }

    fn described(&self) -> Value {
        json!({
            "from_s": self.from_s,
            "step_s": self.step_s,
            "steps": self.steps,
            "signals": self.signals,
        })
    }
}
