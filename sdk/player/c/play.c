/* Plays a block by a script and prints a hash of the samples' bits. On a host the block is a file; on the board
   mps2-an386 (board.c) QEMU loads it to memory. */
#include "htex_player.h"

#include <string.h>

static htex_player player;

static uint32_t add(uint32_t hash, uint32_t bits) {
    for (int i = 0; i < 4; i++) {
        hash = (hash ^ (bits >> (8 * i) & 0xFF)) * 0x01000193u;
    }
    return hash;
}

/* Returns the status of opening; writes FNV-1a of all samples. The script is that of tests/common/script.rs. */
int play(const uint8_t *block, size_t length, uint32_t *hash) {
    static const float motions[6][2] = {{80.0f, 0.4f}, {55.5f, 0.25f}, {0.0f, 0.0f}, {101.25f, 0.5f}, {1e6f, 100.0f}, {-60.0f, 0.3f}};
    static const size_t lengths[4] = {64, 1, 33, 200};
    static float samples[200];
    static int16_t integers[40];
    int status = htex_player_open(&player, block, length, 7);
    if (status != HTEX_PLAYER_OK) {
        return status;
    }
    if (htex_player_set_motion(&player, 0.0f / 0.0f, 1.0f) != HTEX_PLAYER_MOTION
        || htex_player_render(&player, 0, 1) != HTEX_PLAYER_POINTER) {
        return 100;
    }
    int quantity = htex_player_quantity(&player);
    const char *unit = htex_player_unit(&player);
    if (quantity < HTEX_PLAYER_LATERAL_FORCE || quantity > HTEX_PLAYER_DISPLACEMENT || unit[0] != (quantity <= HTEX_PLAYER_NORMAL_FORCE ? 'N' : 'm')
        || !(htex_player_full_scale(&player) > 0.0f) || htex_player_unit(0)[0] != 0) {
        return 101;
    }
    uint32_t sum = 0x811C9DC5u;
    for (int m = 0; m < 6; m++) {
        htex_player_set_motion(&player, motions[m][0], motions[m][1]);
        for (int l = 0; l < 4; l++) {
            htex_player_render(&player, samples, lengths[l]);
            for (size_t i = 0; i < lengths[l]; i++) {
                uint32_t bits;
                memcpy(&bits, &samples[i], sizeof bits);
                sum = add(sum, bits);
            }
        }
        htex_player_render_i16(&player, integers, 40, 0.5f);
        for (int i = 0; i < 40; i++) {
            sum = add(sum, (uint16_t)integers[i]);
        }
    }
    *hash = sum;
    return 0;
}

#ifndef BOARD
#include <stdio.h>

int main(int count, char **arguments) {
    static uint8_t block[1 << 20];
    FILE *file = count > 1 ? fopen(arguments[1], "rb") : 0;
    if (!file) {
        return 2;
    }
    size_t length = fread(block, 1, sizeof block, file);
    fclose(file);
    uint32_t hash = 0;
    int status = play(block, length, &hash);
    if (status != 0) {
        printf("status %d\n", status);
        return 1;
    }
    printf("hash %08x\n", (unsigned)hash);
    return 0;
}
#endif
