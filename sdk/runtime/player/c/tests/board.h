/* What a program can use on a board that QEMU emulates, without an operating system or a C
   library. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* The program. It runs once, after reset. */
void program(void);

/* Address at which QEMU loads the data that the program reads (-device loader). */
extern const uint8_t loaded[];

void print(const char *text);
void print_number(const char *label, uint32_t number);
void print_hex(const char *label, uint32_t number);

/* Number of instructions since the timer was started, at most 6e8. On Cortex-M with -icount
   shift=0, in steps of 40. */
void start_timer(void);
uint32_t instructions(void);

/* Calls on_timer every `period` ticks of 40 ns; on_timer may request on_pending. Programs define
   both. */
void start_interrupts(uint32_t period);
void on_timer(void);
void on_pending(void);

#endif
