/* htex_voices_1.h: the extension "htex.voices/1" of the model ABI: several voices of one model,
 * rendered in one call. A native library has it if htex_model_extension answers 1 to the id; see
 * section 10 of model-abi-1.md.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef HTEX_VOICES_1_H
#define HTEX_VOICES_1_H

#include "htex_model.h"

/* Most voices that one call takes. */
#define HTEX_VOICES_1_MAX_VOICES 16

#ifdef __cplusplus
extern "C" {
#endif

/* Writes the next `frames` samples of each of `count` voices to out[0..count * frames], one voice
 * behind the other: what htex_model_voice_render writes of each, to the bit. Answers a status: of a
 * handle that is none HTEX_BAD_HANDLE, of one that comes twice, or more than
 * HTEX_VOICES_1_MAX_VOICES, HTEX_INVALID_ARGUMENT; no voice has then moved on.
 * [render thread, one at a time for each of the voices] */
HTEX_EXPORT(htex_voices_1_render)
int64_t htex_voices_1_render(const int64_t *voices, size_t count, float *out, size_t frames);

#ifdef __cplusplus
}
#endif

#endif
