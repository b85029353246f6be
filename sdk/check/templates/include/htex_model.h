/* htex_model.h: the model ABI of htex, version 1.0, for C11, C++17 and later.
 *
 * A model describes the spectrum of a touched surface by a few parameters. It is one native library
 * or one WASM module that defines the functions below; include this header and define them, the
 * export needs nothing more. model-abi-1.md beside this folder is the normative text; this header
 * states each function's contract in brackets:
 *
 *   [any thread]      the host may call it from any thread, from several at the same time
 *   [render thread]   called where sound is made: it must not allocate, lock, wait or do I/O
 *   [one at a time]   never called for the same voice from two threads at the same time
 *
 * A host enters an instance of a WASM module from one thread at a time only.
 *
 * Answers: functions of type int64_t answer a length, a handle or HTEX_OK; below zero they answer
 * a status, and htex_model_last_error tells the reason.
 *
 * Memory: every array belongs to the caller and may be used during the call only. An array of
 * length 0 may be null. Arrays are aligned as their type wants. What a model keeps, it copies.
 *
 * Parameters are one flat array laid out by the descriptor's fields: a scalar takes one number, a
 * list its length and then its numbers.
 *
 * Units: frequencies and rates in hertz, levels and signals in the unit of the asset's
 * quantity, which a model is not told (newtons for a force). A shape has unit RMS:
 * sqrt(sum of magnitude^2 / 3) = 1 over the multiples of HTEX_GRID_HZ in the band.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef HTEX_MODEL_H
#define HTEX_MODEL_H

#include <stddef.h>
#include <stdint.h>

/* ---- constants ---- */

#define HTEX_ABI_MAJOR 1
#define HTEX_ABI_MINOR 0
/* What htex_model_abi_version answers: "HT", the major version, the minor version. */
#define HTEX_ABI_MARKER 0x48540100

/* Most parameters one set may have, lengths of lists included. */
#define HTEX_MAX_PARAMETERS 65536
/* Most fields a descriptor may have; the least is one. */
#define HTEX_MAX_FIELDS 32
/* Most numbers one list may have. */
#define HTEX_MAX_LIST_LEN 65535
/* Most bytes a descriptor or an error text may have. */
#define HTEX_MAX_TEXT_BYTES 1048576
/* Fewest bins of a spectrum that is fitted. */
#define HTEX_MIN_BINS 3
/* Highest band edge. */
#define HTEX_MAX_BAND_HZ 1000000.0
/* Lowest and highest rate of a signal or a voice. */
#define HTEX_MIN_RATE_HZ 1.0
#define HTEX_MAX_RATE_HZ 10000000.0
/* Spacing of the grid on which spectra are fitted and a shape has unit RMS. */
#define HTEX_GRID_HZ 5.0
/* Alignment, bytes, of what htex_model_alloc answers. */
#define HTEX_ALLOC_ALIGN 16

/* ---- statuses ---- */

/* The call did what it says. */
#define HTEX_OK 0
/* A pointer, length, rate, band or weight is not usable. */
#define HTEX_INVALID_ARGUMENT (-1)
/* Parameters do not fit the descriptor's fields. */
#define HTEX_INVALID_PARAMETERS (-2)
/* A fit option does not fit the descriptor's options. */
#define HTEX_INVALID_OPTION (-3)
/* The spectrum holds nothing this model can be fitted to. */
#define HTEX_CANNOT_FIT (-4)
/* No such voice, or a voice that was freed. */
#define HTEX_BAD_HANDLE (-5)
/* No more voices can be made. */
#define HTEX_TOO_MANY_VOICES (-6)
/* The model panicked; the call had no effect that can be relied on. */
#define HTEX_PANICKED (-7)
/* Any other failure, told by the last-error text. */
#define HTEX_FAILED (-8)

/* ---- export ---- */

#if defined(__wasm__)
#define HTEX_EXPORT(name) __attribute__((export_name(#name)))
#elif defined(_WIN32)
#define HTEX_EXPORT(name) __declspec(dllexport)
#else
#define HTEX_EXPORT(name) __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- the model ---- */

/* Answers HTEX_ABI_MARKER. [any thread] */
HTEX_EXPORT(htex_model_abi_version)
uint32_t htex_model_abi_version(void);

/* Writes the descriptor, UTF-8 JSON as schemas/descriptor-1.json has it and without a final zero,
 * to out[0..capacity]; answers its whole length, of which no more than `capacity` were written.
 * Answers the same text at each call. [any thread] */
HTEX_EXPORT(htex_model_descriptor)
int64_t htex_model_descriptor(uint8_t *out, size_t capacity);

/* Writes the UTF-8 text of the last error, of this thread in a native library, of this instance in
 * a WASM module; answers its whole length, as htex_model_descriptor does. 0: there was none.
 * [any thread] */
HTEX_EXPORT(htex_model_last_error)
int64_t htex_model_last_error(uint8_t *out, size_t capacity);

/* Fits the model to a spectrum of `bins` magnitudes, in the asset's unit, at ascending frequencies. `signal` is
 * the recording behind it, in the same unit, and may be empty. `options` has one value for each option of
 * the descriptor. Writes the parameters, no more than `capacity`, and the level: RMS of the fitted
 * magnitude in the band, in that unit. Answers how many parameters there are; the caller comes again
 * with more room if need be. [any thread] */
HTEX_EXPORT(htex_model_fit)
int64_t htex_model_fit(double band_low_hz, double band_high_hz, const double *frequency_hz,
                       const double *magnitude, size_t bins, const double *signal,
                       size_t signal_len, double signal_rate_hz, const double *options,
                       size_t options_len, double *parameters, size_t capacity, double *level_rms);

/* Writes the shape's magnitude at `bins` frequencies, of unit RMS, zero outside the band, without
 * synthesis; answers a status. [any thread] */
HTEX_EXPORT(htex_model_magnitude)
int64_t htex_model_magnitude(const double *parameters, size_t parameters_len, double band_low_hz,
                             double band_high_hz, const double *frequency_hz, double *magnitude,
                             size_t bins);

/* Mixes `weights_len` sets of parameters that stand one behind the other in `sets`. Weights lie in
 * 0 to 1 and sum to 1. Writes the mix, no more than `capacity`; answers how many parameters it has.
 * [any thread] */
HTEX_EXPORT(htex_model_interpolate)
int64_t htex_model_interpolate(const double *sets, size_t sets_len, const double *weights,
                               size_t weights_len, double *parameters, size_t capacity);

/* ---- voices ---- */

/* Answers the rate at which a voice of these parameters renders when `wanted_hz` is wanted, or a
 * negative status; the host converts the rest. [any thread] */
HTEX_EXPORT(htex_model_voice_rate)
double htex_model_voice_rate(const double *parameters, size_t parameters_len, double band_low_hz,
                             double band_high_hz, double wanted_hz);

/* Makes a voice at `rate_hz`, which is what htex_model_voice_rate answered; answers its handle,
 * greater than zero. The host frees it. [any thread] */
HTEX_EXPORT(htex_model_voice_new)
int64_t htex_model_voice_new(const double *parameters, size_t parameters_len, double band_low_hz,
                             double band_high_hz, double rate_hz, uint64_t seed);

/* Writes the next `frames` samples, of unit RMS over time; answers a status.
 * [render thread, one at a time] */
HTEX_EXPORT(htex_model_voice_render)
int64_t htex_model_voice_render(int64_t voice, float *out, size_t frames);

/* Changes to other parameters without a click, from the next sample on; answers a status. A voice
 * that refuses plays on as before. [render thread, one at a time] */
HTEX_EXPORT(htex_model_voice_retune)
int64_t htex_model_voice_retune(int64_t voice, const double *parameters, size_t parameters_len);

/* Frees a voice; its handle is refused from then on. Answers a status.
 * [any thread, one at a time] */
HTEX_EXPORT(htex_model_voice_free)
int64_t htex_model_voice_free(int64_t voice);

/* ---- growth ---- */

/* Answers 1 if the extension named by UTF-8 `id`, "htex.NAME/REV" or "com.vendor.NAME/REV", is
 * there, else 0. [any thread] */
HTEX_EXPORT(htex_model_extension)
int64_t htex_model_extension(const uint8_t *id, size_t id_len);

/* ---- WASM modules only ---- */

/* Makes room for `len` bytes, zeroed, aligned to HTEX_ALLOC_ALIGN; answers null when there is none
 * or `len` is 0. The host owns the room until it gives it to htex_model_free. */
HTEX_EXPORT(htex_model_alloc)
uint8_t *htex_model_alloc(size_t len);

/* Takes back what htex_model_alloc answered to the same `len`; null does nothing. */
HTEX_EXPORT(htex_model_free)
void htex_model_free(uint8_t *pointer, size_t len);

#ifdef __cplusplus
}
#endif

#endif
