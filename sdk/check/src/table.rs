//! Every check, in one table.

use crate::case::Case;
use crate::checks::{
    abi, allocation, change, fit, magnitude, motion, refusal, repeat, resources, sound, together,
    twin,
};

htex_check_runner::checks! { Case;
    "marker" needs [] abi::loaded:
        "The marker names this ABI's major version.",
        "`htex_model_abi_version` is called before anything else.";
    "exports" needs ["marker"] abi::loaded:
        "The file loads, and exports every function of the ABI.",
        "The file is loaded as a host loads it; each function is looked up by name.";
    "descriptor" needs ["exports"] abi::descriptor:
        "The descriptor is JSON of the schema, and makes sense.",
        "Reverse-DNS id, semantic version, name and summary present; 1 to 32 fields; names not empty \
         and no two alike; finite ranges the right way round; stores with positive, finite steps; \
         option defaults in range, whole where they must be.";
    "extensions" needs ["exports"] abi::extensions:
        "Unknown extensions are absent.",
        "Made-up ids, an empty one and a very long one are asked for; each must return 0.";
    "fit" needs ["descriptor"] fit::reference:
        "Reference spectra are fitted.",
        "Five spectra: two smooth bumps, falling, rising, broad with ripple, few peaks. Each is \
         fitted, or the model returns CANNOT_FIT, and at least one is fitted; parameters obey the \
         descriptor; the level is above 0; fitting again gives the same numbers.";
    "fit-hard" needs ["fit"] fit::hard:
        "Hard spectra are fitted, or the model returns a status.",
        "Silence, one line, flat, 1e-200 and 1e100 times the usual, all energy in the lowest bin, and \
         a grid of two bins. A panic fails.";
    "magnitude" needs ["fit"] magnitude::sane:
        "Magnitudes are finite and not negative.",
        "On the 5 Hz grid, every 0.5 Hz, at the band's edges and outside of it, for every reference.";
    "parameters" needs ["fit", "magnitude"] fit::round_trip:
        "Parameters survive being taken apart, put together and stored.",
        "Fitted parameters are read by field and flattened again: the same magnitudes. They are \
         stored by the descriptor's stores and read back: still accepted. A warning when storing \
         moves the spectrum by more than 0.5 dB.";
    "magnitude-grid" needs ["magnitude"] magnitude::grid:
        "The magnitude at a frequency does not depend on which others are asked for.",
        "The 5 Hz grid as a whole, frequency by frequency, in reversed chunks of ten, and within a \
         0.5 Hz grid; agreement within 1e-9 of the largest magnitude.";
    "render" needs ["fit"] sound::renders:
        "A voice renders.",
        "One second of every fitted reference; no error, not silent.";
    "samples" needs ["render"] sound::clean:
        "No sample is infinite, not a number or subnormal.",
        "Twenty seconds of every fitted reference, with a retune each second.";
    "level" needs ["magnitude", "render"] sound::level:
        "Magnitude and sound have unit RMS.",
        "The magnitude's RMS on the 5 Hz grid within 2 %, and the RMS of a minute of sound within 2 %, \
         or within four standard deviations of what noise of this spectrum has in a minute, where \
         that is more. A magnitude of separate lines adds power where lines share a bin: it is judged \
         by its sound alone.";
    "spectrum" needs ["magnitude", "render"] sound::spectrum:
        "The sound has the spectrum of the magnitude.",
        "A minute, segments of 0.2 s averaged by power, levels matched: within 1 dB RMS over the bins \
         that hold 99 % of the energy, of the magnitude or of what noise of that density reads through the \
         window, which differ at steep flanks. A line spectrum is thereby judged at its lines.";
    "narrow-band" needs ["level"] sound::narrow_band:
        "What lies outside the band is neither in the magnitude nor in the sound.",
        "Every fitted reference in the band 150 to 700 Hz, which leaves peaks of two of them out: the RMS \
         of a minute of sound is 1 within 1.5 dB, in the band and in all. A model may refuse parameters that \
         leave nothing in the band.";
    "reproducible" needs ["render"] repeat::reproducible:
        "The same parameters, rate and seed give the same samples.",
        "Two voices, one after the other, 9000 samples, bit by bit.";
    "blocks" needs ["reproducible"] repeat::blocks:
        "Block sizes do not change the samples.",
        "Blocks of 1, 7, 64 and 1000, and the whole, bit by bit; a block of no samples is allowed.";
    "seeds" needs ["reproducible"] repeat::seeds:
        "Different seeds give different samples.",
        "Two seeds. The same samples are a warning for a line spectrum, which may have nothing random \
         in it, else a failure.";
    "voices-apart" needs ["reproducible"] repeat::voices_apart:
        "Voices do not disturb each other.",
        "Two voices in turns of 64 samples, and two on threads of their own, against each one alone, \
         bit by bit.";
    "voices-together" needs ["blocks", "voices-apart"] together::agrees:
        "Voices that are rendered in one call sound as each does alone.",
        "Where the model has the extension `htex.voices/1`: seventeen voices of two sets of parameters, in \
         blocks of 1, 256, 3, 64 and 500 frames, one of them retuned on the way, against each alone, bit by \
         bit.";
    "handles" needs ["render"] repeat::handles:
        "A freed handle is refused.",
        "Rendering, retuning and freeing by a handle that was freed return a status; so it is after \
         the next voice was made.";
    "retune" needs ["render"] change::retune:
        "A retune does not click.",
        "Three sets of parameters in turn, every 500 samples at 20 kHz: no second difference is more \
         than twice the sharpest of the steady sounds.";
    "retune-follows" needs ["spectrum", "retune"] change::follows:
        "After a retune the sound has the spectrum of the new parameters.",
        "One voice is retuned to each fitted reference in turn. A second later, a minute of it is within 1 dB RMS of the \
         magnitude of the new parameters, judged as in `spectrum`: a model that passes there with a fresh voice passes here. \
         A reference counts if its magnitude is at least 3 dB RMS from that of the one before, by the same measure; if \
         there is none, there is nothing to follow.";
    "interpolate" needs ["magnitude", "render"] change::interpolate:
        "Mixing meets its ends, and everything between can be played.",
        "Weights 1 and 0 give the magnitudes of the sets themselves within 1e-6 of the largest. Eleven \
         mixtures of each pair of neighbouring references: a finite magnitude, and two seconds of \
         finite samples below 100 times unit RMS.";
    "bad-parameters" needs ["magnitude", "reproducible"] refusal::parameters:
        "Parameters that break the descriptor are refused.",
        "For each field a value below and above its range, NaN, infinity, and for lists impossible \
         lengths; too few numbers, too many, none. `magnitude`, `voice_rate`, `voice_new` and \
         `voice_retune` return a status; a voice whose retune was refused plays on as before.";
    "bad-band" needs ["magnitude", "render"] refusal::band:
        "Invalid bands are refused.",
        "Upside down, empty, from 0, negative, NaN, infinite, beyond 1 MHz, in `fit`, `magnitude`, \
         `voice_rate` and `voice_new`.";
    "bad-rate" needs ["render"] refusal::rate:
        "Invalid rates are refused.",
        "NaN, 0, -1, infinity and 1e12 Hz in `voice_rate` and `voice_new`.";
    "allocation" needs ["render", "retune"] allocation::none:
        "Rendering and retuning do not allocate.",
        "After 64 blocks with retunes through all fitted references, 1,000 more in sizes of 1, 64, 256 and 1,000. Native, on \
         64-bit Linux: calls of the C library's `malloc`, `calloc`, `realloc`, `aligned_alloc`, `posix_memalign` and `free`, by the \
         model or a library that it calls, in the thread that renders; none is allowed. Not seen: threads of the model's own, and an \
         allocator of its own that takes pages from the system by itself. WASM: the module's memory must not grow. What it takes \
         and gives back within its memory is not seen; its native twin shows that.";
    "motion" needs ["render", "retune", "allocation"] motion::keeps_its_promises:
        "A voice that is told the motion takes any in range, and refuses others.",
        "Of a model with the extension `htex.motion/1`; others pass. NaN, infinities and 1e13 in each number, a force of -0.1 and a \
         freed voice: a status, and the voice plays on as before. 4,000 samples of a constant motion in blocks of 1, 7, 64, 1,000 \
         and all: the same. A retune and a motion before the same sample: the same in either order. 40,000 samples of a way there \
         and back, told every 50: finite, and nothing allocated, seen as in `allocation`. The references are fitted at a condition \
         that is known, known by half, and unknown; a negative or infinite speed or force is refused. That the model exports the \
         extension's functions is part of `exports`.";
    "memory" needs ["render"] resources::memory:
        "Memory does not grow.",
        "Resident memory of the process over 10,000 blocks of 256 samples with retunes, and over 2,000 \
         voices made and freed: at most 2 MiB more after than before. On Linux.";
    "cost" needs ["render"] resources::cost:
        "What a sample costs.",
        "Nanoseconds a sample in blocks of 256, at the model's own rate: the median of 21 runs. A \
         warning from a tenth of one processor on.";
    "twin" needs ["render"] twin::agrees:
        "The native library and the WASM module of a model agree.",
        "The file named by `--against`, or one of the same name beside it: same id and version; same \
         parameters from every reference within 1e-6; samples within 1e-4 of unit RMS. A warning when \
         they are not the same bits.";
}
