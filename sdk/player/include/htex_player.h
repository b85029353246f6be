/* Plays textures that `htex bake` wrote (spec/baked-1.md). No heap, no operating system; needs single-precision
   floating point. Link libhtex_player.a (docs/microcontroller.md). */
#ifndef HTEX_PLAYER_H
#define HTEX_PLAYER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The memory of one playing texture. Its contents are private; a player may be copied and needs no release. */
typedef struct htex_player {
    uint64_t memory[1248];
} htex_player;

/* Status: 0, or one of these. */
enum {
    HTEX_PLAYER_OK = 0,
    HTEX_PLAYER_TOO_SHORT = 1,   /* fewer bytes than a header */
    HTEX_PLAYER_NOT_A_BLOCK = 2, /* does not begin with HTXB */
    HTEX_PLAYER_VERSION = 3,     /* not version 1: bake the asset again */
    HTEX_PLAYER_LENGTH = 4,      /* the length differs from the header's */
    HTEX_PLAYER_CHECKSUM = 5,    /* the bytes were changed */
    HTEX_PLAYER_HEADER = 6,      /* a number of the header is out of range */
    HTEX_PLAYER_VALUES = 7,      /* a number after the header is out of range */
    HTEX_PLAYER_AXES = 8,        /* speeds or forces do not ascend or are out of range */
    HTEX_PLAYER_POINTER = -1,    /* a pointer is null or misaligned */
    HTEX_PLAYER_MOTION = -2      /* speed or force is not finite */
};

/* Validates `length` bytes of a block and makes a player at its first condition. The block stays in place, in flash
   memory or RAM, unchanged while the player is used. Returns a status. */
int htex_player_open(htex_player *player, const uint8_t *block, size_t length, uint32_t seed);

/* Returns the rate of the samples, hertz. */
float htex_player_rate_hz(const htex_player *player);

/* Quantities of samples. */
enum {
    HTEX_PLAYER_LATERAL_FORCE = 1, /* N */
    HTEX_PLAYER_NORMAL_FORCE = 2,  /* N */
    HTEX_PLAYER_ACCELERATION = 3,  /* m/s2 */
    HTEX_PLAYER_VELOCITY = 4,      /* m/s */
    HTEX_PLAYER_DISPLACEMENT = 5   /* m */
};

/* Returns the quantity of the samples. */
int htex_player_quantity(const htex_player *player);

/* Returns the symbol of their unit: "N", "m/s2", "m/s" or "m". */
const char *htex_player_unit(const htex_player *player);

/* Returns a magnitude that samples of the grid of motions rarely exceed, in their unit: for htex_player_render_i16. */
float htex_player_full_scale(const htex_player *player);

/* Sets speed (mm/s, of either sign) and normal force (newtons). Spectrum and level glide to it. Beyond the baked
   conditions the level follows the law of the block, and so do the frequencies of sinusoids. A finger that does not slide
   (below 0.5 mm/s, or without force) is silent. A reading above 1000 mm/s or 20 N is none of a finger: the last motion is
   held for 0.1 s, then the player is silent until the next good one. Returns a status. */
int htex_player_set_motion(htex_player *player, float speed_mm_s, float force_n);

/* Writes the next `count` samples, in the asset's unit. Returns a status. */
int htex_player_render(htex_player *player, float *out, size_t count);

/* Writes the next `count` samples as integers; `full_scale`, in the asset's unit, becomes 32767, and larger samples are
   limited. Returns a status. */
int htex_player_render_i16(htex_player *player, int16_t *out, size_t count, float full_scale);

#ifdef __cplusplus
}
#endif

#endif
