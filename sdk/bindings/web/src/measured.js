// Computes the spectrum of samples in the same way as for a recording: segments of 0.2 s that
// overlap by half, Hann windows, RMS over all segments.

/** Distance between the frequencies of a spectrum, Hz: one period per segment. */
export const GRID_HZ = 5;

/**
 * Returns the magnitudes of samples at multiples of 5 Hz, in the samples' unit. A sinusoid's
 * magnitude is its amplitude. The sample rate is in Hz.
 */
export function measured(samples, rate, frequencies) {
  const len = Math.round(rate / GRID_HZ);
  const [cos, sin] = [Math.cos, Math.sin].map((wave) => Float64Array.from({ length: len }, (_, n) => wave((2 * Math.PI * n) / len)));
  const bins = Array.from(frequencies, (hz) => Math.round(hz / GRID_HZ));
  const power = new Float64Array(bins.length);
  const windowed = new Float64Array(len);
  let count = 0;
  for (let start = 0; start + len <= samples.length; start += len / 2, count += 1) {
    for (let n = 0; n < len; n++) windowed[n] = samples[start + n] * (0.5 - 0.5 * cos[n]);
    bins.forEach((bin, i) => {
      let [re, im] = [0, 0];
      for (let n = 0, turn = 0; n < len; n++, turn = (turn + bin) % len) {
        re += windowed[n] * cos[turn];
        im += windowed[n] * sin[turn];
      }
      power[i] += re * re + im * im;
    });
  }
  return power.map((sum) => (4 / len) * Math.sqrt(sum / count));
}
