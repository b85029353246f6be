/* Ridges: a simulated finger that slides to and fro over parallel ridges.
 *
 * The force across the ridges follows the finger's position, so that ridges of 0.8 mm at 80 mm/s are
 * felt at 100 Hz. With pace=real frames come at their rate, and those that nobody reads for ten
 * seconds are lost: the next read fails. With pace=fast they come as fast as they are read.
 */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "htex_device.h"

enum { CHANNELS = 3, INPUTS = 16, KEPT_S = 10 };

static const double PI = 3.14159265358979323846;
static const double STROKE_MM = 60, FRICTION = 0.5, RIPPLE = 0.2;

#define NUMBER(name, min, max, value, text)                                                      \
    "{\"name\":\"" name "\",\"kind\":{\"type\":\"number\",\"min\":" min ",\"max\":" max "},"     \
    "\"default\":\"" value "\",\"description\":\"" text "\"}"

static const char descriptor[] =
    "{\"id\":\"org.example.ridges\",\"name\":\"Ridges\",\"version\":\"1.0.0\","
    "\"summary\":\"Simulates a finger on parallel ridges.\",\"direction\":\"input\",\"target\":\"spacing_mm\",\"settings\":["
    NUMBER("spacing_mm", "0.01", "10", "1", "From ridge to ridge.") ","
    NUMBER("speed_mm_s", "1", "1000", "80", "Speed of the finger.") ","
    NUMBER("force_n", "0.01", "10", "0.4", "Force of the finger.") ","
    NUMBER("rate_hz", "100", "100000", "5000", "Frames a second.") ","
    NUMBER("seconds", "0", "86400", "0", "Time after which the input ends; 0: never.") ","
    "{\"name\":\"pace\",\"kind\":{\"type\":\"choice\",\"values\":[\"real\",\"fast\"]},"
    "\"default\":\"real\",\"description\":\"Whether frames come at their rate.\"}]}";

/* ---- errors and texts ---- */

static _Thread_local char last_error[512];

static int64_t fail(int64_t status, const char *before, const char *text) {
    snprintf(last_error, sizeof last_error, "%s%s", before, text);
    return status;
}

/* Whether `len` values of `size` bytes can stand at `pointer`. */
static int usable(const void *pointer, size_t len, size_t size) {
    return !len || (pointer && (uintptr_t)pointer % size == 0);
}

static int64_t give(const char *text, uint8_t *out, size_t capacity) {
    size_t len = strlen(text);
    if (!usable(out, capacity, 1)) return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "`out` is not usable");
    if (capacity) memcpy(out, text, len < capacity ? len : capacity);
    return (int64_t)len;
}

static int64_t device_descriptor(uint8_t *out, size_t capacity) {
    return give(descriptor, out, capacity);
}

static int64_t device_last_error(uint8_t *out, size_t capacity) {
    return give(last_error, out, capacity);
}

static int64_t device_endpoints(uint8_t *out, size_t capacity) {
    return give("[{\"name\":\"1\",\"setting\":\"spacing_mm\",\"summary\":\"coarse ridges\"}]", out,
                capacity);
}

static int64_t device_extension(const uint8_t *id, size_t id_len) {
    (void)id, (void)id_len;
    return 0;
}

/* ---- settings ---- */

struct settings {
    double spacing_mm, speed_mm_s, force_n, rate_hz, seconds;
    int is_fast;
};

static int number(const char *text, double min, double max, double *out) {
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= min && value <= max)) return 0;
    *out = value;
    return 1;
}

static int64_t set(struct settings *all, const char *name, const char *value) {
    int is_fast = !strcmp(value, "fast");
    if (!strcmp(name, "pace") && (is_fast || !strcmp(value, "real"))) {
        all->is_fast = is_fast;
        return 0;
    }
    if ((!strcmp(name, "spacing_mm") && number(value, 0.01, 10, &all->spacing_mm)) ||
        (!strcmp(name, "speed_mm_s") && number(value, 1, 1000, &all->speed_mm_s)) ||
        (!strcmp(name, "force_n") && number(value, 0.01, 10, &all->force_n)) ||
        (!strcmp(name, "rate_hz") && number(value, 100, 100000, &all->rate_hz)) ||
        (!strcmp(name, "seconds") && number(value, 0, 86400, &all->seconds)))
        return 0;
    return fail(HTEX_DEVICE_INVALID_SETTING, name, ": not known, or not usable");
}

/* The bit of a setting, by which a second line is found; 0 of an unknown one, which is refused anyway. */
static unsigned bit_of(const char *name) {
    static const char *const names[] = {"spacing_mm", "speed_mm_s", "force_n", "rate_hz", "seconds", "pace"};
    unsigned bit = 1;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++, bit <<= 1)
        if (!strcmp(name, names[i])) return bit;
    return 0;
}

static int64_t read_settings(struct settings *all, const uint8_t *text, size_t len) {
    *all = (struct settings){1, 80, 0.4, 5000, 0, 0};
    if (!usable(text, len, 1)) return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "`settings` is not usable");
    unsigned given = 0;
    for (size_t at = 0; at < len;) {
        char line[128];
        size_t n = 0;
        while (at + n < len && text[at + n] != '\n') n++;
        if (n >= sizeof line) return fail(HTEX_DEVICE_INVALID_SETTING, "", "settings: too long");
        memcpy(line, text + at, n);
        line[n] = 0;
        char *value = strchr(line, '=');
        if (!value) return fail(HTEX_DEVICE_INVALID_SETTING, line, ": a line is NAME=VALUE");
        *value++ = 0;
        unsigned bit = bit_of(line);
        if (given & bit) return fail(HTEX_DEVICE_INVALID_SETTING, line, ": it is given twice");
        given |= bit;
        int64_t status = set(all, line, value);
        if (status) return status;
        at += n + 1;
    }
    return 0;
}

/* ---- open inputs ---- */

struct input {
    int64_t handle; /* 0: free */
    struct settings settings;
    enum { OPENED, SAMPLING, STOPPED } state;
    struct timespec begun;
    uint64_t frames; /* that were read */
};

static struct input inputs[INPUTS];
static int64_t handles;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static struct input *find(int64_t handle) {
    struct input *found = NULL;
    pthread_mutex_lock(&lock);
    for (int i = 0; i < INPUTS && handle > 0; i++)
        if (inputs[i].handle == handle) found = &inputs[i];
    pthread_mutex_unlock(&lock);
    if (!found) fail(HTEX_DEVICE_BAD_HANDLE, "", "no such device is open; it may have been closed");
    return found;
}

static int64_t device_open(const uint8_t *settings, size_t settings_len, double rate_hz,
                           uint32_t block_frames) {
    (void)rate_hz, (void)block_frames; /* of outputs */
    struct input s = {0};
    int64_t status = read_settings(&s.settings, settings, settings_len);
    if (status) return status;
    pthread_mutex_lock(&lock);
    struct input *slot = NULL;
    for (int i = 0; i < INPUTS; i++)
        if (!inputs[i].handle) slot = &inputs[i];
    if (slot) {
        s.handle = ++handles;
        *slot = s;
    }
    pthread_mutex_unlock(&lock);
    return slot ? s.handle : fail(HTEX_DEVICE_BUSY, "", "sixteen are open; close one");
}

static int64_t device_stream(int64_t device, uint8_t *out, size_t capacity) {
    struct input *s = find(device);
    if (!s) return HTEX_DEVICE_BAD_HANDLE;
    char text[256];
    snprintf(text, sizeof text,
             "{\"rate_hz\":%.17g,\"channels\":[{\"name\":\"lateral_x\",\"unit\":\"N\"},"
             "{\"name\":\"normal\",\"unit\":\"N\"},{\"name\":\"speed\",\"unit\":\"mm/s\"}]}",
             s->settings.rate_hz);
    return give(text, out, capacity);
}

static int64_t device_start(int64_t device) {
    struct input *s = find(device);
    if (!s) return HTEX_DEVICE_BAD_HANDLE;
    if (s->state == STOPPED) return fail(HTEX_DEVICE_CLOSED, "", "the finger has stopped");
    if (s->state == OPENED) clock_gettime(CLOCK_MONOTONIC, &s->begun);
    s->state = SAMPLING;
    return HTEX_DEVICE_OK;
}

static double since_s(const struct timespec *then) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)(now.tv_sec - then->tv_sec) + 1e-9 * (double)(now.tv_nsec - then->tv_nsec);
}

static void sleep_s(double seconds) {
    struct timespec time = {(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
    nanosleep(&time, NULL);
}

/* Frames that were sampled and not read; waits for the first. */
static uint64_t waiting(const struct input *s, uint32_t timeout_ms) {
    double rate_hz = s->settings.rate_hz, now_s = since_s(&s->begun);
    double wait_s = (double)(s->frames + 1) / rate_hz - now_s;
    if (wait_s > 0) sleep_s(fmin(wait_s, timeout_ms / 1000.0));
    uint64_t sampled = (uint64_t)(since_s(&s->begun) * rate_hz);
    return sampled > s->frames ? sampled - s->frames : 0;
}

/* Forces and speed of a frame: the finger moves to and fro at its speed. */
static void sample(const struct settings *all, uint64_t frame, double *out) {
    double way_mm = fmod(all->speed_mm_s * (double)frame / all->rate_hz, 2 * STROKE_MM);
    double is_back = way_mm >= STROKE_MM, x_mm = is_back ? 2 * STROKE_MM - way_mm : way_mm;
    double ripple = RIPPLE * sin(2 * PI * x_mm / all->spacing_mm);
    out[0] = FRICTION * all->force_n * (ripple - (is_back ? -1 : 1));
    out[1] = all->force_n;
    out[2] = all->speed_mm_s;
}

static int64_t device_read(int64_t device, double *samples, size_t len, uint32_t timeout_ms) {
    struct input *s = find(device);
    if (!s) return HTEX_DEVICE_BAD_HANDLE;
    if (len % CHANNELS) return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "a frame has three samples");
    if (!usable(samples, len, sizeof *samples))
        return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "`samples` is not usable");
    if (s->state != SAMPLING) return fail(HTEX_DEVICE_CLOSED, "", "the finger does not move");
    uint64_t frames = len / CHANNELS;
    if (s->settings.seconds > 0) {
        uint64_t all = (uint64_t)(s->settings.seconds * s->settings.rate_hz);
        if (s->frames >= all) return fail(HTEX_DEVICE_END, "", "the time has passed");
        if (frames > all - s->frames) frames = all - s->frames;
    }
    if (!s->settings.is_fast && frames) {
        uint64_t there = waiting(s, timeout_ms);
        if ((double)there > KEPT_S * s->settings.rate_hz) {
            s->state = STOPPED;
            return fail(HTEX_DEVICE_OVERRUN, "", "read more often than every 10 s");
        }
        if (frames > there) frames = there;
    }
    for (uint64_t i = 0; i < frames; i++)
        sample(&s->settings, s->frames + i, samples + CHANNELS * i);
    s->frames += frames;
    return (int64_t)frames;
}

static int64_t device_finish(int64_t device) {
    struct input *s = find(device);
    if (!s) return HTEX_DEVICE_BAD_HANDLE;
    s->state = STOPPED;
    return HTEX_DEVICE_OK;
}

static int64_t device_close(int64_t device) {
    struct input *s = find(device);
    if (!s) return HTEX_DEVICE_BAD_HANDLE;
    pthread_mutex_lock(&lock);
    s->handle = 0;
    pthread_mutex_unlock(&lock);
    return HTEX_DEVICE_OK;
}

/* ---- export ---- */

const htex_device_table *htex_device_adapter(void) {
    static const htex_device_table table = {
        .marker = HTEX_DEVICE_ABI_MARKER,
        .size = sizeof(htex_device_table),
        .descriptor = device_descriptor,
        .last_error = device_last_error,
        .endpoints = device_endpoints,
        .open = device_open,
        .finish = device_finish,
        .close = device_close,
        .extension = device_extension,
        .stream = device_stream,
        .start = device_start,
        .read = device_read,
    };
    return &table;
}
