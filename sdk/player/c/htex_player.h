/* Plays textures that `htex bake` wrote (spec/baked-1.md). C99, no heap, no operating system, no other library. Compile
   htex_player.c with the program; docs/microcontroller.md describes all of it. */
#ifndef HTEX_PLAYER_H
#define HTEX_PLAYER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A playing texture: these members, which are private, and behind them the numbers that its block needs. It has no pointer
   into itself, so that it may be moved with all its bytes, and it needs no release. */
typedef struct htex_player {
    const uint8_t *block;
    float rate_hz;
    float full_scale;
    float level;
    float centre;
    float centre_step;
    float last_speed;
    float last_force;
    uint32_t random[4];
    uint32_t gliding;
    uint32_t held;
    uint16_t size;
    uint16_t up;
    uint16_t row;
    uint16_t phase;
    uint16_t next_noise;
    uint16_t next_input;
    uint16_t inputs_at;
    uint16_t own_at;
    uint8_t kind;
    uint8_t quantity;
    uint8_t is_held;
    uint8_t is_silent;
    uint8_t is_started;
} htex_player;

/* Declares the memory of a player for a block that needs `numbers` numbers. A header of `htex bake` has them as a macro:
       static HTEX_PLAYER_MEMORY(memory, TEXTURE_CLOTH_NUMBERS);
       htex_player_open(&memory.player, sizeof memory, texture_cloth, sizeof texture_cloth, 1); */
#define HTEX_PLAYER_MEMORY(name, numbers) \
    struct {                              \
        htex_player player;               \
        float values[numbers];            \
    } name

/* Status: 0, or one of these. */
enum {
    HTEX_PLAYER_OK = 0,
    HTEX_PLAYER_TOO_SHORT = 1,    /* fewer bytes than a header */
    HTEX_PLAYER_NOT_A_BLOCK = 2,  /* does not begin with HTXB */
    HTEX_PLAYER_VERSION = 3,      /* not version 1: bake the asset again */
    HTEX_PLAYER_LENGTH = 4,       /* the length differs from the header's */
    HTEX_PLAYER_CHECKSUM = 5,     /* the bytes were changed */
    HTEX_PLAYER_HEADER = 6,       /* a number of the header is out of range */
    HTEX_PLAYER_VALUES = 7,       /* a number after the header is out of range */
    HTEX_PLAYER_AXES = 8,         /* speeds or forces do not ascend or are out of range */
    HTEX_PLAYER_POINTER = -1,     /* a pointer is null or misaligned */
    HTEX_PLAYER_MOTION = -2,      /* speed or force is not finite */
    HTEX_PLAYER_NO_MEMORY = -3,   /* the memory is smaller than htex_player_size says */
    HTEX_PLAYER_ARITHMETIC = -4   /* the processor or the compiler does not compute as IEEE 754 says */
};

/* Returns the bytes of memory that a block needs while it plays, which depend on what it holds; 0 if its header is none of
   a playable block. Only the first 52 bytes are read. */
size_t htex_player_size(const uint8_t *block, size_t length);

/* Validates `length` bytes of a block and makes a player of it at its first condition, in `size` bytes of memory that are
   aligned as a htex_player is. The block stays in place, in flash memory or RAM, at any alignment, unchanged while the
   player is used. Players of different seeds have independent noise. Returns a status. */
int htex_player_open(htex_player *player, size_t size, const uint8_t *block, size_t length, uint32_t seed);

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

/* Returns the RMS of the samples at the motion that was set, once they have glided to it, in their unit; 0 if the player is
   silent or becomes so. */
float htex_player_level(const htex_player *player);

/* Sets speed (mm/s, of either sign) and normal force (newtons). Spectrum and level glide to it. Beyond the baked
   conditions the level follows the law of the block, and so do the frequencies of sinusoids. A finger that does not slide
   (below 0.5 mm/s, or without force) is silent. A reading above 1000 mm/s or 20 N is none of a finger: the last motion is
   held for 0.1 s, then the player is silent until the next good one. A motion equal to the one before changes nothing and
   costs next to nothing. Returns a status. */
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
