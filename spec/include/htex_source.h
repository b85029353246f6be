/* htex_source.h: the source ABI of htex, version 1.0, for C11, C++17 and later.
 *
 * A source delivers samples of one or more channels at one rate: an amplifier of a force sensor, a
 * microphone, a file. It is one native library that defines the functions below; include this header
 * and define them, the export needs nothing more. source-abi-1.md beside this folder is the normative
 * text; this header states each function's contract in brackets:
 *
 *   [any thread]      the host may call it from any thread, from several at the same time
 *   [one at a time]   never called for the same source from two threads at the same time
 *   [may wait]        may wait for a driver or a clock; what is not marked so returns at once
 *
 * Results: functions of type int64_t return a length, a count, a handle or HTEX_SOURCE_OK; below
 * zero they return a status, and htex_source_last_error gives the reason.
 *
 * Memory: every array belongs to the caller and may be used during the call only. An array of
 * length 0 may be null. Arrays are aligned as their type wants. What a source keeps, it copies.
 *
 * Settings are UTF-8 lines "name=value\n", one for each setting of the descriptor and in its order,
 * profiles and defaults already settled.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef HTEX_SOURCE_H
#define HTEX_SOURCE_H

#include <stddef.h>
#include <stdint.h>

/* ---- constants ---- */

#define HTEX_SOURCE_ABI_MAJOR 1
#define HTEX_SOURCE_ABI_MINOR 0
/* What htex_source_abi_version returns: "HS", the major version, the minor version. */
#define HTEX_SOURCE_ABI_MARKER 0x48530100

/* Most bytes any text may have, one way or the other. */
#define HTEX_SOURCE_MAX_TEXT_BYTES 1048576
/* Most settings a descriptor may have, and most profiles. */
#define HTEX_SOURCE_MAX_SETTINGS 64
/* Most channels of a source; the least is one. */
#define HTEX_SOURCE_MAX_CHANNELS 1024
/* Most bytes of a channel's name or unit. */
#define HTEX_SOURCE_MAX_NAME_BYTES 256
/* Lowest and highest rate of a source, Hz. */
#define HTEX_SOURCE_MIN_RATE_HZ 0.001
#define HTEX_SOURCE_MAX_RATE_HZ 10000000.0

/* ---- statuses ---- */

/* The call did what it says. */
#define HTEX_SOURCE_OK 0
/* A pointer or length is not usable, or a text is not UTF-8. */
#define HTEX_SOURCE_INVALID_ARGUMENT (-1)
/* A setting is not known, missing, or not usable; the text begins with "NAME: ". */
#define HTEX_SOURCE_INVALID_SETTING (-2)
/* The source does not sample at this rate. */
#define HTEX_SOURCE_INVALID_RATE (-3)
/* A driver is not installed, or no such source is connected. */
#define HTEX_SOURCE_MISSING (-4)
/* The source is connected, and already in use. */
#define HTEX_SOURCE_BUSY (-5)
/* Frames were lost because they were read too late. The text says what to do. */
#define HTEX_SOURCE_OVERRUN (-6)
/* The source has ended, as a file does; there are no more frames. */
#define HTEX_SOURCE_END (-7)
/* The source was not started, or the call came after its stop or after an error. */
#define HTEX_SOURCE_CLOSED (-8)
/* A file could not be read; the text begins with "PATH: ". */
#define HTEX_SOURCE_FILE (-9)
/* No such source is open, or it was closed. */
#define HTEX_SOURCE_BAD_HANDLE (-10)
/* The source's code panicked. */
#define HTEX_SOURCE_PANICKED (-11)
/* Any other failure, told by the last-error text. */
#define HTEX_SOURCE_FAILED (-12)

/* ---- export ---- */

#if defined(_WIN32)
#define HTEX_SOURCE_EXPORT(name) __declspec(dllexport)
#else
#define HTEX_SOURCE_EXPORT(name) __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- the adapter ---- */

/* Returns HTEX_SOURCE_ABI_MARKER. [any thread] */
HTEX_SOURCE_EXPORT(htex_source_abi_version)
uint32_t htex_source_abi_version(void);

/* Writes the descriptor, UTF-8 JSON as schemas/source-descriptor-1.json has it and without a final
 * zero, to out[0..capacity]; returns its whole length, of which no more than `capacity` were
 * written. Returns the same text at each call. [any thread] */
HTEX_SOURCE_EXPORT(htex_source_descriptor)
int64_t htex_source_descriptor(uint8_t *out, size_t capacity);

/* Writes the UTF-8 text of the calling thread's last error; returns its whole length, as
 * htex_source_descriptor does. 0: there was none. [any thread] */
HTEX_SOURCE_EXPORT(htex_source_last_error)
int64_t htex_source_last_error(uint8_t *out, size_t capacity);

/* Writes the sources that are connected now, a JSON array as schemas/device-endpoints-1.json has it;
 * returns its whole length, which may change from call to call. [any thread, may wait] */
HTEX_SOURCE_EXPORT(htex_source_endpoints)
int64_t htex_source_endpoints(uint8_t *out, size_t capacity);

/* ---- open sources ---- */

/* Opens a source, which does not sample yet; returns its handle, greater than zero. The host closes
 * it. [any thread, may wait] */
HTEX_SOURCE_EXPORT(htex_source_open)
int64_t htex_source_open(const uint8_t *settings, size_t settings_len);

/* Writes the rate and the channels, JSON as schemas/source-stream-1.json has it; returns its whole
 * length. Returns the same text at each call for a source. [one at a time] */
HTEX_SOURCE_EXPORT(htex_source_stream)
int64_t htex_source_stream(int64_t source, uint8_t *out, size_t capacity);

/* Begins to sample; returns HTEX_SOURCE_OK, also when it samples already. [one at a time, may wait] */
HTEX_SOURCE_EXPORT(htex_source_start)
int64_t htex_source_start(int64_t source);

/* Writes frames, in each a sample of each channel in turn, to samples[0..len]: those that are there,
 * and waits up to `timeout_ms` for the first; returns how many frames, or HTEX_SOURCE_END. `len` is a
 * multiple of the number of channels. Samples are finite. [one at a time, may wait] */
HTEX_SOURCE_EXPORT(htex_source_read)
int64_t htex_source_read(int64_t source, double *samples, size_t len, uint32_t timeout_ms);

/* Stops sampling for good; returns HTEX_SOURCE_OK, also when it was stopped before.
 * [one at a time, may wait] */
HTEX_SOURCE_EXPORT(htex_source_stop)
int64_t htex_source_stop(int64_t source);

/* Closes a source, and stops it if it samples; its handle is refused from then on. Returns
 * HTEX_SOURCE_OK. [one at a time] */
HTEX_SOURCE_EXPORT(htex_source_close)
int64_t htex_source_close(int64_t source);

/* ---- growth ---- */

/* Returns 1 if the extension named by UTF-8 `id`, "htex.NAME/REV" or "com.vendor.NAME/REV", is
 * there, else 0. [any thread] */
HTEX_SOURCE_EXPORT(htex_source_extension)
int64_t htex_source_extension(const uint8_t *id, size_t id_len);

#ifdef __cplusplus
}
#endif

#endif
