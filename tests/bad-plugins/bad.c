/* A valid model with one fault.
 *
 * Every call is passed to the library GOOD_LIBRARY (a native build of a model), except for the change by one
 * -DFAULT_…. Only the check of this fault must fail; the table of
 * faults and checks is in cli/tests/command/checker.rs.
 */
#include <dlfcn.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "htex_model.h"
#include "htex_motion_1.h"
#include "htex_voices_1.h"

static void *good_symbol(const char *name) {
    static void *library;
    if (!library) library = dlopen(GOOD_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    void *symbol = library ? dlsym(library, name) : NULL;
    if (!symbol) abort();
    return symbol;
}

/* The good model's function of the same name and type. */
#define GOOD(function) ((__typeof__(&function))good_symbol(#function))

/* Voices of the good model, and the state that a fault needs for each. Handles count up from 1 and
 * are never reused. */
struct voice {
    int64_t good;
    uint64_t rendered;
    int click;
    int told;
    int is_poisoned;
    const double *kept;
    /* Samples for which the level still falls after a retune, and by how much it is lower. */
    int dips;
    double dip;
};

/* Faults of the extension require a model that has it. */
#if defined FAULT_MOTION_MISSING || defined FAULT_ACCEPTS_MOTION || defined FAULT_ACCEPTS_PLACE || defined FAULT_MOTION_ALLOCATES \
    || defined FAULT_MOTION_BLOCKS
#define HAS_MOTION
#endif
#define VOICES 65536
static struct voice voices[VOICES];
static int64_t voices_made;

static struct voice *live(int64_t handle) {
    int known = handle > 0 && handle <= voices_made;
    return known && voices[handle - 1].good ? &voices[handle - 1] : NULL;
}

uint32_t htex_model_abi_version(void) {
#ifdef FAULT_MARKER
    return 0x48540900;
#else
    return GOOD(htex_model_abi_version)();
#endif
}

int64_t htex_model_descriptor(uint8_t *out, size_t capacity) {
#ifdef FAULT_DESCRIPTOR_JSON
    static const char text[] = "{\"id\": \"org.example.bad\", \"fields\": [";
#elif defined FAULT_DESCRIPTOR_DEFAULT || defined FAULT_DESCRIPTOR_SWEEP || defined FAULT_DESCRIPTOR_USUAL
#if defined FAULT_DESCRIPTOR_SWEEP
#define USUAL ""
#define OPTION "\"default\":0,\"sweep\":[0.5,2]"
#elif defined FAULT_DESCRIPTOR_USUAL
#define USUAL "\"usual\":{\"min\":0,\"max\":1,\"scale\":\"log\"},"
#define OPTION "\"default\":0"
#else
#define USUAL ""
#define OPTION "\"default\":2"
#endif
    static const char text[] =
        "{\"id\":\"org.example.bad\",\"name\":\"Bad\",\"version\":\"1.0.0\",\"summary\":\"Bad.\","
        "\"fields\":[{\"name\":\"a\",\"unit\":\"1\",\"kind\":{\"type\":\"scalar\"},\"min\":0,"
        "\"max\":1," USUAL "\"store\":{\"type\":\"f32\"},\"description\":\"A.\"}],"
        "\"options\":[{\"name\":\"o\",\"unit\":\"1\",\"min\":0,\"max\":1," OPTION ","
        "\"description\":\"O.\"}]}";
#elif defined FAULT_STORE
    /* The descriptor of the good model, with a store of 0 to 255 millionths, below the least alpha. */
#define SHAPE(name)                                                                              \
    "{\"name\":\"" name "\",\"unit\":\"1\",\"kind\":{\"type\":\"scalar\"},\"min\":0.001,"        \
    "\"max\":1000000,\"store\":{\"type\":\"u8\",\"scale\":1e-6,\"offset\":0},"                   \
    "\"description\":\"Shape.\"}"
#define OPTION(name, min, max, value)                                                            \
    "{\"name\":\"" name "\",\"unit\":\"1\",\"min\":" min ",\"max\":" max ",\"default\":" value   \
    ",\"description\":\"Option.\"}"
    static const char text[] =
        "{\"id\":\"org.example.bad\",\"name\":\"Bad\",\"version\":\"1.0.0\",\"summary\":\"Bad.\","
        "\"fields\":[" SHAPE("alpha") "," SHAPE("beta") "],\"options\":["
        OPTION("points", "3", "64", "10") "," OPTION("jnd", "0", "1", "0.12") ","
        OPTION("lower_bound", "0", "1", "0.5") "," OPTION("error", "0", "1", "0") ","
        OPTION("bins", "0", "64", "20") "," OPTION("refit", "0", "1", "0") "]}";
#endif
#if defined FAULT_DESCRIPTOR_JSON || defined FAULT_DESCRIPTOR_DEFAULT || defined FAULT_DESCRIPTOR_SWEEP \
    || defined FAULT_DESCRIPTOR_USUAL || defined FAULT_STORE
    size_t len = sizeof text - 1;
    if (capacity && !out) return HTEX_INVALID_ARGUMENT;
    if (capacity) memcpy(out, text, capacity < len ? capacity : len);
    return (int64_t)len;
#else
    return GOOD(htex_model_descriptor)(out, capacity);
#endif
}

#ifdef FAULT_NO_REASON
static int is_silent; /* the last retune had no parameters */
#endif

int64_t htex_model_last_error(uint8_t *out, size_t capacity) {
#ifdef FAULT_NO_REASON
    if (is_silent && (out || !capacity)) return 0;
#endif
    return GOOD(htex_model_last_error)(out, capacity);
}

int64_t htex_model_fit(double band_low_hz, double band_high_hz, const double *frequency_hz,
                       const double *magnitude, size_t bins, const double *signal,
                       size_t signal_len, double signal_rate_hz, const double *options,
                       size_t options_len, double *parameters, size_t capacity, double *level_rms) {
#ifdef FAULT_FIT_CRASHES
    abort();
#elif defined FAULT_ACCEPTS_SPECTRUM
    /* A negative magnitude is taken for 0. */
    double zeroed[256];
    for (size_t i = 0; magnitude && i < bins && i < 256; i++) zeroed[i] = magnitude[i] < 0 ? 0 : magnitude[i];
    if (magnitude) magnitude = zeroed;
#elif defined FAULT_CAPACITY
    double whole[64];
    int64_t len = GOOD(htex_model_fit)(band_low_hz, band_high_hz, frequency_hz, magnitude, bins, signal, signal_len,
                                       signal_rate_hz, options, options_len, whole, 64, level_rms);
    for (int64_t i = 0; parameters && i < len; i++) parameters[i] = whole[i];
    if (parameters) return len;
#endif
    int64_t answer = GOOD(htex_model_fit)(band_low_hz, band_high_hz, frequency_hz, magnitude, bins,
                                          signal, signal_len, signal_rate_hz, options, options_len,
                                          parameters, capacity, level_rms);
#ifdef FAULT_FIT_RANGE
    if (answer > 0 && capacity) parameters[0] = -1;
#endif
#ifdef FAULT_FIT_HARD
    if (answer == HTEX_CANNOT_FIT) abort();
#elif defined FAULT_FIT_SIGNAL
    if (answer > 0 && signal_len) return HTEX_FAILED;
#elif defined FAULT_FIT_STATUS
    if (answer == HTEX_CANNOT_FIT) return HTEX_INVALID_ARGUMENT;
#elif defined FAULT_CAPACITY_LENGTH
    if (answer > (int64_t)capacity) return (int64_t)capacity;
#endif
    return answer;
}

/* Replaces NaN in the parameters, for the fault that accepts it. */
static const double *tolerant(const double *parameters, size_t len) {
#ifdef FAULT_ACCEPTS_NAN
    static const double usual[] = {2, 5};
    for (size_t i = 0; parameters && i < len; i++)
        if (isnan(parameters[i])) return usual;
#endif
    (void)len;
    return parameters;
}

int64_t htex_model_magnitude(const double *parameters, size_t parameters_len, double band_low_hz,
                             double band_high_hz, const double *frequency_hz, double *magnitude,
                             size_t bins) {
    parameters = tolerant(parameters, parameters_len);
#ifdef FAULT_ACCEPTS_BAND
    if (!(band_low_hz < band_high_hz)) band_low_hz = 20, band_high_hz = 1000;
#endif
#ifdef FAULT_SPECTRUM
    /* The shape of parameters other than those that are played. */
    if (!parameters) return HTEX_INVALID_ARGUMENT;
    double other[] = {parameters_len ? parameters[0] + 2 : 0, parameters_len > 1 ? parameters[1] : 0};
    if (parameters_len == 2) parameters = other;
#endif
#ifdef FAULT_ACCEPTS_NULL
    if (bins && !magnitude) return HTEX_OK;
#elif defined FAULT_BOUND_REFUSED
    if (parameters && parameters_len == 2 && parameters[0] == 0.001) return HTEX_INVALID_PARAMETERS;
#endif
    int64_t answer = GOOD(htex_model_magnitude)(parameters, parameters_len, band_low_hz,
                                                band_high_hz, frequency_hz, magnitude, bins);
#ifdef FAULT_PARAMETERS_STATUS
    if (answer == HTEX_INVALID_PARAMETERS && parameters_len != 2) return HTEX_FAILED;
#elif defined FAULT_MAGNITUDE_BEYOND
    if (answer == 0) magnitude[bins] = 1;
#elif defined FAULT_MAGNITUDE_ANSWERS_ONE
    if (answer == 0) answer = 1;
#endif
    for (size_t i = 0; answer == 0 && i < bins; i++) {
#ifdef FAULT_MAGNITUDE_NAN
        if (i == bins / 2) magnitude[i] = NAN;
#elif defined FAULT_MAGNITUDE_NEGATIVE
        if (i == bins / 2) magnitude[i] = -magnitude[i] - 1e-3;
#elif defined FAULT_MAGNITUDE_OUTSIDE
        if (frequency_hz[i] > band_high_hz) magnitude[i] = 1e-3;
#elif defined FAULT_MAGNITUDE_GRID
        if (bins == 1) magnitude[i] *= 1.5;
#elif defined FAULT_MAGNITUDE_LEVEL
        magnitude[i] *= 2;
#endif
    }
    return answer;
}

int64_t htex_model_interpolate(const double *sets, size_t sets_len, const double *weights,
                               size_t weights_len, double *parameters, size_t capacity) {
#ifdef FAULT_INTERPOLATE_ENDS
    double even[] = {0.5, 0.5};
    if (weights && weights_len == 2 && (weights[0] == 1 || weights[1] == 1)) weights = even;
#elif defined FAULT_ACCEPTS_WEIGHTS
    double scaled[2];
    if (weights && weights_len == 2 && weights[0] > 0 && weights[1] > 0) {
        scaled[0] = weights[0] / (weights[0] + weights[1]), scaled[1] = 1 - scaled[0];
        weights = scaled;
    }
#elif defined FAULT_INTERPOLATE_LAST_BIT
    int64_t answer = GOOD(htex_model_interpolate)(sets, sets_len, weights, weights_len, parameters, capacity);
    if (answer > 0 && capacity && weights[0] == 1) parameters[0] = nextafter(parameters[0], 1);
    return answer;
#endif
    return GOOD(htex_model_interpolate)(sets, sets_len, weights, weights_len, parameters, capacity);
}

double htex_model_voice_rate(const double *parameters, size_t parameters_len, double band_low_hz,
                             double band_high_hz, double wanted_hz) {
#ifdef FAULT_ACCEPTS_RATE
    if (wanted_hz > 1e7) wanted_hz = 20000;
#endif
    return GOOD(htex_model_voice_rate)(tolerant(parameters, parameters_len), parameters_len,
                                       band_low_hz, band_high_hz, wanted_hz);
}

/* Stores the last leaked pointer, so that a compiler does not remove the allocation. */
static void *volatile kept;

#ifdef FAULT_SHARED_STATE
static uint64_t shared;
#endif

int64_t htex_model_voice_new(const double *parameters, size_t parameters_len, double band_low_hz,
                             double band_high_hz, double rate_hz, uint64_t seed) {
#ifdef FAULT_SEED_IGNORED
    seed = 1;
#elif defined FAULT_NOT_REPRODUCIBLE
    static uint64_t calls;
    seed += calls++;
#elif defined FAULT_SHARED_STATE
    shared = 0;
#elif defined FAULT_BAND_IGNORED
    if (band_low_hz == 150) band_low_hz = 20, band_high_hz = 1000;
#endif
    if (voices_made >= VOICES) return HTEX_TOO_MANY_VOICES;
    int64_t good = GOOD(htex_model_voice_new)(tolerant(parameters, parameters_len), parameters_len,
                                              band_low_hz, band_high_hz, rate_hz, seed);
    if (good < 0) return good;
#ifdef FAULT_VOICES_LEAK
    kept = memset(malloc(65536), 1, 65536);
#endif
    int64_t handle = __atomic_add_fetch(&voices_made, 1, __ATOMIC_SEQ_CST);
    voices[handle - 1] = (struct voice){.good = good, .kept = parameters};
#ifdef FAULT_BOUND_NAN
    voices[handle - 1].is_poisoned = parameters_len == 2 && parameters[1] == 0.001;
#elif defined FAULT_SEEDED_NAN
    /* Between what is fitted to the references and the ends of the ranges. */
    for (int i = 0; parameters_len == 2 && i < 2; i++)
        voices[handle - 1].is_poisoned |= parameters[i] > 100 && parameters[i] < 900000;
#endif
    return handle;
}

int64_t htex_model_voice_render(int64_t handle, float *out, size_t frames) {
    struct voice *voice = live(handle);
#ifdef FAULT_FREED_HANDLE
    if (!voice && handle > 0 && handle <= voices_made) return HTEX_OK;
#endif
    if (!voice) return HTEX_BAD_HANDLE;
#ifdef FAULT_EMPTY_BLOCKS
    float skipped;
    if (!frames) return GOOD(htex_model_voice_render)(voice->good, &skipped, 1);
#elif defined FAULT_FUZZ_CRASHES
    /* A mix of blocks that only the fuzzer plays. */
    static size_t before;
    if (frames == 2 && before == 4096) abort();
    before = frames;
#elif defined FAULT_RENDER_WAITS
    usleep(100);
#elif defined FAULT_RENDER_WRITES
    static int null_device;
    if (!null_device) null_device = open("/dev/null", O_WRONLY);
    if (write(null_device, "x", 1) != 1) return HTEX_FAILED;
#endif
#ifdef FAULT_RENDER_LOOPS
    for (volatile int forever = 1; forever;) {}
#elif defined FAULT_RENDER_CRASHES
    abort();
#endif
    int64_t answer = GOOD(htex_model_voice_render)(voice->good, out, frames);
    if (answer < 0) return answer;
#ifdef FAULT_RENDER_ANSWERS_ONE
    answer = 1;
#elif defined FAULT_RENDER_BEYOND
    out[frames] = 9;
#elif defined FAULT_RENDER_FAR_BEYOND
    out[frames + 100000] = 9;
#elif defined FAULT_KEEPS_PARAMETERS
    /* Reads what was lent for another call. */
    if (voice->rendered < 64 && frames && voice->kept && isnan(*voice->kept)) out[0] += 1e-3f;
#endif
    for (size_t i = 0; i < frames; i++, voice->rendered++) {
#ifdef FAULT_LEVEL
        out[i] *= 2;
#elif defined FAULT_SUBNORMAL
        if (voice->rendered % 997 == 0) out[i] = 1e-40f;
#elif defined FAULT_NOT_FINITE
        if (voice->rendered % 997 == 0) out[i] = NAN;
#elif defined FAULT_BLOCKS
        if (i == 0) out[i] += 1e-3f;
#elif defined FAULT_SHARED_STATE
        out[i] += 1e-3f * (float)(__atomic_fetch_add(&shared, 1, __ATOMIC_SEQ_CST) % 97);
#endif
#ifdef FAULT_MOTION_BLOCKS
        if (voice->told && i == 0) out[i] += 1e-3f;
#endif
        if (voice->is_poisoned) out[i] = NAN;
        voice->dip += ((voice->dips > 0 ? 0.4 : 0) - voice->dip) / 200;
        voice->dips -= voice->dips > 0;
        out[i] *= (float)(1 - voice->dip);
        if (voice->click) out[i] += 30, voice->click = 0;
    }
#ifdef FAULT_LEAK
    /* Pages from the system, which are not counted as calls of the allocator. */
    kept = mmap(NULL, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (kept != MAP_FAILED) memset(kept, 1, 4096);
#elif defined FAULT_RENDER_ALLOCATES
    kept = malloc(1024);
    free(kept);
#endif
    return answer;
}

#ifndef FAULT_EXPORT_MISSING
int64_t htex_model_voice_retune(int64_t handle, const double *parameters, size_t parameters_len) {
    struct voice *voice = live(handle);
    if (!voice) return HTEX_BAD_HANDLE;
#ifdef FAULT_NO_REASON
    is_silent = parameters_len == 0;
#endif
#ifdef FAULT_RETUNE_IGNORED
    /* Checks the parameters, and keeps the old ones. */
    double hz = 100, magnitude;
    int64_t answer = GOOD(htex_model_magnitude)(parameters, parameters_len, 20, 1000, &hz, &magnitude, 1);
#else
    int64_t answer = GOOD(htex_model_voice_retune)(voice->good, tolerant(parameters, parameters_len),
                                                   parameters_len);
#endif
#ifdef FAULT_RETUNE_ALLOCATES
    kept = strdup("parameters");
    free(kept);
#endif
#ifdef FAULT_CLICK
    if (answer == 0) voice->click = 1;
#elif defined FAULT_RETUNE_DIPS
    if (answer == 0) voice->dips = 100;
#endif
    return answer;
}
#endif

int64_t htex_model_voice_free(int64_t handle) {
    struct voice *voice = live(handle);
    if (!voice) return HTEX_BAD_HANDLE;
    int64_t good = voice->good;
    voice->good = 0;
    return GOOD(htex_model_voice_free)(good);
}

int64_t htex_model_extension(const uint8_t *id, size_t id_len) {
#ifdef FAULT_EXTENSIONS
    return id != NULL;
#else
#ifdef HAS_MOTION
    static const char motion[] = "htex.motion/1";
    if (id_len == sizeof motion - 1 && memcmp(id, motion, id_len) == 0) return 1;
#endif
    return GOOD(htex_model_extension)(id, id_len);
#endif
}

#ifndef FAULT_EXTENSION_MISSING
int64_t htex_voices_1_render(const int64_t *handles, size_t count, float *out, size_t frames) {
    if (count > 16) return HTEX_INVALID_ARGUMENT;
    for (size_t i = 0; i < count; i++) {
        if (!live(handles[i])) return HTEX_BAD_HANDLE;
#ifndef FAULT_TOGETHER_TWICE
        for (size_t k = 0; k < i; k++)
            if (handles[k] == handles[i]) return HTEX_INVALID_ARGUMENT;
#endif
    }
    for (size_t i = 0; i < count; i++) {
        int64_t answer = htex_model_voice_render(handles[i], out + i * frames, frames);
        if (answer < 0) return answer;
    }
#ifdef FAULT_TOGETHER
    /* The last of many voices is one sample late. */
    if (count > 8 && frames > 1)
        memmove(out + (count - 1) * frames + 1, out + (count - 1) * frames, (frames - 1) * sizeof *out);
#endif
    return 0;
}
#endif

#ifndef FAULT_MOTION_MISSING
/* The good model ignores motions. */
int64_t htex_motion_1_set(int64_t handle, double speed_mm_s, double force_n, double position_mm, double x_mm,
                          double y_mm) {
    struct voice *voice = live(handle);
    if (!voice) return HTEX_BAD_HANDLE;
#ifndef FAULT_ACCEPTS_MOTION
    if (!(fabs(speed_mm_s) <= HTEX_MOTION_1_MAX_SPEED_MM_S)) return HTEX_INVALID_ARGUMENT;
    if (!(fabs(position_mm) <= HTEX_MOTION_1_MAX_POSITION_MM)) return HTEX_INVALID_ARGUMENT;
#ifndef FAULT_ACCEPTS_PLACE
    if (!(fabs(x_mm) <= HTEX_MOTION_1_MAX_POSITION_MM)) return HTEX_INVALID_ARGUMENT;
    if (!(fabs(y_mm) <= HTEX_MOTION_1_MAX_POSITION_MM)) return HTEX_INVALID_ARGUMENT;
#endif
    if (!(force_n >= 0 && force_n <= HTEX_MOTION_1_MAX_FORCE_N)) return HTEX_INVALID_ARGUMENT;
#endif
#ifdef FAULT_MOTION_ALLOCATES
    kept = strdup("motion");
    free(kept);
#elif defined FAULT_MOTION_BLOCKS
    voice->told = 1;
#endif
    return HTEX_OK;
}
#endif

int64_t htex_motion_1_fit(double band_low_hz, double band_high_hz, const double *frequency_hz,
                          const double *magnitude, size_t bins, const double *signal, size_t signal_len,
                          double signal_rate_hz, const double *options, size_t options_len,
                          double speed_mm_s, double force_n, double *parameters, size_t capacity,
                          double *level_rms) {
    if (speed_mm_s < 0 || force_n < 0 || isinf(speed_mm_s) || isinf(force_n)) return HTEX_INVALID_ARGUMENT;
    return htex_model_fit(band_low_hz, band_high_hz, frequency_hz, magnitude, bins, signal, signal_len,
                          signal_rate_hz, options, options_len, parameters, capacity, level_rms);
}
