//! sPeak model (`org.htex.speak`): the spectrum as a few sinusoids, whose frequencies are at least
//! a just-noticeable difference apart (section "Spectral peak" of the paper, equation for y_sp).
//!
//! By default, the frequency of a sinusoid is interpolated between the bins
//! ([`htex_dsp::interpolated_peaks`]). In this case, a tone at any multiple of 0.5 Hz from 60 to
//! 900 Hz is stored with an error of less than 0.001 Hz and 0.001 dB. Other frequencies are rounded
//! to a multiple of 1/32 Hz when they are stored in a file. With `frequency=bin`, as in the paper,
//! each sinusoid has the frequency of a bin. In this case, the errors are up to 2.5 Hz and 1.4 dB,
//! and the sound repeats every 0.2 s, because all frequencies are multiples of 5 Hz.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![no_std]

extern crate alloc;

use alloc::vec::Vec;

use htex_dsp::grid::{GRID_HZ, read_part};
use htex_dsp::interpolated_peaks::select_interpolated_peaks;
use htex_dsp::peaks::{Peak, select_peaks};
use htex_dsp::sine_bank::{Sine, SineBank};
use htex_dsp::uniform::Uniform;
use htex_dsp::window::hann_main_lobe;
use htex_model::{
    Band, Error, Fit, FitInput, Model, Numbers, StaticDescriptor, StaticField, StaticOption, Store,
    UsualRange, Values, Voice, mix, text,
};

const FREQUENCY: usize = 0;
const AMPLITUDE: usize = 1;
const PHASE: usize = 2;
const COUNT: usize = 0;
const JND: usize = 1;
const PHASE_OPTION: usize = 2;
const FREQUENCY_OPTION: usize = 3;

/// Maximum number of sinusoids in one parameter set.
const MAX_PEAKS: usize = 64;
/// Peaks below this magnitude, relative to the largest bin, are ignored. They are imperceptible,
/// cannot be stored, and may be rounding errors next to a tone at the band's edge.
const FAINTEST: f64 = 1e-7;

/// Frequencies are stored in steps of 1/32 Hz, which represent the 5 Hz grid exactly.
const HERTZ: Store = Store::U16 { scale: 0.03125, offset: 0.0, log: false };
/// Amplitudes are stored in steps of 0.003 dB.
const RATIO: Store = Store::U16 { scale: 0.0003, offset: -18.0, log: true };

pub(crate) struct SpectralPeak;

htex_model::export_model!(SpectralPeak, symbols: "plugin");

impl Model for SpectralPeak {
    type Voice = SpectralPeakVoice;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.htex.speak",
        "sPeak",
        env!("CARGO_PKG_VERSION"),
        "The strongest spectral peaks, as sinusoids whose frequencies are far enough apart to be told apart.",
    )
    .fields(&[
        StaticField::list(
            "frequency_hz",
            "Hz",
            (0.0, 2000.0),
            MAX_PEAKS as u32,
            "Frequencies of the sinusoids. Sinusoids outside the band are not played.",
        )
        .stored(HERTZ)
        // The band of textures.
        .usual(UsualRange::log(20.0, 1000.0)),
        StaticField::list(
            "amplitude",
            "1",
            (0.0, 4.0),
            MAX_PEAKS as u32,
            "Amplitudes of the sinusoids, divided by the level. For the sinusoids in the band, half the squares of \
             the amplitudes add up to one. In this sum, each is weighted by the part of its power that the band's \
             bins measure (1 inside the band, 5/6 at an edge).",
        )
        .stored(RATIO)
        // A single sinusoid has the amplitude √2, because half the squares of all amplitudes add up
        // to one.
        .usual(UsualRange::linear(0.0, 1.42)),
        StaticField::scalar(
            "random_phase",
            "1",
            (0.0, 1.0),
            "0: all sinusoids start at their maximum, as in the paper. 1: they start at random phases, which depend \
             on the voice's seed.",
        )
        .stored(Store::U8 {
            scale: 1.0,
            offset: 0.0,
            log: false,
        })
        .usual(UsualRange::linear(0.0, 1.0)),
    ])
    .options(&[
        StaticOption::integer(
            "count",
            (1, MAX_PEAKS as u32),
            10,
            "Maximum number of peaks to store. The paper uses ten.",
        )
        .sweep(&[1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0]),
        StaticOption::number(
            "jnd",
            "1",
            (0.0, 1.0),
            0.12,
            "Smallest relative distance between the frequencies of two peaks. The paper uses 12 %.",
        )
        .sweep(&[0.24, 0.12, 0.06, 0.03, 0.0]),
        StaticOption::choice(
            "phase",
            &["seed", "zero"],
            "Phases at which the sinusoids start. `seed`: random phases, which depend on the voice's seed. `zero`: \
             all at their maximum, as in the paper.",
        ),
        StaticOption::choice(
            "frequency",
            &["interpolated", "bin"],
            "How the frequency of a peak is measured. `interpolated`: between the bins, at the frequency of a \
             sinusoid that would give the magnitudes of the peak's bin and of its larger neighbour. `bin`: at the \
             bin, as in the paper; a sinusoid is then stored up to 2.5 Hz off and 1.4 dB too weak.",
        ),
    ]);

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        let mut peaks = selected_peaks(input);
        let largest = input.magnitude.iter().copied().fold(0.0, f64::max);
        peaks.retain(|p| p.magnitude > FAINTEST * largest);
        let strongest = peaks.iter().map(|p| p.magnitude).fold(0.0, f64::max);
        if peaks.is_empty() {
            return Err(Error::cannot_fit(
                "the spectrum has no peak: no bin stands above its neighbours",
            ));
        }
        let relative = |p: &Peak| (p.frequency_hz, p.magnitude / strongest);
        let unit = level(input.band, peaks.iter().map(relative));
        let frequency_hz: Vec<f64> = peaks.iter().map(|p| p.frequency_hz).collect();
        let amplitude: Vec<f64> = peaks.iter().map(|p| relative(p).1 / unit).collect();
        Ok(Fit {
            parameters: flat(&frequency_hz, &amplitude, random_phase(input)),
            level_rms: unit * strongest,
        })
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        let lines = Lines::new(parameters, band)?;
        for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
            let inside = (band.low_hz..=band.high_hz).contains(&f);
            *m = if inside { lines.seen_at(f) } else { 0.0 };
        }
        Ok(())
    }

    /// If all sets have the same number of lines, interpolates the frequency and the amplitude of
    /// each line. Otherwise cross-fades the lines at constant power.
    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        let same = |s: &Values<'_>| s.list(FREQUENCY).len() == sets[0].list(FREQUENCY).len();
        if sets.iter().all(same) {
            return mix::linear(sets, weights, out);
        }
        let heard = || sets.iter().zip(weights).filter(|(_, w)| **w > 0.0);
        let count: usize = heard().map(|(set, _)| set.list(FREQUENCY).len()).sum();
        if count > MAX_PEAKS {
            return Err(Error::argument(text![
                "the sets have ",
                count,
                " lines together; ",
                MAX_PEAKS,
                " are allowed",
            ]));
        }
        out.push(count as f64);
        heard().for_each(|(set, _)| out.extend(set.list(FREQUENCY)));
        out.push(count as f64);
        for (set, weight) in heard() {
            // The powers of different lines add up, so the weights apply to powers.
            let fade = htex_dsp::root::sqrt(*weight);
            set.list(AMPLITUDE).iter().for_each(|a| out.push(a * fade));
        }
        out.push(sets.first().map_or(0.0, |s| s.scalar(PHASE)));
        Ok(())
    }

    fn voice(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error> {
        let lines = Lines::new(parameters, band)?;
        let mut voice = SpectralPeakVoice {
            band,
            phase_cycles: start_phases(parameters.scalar(PHASE), seed),
            sines: [SILENT; MAX_PEAKS],
            bank: SineBank::new(rate_hz, 0, &[]),
        };
        let count = voice.set(&lines);
        voice.bank = SineBank::new(rate_hz, MAX_PEAKS, &voice.sines[..count]);
        Ok(voice)
    }
}

fn selected_peaks(input: &FitInput<'_>) -> Vec<Peak> {
    let select = match input.options[FREQUENCY_OPTION] as u32 {
        0 => select_interpolated_peaks,
        _ => select_peaks,
    };
    let (count, jnd) = (input.options[COUNT] as usize, input.options[JND]);
    select(input.frequency_hz, input.magnitude, count, jnd)
}

/// Returns the value of the field `random_phase`.
fn random_phase(input: &FitInput<'_>) -> f64 {
    match input.options[PHASE_OPTION] as u32 {
        0 => 1.0,
        _ => 0.0,
    }
}

const SILENT: Sine = Sine { frequency_hz: 0.0, amplitude: 0.0, phase_cycles: 0.0 };

fn start_phases(random: f64, seed: u64) -> [f64; MAX_PEAKS] {
    let mut phases = [0.0; MAX_PEAKS];
    if random >= 0.5 {
        let mut uniform = Uniform::new(seed);
        phases.iter_mut().for_each(|p| *p = uniform.next_unit());
    }
    phases
}

/// The voice: a bank of sinusoids.
pub struct SpectralPeakVoice {
    band: Band,
    phase_cycles: [f64; MAX_PEAKS],
    sines: [Sine; MAX_PEAKS],
    bank: SineBank,
}

impl SpectralPeakVoice {
    /// Sets the lines, and returns their number.
    fn set(&mut self, lines: &Lines<'_>) -> usize {
        let count = lines.frequency_hz.len().min(MAX_PEAKS);
        for i in 0..count {
            // A line outside the band keeps its index and its phase, so that it can return.
            self.sines[i] = Sine {
                frequency_hz: lines.frequency_hz[i],
                amplitude: lines.played(i) / lines.level,
                phase_cycles: self.phase_cycles[i],
            };
        }
        count
    }
}

impl Voice for SpectralPeakVoice {
    fn render(&mut self, out: &mut [f32]) {
        self.bank.render(out);
    }

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        let count = self.set(&Lines::new(parameters, self.band)?);
        self.bank.retune(&self.sines[..count]);
        Ok(())
    }
}

/// The sinusoids of a parameter set, and their RMS in the band, as the bins measure it.
struct Lines<'a> {
    frequency_hz: &'a [f64],
    amplitude: &'a [f64],
    band: Band,
    level: f64,
}

impl<'a> Lines<'a> {
    fn new(parameters: &Values<'a>, band: Band) -> Result<Self, Error> {
        let mut lines = Self {
            frequency_hz: parameters.list(FREQUENCY),
            amplitude: parameters.list(AMPLITUDE),
            band,
            level: 0.0,
        };
        if lines.frequency_hz.len() != lines.amplitude.len() {
            return Err(Error::parameters(text![
                lines.frequency_hz.len(),
                " frequencies and ",
                lines.amplitude.len(),
                " amplitudes: there must be as many",
            ]));
        }
        let played = (0..lines.amplitude.len()).map(|i| (lines.frequency_hz[i], lines.played(i)));
        lines.level = level(band, played);
        if lines.level > 0.0 {
            return Ok(lines);
        }
        Err(Error::parameters(text![
            "no line in the band ",
            band.low_hz,
            " to ",
            band.high_hz,
            " Hz has an amplitude above zero",
        ]))
    }

    /// Returns the amplitude with which a line is played. It is 0 outside the band, where textures
    /// have no magnitude.
    fn played(&self, line: usize) -> f64 {
        let inside = self.band.low_hz..=self.band.high_hz;
        if inside.contains(&self.frequency_hz[line]) { self.amplitude[line] } else { 0.0 }
    }

    /// Returns the magnitude at unit RMS, as the Hann window measures it: A on a line, and A/2 one
    /// bin away from the line. The powers of lines are added.
    fn seen_at(&self, frequency_hz: f64) -> f64 {
        let lines = self.frequency_hz.iter().enumerate();
        let power: f64 = lines
            .map(|(i, f)| self.played(i) * hann_main_lobe((frequency_hz - f) / GRID_HZ))
            .map(|m| m * m)
            .sum();
        htex_dsp::root::sqrt(power) / self.level
    }
}

/// Returns the RMS of lines, as the bins of the band measure it. A line is a frequency and an
/// amplitude.
fn level(band: Band, lines: impl Iterator<Item = (f64, f64)>) -> f64 {
    let power = |(hz, a): (f64, f64)| 0.5 * a * a * read_part(band, hz);
    htex_dsp::root::sqrt(lines.map(power).sum())
}

fn flat(frequency_hz: &[f64], amplitude: &[f64], phase: f64) -> Vec<f64> {
    let count = frequency_hz.len() as f64;
    [&[count], frequency_hz, &[count], amplitude, &[phase]].concat()
}
