//! Finds the sinusoids of a model that renders a sum of sinusoids.

use std::rc::Rc;

use htex_dsp::grid::GRID_HZ;
use htex_dsp::window::hann_main_lobe;
use htex_host::Band;
use htex_player::layout::MOST_TONES;

use crate::Error;
use crate::bake::moments::Moment;

/// Frequencies that differ by less than this, hertz, count as one sinusoid.
const SAME_HZ: f64 = 0.01;

/// A frequency in hertz, and an amplitude in any scale.
pub(crate) type Tone = (f64, f64);

/// Returns the sinusoids of each condition, and whether their phases are random. All conditions get
/// the same number of sinusoids. If they already have the same number, the sinusoids are matched by
/// index, as in the model. Otherwise they are matched by frequency, and a missing sinusoid gets
/// zero amplitude.
pub(crate) fn tones_of(
    moments: &[Rc<Moment>],
    band: Band,
) -> Result<(Vec<Vec<Tone>>, bool), Error> {
    let read: Option<Vec<(Vec<Tone>, bool)>> = moments.iter().map(|m| read(m, band)).collect();
    // The model has already accepted these parameters.
    let read = read.unwrap_or_default();
    let random = read.first().is_some_and(|(_, random)| *random);
    let all: Vec<Vec<Tone>> = read.into_iter().map(|(tones, _)| tones).collect();
    let count = all.first().map_or(0, Vec::len);
    let all = if all.iter().all(|tones| tones.len() == count) { all } else { matched(&all) };
    let count = all.first().map_or(0, Vec::len);
    if count <= MOST_TONES {
        Ok((all, random))
    } else {
        Err(Error::Tones { count, most: MOST_TONES })
    }
}

/// Returns the magnitude of a sum of sinusoids on the band's frequency grid, as a Hann window
/// measures it. The frequencies of the sinusoids are first divided by `ratio`.
pub(crate) fn magnitude(tones: &[Tone], band: Band, ratio: f64) -> Vec<f64> {
    let at = |hz: f64| {
        let seen = tones.iter().map(|&(f, a)| a * hann_main_lobe((hz - f / ratio) / GRID_HZ));
        seen.map(|m| m * m).sum::<f64>().sqrt()
    };
    band.grid_hz().into_iter().map(at).collect()
}

/// Reads the model's fields: a list of frequencies, a list of amplitudes, and whether the phases
/// are random.
fn read(moment: &Moment, band: Band) -> Option<(Vec<Tone>, bool)> {
    let (&count, rest) = moment.parameters.split_first()?;
    let (frequencies, rest) = rest.split_at_checked(count as usize)?;
    // Each list comes after its length, and both lists have the same length.
    let (amplitudes, rest) = rest.get(1..)?.split_at_checked(count as usize)?;
    let tone = |(&hz, &amplitude): (&f64, &f64)| {
        if band.contains(hz) { (hz * moment.ratio, amplitude) } else { (hz * moment.ratio, 0.0) }
    };
    let tones = frequencies.iter().zip(amplitudes).map(tone).collect();
    Some((tones, rest.first().is_some_and(|random| *random >= 0.5)))
}

fn matched(all: &[Vec<Tone>]) -> Vec<Vec<Tone>> {
    let mut union: Vec<f64> = all.iter().flatten().map(|(hz, _)| *hz).collect();
    union.sort_by(f64::total_cmp);
    // `dedup_by` passes the later element first, so the difference is not negative.
    union.dedup_by(|a, b| *a - *b < SAME_HZ);
    let amplitude = |tones: &[Tone], hz: f64| -> f64 {
        let same = tones.iter().filter(|(f, _)| (f - hz).abs() < SAME_HZ);
        same.map(|(_, amplitude)| amplitude).sum()
    };
    let row = |tones: &Vec<Tone>| union.iter().map(|&hz| (hz, amplitude(tones, hz))).collect();
    all.iter().map(row).collect()
}
