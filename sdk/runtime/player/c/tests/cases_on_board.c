/* Plays the cases that QEMU loads, and prints the FNV-1a hash of the results. */
#include "board.h"
#include "cases.h"

/* In memory, the length precedes the cases. */
enum { MOST_BYTES = 11 * 1024 };

static uint64_t memory[MOST_BYTES / sizeof(uint64_t)];
static uint32_t hash;

void *memory_of(size_t size)
{
    if (size > sizeof memory) {
        print("error: too little memory\n");
    }
    return memory;
}

void release(void *released)
{
    (void)released;
}

void put(const void *bytes, size_t length)
{
    const uint8_t *byte = bytes;
    while (length-- > 0) {
        hash = (hash ^ *byte++) * 0x01000193u;
    }
}

void program(void)
{
    uint32_t length = loaded[0] | (uint32_t)loaded[1] << 8 | (uint32_t)loaded[2] << 16 | (uint32_t)loaded[3] << 24;
    hash = 0x811C9DC5u;
    int wrong = play_cases(loaded + 4, length);
    if (wrong) {
        print_number("error: cases.c, line ", (uint32_t)wrong);
    } else {
        print_hex("hash ", hash);
    }
}
