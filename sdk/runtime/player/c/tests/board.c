/* Reset, output and timer of boards with a Cortex-M or RISC-V; link with cortex_m.ld or
   riscv32.ld. */
#include "board.h"

extern uint32_t stack_top;

/* Compilers may call these two functions; their own code must not be compiled to such calls. */
#define PLAIN __attribute__((optimize("no-tree-loop-distribute-patterns")))

PLAIN void *memset(void *to, int value, size_t length)
{
    uint8_t *bytes = to;
    uint32_t word = 0x01010101u * (uint8_t)value;
    for (; length > 0 && (uintptr_t)bytes % 4 != 0; length--) {
        *bytes++ = (uint8_t)value;
    }
    for (; length >= 4; length -= 4) {
        __builtin_memcpy(bytes, &word, 4);
        bytes += 4;
    }
    while (length-- > 0) {
        *bytes++ = (uint8_t)value;
    }
    return to;
}

PLAIN void *memcpy(void *to, const void *from, size_t length)
{
    uint8_t *bytes = to;
    const uint8_t *source = from;
    while (length-- > 0) {
        *bytes++ = *source++;
    }
    return to;
}

/* Calls the debugger, which is QEMU. */
#if defined(__riscv)
static int semihosting(int operation, const void *argument)
{
    register int a0 __asm__("a0") = operation;
    register const void *a1 __asm__("a1") = argument;
    __asm__ volatile(".option push\n .option norvc\n .balign 16\n slli x0, x0, 0x1f\n ebreak\n srai x0, x0, 7\n .option pop"
                     : "+r"(a0)
                     : "r"(a1)
                     : "memory");
    return a0;
}
#else
static int semihosting(int operation, const void *argument)
{
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}
#endif

static void stop(void)
{
    for (;;) {
        semihosting(0x18, (const void *)0x20026);
    }
}

void print(const char *text)
{
    semihosting(0x04, text);
}

void print_hex(const char *label, uint32_t number)
{
    print(label);
    for (int i = 28; i >= 0; i -= 4) {
        char digit = "0123456789abcdef"[number >> i & 15];
        semihosting(0x03, &digit);
    }
    print("\n");
}

void print_number(const char *label, uint32_t number)
{
    char digits[11];
    int at = 10;
    digits[at] = 0;
    do {
        digits[--at] = (char)('0' + number % 10);
        number /= 10;
    } while (number > 0);
    print(label);
    print(&digits[at]);
    print("\n");
}

static void fault(void)
{
    print("error: a fault of the processor\n");
    stop();
}

#if defined(__riscv)
void start(void);

void start(void)
{
    program();
    stop();
}

__attribute__((naked, section(".vectors"), used)) void reset(void);

__attribute__((naked, section(".vectors"), used)) void reset(void)
{
    __asm__ volatile(".option arch, +zicsr\n la sp, stack_top\n la t0, %0\n csrw mtvec, t0\n j start" : : "i"(fault));
}
#else
#define REGISTER(address) (*(volatile uint32_t *)(address))
#define TIMER_CONTROL REGISTER(0xE000E010)
#define TIMER_RELOAD REGISTER(0xE000E014)
#define TIMER_VALUE REGISTER(0xE000E018)

/* The timer counts down at 25 MHz, and an instruction takes 1 ns. */
void start_timer(void)
{
    TIMER_RELOAD = 0x00FFFFFF;
    TIMER_VALUE = 0;
    TIMER_CONTROL = 7;
}

uint32_t instructions(void)
{
    uint32_t ticks = 0x00FFFFFF - TIMER_VALUE;
    return 40 * ticks;
}

void start_interrupts(uint32_t period)
{
    TIMER_RELOAD = period - 1;
    TIMER_VALUE = 0;
    TIMER_CONTROL = 7;
}

__attribute__((weak)) void on_timer(void)
{
    print("error: the timer is too short\n");
    stop();
}

__attribute__((weak)) void on_pending(void)
{
    fault();
}

void reset(void);

/* Enables the floating-point unit, which is two coprocessors. A Cortex-M0 has none. */
__attribute__((used)) void reset(void)
{
#if defined(__ARM_FP)
    REGISTER(0xE000ED88) |= 0xFu << 20;
    __asm__ volatile("dsb\n isb");
#endif
    program();
    stop();
}

#define F fault
__attribute__((section(".vectors"), used)) static void (*const vectors[16])(void) = {
    (void (*)(void)) & stack_top, reset, F, F, F, F, F, F, F, F, F, F, F, F, on_pending, on_timer};
#endif
