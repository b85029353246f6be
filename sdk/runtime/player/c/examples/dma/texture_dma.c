#include "texture_dma.h"

#include "cloth.h"
#include "htex_player.h"

static HTEX_PLAYER_MEMORY(memory, TEXTURE_CLOTH_NUMBERS);

int16_t texture_samples[2 * TEXTURE_HALF];

/* Reads the motion once per half, where the samples are made. So only one interrupt uses the player
   and the motion. */
static void fill(int16_t *half)
{
    float speed;
    float force;
    finger_read(&speed, &force);
    htex_player_set_motion(&memory.player, speed, force);
    htex_player_render_i16(&memory.player, half, TEXTURE_HALF, htex_player_full_scale(&memory.player));
}

int texture_start(uint32_t seed)
{
    int status = htex_player_open(&memory.player, sizeof memory, texture_cloth, sizeof texture_cloth, seed);
    if (status == HTEX_PLAYER_OK) {
        fill(texture_samples);
        fill(texture_samples + TEXTURE_HALF);
    }
    return status;
}

void texture_half_sent(void)
{
    fill(texture_samples);
}

void texture_all_sent(void)
{
    fill(texture_samples + TEXTURE_HALF);
}
