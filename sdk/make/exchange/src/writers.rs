//! The writers of the formats. Each writer reduces the asset's vibration to what the actuator can
//! play, writes the file and reads the file back.

use crate::android::{
    Android, BasicEnvelope, BasicPoint, LONGEST_POINT_MS, Waveform, WaveformEnvelope, WaveformPoint,
};
use crate::curve::{Point, simplified, value_at};
use crate::error::ExchangeError;
use crate::export::MOST_RATE_HZ;
use crate::format::RATE_HZ;
use crate::heard::{Heard, threshold};
use crate::hjif::{Hjif, Space, Tone, vectorial, waveform};
use crate::job::{Coding, Job, WrittenSignal};
use crate::pattern::{Pattern, rendered};
use crate::reduce::{drive, one_tone, played_by, tones};
use htex_format::{Manifest, Quantity};

/// Largest number of points in an envelope if the format has no limit.
const MANY: usize = 4_000;
/// Number of tones in a vectorial file. It is the largest number of bands in a channel of level 1.
const TONES: usize = 7;
/// Tolerance when curves are simplified: a point is left out if it is closer than this to the line
/// between the remaining points.
const TOLERANCE: f64 = 1e-3;
/// The intensity 0 of a basic envelope stands for this level above the detection threshold,
/// decibels (documentation of `VibrationEffect.BasicEnvelopeBuilder`).
const LEAST_SL_DB: f64 = 10.0;

pub(crate) fn haptic(job: &Job<'_>) -> Result<WrittenSignal, ExchangeError> {
    let source = &job.playing.source;
    let manifest = source.manifest();
    let text =
        |of: fn(&Manifest) -> Option<&String>| manifest.and_then(of).cloned().unwrap_or_default();
    let metadata = crate::haptic::Metadata {
        editor: concat!("htex ", env!("CARGO_PKG_VERSION")).to_owned(),
        source: source.name().to_owned(),
        author: source.rights().author.unwrap_or_default(),
        tags: manifest.map(|manifest| manifest.tags.clone()).unwrap_or_default(),
        description: {
            let description = text(|manifest| manifest.description.as_ref());
            source.rights().described(&description)
        },
        ..Default::default()
    };
    one_envelope(job, |pattern| {
        let bytes = crate::Haptic::from_pattern(pattern, job.profile, metadata.clone()).to_bytes();
        let read = crate::Haptic::from_bytes(&bytes).map_err(|fault| job.own(fault))?;
        Ok((bytes, vec![read.pattern(job.profile)]))
    })
}

pub(crate) fn ahap(job: &Job<'_>) -> Result<WrittenSignal, ExchangeError> {
    let rights = job.playing.source.rights();
    one_envelope(job, |pattern| {
        let ahap = crate::Ahap::from_pattern(pattern, job.profile);
        let bytes = ahap.with_description(&rights.described("")).to_bytes();
        let read = crate::Ahap::from_bytes(&bytes).map_err(|fault| job.own(fault))?;
        Ok((bytes, read.patterns(job.profile)))
    })
}

type ReadBack = (Vec<u8>, Vec<Pattern>);

fn one_envelope(
    job: &Job<'_>,
    written: impl Fn(&Pattern) -> Result<ReadBack, ExchangeError>,
) -> Result<WrittenSignal, ExchangeError> {
    let heard = job.playing.heard(RATE_HZ, job.point_s(MANY))?;
    let mut reduced = one_tone(&heard, job.profile, false);
    thin(&mut reduced.pattern);
    let (bytes, patterns) = written(&reduced.pattern)?;
    let patterns: Vec<Pattern> = patterns.into_iter().map(|p| played_by(p, job.profile)).collect();
    Ok(WrittenSignal {
        drive: rendered(&patterns, RATE_HZ),
        bytes,
        heard,
        limited: reduced.limited,
        notes: Vec::new(),
    })
}

/// Rounds values to the digits that a file needs, and leaves out points where the curve does not
/// bend.
fn thin(pattern: &mut Pattern) {
    let rounded =
        |p: &Point| Point::new(libm::round(p.time_s * 1e6) / 1e6, libm::round(p.value * 1e4) / 1e4);
    for curve in [&mut pattern.level, &mut pattern.frequency_hz] {
        curve.iter_mut().for_each(|p| *p = rounded(p));
    }
    pattern.to_s = libm::round(pattern.to_s * 1e6) / 1e6;
    pattern.level = simplified(&pattern.level, TOLERANCE);
    // Frequencies are in hertz instead of 0 to 1, so their tolerance is a tenth of a hertz.
    pattern.frequency_hz = simplified(&pattern.frequency_hz, TOLERANCE * 1e2);
}

pub(crate) fn android(job: &Job<'_>) -> Result<WrittenSignal, ExchangeError> {
    let point_s = job.point_s(MANY);
    if point_s > LONGEST_POINT_MS as f64 / 1e3 {
        let problem = format!(
            "{} points of at most 1 s are less than {:.1} s; export a shorter part",
            job.profile.most_points.value, job.playing.seconds
        );
        return Err(job.cannot(problem));
    }
    let heard = job.playing.heard(RATE_HZ, point_s)?;
    let free = one_tone(&heard, job.profile, false);
    // The oldest form has only amplitudes. The device chooses the frequency, which is its
    // resonance.
    let fixed = one_tone(&heard, job.profile, true);
    let effect = Android::new(
        as_waveform(job, &heard, &fixed.pattern),
        as_envelope(job, &heard, &free.pattern),
        as_basic(job, &heard, &free.pattern),
    );
    let rights = job.playing.source.rights();
    let effect = effect.with_rights(&rights);
    let json = effect.to_bytes();
    let read = Android::from_bytes(&json).map_err(|fault| job.own(fault))?;
    read.check_device(job.profile).map_err(|fault| job.own(fault))?;
    let bytes = match job.export.extension {
        Some("kt") => {
            let kotlin = effect.to_kotlin(job.playing.source.name());
            [rights.commented("// ").into_bytes(), kotlin].concat()
        }
        _ => json,
    };
    let richest =
        "The loss is stated for the envelope of WaveformEnvelopeBuilder, the richest of the three.";
    Ok(WrittenSignal {
        drive: rendered(&[played_by(read.pattern(), job.profile)], RATE_HZ),
        bytes,
        heard,
        limited: free.limited,
        notes: vec![richest.to_owned()],
    })
}

/// Returns the durations of points in whole milliseconds. Together they last as long as what is
/// played. If the last block is shorter than the shortest allowed point, it is added to the
/// previous point.
fn durations_ms(job: &Job<'_>, heard: &Heard) -> Vec<u64> {
    let end_s = |count: usize| (count as f64 * heard.block_s).min(heard.seconds());
    let shortest_ms = (libm::ceil(job.profile.shortest_point_ms.value) as u64).max(1);
    let (mut before, mut durations) = (0, Vec::new());
    for count in 1..=heard.blocks.len() {
        // The end times are rounded, not the durations, so that rounding errors do not add up.
        let end = libm::round(end_s(count) * 1e3) as u64;
        let own = end.saturating_sub(before);
        before = end;
        match durations.last_mut() {
            Some(last) if own < shortest_ms => *last += own,
            _ => durations.push(own.max(1)),
        }
    }
    durations
}

fn as_waveform(job: &Job<'_>, heard: &Heard, fixed: &Pattern) -> Waveform {
    let timings_ms = durations_ms(job, heard);
    let mut from_ms = 0;
    let amplitude = |ms: &u64| {
        let middle_s = (from_ms as f64 + 0.5 * *ms as f64) / 1e3;
        from_ms += ms;
        libm::round(255.0 * value_at(&fixed.level, middle_s).unwrap_or(0.0)) as u8
    };
    Waveform { amplitudes: timings_ms.iter().map(amplitude).collect(), timings_ms, repeat: -1 }
}

/// Returns the points at the ends of blocks, and a final point. Each has a level, a frequency and a
/// duration.
fn points(job: &Job<'_>, heard: &Heard, pattern: &Pattern) -> Vec<(f64, f64, u64)> {
    let mut time_s = 0.0;
    let mut points: Vec<(f64, f64, u64)> = Vec::new();
    let durations = durations_ms(job, heard);
    let last = durations.len().saturating_sub(1);
    for (index, ms) in durations.into_iter().enumerate() {
        time_s += ms as f64 / 1e3;
        let at = |curve: &[Point]| value_at(curve, time_s).unwrap_or(0.0);
        // Android refuses a basic envelope that does not end at intensity 0. All envelopes use the
        // same points.
        let level = if index == last { 0.0 } else { at(&pattern.level) };
        points.push((
            libm::round(level * 1e4) / 1e4,
            libm::round(at(&pattern.frequency_hz) * 10.0) / 10.0,
            ms,
        ));
    }
    points
}

fn as_envelope(job: &Job<'_>, heard: &Heard, free: &Pattern) -> WaveformEnvelope {
    let control_points =
        points(job, heard, free).into_iter().map(|(amplitude, frequency_hz, duration_ms)| {
            WaveformPoint { amplitude, frequency_hz, duration_ms }
        });
    WaveformEnvelope {
        initial_frequency_hz: libm::round(
            free.frequency_hz.first().map_or(1.0, |p| p.value) * 10.0,
        ) / 10.0,
        control_points: control_points.collect(),
    }
}

/// Converts amplitudes to intensities. An intensity is a position on a scale of decibels, from 10
/// dB above the threshold (0) to the strongest sensation (1). Android gives no formula, and states
/// only that 0.5 feels half as strong.
fn as_basic(job: &Job<'_>, heard: &Heard, free: &Pattern) -> BasicEnvelope {
    let profile = job.profile;
    let above_db = |hertz: f64, part: f64| {
        let over = part * profile.strongest_at(hertz) / threshold(Quantity::Acceleration, hertz);
        20.0 * libm::log10(over.max(1e-9)) - LEAST_SL_DB
    };
    let range = |step: usize| profile.hertz_of(step as f64 / 64.0);
    let most_db = (0..=64).map(|step| above_db(range(step), 1.0)).fold(1.0, f64::max);
    let rounded = |x: f64| libm::round(x * 1e4) / 1e4;
    let control_points =
        points(job, heard, free).into_iter().map(|(amplitude, hertz, duration_ms)| BasicPoint {
            intensity: rounded((above_db(hertz, amplitude) / most_db).clamp(0.0, 1.0)),
            sharpness: rounded(profile.part_of(hertz)),
            duration_ms,
        });
    BasicEnvelope {
        initial_sharpness: rounded(
            profile.part_of(free.frequency_hz.first().map_or(1.0, |p| p.value)),
        ),
        control_points: control_points.collect(),
    }
}

/// Returns positions in space for an export at a condition, and positions in time for an export
/// along a stroke or of a scene.
fn space(job: &Job<'_>) -> Space {
    let speed = job.playing.source.speed_mm_s();
    Space { speed_mm_s: speed.filter(|speed| *speed > 0.0) }
}

pub(crate) fn hjif(job: &Job<'_>) -> Result<WrittenSignal, ExchangeError> {
    job.check_samples()?;
    let space = space(job);
    let (file, heard, limited) = match job.export.coding.unwrap_or_default() {
        Coding::Vectorial => vectorial_file(job, space)?,
        Coding::Wavelet => wavelet_file(job, space)?,
    };
    let bytes = file.to_bytes();
    let read = Hjif::from_bytes(&bytes).map_err(|fault| job.own(fault))?;
    let speed = space.speed_mm_s.unwrap_or(1.0);
    let drive = read.rendered(heard.rate_hz, speed).map_err(|fault| job.own(fault))?;
    let over_way = |speed: f64| {
        format!("It lies along the finger's path, and is felt as the asset only at {speed} mm/s.")
    };
    Ok(WrittenSignal {
        bytes,
        heard,
        drive,
        limited,
        notes: space.speed_mm_s.map(over_way).into_iter().collect(),
    })
}

type Coded = (Hjif, Heard, f64);

/// Returns a description with the name and the rights.
fn described(job: &Job<'_>) -> String {
    let source = &job.playing.source;
    source.rights().described(source.name())
}

fn vectorial_file(job: &Job<'_>, space: Space) -> Result<Coded, ExchangeError> {
    let heard = job.playing.heard(RATE_HZ, job.point_s(MANY))?;
    let several = tones(&heard, job.profile, TONES);
    let rounded = |p: &Point| Point::new(p.time_s, libm::round(p.value * 1e4) / 1e4);
    let tone = |(hertz, amplitude): (f64, Vec<Point>)| Tone {
        hertz,
        amplitude: simplified(&amplitude, TOLERANCE).iter().map(rounded).collect(),
    };
    let all: Vec<Tone> = several.tones.into_iter().map(tone).collect();
    let description = described(job);
    Ok((vectorial(&all, job.profile, space, &description), heard, several.limited))
}

fn wavelet_file(job: &Job<'_>, space: Space) -> Result<Coded, ExchangeError> {
    let least_hz = 2.0 * job.playing.source.band().high_hz;
    if space.rate_hz() < least_hz {
        let problem = format!(
            "at {} mm/s its smallest steps of way are {:.0} samples in a second, and the texture needs {least_hz:.0}; choose a higher speed, or vectorial coding",
            space.speed_mm_s.unwrap_or_default(),
            space.rate_hz()
        );
        return Err(job.cannot(problem));
    }
    if space.rate_hz() > MOST_RATE_HZ {
        let problem = format!(
            "at {} mm/s its steps of way are more than {MOST_RATE_HZ} samples in a second; choose a lower speed, or vectorial coding",
            space.speed_mm_s.unwrap_or_default()
        );
        return Err(job.cannot(problem));
    }
    let heard = job.playing.heard(space.rate_hz(), job.point_s(MANY))?;
    let (samples, limited) = drive(&heard, job.profile);
    let description = described(job);
    let file = waveform(&samples, job.profile, space, &description);
    Ok((file, heard, limited))
}

pub(crate) fn wav(job: &Job<'_>) -> Result<WrittenSignal, ExchangeError> {
    job.check_samples()?;
    let rate_hz = libm::round(job.export.rate_hz());
    let heard = job.playing.heard(rate_hz, job.point_s(MANY))?;
    let (samples, limited) = drive(&heard, job.profile);
    let rights = job.playing.source.rights();
    let bytes =
        crate::wav::to_bytes(&samples, rate_hz as u32, &rights).map_err(|fault| job.own(fault))?;
    let drive = crate::wav::from_bytes(&bytes).map_err(|fault| job.own(fault))?;
    Ok(WrittenSignal { bytes, heard, drive, limited, notes: Vec::new() })
}
