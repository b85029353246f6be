/* The example of a model in C, with a voice that never returns. */

#include "htex_model.h"

#define htex_model_voice_render rendered
#include "bursts.c"
#undef htex_model_voice_render

int64_t htex_model_voice_render(int64_t voice, float *out, size_t frames)
{
    (void)voice;
    (void)out;
    (void)frames;
    for (;;) {
    }
}
