/* The spectrum of one resonance, and its fit to a recorded spectrum. The model includes this file,
 * and defines the indices CENTRE and BANDWIDTH of its parameters and their ranges MIN and MAX.
 */
#ifndef RESONANCE_H
#define RESONANCE_H

/* ---- the spectrum ---- */

struct band { double low_hz, high_hz, pass_low_hz, pass_high_hz; };

/* A filter cuts the noise off half a bin below the band, because a bin stands for 5 Hz around
 * its frequency. At the upper edge it cuts off from 13 % inside the band. So less than 2 % of
 * the power of the widest resonance lies outside the band. */
static struct band band_of(double low_hz, double high_hz)
{
    double cut = low_hz - 0.5 * HTEX_GRID_HZ;
    struct band band = {low_hz, high_hz, cut, 0.87 * high_hz};
    if (cut < 0.5 * low_hz)
        band.pass_low_hz = 0.5 * low_hz;
    return band;
}

static double power_16(double x)
{
    for (int i = 0; i < 4; i++)
        x *= x;
    return x;
}

/* Returns the magnitude of the filters at a frequency, in any scale; 0 outside the band. */
static double shape_at(const double *p, struct band band, double f)
{
    if (!within(f, band.low_hz, band.high_hz))
        return 0.0;
    double detuned = (f / p[CENTRE] - p[CENTRE] / f) * p[CENTRE] / p[BANDWIDTH];
    double edges = (1.0 + power_16(band.pass_low_hz / f)) * (1.0 + power_16(f / band.pass_high_hz));
    return 1.0 / __builtin_sqrt((1.0 + detuned * detuned) * edges);
}

/* Returns the RMS of the shape on the grid; 0 if no multiple of 5 Hz lies in the band. */
static double shape_rms(const double *p, struct band band)
{
    double power = 0.0;
    uint64_t first = (uint64_t)(band.low_hz / HTEX_GRID_HZ);
    uint64_t last = (uint64_t)(band.high_hz / HTEX_GRID_HZ);
    for (uint64_t bin = first; bin <= last; bin++) {
        double m = shape_at(p, band, (double)bin * HTEX_GRID_HZ);
        power += m * m;
    }
    return __builtin_sqrt(power / 3.0);
}

/* ---- fit ---- */

enum { SHAPE = 2 /* parameters of the resonance */ };

struct spectrum { const double *hz, *magnitude; size_t bins; double largest; };

/* Returns the squared distance of the best scaled shape to the spectrum, divided by the square
 * of the spectrum. */
static double misfit(const double *p, struct band band, struct spectrum s)
{
    double hm = 0.0, hh = 0.0, mm = 0.0;
    for (size_t i = 0; i < s.bins; i++) {
        double h = shape_at(p, band, s.hz[i]), m = s.magnitude[i] / s.largest;
        hm += h * m;
        hh += h * h;
        mm += m * m;
    }
    return hh > 0.0 && mm > 0.0 ? 1.0 - hm * hm / (hh * mm) : 1.0;
}

/* Tries one step from `p`. Keeps the step if the fit is better. */
static int try_step(double *p, double *best, int field, double factor, struct band band,
                    struct spectrum s)
{
    double at[SHAPE] = {p[CENTRE], p[BANDWIDTH]};
    at[field] = clamp(at[field] * factor, MIN[field], MAX[field]);
    /* The centre stays inside the band, because an asset rounds its numbers, and because a
     * resonance at the upper edge would have half of its power outside. */
    at[CENTRE] = clamp(at[CENTRE], band.low_hz * 1.0001, band.high_hz * 0.9);
    double value = misfit(at, band, s);
    if (!(value < *best))
        return 0;
    *best = value;
    p[CENTRE] = at[CENTRE];
    p[BANDWIDTH] = at[BANDWIDTH];
    return 1;
}

/* Searches from the best point of a coarse grid, by steps that are halved until they are 0.01 %. */
static void search(double *p, struct band band, struct spectrum s)
{
    double best = 2.0;
    double middle = __builtin_sqrt(band.low_hz * band.high_hz);
    p[CENTRE] = clamp(middle, MIN[CENTRE], MAX[CENTRE]);
    p[BANDWIDTH] = 100.0;
    for (double hz = band.low_hz; hz < band.high_hz; hz *= 1.2)
        for (double width = 20.0; width < 2000.0; width *= 2.0) {
            double at[SHAPE] = {clamp(hz, MIN[CENTRE], MAX[CENTRE]), width};
            double value = 2.0;
            if (try_step(at, &value, CENTRE, 1.0, band, s) && value < best) {
                best = value;
                p[CENTRE] = at[CENTRE];
                p[BANDWIDTH] = at[BANDWIDTH];
            }
        }
    for (double step = 1.2; step > 1.0001;) {
        int better = 0;
        for (int field = 0; field < SHAPE; field++)
            better |= try_step(p, &best, field, step, band, s)
                      || try_step(p, &best, field, 1.0 / step, band, s);
        if (!better)
            step = __builtin_sqrt(step);
    }
}

#endif
