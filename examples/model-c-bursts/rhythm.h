/* Period and duty of the bursts of a recorded signal. Included by bursts.c, which defines the indices of the parameters and
 * their ranges MIN and MAX.
 */
#ifndef RHYTHM_H
#define RHYTHM_H

/* Power of the signal in blocks of 2 ms, minus its mean; returns the mean. */
static double envelope(const double *signal, size_t blocks, size_t frames, double *out)
{
    double mean = 0.0;
    for (size_t n = 0; n < blocks; n++) {
        out[n] = 0.0;
        for (size_t i = 0; i < frames; i++)
            out[n] += signal[n * frames + i] * signal[n * frames + i];
        mean += out[n] / (double)blocks;
    }
    for (size_t n = 0; n < blocks; n++)
        out[n] -= mean;
    return mean;
}

static double covariance(const double *x, size_t len, size_t lag)
{
    double sum = 0.0;
    for (size_t n = 0; n + lag < len; n++)
        sum += x[n] * x[n + lag];
    return sum / (double)(len - lag);
}

/* Finds the period of the bursts: the first maximum of the covariance of the signal's envelope. At one period it is
 * (1/duty - 1) mean^2, without the part of the noise at lag 0. The result is steady noise if there is no clear maximum,
 * or if the signal is shorter than half a second. `p[SPEED]` must be set. */
static void find_bursts(double *p, const double *signal, size_t len, double rate_hz)
{
    enum { BLOCKS = 2048, LEAST = 250, SHORTEST = 5, LONGEST = 250 };
    double power[BLOCKS], lags[LONGEST + 2], largest = 0.0;
    size_t frames = (size_t)(0.002 * rate_hz), blocks = frames > 0 ? len / frames : 0;
    p[PER_MM] = clamp(20.0 / p[SPEED], MIN[PER_MM], MAX[PER_MM]);
    p[DUTY] = 1.0;
    p[JITTER] = 0.0;
    if (blocks < LEAST)
        return;
    if (blocks > BLOCKS)
        blocks = BLOCKS;
    size_t longest = blocks / 3 < LONGEST ? blocks / 3 : LONGEST;
    double mean = envelope(signal, blocks, frames, power);
    for (size_t lag = SHORTEST - 1; lag <= longest + 1; lag++)
        lags[lag] = covariance(power, blocks, lag);
    size_t period = 0;
    for (size_t lag = SHORTEST; lag <= longest; lag++)
        if (lags[lag] > lags[lag - 1] && lags[lag] >= lags[lag + 1] && lags[lag] > largest)
            largest = lags[lag];
    /* The first maximum that is nearly as high: later ones are multiples of the period. */
    for (size_t lag = longest; lag >= SHORTEST; lag--)
        if (lags[lag] > lags[lag - 1] && lags[lag] >= lags[lag + 1] && lags[lag] >= 0.8 * largest)
            period = lag;
    double threshold = 8.0 / __builtin_sqrt((double)blocks);
    if (period == 0 || !(largest > clamp(threshold, 0.15, 1.0) * covariance(power, blocks, 0)))
        return;
    double before = lags[period - 1], at = lags[period], after = lags[period + 1];
    double exact = (double)period + 0.5 * (before - after) / (before - 2.0 * at + after);
    p[PER_MM] = clamp(rate_hz / ((double)frames * exact) / p[SPEED], MIN[PER_MM], MAX[PER_MM]);
    p[DUTY] = clamp(1.0 / (1.0 + largest / (mean * mean)), MIN[DUTY], MAX[DUTY]);
}

#endif
