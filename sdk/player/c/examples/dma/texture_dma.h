/* A texture by a converter with DMA: two halves of a buffer in turn, of which one is sent while the other is filled. */
#ifndef TEXTURE_DMA_H
#define TEXTURE_DMA_H

#include <stdint.h>

/* Samples of a half. At 8 kHz, 64 are 8 ms, by which a motion is late at most. */
enum { TEXTURE_HALF = 64 };

/* What the DMA controller sends again and again. */
extern int16_t texture_samples[2 * TEXTURE_HALF];

/* Opens the texture and fills both halves, before the transfer begins. Returns a status of htex_player.h. */
int texture_start(uint32_t seed);

/* The two interrupts of the transfer: the first half was sent, and the second half was sent. Of an STM32, for instance,
   HAL_SAI_TxHalfCpltCallback and HAL_SAI_TxCpltCallback call them. Each has the time of a half to end. */
void texture_half_sent(void);
void texture_all_sent(void);

/* The program's: the speed of the finger, mm/s, and its normal force, newtons, at this time. */
void finger_read(float *speed_mm_s, float *force_n);

#endif
