/* What FMOD does of an instrument, for programs that test it: loads the plugin, makes instances and mixes their blocks. Written from FMOD's
 * published documentation, as the headers here; FMOD itself has no part in it.
 */
#ifndef HOST_H
#define HOST_H

#include "counted.h"

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <fmod_common.h>

enum { ASSET, SPEED, FORCE, LEVEL, MODEL, SEED, PARAMETERS };

static const FMOD_DSP_DESCRIPTION *plugin;

/* What the functions of the host do and did. */
static int rate_hz = 48000;
static FMOD_RESULT rate_result = FMOD_OK;
static int is_out_of_memory;
static int is_changing; /* parameters change while blocks are mixed */
static int blocks; /* of memory, that the plugin has */
static int messages;
static char message[1024];

#define EXPECT(condition)                                                                                              \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "line %d: %s; last message: %s\n", __LINE__, #condition, message);                         \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

static void *F_CALL host_alloc(unsigned int size, FMOD_MEMORY_TYPE type, const char *source)
{
    (void)type;
    (void)source;
    if (is_out_of_memory)
        return NULL;
    blocks++;
    return malloc(size);
}

static void F_CALL host_free(void *memory, FMOD_MEMORY_TYPE type, const char *source)
{
    (void)type;
    (void)source;
    blocks -= memory != NULL;
    free(memory);
}

static FMOD_RESULT F_CALL host_rate(FMOD_DSP_STATE *unit, int *rate)
{
    (void)unit;
    *rate = rate_hz;
    return rate_result;
}

static void F_CALL host_log(FMOD_DEBUG_FLAGS level, const char *file, int line, const char *function, const char *format, ...)
{
    va_list arguments;
    (void)file;
    (void)line;
    EXPECT(level == FMOD_DEBUG_LEVEL_ERROR && strcmp(function, "htex") == 0);
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    messages++;
}

static FMOD_DSP_STATE_FUNCTIONS functions = {
    .alloc = host_alloc, .free = host_free, .getsamplerate = host_rate, .log = host_log,
};

/* Loads the plugin; its library stays, as FMOD's do until the system is released. */
static void load(const char *path)
{
    FMOD_DSP_DESCRIPTION *(F_CALL *describe)(void) = NULL;
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (library != NULL)
        *(void **)&describe = dlsym(library, "FMODGetDSPDescription");
    if (describe == NULL) {
        fprintf(stderr, "%s\n", dlerror());
        exit(2);
    }
    plugin = describe();
}

static void read_file(const char *path, unsigned char *bytes, unsigned int capacity, unsigned int *length)
{
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        perror(path);
        exit(2);
    }
    *length = (unsigned int)fread(bytes, 1, capacity, file);
    fclose(file);
}

static FMOD_DSP_STATE make_unit(void)
{
    FMOD_DSP_STATE unit = {.functions = &functions};
    EXPECT(plugin->create(&unit) == FMOD_OK && unit.plugindata != NULL);
    return unit;
}

static void move(FMOD_DSP_STATE *unit, float speed_mm_s, float force_n)
{
    EXPECT(plugin->setparameterfloat(unit, SPEED, speed_mm_s) == FMOD_OK);
    EXPECT(plugin->setparameterfloat(unit, FORCE, force_n) == FMOD_OK);
}

/* Mixes a block as FMOD's mixer does: asks first, and plays what does not say that it is silent. With `channels` above 0 it overrules what the
 * plugin asks for. Nothing may be allocated or freed. Returns the answer of the query. */
static FMOD_RESULT mix(FMOD_DSP_STATE *unit, float *out, unsigned int frames, int channels)
{
    FMOD_CHANNELMASK mask = 1;
    int asked = 0;
    FMOD_DSP_BUFFER_ARRAY array = {1, &asked, &mask, &out, FMOD_SPEAKERMODE_DEFAULT};
    counting = 1;
    FMOD_RESULT should = plugin->shouldiprocess(unit, 1, frames, 0, 0, FMOD_SPEAKERMODE_STEREO);
    FMOD_RESULT answer = plugin->process(unit, frames, NULL, &array, 1, FMOD_DSP_PROCESS_QUERY);
    EXPECT(asked == 1 && mask == 0 && array.speakermode == FMOD_SPEAKERMODE_MONO && (should == answer || is_changing));
    asked = channels > 0 ? channels : asked;
    memset(out, 0, frames * (unsigned int)asked * sizeof *out);
    if (answer == FMOD_OK)
        EXPECT(plugin->process(unit, frames, NULL, &array, 1, FMOD_DSP_PROCESS_PERFORM) == FMOD_OK);
    counting = 0;
    EXPECT(calls == 0);
    return answer;
}

#endif
