/* Plays cases from one piece of memory and passes on the results (format:
   sdk/runtime/player/tests/it/common/stream.rs). */
#ifndef CASES_H
#define CASES_H

#include <stddef.h>
#include <stdint.h>

/* Plays all cases. Returns 0, or the line of cases.c at which the player did something wrong. */
int play_cases(const uint8_t *cases, size_t length);

/* A program for a board or a host defines these: memory for a player, its release, and the output
   of results. */
void *memory_of(size_t size);
void release(void *memory);
void put(const void *bytes, size_t length);

#endif
