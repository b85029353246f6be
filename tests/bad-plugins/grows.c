/* A WASM module with one fault: rendering allocates memory. The rest is the example
 * examples/model-c-bursts. The table of faults and checks is in cli/tests/command/checker.rs.
 */
#include "htex_model.h"

/* Declared and exported above under its own name; the function of the example is renamed and called by it. */
#define htex_model_voice_render good_render
#include "../../examples/model-c-bursts/bursts.c"
#undef htex_model_voice_render

int64_t htex_model_voice_render(int64_t handle, float *out, size_t frames)
{
    static unsigned blocks;
    /* At most 32 MiB: above the host's limit the voice would be stopped, which other checks detect. */
    if (blocks++ % 16 == 0 && __builtin_wasm_memory_size(0) < 512)
        __builtin_wasm_memory_grow(0, 1);
    return good_render(handle, out, frames);
}
