/* Counts the instructions that the block loaded by QEMU takes: per sample, per sample while a
   motion changes, to set a motion, and to set it again. The board has a timer and a floating-point
   unit. */
#include "board.h"
#include "htex_player.h"

enum { MOST_BYTES = 24 * 1024, COUNTED = 2400, AT_ONCE = 64 };

static uint64_t memory[MOST_BYTES / sizeof(uint64_t)];
static float buffer[AT_ONCE];

static uint32_t rendered(htex_player *player, size_t count)
{
    start_timer();
    for (size_t from = 0; from < count; from += AT_ONCE) {
        size_t left = count - from;
        htex_player_render(player, buffer, left < AT_ONCE ? left : AT_ONCE);
    }
    return instructions() / (uint32_t)count;
}

static uint32_t set(htex_player *player, float speed, float force)
{
    start_timer();
    htex_player_set_motion(player, speed, force);
    return instructions();
}

void program(void)
{
    htex_player *player = (htex_player *)(void *)memory;
    size_t length = 0x00100000;
    size_t size = htex_player_size(loaded, length);
    if (size > sizeof memory || htex_player_open(player, sizeof memory, loaded, length, 7) != HTEX_PLAYER_OK) {
        print("error: the block is refused\n");
        return;
    }
    htex_player_set_motion(player, 80.0f, 0.4f);
    rendered(player, COUNTED);
    print_number("sample ", rendered(player, COUNTED));
    print_number("motion ", set(player, 87.0f, 0.43f));
    print_number("again ", set(player, 87.0f, 0.43f));
    print_number("gliding ", rendered(player, 96));
    print_number("bytes ", (uint32_t)size);
}
