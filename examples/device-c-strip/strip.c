/* A strip chart: the force at the finger, drawn into an SVG file as it is played.
 *
 * Each column of the chart is the span between the least and the greatest force within column_ms.
 * Memory is the same for seconds and for hours: columns are written as they are complete, into
 * PATH.1 (2, 3 …), which gets its name when the device is finished.
 */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "htex_device.h"

enum { HEIGHT = 200, PATH_BYTES = 4096, DEVICES = 16 };

static const char descriptor[] =
    "{\"id\":\"org.example.strip\",\"name\":\"Strip chart\",\"version\":\"1.0.0\","
    "\"summary\":\"Draws the force into an SVG file.\",\"direction\":\"output\",\"settings\":["
    "{\"name\":\"path\",\"kind\":{\"type\":\"path\"},\"description\":\"The file.\"},"
    "{\"name\":\"full_scale_n\",\"kind\":{\"type\":\"number\",\"min\":0.001,\"max\":100},"
    "\"default\":\"1\",\"description\":\"Force at the chart's upper edge; more is refused.\"},"
    "{\"name\":\"column_ms\",\"kind\":{\"type\":\"number\",\"min\":1,\"max\":1000},"
    "\"default\":\"10\",\"description\":\"Time that one column stands for.\"}],"
    "\"profiles\":[{\"name\":\"day\",\"summary\":\"One column a second.\","
    "\"settings\":{\"column_ms\":\"1000\"}}]}";

/* ---- errors and texts ---- */

static _Thread_local char last_error[PATH_BYTES + 256];

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

/* A file needs no connected device. */
static int64_t device_endpoints(uint8_t *out, size_t capacity) { return give("[]", out, capacity); }

static int64_t device_extension(const uint8_t *id, size_t id_len) {
    (void)id, (void)id_len;
    return 0;
}

/* ---- settings ---- */

struct settings {
    char path[PATH_BYTES];
    double full_scale_n, column_ms;
};

static int number(const char *text, double min, double max, double *out) {
    char *end;
    double value = strtod(text, &end);
    if (end == text || *end || !(value >= min && value <= max)) return 0;
    *out = value;
    return 1;
}

static int64_t set(struct settings *all, const char *name, const char *value) {
    if (!strcmp(name, "path") && *value) {
        snprintf(all->path, sizeof all->path, "%s", value);
        return 0;
    }
    if (!strcmp(name, "full_scale_n") && number(value, 0.001, 100, &all->full_scale_n)) return 0;
    if (!strcmp(name, "column_ms") && number(value, 1, 1000, &all->column_ms)) return 0;
    return fail(HTEX_DEVICE_INVALID_SETTING, name, ": not known, or not usable");
}

/* The bit of a setting, by which a second line is found; 0 of an unknown one, which is refused anyway. */
static unsigned bit_of(const char *name) {
    static const char *const names[] = {"path", "full_scale_n", "column_ms"};
    unsigned bit = 1;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++, bit <<= 1)
        if (!strcmp(name, names[i])) return bit;
    return 0;
}

static int64_t read_settings(struct settings *all, const uint8_t *text, size_t len) {
    memset(all, 0, sizeof *all);
    all->full_scale_n = 1, all->column_ms = 10;
    if (!usable(text, len, 1)) return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "`settings` is not usable");
    unsigned given = 0;
    for (size_t at = 0; at < len;) {
        char line[PATH_BYTES];
        size_t n = 0;
        while (at + n < len && text[at + n] != '\n') n++;
        if (n >= sizeof line) return fail(HTEX_DEVICE_INVALID_SETTING, "path", ": too long");
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
    if (!*all->path) return fail(HTEX_DEVICE_INVALID_SETTING, "path", ": it must be given");
    return 0;
}

static int64_t device_capabilities(const uint8_t *settings, size_t settings_len, uint8_t *out,
                                 size_t capacity) {
    struct settings all;
    int64_t status = read_settings(&all, settings, settings_len);
    if (status) return status;
    char text[512];
    snprintf(text, sizeof text,
             "{\"quantity\":\"lateral_force\",\"rates\":{\"range\":{\"min_hz\":100,"
             "\"max_hz\":100000}},\"default_rate_hz\":10000,\"limit\":%.17g,\"paced\":false,"
             "\"block_frames\":1024}",
             all.full_scale_n);
    return give(text, out, capacity);
}

/* ---- open devices ---- */

struct device {
    int64_t handle; /* 0: free */
    FILE *file;     /* NULL: finished, or failed */
    struct settings settings;
    char part[PATH_BYTES + 32];
    double rate_hz;
    uint64_t frames, columns;
    float low, high, peak;
};

static struct device devices[DEVICES];
static int64_t handles;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static struct device *find(int64_t handle) {
    struct device *found = NULL;
    pthread_mutex_lock(&lock);
    for (int i = 0; i < DEVICES && handle > 0; i++)
        if (devices[i].handle == handle) found = &devices[i];
    pthread_mutex_unlock(&lock);
    if (!found) fail(HTEX_DEVICE_BAD_HANDLE, "", "no such device is open; it may have been closed");
    return found;
}

/* The drawing's size is known at its end only: the head has the same length for any. */
static void head(struct device *d) {
    fprintf(d->file,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %12llu %d\" "
            "preserveAspectRatio=\"none\"><path fill=\"none\" stroke=\"#246\" d=\"M0 %dh%12llu",
            (unsigned long long)d->columns, HEIGHT, HEIGHT / 2, (unsigned long long)d->columns);
}

static double y(const struct device *d, float force_n) {
    return HEIGHT * (0.5 - 0.5 * force_n / d->settings.full_scale_n);
}

static void end_column(struct device *d) {
    fprintf(d->file, "M%llu.5 %.2fV%.2f", (unsigned long long)d->columns, y(d, d->high),
            y(d, d->low) + 0.5);
    d->columns++;
}

/* Closes and removes the file. */
static void abandon(struct device *d) {
    if (!d->file) return;
    fclose(d->file);
    d->file = NULL;
    remove(d->part);
}

static int64_t file_error(struct device *d) {
    abandon(d);
    return fail(HTEX_DEVICE_FILE, d->settings.path, ": cannot be written");
}

static int64_t device_open(const uint8_t *settings, size_t settings_len, double rate_hz,
                         uint32_t block_frames) {
    struct device d = {0};
    int64_t status = read_settings(&d.settings, settings, settings_len);
    if (status) return status;
    if (!(rate_hz >= 100 && rate_hz <= 100000))
        return fail(HTEX_DEVICE_INVALID_RATE, "", "100 to 100000 Hz it is");
    if (block_frames < 1 || block_frames > HTEX_DEVICE_MAX_BLOCK_FRAMES)
        return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "a block has 1 to 1048576 frames");
    d.rate_hz = rate_hz;
    pthread_mutex_lock(&lock);
    struct device *slot = NULL;
    for (int i = 0; i < DEVICES; i++)
        if (!devices[i].handle) slot = &devices[i];
    if (slot) {
        d.handle = ++handles;
        snprintf(d.part, sizeof d.part, "%s.%lld", d.settings.path, (long long)d.handle);
        d.file = fopen(d.part, "wb");
        if (d.file) head(&d);
        if (d.file) *slot = d;
    }
    pthread_mutex_unlock(&lock);
    if (!slot) return fail(HTEX_DEVICE_BUSY, "", "sixteen charts are open; close one");
    return d.file ? d.handle : file_error(&d);
}

static int64_t device_write(int64_t device, const float *samples, size_t frames,
                          uint32_t timeout_ms) {
    (void)timeout_ms; /* there is always space */
    struct device *d = find(device);
    if (!d) return HTEX_DEVICE_BAD_HANDLE;
    if (!d->file) return fail(HTEX_DEVICE_CLOSED, "", "the chart is closed");
    if (!usable(samples, frames, sizeof *samples))
        return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "`samples` is not usable");
    for (size_t i = 0; i < frames; i++)
        if (!(fabsf(samples[i]) <= (float)d->settings.full_scale_n)) {
            abandon(d);
            return fail(HTEX_DEVICE_OVER_LIMIT, "", "a force is over full_scale_n, or no number");
        }
    double columns_a_frame = 1000 / (d->settings.column_ms * d->rate_hz);
    for (size_t i = 0; i < frames; i++) {
        while ((uint64_t)((double)d->frames * columns_a_frame) > d->columns) {
            end_column(d);
            d->low = d->high = samples[i];
        }
        if (d->frames++ == 0) d->low = d->high = samples[i];
        d->low = fminf(d->low, samples[i]);
        d->high = fmaxf(d->high, samples[i]);
        d->peak = fmaxf(d->peak, fabsf(samples[i]));
    }
    return ferror(d->file) ? file_error(d) : (int64_t)frames;
}

static int64_t device_status(int64_t device, double *out, size_t capacity) {
    struct device *d = find(device);
    if (!d) return HTEX_DEVICE_BAD_HANDLE;
    if (!usable(out, capacity, sizeof *out))
        return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "`out` is not usable");
    double all[HTEX_DEVICE_STATUS_NUMBERS] = {
        [HTEX_DEVICE_STATUS_FRAMES_WRITTEN] = (double)d->frames,
        [HTEX_DEVICE_STATUS_FRAMES_PLAYED] = (double)d->frames,
        [HTEX_DEVICE_STATUS_PEAK] = d->peak,
    };
    for (size_t i = 0; i < capacity && i < HTEX_DEVICE_STATUS_NUMBERS; i++) out[i] = all[i];
    return HTEX_DEVICE_STATUS_NUMBERS;
}

static int64_t device_finish(int64_t device) {
    struct device *d = find(device);
    if (!d) return HTEX_DEVICE_BAD_HANDLE;
    if (!d->file) return fail(HTEX_DEVICE_CLOSED, "", "the chart is closed");
    if (d->frames) end_column(d);
    fputs("\"/></svg>\n", d->file);
    rewind(d->file);
    head(d);
    int whole = !ferror(d->file) && !fflush(d->file);
    if (!whole) return file_error(d);
    whole = !fclose(d->file);
    d->file = NULL;
    if (whole && !rename(d->part, d->settings.path)) return HTEX_DEVICE_OK;
    remove(d->part);
    return fail(HTEX_DEVICE_FILE, d->settings.path, ": cannot be written");
}

static int64_t device_close(int64_t device) {
    struct device *d = find(device);
    if (!d) return HTEX_DEVICE_BAD_HANDLE;
    abandon(d);
    pthread_mutex_lock(&lock);
    d->handle = 0;
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
        .capabilities = device_capabilities,
        .write = device_write,
        .status = device_status,
    };
    return &table;
}
