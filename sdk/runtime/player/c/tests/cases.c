/* Plays cases. The format is a sequence of 32-bit numbers: the number of cases; then for each case
   its seed, the number of its steps, three numbers for each step, the length of the block, and the
   block, padded to a multiple of four bytes. */
#include "cases.h"

#include "htex_player.h"

enum { SET_MOTION = 1, RENDER = 2, RENDER_I16 = 3, MOST_AT_ONCE = 64 };

static uint32_t next(const uint8_t **at)
{
    uint32_t number;
    __builtin_memcpy(&number, *at, sizeof number);
    *at += sizeof number;
    return number;
}

static float number_of(uint32_t bits)
{
    float number;
    __builtin_memcpy(&number, &bits, sizeof number);
    return number;
}

static void put_status(int status)
{
    int32_t number = status;
    put(&number, sizeof number);
}

static void set_motion(htex_player *player, uint32_t speed, uint32_t force)
{
    put_status(htex_player_set_motion(player, number_of(speed), number_of(force)));
    float level = htex_player_level(player);
    put(&level, sizeof level);
}

static void render(htex_player *player, uint32_t count)
{
    float samples[MOST_AT_ONCE];
    while (count > 0) {
        uint32_t part = count < MOST_AT_ONCE ? count : MOST_AT_ONCE;
        htex_player_render(player, samples, part);
        put(samples, part * sizeof samples[0]);
        count -= part;
    }
}

static void render_i16(htex_player *player, uint32_t count, uint32_t full_scale)
{
    int16_t samples[MOST_AT_ONCE];
    while (count > 0) {
        uint32_t part = count < MOST_AT_ONCE ? count : MOST_AT_ONCE;
        htex_player_render_i16(player, samples, part, number_of(full_scale));
        put(samples, part * sizeof samples[0]);
        count -= part;
    }
}

static void play_steps(htex_player *player, const uint8_t *steps, uint32_t count)
{
    while (count-- > 0) {
        uint32_t kind = next(&steps);
        uint32_t first = next(&steps);
        uint32_t second = next(&steps);
        if (kind == SET_MOTION) {
            set_motion(player, first, second);
        } else if (kind == RENDER) {
            render(player, first);
        } else if (kind == RENDER_I16) {
            render_i16(player, first, second);
        }
    }
}

/* Tests what a player refuses before and after it is opened, and what it returns about itself. */
static int is_refused(htex_player *player, size_t size, const uint8_t *block, size_t length)
{
    float sample;
    if (htex_player_open(player, size - 1, block, length, 1) != HTEX_PLAYER_NO_MEMORY) {
        return __LINE__;
    }
    if (htex_player_open(0, size, block, length, 1) != HTEX_PLAYER_POINTER
        || htex_player_open((htex_player *)(void *)((char *)player + 1), size, block, length, 1) != HTEX_PLAYER_POINTER
        || htex_player_open(player, size, 0, length, 1) != HTEX_PLAYER_POINTER) {
        return __LINE__;
    }
    if (htex_player_set_motion(0, 80.0f, 0.4f) != HTEX_PLAYER_POINTER || htex_player_render(0, &sample, 1) != HTEX_PLAYER_POINTER
        || htex_player_rate_hz(0) != 0.0f || htex_player_full_scale(0) != 0.0f || htex_player_level(0) != 0.0f
        || htex_player_quantity(0) != 0 || htex_player_unit(0)[0] != 0) {
        return __LINE__;
    }
    return 0;
}

static int is_told(htex_player *player)
{
    int quantity = htex_player_quantity(player);
    const char *unit = htex_player_unit(player);
    char first = quantity <= HTEX_PLAYER_NORMAL_FORCE ? 'N' : 'm';
    if (quantity < HTEX_PLAYER_LATERAL_FORCE || quantity > HTEX_PLAYER_DISPLACEMENT || unit[0] != first) {
        return __LINE__;
    }
    if (htex_player_render(player, 0, 1) != HTEX_PLAYER_POINTER || htex_player_render_i16(player, 0, 1, 1.0f) != HTEX_PLAYER_POINTER) {
        return __LINE__;
    }
    return 0;
}

static int play_block(const uint8_t *block, size_t length, uint32_t seed, const uint8_t *steps, uint32_t count)
{
    size_t size = htex_player_size(block, length);
    htex_player *player = memory_of(size < sizeof *player ? sizeof *player : size);
    int status = htex_player_open(player, size, block, length, seed);
    int wrong = 0;
    put_status(status);
    if (status == HTEX_PLAYER_OK) {
        wrong = is_refused(player, size, block, length);
        status = htex_player_open(player, size, block, length, seed);
        wrong = wrong ? wrong : is_told(player);
        float stated[2] = {htex_player_rate_hz(player), htex_player_full_scale(player)};
        put(stated, sizeof stated);
        play_steps(player, steps, count);
    }
    release(player);
    return wrong;
}

int play_cases(const uint8_t *cases, size_t length)
{
    const uint8_t *at = cases;
    uint32_t count = next(&at);
    while (count-- > 0) {
        uint32_t seed = next(&at);
        uint32_t steps = next(&at);
        const uint8_t *first = at;
        at += 12 * (size_t)steps;
        uint32_t bytes = next(&at);
        int wrong = play_block(at, bytes, seed, first, steps);
        if (wrong) {
            return wrong;
        }
        at += (bytes + 3) / 4 * 4;
    }
    return (size_t)(at - cases) == length ? 0 : __LINE__;
}
