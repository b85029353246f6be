/* A valid source with one fault.
 *
 * Every call is passed on to the library GOOD_LIBRARY (the ridges of examples/source-c-ridges), but
 * for what one -DFAULT_… changes. Only the check of this fault must fail; the
 * table of faults and checks stands in cli/tests/source.rs.
 */
#include <dlfcn.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "htex_source.h"

static void *good_symbol(const char *name) {
    static void *library;
    if (!library) library = dlopen(GOOD_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    void *symbol = library ? dlsym(library, name) : NULL;
    if (!symbol) abort();
    return symbol;
}

/* The good source's function of the same name and type. */
#define GOOD(function) ((__typeof__(&function))good_symbol(#function))

/* Where a leak points last, so that a compiler does not leave it out. */
static void *volatile kept;

static int64_t give(const char *text, uint8_t *out, size_t capacity) {
    size_t len = strlen(text);
    if (capacity && !out) return -1; /* invalid argument */
    if (capacity) memcpy(out, text, capacity < len ? capacity : len);
    return (int64_t)len;
}

uint32_t htex_source_abi_version(void) {
#ifdef FAULT_MARKER
    return 0x48440100; /* a device's */
#else
    return GOOD(htex_source_abi_version)();
#endif
}

int64_t htex_source_descriptor(uint8_t *out, size_t capacity) {
#define BAD(name, target)                                                                        \
    "{\"id\":\"org.example.bad\",\"name\":\"" name "\",\"version\":\"1.0.0\","                   \
    "\"summary\":\"Bad.\",\"target\":\"" target "\",\"settings\":[{\"name\":\"a\","              \
    "\"kind\":{\"type\":\"number\",\"min\":0,\"max\":1},\"default\":\"1\",\"description\":\"A.\"}]}"
#if defined FAULT_TARGET
    return give(BAD("Bad", "b"), out, capacity);
#elif defined FAULT_NO_TEXT
    return give(BAD("\xff\xfe", "a"), out, capacity);
#else
    return GOOD(htex_source_descriptor)(out, capacity);
#endif
}

int64_t htex_source_last_error(uint8_t *out, size_t capacity) {
#ifdef FAULT_SETTING_UNNAMED
    static const char text[] = "one of the settings is not usable";
    for (size_t i = 0; out && i < sizeof text - 1 && i < capacity; i++) out[i] = (uint8_t)text[i];
    if (out || !capacity) return sizeof text - 1;
#endif
    return GOOD(htex_source_last_error)(out, capacity);
}

int64_t htex_source_endpoints(uint8_t *out, size_t capacity) {
#ifdef FAULT_ENDPOINTS
    return give("[{\"name\":\"a\",\"setting\":\"no_such\",\"summary\":\"A.\"}]", out, capacity);
#else
    return GOOD(htex_source_endpoints)(out, capacity);
#endif
}

static int64_t opened, running;

int64_t htex_source_open(const uint8_t *settings, size_t settings_len) {
#ifdef FAULT_OPENINGS_LEAK
    kept = memset(malloc(65536), 1, 65536);
#elif defined FAULT_TWO
    if (opened) return HTEX_SOURCE_FAILED;
#endif
    int64_t handle = GOOD(htex_source_open)(settings, settings_len);
#ifdef FAULT_ACCEPTS_TWICE
    char why[64] = "";
    GOOD(htex_source_last_error)((uint8_t *)why, sizeof why - 1);
    if (handle == HTEX_SOURCE_INVALID_SETTING && strstr(why, "twice")) handle = GOOD(htex_source_open)(NULL, 0);
#endif
#ifdef FAULT_ACCEPTS_SETTING
    if (handle == HTEX_SOURCE_INVALID_SETTING) handle = GOOD(htex_source_open)(NULL, 0);
#endif
    if (handle > 0) opened++;
    return handle;
}

int64_t htex_source_stream(int64_t source, uint8_t *out, size_t capacity) {
#define STREAM(rate, channels) "{\"rate_hz\":" rate ",\"channels\":[" channels "]}"
#define CHANNEL "{\"name\":\"a\",\"unit\":\"N\"}"
#if defined FAULT_RATE_NAN
    return give(STREAM("NaN", CHANNEL), out, capacity);
#elif defined FAULT_NO_CHANNELS
    return give(STREAM("5000", ""), out, capacity);
#elif defined FAULT_CHANGES
    if (source % 2) return give(STREAM("5000", CHANNEL), out, capacity);
#elif defined FAULT_STREAM_BEYOND
    uint8_t whole[1024];
    int64_t len = GOOD(htex_source_stream)(source, whole, sizeof whole);
    if (len > 0 && out && capacity) memcpy(out, whole, (size_t)len);
    if (len > 0 && (out || !capacity)) return len;
#endif
    return GOOD(htex_source_stream)(source, out, capacity);
}

int64_t htex_source_start(int64_t source) {
    int64_t answer = GOOD(htex_source_start)(source);
    if (answer == 0) running = source;
    return answer;
}

int64_t htex_source_read(int64_t source, double *samples, size_t len, uint32_t timeout_ms) {
#if defined FAULT_READ_TOO_MANY
    if (len > 100) return (int64_t)len + 1;
#elif defined FAULT_READ_CRASHES
    if (len > 100) abort();
#elif defined FAULT_READ_LOOPS
    for (volatile int forever = len > 100; forever;) {}
#elif defined FAULT_LEAK
    kept = memset(malloc(65536), 1, 65536);
#elif defined FAULT_LATE
    if (timeout_ms < 1000 && len) sleep(1);
#elif defined FAULT_READS_EARLY
    if (source != running) return 0;
#elif defined FAULT_ACCEPTS_NULL
    if (len && !samples) return 0;
#endif
    int64_t answer = GOOD(htex_source_read)(source, samples, len, timeout_ms);
#ifdef FAULT_NAN
    if (answer > 0 && len > 100) samples[3 * answer - 1] = NAN;
#elif defined FAULT_AFTER_STOP
    if (answer == HTEX_SOURCE_CLOSED && source == running) return 0;
#endif
    return answer;
}

#ifndef FAULT_EXPORT_MISSING
int64_t htex_source_stop(int64_t source) { return GOOD(htex_source_stop)(source); }
#endif

int64_t htex_source_close(int64_t source) {
    int64_t answer = GOOD(htex_source_close)(source);
    if (answer == 0) opened--;
#ifdef FAULT_CLOSED_HANDLE
    if (answer == HTEX_SOURCE_BAD_HANDLE) return HTEX_SOURCE_OK;
#endif
    return answer;
}

int64_t htex_source_extension(const uint8_t *id, size_t id_len) {
#ifdef FAULT_EXTENSIONS
    return 1;
#else
    return GOOD(htex_source_extension)(id, id_len);
#endif
}
