/* Plays textures that `htex bake` wrote (spec/baked-1.md). C99, without heap, operating system or
   other libraries. Compile htex_player.c with your program; docs/microcontroller.md describes
   everything. */
#ifndef HTEX_PLAYER_H
#define HTEX_PLAYER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A playing texture. The members are private. The numbers that the block needs follow them in
   memory (see HTEX_PLAYER_MEMORY). A player has no pointer into itself, so it may be moved together
   with these numbers. It does not have to be released. */
typedef struct htex_player {
    const uint8_t *block;
    float rate_hz;
    float full_scale;
    float level;
    float centre;
    float centre_step;
    float last_speed;
    float last_force;
    float envelope_from;
    float envelope_to;
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
    uint16_t lines_at;
    uint16_t envelope_period;
    uint16_t envelope_count;
    uint8_t kind;
    uint8_t quantity;
    uint8_t is_held;
    uint8_t is_silent;
    uint8_t is_started;
} htex_player;

/* Declares the memory of a player for a block that needs `numbers` numbers. A header that `htex
   bake` wrote defines this number as a macro:

       static HTEX_PLAYER_MEMORY(memory, TEXTURE_CLOTH_NUMBERS);
       htex_player_open(&memory.player, sizeof memory, texture_cloth, sizeof texture_cloth, 1); */
#define HTEX_PLAYER_MEMORY(name, numbers) \
    struct {                              \
        htex_player player;               \
        float values[numbers];            \
    } name

/* Status codes: 0 for success, or one of these. */
enum {
    HTEX_PLAYER_OK = 0,
    HTEX_PLAYER_TOO_SHORT = 1,    /* fewer bytes than a header */
    HTEX_PLAYER_NOT_A_BLOCK = 2,  /* does not begin with HTXB */
    HTEX_PLAYER_VERSION = 3,      /* not version 1: bake the asset again */
    HTEX_PLAYER_LENGTH = 4,       /* the length differs from the length in the header */
    HTEX_PLAYER_CHECKSUM = 5,     /* the bytes were changed */
    HTEX_PLAYER_HEADER = 6,       /* a number in the header is out of range */
    HTEX_PLAYER_VALUES = 7,       /* a number after the header is out of range */
    HTEX_PLAYER_AXES = 8,         /* speeds or forces do not ascend, or are out of range */
    HTEX_PLAYER_POINTER = -1,     /* a pointer is null or misaligned */
    HTEX_PLAYER_MOTION = -2,      /* speed or force is not finite */
    HTEX_PLAYER_NO_MEMORY = -3,   /* the memory is smaller than htex_player_size returns */
    HTEX_PLAYER_ARITHMETIC = -4   /* processor or compiler do not compute as IEEE 754 requires */
};

/* Returns the memory that a block needs while it plays, bytes. It depends on the content of the
   block. Returns 0 if the header is not valid. Reads only the first 52 bytes. */
size_t htex_player_size(const uint8_t *block, size_t length);

/* Validates a block of `length` bytes and makes a player at its first condition. Returns a status.

   The player uses `size` bytes of memory, which must be aligned like a htex_player. The block stays
   in place, in flash memory or RAM, at any alignment; it must not change while the player is in
   use. Players with different seeds have independent noise. */
int htex_player_open(htex_player *player, size_t size, const uint8_t *block, size_t length, uint32_t seed);

/* Returns the sample rate, hertz. */
float htex_player_rate_hz(const htex_player *player);

/* Physical quantities of the samples. */
enum {
    HTEX_PLAYER_LATERAL_FORCE = 1, /* N */
    HTEX_PLAYER_NORMAL_FORCE = 2,  /* N */
    HTEX_PLAYER_ACCELERATION = 3,  /* m/s2 */
    HTEX_PLAYER_VELOCITY = 4,      /* m/s */
    HTEX_PLAYER_DISPLACEMENT = 5   /* m */
};

/* Returns the physical quantity of the samples. */
int htex_player_quantity(const htex_player *player);

/* Returns the symbol of the samples' unit: "N", "m/s2", "m/s" or "m". */
const char *htex_player_unit(const htex_player *player);

/* Returns a magnitude that samples at the motions of the grid rarely exceed, in their unit. Use it
   as the full scale of htex_player_render_i16. */
float htex_player_full_scale(const htex_player *player);

/* Returns the RMS that the samples have at the current motion once they have glided to it, in their
   unit. It is 0 if the player is silent or is becoming silent. */
float htex_player_level(const htex_player *player);

/* Sets speed (mm/s, of either sign) and normal force (newtons). Returns a status.

   Spectrum and level glide to the motion. Beyond the baked conditions, the level and the
   frequencies of sinusoids follow the law of the block. While the finger does not slide (below 0.5
   mm/s, or without force), the player is silent. A reading above 1000 mm/s or 20 N is not
   plausible: the player holds the last motion for 0.1 s, and is then silent until the next
   plausible reading. Setting the same motion again changes nothing and costs next to nothing. */
int htex_player_set_motion(htex_player *player, float speed_mm_s, float force_n);

/* Writes the next `count` samples, in the asset's unit. Returns a status. */
int htex_player_render(htex_player *player, float *out, size_t count);

/* Writes the next `count` samples as integers. `full_scale`, in the asset's unit, becomes 32767,
   and larger samples are clipped. Returns a status. */
int htex_player_render_i16(htex_player *player, int16_t *out, size_t count, float full_scale);

#ifdef __cplusplus
}
#endif

#endif
