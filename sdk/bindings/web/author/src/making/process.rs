//! Reads a recording: its columns, signals, spectrum and findings.

use htex_author::recording::{Preview, preview};
use htex_author::{Recording, SegmentedTake, TextureSpectrum, segment_take};
use serde::Serialize;

use super::describe::{self, DescribedFinding, DescribedNotice, DescribedSpectrum};
use super::recordings::Reading;
use crate::answer::{Answer, Files};
use crate::document::Document;
use crate::refusal::Refusal;

/// Number of time steps in a picture of the signals.
const STEPS: usize = 1000;

fn reading<'a>(mut call: Document, files: Files<'a>) -> Result<Reading<'a>, Refusal> {
    let names = call.object("files")?;
    let mut settings = call.object("settings")?;
    call.finish()?;
    let reading = Reading::new(names, &mut settings, files)?;
    settings.finish()?;
    Ok(reading)
}

/// Returns the columns of a recording, and how they are interpreted.
pub(crate) fn columns(call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let reading = reading(call, files)?;
    let (name, bytes, options) = reading.only()?;
    let preview = preview(name, bytes, options)?;
    Answer::new(&Columns::new(&preview), Vec::new())
}

#[derive(Serialize)]
struct Columns<'a> {
    columns: Vec<Column<'a>>,
    rate_hz: Option<f64>,
    map: &'a str,
    problem: Option<&'a str>,
}

#[derive(Serialize)]
struct Column<'a> {
    name: &'a str,
    role: Option<&'static str>,
    scale: f64,
    unit: &'static str,
    first: &'a [f64],
}

impl<'a> Columns<'a> {
    fn new(preview: &'a Preview) -> Self {
        let columns = preview.columns.iter().map(|column| Column {
            name: &column.name,
            role: column.role.map(|role| role.name()),
            scale: column.scale,
            unit: column.unit,
            first: &column.first,
        });
        Self {
            columns: columns.collect(),
            rate_hz: preview.rate_hz,
            map: &preview.map,
            problem: preview.problem.as_deref(),
        }
    }
}

/// Reads a recording. The bytes of the answer are the numbers of a [`Picture`] of its signals.
pub(crate) fn process(call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let reading = reading(call, files)?;
    let (name, bytes, options) = reading.only()?;
    let preview = preview(name, bytes, options)?;
    let take = reading.takes(&[])?.pop().ok_or_else(|| Refusal::argument("give one recording"))?;
    let read = segment_take(&take, &reading.spectrum, reading.strict)?;
    let parts = std::slice::from_ref(&read.spectra);
    let spectrum = TextureSpectrum::average(parts, reading.spectrum.averaging)?;
    let (picture, numbers) = Picture::new(&take.recording);
    let processed = ProcessAnswer {
        columns: Columns::new(&preview),
        picture,
        ..ProcessAnswer::new(&take.recording, &read, &spectrum)
    };
    Answer::new(&processed, numbers)
}

#[derive(Serialize)]
struct ProcessAnswer<'a> {
    columns: Columns<'a>,
    rate_hz: f64,
    duration_s: f64,
    simulated: bool,
    spectrum: DescribedSpectrum<'a>,
    segments: usize,
    from_sweeps: bool,
    read_s: Vec<[f64; 2]>,
    condition: Condition,
    speed_spread: Option<[f64; 2]>,
    force_spread: Option<[f64; 2]>,
    findings: Vec<DescribedFinding<'a>>,
    warnings: Vec<DescribedNotice<'a>>,
    notes: Vec<DescribedNotice<'a>>,
    picture: Picture,
}

#[derive(Serialize)]
struct Condition {
    speed: Option<f64>,
    force: Option<f64>,
}

impl<'a> ProcessAnswer<'a> {
    fn new(recording: &Recording, read: &'a SegmentedTake, spectrum: &'a TextureSpectrum) -> Self {
        let stretches = read.spectra.segments.stretches().into_iter();
        let second = |part: std::ops::Range<usize>| {
            [recording.second(part.start), recording.second(part.end)]
        };
        Self {
            // Empty here and below: the caller fills in columns and picture.
            columns: Columns { columns: Vec::new(), rate_hz: None, map: "", problem: None },
            rate_hz: recording.rate_hz,
            duration_s: recording.duration_s(),
            simulated: recording.simulated,
            spectrum: describe::spectrum(spectrum),
            segments: spectrum.segments,
            from_sweeps: read.spectra.segments.from_sweeps,
            read_s: stretches.map(second).collect(),
            condition: Condition { speed: read.motion.speed_mm_s, force: read.motion.force_n },
            speed_spread: read.spread.speed_mm_s,
            force_spread: read.spread.force_n,
            findings: describe::findings(&read.findings),
            warnings: describe::notices(&read.warnings),
            notes: describe::notices(&read.notes),
            picture: Picture::default(),
        }
    }
}

/// Signals in at most 1000 time steps: the minimum and maximum in each step, in single precision.
#[derive(Serialize, Default)]
struct Picture {
    from_s: f64,
    step_s: f64,
    steps: usize,
    signals: Vec<&'static str>,
}

impl Picture {
    /// Returns the picture, and its numbers as bytes.
    fn new(recording: &Recording) -> (Self, Vec<u8>) {
        let samples = recording.samples();
        // `chunks` panics at 0.
        let per_step = samples.div_ceil(STEPS).max(1);
        let axes = ["signal", "signal_y", "signal_z"];
        let axes = axes.into_iter().zip(recording.axes.iter().map(Some));
        let motion =
            [("normal", recording.normal_n.as_ref()), ("speed", recording.speed_mm_s.as_ref())];
        let mut picture = Self {
            from_s: recording.second(0),
            step_s: per_step as f64 / recording.rate_hz,
            steps: samples.div_ceil(per_step),
            signals: Vec::new(),
        };
        let mut numbers = Vec::new();
        for (name, signal) in axes.chain(motion) {
            if let Some(signal) = signal {
                picture.signals.push(name);
                draw(signal, per_step, &mut numbers);
            }
        }
        (picture, numbers)
    }
}

fn draw(signal: &[f64], per_step: usize, numbers: &mut Vec<u8>) {
    let mut greatest = Vec::new();
    for step in signal.chunks(per_step) {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in step {
            low = low.min(*value);
            high = high.max(*value);
        }
        numbers.extend((low as f32).to_le_bytes());
        greatest.extend((high as f32).to_le_bytes());
    }
    numbers.append(&mut greatest);
}
