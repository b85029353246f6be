/* {{LABEL}}: initially an output that writes the force at the finger to a CSV file.
 *
 * The samples are written to a temporary file beside the file that the user named (PATH.1, or the
 * next number that is free). When the device is finished, the temporary file is renamed to PATH.
 *
 * This file needs only htex_device.h and a C library. See build.sh.
 */
#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "htex_device.h"

enum { PATH_BYTES = 4096, DEVICES = 16 };

static const double MIN_RATE_HZ = 100.0, MAX_RATE_HZ = 100000.0;

/* ---- the descriptor: what the device states about itself ---- */

static const char DESCRIPTOR[] =
    "{\"id\":\"{{ID}}\",\"name\":\"{{LABEL}}\",\"version\":\"1.0.0\","
    "\"summary\":\"{{LABEL}}: writes the force to a CSV file.\",\"direction\":\"output\","
    "\"settings\":["
    "{\"name\":\"path\",\"kind\":{\"type\":\"path\"},\"description\":\"Path of the file.\"},"
    "{\"name\":\"limit_n\",\"kind\":{\"type\":\"number\",\"min\":0.001,\"max\":100},"
    "\"default\":\"1\",\"description\":\"Largest force; samples beyond it are refused.\"}]}";

/* ---- errors and texts ---- */

static _Thread_local char last_error[PATH_BYTES + 256];

static int64_t fail(int64_t status, const char *subject, const char *text)
{
    snprintf(last_error, sizeof last_error, "%s%s", subject, text);
    return status;
}

/* Whether `len` values of `size` bytes may be at `pointer`. */
static int usable(const void *pointer, size_t len, size_t size)
{
    return len == 0 || (pointer != NULL && (uintptr_t)pointer % size == 0);
}

static int64_t copy_text(const char *text, uint8_t *out, size_t capacity)
{
    size_t len = strlen(text);
    if (!usable(out, capacity, 1))
        return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "`out` is not a usable buffer");
    if (capacity > 0)
        memcpy(out, text, len < capacity ? len : capacity);
    return (int64_t)len;
}

static int64_t device_descriptor(uint8_t *out, size_t capacity)
{
    return copy_text(DESCRIPTOR, out, capacity);
}

static int64_t device_last_error(uint8_t *out, size_t capacity)
{
    return copy_text(last_error, out, capacity);
}

/* A list of the connected hardware. A file needs none. */
static int64_t device_endpoints(uint8_t *out, size_t capacity)
{
    return copy_text("[]", out, capacity);
}

static int64_t device_extension(const uint8_t *id, size_t id_len)
{
    (void)id;
    (void)id_len;
    return 0;
}

/* ---- settings ---- */

struct settings {
    char path[PATH_BYTES];
    double limit_n;
    int has_limit;
};

/* Reads one setting. The host has applied the defaults, so each setting has exactly one line. */
static int64_t set(struct settings *all, const char *name, const char *value)
{
    if (strcmp(name, "path") == 0) {
        if (*all->path != 0)
            return fail(HTEX_DEVICE_INVALID_SETTING, name, ": it is given twice");
        if (*value == 0)
            return fail(HTEX_DEVICE_INVALID_SETTING, name, ": a file is needed");
        snprintf(all->path, sizeof all->path, "%s", value);
        return HTEX_DEVICE_OK;
    }
    if (strcmp(name, "limit_n") == 0) {
        char *end;
        double limit_n = strtod(value, &end);
        if (all->has_limit)
            return fail(HTEX_DEVICE_INVALID_SETTING, name, ": it is given twice");
        if (end == value || *end != 0 || !(limit_n >= 0.001 && limit_n <= 100.0))
            return fail(HTEX_DEVICE_INVALID_SETTING, name, ": a number from 0.001 to 100 is needed");
        all->limit_n = limit_n;
        all->has_limit = 1;
        return HTEX_DEVICE_OK;
    }
    return fail(HTEX_DEVICE_INVALID_SETTING, name, ": there is no such setting");
}

static int64_t read_settings(struct settings *all, const uint8_t *text, size_t len)
{
    memset(all, 0, sizeof *all);
    all->limit_n = 1.0;
    if (!usable(text, len, 1))
        return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "`settings` is not a usable array");
    for (size_t at = 0; at < len;) {
        char line[PATH_BYTES];
        size_t n = 0;
        while (at + n < len && text[at + n] != '\n')
            n++;
        if (n >= sizeof line)
            return fail(HTEX_DEVICE_INVALID_SETTING, "path", ": it is too long");
        memcpy(line, text + at, n);
        line[n] = 0;
        char *value = strchr(line, '=');
        if (value == NULL)
            return fail(HTEX_DEVICE_INVALID_SETTING, line, ": a line is NAME=VALUE");
        *value++ = 0;
        int64_t status = set(all, line, value);
        if (status != HTEX_DEVICE_OK)
            return status;
        at += n + 1;
    }
    if (*all->path == 0)
        return fail(HTEX_DEVICE_INVALID_SETTING, "path", ": it must be given");
    return HTEX_DEVICE_OK;
}

static int64_t device_capabilities(const uint8_t *settings, size_t settings_len, uint8_t *out,
                                   size_t capacity)
{
    struct settings all;
    int64_t status = read_settings(&all, settings, settings_len);
    if (status != HTEX_DEVICE_OK)
        return status;
    char text[512];
    snprintf(text, sizeof text,
             "{\"quantity\":\"lateral_force\",\"rates\":{\"range\":{\"min_hz\":%.17g,"
             "\"max_hz\":%.17g}},\"default_rate_hz\":10000,\"limit\":%.17g,\"paced\":false,"
             "\"block_frames\":1024}",
             MIN_RATE_HZ, MAX_RATE_HZ, all.limit_n);
    return copy_text(text, out, capacity);
}

/* ---- open devices ---- */

struct device {
    int64_t handle; /* 0: the slot is free */
    FILE *file;     /* NULL: finished, or stopped by an error */
    struct settings settings;
    char temporary[PATH_BYTES + 16];
    double rate_hz;
    uint64_t frames;
    float peak;
};

static struct device devices[DEVICES];
static int64_t handles;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

static struct device *find(int64_t handle)
{
    struct device *found = NULL;
    pthread_mutex_lock(&lock);
    for (int i = 0; i < DEVICES && handle > 0; i++)
        if (devices[i].handle == handle)
            found = &devices[i];
    pthread_mutex_unlock(&lock);
    if (found == NULL)
        fail(HTEX_DEVICE_BAD_HANDLE, "", "no such device is open; it may have been closed");
    return found;
}

/* Closes and removes the temporary file. */
static void stop(struct device *d)
{
    if (d->file == NULL)
        return;
    fclose(d->file);
    d->file = NULL;
    remove(d->temporary);
}

static int64_t file_error(const struct device *d, int error)
{
    char text[256];
    snprintf(text, sizeof text, ": cannot be written: %s", strerror(error));
    return fail(HTEX_DEVICE_FILE, d->settings.path, text);
}

/* Creates the temporary file, which must not exist yet ("x"). */
static int create(struct device *d)
{
    for (int number = 1; d->file == NULL && number <= 100; number++) {
        snprintf(d->temporary, sizeof d->temporary, "%s.%d", d->settings.path, number);
        d->file = fopen(d->temporary, "wbx");
        if (d->file == NULL && errno != EEXIST)
            return 0;
    }
    return d->file != NULL && fputs("time_s,force_n\n", d->file) >= 0;
}

static int64_t device_open(const uint8_t *settings, size_t settings_len, double rate_hz,
                           uint32_t block_frames)
{
    struct device d = {0};
    int64_t status = read_settings(&d.settings, settings, settings_len);
    if (status != HTEX_DEVICE_OK)
        return status;
    if (!(rate_hz >= MIN_RATE_HZ && rate_hz <= MAX_RATE_HZ))
        return fail(HTEX_DEVICE_INVALID_RATE, "", "rates from 100 to 100000 Hz are possible");
    if (block_frames < 1 || block_frames > HTEX_DEVICE_MAX_BLOCK_FRAMES)
        return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "a block has 1 to 1048576 frames");
    d.rate_hz = rate_hz;
    pthread_mutex_lock(&lock);
    struct device *slot = NULL;
    for (int i = 0; i < DEVICES; i++)
        if (devices[i].handle == 0)
            slot = &devices[i];
    int error = 0;
    if (slot != NULL && create(&d)) {
        d.handle = ++handles;
        *slot = d;
    } else {
        error = errno;
        stop(&d);
    }
    pthread_mutex_unlock(&lock);
    if (slot == NULL)
        return fail(HTEX_DEVICE_BUSY, "", "sixteen files are open; close one");
    return d.handle > 0 ? d.handle : file_error(&d, error);
}

static int64_t device_write(int64_t device, const float *samples, size_t frames, uint32_t timeout_ms)
{
    (void)timeout_ms; /* A file never has to be waited for. */
    struct device *d = find(device);
    if (d == NULL)
        return HTEX_DEVICE_BAD_HANDLE;
    if (d->file == NULL)
        return fail(HTEX_DEVICE_CLOSED, "", "the file is closed");
    if (!usable(samples, frames, sizeof *samples))
        return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "`samples` is not a usable array");
    /* All samples are checked before any is written. The comparison is false for NaN. */
    for (size_t i = 0; i < frames; i++)
        if (!(fabsf(samples[i]) <= (float)d->settings.limit_n)) {
            stop(d);
            return fail(HTEX_DEVICE_OVER_LIMIT, "", "a sample is over limit_n, or is not a number");
        }
    for (size_t i = 0; i < frames; i++) {
        if (fprintf(d->file, "%.9g,%.9g\n", (double)d->frames / d->rate_hz, (double)samples[i]) < 0) {
            int error = errno;
            stop(d);
            return file_error(d, error);
        }
        d->frames++;
        d->peak = fmaxf(d->peak, fabsf(samples[i]));
    }
    return (int64_t)frames;
}

static int64_t device_status(int64_t device, double *out, size_t capacity)
{
    struct device *d = find(device);
    if (d == NULL)
        return HTEX_DEVICE_BAD_HANDLE;
    if (!usable(out, capacity, sizeof *out))
        return fail(HTEX_DEVICE_INVALID_ARGUMENT, "", "`out` is not a usable array");
    const double all[HTEX_DEVICE_STATUS_NUMBERS] = {
        [HTEX_DEVICE_STATUS_FRAMES_WRITTEN] = (double)d->frames,
        [HTEX_DEVICE_STATUS_FRAMES_PLAYED] = (double)d->frames,
        [HTEX_DEVICE_STATUS_PEAK] = (double)d->peak,
    };
    for (size_t i = 0; i < capacity && i < HTEX_DEVICE_STATUS_NUMBERS; i++)
        out[i] = all[i];
    return HTEX_DEVICE_STATUS_NUMBERS;
}

static int64_t device_finish(int64_t device)
{
    struct device *d = find(device);
    if (d == NULL)
        return HTEX_DEVICE_BAD_HANDLE;
    if (d->file == NULL)
        return fail(HTEX_DEVICE_CLOSED, "", "the file is closed");
    int is_whole = fclose(d->file) == 0;
    d->file = NULL;
    if (is_whole && rename(d->temporary, d->settings.path) == 0)
        return HTEX_DEVICE_OK;
    int error = errno;
    remove(d->temporary);
    return file_error(d, error);
}

static int64_t device_close(int64_t device)
{
    struct device *d = find(device);
    if (d == NULL)
        return HTEX_DEVICE_BAD_HANDLE;
    stop(d);
    pthread_mutex_lock(&lock);
    d->handle = 0;
    pthread_mutex_unlock(&lock);
    return HTEX_DEVICE_OK;
}

/* ---- the table of functions ---- */

const htex_device_table *htex_device_adapter(void)
{
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
