/* A WASM module with one fault: each voice of an instance has the seed of its number. The rest is the example
 * examples/model-c-bursts. cli/tests/command/checker.rs has the test.
 */
#include "htex_model.h"

/* Declared and exported above under its own name; the function of the example is renamed and called by it. */
#define htex_model_voice_new good_new
#include "../../examples/model-c-bursts/bursts.c"
#undef htex_model_voice_new

int64_t htex_model_voice_new(const double *parameters, size_t parameters_len, double band_low_hz,
                             double band_high_hz, double rate_hz, uint64_t seed)
{
    static uint64_t voices;
    return good_new(parameters, parameters_len, band_low_hz, band_high_hz, rate_hz, seed + ++voices);
}
