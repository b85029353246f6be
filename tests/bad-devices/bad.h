/* What a faulty input and a faulty output share. */
#include <dlfcn.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "htex_device.h"

static const htex_device_table *good(void) {
    static void *library;
    if (!library) library = dlopen(GOOD_LIBRARY, RTLD_NOW | RTLD_LOCAL);
    void *symbol = library ? dlsym(library, "htex_device_adapter") : NULL;
    if (!symbol) abort();
    return ((const htex_device_table *(*)(void))symbol)();
}

/* Where a leak points last, so that a compiler does not leave it out. */
static void *volatile kept;

static int64_t give(const char *text, uint8_t *out, size_t capacity) {
    size_t len = strlen(text);
    if (capacity && !out) return -1; /* invalid argument */
    if (capacity) memcpy(out, text, capacity < len ? capacity : len);
    return (int64_t)len;
}

static int64_t bad_last_error(uint8_t *out, size_t capacity) {
#ifdef FAULT_SETTING_UNNAMED
    static const char text[] = "one of the settings is not usable";
    for (size_t i = 0; out && i < sizeof text - 1 && i < capacity; i++) out[i] = (uint8_t)text[i];
    if (out || !capacity) return sizeof text - 1;
#endif
    return good()->last_error(out, capacity);
}

static int64_t bad_endpoints(uint8_t *out, size_t capacity) {
#ifdef FAULT_ENDPOINTS
    return give("[{\"name\":\"a\",\"setting\":\"no_such\",\"summary\":\"A.\"}]", out, capacity);
#else
    return good()->endpoints(out, capacity);
#endif
}

static int64_t opened;

static int64_t bad_extension(const uint8_t *id, size_t id_len) {
#ifdef FAULT_EXTENSIONS
    return 1;
#else
    return good()->extension(id, id_len);
#endif
}

#ifdef FAULT_MARKER
#define MARKER 0x48540100 /* a model's */
#else
#define MARKER HTEX_DEVICE_ABI_MARKER
#endif
#ifdef FAULT_EXPORT_MISSING
#define FINISH NULL
#else
#define FINISH bad_finish
#endif
/* What a table of either has. */
#define BOTH                                                                                     \
    .marker = MARKER, .size = sizeof(htex_device_table), .descriptor = bad_descriptor,           \
    .last_error = bad_last_error, .endpoints = bad_endpoints, .open = bad_open,                  \
    .finish = FINISH, .close = bad_close, .extension = bad_extension
