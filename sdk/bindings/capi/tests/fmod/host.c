/* Plays an asset by the plugin at 48 kHz, in blocks of FRAMES, along strokes of 6144 samples, and writes the samples as 32-bit floats. Prints
 * how many blocks the plugin played, and how many it left out.
 *
 *     host PLUGIN ASSET.htex FRAMES OUT.f32 LEVEL_DB SEED SPEED_MM_S,FORCE_N...
 */
#include "host.h"

enum { STROKE = 6144, MOST = 2048 };

static int counts[2]; /* blocks that were played, and left out */

static void stroke(FMOD_DSP_STATE *unit, const char *motion, unsigned int frames, FILE *out)
{
    static float block[MOST];
    float speed_mm_s, force_n;
    EXPECT(sscanf(motion, "%f,%f", &speed_mm_s, &force_n) == 2);
    move(unit, speed_mm_s, force_n);
    for (unsigned int done = 0; done < STROKE; done += frames) {
        FMOD_RESULT answer = mix(unit, block, frames, 0);
        EXPECT(answer == FMOD_OK || answer == FMOD_ERR_DSP_SILENCE);
        counts[answer != FMOD_OK]++;
        EXPECT(fwrite(block, sizeof *block, frames, out) == frames);
    }
}

int main(int argc, char **argv)
{
    static unsigned char bytes[1 << 16];
    unsigned int length, frames;
    if (argc < 8)
        return 2;
    load(argv[1]);
    read_file(argv[2], bytes, sizeof bytes, &length);
    frames = (unsigned int)atoi(argv[3]);
    EXPECT(frames > 0 && frames <= MOST && STROKE % frames == 0);
    FILE *out = fopen(argv[4], "wb");
    EXPECT(out != NULL);
    FMOD_DSP_STATE unit = make_unit();
    EXPECT(plugin->setparameterfloat(&unit, LEVEL, (float)atof(argv[5])) == FMOD_OK);
    EXPECT(plugin->setparameterdata(&unit, ASSET, bytes, length) == FMOD_OK);
    memset(bytes, 0, sizeof bytes); /* the plugin has a copy */
    EXPECT(plugin->setparameterint(&unit, SEED, atoi(argv[6])) == FMOD_OK);
    for (int i = 7; i < argc; i++)
        stroke(&unit, argv[i], frames, out);
    EXPECT(plugin->release(&unit) == FMOD_OK && blocks == 0 && messages == 0);
    printf("%d %d\n", counts[0], counts[1]);
    return fclose(out) == 0 ? 0 : 1;
}
