/* A gamepad without hardware: SDL's own virtual joystick, which records what its motors are told.
 *
 * A library that is linked with SDL, and thus has all of its functions. The adapter gets it as
 * `driver`. The gamepad is attached when the adapter initialises SDL. With PAD_RECORD=FILE in the
 * environment, each call also writes a line to the file. */
#define _GNU_SOURCE
#include <SDL2/SDL.h>
#include <dlfcn.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define MOST 100000

struct told {
    int64_t ns;
    uint16_t large, small;
};

static struct told told[MOST];
static atomic_size_t count;
static atomic_int index_of_pad = -1;
static atomic_int fails;

int64_t pad_now_ns(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static int rumble(void *userdata, Uint16 large, Uint16 small) {
    (void)userdata;
    if (atomic_load(&fails)) return SDL_SetError("the cable is loose");
    size_t at = atomic_load(&count);
    if (at < MOST) {
        told[at] = (struct told){pad_now_ns(), large, small};
        atomic_store(&count, at + 1);
    }
    const char *path = getenv("PAD_RECORD");
    FILE *file = path ? fopen(path, "a") : NULL;
    if (file) {
        fprintf(file, "%u %u\n", large, small);
        fclose(file);
    }
    return 0;
}

static int attach(void) {
    SDL_VirtualJoystickDesc desc;
    SDL_zero(desc);
    desc.version = SDL_VIRTUAL_JOYSTICK_DESC_VERSION;
    desc.type = SDL_JOYSTICK_TYPE_GAMECONTROLLER;
    desc.naxes = SDL_CONTROLLER_AXIS_MAX;
    desc.nbuttons = SDL_CONTROLLER_BUTTON_MAX;
    desc.name = "Test pad";
    desc.Rumble = rumble;
    return SDL_JoystickAttachVirtualEx(&desc);
}

/* SDL's function, with a gamepad once it is ready. */
int SDL_InitSubSystem(Uint32 flags) {
    int (*real)(Uint32) = (int (*)(Uint32))dlsym(RTLD_NEXT, "SDL_InitSubSystem");
    int code = real ? real(flags) : -1;
    if (code == 0 && getenv("PAD_NONE") == NULL) atomic_store(&index_of_pad, attach());
    return code;
}

size_t pad_count(void) { return atomic_load(&count); }

void pad_told(size_t at, int64_t *ns, uint16_t *large, uint16_t *small) {
    *ns = told[at].ns;
    *large = told[at].large;
    *small = told[at].small;
}

/* From now on SDL cannot reach the motors, or it can again. */
void pad_fail(int now) { atomic_store(&fails, now); }

void pad_pull_out(void) { SDL_JoystickDetachVirtual(atomic_exchange(&index_of_pad, -1)); }
void pad_plug_in(void) { atomic_store(&index_of_pad, attach()); }
