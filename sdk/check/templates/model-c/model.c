/* {{LABEL}}: initially one resonance. The model plays white noise through a two-pole band-pass
 * filter, so its spectrum is 1 / sqrt(1 + ((f/centre - centre/f) centre/bandwidth)^2).
 *
 * This file needs only htex_model.h and htex_motion_1.h. It uses no C library, so that the native
 * library and the WASM module can be built from it and have the same samples. See build.sh.
 */
#include <stdatomic.h>

#include "htex_model.h"
#include "htex_model_parts.h"
#include "htex_model_wasm.h"
#include "htex_motion_1.h"

/* 1: the host passes the finger's motion to the voice (extension htex.motion/1), and the voice
 * follows it. The host then scales neither frequencies with the speed nor the level with the
 * force. 0: the host does both. */
#ifndef FOLLOWS_MOTION
#define FOLLOWS_MOTION 0
#endif

/* ---- the descriptor: what the model states about itself ---- */

enum { CENTRE, BANDWIDTH, PARAMETERS };

static const double MIN[PARAMETERS] = {5.0, 20.0}, MAX[PARAMETERS] = {2000.0, 2000.0};

static const char DESCRIPTOR[] =
    "{\"id\":\"{{ID}}\",\"name\":\"{{LABEL}}\",\"version\":\"1.0.0\","
    "\"summary\":\"{{LABEL}}: one resonance, where it lies and how wide it is.\","
    "\"fields\":["
    "{\"name\":\"centre_hz\",\"unit\":\"Hz\",\"kind\":{\"type\":\"scalar\"},"
    "\"min\":5,\"max\":2000,\"store\":{\"type\":\"f32\"},"
    "\"description\":\"Frequency of the resonance; lies in the band.\"},"
    "{\"name\":\"bandwidth_hz\",\"unit\":\"Hz\",\"kind\":{\"type\":\"scalar\"},"
    "\"min\":20,\"max\":2000,\"store\":{\"type\":\"f32\"},"
    "\"description\":\"Width between the points 3 dB below it.\"}],"
    "\"options\":[]}";

#include "resonance.h"

/* ---- checks ---- */

/* Checks one set of parameters, at `p`. */
static int64_t check_set(const double *p)
{
    if (!within(p[CENTRE], MIN[CENTRE], MAX[CENTRE]))
        return fail(HTEX_INVALID_PARAMETERS, "centre_hz: 5 to 2000 Hz is allowed");
    if (!within(p[BANDWIDTH], MIN[BANDWIDTH], MAX[BANDWIDTH]))
        return fail(HTEX_INVALID_PARAMETERS, "bandwidth_hz: 20 to 2000 Hz is allowed");
    return HTEX_OK;
}

static int64_t check_parameters(const double *p, size_t len)
{
    if (!usable(p, len, sizeof *p))
        return fail(HTEX_INVALID_ARGUMENT, "`parameters` is not a usable array");
    if (len != PARAMETERS)
        return fail(HTEX_INVALID_PARAMETERS, "two parameters are wanted: centre_hz, bandwidth_hz");
    return check_set(p);
}

/* Checks the parameters, and that they have a spectrum in the band. */
static int64_t check_shape(const double *p, size_t len, double low_hz, double high_hz)
{
    int64_t status = check_parameters(p, len);
    if (status == HTEX_OK)
        status = check_band(low_hz, high_hz);
    if (status == HTEX_OK && !within(p[CENTRE], low_hz, high_hz))
        status = fail(HTEX_INVALID_PARAMETERS, "centre_hz lies outside the band: move it in");
    return status;
}

/* ---- voices ---- */

enum { EDGE_SECTIONS = 4, VOICES = 256 };

/* The resonance. Its noise is scaled so that the output has unit RMS. */
struct tone { struct biquad filter; double gain; };

struct voice {
    struct band band;
    double rate_hz;
    uint64_t random;
    struct tone now, next, pending;
    int fading, waiting;
    double faded, fade_frames;
    /* The current level of the texture, and its target, which the level reaches within 10 ms. */
    double level, goal;
    struct biquad low_cut[EDGE_SECTIONS], high_cut[EDGE_SECTIONS];
};

/* `generation` is odd while this slot has a voice. A handle contains the generation and the
 * slot's number. */
struct slot { atomic_flag taken; atomic_uint generation; struct voice voice; };

static struct slot slots[VOICES];

static struct slot *find(int64_t handle)
{
    uint64_t number = ((uint64_t)handle & 0xffffffff) - 1;
    if (handle <= 0 || number >= VOICES)
        return NULL;
    unsigned generation = atomic_load(&slots[number].generation);
    int live = generation % 2 == 1 && (generation & 0x7fffffff) == (uint64_t)handle >> 32;
    return live ? &slots[number] : NULL;
}

/* A bin of magnitude m has the power m^2 / 3. White noise of unit variance has the power 2 * 5
 * Hz / rate in each bin. So the noise is multiplied by sqrt(rate / 30) and divided by the
 * shape's RMS. */
static struct tone tone_of(const double *p, const struct voice *v)
{
    static const double band_pass[3] = {0.0, 1.0, 0.0};
    double w = 6.28318530717958647692 * p[CENTRE] / v->rate_hz, t = tangent(0.5 * w);
    /* The transform narrows bandwidths by sin(w)/w; sin(w) = 2t / (1 + t^2). */
    double q = p[CENTRE] / p[BANDWIDTH] * 2.0 * t / (1.0 + t * t) / w;
    struct tone tone = {
        .filter = section(p[CENTRE], q, v->rate_hz, band_pass),
        .gain = __builtin_sqrt(v->rate_hz / 30.0) / shape_rms(p, v->band),
    };
    return tone;
}

static void make_edges(struct voice *v)
{
    /* Butterworth, order 8: q = 1 / (2 sin((2k + 1) pi / 16)). */
    static const double q[EDGE_SECTIONS] = {2.5629154477415055, 0.89997622313641557,
                                            0.60134488693504529, 0.50979557910415918};
    static const double low_pass[3] = {1.0, 0.0, 0.0}, high_pass[3] = {0.0, 0.0, 1.0};
    for (int i = 0; i < EDGE_SECTIONS; i++) {
        v->low_cut[i] = section(v->band.pass_low_hz, q[i], v->rate_hz, high_pass);
        v->high_cut[i] = section(v->band.pass_high_hz, q[i], v->rate_hz, low_pass);
    }
}

/* Begins to fade to the waiting resonance. It takes over the filter's state, so that there is no
 * click and no gap. */
static void begin_fade(struct voice *v)
{
    v->next = v->pending;
    v->next.filter.s1 = v->now.filter.s1;
    v->next.filter.s2 = v->now.filter.s2;
    v->waiting = 0;
    v->fading = 1;
    v->faded = 0.0;
}

static float next_sample(struct voice *v)
{
    if (v->waiting && !v->fading)
        begin_fade(v);
    double x = noise(&v->random), y = tick(&v->now.filter, x * v->now.gain);
    if (v->fading) {
        v->faded += 1.0;
        y += (tick(&v->next.filter, x * v->next.gain) - y) * v->faded / v->fade_frames;
        if (v->faded >= v->fade_frames) {
            v->now = v->next;
            v->fading = 0;
        }
    }
    for (int i = 0; i < EDGE_SECTIONS; i++)
        y = tick(&v->high_cut[i], tick(&v->low_cut[i], y));
    v->level = without_subnormals(v->level + (v->goal - v->level) * 3.0 / v->fade_frames);
    y *= v->level;
    /* The smallest normal number of a float. */
    return within(y, -0x1p-126, 0x1p-126) ? 0.0f : (float)y;
}

static void start(struct voice *v, const double *p, uint64_t seed)
{
    v->random = seed * 0xd1342543de82ef95u + 1; /* apart from the step of noise() */
    v->fade_frames = 0.010 * v->rate_hz > 3.0 ? 0.010 * v->rate_hz : 3.0;
    v->fading = v->waiting = 0;
    v->level = v->goal = 1.0;
    v->now = tone_of(p, v);
    make_edges(v);
    /* Lets the filters settle before the first sample is played. */
    double settle = 4.0 * v->rate_hz / v->band.pass_low_hz;
    for (double n = settle < 65536.0 ? settle : 65536.0; n > 0.0; n -= 1.0)
        next_sample(v);
}

/* ---- the functions of the ABI ---- */

uint32_t htex_model_abi_version(void)
{
    return HTEX_ABI_MARKER;
}

int64_t htex_model_descriptor(uint8_t *out, size_t capacity)
{
    if (!usable(out, capacity, 1))
        return fail(HTEX_INVALID_ARGUMENT, "`out` is not a usable buffer");
    return copy_text(DESCRIPTOR, out, capacity);
}

int64_t htex_model_last_error(uint8_t *out, size_t capacity)
{
    return usable(out, capacity, 1) ? copy_text(last_error, out, capacity) : HTEX_INVALID_ARGUMENT;
}

int64_t htex_model_fit(double band_low_hz, double band_high_hz, const double *frequency_hz,
                       const double *magnitude, size_t bins, const double *signal,
                       size_t signal_len, double signal_rate_hz, const double *options,
                       size_t options_len, double *parameters, size_t capacity, double *level_rms)
{
    (void)options;
    int64_t status = check_band(band_low_hz, band_high_hz);
    if (status == HTEX_OK)
        status = check_spectrum(frequency_hz, magnitude, bins);
    if (status == HTEX_OK)
        status = check_signal(signal, signal_len, signal_rate_hz);
    if (status != HTEX_OK)
        return status;
    if (options_len != 0)
        return fail(HTEX_INVALID_OPTION, "this model has no fit options");
    if (!usable(parameters, capacity, sizeof *parameters) || !usable(level_rms, 1, sizeof *level_rms))
        return fail(HTEX_INVALID_ARGUMENT, "`parameters` or `level_rms` is not a usable buffer");
    struct band band = band_of(band_low_hz, band_high_hz);
    if (band_high_hz < MIN[CENTRE] || band_low_hz > MAX[CENTRE])
        return fail(HTEX_CANNOT_FIT, "the band lies outside 5 to 2000 Hz");
    struct spectrum s = {frequency_hz, magnitude, bins, 0.0};
    for (size_t i = 0; i < bins; i++)
        if (within(frequency_hz[i], band_low_hz, band_high_hz) && magnitude[i] > s.largest)
            s.largest = magnitude[i];
    if (s.largest == 0.0)
        return fail(HTEX_CANNOT_FIT, "the spectrum is silent: there is nothing to fit");
    double p[PARAMETERS], power = 0.0;
    search(p, band, s);
    for (size_t i = 0; i < bins; i++)
        if (within(frequency_hz[i], band_low_hz, band_high_hz))
            power += magnitude[i] / s.largest * (magnitude[i] / s.largest) / 3.0;
    *level_rms = s.largest * __builtin_sqrt(power);
    for (size_t i = 0; i < PARAMETERS && i < capacity; i++)
        parameters[i] = p[i];
    return PARAMETERS;
}

int64_t htex_model_magnitude(const double *parameters, size_t parameters_len, double band_low_hz,
                             double band_high_hz, const double *frequency_hz, double *magnitude,
                             size_t bins)
{
    int64_t status = check_shape(parameters, parameters_len, band_low_hz, band_high_hz);
    if (status != HTEX_OK)
        return status;
    if (!usable(frequency_hz, bins, sizeof *frequency_hz) || !usable(magnitude, bins, sizeof *magnitude))
        return fail(HTEX_INVALID_ARGUMENT, "`frequency_hz` or `magnitude` is not a usable array");
    struct band band = band_of(band_low_hz, band_high_hz);
    double rms = shape_rms(parameters, band);
    if (!(rms > 0.0))
        return fail(HTEX_INVALID_ARGUMENT, "band: no multiple of 5 Hz lies in it");
    for (size_t i = 0; i < bins; i++) {
        if (!within(frequency_hz[i], -1e300, 1e300))
            return fail(HTEX_INVALID_ARGUMENT, "`frequency_hz` is not finite");
        magnitude[i] = shape_at(parameters, band, frequency_hz[i]) / rms;
    }
    return HTEX_OK;
}

int64_t htex_model_interpolate(const double *sets, size_t sets_len, const double *weights,
                               size_t weights_len, double *parameters, size_t capacity)
{
    double sum = 0.0, mix[PARAMETERS] = {0.0};
    if (!usable(sets, sets_len, sizeof *sets) || !usable(weights, weights_len, sizeof *weights)
        || !usable(parameters, capacity, sizeof *parameters))
        return fail(HTEX_INVALID_ARGUMENT, "`sets`, `weights` or `parameters` is not usable");
    if (sets_len / PARAMETERS != weights_len || sets_len % PARAMETERS != 0)
        return fail(HTEX_INVALID_PARAMETERS, "two parameters are wanted for each weight");
    for (size_t n = 0; n < weights_len; n++) {
        const double *set = sets + n * PARAMETERS;
        if (!within(weights[n], 0.0, 1.0))
            return fail(HTEX_INVALID_ARGUMENT, "a weight lies outside 0 to 1");
        int64_t status = check_set(set);
        if (status != HTEX_OK)
            return status;
        sum += weights[n];
        for (int i = 0; i < PARAMETERS; i++)
            mix[i] += weights[n] * set[i];
    }
    if (!within(sum, 1.0 - 1e-6, 1.0 + 1e-6))
        return fail(HTEX_INVALID_ARGUMENT, "weights do not sum to 1");
    for (size_t i = 0; i < PARAMETERS && i < capacity; i++)
        parameters[i] = clamp(mix[i], MIN[i], MAX[i]);
    return PARAMETERS;
}

double htex_model_voice_rate(const double *parameters, size_t parameters_len, double band_low_hz,
                             double band_high_hz, double wanted_hz)
{
    int64_t status = check_shape(parameters, parameters_len, band_low_hz, band_high_hz);
    if (status == HTEX_OK)
        status = check_rate(wanted_hz);
    if (status != HTEX_OK)
        return (double)status;
    /* At least ten times the highest frequency of the band, where the filters are close to their
     * analogue models. The rate is a whole fraction or a whole multiple of the wanted one. */
    double least = clamp(10.0 * band_high_hz, HTEX_MIN_RATE_HZ, HTEX_MAX_RATE_HZ);
    if (wanted_hz >= least)
        return wanted_hz / (double)(uint64_t)(wanted_hz / least);
    return clamp(wanted_hz * (double)(1 + (uint64_t)(least / wanted_hz)), least, HTEX_MAX_RATE_HZ);
}

int64_t htex_model_voice_new(const double *parameters, size_t parameters_len, double band_low_hz,
                             double band_high_hz, double rate_hz, uint64_t seed)
{
    int64_t status = check_shape(parameters, parameters_len, band_low_hz, band_high_hz);
    if (status == HTEX_OK)
        status = check_rate(rate_hz);
    if (status != HTEX_OK)
        return status;
    struct band band = band_of(band_low_hz, band_high_hz);
    if (rate_hz < 2.3 * band.high_hz)
        return fail(HTEX_INVALID_ARGUMENT, "rate: too low for the band; ask htex_model_voice_rate");
    if (!(shape_rms(parameters, band) > 0.0))
        return fail(HTEX_INVALID_ARGUMENT, "band: no multiple of 5 Hz lies in it");
    for (int64_t i = 0; i < VOICES; i++) {
        struct slot *slot = &slots[i];
        if (atomic_flag_test_and_set(&slot->taken))
            continue;
        slot->voice.band = band;
        slot->voice.rate_hz = rate_hz;
        start(&slot->voice, parameters, seed);
        int64_t generation = (atomic_fetch_add(&slot->generation, 1) + 1) & 0x7fffffff;
        return generation << 32 | (i + 1);
    }
    return fail(HTEX_TOO_MANY_VOICES, "256 voices are in use; free some");
}

int64_t htex_model_voice_render(int64_t voice, float *out, size_t frames)
{
    struct slot *slot = find(voice);
    if (slot == NULL)
        return fail(HTEX_BAD_HANDLE, "no such voice; it may have been freed");
    if (!usable(out, frames, sizeof *out))
        return fail(HTEX_INVALID_ARGUMENT, "`out` is not a usable buffer");
    for (size_t i = 0; i < frames; i++)
        out[i] = next_sample(&slot->voice);
    return HTEX_OK;
}

int64_t htex_model_voice_retune(int64_t voice, const double *parameters, size_t parameters_len)
{
    struct slot *slot = find(voice);
    if (slot == NULL)
        return fail(HTEX_BAD_HANDLE, "no such voice; it may have been freed");
    struct voice *v = &slot->voice;
    int64_t status = check_shape(parameters, parameters_len, v->band.low_hz, v->band.high_hz);
    if (status != HTEX_OK)
        return status;
    v->pending = tone_of(parameters, v);
    v->waiting = 1;
    return HTEX_OK;
}

int64_t htex_model_voice_free(int64_t voice)
{
    struct slot *slot = find(voice);
    unsigned live = (unsigned)((uint64_t)voice >> 32);
    if (slot == NULL)
        return fail(HTEX_BAD_HANDLE, "no such voice; it may have been freed");
    unsigned generation = live | (atomic_load(&slot->generation) & 0x80000000u);
    if (!atomic_compare_exchange_strong(&slot->generation, &generation, generation + 1))
        return fail(HTEX_BAD_HANDLE, "no such voice; it may have been freed");
    atomic_flag_clear(&slot->taken);
    return HTEX_OK;
}

int64_t htex_model_extension(const uint8_t *id, size_t id_len)
{
#if FOLLOWS_MOTION
    static const char motion[] = "htex.motion/1";
    size_t same = 0;
    while (id != NULL && same < id_len && same < sizeof motion - 1 && id[same] == (uint8_t)motion[same])
        same++;
    return same == id_len && same == sizeof motion - 1;
#else
    (void)id;
    (void)id_len;
    return 0;
#endif
}

/* ---- the extension htex.motion/1 ---- */

#if FOLLOWS_MOTION

/* How the voice follows the motion. In this template, the level is proportional to the speed, up
 * to a factor of 4, and at 100 mm/s the texture plays as recorded. A model may also use position
 * and place, for example for a pattern that is fixed to the surface. */
int64_t htex_motion_1_set(int64_t voice, double speed_mm_s, double force_n, double position_mm, double x_mm,
                          double y_mm)
{
    struct slot *slot = find(voice);
    if (slot == NULL)
        return fail(HTEX_BAD_HANDLE, "no such voice; it may have been freed");
    if (!within(speed_mm_s, -HTEX_MOTION_1_MAX_SPEED_MM_S, HTEX_MOTION_1_MAX_SPEED_MM_S)
        || !within(force_n, 0.0, HTEX_MOTION_1_MAX_FORCE_N)
        || !within(position_mm, -HTEX_MOTION_1_MAX_POSITION_MM, HTEX_MOTION_1_MAX_POSITION_MM)
        || !within(x_mm, -HTEX_MOTION_1_MAX_POSITION_MM, HTEX_MOTION_1_MAX_POSITION_MM)
        || !within(y_mm, -HTEX_MOTION_1_MAX_POSITION_MM, HTEX_MOTION_1_MAX_POSITION_MM))
        return fail(HTEX_INVALID_ARGUMENT, "speed, force, position or place is not finite, or beyond its range");
    slot->voice.goal = clamp((speed_mm_s < 0.0 ? -speed_mm_s : speed_mm_s) / 100.0, 0.0, 4.0);
    return HTEX_OK;
}

/* NaN stands for an unknown speed or force. This model has no parameter that depends on them. */
int64_t htex_motion_1_fit(double band_low_hz, double band_high_hz, const double *frequency_hz,
                          const double *magnitude, size_t bins, const double *signal,
                          size_t signal_len, double signal_rate_hz, const double *options,
                          size_t options_len, double speed_mm_s, double force_n, double *parameters,
                          size_t capacity, double *level_rms)
{
    if (!(speed_mm_s != speed_mm_s || within(speed_mm_s, 0.0, HTEX_MOTION_1_MAX_SPEED_MM_S))
        || !(force_n != force_n || within(force_n, 0.0, HTEX_MOTION_1_MAX_FORCE_N)))
        return fail(HTEX_INVALID_ARGUMENT, "the recording's speed or force is negative or too large");
    return htex_model_fit(band_low_hz, band_high_hz, frequency_hz, magnitude, bins, signal, signal_len,
                          signal_rate_hz, options, options_len, parameters, capacity, level_rms);
}

#endif
