/* What a program has on a board that QEMU emulates, without an operating system and a library of C. */
#ifndef BOARD_H
#define BOARD_H

#include <stddef.h>
#include <stdint.h>

/* The program; it runs after reset, once. */
void program(void);

/* Where QEMU loads what the program reads (-device loader). */
extern const uint8_t loaded[];

void print(const char *text);
void print_number(const char *label, uint32_t number);
void print_hex(const char *label, uint32_t number);

/* Instructions since the timer was started; on Cortex-M with -icount shift=0, to 40. At most 6e8. */
void start_timer(void);
uint32_t instructions(void);

/* Calls on_timer each `period` ticks of 40 ns; it may ask for on_pending. Programs have their own of these. */
void start_interrupts(uint32_t period);
void on_timer(void);
void on_pending(void);

#endif
