/* A plug-in instrument for FMOD: plays a texture of touch at the speed and force of a finger.
 * For FMOD 2.02 and 2.03; see README.md.
 *
 * Threads. The mixer calls `process` and `should_i_process`. The thread that sets parameters calls
 * all other functions, one at a time for each instance. FMOD's documentation does not promise that
 * these are two different threads, so no function waits for another:
 *   - the thread that sets parameters makes a voice and puts it in `next`; the mixer takes it from
 *     there at its next block;
 *   - the mixer frees nothing: it puts the voice that was replaced in `retired`, and a later call
 *     that sets the asset, model or seed, resets or releases frees it;
 *   - numbers are atomic.
 * set_data opens an asset within the call. So set it while a level loads, not by automation.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0
 */
#include <math.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <fmod_common.h>
#include <htex.h>

#include "models.h"

enum { ASSET, SPEED, FORCE, LEVEL, MODEL, SEED, PARAMETERS };

/* Level in dB that counts as silence. */
#define OFF_DB (-80.0f)

/* Value of `next`: play nothing. */
#define NO_VOICE UINT64_MAX

/* Projects store the index of a model, so append new models at the end. */
enum { MODEL_COUNT = sizeof MODELS / sizeof MODELS[0] };

#define FLOAT(_name, _label, _description, _min, _max, _default)                                                       \
    {                                                                                                                  \
        .type = FMOD_DSP_PARAMETER_TYPE_FLOAT, .name = _name, .label = _label, .description = _description,            \
        .floatdesc = {_min, _max, _default, {.type = FMOD_DSP_PARAMETER_FLOAT_MAPPING_TYPE_AUTO}},                     \
    }
#define INT(_name, _description, _max, _names)                                                                         \
    {                                                                                                                  \
        .type = FMOD_DSP_PARAMETER_TYPE_INT, .name = _name, .description = _description,                               \
        .intdesc = {.max = _max, .valuenames = _names},                                                                \
    }

static FMOD_DSP_PARAMETER_DESC parameters[PARAMETERS] = {
    [ASSET] = {.type = FMOD_DSP_PARAMETER_TYPE_DATA,
               .name = "Asset",
               .description = "Bytes of a .htex file. Default: none, which is silent",
               .datadesc = {FMOD_DSP_PARAMETER_DATA_TYPE_USER}},
    /* A motion above 1000 mm/s or 20 N counts as a failed reading. The voice does not follow it. */
    [SPEED] = FLOAT("Speed", "mm/s", "Scanning speed in mm/s. 0 to 1000. Default: 0, which is silent", 0.0f, 1000.0f, 0.0f),
    [FORCE] = FLOAT("Force", "N", "Normal force in N. 0 to 20. Default: 0.4", 0.0f, 20.0f, 0.4f),
    [LEVEL] = FLOAT("Level", "dB", "Full scale for one unit of the asset, in dB. -80 (off) to 60. Default: 20", OFF_DB, 60.0f, 20.0f),
    [MODEL] = INT("Model", "Model that plays. Default: the one with the least error", MODEL_COUNT - 1, MODELS),
    [SEED] = INT("Seed", "Seed of the noise. Equal seeds give equal samples. Default: 0", INT32_MAX, NULL),
};
static FMOD_DSP_PARAMETER_DESC *parameter_list[PARAMETERS] = {
    &parameters[ASSET], &parameters[SPEED], &parameters[FORCE], &parameters[LEVEL], &parameters[MODEL], &parameters[SEED],
};

/* An instance of the plug-in. */
struct texture {
    /* Only the thread that sets parameters uses these. */
    htex_asset asset;
    unsigned char *bytes;
    unsigned int length;
    int model;
    int seed;
    /* Both threads use these. */
    _Atomic float speed_mm_s;
    _Atomic float force_n;
    _Atomic float level_db;
    _Atomic uint64_t next;    /* new voice, NO_VOICE, or 0 once the mixer took it */
    _Atomic uint64_t retired; /* voice that the mixer does not play any more, or 0 */
    atomic_int failed;        /* not 0: `failure` has a text to be logged */
    char failure[256];
    /* Only the mixer uses these. */
    htex_voice playing;
    int is_broken; /* `playing` failed; silent until another voice comes */
};

static struct texture *texture_of(FMOD_DSP_STATE *state)
{
    return state->plugindata;
}

/* ---- Mixer: nothing below allocates, frees, locks or waits. ---- */

/* Takes the voice that waits in `next`, once the voice before it in `retired` was collected.
 * `retired` is stored first. A later hand_over then finds it empty or collects it, so that no
 * voice waits forever. */
static void take_over(struct texture *texture)
{
    if (atomic_load(&texture->next) == 0 || atomic_load(&texture->retired) != 0)
        return;
    atomic_store(&texture->retired, texture->playing.id);
    uint64_t next = atomic_exchange(&texture->next, 0);
    texture->playing.id = next == NO_VOICE ? 0 : next;
    texture->is_broken = 0;
}

/* Keeps the text of an error for the thread that sets parameters, and makes the voice silent. */
static void fail(struct texture *texture)
{
    texture->is_broken = 1;
    if (atomic_load(&texture->failed))
        return;
    strncpy(texture->failure, htex_last_error(), sizeof texture->failure - 1);
    atomic_store(&texture->failed, 1);
}

static double gain_of(float level_db)
{
    return level_db <= OFF_DB ? 0.0 : pow(10.0, level_db / 20.0);
}

/* Sets the level and motion of the voice. Returns whether it is audible. After the finger stops,
 * the voice stays audible until it has faded. */
static int prepare(struct texture *texture)
{
    uint32_t is_silent = 1;
    take_over(texture);
    if (texture->playing.id == 0 || texture->is_broken)
        return 0;
    htex_motion motion = {
        sizeof motion, atomic_load(&texture->speed_mm_s), atomic_load(&texture->force_n), NAN, NAN, NAN,
    };
    if (htex_voice_set_gain(texture->playing, gain_of(atomic_load(&texture->level_db))) != HTEX_STATUS_OK
        || htex_voice_set_motion(texture->playing, &motion) != HTEX_STATUS_OK
        || htex_voice_is_silent(texture->playing, &is_silent) != HTEX_STATUS_OK)
        fail(texture);
    return !is_silent;
}

/* Copies the first `frames` samples of the buffer into every one of the interleaved channels. */
static void spread(float *out, size_t frames, size_t channels)
{
    for (size_t frame = frames; frame-- > 0;) {
        float sample = out[frame];
        for (size_t channel = 0; channel < channels; channel++)
            out[frame * channels + channel] = sample;
    }
}

static void render(struct texture *texture, float *out, size_t frames, size_t channels)
{
    int sounds = prepare(texture);
    if (sounds && htex_voice_render(texture->playing, out, frames) != HTEX_STATUS_OK) {
        fail(texture);
        sounds = 0;
    }
    if (sounds)
        spread(out, frames, channels);
    else
        memset(out, 0, frames * channels * sizeof *out);
}

static void ask_for_mono(FMOD_DSP_BUFFER_ARRAY *out)
{
    out->speakermode = FMOD_SPEAKERMODE_MONO;
    out->buffernumchannels[0] = 1;
    if (out->bufferchannelmask != NULL)
        out->bufferchannelmask[0] = 0;
}

static FMOD_RESULT F_CALL process(FMOD_DSP_STATE *state, unsigned int length, const FMOD_DSP_BUFFER_ARRAY *in,
                                  FMOD_DSP_BUFFER_ARRAY *out, FMOD_BOOL inputs_idle, FMOD_DSP_PROCESS_OPERATION operation)
{
    (void)in;
    (void)inputs_idle;
    if (operation == FMOD_DSP_PROCESS_QUERY) {
        if (out != NULL)
            ask_for_mono(out);
        return prepare(texture_of(state)) ? FMOD_OK : FMOD_ERR_DSP_SILENCE;
    }
    render(texture_of(state), out->buffers[0], length, (size_t)out->buffernumchannels[0]);
    return FMOD_OK;
}

static FMOD_RESULT F_CALL should_i_process(FMOD_DSP_STATE *state, FMOD_BOOL inputs_idle, unsigned int length,
                                           FMOD_CHANNELMASK in_mask, int in_channels, FMOD_SPEAKERMODE speaker_mode)
{
    (void)inputs_idle;
    (void)length;
    (void)in_mask;
    (void)in_channels;
    (void)speaker_mode;
    return prepare(texture_of(state)) ? FMOD_OK : FMOD_ERR_DSP_SILENCE;
}

/* ---- The thread that sets parameters. ---- */

/* Logs the error that the mixer kept. */
static void report(FMOD_DSP_STATE *state)
{
    struct texture *texture = texture_of(state);
    if (!atomic_load(&texture->failed))
        return;
    FMOD_DSP_LOG(state, FMOD_DEBUG_LEVEL_ERROR, "htex", "the texture is silent: %s\n", texture->failure);
    atomic_store(&texture->failed, 0);
}

/* Logs the last error of libhtex. */
static FMOD_RESULT refused(FMOD_DSP_STATE *state, const char *what, FMOD_RESULT result)
{
    FMOD_DSP_LOG(state, FMOD_DEBUG_LEVEL_ERROR, "htex", "%s: %s\n", what, htex_last_error());
    return result;
}

static void free_voice(uint64_t voice)
{
    if (voice != 0 && voice != NO_VOICE)
        htex_voice_free((htex_voice){voice});
}

/* Gives the mixer a voice, or NO_VOICE. Frees the voice that the mixer did not take, then the
 * voice that it played before. */
static void hand_over(struct texture *texture, uint64_t voice)
{
    free_voice(atomic_exchange(&texture->next, voice));
    free_voice(atomic_exchange(&texture->retired, 0));
}

/* Makes a voice at rest. It fades in at the first motion. */
static FMOD_RESULT make_voice(FMOD_DSP_STATE *state, htex_asset asset, int model, int seed, htex_voice *voice)
{
    int rate_hz = 0;
    FMOD_RESULT result = FMOD_DSP_GETSAMPLERATE(state, &rate_hz);
    if (result != FMOD_OK)
        return result;
    htex_motion rest = {sizeof rest, 0.0, 0.0, NAN, NAN, NAN};
    htex_voice_options options = {
        .size = sizeof options,
        .model = model == 0 ? NULL : MODELS[model],
        .rate_hz = rate_hz,
        .seed = (uint64_t)seed,
        .motion = &rest,
    };
    if (htex_voice_new(asset, &options, voice) != HTEX_STATUS_OK)
        return refused(state, "the texture cannot be played", FMOD_ERR_PLUGIN);
    return FMOD_OK;
}

/* Plays the asset from its beginning with the current model and seed. After an error the old
 * voice plays on. */
static FMOD_RESULT restart(FMOD_DSP_STATE *state, int model, int seed)
{
    struct texture *texture = texture_of(state);
    htex_voice voice;
    if (texture->asset.id == 0)
        return FMOD_OK;
    FMOD_RESULT result = make_voice(state, texture->asset, model, seed, &voice);
    if (result == FMOD_OK)
        hand_over(texture, voice.id);
    return result;
}

/* Replaces asset, bytes and voice. 0, NULL and NO_VOICE stand for none. */
static void replace(FMOD_DSP_STATE *state, htex_asset asset, unsigned char *bytes, unsigned int length, uint64_t voice)
{
    struct texture *texture = texture_of(state);
    hand_over(texture, voice);
    if (texture->asset.id != 0) {
        htex_asset_free(texture->asset);
        FMOD_DSP_FREE(state, texture->bytes);
    }
    texture->asset = asset;
    texture->bytes = bytes;
    texture->length = length;
}

/* Opens an asset and makes its voice, then replaces the previous asset and voice. Keeps the
 * bytes for get_data. */
static FMOD_RESULT open_asset(FMOD_DSP_STATE *state, const void *data, unsigned int length)
{
    struct texture *texture = texture_of(state);
    htex_asset asset;
    htex_voice voice;
    if (htex_asset_from_bytes(data, length, NULL, &asset) != HTEX_STATUS_OK)
        return refused(state, "the asset cannot be opened", FMOD_ERR_FORMAT);
    FMOD_RESULT result = make_voice(state, asset, texture->model, texture->seed, &voice);
    if (result != FMOD_OK) {
        htex_asset_free(asset);
        return result;
    }
    unsigned char *bytes = FMOD_DSP_ALLOC(state, length);
    if (bytes == NULL) {
        htex_voice_free(voice);
        htex_asset_free(asset);
        return FMOD_ERR_MEMORY;
    }
    memcpy(bytes, data, length);
    replace(state, asset, bytes, length, voice.id);
    return FMOD_OK;
}

static FMOD_RESULT F_CALL set_data(FMOD_DSP_STATE *state, int index, void *data, unsigned int length)
{
    report(state);
    if (index != ASSET)
        return FMOD_ERR_INVALID_PARAM;
    if (length != 0)
        return open_asset(state, data, length);
    replace(state, (htex_asset){0}, NULL, 0, NO_VOICE);
    return FMOD_OK;
}

static FMOD_RESULT F_CALL get_data(FMOD_DSP_STATE *state, int index, void **data, unsigned int *length, char *text)
{
    struct texture *texture = texture_of(state);
    if (index != ASSET)
        return FMOD_ERR_INVALID_PARAM;
    *data = texture->bytes;
    *length = texture->length;
    /* A name that is too long is cut after a whole character. */
    if (text != NULL && htex_asset_name(texture->asset, text, FMOD_DSP_GETPARAM_VALUESTR_LENGTH, NULL) == HTEX_STATUS_BAD_HANDLE)
        text[0] = 0;
    return FMOD_OK;
}

static _Atomic float *float_of(struct texture *texture, int index)
{
    switch (index) {
    case SPEED:
        return &texture->speed_mm_s;
    case FORCE:
        return &texture->force_n;
    case LEVEL:
        return &texture->level_db;
    default:
        return NULL;
    }
}

static FMOD_RESULT F_CALL set_float(FMOD_DSP_STATE *state, int index, float value)
{
    _Atomic float *place = float_of(texture_of(state), index);
    report(state);
    if (place == NULL)
        return FMOD_ERR_INVALID_PARAM;
    if (!isfinite(value))
        return FMOD_ERR_INVALID_FLOAT;
    if (value < parameters[index].floatdesc.min || value > parameters[index].floatdesc.max)
        return FMOD_ERR_INVALID_PARAM;
    atomic_store(place, value);
    return FMOD_OK;
}

static FMOD_RESULT F_CALL get_float(FMOD_DSP_STATE *state, int index, float *value, char *text)
{
    _Atomic float *place = float_of(texture_of(state), index);
    if (place == NULL)
        return FMOD_ERR_INVALID_PARAM;
    *value = atomic_load(place);
    if (text != NULL)
        snprintf(text, FMOD_DSP_GETPARAM_VALUESTR_LENGTH, "%.2f %s", *value, parameters[index].label);
    return FMOD_OK;
}

static FMOD_RESULT F_CALL set_int(FMOD_DSP_STATE *state, int index, int value)
{
    struct texture *texture = texture_of(state);
    report(state);
    if ((index != MODEL && index != SEED) || value < 0 || value > parameters[index].intdesc.max)
        return FMOD_ERR_INVALID_PARAM;
    int *place = index == MODEL ? &texture->model : &texture->seed;
    int before = *place;
    if (value == before)
        return FMOD_OK;
    *place = value;
    FMOD_RESULT result = restart(state, texture->model, texture->seed);
    if (result != FMOD_OK)
        *place = before;
    return result;
}

static FMOD_RESULT F_CALL get_int(FMOD_DSP_STATE *state, int index, int *value, char *text)
{
    struct texture *texture = texture_of(state);
    if (index != MODEL && index != SEED)
        return FMOD_ERR_INVALID_PARAM;
    *value = index == MODEL ? texture->model : texture->seed;
    if (text == NULL)
        return FMOD_OK;
    if (index == MODEL)
        snprintf(text, FMOD_DSP_GETPARAM_VALUESTR_LENGTH, "%s", MODELS[*value]);
    else
        snprintf(text, FMOD_DSP_GETPARAM_VALUESTR_LENGTH, "%d", *value);
    return FMOD_OK;
}

static FMOD_RESULT F_CALL reset(FMOD_DSP_STATE *state)
{
    report(state);
    return restart(state, texture_of(state)->model, texture_of(state)->seed);
}

static FMOD_RESULT F_CALL create(FMOD_DSP_STATE *state)
{
    struct texture *texture = FMOD_DSP_ALLOC(state, sizeof *texture);
    if (texture == NULL)
        return FMOD_ERR_MEMORY;
    memset(texture, 0, sizeof *texture);
    atomic_init(&texture->speed_mm_s, parameters[SPEED].floatdesc.defaultval);
    atomic_init(&texture->force_n, parameters[FORCE].floatdesc.defaultval);
    atomic_init(&texture->level_db, parameters[LEVEL].floatdesc.defaultval);
    atomic_init(&texture->next, 0);
    atomic_init(&texture->retired, 0);
    atomic_init(&texture->failed, 0);
    state->plugindata = texture;
    return FMOD_OK;
}

/* FMOD has taken the instance out of the mix. */
static FMOD_RESULT F_CALL release(FMOD_DSP_STATE *state)
{
    struct texture *texture = texture_of(state);
    report(state);
    replace(state, (htex_asset){0}, NULL, 0, NO_VOICE);
    free_voice(texture->playing.id);
    FMOD_DSP_FREE(state, texture);
    state->plugindata = NULL;
    return FMOD_OK;
}

static FMOD_DSP_DESCRIPTION description = {
    .pluginsdkversion = FMOD_PLUGIN_SDK_VERSION,
    .name = "htex Texture",
    .version = 0x00010000,
    .numinputbuffers = 0,
    .numoutputbuffers = 1,
    .create = create,
    .release = release,
    .reset = reset,
    .process = process,
    .numparameters = PARAMETERS,
    .paramdesc = parameter_list,
    .setparameterfloat = set_float,
    .setparameterint = set_int,
    .setparameterdata = set_data,
    .getparameterfloat = get_float,
    .getparameterint = get_int,
    .getparameterdata = get_data,
    .shouldiprocess = should_i_process,
};

F_EXPORT FMOD_DSP_DESCRIPTION *F_CALL FMODGetDSPDescription(void);

F_EXPORT FMOD_DSP_DESCRIPTION *F_CALL FMODGetDSPDescription(void)
{
    return &description;
}
