/* Runs the DMA example on a board. QEMU has no converter with DMA, so a timer takes its place. The
   timer's interrupt sends one sample every 125 us, and requests the interrupts of the example. Like
   the interrupts of a DMA controller, they have a lower priority. */
#include "board.h"
#include "texture_dma.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))
#define PEND REGISTER(0xE000ED04)
#define PRIORITIES REGISTER(0xE000ED20)

enum { SENT = 40 * TEXTURE_HALF, PERIOD = 3125, PEND_INTERRUPT = 1 << 28 };

static volatile uint32_t sent;
static volatile uint32_t filled;
static volatile uint32_t late;
static uint32_t readings;
static uint32_t hash;

/* A finger that changes its motion, rests, and leaves. */
void finger_read(float *speed_mm_s, float *force_n)
{
    *speed_mm_s = (float)(20 * (readings % 9));
    *force_n = 0.1f * (float)(readings % 7);
    readings++;
}

void on_timer(void)
{
    if (sent == SENT) {
        return;
    }
    /* A half must be filled before it is sent. Two were filled before the start. */
    late += sent / TEXTURE_HALF >= filled + 2;
    uint16_t sample = (uint16_t)texture_samples[sent % (2 * TEXTURE_HALF)];
    hash = (hash ^ (sample & 0xFFu)) * 0x01000193u;
    hash = (hash ^ sample >> 8) * 0x01000193u;
    sent++;
    if (sent % TEXTURE_HALF == 0) {
        PEND = PEND_INTERRUPT;
    }
}

void on_pending(void)
{
    if (filled % 2 == 0) {
        texture_half_sent();
    } else {
        texture_all_sent();
    }
    filled++;
}

void program(void)
{
    hash = 0x811C9DC5u;
    if (texture_start(7) != 0) {
        print("error: the texture is refused\n");
        return;
    }
    /* The timer may interrupt the pending interrupt. */
    PRIORITIES = 0x00FF0000;
    start_interrupts(PERIOD);
    while (sent < SENT) {
    }
    print_number("late ", late);
    print_hex("hash ", hash);
}
