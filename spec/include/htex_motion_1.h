/* htex_motion_1.h: the extension "htex.motion/1" of the model ABI: voices that are told how the finger
 * moves, and fits that are told at which motion the recording was made. A model has it if
 * htex_model_extension returns 1 for the id; see section 10 of model-abi-1.md.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#ifndef HTEX_MOTION_1_H
#define HTEX_MOTION_1_H

#include "htex_model.h"

/* Largest speed of a finger, mm/s, in either direction. */
#define HTEX_MOTION_1_MAX_SPEED_MM_S 1000000.0
/* Largest normal force of a finger, newtons. */
#define HTEX_MOTION_1_MAX_FORCE_N 1000000.0
/* Largest distance of a finger from where its path begins, and of its place from the origin, mm, in either direction. */
#define HTEX_MOTION_1_MAX_POSITION_MM 1000000000000.0

#ifdef __cplusplus
extern "C" {
#endif

/* Tells a voice the motion at its next sample: the speed along the finger's path (mm/s, negative while
 * the position falls), the normal force (newtons, not negative), the position along the path and the place
 * on the surface (mm, of either sign; where no place is known, x_mm is the position and y_mm is 0). Until the
 * next call the finger goes on at this speed. Returns a status; after a negative one the voice plays on as before. Infinities, NaN and numbers beyond the constants above are
 * HTEX_INVALID_ARGUMENT.
 * [render thread, one at a time] */
HTEX_EXPORT(htex_motion_1_set)
int64_t htex_motion_1_set(int64_t voice, double speed_mm_s, double force_n, double position_mm, double x_mm,
                          double y_mm);

/* As htex_model_fit, of a recording at a speed (mm/s) and a normal force (newtons), neither negative; NaN
 * where one is not known.
 * [any thread] */
HTEX_EXPORT(htex_motion_1_fit)
int64_t htex_motion_1_fit(double band_low_hz, double band_high_hz, const double *frequency_hz,
                          const double *magnitude, size_t bins, const double *signal,
                          size_t signal_len, double signal_rate_hz, const double *options,
                          size_t options_len, double speed_mm_s, double force_n, double *parameters,
                          size_t capacity, double *level_rms);

#ifdef __cplusplus
}
#endif

#endif
