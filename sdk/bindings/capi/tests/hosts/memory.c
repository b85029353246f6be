/* Bytes that an asset, the first voice of each model and a second one take, and what is left at the end.
 *
 *     memory ASSET.htex
 */
#include "counted.h"

#include <htex.h>
#include <stdio.h>

enum { MODELS = 7, FIRST = 64 << 10, LEFT = 256 << 10 };

static const char *const NAMES[MODELS] = {"ar", "arma", "bands", "mfcc", "sbeta", "speak", "sslope"};

int main(int argc, char **argv)
{
    htex_asset asset;
    htex_voice voice;
    long start = live_bytes, before = start, after = start;
    int failed = 0;
    if (argc != 2)
        return 2;
    for (int run = 0; run < 2; run++) {
        if (htex_asset_open(argv[1], NULL, &asset) != HTEX_STATUS_OK)
            return 3;
        printf("asset: %ld bytes\n", live_bytes - before);
        for (int i = 0; i < MODELS; i++) {
            htex_voice_options options = {.size = sizeof options, .model = NAMES[i]};
            long bytes[2];
            for (int k = 0; k < 2; k++) {
                before = live_bytes;
                if (htex_voice_new(asset, &options, &voice) != HTEX_STATUS_OK)
                    return 4;
                bytes[k] = live_bytes - before;
            }
            printf("%s: first voice %ld bytes, second %ld\n", NAMES[i], bytes[0], bytes[1]);
            /* What a model has made for its first voice, and uses for all. */
            failed |= bytes[0] - bytes[1] > FIRST;
        }
        if (htex_shutdown() != HTEX_STATUS_OK)
            return 5;
        before = live_bytes;
        printf("left: %ld bytes\n", before - start);
        /* Constants of models stay, and nothing is added to them. */
        failed |= run == 0 ? before - start > LEFT : before != after;
        after = before;
    }
    return failed;
}
