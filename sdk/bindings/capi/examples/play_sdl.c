/* Plays an asset through a sound card with SDL2 while the finger speeds up. The audio thread
 * renders; the main thread moves the finger.
 *
 *     cc play_sdl.c $(pkg-config --cflags --libs htex sdl2) -o play_sdl
 *     ./play_sdl sandpaper.htex 2
 */
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

#include <SDL.h>
#include <htex.h>

enum { RATE_HZ = 48000, LEVEL_DB = -20 };

static htex_voice voice;
static float gain;
static _Atomic float speed_mm_s = 40.0f;
static atomic_int failures;

static void render(void *user, Uint8 *stream, int bytes)
{
    float *samples = (float *)stream;
    int frames = bytes / (int)sizeof *samples;
    htex_motion motion = {sizeof motion, atomic_load(&speed_mm_s), 0.4, NAN, NAN, NAN};
    (void)user;
    if (htex_voice_set_motion(voice, &motion) != HTEX_STATUS_OK
        || htex_voice_render(voice, samples, (size_t)frames) != HTEX_STATUS_OK) {
        SDL_memset(stream, 0, (size_t)bytes);
        atomic_fetch_add(&failures, 1);
        return;
    }
    for (int i = 0; i < frames; i++)
        samples[i] *= gain;
}

static int failed(const char *what, const char *why)
{
    fprintf(stderr, "%s: %s\n", what, why);
    return 1;
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: play_sdl ASSET.htex SECONDS\n");
        return 2;
    }
    htex_asset asset;
    double level_rms;
    htex_voice_options options = {.size = sizeof options, .rate_hz = RATE_HZ};
    if (htex_asset_open(argv[1], NULL, &asset) != HTEX_STATUS_OK)
        return failed(argv[1], htex_last_error());
    if (htex_asset_level_rms(asset, NULL, NULL, &level_rms) != HTEX_STATUS_OK
        || htex_voice_new(asset, &options, &voice) != HTEX_STATUS_OK)
        return failed("voice", htex_last_error());
    gain = level_rms > 0.0 ? (float)(pow(10.0, LEVEL_DB / 20.0) / level_rms) : 0.0f;

    if (SDL_Init(SDL_INIT_AUDIO) != 0)
        return failed("SDL", SDL_GetError());
    SDL_AudioSpec wanted = {.freq = RATE_HZ, .format = AUDIO_F32SYS, .channels = 1, .samples = 256, .callback = render};
    SDL_AudioDeviceID device = SDL_OpenAudioDevice(NULL, 0, &wanted, NULL, 0);
    if (device == 0)
        return failed("sound", SDL_GetError());
    SDL_PauseAudioDevice(device, 0);
    int steps = (int)(100.0 * atof(argv[2]));
    for (int step = 0; step < steps; step++) {
        atomic_store(&speed_mm_s, 40.0f + 120.0f * (float)step / (float)steps);
        SDL_Delay(10);
    }
    SDL_CloseAudioDevice(device);
    SDL_Quit();
    htex_voice_free(voice);
    htex_asset_free(asset);
    printf("%d blocks failed\n", atomic_load(&failures));
    return atomic_load(&failures) == 0 ? 0 : 1;
}
