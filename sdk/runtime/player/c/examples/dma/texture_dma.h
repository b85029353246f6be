/* Renders a texture for a converter with DMA. The buffer has two halves: one is sent while the
   other is filled. */
#ifndef TEXTURE_DMA_H
#define TEXTURE_DMA_H

#include <stdint.h>

/* Samples in a half. At 8 kHz, 64 samples are 8 ms: a motion takes effect at most this much
   later. */
enum { TEXTURE_HALF = 64 };

/* The buffer that the DMA controller sends again and again. */
extern int16_t texture_samples[2 * TEXTURE_HALF];

/* Opens the texture and fills both halves. Call it before the transfer begins. Returns a status of
   htex_player.h. */
int texture_start(uint32_t seed);

/* Call these from the two interrupts of the transfer: when the first half was sent, and when the
   second half was sent. On an STM32, for example, from HAL_SAI_TxHalfCpltCallback and
   HAL_SAI_TxCpltCallback. Each has to return within the duration of a half. */
void texture_half_sent(void);
void texture_all_sent(void);

/* Implement this in your program: the current speed of the finger, mm/s, and its normal force,
   newtons. */
void finger_read(float *speed_mm_s, float *force_n);

#endif
