/* 64 voices on four threads: motions, blocks and errors, without one call of the allocator.
 *
 *     real_time ASSET.htex RENDERS
 */
#include "counted.h"

#include <htex.h>
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

enum { THREADS = 4, VOICES = 16, FRAMES = 64, BANDS = 4 };

static htex_asset asset;
static htex_voice common; /* that all threads use */
static int renders;

#define EXPECT(call, wanted)                                                                                  \
    do {                                                                                                      \
        htex_status got = (call);                                                                             \
        if (got != (wanted)) {                                                                                \
            fprintf(stderr, "line %d: %s: status %d, %s\n", __LINE__, #call, (int)got, htex_last_error());    \
            exit(1);                                                                                          \
        }                                                                                                     \
    } while (0)

static void fail_in_every_way(htex_voice voice, float *block)
{
    const double wrong[] = {NAN, INFINITY, -1.0};
    htex_envelope envelope = {.size = sizeof envelope};
    double bands[BANDS + 1];
    htex_motion motion = {sizeof motion, 80.0, 0.4, NAN, NAN, NAN};
    htex_voice none = {voice.id + 1000};
    htex_voice foreign = {asset.id};
    for (int i = 0; i < 3; i++) {
        htex_motion bad = motion;
        bad.speed_mm_s = wrong[i];
        EXPECT(htex_voice_set_motion(voice, &bad), HTEX_STATUS_INVALID_MOTION);
        bad = motion;
        bad.force_n = wrong[i];
        EXPECT(htex_voice_set_motion(voice, &bad), HTEX_STATUS_INVALID_MOTION);
        EXPECT(htex_voice_set_gain(voice, wrong[i]), HTEX_STATUS_INVALID_ARGUMENT);
    }
    motion.position_mm = INFINITY;
    EXPECT(htex_voice_set_motion(voice, &motion), HTEX_STATUS_INVALID_MOTION);
    motion.size = 3;
    EXPECT(htex_voice_set_motion(voice, &motion), HTEX_STATUS_INVALID_ARGUMENT);
    motion.size = sizeof motion;
    EXPECT(htex_voice_set_motion(voice, NULL), HTEX_STATUS_INVALID_ARGUMENT);
    EXPECT(htex_voice_render(voice, NULL, FRAMES), HTEX_STATUS_INVALID_ARGUMENT);
    EXPECT(htex_voice_render(none, block, FRAMES), HTEX_STATUS_BAD_HANDLE);
    EXPECT(htex_voice_render(foreign, block, FRAMES), HTEX_STATUS_BAD_HANDLE);
    EXPECT(htex_voice_render_add(voice, block, FRAMES, NAN), HTEX_STATUS_INVALID_ARGUMENT);
    EXPECT(htex_voice_render_path(voice, &motion, 1, block, FRAMES), HTEX_STATUS_INVALID_MOTION);
    EXPECT(htex_voice_envelope(voice, &envelope, bands, BANDS + 1), HTEX_STATUS_INVALID_ARGUMENT);
    envelope.size = 1;
    EXPECT(htex_voice_envelope(voice, &envelope, bands, BANDS), HTEX_STATUS_INVALID_ARGUMENT);
}

static void play(htex_voice voice, int render, float *block)
{
    htex_envelope envelope = {.size = sizeof envelope};
    double bands[BANDS];
    uint32_t silent;
    /* Slow, fast, lifted, and readings that no finger has. */
    htex_motion motion = {sizeof motion, (render % 7) * 60.0, (render % 5) * 0.3, NAN, NAN, NAN};
    if (render % 11 == 0)
        motion.speed_mm_s = 1e6;
    EXPECT(htex_voice_set_motion(voice, &motion), HTEX_STATUS_OK);
    EXPECT(htex_voice_set_gain(voice, (render % 3) * 0.5), HTEX_STATUS_OK);
    EXPECT(htex_voice_render(voice, block, (size_t)(render % FRAMES)), HTEX_STATUS_OK);
    EXPECT(htex_voice_render_add(voice, block, FRAMES, 0.25f), HTEX_STATUS_OK);
    EXPECT(htex_voice_is_silent(voice, &silent), HTEX_STATUS_OK);
    EXPECT(htex_voice_envelope(voice, &envelope, bands, BANDS), HTEX_STATUS_OK);
    if (envelope.frames != (uint64_t)(render % FRAMES) + FRAMES)
        exit(2);
}

static void *run(void *own)
{
    htex_voice *voices = own;
    float block[FRAMES] = {0};
    counting = 1;
    for (int render = 0; render < renders; render++) {
        htex_voice voice = voices[render % VOICES];
        play(voice, render, block);
        if (render % 16 == 0)
            fail_in_every_way(voice, block);
        htex_status status = htex_voice_render(common, block, FRAMES);
        if (status != HTEX_STATUS_OK)
            EXPECT(status, HTEX_STATUS_BUSY);
    }
    counting = 0;
    return (void *)calls;
}

int main(int argc, char **argv)
{
    static htex_voice voices[THREADS][VOICES];
    pthread_t threads[THREADS];
    long allocations = 0;
    size_t models;
    if (argc != 3)
        return 2;
    renders = atoi(argv[2]);
    EXPECT(htex_asset_open(argv[1], NULL, &asset), HTEX_STATUS_OK);
    EXPECT(htex_asset_representation_count(asset, &models), HTEX_STATUS_OK);
    for (int i = 0; i < THREADS * VOICES; i++) {
        char model[64];
        EXPECT(htex_asset_representation_model(asset, (size_t)i % models, model, sizeof model, NULL), HTEX_STATUS_OK);
        htex_voice_options options = {
            .size = sizeof options,
            .model = model,
            .seed = (uint64_t)i,
            .rate_hz = i % 2 ? 48000.0 : 0.0,
            .limit = 1.0,
            .envelope_bands = BANDS,
        };
        EXPECT(htex_voice_new(asset, &options, &voices[i / VOICES][i % VOICES]), HTEX_STATUS_OK);
    }
    EXPECT(htex_voice_new(asset, NULL, &common), HTEX_STATUS_OK);
#ifdef COUNTED
    /* The library's calls are counted: this one is not for real-time threads. */
    counting = 1;
    EXPECT(htex_voice_reset(common, NULL), HTEX_STATUS_OK);
    if (calls == 0)
        return 3;
    counting = calls = 0;
#endif
    for (int i = 0; i < THREADS; i++)
        if (pthread_create(&threads[i], NULL, run, voices[i]) != 0)
            return 2;
    for (int i = 0; i < THREADS; i++) {
        void *made;
        pthread_join(threads[i], &made);
        allocations += (long)made;
    }
    EXPECT(htex_shutdown(), HTEX_STATUS_OK);
    EXPECT(htex_asset_free(asset), HTEX_STATUS_BAD_HANDLE);
    printf("%ld calls of the allocator\n", allocations);
    return allocations == 0 ? 0 : 1;
}
