/* Holds the plugin to what its README says: silence, refusals, parameters, several instances, a mixer that never waits. Prints the parameters as
 * rows of the table of the README, the names of the models, and the messages of refusals.
 *
 *     checks PLUGIN ASSET.htex CHANGES
 */
#include "host.h"

#include <math.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>

#include <htex.h>

enum { FRAMES = 256, UNITS = 8, ROUNDS = 12 };

static unsigned char asset[1 << 16];
static unsigned int asset_length;

static FMOD_DSP_STATE unit_with_asset(void)
{
    FMOD_DSP_STATE unit = make_unit();
    EXPECT(plugin->setparameterdata(&unit, ASSET, asset, asset_length) == FMOD_OK);
    return unit;
}

static void release(FMOD_DSP_STATE *unit)
{
    EXPECT(plugin->release(unit) == FMOD_OK && unit->plugindata == NULL);
}

/* Some blocks one after the other; returns their mean square. */
static double play(FMOD_DSP_STATE *unit, float out[ROUNDS][FRAMES])
{
    double sum = 0.0;
    for (int round = 0; round < ROUNDS; round++) {
        mix(unit, out[round], FRAMES, 0);
        for (int i = 0; i < FRAMES; i++)
            sum += (double)out[round][i] * out[round][i];
    }
    return sum / (ROUNDS * FRAMES);
}

/* What a new instance plays at 80 mm/s and 0.4 N. */
static void play_alone(int model, int seed, float out[ROUNDS][FRAMES])
{
    FMOD_DSP_STATE unit = unit_with_asset();
    EXPECT(plugin->setparameterint(&unit, MODEL, model) == FMOD_OK);
    EXPECT(plugin->setparameterint(&unit, SEED, seed) == FMOD_OK);
    move(&unit, 80.0f, 0.4f);
    EXPECT(play(&unit, out) > 0.0);
    release(&unit);
}

static int same(float a[ROUNDS][FRAMES], float b[ROUNDS][FRAMES])
{
    return memcmp(a, b, sizeof(float[ROUNDS][FRAMES])) == 0;
}

static void print_parameter(int index)
{
    const FMOD_DSP_PARAMETER_DESC *desc = plugin->paramdesc[index];
    printf("| %d | %s |", index, desc->name);
    if (desc->type == FMOD_DSP_PARAMETER_TYPE_FLOAT)
        printf(" float, %s | %g to %g | %g |", desc->label, (double)desc->floatdesc.min, (double)desc->floatdesc.max,
               (double)desc->floatdesc.defaultval);
    else if (desc->type == FMOD_DSP_PARAMETER_TYPE_INT)
        printf(" int | %d to %d | %d |", desc->intdesc.min, desc->intdesc.max, desc->intdesc.defaultval);
    else
        printf(" data | | none |");
    printf("\n");
}

static void describe(void)
{
    EXPECT(plugin->pluginsdkversion == 110 && plugin->numinputbuffers == 0 && plugin->numoutputbuffers == 1);
    EXPECT(plugin->numparameters == PARAMETERS && strcmp(plugin->name, "htex Texture") == 0);
    for (int i = 0; i < PARAMETERS; i++)
        print_parameter(i);
    const FMOD_DSP_PARAMETER_DESC_INT *models = &plugin->paramdesc[MODEL]->intdesc;
    for (int i = 1; i <= models->max; i++)
        printf("model %s\n", models->valuenames[i]);
}

/* New instances have the values of the descriptions. */
static void defaults_are_those_described(void)
{
    FMOD_DSP_STATE unit = make_unit();
    for (int i = 0; i < PARAMETERS; i++) {
        const FMOD_DSP_PARAMETER_DESC *desc = plugin->paramdesc[i];
        float number;
        int whole;
        if (desc->type == FMOD_DSP_PARAMETER_TYPE_FLOAT)
            EXPECT(plugin->getparameterfloat(&unit, i, &number, NULL) == FMOD_OK && number == desc->floatdesc.defaultval);
        else if (desc->type == FMOD_DSP_PARAMETER_TYPE_INT)
            EXPECT(plugin->getparameterint(&unit, i, &whole, NULL) == FMOD_OK && whole == desc->intdesc.defaultval);
    }
    release(&unit);
}

static void silence_without_asset_and_without_motion(void)
{
    static float out[ROUNDS][FRAMES];
    FMOD_DSP_STATE unit = make_unit();
    move(&unit, 80.0f, 0.4f);
    EXPECT(mix(&unit, out[0], FRAMES, 0) == FMOD_ERR_DSP_SILENCE);
    EXPECT(plugin->reset(&unit) == FMOD_OK);
    EXPECT(plugin->setparameterdata(&unit, ASSET, asset, asset_length) == FMOD_OK);
    EXPECT(mix(&unit, out[0], FRAMES, 0) == FMOD_OK);
    /* The finger stops: the texture fades, then the instance is idle. */
    move(&unit, 0.0f, 0.4f);
    EXPECT(mix(&unit, out[0], FRAMES, 0) == FMOD_OK);
    play(&unit, out);
    EXPECT(mix(&unit, out[0], FRAMES, 0) == FMOD_ERR_DSP_SILENCE);
    move(&unit, 80.0f, 0.4f);
    EXPECT(mix(&unit, out[0], FRAMES, 0) == FMOD_OK && play(&unit, out) > 0.0);
    move(&unit, 80.0f, 0.0f);
    play(&unit, out);
    EXPECT(mix(&unit, out[0], FRAMES, 0) == FMOD_ERR_DSP_SILENCE);
    /* Without the asset it is silent at once, also for a mixer that does not ask. */
    move(&unit, 80.0f, 0.4f);
    EXPECT(plugin->setparameterdata(&unit, ASSET, NULL, 0) == FMOD_OK);
    EXPECT(mix(&unit, out[0], FRAMES, 0) == FMOD_ERR_DSP_SILENCE);
    int channels = 1;
    float *buffer = out[0];
    FMOD_DSP_BUFFER_ARRAY array = {1, &channels, NULL, &buffer, FMOD_SPEAKERMODE_MONO};
    out[0][0] = 1.0f;
    EXPECT(plugin->process(&unit, FRAMES, NULL, &array, 1, FMOD_DSP_PROCESS_PERFORM) == FMOD_OK && out[0][0] == 0.0f);
    release(&unit);
}

/* A level at its lowest is silent, and the louder of two is so by their difference. */
static void levels(void)
{
    static float loud[ROUNDS][FRAMES], soft[ROUNDS][FRAMES];
    FMOD_DSP_STATE unit = unit_with_asset();
    move(&unit, 80.0f, 0.4f);
    EXPECT(plugin->setparameterfloat(&unit, LEVEL, -80.0f) == FMOD_OK && play(&unit, soft) == 0.0);
    release(&unit);
    play_alone(0, 0, loud);
    unit = unit_with_asset();
    EXPECT(plugin->setparameterfloat(&unit, LEVEL, 0.0f) == FMOD_OK);
    move(&unit, 80.0f, 0.4f);
    play(&unit, soft);
    for (int i = 0; i < FRAMES; i++)
        EXPECT(fabsf(loud[4][i] - 10.0f * soft[4][i]) <= 1e-5f * fabsf(loud[4][i]));
    release(&unit);
}

static void values_have_texts(void)
{
    char text[FMOD_DSP_GETPARAM_VALUESTR_LENGTH];
    void *data;
    unsigned int length;
    float number;
    int whole;
    FMOD_DSP_STATE unit = unit_with_asset();
    move(&unit, 80.0f, 0.25f);
    EXPECT(plugin->getparameterfloat(&unit, SPEED, &number, text) == FMOD_OK && number == 80.0f && strcmp(text, "80.00 mm/s") == 0);
    EXPECT(plugin->getparameterfloat(&unit, FORCE, &number, text) == FMOD_OK && number == 0.25f && strcmp(text, "0.25 N") == 0);
    EXPECT(plugin->getparameterfloat(&unit, LEVEL, &number, text) == FMOD_OK && strcmp(text, "20.00 dB") == 0);
    EXPECT(plugin->setparameterint(&unit, MODEL, 4) == FMOD_OK && plugin->setparameterint(&unit, SEED, 7) == FMOD_OK);
    EXPECT(plugin->getparameterint(&unit, MODEL, &whole, text) == FMOD_OK && whole == 4 && strcmp(text, "sbeta") == 0);
    EXPECT(plugin->getparameterint(&unit, SEED, &whole, text) == FMOD_OK && whole == 7 && strcmp(text, "7") == 0);
    EXPECT(plugin->getparameterdata(&unit, ASSET, &data, &length, text) == FMOD_OK && strcmp(text, "vinyl (simulated)") == 0);
    EXPECT(length == asset_length && memcmp(data, asset, length) == 0);
    EXPECT(plugin->setparameterdata(&unit, ASSET, NULL, 0) == FMOD_OK);
    EXPECT(plugin->getparameterdata(&unit, ASSET, &data, &length, text) == FMOD_OK && data == NULL && length == 0 && text[0] == 0);
    release(&unit);
}

/* No index is taken for another kind of value, and no value beyond its range. */
static void bad_indices_and_values(void)
{
    const float bad[] = {-1.0f, 1001.0f};
    void *data;
    unsigned int length;
    float number;
    int whole;
    FMOD_DSP_STATE unit = make_unit();
    for (int i = -2; i < PARAMETERS + 3; i++) {
        int is_float = i == SPEED || i == FORCE || i == LEVEL, is_int = i == MODEL || i == SEED;
        EXPECT((plugin->setparameterfloat(&unit, i, 0.0f) == FMOD_OK) == is_float);
        EXPECT((plugin->getparameterfloat(&unit, i, &number, NULL) == FMOD_OK) == is_float);
        EXPECT((plugin->setparameterint(&unit, i, 0) == FMOD_OK) == is_int);
        EXPECT((plugin->getparameterint(&unit, i, &whole, NULL) == FMOD_OK) == is_int);
        EXPECT((plugin->setparameterdata(&unit, i, asset, asset_length) == FMOD_OK) == (i == ASSET));
        EXPECT((plugin->getparameterdata(&unit, i, &data, &length, NULL) == FMOD_OK) == (i == ASSET));
    }
    for (int i = 0; i < 2; i++)
        EXPECT(plugin->setparameterfloat(&unit, SPEED, bad[i]) == FMOD_ERR_INVALID_PARAM);
    EXPECT(plugin->setparameterfloat(&unit, SPEED, NAN) == FMOD_ERR_INVALID_FLOAT);
    EXPECT(plugin->setparameterfloat(&unit, LEVEL, INFINITY) == FMOD_ERR_INVALID_FLOAT);
    EXPECT(plugin->setparameterint(&unit, MODEL, -1) == FMOD_ERR_INVALID_PARAM);
    EXPECT(plugin->setparameterint(&unit, MODEL, plugin->paramdesc[MODEL]->intdesc.max + 1) == FMOD_ERR_INVALID_PARAM);
    EXPECT(plugin->setparameterint(&unit, SEED, -1) == FMOD_ERR_INVALID_PARAM);
    EXPECT(plugin->getparameterfloat(&unit, SPEED, &number, NULL) == FMOD_OK && number == 0.0f && messages == 0);
    release(&unit);
}

static void expect_message(int *before)
{
    EXPECT(messages == *before + 1);
    *before = messages;
    printf("message %s", message);
}

/* A damaged asset, a model that the asset lacks, a rate that is too low, no memory: the texture plays on, with the same samples. */
static void refusals_change_nothing(void)
{
    static float expected[ROUNDS][FRAMES], out[ROUNDS][FRAMES];
    const int absent = 6, before_hz = rate_hz;
    int whole, seen = messages;
    play_alone(0, 3, expected);
    FMOD_DSP_STATE unit = unit_with_asset();
    EXPECT(plugin->setparameterint(&unit, SEED, 3) == FMOD_OK);
    move(&unit, 80.0f, 0.4f);
    for (int round = 0; round < ROUNDS; round++) {
        if (round == 4) {
            EXPECT(plugin->setparameterdata(&unit, ASSET, asset, asset_length / 2) == FMOD_ERR_FORMAT);
            expect_message(&seen);
            EXPECT(plugin->setparameterint(&unit, MODEL, absent) == FMOD_ERR_PLUGIN);
            expect_message(&seen);
            EXPECT(plugin->getparameterint(&unit, MODEL, &whole, NULL) == FMOD_OK && whole == 0);
            rate_hz = 1000;
            EXPECT(plugin->setparameterint(&unit, SEED, 4) == FMOD_ERR_PLUGIN);
            expect_message(&seen);
            EXPECT(plugin->setparameterdata(&unit, ASSET, asset, asset_length) == FMOD_ERR_PLUGIN);
            expect_message(&seen);
            rate_hz = before_hz;
            rate_result = FMOD_ERR_INVALID_PARAM;
            EXPECT(plugin->reset(&unit) == FMOD_ERR_INVALID_PARAM);
            rate_result = FMOD_OK;
            is_out_of_memory = 1;
            EXPECT(plugin->setparameterdata(&unit, ASSET, asset, asset_length) == FMOD_ERR_MEMORY);
            is_out_of_memory = 0;
        }
        mix(&unit, out[round], FRAMES, 0);
    }
    EXPECT(same(out, expected) && messages == seen);
    release(&unit);
    FMOD_DSP_STATE other = {.functions = &functions};
    is_out_of_memory = 1;
    EXPECT(plugin->create(&other) == FMOD_ERR_MEMORY);
    is_out_of_memory = 0;
}

/* Model and seed begin the texture anew, and so does a reset; the same again changes nothing. */
static void models_seeds_and_resets(void)
{
    static float first[ROUNDS][FRAMES], other[ROUNDS][FRAMES], out[ROUNDS][FRAMES];
    play_alone(0, 0, first);
    play_alone(1, 0, out);
    EXPECT(same(out, first)); /* of least error is ar */
    play_alone(0, 1, other);
    EXPECT(!same(other, first));
    play_alone(4, 0, out);
    EXPECT(!same(out, first) && !same(out, other));
    FMOD_DSP_STATE unit = unit_with_asset();
    move(&unit, 80.0f, 0.4f);
    EXPECT(play(&unit, out) > 0.0 && same(out, first));
    EXPECT(plugin->setparameterint(&unit, SEED, 0) == FMOD_OK && plugin->setparameterint(&unit, MODEL, 0) == FMOD_OK);
    EXPECT(play(&unit, out) > 0.0 && !same(out, first));
    EXPECT(plugin->reset(&unit) == FMOD_OK && play(&unit, out) > 0.0 && same(out, first));
    EXPECT(plugin->setparameterint(&unit, SEED, 1) == FMOD_OK && play(&unit, out) > 0.0 && same(out, other));
    EXPECT(plugin->setparameterdata(&unit, ASSET, asset, asset_length) == FMOD_OK && play(&unit, out) > 0.0 && same(out, other));
    release(&unit); /* while it sounds */
}

/* Instances that are mixed in turn play what each plays alone, and a block of two channels has the samples of one in both. */
static void instances_are_of_their_own(void)
{
    static float expected[UNITS][ROUNDS][FRAMES], two[2 * FRAMES], one[FRAMES];
    FMOD_DSP_STATE units[UNITS];
    for (int i = 0; i < UNITS; i++) {
        play_alone(0, i, expected[i]);
        units[i] = unit_with_asset();
        EXPECT(plugin->setparameterint(&units[i], SEED, i) == FMOD_OK);
        move(&units[i], 80.0f, 0.4f);
    }
    for (int round = 0; round < ROUNDS; round++)
        for (int i = 0; i < UNITS; i++) {
            mix(&units[i], two, FRAMES, i % 2 ? 2 : 1);
            for (int frame = 0; frame < FRAMES; frame++)
                one[frame] = two[frame * (i % 2 + 1)];
            EXPECT(memcmp(one, expected[i][round], sizeof one) == 0);
            for (int frame = 0; frame < FRAMES && i % 2; frame++)
                EXPECT(two[2 * frame] == two[2 * frame + 1]);
        }
    for (int i = 0; i < UNITS; i++)
        release(&units[i]);
}

static atomic_int is_over;
static atomic_long mixed;

static void *mix_until_over(void *unit)
{
    static float block[FRAMES];
    for (; !atomic_load(&is_over); atomic_fetch_add(&mixed, 1))
        mix(unit, block, FRAMES, 0);
    return NULL;
}

/* Valgrind runs one thread at a time, and need not run the mixer at all before the changes are over. */
static void wait_for_a_block(void)
{
    for (long seen = atomic_load(&mixed); atomic_load(&mixed) == seen;)
        sched_yield();
}

/* Assets, models, seeds, motions and resets while a mixer runs without a pause; then the release of what sounds. */
static void changes_while_it_plays(int changes)
{
    FMOD_DSP_STATE unit = make_unit();
    pthread_t mixer;
    is_changing = 1;
    atomic_store(&is_over, 0);
    EXPECT(pthread_create(&mixer, NULL, mix_until_over, &unit) == 0);
    for (int i = 0; i < changes; i++) {
        unsigned int length = i % 7 == 6 ? 0 : asset_length;
        if (i % 3 == 0)
            EXPECT(plugin->setparameterdata(&unit, ASSET, asset, length) == FMOD_OK);
        EXPECT(plugin->setparameterint(&unit, MODEL, i % 6) == FMOD_OK);
        EXPECT(plugin->setparameterint(&unit, SEED, i) == FMOD_OK);
        move(&unit, (float)(i % 5) * 50.0f, 0.4f);
        EXPECT(plugin->reset(&unit) == FMOD_OK);
        if (i % 2 == 0)
            wait_for_a_block();
    }
    atomic_store(&is_over, 1);
    pthread_join(mixer, NULL);
    is_changing = 0;
    EXPECT(messages == 4);
    release(&unit);
}

/* No voice is lost between the threads. */
static void changes_lose_no_voice(int changes)
{
    changes_while_it_plays(changes);
#ifdef COUNTED
    long live = live_bytes;
    changes_while_it_plays(changes);
    EXPECT(live_bytes == live);
#endif
}

/* Instances leave no memory behind; the first ones leave what libhtex keeps. */
static void instances_leave_nothing(void)
{
    EXPECT(blocks == 0);
#ifdef COUNTED
    static float out[ROUNDS][FRAMES];
    long live = 0;
    for (int i = 0; i < 40; i++) {
        FMOD_DSP_STATE unit = unit_with_asset();
        move(&unit, 80.0f, 0.4f);
        EXPECT(play(&unit, out) > 0.0 && plugin->setparameterint(&unit, SEED, i + 1) == FMOD_OK && plugin->reset(&unit) == FMOD_OK);
        play(&unit, out);
        rate_hz = 1000; /* too low: the asset opens, and there is no voice */
        EXPECT(plugin->setparameterdata(&unit, ASSET, asset, asset_length) == FMOD_ERR_PLUGIN);
        rate_hz = 48000;
        release(&unit);
        if (i == 10)
            live = live_bytes;
    }
    EXPECT(live_bytes == live);
#endif
}

/* The end of the library takes voices away from the mixer: the instance is silent, and says why once a parameter is set. */
static void failures_of_the_mixer_are_told(void)
{
    static float out[ROUNDS][FRAMES];
    int seen = messages;
    FMOD_DSP_STATE unit = unit_with_asset();
    move(&unit, 80.0f, 0.4f);
    EXPECT(play(&unit, out) > 0.0);
    EXPECT(htex_shutdown() == HTEX_STATUS_OK);
    EXPECT(mix(&unit, out[0], FRAMES, 0) == FMOD_ERR_DSP_SILENCE && play(&unit, out) == 0.0 && messages == seen);
    move(&unit, 90.0f, 0.4f);
    expect_message(&seen);
    play(&unit, out);
    move(&unit, 90.0f, 0.4f); /* says it once */
    EXPECT(plugin->setparameterdata(&unit, ASSET, asset, asset_length) == FMOD_OK && play(&unit, out) > 0.0 && messages == seen);
    release(&unit);
}

int main(int argc, char **argv)
{
    if (argc != 4)
        return 2;
    load(argv[1]);
    read_file(argv[2], asset, sizeof asset, &asset_length);
    describe();
    defaults_are_those_described();
    silence_without_asset_and_without_motion();
    levels();
    values_have_texts();
    bad_indices_and_values();
    refusals_change_nothing();
    models_seeds_and_resets();
    instances_are_of_their_own();
    changes_lose_no_voice(atoi(argv[3]));
    instances_leave_nothing();
    failures_of_the_mixer_are_told();
    EXPECT(blocks == 0);
    return 0;
}
