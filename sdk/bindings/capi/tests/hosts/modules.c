/* A program that opens an asset with a module, which it did not ask for, and then one that it asked for: threads and handlers of signals.
 *
 *     modules ASSET.htex
 */
#define _GNU_SOURCE
#include <dirent.h>
#include <htex.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const int SIGNALS[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGTRAP};
enum { COUNT = sizeof SIGNALS / sizeof *SIGNALS };

static int entries(const char *folder)
{
    int count = 0;
    DIR *open = opendir(folder);
    while (open != NULL && readdir(open) != NULL)
        count++;
    if (open != NULL)
        closedir(open);
    return count;
}

static int threads(void)
{
    return entries("/proc/self/task") - 2;
}

/* Handlers that are not the default ones. */
static int handlers(void)
{
    int count = 0;
    for (int i = 0; i < COUNT; i++) {
        struct sigaction action;
        sigaction(SIGNALS[i], NULL, &action);
        count += action.sa_handler != SIG_DFL;
    }
    return count;
}

static void expect(const char *when, int wanted_threads, int wanted_handlers)
{
    if (threads() != wanted_threads || handlers() != wanted_handlers) {
        fprintf(stderr, "%s: %d threads, %d handlers\n", when, threads(), handlers());
        exit(1);
    }
}

static htex_status play(htex_asset asset, const char *model, float *block)
{
    htex_voice voice;
    htex_voice_options options = {.size = sizeof options, .model = model};
    htex_status status = htex_voice_new(asset, &options, &voice);
    if (status == HTEX_STATUS_OK)
        status = htex_voice_render(voice, block, 256);
    return status;
}

int main(int argc, char **argv)
{
    htex_asset asset;
    float block[256];
    if (argc != 2)
        return 2;
    expect("at the start", 1, 0);
    if (htex_asset_open(argv[1], NULL, &asset) != HTEX_STATUS_OK)
        return 3;
    /* The representation of least error that a model of this program plays. */
    if (play(asset, NULL, block) != HTEX_STATUS_OK)
        return 4;
    if (play(asset, "bursts", block) != HTEX_STATUS_NO_MODEL)
        return 5;
    expect("without an engine", 1, 0);

    htex_open_options options = {.size = sizeof options, .engine = HTEX_ENGINE_CHECKED};
    if (htex_asset_open(argv[1], &options, &asset) != HTEX_STATUS_OK)
        return 6;
    expect("before a module is used", 1, 0);
    if (play(asset, "bursts", block) != HTEX_STATUS_OK)
        return fprintf(stderr, "%s\n", htex_last_error()), 7;
    expect("with a checked engine", 2, 0);
    if (htex_shutdown() != HTEX_STATUS_OK)
        return 8;
    expect("after the end", 1, 0);

    options.engine = HTEX_ENGINE_SIGNALS;
    if (htex_asset_open(argv[1], &options, &asset) != HTEX_STATUS_OK || play(asset, "bursts", block) != HTEX_STATUS_OK)
        return 9;
    if (threads() != 2 || handlers() == 0)
        return 10;
    options.engine = 3;
    if (htex_asset_open(argv[1], &options, &asset) != HTEX_STATUS_INVALID_ARGUMENT)
        return 11;
    return htex_shutdown() == HTEX_STATUS_OK && threads() == 1 ? 0 : 12;
}
