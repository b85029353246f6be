/* Cases for the player, in one piece of memory, and what it makes of them (sdk/player/tests/common/stream.rs). */
#ifndef CASES_H
#define CASES_H

#include <stddef.h>
#include <stdint.h>

/* Plays all cases; 0, or the number of a line of cases.c where the player did what it must not. */
int play_cases(const uint8_t *cases, size_t length);

/* What a program for a board or a host has: memory of a player, its release, and where results go. */
void *memory_of(size_t size);
void release(void *memory);
void put(const void *bytes, size_t length);

#endif
