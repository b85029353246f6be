//! Sharpens a power spectrum to compensate for the blur of the Hann window. If noise has the
//! sharpened spectrum, a measurement through this window gives the original spectrum.

/// Number of sharpening steps.
const SHARPENINGS: usize = 2;

/// Writes the sharpened power spectrum on the band's grid. If noise has the sharpened spectrum, a
/// measurement through the Hann window gives approximately `power`.
///
/// The window distributes the power of noise over bins: two thirds stay in a bin, and a sixth goes
/// to each neighbour. Two Richardson–Lucy steps approximately undo this distribution. Next to
/// flanks that are steeper than the window's flanks, some blur remains. All slices have the length
/// of `power`, which may be 0; `before` is working memory. Does not allocate.
///
/// ```
/// let (mut before, mut sharp) = ([0.0; 3], [0.0; 3]);
/// htex_dsp::sharpening::sharpen(&[2.0; 3], &mut before, &mut sharp);
/// assert!(sharp.iter().all(|x| (x - 2.0).abs() < 1e-12)); // What is even stays.
/// htex_dsp::sharpening::sharpen(&[1.0, 4.0, 1.0], &mut before, &mut sharp);
/// assert!(sharp[1] > 4.0 && sharp[0] < 1.0);
/// ```
pub fn sharpen(power: &[f64], before: &mut [f64], sharp: &mut [f64]) {
    let Some(last) = power.len().checked_sub(1) else {
        return;
    };
    sharp.copy_from_slice(power);
    for _ in 0..SHARPENINGS {
        before.copy_from_slice(sharp);
        sharp[0] = sharpened(power[0], [before[0], before[0], before[last.min(1)]]);
        sharp[last] =
            sharpened(power[last], [before[last.saturating_sub(1)], before[last], before[last]]);
        let inner = sharp.iter_mut().skip(1).zip(power.iter().skip(1));
        for ((sharp, power), neighbours) in inner.zip(before.array_windows()) {
            *sharp = sharpened(*power, *neighbours);
        }
    }
}

/// Power of a bin after one step. `[below, here, above]` is the power before the step, in the bin
/// and its two neighbours.
fn sharpened(power: f64, [below, here, above]: [f64; 3]) -> f64 {
    let read = (below + 4.0 * here + above) / 6.0;
    if read > 0.0 { here * (power / read) } else { here }
}
