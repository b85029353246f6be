/* An OpenXR runtime without hardware, which holds a program to the rules of the specification and records what is played.
 *
 * Written from the text of the OpenXR 1.1 specification; the structures have the layouts that it
 * states. Brackets name the section of the specification that states a rule. A call that breaks a
 * rule gets the error that the section demands, and the rule is recorded, so that a test sees which
 * one it was. With MOCK_XR_RECORD=FILE in the environment, each line of the record is also written
 * to the file. */
#define _GNU_SOURCE
#include <pthread.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef int32_t Result;
enum { /* [Return Codes] */
    SUCCESS = 0, EVENT_UNAVAILABLE = 4, SESSION_NOT_FOCUSED = 8, VALIDATION_FAILURE = -1, RUNTIME_FAILURE = -2,
    INITIALIZATION_FAILED = -6, FUNCTION_UNSUPPORTED = -7, FEATURE_UNSUPPORTED = -8, EXTENSION_NOT_PRESENT = -9, LIMIT_REACHED = -10, SIZE_INSUFFICIENT = -11,
    HANDLE_INVALID = -12, SYSTEM_INVALID = -18, PATH_INVALID = -19, PATH_UNSUPPORTED = -22, ACTIONSET_NOT_ATTACHED = -46, GRAPHICS_DEVICE_INVALID = -38
};
enum { /* XrStructureType */
    T_EXTENSION = 2, T_INSTANCE = 3, T_SYSTEM_GET = 4, T_SYSTEM = 5, T_SESSION = 8, T_BEGIN = 10, T_EVENT = 16, T_STATE_CHANGED = 18, T_ACTION_SET = 28,
    T_ACTION = 29, T_SUGGESTED = 51, T_HAPTIC_ACTION = 59, T_ATTACH = 60, T_SYNC = 61, T_PCM = 1000209001, T_PCM_RATE = 1000209002,
    T_VIBRATION = 1000775000, T_PROPERTIES = 1000775001, T_SYSTEM_PARAMETRIC = 1000775002
};
enum { IDLE = 1, READY, SYNCHRONIZED, VISIBLE, FOCUSED, STOPPING };
enum { WHOLE, FIRST, INTERMEDIATE, LAST };
#define MOST_POINTS 500          /* XR_HAPTIC_PARAMETRIC_MAX_POINTS_TRANSIENTS_EXT */
#define MOST_SAMPLES 4000        /* XR_MAX_HAPTIC_PCM_BUFFER_SIZE_FB */

typedef uint64_t Handle;
typedef struct { int32_t type; const void *next; } Header;
typedef struct { int32_t type; void *next; char name[128]; uint32_t version; } Extension;
typedef struct { char name[128]; uint32_t version; char engine[128]; uint32_t engine_version; uint64_t api; } Application;
typedef struct { int32_t type; const void *next; uint64_t flags; Application application; uint32_t layers; const char *const *layer; uint32_t extensions; const char *const *extension; } InstanceInfo;
typedef struct { int32_t type; const void *next; int32_t form; } SystemInfo;
typedef struct { int32_t type; void *next; uint64_t system; uint32_t vendor; char name[256]; uint32_t graphics[3]; uint32_t tracking[2]; } System;
typedef struct { int32_t type; void *next; uint32_t supported; } SystemParametric;
typedef struct { int32_t type; const void *next; uint64_t flags; uint64_t system; } SessionInfo;
typedef struct { int32_t type; const void *next; int32_t views; } BeginInfo;
typedef struct { int32_t type; const void *next; uint8_t varying[4000]; } Event;
typedef struct { int32_t type; const void *next; Handle session; int32_t state; int64_t time; } StateChanged;
typedef struct { int32_t type; const void *next; char name[64]; char localized[128]; uint32_t priority; } SetInfo;
typedef struct { int32_t type; const void *next; char name[64]; int32_t kind; uint32_t paths; const uint64_t *path; char localized[128]; } ActionInfo;
typedef struct { Handle action; uint64_t path; } Binding;
typedef struct { int32_t type; const void *next; uint64_t profile; uint32_t count; const Binding *bindings; } Suggested;
typedef struct { int32_t type; const void *next; uint32_t count; const Handle *sets; } AttachInfo;
typedef struct { Handle set; uint64_t path; } Active;
typedef struct { int32_t type; const void *next; uint32_t count; const Active *active; } SyncInfo;
typedef struct { int32_t type; const void *next; Handle action; uint64_t path; } Element;
typedef struct { int64_t time; float value; } Point;
typedef struct { int64_t time; float amplitude, frequency; } Transient;
typedef struct {
    int32_t type; const void *next; uint32_t amplitudes; const Point *amplitude; uint32_t frequencies; const Point *frequency;
    uint32_t transients; const Transient *transient; float min_hz, max_hz; int32_t frame;
} Vibration;
typedef struct { int32_t type; void *next; int64_t ideal_ns, first_ns; float min_hz, max_hz; } Properties;
typedef struct { int32_t type; const void *next; uint32_t count; const float *samples; float rate; uint32_t append; uint32_t *consumed; } Pcm;
typedef struct { int32_t type; void *next; float rate; } PcmRate;
typedef Result (*Function)(void);

/* What a test sets. */
static struct {
    double headless, parametric, pcm, supported, focused, fails, ideal_ns, first_ns, min_hz, max_hz, pcm_rate, pcm_most;
} set = {1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 2000, MOST_SAMPLES};

/* The stream that runs on a hand [XR_EXT_haptic_parametric, Streaming], and the samples that play [XR_FB_haptic_pcm]. */
static struct hand {
    int runs, samples_play;
    int64_t since, last_amplitude, last_frequency, last_transient, samples_end;
} hands[2];

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static int instances, sessions, begun, attached, has_parametric, has_pcm, suggested, told_state, state;
static uint32_t actions, sets;
static char *paths[64];
static char *text;
static size_t length, room;

static int64_t now_ns(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static void put(const char *format, ...) {
    char part[256];
    va_list arguments;
    va_start(arguments, format);
    int count = vsnprintf(part, sizeof part, format, arguments);
    va_end(arguments);
    if (length + (size_t)count + 1 > room) text = realloc(text, room = 2 * (length + (size_t)count + 1));
    memcpy(text + length, part, (size_t)count + 1);
    length += (size_t)count;
    const char *path = getenv("MOCK_XR_RECORD");
    FILE *file = path ? fopen(path, "a") : NULL;
    if (file) {
        fputs(part, file);
        fclose(file);
    }
}

static Result broken(Result code, const char *rule) {
    put("broken %s\n", rule);
    return code;
}

/* [Trigger haptics, XrHapticParametricVibrationEXT]: each condition under which a frame is refused, in the order of the text. */
static const char *rule_of_frame(const Vibration *v, const struct hand *hand) {
    int starts = v->frame == WHOLE || v->frame == FIRST, ends = v->frame == WHOLE || v->frame == LAST;
    if (v->frame < WHOLE || v->frame > LAST) return "streamFrameType";
    if (v->amplitudes < (starts ? 2u : 1u) || v->amplitude == NULL) return "amplitude-count";
    if (v->amplitudes > MOST_POINTS || v->frequencies > MOST_POINTS || v->transients > MOST_POINTS) return "most-points";
    if (starts && v->amplitude[0].time != 0) return "first-amplitude-at-0";
    if (starts && v->frequencies > 0 && v->frequency[0].time != 0) return "first-frequency-at-0";
    if (v->frame == FIRST && v->amplitude[v->amplitudes - 1].time < (int64_t)set.first_ns) return "first-frame-duration";
    if (!starts && !hand->runs) return "no-stream";
    int low = v->min_hz != 0, high = v->max_hz != 0;
    if (low != high) return "one-frequency-unspecified";
    if (low && !(v->min_hz >= 1 && v->min_hz <= 1000 && v->max_hz >= 1 && v->max_hz <= 1000)) return "frequency-range";
    if (low && v->max_hz < v->min_hz) return "frequency-order";
    if (!starts && low) return "frequency-in-a-later-frame";
    int64_t amplitude = starts ? 0 : hand->last_amplitude, frequency = starts ? 0 : hand->last_frequency, transient = starts ? -1 : hand->last_transient;
    for (uint32_t i = 0; i < v->amplitudes; amplitude = v->amplitude[i++].time)
        if (v->amplitude[i].time < amplitude) return "amplitudes-in-order";
    for (uint32_t i = 0; i < v->frequencies; frequency = v->frequency[i++].time)
        if (v->frequency[i].time < frequency) return "frequencies-in-order";
    for (uint32_t i = 0; i < v->transients; transient = v->transient[i++].time)
        if (v->transient[i].time <= transient) return "transients-in-order";
    if (ends && (frequency > amplitude || transient > amplitude)) return "after-the-last-amplitude";
    for (uint32_t i = 0; i < v->amplitudes; i++)
        if (!(v->amplitude[i].value >= 0 && v->amplitude[i].value <= 1)) return "amplitude-0-to-1";
    for (uint32_t i = 0; i < v->frequencies; i++)
        if (!(v->frequency[i].value >= 0 && v->frequency[i].value <= 1)) return "frequency-0-to-1";
    for (uint32_t i = 0; i < v->transients; i++)
        if (!(v->transient[i].amplitude >= 0 && v->transient[i].amplitude <= 1 && v->transient[i].frequency >= 0 && v->transient[i].frequency <= 1))
            return "transient-0-to-1";
    return NULL;
}

static Result play_points(const Vibration *v, struct hand *hand, int64_t now) {
    const char *name[] = {"left", "right"}, *frame[] = {"whole", "first", "intermediate", "last"};
    if (!has_parametric) return broken(VALIDATION_FAILURE, "extension-not-enabled"); /* [Valid Usage of Structures] */
    if (!set.supported) return FEATURE_UNSUPPORTED; /* [Inspect system capability] */
    const char *rule = rule_of_frame(v, hand);
    if (rule) return broken(VALIDATION_FAILURE, rule);
    if (v->frame == WHOLE || v->frame == FIRST) *hand = (struct hand){.since = now, .last_transient = -1};
    /* [Streaming]: a frame should come before the last one has been played. It is no rule, and a program can do better. */
    int64_t late = now - hand->since - hand->last_amplitude;
    if (v->frame >= INTERMEDIATE && late > 0) put("late %lld\n", (long long)late);
    hand->runs = v->frame == FIRST || v->frame == INTERMEDIATE;
    put("points %s %s at %lld range %g %g amplitude", name[hand - hands], frame[v->frame], (long long)now, v->min_hz, v->max_hz);
    for (uint32_t i = 0; i < v->amplitudes; i++) put(" %lld:%.6f", (long long)v->amplitude[i].time, v->amplitude[i].value);
    put(" frequency");
    for (uint32_t i = 0; i < v->frequencies; i++) put(" %lld:%.6f", (long long)v->frequency[i].time, v->frequency[i].value);
    put("\n");
    hand->last_amplitude = v->amplitude[v->amplitudes - 1].time;
    if (v->frequencies) hand->last_frequency = v->frequency[v->frequencies - 1].time;
    if (v->transients) hand->last_transient = v->transient[v->transients - 1].time;
    return SUCCESS;
}

/* [XR_FB_haptic_pcm, Trigger haptics] */
static Result play_samples(const Pcm *pcm, struct hand *hand, int64_t now) {
    const char *name[] = {"left", "right"};
    if (!has_pcm) return broken(VALIDATION_FAILURE, "extension-not-enabled");
    if (set.pcm_rate == 0) return FEATURE_UNSUPPORTED;
    if (pcm->count == 0 || pcm->samples == NULL) return broken(VALIDATION_FAILURE, "bufferSize");
    if (pcm->consumed == NULL) return broken(VALIDATION_FAILURE, "samplesConsumed");
    if (!(pcm->rate > 0)) return broken(VALIDATION_FAILURE, "sampleRate");
    for (uint32_t i = 0; i < pcm->count; i++)
        if (!(pcm->samples[i] >= -1 && pcm->samples[i] <= 1)) return broken(VALIDATION_FAILURE, "sample-1-to-1");
    int goes_on = pcm->append && hand->samples_play;
    if (goes_on && now > hand->samples_end) put("late %lld\n", (long long)(now - hand->samples_end));
    int64_t from = goes_on && hand->samples_end > now ? hand->samples_end : now;
    double waits = (double)(from - now) / 1e9 * pcm->rate, space = set.pcm_most - waits;
    uint32_t taken = space <= 0 ? 0 : pcm->count <= space ? pcm->count : (uint32_t)space;
    *hand = (struct hand){.samples_play = 1, .samples_end = from + (int64_t)(1e9 * taken / pcm->rate)};
    *pcm->consumed = taken;
    put("samples %s rate %g append %u", name[hand - hands], pcm->rate, pcm->append);
    for (uint32_t i = 0; i < taken; i++) put(" %.9g", pcm->samples[i]);
    put("\n");
    return SUCCESS;
}

/* [Resolving a single Action bound to Multiple Inputs or Outputs]: the hand that an element names. */
static Result element(const Element *e, struct hand **hand) {
    if (e == NULL || e->type != T_HAPTIC_ACTION) return broken(VALIDATION_FAILURE, "hapticActionInfo");
    if (e->action == 0 || e->action > actions) return HANDLE_INVALID;
    if (!attached) return ACTIONSET_NOT_ATTACHED;
    const char *path = e->path > 0 && e->path < 64 ? paths[e->path] : NULL;
    if (path == NULL) return PATH_INVALID;
    if (strcmp(path, "/user/hand/left") == 0) *hand = &hands[0];
    else if (strcmp(path, "/user/hand/right") == 0) *hand = &hands[1];
    else return PATH_UNSUPPORTED;
    return SUCCESS;
}

static Result apply(Handle session, const Element *e, const Header *haptics) {
    pthread_mutex_lock(&lock);
    struct hand *hand = NULL;
    Result code = session == 1 && sessions ? element(e, &hand) : HANDLE_INVALID;
    if (code == SUCCESS && set.fails) code = RUNTIME_FAILURE;
    /* [Haptics]: haptics of a session without the focus are not played. */
    if (code == SUCCESS && state != FOCUSED) code = SESSION_NOT_FOCUSED;
    if (code == SUCCESS) {
        if (haptics && haptics->next != NULL) code = broken(VALIDATION_FAILURE, "next");
        else if (haptics && haptics->type == T_VIBRATION) code = play_points((const Vibration *)haptics, hand, now_ns());
        else if (haptics && haptics->type == T_PCM) code = play_samples((const Pcm *)haptics, hand, now_ns());
        else code = broken(VALIDATION_FAILURE, "type");
    }
    pthread_mutex_unlock(&lock);
    return code;
}

static Result stop(Handle session, const Element *e) {
    pthread_mutex_lock(&lock);
    struct hand *hand = NULL;
    Result code = session == 1 && sessions ? element(e, &hand) : HANDLE_INVALID;
    if (code == SUCCESS) {
        put("stop %s at %lld\n", hand == hands ? "left" : "right", (long long)now_ns());
        *hand = (struct hand){0};
    }
    pthread_mutex_unlock(&lock);
    return code;
}

static Result get_properties(Handle session, const Element *e, Properties *p) {
    pthread_mutex_lock(&lock);
    struct hand *hand = NULL;
    Result code = session == 1 && sessions ? element(e, &hand) : HANDLE_INVALID;
    if (code == SUCCESS && !set.supported) code = FEATURE_UNSUPPORTED;
    if (code == SUCCESS && (p == NULL || p->type != T_PROPERTIES)) code = broken(VALIDATION_FAILURE, "properties");
    if (code == SUCCESS) {
        p->ideal_ns = (int64_t)set.ideal_ns;
        p->first_ns = (int64_t)set.first_ns;
        p->min_hz = (float)set.min_hz;
        p->max_hz = (float)set.max_hz;
    }
    pthread_mutex_unlock(&lock);
    return code;
}

static Result pcm_rate(Handle session, const Element *e, PcmRate *rate) {
    pthread_mutex_lock(&lock);
    struct hand *hand = NULL;
    Result code = session == 1 && sessions ? element(e, &hand) : HANDLE_INVALID;
    if (code == SUCCESS && (rate == NULL || rate->type != T_PCM_RATE)) code = broken(VALIDATION_FAILURE, "rate");
    if (code == SUCCESS) rate->rate = (float)set.pcm_rate;
    pthread_mutex_unlock(&lock);
    return code;
}

static Result enumerate(const char *layer, uint32_t capacity, uint32_t *count, Extension *all) {
    (void)layer;
    const char *there[3];
    uint32_t n = 0;
    if (set.headless) there[n++] = "XR_MND_headless";
    if (set.parametric) there[n++] = "XR_EXT_haptic_parametric";
    if (set.pcm) there[n++] = "XR_FB_haptic_pcm";
    *count = n;
    if (capacity == 0) return SUCCESS; /* [Buffer Size Parameters] */
    if (capacity < n) return SIZE_INSUFFICIENT;
    for (uint32_t i = 0; i < n; i++) {
        if (all[i].type != T_EXTENSION) return broken(VALIDATION_FAILURE, "extension-type");
        strcpy(all[i].name, there[i]);
        all[i].version = 1;
    }
    return SUCCESS;
}

static Result create_instance(const InstanceInfo *info, Handle *out) {
    if (info == NULL || info->type != T_INSTANCE) return broken(VALIDATION_FAILURE, "instance");
    if (instances) return LIMIT_REACHED;
    if (info->application.name[0] == 0) return broken(VALIDATION_FAILURE, "application-name");
    int headless = 0;
    has_parametric = has_pcm = 0;
    for (uint32_t i = 0; i < info->extensions; i++) {
        const char *name = info->extension[i];
        if (strcmp(name, "XR_MND_headless") == 0 && set.headless) headless = 1;
        else if (strcmp(name, "XR_EXT_haptic_parametric") == 0 && set.parametric) has_parametric = 1;
        else if (strcmp(name, "XR_FB_haptic_pcm") == 0 && set.pcm) has_pcm = 1;
        else return EXTENSION_NOT_PRESENT;
    }
    if (!headless) return INITIALIZATION_FAILED;
    instances = 1;
    actions = sets = 0;
    suggested = attached = 0;
    *out = 1;
    put("instance\n");
    return SUCCESS;
}

static Result destroy_instance(Handle instance) {
    if (instance != 1 || !instances) return HANDLE_INVALID;
    if (sessions) broken(SUCCESS, "session-outlives-instance");
    instances = sessions = 0;
    put("end\n");
    return SUCCESS;
}

static Result get_system(Handle instance, const SystemInfo *info, uint64_t *system) {
    if (instance != 1) return HANDLE_INVALID;
    if (info->type != T_SYSTEM_GET || info->form != 1) return broken(VALIDATION_FAILURE, "system");
    *system = 7;
    return SUCCESS;
}

static Result system_properties(Handle instance, uint64_t id, System *system) {
    if (instance != 1 || id != 7) return SYSTEM_INVALID;
    if (system->type != T_SYSTEM) return broken(VALIDATION_FAILURE, "system-properties");
    SystemParametric *next = system->next;
    if (next && next->type == T_SYSTEM_PARAMETRIC) {
        if (!has_parametric) return broken(VALIDATION_FAILURE, "extension-not-enabled");
        next->supported = set.supported != 0;
    }
    return SUCCESS;
}

static Result create_session(Handle instance, const SessionInfo *info, Handle *out) {
    if (instance != 1 || info->system != 7) return HANDLE_INVALID;
    if (info->type != T_SESSION) return broken(VALIDATION_FAILURE, "session");
    if (info->next != NULL) return GRAPHICS_DEVICE_INVALID; /* [XR_MND_headless] */
    if (sessions) return LIMIT_REACHED;
    sessions = 1;
    begun = told_state = 0;
    state = READY;
    memset(hands, 0, sizeof hands);
    *out = 1;
    return SUCCESS;
}

static Result destroy_session(Handle session) {
    if (session != 1 || !sessions) return HANDLE_INVALID;
    sessions = 0;
    return SUCCESS;
}

static Result begin_session(Handle session, const BeginInfo *info) {
    if (session != 1) return HANDLE_INVALID;
    if (info->type != T_BEGIN || info->views != 2 || state != READY) return broken(VALIDATION_FAILURE, "begin");
    begun = 1;
    return SUCCESS;
}

/* [Session Lifecycle]: the states in their order, each told once. */
static Result poll_event(Handle instance, Event *event) {
    if (instance != 1) return HANDLE_INVALID;
    if (event->type != T_EVENT) return broken(VALIDATION_FAILURE, "event");
    pthread_mutex_lock(&lock);
    int target = !sessions ? 0 : !begun ? READY : set.focused ? FOCUSED : VISIBLE;
    int next = told_state < target ? told_state + 1 : told_state > target ? told_state - 1 : 0;
    if (next) {
        told_state = state = next;
        StateChanged changed = {T_STATE_CHANGED, NULL, 1, next, now_ns()};
        memcpy(event, &changed, sizeof changed);
    }
    pthread_mutex_unlock(&lock);
    return next ? SUCCESS : EVENT_UNAVAILABLE;
}

static Result string_to_path(Handle instance, const char *name, uint64_t *path) {
    if (instance != 1) return HANDLE_INVALID;
    for (uint64_t i = 1; i < 64; i++) {
        if (paths[i] == NULL) paths[i] = strdup(name);
        if (strcmp(paths[i], name) == 0) {
            *path = i;
            return SUCCESS;
        }
    }
    return PATH_INVALID;
}

static Result create_action_set(Handle instance, const SetInfo *info, Handle *out) {
    if (instance != 1) return HANDLE_INVALID;
    if (info->type != T_ACTION_SET || info->name[0] == 0 || info->localized[0] == 0) return broken(VALIDATION_FAILURE, "action-set");
    *out = ++sets;
    return SUCCESS;
}

static Result create_action(Handle of, const ActionInfo *info, Handle *out) {
    if (of == 0 || of > sets) return HANDLE_INVALID;
    if (info->type != T_ACTION || info->kind != 100 || info->paths != 2 || info->localized[0] == 0) return broken(VALIDATION_FAILURE, "action");
    *out = ++actions;
    return SUCCESS;
}

static Result suggest(Handle instance, const Suggested *all) {
    if (instance != 1) return HANDLE_INVALID;
    if (all->type != T_SUGGESTED || all->count == 0 || attached) return broken(VALIDATION_FAILURE, "suggested");
    for (uint32_t i = 0; i < all->count; i++) {
        const char *path = paths[all->bindings[i].path];
        if (path == NULL || strstr(path, "/output/haptic") == NULL) return PATH_UNSUPPORTED;
    }
    /* A runtime takes the profiles that it knows; this one has the one that all have. */
    if (strcmp(paths[all->profile], "/interaction_profiles/khr/simple_controller") != 0) return PATH_UNSUPPORTED;
    suggested = 1;
    return SUCCESS;
}

static Result attach(Handle session, const AttachInfo *info) {
    if (session != 1) return HANDLE_INVALID;
    if (info->type != T_ATTACH || info->count != 1 || attached) return broken(VALIDATION_FAILURE, "attach");
    attached = 1;
    return SUCCESS;
}

static Result sync_actions(Handle session, const SyncInfo *info) {
    if (session != 1) return HANDLE_INVALID;
    if (info->type != T_SYNC || info->count != 1 || !attached) return broken(VALIDATION_FAILURE, "sync");
    return state == FOCUSED ? SUCCESS : SESSION_NOT_FOCUSED;
}

static Result get_address(Handle instance, const char *name, Function *out) {
    static const struct { const char *name; Function function; } all[] = {
#define ENTRY(name, function) {name, (Function)(void *)(function)}
        ENTRY("xrEnumerateInstanceExtensionProperties", enumerate), ENTRY("xrCreateInstance", create_instance),
        ENTRY("xrGetInstanceProcAddr", get_address), ENTRY("xrDestroyInstance", destroy_instance), ENTRY("xrGetSystem", get_system), ENTRY("xrGetSystemProperties", system_properties),
        ENTRY("xrCreateSession", create_session), ENTRY("xrDestroySession", destroy_session), ENTRY("xrBeginSession", begin_session),
        ENTRY("xrPollEvent", poll_event), ENTRY("xrStringToPath", string_to_path), ENTRY("xrCreateActionSet", create_action_set),
        ENTRY("xrCreateAction", create_action), ENTRY("xrSuggestInteractionProfileBindings", suggest),
        ENTRY("xrAttachSessionActionSets", attach), ENTRY("xrSyncActions", sync_actions), ENTRY("xrApplyHapticFeedback", apply),
        ENTRY("xrStopHapticFeedback", stop), ENTRY("xrHapticParametricGetPropertiesEXT", get_properties),
        ENTRY("xrGetDeviceSampleRateFB", pcm_rate),
    };
    (void)instance;
    *out = NULL;
    /* [xrGetInstanceProcAddr]: functions of an extension only if it is enabled. */
    if (strcmp(name, "xrHapticParametricGetPropertiesEXT") == 0 && !has_parametric) return FUNCTION_UNSUPPORTED;
    if (strcmp(name, "xrGetDeviceSampleRateFB") == 0 && !has_pcm) return FUNCTION_UNSUPPORTED;
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        if (strcmp(all[i].name, name) == 0) *out = all[i].function;
    return *out ? SUCCESS : FUNCTION_UNSUPPORTED;
}

/* [Loader and runtime negotiation] */
typedef struct { int32_t type; uint32_t version; size_t size; uint32_t min, max; uint64_t min_api, max_api; } LoaderInfo;
typedef struct { int32_t type; uint32_t version; size_t size; uint32_t interface; uint64_t api; Result (*get)(Handle, const char *, Function *); } Request;

Result xrNegotiateLoaderRuntimeInterface(const LoaderInfo *loader, Request *request) {
    if (loader->type != 1 || loader->version != 1 || loader->size != sizeof *loader || loader->min > 1 || loader->max < 1) return INITIALIZATION_FAILED;
    if (request->type != 3 || request->version != 1 || request->size != sizeof *request) return INITIALIZATION_FAILED;
    request->interface = 1;
    request->api = (uint64_t)1 << 48 | 34;
    request->get = get_address;
    return SUCCESS;
}

/* For tests. */
int mock_set(const char *name, double value) {
    static const struct { const char *name; double *place; } all[] = {
        {"headless", &set.headless}, {"parametric", &set.parametric}, {"pcm", &set.pcm}, {"supported", &set.supported}, {"focused", &set.focused},
        {"fails", &set.fails}, {"ideal_ns", &set.ideal_ns}, {"first_ns", &set.first_ns}, {"min_hz", &set.min_hz}, {"max_hz", &set.max_hz},
        {"pcm_rate", &set.pcm_rate}, {"pcm_most", &set.pcm_most},
    };
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++)
        if (strcmp(all[i].name, name) == 0) {
            pthread_mutex_lock(&lock);
            *all[i].place = value;
            pthread_mutex_unlock(&lock);
            return 1;
        }
    return 0;
}

/* The record so far, as a text that lasts until the next call; it begins anew. */
const char *mock_record(void) {
    static char *given;
    pthread_mutex_lock(&lock);
    free(given);
    given = text ? text : strdup("");
    text = NULL;
    length = room = 0;
    pthread_mutex_unlock(&lock);
    return given;
}
