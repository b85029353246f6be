/* A valid input with one fault.
 *
 * Every call is passed on to the library GOOD_LIBRARY (the ridges of examples/device-c-ridges), but
 * for what one -DFAULT_… changes. Only the check of this fault must fail; the
 * table of faults and checks stands in cli/tests/live/device.rs.
 */
#include "bad.h"
#include <unistd.h>

static int64_t bad_descriptor(uint8_t *out, size_t capacity) {
#define BAD(name, target)                                                                        \
    "{\"id\":\"org.example.bad\",\"name\":\"" name "\",\"version\":\"1.0.0\","                   \
    "\"summary\":\"Bad.\",\"direction\":\"input\",\"target\":\"" target "\",\"settings\":[{\"name\":\"a\","              \
    "\"kind\":{\"type\":\"number\",\"min\":0,\"max\":1},\"default\":\"1\",\"description\":\"A.\"}]}"
#if defined FAULT_TARGET
    return give(BAD("Bad", "b"), out, capacity);
#elif defined FAULT_NO_TEXT
    return give(BAD("\xff\xfe", "a"), out, capacity);
#else
    return good()->descriptor(out, capacity);
#endif
}

static int64_t running;

static int64_t bad_open(const uint8_t *settings, size_t settings_len, double rate_hz,
                        uint32_t block_frames) {
#ifdef FAULT_OPENINGS_LEAK
    kept = memset(malloc(65536), 1, 65536);
#elif defined FAULT_TWO
    if (opened) return HTEX_DEVICE_FAILED;
#endif
    int64_t handle = good()->open(settings, settings_len, rate_hz, block_frames);
#ifdef FAULT_ACCEPTS_TWICE
    char why[64] = "";
    good()->last_error((uint8_t *)why, sizeof why - 1);
    if (handle == HTEX_DEVICE_INVALID_SETTING && strstr(why, "twice")) handle = good()->open(NULL, 0, rate_hz, block_frames);
#endif
#ifdef FAULT_ACCEPTS_SETTING
    if (handle == HTEX_DEVICE_INVALID_SETTING) handle = good()->open(NULL, 0, rate_hz, block_frames);
#endif
    if (handle > 0) opened++;
    return handle;
}

static int64_t bad_stream(int64_t device, uint8_t *out, size_t capacity) {
#define STREAM(rate, channels) "{\"rate_hz\":" rate ",\"channels\":[" channels "]}"
#define CHANNEL "{\"name\":\"a\",\"unit\":\"N\"}"
#if defined FAULT_RATE_NAN
    return give(STREAM("NaN", CHANNEL), out, capacity);
#elif defined FAULT_NO_CHANNELS
    return give(STREAM("5000", ""), out, capacity);
#elif defined FAULT_CHANGES
    if (device % 2) return give(STREAM("5000", CHANNEL), out, capacity);
#elif defined FAULT_STREAM_BEYOND
    uint8_t whole[1024];
    int64_t len = good()->stream(device, whole, sizeof whole);
    if (len > 0 && out && capacity) memcpy(out, whole, (size_t)len);
    if (len > 0 && (out || !capacity)) return len;
#endif
    return good()->stream(device, out, capacity);
}

static int64_t bad_start(int64_t device) {
    int64_t answer = good()->start(device);
    if (answer == 0) running = device;
    return answer;
}

static int64_t bad_read(int64_t device, double *samples, size_t len, uint32_t timeout_ms) {
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
    if (device != running) return 0;
#elif defined FAULT_ACCEPTS_NULL
    if (len && !samples) return 0;
#endif
    int64_t answer = good()->read(device, samples, len, timeout_ms);
#ifdef FAULT_NAN
    if (answer > 0 && len > 100) samples[3 * answer - 1] = NAN;
#elif defined FAULT_AFTER_STOP
    if (answer == HTEX_DEVICE_CLOSED && device == running) return 0;
#endif
    return answer;
}

static int64_t bad_finish(int64_t device) { return good()->finish(device); }

static int64_t bad_close(int64_t device) {
    int64_t answer = good()->close(device);
    if (answer == 0) opened--;
#ifdef FAULT_CLOSED_HANDLE
    if (answer == HTEX_DEVICE_BAD_HANDLE) return HTEX_DEVICE_OK;
#endif
    return answer;
}

const htex_device_table *htex_device_adapter(void) {
    static htex_device_table table = {
        BOTH,
        .stream = bad_stream,
        .start = bad_start,
        .read = bad_read,
    };
    return &table;
}
