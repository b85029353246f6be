/* The player of htex_player.h. It does every operation of spec/baked-1.md, sections 1 and 3, in the
   same order, so that the samples have the same bits on every processor.

   A compiler must not fuse products with sums, nor reorder sums. The lines below tell this to GCC
   and clang. They refuse -ffast-math and its parts where a compiler announces them. Another
   compiler needs its own option against contraction, and -DHTEX_PLAYER_NOT_FUSED. htex_player_open
   tests the arithmetic once more, on the processor. It thereby finds what cannot be seen here:
   clang's -ffp-contract=fast, flushed subnormal numbers, another rounding. */
#include "htex_player.h"

#include <float.h>

#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || defined(__RECIPROCAL_MATH__) \
    || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "htex_player.c: compile this file without -ffast-math and its parts: the samples would have other bits"
#endif
#if !defined(FLT_EVAL_METHOD) || FLT_EVAL_METHOD != 0
#error "htex_player.c: float has to be computed as float (FLT_EVAL_METHOD 0); on 32-bit x86, -msse2 -mfpmath=sse"
#endif
#if defined(__clang__)
#pragma STDC FP_CONTRACT OFF
#pragma clang fp reassociate(off)
#elif defined(__GNUC__)
/* GCC ignores the standard pragma. */
#pragma GCC optimize("fp-contract=off")
#elif !defined(HTEX_PLAYER_NOT_FUSED)
#error "htex_player.c: forbid fused operations (the compiler's -ffp-contract=off), and say so with -DHTEX_PLAYER_NOT_FUSED"
#endif

/* Keeps code that runs once for several samples out of the code that runs for every sample, and
   saves the call of code that runs for every sinusoid. */
#if defined(__GNUC__)
#define APART __attribute__((noinline))
#define INSIDE static inline __attribute__((always_inline))
#else
#define APART
#define INSIDE static
#endif

/* Copies a few bytes. Compilers turn it into loads and stores that the processor permits at the
   address. */
#if defined(__GNUC__)
#define COPY(to, from, size) __builtin_memcpy(to, from, size)
#else
#include <string.h>
#define COPY(to, from, size) memcpy(to, from, size)
#endif

typedef char float_has_32_bits[sizeof(float) == 4 && FLT_MANT_DIG == 24 ? 1 : -1];

enum {
    HEADER = 52,
    CHECKSUM = 4,
    NOISE = 1,
    TONES = 2,
    RANDOM_PHASE = 1,
    FLUCTUATES = 2,
    /* Length of the fluctuation in a block, bytes. */
    FLUCTUATION = 8,
    /* Sinusoids of each of the two parts of the envelope. */
    LINES = 8,
    MOST_HALF = 320,
    MOST_TONES = 64,
    MOST_UP = 64,
    MOST_ROW = 64,
    MOST_FILTERS = 64,
    MOST_ON_AXIS = 32,
    MOST_GLIDE = 4096,
    /* Number of filters that are added to a mix in one pass. */
    AT_ONCE = 4
};

#define CYCLE 4294967296.0f
#define MOST_SCALE (1.0f / 16777216.0f)
#define MOST_VALUE 64.0f
#define MOST_LEVEL 1e9f
#define MOST_CEILING 1e10f
#define MOST_EXPONENT 4.0f
#define MIN_SLIDING_MM_S 0.5f
#define MOST_SPEED_MM_S 1000.0f
#define LEAST_FORCE_N 1e-6f
#define MOST_FORCE_N 20.0f
#define MOST_OFFSET 16.0f
#define HOLD_S 0.1f
#define MIN_RATIO 0.0625f
#define MAX_RATIO 8.0f
#define MAX_FORCE_RATIO 1048576.0f
/* Lowest energy of a mixed filter, and lowest power of mixed sinusoids, that can be scaled to a
   level. */
#define LEAST_POWER 1e-9f

/* ---- bytes and bits ---- */

static uint16_t half_word(const uint8_t *at)
{
    return (uint16_t)(at[0] | (uint32_t)at[1] << 8);
}

static uint32_t word(const uint8_t *at)
{
    return at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static float float_of(uint32_t bits)
{
    float number;
    COPY(&number, &bits, sizeof number);
    return number;
}

static uint32_t bits_of(float number)
{
    uint32_t bits;
    COPY(&bits, &number, sizeof bits);
    return bits;
}

static float number_at(const uint8_t *numbers, uint32_t index)
{
    return float_of(word(numbers + 4 * index));
}

static float integer_at(const uint8_t *integers, uint32_t index)
{
    const uint8_t *at = integers + 2 * index;
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
    int16_t integer;
    COPY(&integer, at, sizeof integer);
    return (float)integer;
#else
    return (float)((int32_t)(half_word(at) ^ 0x8000u) - 0x8000);
#endif
}

static int is_finite(float number)
{
    return (bits_of(number) & 0x7F800000u) != 0x7F800000u;
}

static int is_in(float number, float least, float most)
{
    return number >= least && number <= most;
}

static float within(float number, float least, float most)
{
    float raised = number > least ? number : least;
    return raised < most ? raised : most;
}

/* CRC-32 of ZIP, four bits at a time. */
static uint32_t checksum(const uint8_t *bytes, uint32_t length)
{
    static const uint32_t table[16] = {
        0x00000000u, 0x1DB71064u, 0x3B6E20C8u, 0x26D930ACu, 0x76DC4190u, 0x6B6B51F4u, 0x4DB26158u, 0x5005713Cu,
        0xEDB88320u, 0xF00F9344u, 0xD6D6A3E8u, 0xCB61B38Cu, 0x9B64C2B0u, 0x86D3D2D4u, 0xA00AE278u, 0xBDBDF21Cu};
    uint32_t crc = 0xFFFFFFFFu;
    for (uint32_t i = 0; i < length; i++) {
        crc ^= bytes[i];
        crc = table[crc & 15u] ^ crc >> 4;
        crc = table[crc & 15u] ^ crc >> 4;
    }
    return ~crc;
}

/* ---- functions of numbers ---- */

/* The root of a normal positive number, rounded to the nearest: digit by digit. */
static float root(float number)
{
    uint32_t bits = bits_of(number);
    uint32_t biased = bits >> 23;
    uint32_t rest = (bits & 0x7FFFFFu) | 0x800000u;
    uint32_t digits = 0;
    uint32_t sum = 0;
    /* The exponent is biased by 127: it is odd where this is even. */
    rest <<= (biased & 1u) == 0u ? 2 : 1;
    for (uint32_t digit = 0x01000000u; digit != 0u; digit >>= 1) {
        uint32_t tried = sum + digit;
        if (tried <= rest) {
            sum = tried + digit;
            rest -= tried;
            digits += digit;
        }
        rest <<= 1;
    }
    if (rest != 0u) {
        digits += digits & 1u;
    }
    return float_of((digits >> 1) + 0x1F000000u + ((biased + 1u) / 2u << 23));
}

/* The binary logarithm of a normal positive number. */
static float log_2(float number)
{
    uint32_t bits = bits_of(number);
    int32_t exponent = (int32_t)(bits >> 23) - 127;
    uint32_t mantissa = (bits & 0x7FFFFFu) | 0x3F800000u;
    if (mantissa > 0x3FB504F3u) {
        mantissa -= (uint32_t)1 << 23;
        exponent += 1;
    }
    float m = float_of(mantissa);
    float s = (m - 1.0f) / (m + 1.0f);
    float q = s * s;
    return (float)exponent + s * (2.88539f + q * (0.9617967f + q * (0.577078f + q * 0.4121986f)));
}

/* 2 to the power of a number from -120 to 120. */
static float exp_2(float number)
{
    static const float terms[7] = {1.0f, 0.69314718f, 0.2402265f, 0.05550411f, 0.009618129f, 0.0013333558f, 0.0001540353f};
    int32_t whole = (int32_t)(number + (number < 0.0f ? -0.5f : 0.5f));
    float part = number - (float)whole;
    float sum = 0.0f;
    for (int i = 6; i >= 0; i--) {
        sum = sum * part + terms[i];
    }
    return sum * float_of((uint32_t)(whole + 127) << 23);
}

/* The cosine of a phase of which 2^32 is one cycle; the error is at most 4e-6. */
INSIDE float cosine(uint32_t phase)
{
    int32_t place = phase < 0x80000000u ? (int32_t)phase : (int32_t)(phase ^ 0x80000000u) - 0x7FFFFFFF - 1;
    float x = (float)place * (1.0f / CYCLE);
    float t = 0.25f - (x < 0.0f ? -x : x);
    float s = t * t;
    float high = -76.70586f + s * 42.058693f;
    return t * (6.2831855f + s * (-41.3417f + s * (81.60525f + s * high)));
}

/* Advances the phase of a sinusoid by its frequency, in cycles per sample. */
INSIDE uint32_t step_of(float frequency)
{
    float step = frequency * CYCLE;
    if (!(step > 0.0f)) {
        return 0;
    }
    return step < CYCLE ? (uint32_t)step : 0xFFFFFFFFu;
}

/* ---- random numbers: xoshiro128++ ---- */

static void seed_random(uint32_t state[4], uint32_t seed)
{
    for (int i = 0; i < 4; i++) {
        seed += 0x9E3779B9u;
        uint32_t z = seed;
        z = (z ^ z >> 16) * 0x85EBCA6Bu;
        z = (z ^ z >> 13) * 0xC2B2AE35u;
        state[i] = z ^ z >> 16;
    }
}

static uint32_t next_random(uint32_t s[4])
{
    uint32_t sum = s[0] + s[3];
    uint32_t result = (sum << 7 | sum >> 25) + s[0];
    uint32_t shifted = s[1] << 9;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= shifted;
    s[3] = s[3] << 11 | s[3] >> 21;
    return result;
}

/* White noise of unit variance: a sum of four uniform numbers. */
static float next_noise(uint32_t s[4])
{
    uint32_t x = next_random(s);
    uint32_t y = next_random(s);
    uint32_t sum = (x & 0xFFFFu) + (x >> 16) + (y & 0xFFFFu) + (y >> 16);
    return (float)((int32_t)sum - 131070) * 2.6428943e-5f;
}

/* ---- the block ---- */

/* A block that is read in place: its header, and the parts after it. */
struct parts {
    uint32_t half_or_count;
    uint32_t up;
    uint32_t row;
    uint32_t glide;
    uint32_t speeds;
    uint32_t forces;
    uint32_t filters;
    const uint8_t *speeds_at;
    const uint8_t *forces_at;
    const uint8_t *rows_at;
    const uint8_t *levels_at;
    /* Scales of filters, or frequencies and amplitudes. */
    const uint8_t *numbers_at;
    /* Weights of filters, and the filters. */
    const uint8_t *integers_at;
    uint32_t numbers;
    uint32_t integers;
    /* The fluctuation, if the block has one. */
    const uint8_t *fluctuation_at;
};

static struct parts parts_of(const uint8_t *block)
{
    struct parts parts;
    parts.up = half_word(block + 16);
    parts.row = half_word(block + 18);
    parts.half_or_count = half_word(block + 20);
    parts.glide = half_word(block + 22);
    parts.speeds = block[24];
    parts.forces = block[25];
    parts.filters = block[26];
    uint32_t conditions = parts.speeds * parts.forces;
    if (block[6] == NOISE) {
        parts.numbers = parts.filters;
        parts.integers = parts.filters * (conditions + parts.half_or_count + 1u);
    } else {
        parts.numbers = 2u * parts.half_or_count * conditions;
        parts.integers = 0;
    }
    parts.speeds_at = block + HEADER;
    parts.forces_at = parts.speeds_at + 4u * parts.speeds;
    parts.rows_at = parts.forces_at + 4u * parts.forces;
    parts.levels_at = parts.rows_at + 4u * parts.up * parts.row;
    parts.numbers_at = parts.levels_at + 4u * conditions;
    parts.integers_at = parts.numbers_at + 4u * parts.numbers;
    parts.fluctuation_at = parts.integers_at + (parts.integers + 1u) / 2u * 4u;
    return parts;
}

static int is_header(const uint8_t *block)
{
    uint32_t up = half_word(block + 16);
    uint32_t row = half_word(block + 18);
    uint32_t size = half_word(block + 20);
    uint32_t glide = half_word(block + 22);
    uint32_t flags = block[7] & (0xFFu - FLUCTUATES);
    int is_noise = block[6] == NOISE && flags == 0u && block[26] >= 1 && block[26] <= MOST_FILTERS && size % 4u == 0u
        && size <= MOST_HALF;
    int is_tones = block[6] == TONES && flags <= RANDOM_PHASE && block[26] == 0 && size <= MOST_TONES;
    int is_interpolator = up == 1u ? row == 0u : row % 4u == 0u && row >= 4u && row <= MOST_ROW;
    float full_scale = number_at(block, 11);
    return (is_noise || is_tones) && is_interpolator && size > 0u && up >= 1u && up <= MOST_UP && glide >= 1u
        && glide <= MOST_GLIDE && block[24] >= 1 && block[24] <= MOST_ON_AXIS && block[25] >= 1 && block[25] <= MOST_ON_AXIS
        && block[27] >= HTEX_PLAYER_LATERAL_FORCE && block[27] <= HTEX_PLAYER_DISPLACEMENT
        && is_in(number_at(block, 3), 100.0f, 1e6f) && is_in(number_at(block, 7), -MOST_EXPONENT, MOST_EXPONENT)
        && is_in(number_at(block, 8), -MOST_EXPONENT, MOST_EXPONENT)
        && is_in(number_at(block, 9), -MOST_EXPONENT, MOST_EXPONENT) && is_in(number_at(block, 10), 0.0f, MOST_CEILING)
        && is_in(full_scale, 0.0f, MOST_CEILING) && full_scale > 0.0f && is_in(number_at(block, 12), 0.0f, 0.5f);
}

static int are_in(const uint8_t *numbers, uint32_t count, uint32_t step, float least, float most)
{
    for (uint32_t i = 0; i < count; i += step) {
        if (!is_in(number_at(numbers, i), least, most)) {
            return 0;
        }
    }
    return 1;
}

static int is_axis(const uint8_t *axis, uint32_t count, float least, float most)
{
    for (uint32_t i = 1; i < count; i++) {
        if (!(number_at(axis, i - 1u) < number_at(axis, i))) {
            return 0;
        }
    }
    return are_in(axis, count, 1, least, most);
}

static int are_values(const uint8_t *block, const struct parts *parts)
{
    const uint8_t *numbers = parts->numbers_at;
    int are_sound = block[6] == NOISE
        ? are_in(numbers, parts->numbers, 1, 0.0f, MOST_SCALE)
        : are_in(numbers, parts->numbers, 2, 0.0f, 0.5f) && are_in(numbers + 4, parts->numbers - 1u, 2, -MOST_VALUE, MOST_VALUE);
    const uint8_t *padding = parts->integers_at + 2u * parts->integers;
    int is_padding = parts->integers % 2u == 0u || (padding[0] == 0 && padding[1] == 0);
    const uint8_t *fluctuation = parts->fluctuation_at;
    int is_fluctuation = (block[7] & FLUCTUATES) == 0
        || (half_word(fluctuation) > 0u && is_in(number_at(fluctuation, 1), -MOST_OFFSET, MOST_OFFSET));
    return are_sound && is_padding && is_fluctuation && are_in(parts->rows_at, parts->up * parts->row, 1, -MOST_VALUE, MOST_VALUE)
        && are_in(parts->levels_at, parts->speeds * parts->forces, 1, 0.0f, MOST_LEVEL);
}

/* Checks the rules of the specification, in their order. */
static int check(const uint8_t *block, size_t length)
{
    if (length < HEADER + CHECKSUM) {
        return HTEX_PLAYER_TOO_SHORT;
    }
    if (block[0] != 'H' || block[1] != 'T' || block[2] != 'X' || block[3] != 'B') {
        return HTEX_PLAYER_NOT_A_BLOCK;
    }
    if (half_word(block + 4) != 1u) {
        return HTEX_PLAYER_VERSION;
    }
    uint32_t stated = word(block + 8);
    if (stated > length || stated < HEADER + CHECKSUM) {
        return HTEX_PLAYER_LENGTH;
    }
    if (checksum(block, stated - CHECKSUM) != word(block + stated - CHECKSUM)) {
        return HTEX_PLAYER_CHECKSUM;
    }
    if (!is_header(block)) {
        return HTEX_PLAYER_HEADER;
    }
    struct parts parts = parts_of(block);
    uint32_t words = parts.speeds + parts.forces + parts.up * parts.row + parts.speeds * parts.forces + parts.numbers;
    uint32_t fluctuation = (block[7] & FLUCTUATES) != 0 ? FLUCTUATION : 0;
    if (stated != HEADER + 4u * words + (parts.integers + 1u) / 2u * 4u + fluctuation + CHECKSUM) {
        return HTEX_PLAYER_LENGTH;
    }
    if (!is_axis(parts.speeds_at, parts.speeds, MIN_SLIDING_MM_S, MOST_SPEED_MM_S)
        || !is_axis(parts.forces_at, parts.forces, LEAST_FORCE_N, MOST_FORCE_N)) {
        return HTEX_PLAYER_AXES;
    }
    return are_values(block, &parts) ? HTEX_PLAYER_OK : HTEX_PLAYER_VALUES;
}

/* ---- the memory ---- */

/* Number of values in memory after a player: the interpolator's coefficients and its history. Then
   for noise the filter's side, the side's steps and the history, or for sinusoids five numbers
   each. In a history each input is stored twice, so that the newest ones are always contiguous. Last,
   for a block that fluctuates, phase and step of each sinusoid of its envelope. */
static uint32_t numbers_needed(uint32_t kind, uint32_t flags, uint32_t size, uint32_t up, uint32_t row)
{
    uint32_t others = up * row + 2u * row + ((flags & FLUCTUATES) != 0u ? 4u * LINES : 0u);
    return others + (kind == NOISE ? 2u * size + 2u * (2u * size + 1u) : 5u * size);
}

static float *numbers_of(htex_player *player)
{
    return (float *)(void *)(player + 1);
}

static float *inputs_of(htex_player *player)
{
    return numbers_of(player) + player->inputs_at;
}

static float *own_of(htex_player *player)
{
    return numbers_of(player) + player->own_at;
}

size_t htex_player_size(const uint8_t *block, size_t length)
{
    if (!block || length < HEADER || block[0] != 'H' || block[1] != 'T' || block[2] != 'X' || block[3] != 'B'
        || half_word(block + 4) != 1u || !is_header(block)) {
        return 0;
    }
    struct parts parts = parts_of(block);
    /* At most 25 kB. */
    return sizeof(htex_player) + sizeof(float) * (size_t)numbers_needed(block[6], block[7], parts.half_or_count, parts.up, parts.row);
}

/* ---- where a motion is in the grid ---- */

/* The conditions that a motion mixes, and the level and frequency factor that it plays. */
struct target {
    uint32_t count;
    uint32_t conditions[4];
    float weights[4];
    float level;
    float frequency;
};

/* The index of the value below a number on an axis; `part` is the position towards the next
   value. */
static uint32_t place(const uint8_t *axis, uint32_t count, float value, float *part)
{
    uint32_t above = 0;
    while (above < count && number_at(axis, above) <= value) {
        above++;
    }
    *part = 0.0f;
    if (above == 0u || above >= count) {
        return above == 0u ? 0u : above - 1u;
    }
    float low = number_at(axis, above - 1u);
    *part = (value - low) / (number_at(axis, above) - low);
    return above - 1u;
}

static void weigh(struct target *target, uint32_t condition, float weight)
{
    if (weight > 0.0f) {
        target->conditions[target->count] = condition;
        target->weights[target->count] = weight;
        target->count++;
    }
}

static float mixed(const struct target *target, const uint8_t *numbers, uint32_t stride, uint32_t index)
{
    float sum = 0.0f;
    for (uint32_t i = 0; i < target->count; i++) {
        sum += target->weights[i] * number_at(numbers, target->conditions[i] * stride + index);
    }
    return sum;
}

static float mixed_integers(const struct target *target, const uint8_t *integers, uint32_t stride, uint32_t index)
{
    float sum = 0.0f;
    for (uint32_t i = 0; i < target->count; i++) {
        sum += target->weights[i] * integer_at(integers, target->conditions[i] * stride + index);
    }
    return sum;
}

/* Applies the law to the level and the frequencies of the nearest motion of the grid. */
static void follow_law(struct target *target, const uint8_t *block, float speed_ratio, float force_ratio)
{
    float speed = log_2(within(speed_ratio, MIN_RATIO, MAX_RATIO));
    float force = log_2(within(force_ratio, 1.0f / MAX_FORCE_RATIO, MAX_FORCE_RATIO));
    float ceiling = number_at(block, 10);
    float scaled = target->level * exp_2(number_at(block, 8) * speed + number_at(block, 9) * force);
    target->frequency = within(exp_2(number_at(block, 7) * speed), MIN_RATIO, MAX_RATIO);
    if (!(scaled > target->level && scaled > ceiling)) {
        target->level = scaled;
    } else if (ceiling > target->level) {
        target->level = ceiling;
    }
}

static struct target target_at(const uint8_t *block, const struct parts *parts, float speed, float force)
{
    struct target target = {0, {0, 0, 0, 0}, {0.0f, 0.0f, 0.0f, 0.0f}, 0.0f, 1.0f};
    const uint8_t *speeds = parts->speeds_at;
    const uint8_t *forces = parts->forces_at;
    float nearest_speed = within(speed, number_at(speeds, 0), number_at(speeds, parts->speeds - 1u));
    float nearest_force = within(force, number_at(forces, 0), number_at(forces, parts->forces - 1u));
    float u;
    float w;
    uint32_t columns = parts->speeds;
    uint32_t first = place(speeds, columns, nearest_speed, &u);
    first += place(forces, parts->forces, nearest_force, &w) * columns;
    weigh(&target, first, (1.0f - u) * (1.0f - w));
    weigh(&target, first + 1u, u * (1.0f - w));
    weigh(&target, first + columns, (1.0f - u) * w);
    weigh(&target, first + columns + 1u, u * w);
    target.level = mixed(&target, parts->levels_at, 1, 0);
    if (speed != nearest_speed || force != nearest_force) {
        follow_law(&target, block, speed / nearest_speed, force / nearest_force);
    }
    return target;
}

/* ---- sums of products, where most of the time is spent ---- */

#if defined(__GNUC__) && defined(__thumb2__) && defined(__ARM_FP) && (__ARM_FP & 4) && !defined(HTEX_PLAYER_PORTABLE)
/* On processors like the Cortex-M4F, one instruction loads eight numbers, but compilers do not use
   it. The operations and their order are the same as in the C functions below. */

#define EIGHT_PRODUCTS                                                                                    \
    "vmul.f32 s12, s4, s12\n vmul.f32 s13, s5, s13\n vmul.f32 s14, s6, s14\n vmul.f32 s15, s7, s15\n"    \
    "vmul.f32 s16, s8, s16\n vmul.f32 s17, s9, s17\n vmul.f32 s18, s10, s18\n vmul.f32 s19, s11, s19\n"  \
    "vadd.f32 s0, s0, s12\n vadd.f32 s1, s1, s13\n vadd.f32 s2, s2, s14\n vadd.f32 s3, s3, s15\n"        \
    "vadd.f32 s0, s0, s16\n vadd.f32 s1, s1, s17\n vadd.f32 s2, s2, s18\n vadd.f32 s3, s3, s19\n"
#define FOUR_PRODUCTS                                                                                     \
    "vmul.f32 s12, s4, s12\n vmul.f32 s13, s5, s13\n vmul.f32 s14, s6, s14\n vmul.f32 s15, s7, s15\n"    \
    "vadd.f32 s0, s0, s12\n vadd.f32 s1, s1, s13\n vadd.f32 s2, s2, s14\n vadd.f32 s3, s3, s15\n"
#define ZERO_SUMS "vmov s0, %[zero]\n vmov s1, %[zero]\n vmov s2, %[zero]\n vmov s3, %[zero]\n"
#define ALL_SUMS "vadd.f32 s0, s0, s1\n vadd.f32 s2, s2, s3\n vadd.f32 s0, s0, s2\n vmov %[sum], s0\n"
#define REGISTERS \
    "s0", "s1", "s2", "s3", "s4", "s5", "s6", "s7", "s8", "s9", "s10", "s11", "s12", "s13", "s14", "s15", "s16", "s17", "s18", "s19"

#define LOAD_EIGHT "vldmia %[x]!, {s4-s11}\n vldmia %[y]!, {s12-s19}\n"
#define LOAD_EIGHT_ON_BOTH_SIDES                                                                               \
    "vldmia %[after]!, {s12-s19}\n vldmdb %[before]!, {s20-s27}\n vldmia %[side]!, {s4-s11}\n"                 \
    "vadd.f32 s12, s12, s27\n vadd.f32 s13, s13, s26\n vadd.f32 s14, s14, s25\n vadd.f32 s15, s15, s24\n"      \
    "vadd.f32 s16, s16, s23\n vadd.f32 s17, s17, s22\n vadd.f32 s18, s18, s21\n vadd.f32 s19, s19, s20\n"

/* Adds products to four sums, and returns their total; `count` is a multiple of four. */
static inline float lanes(const float *x, const float *y, uint32_t count)
{
    uint32_t sum;
    uint32_t eights = count / 8u;
    __asm__ volatile(ZERO_SUMS
                     "cmp %[eights], #0\n beq 2f\n"
                     "1:\n" LOAD_EIGHT EIGHT_PRODUCTS "subs %[eights], #1\n bne 1b\n"
                     "2:\n tst %[count], #4\n beq 3f\n vldmia %[x]!, {s4-s7}\n vldmia %[y]!, {s12-s15}\n" FOUR_PRODUCTS
                     "3:\n" ALL_SUMS
                     : [sum] "=&r"(sum), [x] "+r"(x), [y] "+r"(y), [eights] "+r"(eights)
                     : [count] "r"(count), [zero] "r"(0)
                     : REGISTERS, "cc", "memory");
    return float_of(sum);
}

/* The same for one side of a symmetrical filter, with the inputs on both sides of the middle. */
static inline float symmetrical_lanes(const float *side, const float *middle, uint32_t count)
{
    uint32_t sum;
    uint32_t sixteens = count / 16u;
    const float *after = middle + 1;
    const float *before = middle;
    __asm__ volatile(ZERO_SUMS
                     "cmp %[sixteens], #0\n beq 2f\n"
                     "1:\n" LOAD_EIGHT_ON_BOTH_SIDES EIGHT_PRODUCTS LOAD_EIGHT_ON_BOTH_SIDES EIGHT_PRODUCTS
                     "subs %[sixteens], #1\n bne 1b\n"
                     "2:\n tst %[count], #8\n beq 3f\n" LOAD_EIGHT_ON_BOTH_SIDES EIGHT_PRODUCTS
                     "3:\n tst %[count], #4\n beq 4f\n"
                     "vldmia %[after]!, {s12-s15}\n vldmdb %[before]!, {s20-s23}\n vldmia %[side]!, {s4-s7}\n"
                     "vadd.f32 s12, s12, s23\n vadd.f32 s13, s13, s22\n vadd.f32 s14, s14, s21\n vadd.f32 s15, s15, s20\n" FOUR_PRODUCTS
                     "4:\n" ALL_SUMS
                     : [sum] "=&r"(sum), [side] "+r"(side), [after] "+r"(after), [before] "+r"(before), [sixteens] "+r"(sixteens)
                     : [count] "r"(count), [zero] "r"(0)
                     : REGISTERS, "s20", "s21", "s22", "s23", "s24", "s25", "s26", "s27", "cc", "memory");
    return float_of(sum);
}

/* Adds numbers to other numbers; `count` is a multiple of four. */
static void add_to(float *sums, const float *terms, uint32_t count)
{
    uint32_t eights = count / 8u;
    __asm__ volatile("cmp %[eights], #0\n beq 2f\n"
                     "1:\n vldmia %[sums], {s0-s7}\n vldmia %[terms]!, {s8-s15}\n"
                     "vadd.f32 s0, s0, s8\n vadd.f32 s1, s1, s9\n vadd.f32 s2, s2, s10\n vadd.f32 s3, s3, s11\n"
                     "vadd.f32 s4, s4, s12\n vadd.f32 s5, s5, s13\n vadd.f32 s6, s6, s14\n vadd.f32 s7, s7, s15\n"
                     "vstmia %[sums]!, {s0-s7}\n subs %[eights], #1\n bne 1b\n"
                     "2:\n tst %[count], #4\n beq 3f\n vldmia %[sums], {s0-s3}\n vldmia %[terms]!, {s4-s7}\n"
                     "vadd.f32 s0, s0, s4\n vadd.f32 s1, s1, s5\n vadd.f32 s2, s2, s6\n vadd.f32 s3, s3, s7\n"
                     "vstmia %[sums]!, {s0-s3}\n"
                     "3:\n"
                     : [sums] "+r"(sums), [terms] "+r"(terms), [eights] "+r"(eights)
                     : [count] "r"(count)
                     : REGISTERS, "cc", "memory");
}

#define ADD_FOUR_COEFFICIENTS(pointer, weight)                                                       \
    "ldrsh %[i], [%[" pointer "]], #2\n ldrsh %[j], [%[" pointer "]], #2\n"                       \
    "ldrsh %[k], [%[" pointer "]], #2\n ldrsh %[l], [%[" pointer "]], #2\n"                       \
    "vmov s4, s5, %[i], %[j]\n vmov s6, s7, %[k], %[l]\n"                                            \
    "vcvt.f32.s32 s4, s4\n vcvt.f32.s32 s5, s5\n vcvt.f32.s32 s6, s6\n vcvt.f32.s32 s7, s7\n"      \
    "vmul.f32 s4, s4, " weight "\n vmul.f32 s5, s5, " weight "\n"                                  \
    "vmul.f32 s6, s6, " weight "\n vmul.f32 s7, s7, " weight "\n"                                  \
    "vadd.f32 s0, s0, s4\n vadd.f32 s1, s1, s5\n vadd.f32 s2, s2, s6\n vadd.f32 s3, s3, s7\n"

/* Adds four filters with their weights to the sums of a side, whose length is a multiple of
   four. */
static void add_filters(float *sums, uint32_t half, const uint8_t *const filters[AT_ONCE], const float weights[AT_ONCE])
{
    const uint8_t *a = filters[0] + 2;
    const uint8_t *b = filters[1] + 2;
    const uint8_t *c = filters[2] + 2;
    const uint8_t *d = filters[3] + 2;
    uint32_t fours = half / 4u;
    uint32_t i;
    uint32_t j;
    uint32_t k;
    uint32_t l;
    __asm__ volatile("vldmia %[weights], {s8-s11}\n"
                     "1:\n vldmia %[sums], {s0-s3}\n"
                     ADD_FOUR_COEFFICIENTS("a", "s8") ADD_FOUR_COEFFICIENTS("b", "s9")
                     ADD_FOUR_COEFFICIENTS("c", "s10") ADD_FOUR_COEFFICIENTS("d", "s11")
                     "vstmia %[sums]!, {s0-s3}\n subs %[fours], #1\n bne 1b\n"
                     : [sums] "+r"(sums), [a] "+r"(a), [b] "+r"(b), [c] "+r"(c), [d] "+r"(d), [fours] "+r"(fours),
                       [i] "=&r"(i), [j] "=&r"(j), [k] "=&r"(k), [l] "=&r"(l)
                     : [weights] "r"(weights)
                     : REGISTERS, "cc", "memory");
}
#else
/* Adds products to four sums, and returns their total; `count` is a multiple of four. */
static float lanes(const float *x, const float *y, uint32_t count)
{
    float a = 0.0f;
    float b = 0.0f;
    float c = 0.0f;
    float d = 0.0f;
    for (uint32_t i = 0; i < count; i += 4u) {
        a += x[i] * y[i];
        b += x[i + 1u] * y[i + 1u];
        c += x[i + 2u] * y[i + 2u];
        d += x[i + 3u] * y[i + 3u];
    }
    return (a + b) + (c + d);
}

/* The same for one side of a symmetrical filter, with the inputs on both sides of the middle. */
static float symmetrical_lanes(const float *side, const float *middle, uint32_t count)
{
    float a = 0.0f;
    float b = 0.0f;
    float c = 0.0f;
    float d = 0.0f;
    const float *after = middle + 1;
    const float *before = middle - 4;
    for (const float *end = side + count; side != end; side += 4) {
        a += side[0] * (after[0] + before[3]);
        b += side[1] * (after[1] + before[2]);
        c += side[2] * (after[2] + before[1]);
        d += side[3] * (after[3] + before[0]);
        after += 4;
        before -= 4;
    }
    return (a + b) + (c + d);
}

/* Adds numbers to other numbers; `count` is a multiple of four. */
static void add_to(float *sums, const float *terms, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        sums[i] += terms[i];
    }
}

/* Adds four filters with their weights to the sums of a side, whose length is a multiple of
   four. */
static void add_filters(float *sums, uint32_t half, const uint8_t *const filters[AT_ONCE], const float weights[AT_ONCE])
{
    const uint8_t *a = filters[0] + 2;
    const uint8_t *b = filters[1] + 2;
    const uint8_t *c = filters[2] + 2;
    const uint8_t *d = filters[3] + 2;
    float w = weights[0];
    float x = weights[1];
    float y = weights[2];
    float z = weights[3];
    for (const float *end = sums + half; sums != end; sums += 4) {
        sums[0] = sums[0] + w * integer_at(a, 0) + x * integer_at(b, 0) + y * integer_at(c, 0) + z * integer_at(d, 0);
        sums[1] = sums[1] + w * integer_at(a, 1) + x * integer_at(b, 1) + y * integer_at(c, 1) + z * integer_at(d, 1);
        sums[2] = sums[2] + w * integer_at(a, 2) + x * integer_at(b, 2) + y * integer_at(c, 2) + z * integer_at(d, 2);
        sums[3] = sums[3] + w * integer_at(a, 3) + x * integer_at(b, 3) + y * integer_at(c, 3) + z * integer_at(d, 3);
        a += 8;
        b += 8;
        c += 8;
        d += 8;
    }
}
#endif

/* ---- noise ---- */

static void push(float *history, uint32_t length, uint16_t *next, float input)
{
    history[*next] = input;
    history[*next + length] = input;
    *next = *next + 1u < length ? (uint16_t)(*next + 1u) : 0;
}

static float *history_of(htex_player *player)
{
    return own_of(player) + 2 * (size_t)player->size;
}

static void start_noise(htex_player *player)
{
    uint32_t taps = 2u * player->size + 1u;
    for (uint32_t i = 0; i < taps; i++) {
        push(history_of(player), taps, &player->next_noise, next_noise(player->random));
    }
}

/* Mixes the filters of a motion. Writes the sums of the side, and returns the centre. */
static float mix_filters(float *sums, const struct parts *parts, const struct target *target)
{
    uint32_t half = parts->half_or_count;
    const uint8_t *first = parts->integers_at + 2u * parts->filters * parts->speeds * parts->forces;
    float centre = 0.0f;
    for (uint32_t i = 0; i < half; i++) {
        sums[i] = 0.0f;
    }
    for (uint32_t k = 0; k < parts->filters; k += AT_ONCE) {
        /* A filter with weight 0 does not change any bit, so incomplete groups are filled with
           one. */
        float weights[AT_ONCE] = {0.0f, 0.0f, 0.0f, 0.0f};
        const uint8_t *filters[AT_ONCE] = {first, first, first, first};
        for (uint32_t i = 0; i < AT_ONCE && k + i < parts->filters; i++) {
            weights[i] = mixed_integers(target, parts->integers_at, parts->filters, k + i) * number_at(parts->numbers_at, k + i);
            filters[i] = first + 2u * (k + i) * (half + 1u);
            centre += weights[i] * integer_at(filters[i], 0);
        }
        add_filters(sums, half, filters, weights);
    }
    return centre;
}

static void silence_noise(htex_player *player)
{
    float *side = own_of(player);
    player->centre = 0.0f;
    for (uint32_t i = 0; i < player->size; i++) {
        side[i] = 0.0f;
    }
}

static void glide_noise(htex_player *player)
{
    float *side = own_of(player);
    player->centre += player->centre_step;
    add_to(side, side + player->size, player->size);
}

/* Starts a glide over `samples` samples to the filter of a motion; with 0 it is set at once. */
static void retune_noise(htex_player *player, const struct parts *parts, const struct target *target, uint32_t samples)
{
    if (samples == 0u) {
        silence_noise(player);
    }
    const float *side = own_of(player);
    float *steps = own_of(player) + player->size;
    float centre = mix_filters(steps, parts, target);
    float energy = centre * centre + 2.0f * lanes(steps, steps, player->size);
    float gain = energy > LEAST_POWER ? target->level / root(energy) : 0.0f;
    float part = 1.0f / (float)(samples > 0u ? samples : 1u);
    player->level = energy > LEAST_POWER ? target->level : 0.0f;
    player->centre_step = (centre * gain - player->centre) * part;
    for (uint32_t i = 0; i < player->size; i++) {
        steps[i] = (steps[i] * gain - side[i]) * part;
    }
    if (samples == 0u) {
        glide_noise(player);
    }
}

static void fade_noise(htex_player *player, float part)
{
    const float *side = own_of(player);
    float *steps = own_of(player) + player->size;
    player->centre_step = -player->centre * part;
    for (uint32_t i = 0; i < player->size; i++) {
        steps[i] = -side[i] * part;
    }
}

static float tick_noise(htex_player *player)
{
    uint32_t half = player->size;
    float *history = history_of(player);
    push(history, 2u * half + 1u, &player->next_noise, next_noise(player->random));
    const float *middle = history + player->next_noise + half;
    return player->centre * middle[0] + symmetrical_lanes(own_of(player), middle, half);
}

/* ---- sinusoids ---- */

/* A sinusoid in five numbers. The phase is an integer, stored as the bits of a float. */
enum { PHASE, FREQUENCY, FREQUENCY_STEP, AMPLITUDE, AMPLITUDE_STEP, OF_TONE };

static float *end_of_tones(htex_player *player)
{
    return own_of(player) + OF_TONE * (size_t)player->size;
}

static void start_tones(htex_player *player)
{
    for (float *tone = own_of(player); tone != end_of_tones(player); tone += OF_TONE) {
        uint32_t phase = (player->block[7] & RANDOM_PHASE) != 0 ? next_random(player->random) : 0;
        COPY(&tone[PHASE], &phase, sizeof phase);
    }
}

static void glide_tones(htex_player *player)
{
    for (float *tone = own_of(player); tone != end_of_tones(player); tone += OF_TONE) {
        tone[FREQUENCY] += tone[FREQUENCY_STEP];
        tone[AMPLITUDE] += tone[AMPLITUDE_STEP];
    }
}

static void silence_tones(htex_player *player)
{
    for (float *tone = own_of(player); tone != end_of_tones(player); tone += OF_TONE) {
        tone[AMPLITUDE] = 0.0f;
    }
}

/* Mixes the sinusoids of a motion and writes them to the steps. Returns their power; `highest` is
   the highest frequency with an amplitude. */
static float mix_tones(htex_player *player, const struct parts *parts, const struct target *target, float *highest)
{
    float power = 0.0f;
    uint32_t stride = 2u * player->size;
    uint32_t index = 0;
    *highest = 0.0f;
    for (float *tone = own_of(player); tone != end_of_tones(player); tone += OF_TONE) {
        float frequency = mixed(target, parts->numbers_at, stride, index);
        float amplitude = mixed(target, parts->numbers_at, stride, index + 1u);
        power += 0.5f * amplitude * amplitude;
        if (amplitude != 0.0f && frequency > *highest) {
            *highest = frequency;
        }
        tone[FREQUENCY_STEP] = frequency;
        tone[AMPLITUDE_STEP] = amplitude;
        index += 2u;
    }
    return power;
}

/* A factor of frequencies, reduced so that it raises none above the highest permitted one. */
static float limited(float factor, float highest, float most)
{
    if (!(factor > 1.0f && highest * factor > most)) {
        return factor;
    }
    float least = most / highest;
    return least > 1.0f ? least : 1.0f;
}

static void retune_tones(htex_player *player, const struct parts *parts, const struct target *target, uint32_t samples)
{
    float highest;
    float power = mix_tones(player, parts, target, &highest);
    float gain = power > LEAST_POWER ? target->level / root(power) : 0.0f;
    float factor = limited(target->frequency, highest, number_at(player->block, 12));
    float part = 1.0f / (float)(samples > 0u ? samples : 1u);
    player->level = power > LEAST_POWER ? target->level : 0.0f;
    for (float *tone = own_of(player); tone != end_of_tones(player); tone += OF_TONE) {
        if (samples == 0u) {
            tone[FREQUENCY] = 0.0f;
            tone[AMPLITUDE] = 0.0f;
        }
        tone[FREQUENCY_STEP] = (tone[FREQUENCY_STEP] * factor - tone[FREQUENCY]) * part;
        tone[AMPLITUDE_STEP] = (tone[AMPLITUDE_STEP] * gain - tone[AMPLITUDE]) * part;
    }
    if (samples == 0u) {
        glide_tones(player);
    }
}

static void fade_tones(htex_player *player, float part)
{
    for (float *tone = own_of(player); tone != end_of_tones(player); tone += OF_TONE) {
        tone[FREQUENCY_STEP] = 0.0f;
        tone[AMPLITUDE_STEP] = -tone[AMPLITUDE] * part;
    }
}

static float tick_tones(htex_player *player)
{
    float sum = 0.0f;
    for (float *tone = own_of(player); tone != end_of_tones(player); tone += OF_TONE) {
        uint32_t phase = bits_of(tone[PHASE]);
        sum += tone[AMPLITUDE] * cosine(phase);
        phase += step_of(tone[FREQUENCY]);
        COPY(&tone[PHASE], &phase, sizeof phase);
    }
    return sum;
}

/* ---- motions ---- */

/* Starts a change of motion. Returns its duration in samples at the internal rate, which is 0
   before the first sample. */
static uint32_t start_glide(htex_player *player, int is_silent)
{
    player->gliding = player->is_started ? half_word(player->block + 22) : 0;
    player->is_silent = (uint8_t)is_silent;
    return player->gliding;
}

static void sound(htex_player *player, float speed, float force)
{
    struct parts parts = parts_of(player->block);
    struct target target = target_at(player->block, &parts, speed, force);
    uint32_t samples = start_glide(player, 0);
    player->last_speed = speed;
    player->last_force = force;
    if (player->kind == NOISE) {
        retune_noise(player, &parts, &target, samples);
    } else {
        retune_tones(player, &parts, &target, samples);
    }
}

static void silence(htex_player *player)
{
    if (player->kind == NOISE) {
        silence_noise(player);
    } else {
        silence_tones(player);
    }
}

/* Glides to silence, unless the player is silent already. */
static void fade(htex_player *player)
{
    if (player->is_silent) {
        return;
    }
    uint32_t samples = start_glide(player, 1);
    float part = 1.0f / (float)(samples > 0u ? samples : 1u);
    player->level = 0.0f;
    if (player->kind == NOISE) {
        fade_noise(player, part);
    } else {
        fade_tones(player, part);
    }
    if (samples == 0u) {
        silence(player);
    }
}

/* Holds the current motion. A hold that is already in progress is not prolonged. */
static void hold(htex_player *player)
{
    if (!player->is_held) {
        player->is_held = 1;
        player->held = (uint32_t)(HOLD_S * player->rate_hz);
    }
}

/* ---- the fluctuation in time ---- */

/* The phases and steps of the sinusoids, as bits. */
static float *lines_of(htex_player *player)
{
    return numbers_of(player) + player->lines_at;
}

/* The next value of the envelope. */
APART static float next_value(htex_player *player)
{
    const uint8_t *stored = player->block + word(player->block + 8) - CHECKSUM - FLUCTUATION;
    float *line = lines_of(player);
    float sums[2] = {0.0f, 0.0f};
    for (uint32_t i = 0; i < 2u * LINES; i++) {
        uint32_t phase = bits_of(line[0]);
        sums[i / LINES] += cosine(phase);
        phase += bits_of(line[1]);
        COPY(&line[0], &phase, sizeof phase);
        line += 2;
    }
    float slow = (float)stored[2] * 0.0025952563f;
    float fast = (float)stored[3] * 0.0025952563f;
    return exp_2(number_at(stored, 1) + slow * sums[0] + fast * sums[1]);
}

static void start_envelope(htex_player *player, uint32_t seed)
{
    static const float low[2] = {0.5f, 8.0f};
    static const float width[2] = {0.9375f, 3.0f};
    uint32_t random[4];
    float *line = lines_of(player);
    player->envelope_period = half_word(player->block + word(player->block + 8) - CHECKSUM - FLUCTUATION);
    float period = (float)player->envelope_period / player->rate_hz;
    seed_random(random, seed ^ 0x666C7563u);
    for (uint32_t i = 0; i < 2u * LINES; i++) {
        float part = (float)(next_random(random) >> 8) * (1.0f / 16777216.0f);
        float hertz = low[i / LINES] + width[i / LINES] * ((float)(i % LINES) + part);
        uint32_t step = step_of(hertz * period);
        uint32_t phase = next_random(random);
        COPY(&line[0], &phase, sizeof phase);
        COPY(&line[1], &step, sizeof step);
        line += 2;
    }
    player->envelope_from = next_value(player);
    player->envelope_to = next_value(player);
}

/* The factor of the next sample. */
APART static float next_factor(htex_player *player)
{
    if (player->envelope_count == player->envelope_period) {
        player->envelope_from = player->envelope_to;
        player->envelope_to = next_value(player);
        player->envelope_count = 0;
    }
    float part = (float)player->envelope_count / (float)player->envelope_period;
    player->envelope_count++;
    return player->envelope_from + (player->envelope_to - player->envelope_from) * part;
}

/* ---- samples ---- */

/* Counts a sample of a motion that is held. After the last one the player becomes silent. */
APART static void count_held(htex_player *player)
{
    if (player->held == 0u) {
        fade(player);
    } else {
        player->held--;
    }
}

APART static void glide(htex_player *player)
{
    if (player->kind == NOISE) {
        glide_noise(player);
    } else {
        glide_tones(player);
    }
    player->gliding--;
    if (player->gliding == 0u && player->is_silent) {
        silence(player);
    }
}

/* The next sample at the internal rate. */
APART static float next_input(htex_player *player)
{
    if (player->gliding > 0u) {
        glide(player);
    }
    return player->kind == NOISE ? tick_noise(player) : tick_tones(player);
}

static inline float steady(htex_player *player)
{
    uint32_t phase = player->phase;
    uint32_t row = player->row;
    if (player->is_held) {
        count_held(player);
    }
    if (phase == 0u) {
        float input = next_input(player);
        if (row == 0u) {
            return input;
        }
        push(inputs_of(player), row, &player->next_input, input);
    }
    player->phase = phase + 1u < player->up ? (uint16_t)(phase + 1u) : 0;
    return lanes(numbers_of(player) + phase * row, inputs_of(player) + player->next_input, row);
}

static inline float tick(htex_player *player)
{
    float sample = steady(player);
    return player->envelope_period == 0u ? sample : sample * next_factor(player);
}

static int16_t integer_of(float sample, float gain)
{
    float scaled = sample * gain;
    float rounded = scaled + (scaled < 0.0f ? -0.5f : 0.5f);
    if (!(rounded < 32767.0f)) {
        return rounded >= 32767.0f ? 32767 : 0;
    }
    return rounded > -32768.0f ? (int16_t)rounded : -32768;
}

/* ---- the functions of the header ---- */

/* Tests the arithmetic: a product is rounded before it is added, rounding is to nearest, and
   subnormal numbers are kept. */
static int is_arithmetic_exact(void)
{
    volatile float x = 1.0f + 1.0f / 4096.0f;
    volatile float rounded = -(1.0f + 1.0f / 2048.0f);
    volatile float least = FLT_MIN;
    volatile float one = 1.0f;
    volatile float small = 0.75f * FLT_EPSILON;
    float a = x;
    float sum = a * a + rounded;
    float half = least * 0.5f;
    float next = one + small;
    return sum == 0.0f && half > 0.0f && half + half == least && next == 1.0f + FLT_EPSILON;
}

static int is_player(const htex_player *player)
{
    /* The pointer has the strictest alignment of the members, so the struct has its alignment. */
    return player && (uintptr_t)player % sizeof(const uint8_t *) == 0u;
}

static void clear(htex_player *player, size_t size)
{
    float *numbers = numbers_of(player);
    size_t count = (size - sizeof *player) / sizeof *numbers;
    static const htex_player zero = {0};
    *player = zero;
    for (size_t i = 0; i < count; i++) {
        numbers[i] = 0.0f;
    }
}

/* Copies from the block what is needed for every sample. */
static void start(htex_player *player, const uint8_t *block, uint32_t seed)
{
    struct parts parts = parts_of(block);
    player->block = block;
    player->rate_hz = number_at(block, 3);
    player->full_scale = number_at(block, 11);
    player->kind = block[6];
    player->quantity = block[27];
    player->size = (uint16_t)parts.half_or_count;
    player->up = (uint16_t)parts.up;
    player->row = (uint16_t)parts.row;
    player->inputs_at = (uint16_t)(parts.up * parts.row);
    player->own_at = (uint16_t)(parts.up * parts.row + 2u * parts.row);
    for (uint32_t i = 0; i < parts.up * parts.row; i++) {
        numbers_of(player)[i] = number_at(parts.rows_at, i);
    }
    seed_random(player->random, seed);
    if (player->kind == NOISE) {
        start_noise(player);
    } else {
        start_tones(player);
    }
    if ((block[7] & FLUCTUATES) != 0) {
        player->lines_at = (uint16_t)(numbers_needed(block[6], block[7], parts.half_or_count, parts.up, parts.row) - 4u * LINES);
        start_envelope(player, seed);
    }
    sound(player, number_at(parts.speeds_at, 0), number_at(parts.forces_at, 0));
}

int htex_player_open(htex_player *player, size_t size, const uint8_t *block, size_t length, uint32_t seed)
{
    if (!is_player(player) || !block) {
        return HTEX_PLAYER_POINTER;
    }
    if (!is_arithmetic_exact()) {
        return HTEX_PLAYER_ARITHMETIC;
    }
    int status = check(block, length);
    if (status != HTEX_PLAYER_OK) {
        return status;
    }
    size_t needed = htex_player_size(block, length);
    if (size < needed) {
        return HTEX_PLAYER_NO_MEMORY;
    }
    clear(player, needed);
    start(player, block, seed);
    return HTEX_PLAYER_OK;
}

float htex_player_rate_hz(const htex_player *player)
{
    return is_player(player) ? player->rate_hz : 0.0f;
}

int htex_player_quantity(const htex_player *player)
{
    return is_player(player) ? player->quantity : 0;
}

const char *htex_player_unit(const htex_player *player)
{
    static const char units[6][5] = {"", "N", "N", "m/s2", "m/s", "m"};
    return units[is_player(player) ? player->quantity : 0];
}

float htex_player_full_scale(const htex_player *player)
{
    return is_player(player) ? player->full_scale : 0.0f;
}

float htex_player_level(const htex_player *player)
{
    return is_player(player) ? player->level : 0.0f;
}

int htex_player_set_motion(htex_player *player, float speed_mm_s, float force_n)
{
    if (!is_player(player)) {
        return HTEX_PLAYER_POINTER;
    }
    if (!is_finite(speed_mm_s) || !is_finite(force_n)) {
        return HTEX_PLAYER_MOTION;
    }
    float speed = speed_mm_s < 0.0f ? -speed_mm_s : speed_mm_s;
    if (speed > MOST_SPEED_MM_S || force_n > MOST_FORCE_N) {
        hold(player);
        return HTEX_PLAYER_OK;
    }
    player->is_held = 0;
    if (speed < MIN_SLIDING_MM_S || force_n <= 0.0f) {
        fade(player);
    } else if (player->is_silent || player->last_speed != speed || player->last_force != force_n) {
        sound(player, speed, force_n);
    }
    return HTEX_PLAYER_OK;
}

int htex_player_render(htex_player *player, float *out, size_t count)
{
    if (!is_player(player) || !out || (uintptr_t)out % sizeof *out != 0u) {
        return HTEX_PLAYER_POINTER;
    }
    player->is_started = player->is_started || count > 0;
    for (size_t i = 0; i < count; i++) {
        out[i] = tick(player);
    }
    return HTEX_PLAYER_OK;
}

int htex_player_render_i16(htex_player *player, int16_t *out, size_t count, float full_scale)
{
    if (!is_player(player) || !out || (uintptr_t)out % sizeof *out != 0u) {
        return HTEX_PLAYER_POINTER;
    }
    float gain = full_scale > 0.0f ? 32767.0f / full_scale : 0.0f;
    player->is_started = player->is_started || count > 0;
    for (size_t i = 0; i < count; i++) {
        out[i] = integer_of(tick(player), gain);
    }
    return HTEX_PLAYER_OK;
}
