/* Prints the time of a sample, ns: the least of several runs over blocks of 64. */
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <htex.h>

enum { BLOCK = 64, BLOCKS = 30000, RUNS = 5 };

static double now_ns(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

int main(int argc, char **argv)
{
    htex_asset asset;
    htex_voice voice;
    htex_voice_options options = {.size = sizeof options, .model = argv[2], .seed = 7};
    if (argc < 3 || htex_asset_open(argv[1], NULL, &asset) || htex_voice_new(asset, &options, &voice))
        return 1;
    double least = 1e30;
    for (int run = 0; run < RUNS; run++) {
        float samples[BLOCK];
        double start = now_ns();
        for (int block = 0; block < BLOCKS; block++)
            if (htex_voice_render(voice, samples, BLOCK))
                return 1;
        double ns = (now_ns() - start) / ((double)BLOCK * BLOCKS);
        least = ns < least ? ns : least;
    }
    printf("%.4f\n", least);
    return 0;
}
