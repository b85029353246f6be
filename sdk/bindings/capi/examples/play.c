/* Plays an asset along a stroke that speeds up, and writes the samples as 32-bit floats.
 *
 *     cc play.c $(pkg-config --cflags --libs htex) -o play
 *     ./play sandpaper.htex stroke.f32
 */
#include <math.h>
#include <stdio.h>

#include <htex.h>

enum { BLOCK = 64, BLOCKS = 625 }; /* 2 s at 20 kHz */

static int failed(const char *what)
{
    fprintf(stderr, "%s: %s\n", what, htex_last_error());
    return 1;
}

int main(int argc, char **argv)
{
    if (argc != 3) {
        fprintf(stderr, "usage: play ASSET.htex OUT.f32\n");
        return 2;
    }
    htex_asset asset;
    htex_voice voice;
    htex_voice_options options = {.size = sizeof options, .seed = 7};
    if (htex_asset_open(argv[1], NULL, &asset) != HTEX_STATUS_OK)
        return failed(argv[1]);
    if (htex_voice_new(asset, &options, &voice) != HTEX_STATUS_OK)
        return failed("voice");
    htex_asset_free(asset); /* the voice plays on */

    FILE *file = fopen(argv[2], "wb");
    if (file == NULL) {
        perror(argv[2]);
        return 1;
    }
    for (int block = 0; block < BLOCKS; block++) {
        float samples[BLOCK];
        htex_motion motion = {sizeof motion, 40.0 + 0.2 * block, 0.4, NAN, NAN, NAN};
        if (htex_voice_set_motion(voice, &motion) != HTEX_STATUS_OK
            || htex_voice_render(voice, samples, BLOCK) != HTEX_STATUS_OK)
            return failed("render");
        fwrite(samples, sizeof samples[0], BLOCK, file);
    }
    htex_voice_free(voice);
    return fclose(file) == 0 ? 0 : 1;
}
