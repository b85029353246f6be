/* Reset and output of the board mps2-an386 for play.c: arm-none-eabi-gcc -DBOARD with board.ld of the Rust example. */
#include <stddef.h>
#include <stdint.h>

int play(const uint8_t *block, size_t length, uint32_t *hash);
void reset(void);
extern uint32_t stack_top;

static int semihosting(int operation, const void *argument) {
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static void print_hex(uint32_t number) {
    for (int i = 28; i >= 0; i -= 4) {
        char digit = "0123456789abcdef"[number >> i & 15];
        semihosting(0x03, &digit);
    }
}

__attribute__((noinline)) static void run(void) {
    uint32_t hash = 0;
    int status = play((const uint8_t *)0x00200000, 0x00100000, &hash);
    semihosting(0x04, status == 0 ? "hash " : "status ");
    print_hex(status == 0 ? hash : (uint32_t)status);
    semihosting(0x04, "\n");
}

void reset(void) {
    /* The floating-point unit. */
    *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20;
    __asm__ volatile("dsb\n isb");
    run();
    for (;;) {
        semihosting(0x18, (const void *)0x20026);
    }
}

static void fault(void) {
    semihosting(0x04, "error: a fault of the processor\n");
    semihosting(0x18, (const void *)0x20026);
}

__attribute__((section(".vectors"), used)) static const void *const vectors[8] = {
    &stack_top, (void *)reset, (void *)fault, (void *)fault, (void *)fault, (void *)fault, (void *)fault, (void *)fault};
