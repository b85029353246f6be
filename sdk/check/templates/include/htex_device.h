/* htex_device.h: the device ABI of htex, version 1.0, for C11, C++17 and later.
 *
 * A device plays or records samples. An output takes samples of one quantity at one rate. An input
 * delivers samples of one or more channels at one rate. A device is one native library that exports
 * one function, htex_device_adapter, which returns a table of its functions. Include this header and
 * define that function; the export needs nothing more. device-abi-1.md beside this folder is the
 * normative text; this header states each function's contract in brackets:
 *
 *   [any thread]      the host may call it from any thread, from several at the same time
 *   [one at a time]   never called for the same device from two threads at the same time
 *   [may wait]        may wait for a driver or a clock; what is not marked so returns at once
 *
 * Results: functions of type int64_t return a length, a count, a handle or HTEX_DEVICE_OK; below
 * zero they return a status, and last_error gives the reason.
 *
 * Memory: every array belongs to the caller and may be used during the call only. An array of
 * length 0 may be null. Arrays are aligned as their type wants. What a device keeps, it copies.
 *
 * Settings are UTF-8 lines "name=value\n", one for each setting of the descriptor and in its order,
 * profiles and defaults already settled.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef HTEX_DEVICE_H
#define HTEX_DEVICE_H

#include <stddef.h>
#include <stdint.h>

/* ---- constants ---- */

#define HTEX_DEVICE_ABI_MAJOR 1
#define HTEX_DEVICE_ABI_MINOR 0
/* The marker of a table: "HD", the major version, the minor version. */
#define HTEX_DEVICE_ABI_MARKER 0x48440100

/* Most bytes any text may have, one way or the other. */
#define HTEX_DEVICE_MAX_TEXT_BYTES 1048576
/* Most settings a descriptor may have, and most profiles. */
#define HTEX_DEVICE_MAX_SETTINGS 64
/* Lowest rate of an output, and of an input, Hz. */
#define HTEX_DEVICE_MIN_RATE_HZ 1.0
#define HTEX_DEVICE_MIN_INPUT_RATE_HZ 0.001
/* Highest rate of a device, Hz. */
#define HTEX_DEVICE_MAX_RATE_HZ 10000000.0
/* Most frames of a block that an output asks for or is opened for; the least is one. */
#define HTEX_DEVICE_MAX_BLOCK_FRAMES 1048576
/* Most channels of an input; the least is one. */
#define HTEX_DEVICE_MAX_CHANNELS 1024
/* Most bytes of a channel's name or unit. */
#define HTEX_DEVICE_MAX_NAME_BYTES 256

/* Indices of the numbers that `status` writes. */
/* Frames taken since the device was opened. */
#define HTEX_DEVICE_STATUS_FRAMES_WRITTEN 0
/* Frames that were played. */
#define HTEX_DEVICE_STATUS_FRAMES_PLAYED 1
/* How often the device ran dry. */
#define HTEX_DEVICE_STATUS_UNDERRUNS 2
/* Seconds from writing a sample to its output. */
#define HTEX_DEVICE_STATUS_LATENCY_S 3
/* Largest magnitude taken, in the quantity's unit. */
#define HTEX_DEVICE_STATUS_PEAK 4
/* Number of these numbers. Every output has all of them. */
#define HTEX_DEVICE_STATUS_NUMBERS 5

/* ---- statuses ---- */

/* The call succeeded. */
#define HTEX_DEVICE_OK 0
/* A pointer, length or block size is not usable, or a text is not UTF-8. */
#define HTEX_DEVICE_INVALID_ARGUMENT (-1)
/* A setting is not known, missing, or not usable; the text begins with "NAME: ". */
#define HTEX_DEVICE_INVALID_SETTING (-2)
/* The device does not run at this rate. The text of an input says which rates there are. */
#define HTEX_DEVICE_INVALID_RATE (-3)
/* A driver is not installed, or no such device is connected. */
#define HTEX_DEVICE_MISSING (-4)
/* The device is connected, and already in use. */
#define HTEX_DEVICE_BUSY (-5)
/* A sample is over the limit or not a number; the output is at zero. */
#define HTEX_DEVICE_OVER_LIMIT (-6)
/* The output ran dry and is at zero. The text says what to do. */
#define HTEX_DEVICE_UNDERFLOW (-7)
/* The call came before the start, after the end or after an error. */
#define HTEX_DEVICE_CLOSED (-8)
/* A file could not be written or read; the text begins with "PATH: ". */
#define HTEX_DEVICE_FILE (-9)
/* No such device is open, or it was closed. */
#define HTEX_DEVICE_BAD_HANDLE (-10)
/* The device's code panicked; an output is at zero. */
#define HTEX_DEVICE_PANICKED (-11)
/* Any other failure; see the last-error text. */
#define HTEX_DEVICE_FAILED (-12)
/* Frames of an input were lost because they were read too late. The text says what to do. */
#define HTEX_DEVICE_OVERRUN (-13)
/* An input has ended, as a file does; there are no more frames. */
#define HTEX_DEVICE_END (-14)

/* ---- the table ---- */

/* The functions of a device. The last three of the other direction may be NULL: a host does not
 * call them. */
typedef struct htex_device_table {
    /* HTEX_DEVICE_ABI_MARKER. */
    uint32_t marker;
    /* sizeof(htex_device_table), which grows with the minor version. */
    uint32_t size;

    /* Writes the descriptor, UTF-8 JSON as schemas/device-descriptor-1.json has it and without a
     * final zero, to out[0..capacity]; returns its whole length, of which no more than `capacity`
     * were written. Returns the same text at each call. [any thread] */
    int64_t (*descriptor)(uint8_t *out, size_t capacity);

    /* Writes the UTF-8 text of the calling thread's last error; returns its whole length, as
     * `descriptor` does. 0: there was none. [any thread] */
    int64_t (*last_error)(uint8_t *out, size_t capacity);

    /* Writes the devices that are connected now, a JSON array as schemas/device-endpoints-1.json
     * has it; returns its whole length, which may change from call to call.
     * [any thread, may wait] */
    int64_t (*endpoints)(uint8_t *out, size_t capacity);

    /* Opens a device; returns its handle, greater than zero. The host closes it. An output is
     * opened for blocks of `block_frames`, silent and at zero. An input does not sample yet; its
     * `rate_hz` and `block_frames` are 0. [any thread, may wait] */
    int64_t (*open)(const uint8_t *settings, size_t settings_len, double rate_hz,
                    uint32_t block_frames);

    /* Ends the stream; returns HTEX_DEVICE_OK. An output plays what was written to its end, goes to
     * zero and keeps the result (a file appears under its name); nothing can be written afterwards.
     * An input stops sampling for good, also when it had stopped before.
     * [one at a time, may wait] */
    int64_t (*finish)(int64_t device);

    /* Closes a device; its handle is refused from then on. Without `finish` before, an output
     * aborts: it goes to zero at once, and a file that was being written is not left behind.
     * Returns HTEX_DEVICE_OK. [one at a time] */
    int64_t (*close)(int64_t device);

    /* Returns 1 if the extension named by UTF-8 `id`, "htex.NAME/REV" or "com.vendor.NAME/REV", is
     * there, else 0. [any thread] */
    int64_t (*extension)(const uint8_t *id, size_t id_len);

    /* Output: writes what a device of these settings can do, JSON as
     * schemas/device-capabilities-1.json has it; returns its whole length. Opens nothing.
     * [any thread, may wait] */
    int64_t (*capabilities)(const uint8_t *settings, size_t settings_len, uint8_t *out,
                            size_t capacity);

    /* Output: takes samples, as many as fit within `timeout_ms` (0: those that fit now); returns
     * how many. The first start the output. A sample over the limit or not a number is refused with
     * all of the call, and puts the output to zero for good. [one at a time, may wait] */
    int64_t (*write)(int64_t device, const float *samples, size_t frames, uint32_t timeout_ms);

    /* Output: writes the numbers at HTEX_DEVICE_STATUS_…, no more than `capacity`; returns how many
     * there are. [one at a time] */
    int64_t (*status)(int64_t device, double *out, size_t capacity);

    /* Input: writes the rate and the channels, JSON as schemas/device-stream-1.json has it; returns
     * its whole length. Returns the same text at each call for a device. [one at a time] */
    int64_t (*stream)(int64_t device, uint8_t *out, size_t capacity);

    /* Input: begins to sample; returns HTEX_DEVICE_OK, also when it samples already.
     * [one at a time, may wait] */
    int64_t (*start)(int64_t device);

    /* Input: writes frames, in each a sample of each channel in turn, to samples[0..len]: those
     * that are there, and waits up to `timeout_ms` for the first; returns how many frames, or
     * HTEX_DEVICE_END. `len` is a multiple of the number of channels. Samples are finite.
     * [one at a time, may wait] */
    int64_t (*read)(int64_t device, double *samples, size_t len, uint32_t timeout_ms);
} htex_device_table;

/* ---- export ---- */

#if defined(_WIN32)
#define HTEX_DEVICE_EXPORT __declspec(dllexport)
#else
#define HTEX_DEVICE_EXPORT __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Returns the table, which lives as long as the library. [any thread] */
HTEX_DEVICE_EXPORT const htex_device_table *htex_device_adapter(void);

#ifdef __cplusplus
}
#endif

#endif
