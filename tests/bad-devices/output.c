/* A valid output with one fault.
 *
 * Every call is passed on to the library GOOD_LIBRARY (the strip chart of examples/device-c-strip), but
 * for what one -DFAULT_… changes. Only the check of this fault must fail; the
 * table of faults and checks stands in cli/tests/live/device.rs.
 */
#include "bad.h"

static int64_t bad_descriptor(uint8_t *out, size_t capacity) {
#define BAD(default_value, profile)                                                              \
    "{\"id\":\"org.example.bad\",\"name\":\"Bad\",\"version\":\"1.0.0\",\"summary\":\"Bad.\","   \
    "\"direction\":\"output\","                                                            \
    "\"settings\":[{\"name\":\"a\",\"kind\":{\"type\":\"number\",\"min\":0,\"max\":1},"          \
    "\"default\":\"" default_value "\",\"description\":\"A.\"}],"                                \
    "\"profiles\":[{\"name\":\"p\",\"summary\":\"P.\",\"settings\":{" profile "}}]}"
#if defined FAULT_DESCRIPTOR_JSON
    return give("{\"id\": \"org.example.bad\", \"settings\": [", out, capacity);
#elif defined FAULT_DESCRIPTOR_DEFAULT
    return give(BAD("2", ""), out, capacity);
#elif defined FAULT_PROFILE
    return give(BAD("1", "\"b\":\"1\""), out, capacity);
#else
    return good()->descriptor(out, capacity);
#endif
}

/* Whether the last refusal was of a second line of the same setting. */
static int was_twice(void) {
    char text[64] = "";
    good()->last_error((uint8_t *)text, sizeof text - 1);
    return strstr(text, "twice") != NULL;
}

static const char usual[] = "path=usual.svg\n";

static int64_t bad_capabilities(const uint8_t *settings, size_t settings_len, uint8_t *out,
                                 size_t capacity) {
    int64_t answer = good()->capabilities(settings, settings_len, out, capacity);
    if (answer < 0) {
#ifdef FAULT_ACCEPTS_TWICE
        if (answer == HTEX_DEVICE_INVALID_SETTING && was_twice())
            return good()->capabilities((const uint8_t *)usual, sizeof usual - 1, out, capacity);
#endif
#ifdef FAULT_ACCEPTS_SETTING
        if (answer == HTEX_DEVICE_INVALID_SETTING)
            return good()->capabilities((const uint8_t *)usual, sizeof usual - 1, out, capacity);
#endif
        return answer;
    }
#define CAN(quantity, rate)                                                                      \
    "{\"quantity\":\"" quantity "\",\"rates\":{\"list\":[10000]},\"default_rate_hz\":" rate ","  \
    "\"paced\":false,\"block_frames\":64}"
#if defined FAULT_VOLTAGE
    return give(CAN("display_voltage", "10000"), out, capacity);
#elif defined FAULT_CAPABILITIES
    return give(CAN("lateral_force", "9000"), out, capacity);
#elif defined FAULT_TEXT_BEYOND
    uint8_t whole[1024];
    good()->capabilities(settings, settings_len, whole, sizeof whole);
    if (capacity) memcpy(out, whole, (size_t)answer);
    return answer;
#else
    return answer;
#endif
}

static int64_t bad_open(const uint8_t *settings, size_t settings_len, double rate_hz,
                         uint32_t block_frames) {
#ifdef FAULT_OPEN_HIGH
    if (rate_hz > 50000) return HTEX_DEVICE_FAILED;
#elif defined FAULT_ACCEPTS_RATE
    if (!(rate_hz >= 100)) rate_hz = 100;
    if (rate_hz > 100000) rate_hz = 100000;
#elif defined FAULT_TWO
    if (opened) return HTEX_DEVICE_FAILED;
#elif defined FAULT_OPENINGS_LEAK
    kept = memset(malloc(65536), 1, 65536);
#elif defined FAULT_ACCEPTS_BLOCK
    if (block_frames < 1) block_frames = 1;
#endif
    int64_t handle = good()->open(settings, settings_len, rate_hz, block_frames);
#ifdef FAULT_OPEN_ACCEPTS_SETTING
    if (handle == HTEX_DEVICE_INVALID_SETTING)
        handle = good()->open((const uint8_t *)usual, sizeof usual - 1, rate_hz, block_frames);
#endif
    if (handle > 0) opened++;
    return handle;
}

#ifdef FAULT_CLOSED_GOES_ON
static int64_t refused; /* the device that refused a sample */
#endif
#ifdef FAULT_WRITE_AFTER_FINISH
static int64_t finished;
#endif

static int64_t bad_write(int64_t device, const float *samples, size_t frames,
                          uint32_t timeout_ms) {
#if defined FAULT_WRITE_NOTHING
    return 0;
#elif defined FAULT_WRITE_CRASHES
    if (frames > 100) abort();
#elif defined FAULT_WRITE_LOOPS
    for (volatile int forever = frames > 100; forever;) {}
#elif defined FAULT_WRITE_TOO_MANY
    if (frames > 100) return (int64_t)frames + 1;
#elif defined FAULT_LEAK
    kept = memset(malloc(1024), 1, 1024);
#elif defined FAULT_WRITE_AFTER_FINISH
    if (device == finished) return (int64_t)frames;
#elif defined FAULT_CLOSED_GOES_ON
    if (device == refused) return (int64_t)frames;
#elif defined FAULT_ACCEPTS_NULL
    if (frames && !samples) return (int64_t)frames;
#elif defined FAULT_ACCEPTS_MISALIGNED
    if ((uintptr_t)samples % sizeof *samples) return (int64_t)frames;
#endif
#if defined FAULT_OVER_LIMIT || defined FAULT_NAN
    float clipped[3];
    for (size_t i = 0; frames == 3 && i < frames; i++) {
        clipped[i] = samples[i];
#ifdef FAULT_OVER_LIMIT
        if (isfinite(samples[i])) clipped[i] = fmaxf(-1, fminf(1, samples[i]));
#else
        if (!isfinite(samples[i])) clipped[i] = 0;
#endif
    }
    if (frames == 3) samples = clipped;
#endif
    int64_t answer = good()->write(device, samples, frames, timeout_ms);
#ifdef FAULT_CLOSED_GOES_ON
    if (answer == HTEX_DEVICE_OVER_LIMIT && isnan(samples[1])) refused = device;
#endif
    return answer;
}

static int64_t bad_status(int64_t device, double *out, size_t capacity) {
    int64_t answer = good()->status(device, out, capacity);
#ifdef FAULT_STATUS_BEYOND
    double whole[HTEX_DEVICE_STATUS_NUMBERS];
    if (answer > 0 && capacity) {
        good()->status(device, whole, HTEX_DEVICE_STATUS_NUMBERS);
        memcpy(out, whole, sizeof whole);
    }
#endif
#ifdef FAULT_STATUS
    if (answer > 0 && capacity) out[HTEX_DEVICE_STATUS_FRAMES_WRITTEN] *= 2;
#elif defined FAULT_STATUS_SHORT
    if (answer > 0) return 2;
#elif defined FAULT_CLOSED_HANDLE
    if (answer == HTEX_DEVICE_BAD_HANDLE) return HTEX_DEVICE_STATUS_NUMBERS;
#endif
    return answer;
}

static int64_t bad_finish(int64_t device) {
    int64_t answer = good()->finish(device);
#ifdef FAULT_WRITE_AFTER_FINISH
    if (answer == HTEX_DEVICE_OK) finished = device;
#endif
    return answer;
}

static int64_t bad_close(int64_t device) {
#ifdef FAULT_LEFT_BEHIND
    good()->finish(device);
#endif
    int64_t answer = good()->close(device);
    if (answer == 0) opened--;
    return answer;
}

const htex_device_table *htex_device_adapter(void) {
    static htex_device_table table = {
        BOTH,
        .capabilities = bad_capabilities,
        .write = bad_write,
        .status = bad_status,
    };
    return &table;
}
