//! The table of all checks.

use crate::model::case::Case;
use crate::model::checks::{
    abi, allocation, arrays, change, fit, fuzz, magnitude, motion, often, range, refusal, repeat,
    resources, sound, successor, together, twin, waiting,
};

crate::harness::checks! { Case;
    "marker" needs [] abi::loaded:
        "The marker names this ABI's major version.",
        "`htex_model_abi_version` is called before anything else.";
    "exports" needs ["marker"] abi::loaded:
        "The file loads, and exports every function of the ABI.",
        "The file is loaded as a host loads it; each function is looked up by name.";
    "descriptor" needs ["exports"] abi::descriptor:
        "The descriptor is valid.",
        "JSON of the schema; the same text at each call; reverse-DNS id, semantic version, name and summary present; 1 to 32 fields; names not \
         empty and all different; finite ranges with min <= max; stores with positive, finite steps; option defaults in \
         range, and integers for integer options; usual ranges within the fields' ranges, and values of sweeps that the \
         options take.";
    "extensions" needs ["exports"] abi::extensions:
        "Unknown extensions are absent.",
        "`htex_model_extension` must return 0 for made-up ids, an empty id and a very long one.";
    "fit" needs ["descriptor"] fit::reference:
        "Reference spectra are fitted.",
        "Five spectra: two smooth bumps, falling, rising, broad with ripple, few peaks. Each is \
         fitted, or the model returns CANNOT_FIT, and at least one is fitted; parameters fit the \
         descriptor; the level is above 0; a second fit returns the same numbers.";
    "fit-hard" needs ["fit"] fit::hard:
        "Hard spectra are fitted, or the model returns a status.",
        "Silence, one line, flat, magnitudes of 1e-200 and 1e100, and all energy in the lowest bin: a fit or CANNOT_FIT. \
         A grid of two bins must be refused with INVALID_ARGUMENT.";
    "magnitude" needs ["fit"] magnitude::sane:
        "Magnitudes are finite and not negative.",
        "On the 5 Hz grid, every 0.5 Hz, at the band's edges and outside of it, for every reference. Nothing is written beyond `bins`.";
    "fit-signal" needs ["magnitude"] fit::with_signals:
        "Spectra with the recording's signal are fitted.",
        "Two reference spectra, each with a stationary signal and with one that is ten times as loud in one half of an eighth of a \
         second as in the other: a fit that has a magnitude, or CANNOT_FIT; a second fit returns the same numbers.";
    "parameters" needs ["magnitude"] fit::round_trip:
        "Parameters are unchanged by conversion to fields and back, and remain valid when stored.",
        "Fitted parameters are read by field and flattened again: the magnitudes are equal. They are encoded by the \
         descriptor's stores and decoded: the model accepts them. A warning if storage changes the spectrum by more than \
         0.5 dB.";
    "magnitude-grid" needs ["magnitude"] magnitude::grid:
        "The magnitude at a frequency does not depend on the other frequencies of a call.",
        "The 5 Hz grid as a whole, frequency by frequency, in reversed chunks of ten, and within a \
         0.5 Hz grid; agreement within 1e-9 of the largest magnitude.";
    "render" needs ["fit"] sound::renders:
        "A voice renders.",
        "Blocks of 1 to 4,097 samples, of which nothing is written beyond `frames`; one second of every fitted reference: no error, \
         not silent.";
    "arrays" needs ["magnitude", "render"] arrays::kept_to:
        "No call reads or writes beyond its arrays, or keeps them.",
        "Every call that writes a text or parameters, with a capacity of 0, of 1, of half, of all of what there is, and of more: the \
         same length and the same beginning. Behind what may be written to are guard values, in a module within its own memory; on \
         64-bit Linux each array of a native library ends at a page that nobody may touch. The checks `magnitude` and `render` do the \
         same for their arrays. Input is not written to, and samples do not change when the arrays of parameters are overwritten \
         after the call. A native library refuses null and misaligned arrays.";
    "samples" needs ["render"] sound::clean:
        "No sample is infinite, not a number or subnormal.",
        "Twenty seconds of every fitted reference, with a retune each second.";
    "level" needs ["magnitude", "render"] sound::level:
        "Magnitude and sound have unit RMS.",
        "The magnitude's RMS on the 5 Hz grid within 2 %, and the RMS of a minute of sound within 2 %, \
         or within four standard deviations of the RMS of such noise over a minute, whichever is larger. The magnitude of \
         a line spectrum is not the root of its power in a bin that contains several lines, so for line spectra only the \
         sound is checked.";
    "spectrum" needs ["magnitude", "render"] sound::spectrum:
        "The sound has the spectrum of the magnitude.",
        "A minute, segments of 0.2 s averaged by power, levels matched: within 1 dB RMS over the bins \
         that contain 99 % of the energy, of the magnitude or of the spectrum that the window measures for noise of that \
         density; these differ at steep flanks. A line spectrum is thus compared at its lines.";
    "bounds" needs ["parameters", "level"] range::bounds:
        "Both ends of every field's range play.",
        "Fitted parameters with one field at an end of its range (a list as a whole), as it is and as a file stores it: a finite \
         magnitude, four seconds of finite samples below 1,000 at unit RMS within 3 dB, or within eight standard deviations of the \
         level of such noise, whichever is larger; finite samples in three other bands; and one voice that is retuned to each of \
         them. Parameters may describe no spectrum in the band, but not only at the end of a range, unless it is 0; and \
         a voice may refuse a retune.";
    "seeded" needs ["fit-signal", "level"] range::seeded:
        "Parameters within the ranges play.",
        "Sixteen sets that are drawn by the seed, each field within its range or as it is fitted, and the fits of `fit-signal`; as in \
         `bounds`.";
    "narrow-band" needs ["level"] sound::narrow_band:
        "Magnitude and sound contain nothing outside the band.",
        "Every fitted reference in the band 150 to 700 Hz, which excludes peaks of two of them: the RMS \
         of a minute of sound is 1 within 1.5 dB, both in the band and in total. A model may refuse parameters without \
         energy in the band.";
    "reproducible" needs ["render"] repeat::reproducible:
        "The same parameters, rate and seed give the same samples.",
        "Two voices, one after the other: 9000 bit-identical samples.";
    "blocks" needs ["reproducible"] repeat::blocks:
        "Block sizes do not change the samples.",
        "Blocks of 1, 7, 64 and 1000 samples and one single block: bit-identical samples, also with empty blocks between others.";
    "seeds" needs ["reproducible"] repeat::seeds:
        "Different seeds give different samples.",
        "Two seeds. Equal samples are a warning for a line spectrum, which may contain no random component, else a failure.";
    "voices-apart" needs ["reproducible"] repeat::voices_apart:
        "Voices do not affect each other.",
        "Two voices in alternating blocks of 64 samples, and two on separate threads, compared with each voice alone: \
         bit-identical samples.";
    "voices-together" needs ["blocks", "voices-apart"] together::agrees:
        "Voices that are rendered in one call have the samples of separately rendered ones.",
        "If the model has the extension `htex.voices/1`: a handle of no voice, a handle twice and seventeen voices are refused, and no \
         voice has then moved on. Seventeen voices of two parameter sets, in \
         blocks of 1, 256, 3, 64 and 500 frames, one of them retuned in between, compared with each voice alone: \
         bit-identical samples.";
    "handles" needs ["render"] repeat::handles:
        "A freed handle is refused.",
        "Rendering, retuning and freeing with a freed handle return a status, also after the next voice was made.";
    "retune" needs ["render"] change::retune:
        "A retune does not click.",
        "Three parameter sets in turn, every 500 samples at 20 kHz: no second difference exceeds twice the largest one of \
         the voices without retunes.";
    "retune-often" needs ["spectrum", "retune"] often::keeps_sounding:
        "Retunes at each block do not restart what sounds.",
        "Every fitted reference, ten seconds, retuned to its own parameters every 64 samples: the level within 0.5 dB of that without \
         retunes, or within four standard deviations of the level of such noise, whichever is larger; the spectrum at most 1 dB RMS \
         further from the magnitude.";
    "retune-follows" needs ["spectrum", "retune"] change::follows:
        "After a retune the sound has the spectrum of the new parameters.",
        "One voice is retuned to each fitted reference in turn. One second later, a minute of its sound is within 1 dB RMS of \
         the magnitude of the new parameters, measured as in `spectrum`. References are tested whose magnitude differs from \
         the preceding one by at least 3 dB RMS in the same measure; without one the check is skipped.";
    "interpolate" needs ["magnitude", "render"] change::interpolate:
        "Interpolation reproduces the parameter sets at its ends, and all results can be played.",
        "Weights 1 and 0 give the two sets, to the bit. Eleven \
         interpolations of each pair of neighbouring references: a finite magnitude, and two seconds of \
         finite samples below 100 times unit RMS.";
    "bad-parameters" needs ["magnitude", "reproducible"] refusal::parameters:
        "Parameters that do not fit the descriptor are refused.",
        "For each field a value below and above its range, NaN, infinity, and for lists invalid \
         lengths; too few numbers, too many, none. `magnitude`, `voice_rate`, `voice_new` and \
         `voice_retune` return INVALID_PARAMETERS and a reason; a voice whose retune was refused continues unchanged.";
    "bad-band" needs ["magnitude", "render"] refusal::band:
        "Invalid bands are refused.",
        "Edges in the wrong order, equal, 0, negative, NaN, infinite and above 1 MHz, in `fit`, `magnitude`, \
         `voice_rate` and `voice_new`: INVALID_ARGUMENT and a reason.";
    "bad-rate" needs ["render"] refusal::rate:
        "Invalid rates are refused.",
        "NaN, 0, -1, infinity and 1e12 Hz in `voice_rate` and `voice_new`: INVALID_ARGUMENT and a reason.";
    "bad-input" needs ["magnitude", "render"] refusal::inputs:
        "Invalid spectra, signals and options are refused.",
        "Magnitudes that are negative or not finite, frequencies that are not finite or do not ascend, fewer than three bins, signals \
         that are not finite, and their rates: INVALID_ARGUMENT. Options outside their ranges, NaN, not whole where they must be, too \
         many and too few: INVALID_OPTION. Each with a reason.";
    "bad-weights" needs ["magnitude", "render"] refusal::weights:
        "Invalid weights are refused.",
        "Weights outside 0 to 1, not finite, or of another sum than 1: INVALID_ARGUMENT; a set of them that does not fit the \
         descriptor: INVALID_PARAMETERS. Each with a reason.";
    "allocation" needs ["render", "retune"] allocation::none:
        "Rendering and retuning do not allocate.",
        "After 64 blocks with retunes through all fitted references, 1,000 more in sizes of 1, 64, 256 and 1,000. Native, on \
         64-bit Linux: calls of the C library's `malloc`, `calloc`, `realloc`, `aligned_alloc`, `posix_memalign` and `free`, by the \
         model or a library that it calls, in the thread that renders; none is allowed. Not detected: calls in threads that the \
         model starts, and an allocator of the model that maps pages itself. WASM: the module's memory must not grow. Allocations \
         within that memory are not detected; the check of the same model as a native library detects them.";
    "waiting" needs ["render", "retune"] waiting::none:
        "A voice neither waits nor does input or output.",
        "2,000 blocks with retunes, and with motions if the model follows them, in sizes of 1, 64 and 256: this thread waits at most \
         eight times, and makes no call that reads or writes. On Linux. Not detected: a lock that is free.";
    "motion" needs ["render", "retune", "allocation"] motion::keeps_its_promises:
        "A voice with `htex.motion/1` accepts all motions in range, and refuses others.",
        "Models without the extension pass. NaN, infinities and 1e13 in each number, a force of -0.1 and a freed voice return a \
         status, and the voice continues unchanged. 4,000 samples of a constant motion are equal in blocks of 1, 7, 64, 1,000 \
         and 4,000. A retune and a motion before the same sample give equal samples in either order. 40,000 samples of a movement \
         forward and back, with a motion every 50, are finite, and nothing is allocated, as detected in `allocation`. The \
         references are fitted at a known, a half known and an unknown condition; a negative or infinite speed or force is \
         refused. The check `exports` tests that the model exports the extension's functions.";
    "fuzz" needs ["bounds", "seeded", "blocks", "retune", "motion"] fuzz::plays:
        "What a host may do plays.",
        "Sixteen seeds from `--seed` on, or as many as `--fuzz SECONDS` has time for. Each draws parameters, one of five bands, a rate, \
         and 24 blocks, retunes, mixes and motions. The sequence is played twice, cut into different blocks: finite samples, the same \
         both times. A failure names its seed.";
    "memory" needs ["render"] resources::memory:
        "Memory does not grow.",
        "Resident memory of the process over 10,000 blocks of 256 samples with retunes, and over 2,000 \
         voices made and freed: at most 2 MiB more after than before. On Linux.";
    "cost" needs ["render"] resources::cost:
        "The time per sample.",
        "Nanoseconds per sample in blocks of 256, at the model's own rate: the median of 21 runs. A \
         warning from a tenth of one processor on.";
    "twin" needs ["render"] twin::agrees:
        "The native library and the WASM module of a model agree.",
        "The given other file of the model, or the file of the other kind with the same name in the same folder: equal id and \
         version; equal parameters for every reference within 1e-6; samples within 1e-4 of unit RMS. A warning if \
         they are not bit-identical.";
    "successor" needs ["render"] successor::keeps:
        "A newer version plays what an older version played.",
        "The given other file, if it is an older version of the model with the same major version: every field of the older one is \
         there with its unit, at least its range and at least its length; every new field has a default; for the older version's fit \
         of every reference, with these defaults, samples within 1e-4 of unit RMS. A warning if they are not bit-identical.";
}
