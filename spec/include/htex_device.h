/* htex_device.h: the device ABI of htex, version 1.0, for C11, C++17 and later.
 *
 * A device takes samples of one quantity at one rate. It is one native library that defines the
 * functions below; include this header and define them, the export needs nothing more.
 * device-abi-1.md beside this folder is the normative text; this header states each function's
 * contract in brackets:
 *
 *   [any thread]      the host may call it from any thread, from several at the same time
 *   [one at a time]   never called for the same device from two threads at the same time
 *   [may wait]        may wait for a driver or a clock; what is not marked so answers at once
 *
 * Answers: functions of type int64_t answer a length, a count, a handle or HTEX_DEVICE_OK; below
 * zero they answer a status, and htex_device_last_error tells the reason.
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
/* What htex_device_abi_version answers: "HD", the major version, the minor version. */
#define HTEX_DEVICE_ABI_MARKER 0x48440100

/* Most bytes any text may have, one way or the other. */
#define HTEX_DEVICE_MAX_TEXT_BYTES 1048576
/* Most settings a descriptor may have, and most profiles. */
#define HTEX_DEVICE_MAX_SETTINGS 64
/* Lowest and highest rate of a device. */
#define HTEX_DEVICE_MIN_RATE_HZ 1.0
#define HTEX_DEVICE_MAX_RATE_HZ 10000000.0
/* Most frames a block may have that a device asks for or is opened for; the least is one. */
#define HTEX_DEVICE_MAX_BLOCK_FRAMES 1048576

/* Places of the numbers that htex_device_status writes. */
/* Frames taken since the device was opened. */
#define HTEX_DEVICE_STATUS_FRAMES_WRITTEN 0
/* Frames that came out. */
#define HTEX_DEVICE_STATUS_FRAMES_PLAYED 1
/* Times the device ran dry. */
#define HTEX_DEVICE_STATUS_UNDERRUNS 2
/* Seconds from writing a sample to its coming out. */
#define HTEX_DEVICE_STATUS_LATENCY_S 3
/* Largest magnitude taken, in the quantity's unit. */
#define HTEX_DEVICE_STATUS_PEAK 4
/* How many there are, of which every device knows these. */
#define HTEX_DEVICE_STATUS_NUMBERS 5

/* ---- statuses ---- */

/* The call did what it says. */
#define HTEX_DEVICE_OK 0
/* A pointer, length or block size is not usable, or a text is not UTF-8. */
#define HTEX_DEVICE_INVALID_ARGUMENT (-1)
/* A setting is not known, missing, or not usable; the text begins with "NAME: ". */
#define HTEX_DEVICE_INVALID_SETTING (-2)
/* The device does not run at this rate. */
#define HTEX_DEVICE_INVALID_RATE (-3)
/* A driver is not installed, or no such device is connected. */
#define HTEX_DEVICE_MISSING (-4)
/* The device is there, and somebody has it already. */
#define HTEX_DEVICE_BUSY (-5)
/* A sample is over the limit or not a number; the output is at zero. */
#define HTEX_DEVICE_OVER_LIMIT (-6)
/* The device ran dry; the output is at zero. The text says what to do. */
#define HTEX_DEVICE_UNDERFLOW (-7)
/* The call came after the end or after an error. */
#define HTEX_DEVICE_CLOSED (-8)
/* A file could not be written; the text begins with "PATH: ". */
#define HTEX_DEVICE_FILE (-9)
/* No such device is open, or it was closed. */
#define HTEX_DEVICE_BAD_HANDLE (-10)
/* The device's code panicked; the output is at zero. */
#define HTEX_DEVICE_PANICKED (-11)
/* Any other failure, told by the last-error text. */
#define HTEX_DEVICE_FAILED (-12)

/* ---- export ---- */

#if defined(_WIN32)
#define HTEX_DEVICE_EXPORT(name) __declspec(dllexport)
#else
#define HTEX_DEVICE_EXPORT(name) __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- the adapter ---- */

/* Answers HTEX_DEVICE_ABI_MARKER. [any thread] */
HTEX_DEVICE_EXPORT(htex_device_abi_version)
uint32_t htex_device_abi_version(void);

/* Writes the descriptor, UTF-8 JSON as schemas/device-descriptor-1.json has it and without a final
 * zero, to out[0..capacity]; answers its whole length, of which no more than `capacity` were
 * written. Answers the same text at each call. [any thread] */
HTEX_DEVICE_EXPORT(htex_device_descriptor)
int64_t htex_device_descriptor(uint8_t *out, size_t capacity);

/* Writes the UTF-8 text of the calling thread's last error; answers its whole length, as
 * htex_device_descriptor does. 0: there was none. [any thread] */
HTEX_DEVICE_EXPORT(htex_device_last_error)
int64_t htex_device_last_error(uint8_t *out, size_t capacity);

/* Writes the devices that are there now, a JSON array as schemas/device-endpoints-1.json has it;
 * answers its whole length, which may change from call to call. [any thread, may wait] */
HTEX_DEVICE_EXPORT(htex_device_endpoints)
int64_t htex_device_endpoints(uint8_t *out, size_t capacity);

/* Writes what a device of these settings can do, JSON as schemas/device-capabilities-1.json has it;
 * answers its whole length. Opens nothing. [any thread, may wait] */
HTEX_DEVICE_EXPORT(htex_device_capabilities)
int64_t htex_device_capabilities(const uint8_t *settings, size_t settings_len, uint8_t *out,
                                 size_t capacity);

/* ---- open devices ---- */

/* Opens a device, silent and at zero, for blocks of `block_frames`; answers its handle, greater
 * than zero. The host closes it. [any thread, may wait] */
HTEX_DEVICE_EXPORT(htex_device_open)
int64_t htex_device_open(const uint8_t *settings, size_t settings_len, double rate_hz,
                         uint32_t block_frames);

/* Takes samples, as many as there is room for within `timeout_ms` (0: those that fit now); answers
 * how many. The first start the device. A sample over the limit or not a number is refused with all
 * of the call, and puts the output to zero for good. [one at a time, may wait] */
HTEX_DEVICE_EXPORT(htex_device_write)
int64_t htex_device_write(int64_t device, const float *samples, size_t frames,
                          uint32_t timeout_ms);

/* Writes the numbers at HTEX_DEVICE_STATUS_…, no more than `capacity`; answers how many there are.
 * [one at a time] */
HTEX_DEVICE_EXPORT(htex_device_status)
int64_t htex_device_status(int64_t device, double *out, size_t capacity);

/* Plays what was written to its end, goes to zero and keeps the result (a file appears under its
 * name); answers HTEX_DEVICE_OK. Nothing can be written afterwards. [one at a time, may wait] */
HTEX_DEVICE_EXPORT(htex_device_finish)
int64_t htex_device_finish(int64_t device);

/* Closes a device; its handle is refused from then on. Without htex_device_finish before, it
 * aborts: the output goes to zero at once, and a file that was being written is not left behind.
 * Answers HTEX_DEVICE_OK. [one at a time] */
HTEX_DEVICE_EXPORT(htex_device_close)
int64_t htex_device_close(int64_t device);

/* ---- growth ---- */

/* Answers 1 if the extension named by UTF-8 `id`, "htex.NAME/REV" or "com.vendor.NAME/REV", is
 * there, else 0. [any thread] */
HTEX_DEVICE_EXPORT(htex_device_extension)
int64_t htex_device_extension(const uint8_t *id, size_t id_len);

#ifdef __cplusplus
}
#endif

#endif
