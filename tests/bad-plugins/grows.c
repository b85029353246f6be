/* A WASM module with one fault: rendering takes memory. Everything else is the example
 * examples/model-c-bursts. The table of faults and checks stands in cli/tests/checker.rs.
 */
#include "htex_model.h"

/* Declared and exported above under its own name; the example's own becomes a function behind it. */
#define htex_model_voice_render good_render
#include "../../examples/model-c-bursts/bursts.c"
#undef htex_model_voice_render

int64_t htex_model_voice_render(int64_t handle, float *out, size_t frames)
{
    static unsigned blocks;
    /* 32 MiB at most: beyond the host's limit the voice would end, which other checks find. */
    if (blocks++ % 16 == 0 && __builtin_wasm_memory_size(0) < 512)
        __builtin_wasm_memory_grow(0, 1);
    return good_render(handle, out, frames);
}
