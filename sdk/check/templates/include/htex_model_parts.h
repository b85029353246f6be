/* htex_model_parts.h: common parts of models in C: the text of the last error, checks of arguments, second-order sections
 * and white noise. They call no C library, and compilers for any processor give the same numbers. C11 and C++11.
 *
 * Not part of the ABI: a model may use other code. Include it in one file of the model.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef HTEX_MODEL_PARTS_H
#define HTEX_MODEL_PARTS_H

#include "htex_model.h"

/* ---- errors ---- */

#ifdef __cplusplus
static thread_local const char *last_error = "";
#else
static _Thread_local const char *last_error = "";
#endif

static inline int64_t fail(int64_t status, const char *text)
{
    last_error = text;
    return status;
}

static inline int64_t copy_text(const char *text, uint8_t *out, size_t capacity)
{
    size_t len = 0;
    for (; text[len] != 0; len++)
        if (len < capacity)
            out[len] = (uint8_t)text[len];
    return (int64_t)len;
}

/* ---- checks of arguments ---- */

/* Whether `len` numbers of `size` bytes can stand at `pointer`. */
static inline int usable(const void *pointer, size_t len, size_t size)
{
    return len == 0 || (pointer != NULL && (uintptr_t)pointer % size == 0 && len <= PTRDIFF_MAX / size);
}

static inline int within(double x, double low, double high)
{
    return x >= low && x <= high; /* NaN is not */
}

static inline double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

static inline int64_t check_band(double low_hz, double high_hz)
{
    if (low_hz > 0.0 && low_hz < high_hz && high_hz <= HTEX_MAX_BAND_HZ)
        return HTEX_OK;
    return fail(HTEX_INVALID_ARGUMENT, "band: 0 < low < high <= 1 MHz is allowed");
}

static inline int64_t check_rate(double rate_hz)
{
    if (within(rate_hz, HTEX_MIN_RATE_HZ, HTEX_MAX_RATE_HZ))
        return HTEX_OK;
    return fail(HTEX_INVALID_ARGUMENT, "rate: 1 Hz to 10 MHz is allowed");
}

static inline int64_t check_spectrum(const double *hz, const double *magnitude, size_t bins)
{
    if (!usable(hz, bins, sizeof *hz) || !usable(magnitude, bins, sizeof *magnitude))
        return fail(HTEX_INVALID_ARGUMENT, "`frequency_hz` or `magnitude` is not a usable array");
    if (bins < HTEX_MIN_BINS)
        return fail(HTEX_INVALID_ARGUMENT, "a spectrum needs three bins or more");
    for (size_t i = 0; i < bins; i++) {
        if (!within(hz[i], -1e300, 1e300) || (i > 0 && hz[i] <= hz[i - 1]))
            return fail(HTEX_INVALID_ARGUMENT, "`frequency_hz` does not ascend");
        if (!within(magnitude[i], 0.0, 1e300))
            return fail(HTEX_INVALID_ARGUMENT, "`magnitude` is negative or not finite");
    }
    return HTEX_OK;
}

static inline int64_t check_signal(const double *signal, size_t len, double rate_hz)
{
    if (!usable(signal, len, sizeof *signal))
        return fail(HTEX_INVALID_ARGUMENT, "`signal` is not a usable array");
    for (size_t i = 0; i < len; i++)
        if (!within(signal[i], -1e300, 1e300))
            return fail(HTEX_INVALID_ARGUMENT, "`signal` is not finite");
    return len == 0 ? HTEX_OK : check_rate(rate_hz);
}

/* ---- filters and noise ---- */

struct biquad { double b0, b1, b2, a1, a2, s1, s2; };

/* Smaller state is set to zero, so that no processor meets slow subnormal numbers. */
static inline double without_subnormals(double x)
{
    return within(x, -1e-30, 1e-30) ? 0.0 : x;
}

/* tan of an angle from 0 to 0.45 pi, by the series of sine and cosine. */
static inline double tangent(double x)
{
    double sine = 0.0, cosine = 0.0, term = 1.0;
    for (int n = 0; n < 26; n += 2) {
        cosine += term;
        term *= x / (n + 1);
        sine += term;
        term *= -x / (n + 2);
    }
    return sine / cosine;
}

/* A section by the bilinear transform; `numerator` weighs 1, s and s^2 over the corner. */
static inline struct biquad section(double corner_hz, double q, double rate_hz, const double numerator[3])
{
    double t = tangent(3.14159265358979323846 * corner_hz / rate_hz);
    double norm = 1.0 / (1.0 + t / q + t * t);
    double low = numerator[0] * t * t, mid = numerator[1] * t / q, high = numerator[2];
    struct biquad s;
    s.b0 = (low + mid + high) * norm;
    s.b1 = 2.0 * (low - high) * norm;
    s.b2 = (low - mid + high) * norm;
    s.a1 = 2.0 * (t * t - 1.0) * norm;
    s.a2 = (1.0 - t / q + t * t) * norm;
    s.s1 = s.s2 = 0.0;
    return s;
}

static inline double tick(struct biquad *f, double x)
{
    double y = f->b0 * x + f->s1;
    f->s1 = without_subnormals(f->b1 * x - f->a1 * y + f->s2);
    f->s2 = without_subnormals(f->b2 * x - f->a2 * y);
    return y;
}

/* White noise of unit variance (splitmix64; uniform, which filters make Gaussian). */
static inline double noise(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return ((double)(z >> 11) * 1.1102230246251565e-16 - 0.5) * 3.4641016151377544; /* 2^-53, sqrt(12) */
}

#endif
