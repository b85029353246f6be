//! {{LABEL}}: initially one resonance. The model plays white noise through a two-pole band-pass
//! filter, so its spectrum is 1 / sqrt(1 + ((f/centre - centre/f) centre/bandwidth)^2).
//!
//! The native library and the WASM module are built from the same sources, and have the same
//! samples. See build.sh.

const parts = @import("parts.zig");
const resonance = @import("resonance.zig");

const c = parts.c;
const clamp = parts.clamp;
const fail = parts.fail;
const within = parts.within;
const Band = resonance.Band;
const Biquad = parts.Biquad;
const Error = parts.Error;
const Parameters = resonance.Parameters;
const BANDWIDTH = resonance.BANDWIDTH;
const CENTRE = resonance.CENTRE;
const MAX = resonance.MAX;
const MIN = resonance.MIN;

// ---- the descriptor: what the model states about itself ----

const DESCRIPTOR =
    \\{"id":"{{ID}}","name":"{{LABEL}}","version":"1.0.0",
    \\"summary":"{{LABEL}}: one resonance, where it lies and how wide it is.",
    \\"fields":[
    \\{"name":"centre_hz","unit":"Hz","kind":{"type":"scalar"},
    \\"min":5,"max":2000,"store":{"type":"f32"},
    \\"description":"Frequency of the resonance; lies in the band."},
    \\{"name":"bandwidth_hz","unit":"Hz","kind":{"type":"scalar"},
    \\"min":20,"max":2000,"store":{"type":"f32"},
    \\"description":"Width between the points 3 dB below it."}],
    \\"options":[]}
;

// ---- checks ----

fn checkSet(p: Parameters) Error!void {
    if (!within(p[CENTRE], MIN[CENTRE], MAX[CENTRE]))
        return fail(error.InvalidParameters, "centre_hz: 5 to 2000 Hz is allowed");
    if (!within(p[BANDWIDTH], MIN[BANDWIDTH], MAX[BANDWIDTH]))
        return fail(error.InvalidParameters, "bandwidth_hz: 20 to 2000 Hz is allowed");
}

const Numbers = ?[*]align(1) const f64;

/// Returns the parameters, if they are valid and have a spectrum in the band.
fn checkShape(pointer: Numbers, len: usize, low_hz: f64, high_hz: f64) Error!Parameters {
    const numbers = parts.array(f64, pointer, len) orelse
        return fail(error.InvalidArgument, "`parameters` is not a usable array");
    if (len != MIN.len)
        return fail(error.InvalidParameters, "two parameters are needed: centre_hz, bandwidth_hz");
    const p: Parameters = numbers[0..MIN.len].*;
    try checkSet(p);
    try parts.checkBand(low_hz, high_hz);
    if (!within(p[CENTRE], low_hz, high_hz))
        return fail(error.InvalidParameters, "centre_hz lies outside the band: move it in");
    return p;
}

// ---- voices ----

const VOICES = 256;

/// The resonance. Its noise is scaled so that the output has unit RMS.
const Tone = struct { filter: Biquad, gain: f64 };

/// Butterworth filters of order 8: q = 1 / (2 sin((2k + 1) pi / 16)).
const EDGE_Q = [_]f64{
    2.5629154477415055,
    0.89997622313641557,
    0.60134488693504529,
    0.50979557910415918,
};

const Voice = struct {
    band: Band,
    rate_hz: f64,
    random: u64,
    now: Tone,
    next: Tone,
    pending: Tone,
    fading: bool,
    waiting: bool,
    faded: f64,
    fade_frames: f64,
    low_cut: [EDGE_Q.len]Biquad,
    high_cut: [EDGE_Q.len]Biquad,

    /// A bin of magnitude m has the power m^2 / 3. White noise of unit variance has the power 2 * 5
    /// Hz / rate in each bin. So the noise is multiplied by sqrt(rate / 30) and divided by the
    /// shape's RMS.
    fn toneOf(v: *const Voice, p: Parameters) Tone {
        const w = 6.28318530717958647692 * p[CENTRE] / v.rate_hz;
        const t = parts.tangent(0.5 * w);
        // The transform narrows bandwidths by sin(w)/w; sin(w) = 2t / (1 + t^2).
        const q = p[CENTRE] / p[BANDWIDTH] * 2.0 * t / (1.0 + t * t) / w;
        return .{
            .filter = Biquad.init(p[CENTRE], q, v.rate_hz, .{ 0.0, 1.0, 0.0 }),
            .gain = @sqrt(v.rate_hz / 30.0) / resonance.shapeRms(p, v.band),
        };
    }

    /// Begins to fade to the waiting resonance. It takes over the filter's state, so that there is
    /// no click and no gap.
    fn beginFade(v: *Voice) void {
        v.next = v.pending;
        v.next.filter.s1 = v.now.filter.s1;
        v.next.filter.s2 = v.now.filter.s2;
        v.waiting = false;
        v.fading = true;
        v.faded = 0.0;
    }

    fn nextSample(v: *Voice) f32 {
        if (v.waiting and !v.fading) v.beginFade();
        const x = parts.noise(&v.random);
        var y = v.now.filter.tick(x * v.now.gain);
        if (v.fading) {
            v.faded += 1.0;
            y += (v.next.filter.tick(x * v.next.gain) - y) * v.faded / v.fade_frames;
            if (v.faded >= v.fade_frames) {
                v.now = v.next;
                v.fading = false;
            }
        }
        for (&v.low_cut, &v.high_cut) |*low, *high| y = high.tick(low.tick(y));
        // The smallest normal number of a float.
        return if (within(y, -0x1p-126, 0x1p-126)) 0.0 else @floatCast(y);
    }

    fn start(v: *Voice, p: Parameters, band: Band, rate_hz: f64, seed: u64) void {
        v.band = band;
        v.rate_hz = rate_hz;
        v.random = seed *% 0xd1342543de82ef95 +% 1; // apart from the step of noise()
        v.fade_frames = if (0.010 * rate_hz > 3.0) 0.010 * rate_hz else 3.0;
        v.fading = false;
        v.waiting = false;
        v.now = v.toneOf(p);
        for (&v.low_cut, &v.high_cut, EDGE_Q) |*low, *high, q| {
            low.* = Biquad.init(band.pass_low_hz, q, rate_hz, .{ 0.0, 0.0, 1.0 });
            high.* = Biquad.init(band.pass_high_hz, q, rate_hz, .{ 1.0, 0.0, 0.0 });
        }
        // Lets the filters settle before the first sample is played.
        const settle = 4.0 * rate_hz / band.pass_low_hz;
        var n = if (settle < 65536.0) settle else 65536.0;
        while (n > 0.0) : (n -= 1.0) _ = v.nextSample();
    }
};

/// `generation` is odd while this slot has a voice. A handle contains the generation and the
/// slot's number.
const Slot = struct { taken: bool, generation: u32, voice: Voice };

var slots = @import("std").mem.zeroes([VOICES]Slot);

const LIVE = 0x7fffffff;

fn find(handle: i64) Error!*Slot {
    const bits: u64 = @bitCast(handle);
    const number = (bits & 0xffffffff) -% 1;
    if (handle > 0 and number < VOICES) {
        const slot = &slots[@intCast(number)];
        const generation = @atomicLoad(u32, &slot.generation, .seq_cst);
        if (generation % 2 == 1 and generation & LIVE == bits >> 32) return slot;
    }
    return fail(error.BadHandle, "no such voice; it may have been freed");
}

// ---- the functions of the ABI ----

export fn htex_model_abi_version() u32 {
    return c.HTEX_ABI_MARKER;
}

export fn htex_model_descriptor(out: ?[*]u8, capacity: usize) i64 {
    const into = parts.buffer(u8, out, capacity) orelse
        return parts.statusOf(fail(error.InvalidArgument, "`out` is not a usable buffer"));
    return parts.copyText(DESCRIPTOR, into);
}

export fn htex_model_fit(
    band_low_hz: f64,
    band_high_hz: f64,
    frequency_hz: Numbers,
    magnitude: Numbers,
    bins: usize,
    signal: Numbers,
    signal_len: usize,
    signal_rate_hz: f64,
    options: Numbers,
    options_len: usize,
    parameters: ?[*]align(1) f64,
    capacity: usize,
    level_rms: ?[*]align(1) f64,
) i64 {
    _ = options;
    const unusable = error.InvalidArgument;
    return fit(
        band_low_hz,
        band_high_hz,
        parts.array(f64, frequency_hz, bins) orelse
            return parts.statusOf(fail(unusable, "`frequency_hz` is not a usable array")),
        parts.array(f64, magnitude, bins) orelse
            return parts.statusOf(fail(unusable, "`magnitude` is not a usable array")),
        parts.array(f64, signal, signal_len) orelse
            return parts.statusOf(fail(unusable, "`signal` is not a usable array")),
        signal_rate_hz,
        options_len,
        parts.buffer(f64, parameters, capacity) orelse
            return parts.statusOf(fail(unusable, "`parameters` is not a usable buffer")),
        parts.buffer(f64, level_rms, 1) orelse
            return parts.statusOf(fail(unusable, "`level_rms` is not a usable buffer")),
    ) catch |err| parts.statusOf(err);
}

fn fit(
    low_hz: f64,
    high_hz: f64,
    hz: []const f64,
    magnitude: []const f64,
    signal: []const f64,
    signal_rate_hz: f64,
    options_len: usize,
    parameters: []f64,
    level_rms: []f64,
) Error!i64 {
    try parts.checkBand(low_hz, high_hz);
    try parts.checkSpectrum(hz, magnitude);
    try parts.checkSignal(signal, signal_rate_hz);
    if (options_len != 0) return fail(error.InvalidOption, "this model has no fit options");
    if (high_hz < MIN[CENTRE] or low_hz > MAX[CENTRE])
        return fail(error.CannotFit, "the band lies outside 5 to 2000 Hz");
    var largest: f64 = 0.0;
    for (hz, magnitude) |f, m| {
        if (within(f, low_hz, high_hz) and m > largest) largest = m;
    }
    if (largest == 0.0) return fail(error.CannotFit, "the spectrum is silent: there is nothing to fit");
    const spectrum = resonance.Spectrum{ .hz = hz, .magnitude = magnitude, .largest = largest };
    const p = spectrum.search(Band.init(low_hz, high_hz));
    var power: f64 = 0.0;
    for (hz, magnitude) |f, m| {
        if (within(f, low_hz, high_hz)) power += m / largest * (m / largest) / 3.0;
    }
    level_rms[0] = largest * @sqrt(power);
    return write(p, parameters);
}

/// Writes as many parameters as there is space for. Returns how many there are.
fn write(p: Parameters, out: []f64) i64 {
    const len = @min(p.len, out.len);
    @memcpy(out[0..len], p[0..len]);
    return p.len;
}

export fn htex_model_magnitude(
    parameters: Numbers,
    parameters_len: usize,
    band_low_hz: f64,
    band_high_hz: f64,
    frequency_hz: Numbers,
    magnitude: ?[*]align(1) f64,
    bins: usize,
) i64 {
    const p = checkShape(parameters, parameters_len, band_low_hz, band_high_hz) catch |err|
        return parts.statusOf(err);
    const unusable = error.InvalidArgument;
    const hz = parts.array(f64, frequency_hz, bins) orelse
        return parts.statusOf(fail(unusable, "`frequency_hz` is not a usable array"));
    const out = parts.buffer(f64, magnitude, bins) orelse
        return parts.statusOf(fail(unusable, "`magnitude` is not a usable buffer"));
    const band = Band.init(band_low_hz, band_high_hz);
    const rms = resonance.shapeRms(p, band);
    if (!(rms > 0.0))
        return parts.statusOf(fail(unusable, "band: no multiple of 5 Hz lies in it"));
    for (hz, out) |f, *m| {
        if (!within(f, -1e300, 1e300))
            return parts.statusOf(fail(unusable, "`frequency_hz` is not finite"));
        m.* = resonance.shapeAt(p, band, f) / rms;
    }
    return c.HTEX_OK;
}

export fn htex_model_interpolate(
    sets: Numbers,
    sets_len: usize,
    weights: Numbers,
    weights_len: usize,
    parameters: ?[*]align(1) f64,
    capacity: usize,
) i64 {
    const unusable = error.InvalidArgument;
    return interpolate(
        parts.array(f64, sets, sets_len) orelse
            return parts.statusOf(fail(unusable, "`sets` is not a usable array")),
        parts.array(f64, weights, weights_len) orelse
            return parts.statusOf(fail(unusable, "`weights` is not a usable array")),
        parts.buffer(f64, parameters, capacity) orelse
            return parts.statusOf(fail(unusable, "`parameters` is not a usable buffer")),
    ) catch |err| parts.statusOf(err);
}

fn interpolate(sets: []const f64, weights: []const f64, out: []f64) Error!i64 {
    if (sets.len / MIN.len != weights.len or sets.len % MIN.len != 0)
        return fail(error.InvalidParameters, "two parameters are needed for each weight");
    var sum: f64 = 0.0;
    var mix = [_]f64{0.0} ** MIN.len;
    for (weights, 0..) |weight, n| {
        const set: Parameters = sets[n * MIN.len ..][0..MIN.len].*;
        if (!within(weight, 0.0, 1.0))
            return fail(error.InvalidArgument, "a weight lies outside 0 to 1");
        try checkSet(set);
        sum += weight;
        for (&mix, set) |*mixed, value| mixed.* += weight * value;
    }
    if (!within(sum, 1.0 - 1e-6, 1.0 + 1e-6))
        return fail(error.InvalidArgument, "weights do not sum to 1");
    for (&mix, MIN, MAX) |*mixed, min, max| mixed.* = clamp(mixed.*, min, max);
    return write(mix, out);
}

export fn htex_model_voice_rate(
    parameters: Numbers,
    parameters_len: usize,
    band_low_hz: f64,
    band_high_hz: f64,
    wanted_hz: f64,
) f64 {
    _ = checkShape(parameters, parameters_len, band_low_hz, band_high_hz) catch |err|
        return @floatFromInt(parts.statusOf(err));
    parts.checkRate(wanted_hz) catch |err| return @floatFromInt(parts.statusOf(err));
    // At least ten times the highest frequency of the band, where the filters are close to their
    // analogue models. The rate is a whole fraction or a whole multiple of the wanted one.
    const least = clamp(10.0 * band_high_hz, c.HTEX_MIN_RATE_HZ, c.HTEX_MAX_RATE_HZ);
    if (wanted_hz >= least) return wanted_hz / @floor(wanted_hz / least);
    return clamp(wanted_hz * (1.0 + @floor(least / wanted_hz)), least, c.HTEX_MAX_RATE_HZ);
}

export fn htex_model_voice_new(
    parameters: Numbers,
    parameters_len: usize,
    band_low_hz: f64,
    band_high_hz: f64,
    rate_hz: f64,
    seed: u64,
) i64 {
    return voiceNew(parameters, parameters_len, band_low_hz, band_high_hz, rate_hz, seed) catch |err|
        parts.statusOf(err);
}

fn voiceNew(pointer: Numbers, len: usize, low_hz: f64, high_hz: f64, rate_hz: f64, seed: u64) Error!i64 {
    const p = try checkShape(pointer, len, low_hz, high_hz);
    try parts.checkRate(rate_hz);
    const band = Band.init(low_hz, high_hz);
    if (rate_hz < 2.3 * high_hz)
        return fail(error.InvalidArgument, "rate: too low for the band; ask htex_model_voice_rate");
    if (!(resonance.shapeRms(p, band) > 0.0))
        return fail(error.InvalidArgument, "band: no multiple of 5 Hz lies in it");
    for (&slots, 1..) |*slot, number| {
        if (@atomicRmw(bool, &slot.taken, .Xchg, true, .seq_cst)) continue;
        slot.voice.start(p, band, rate_hz, seed);
        const generation = @atomicRmw(u32, &slot.generation, .Add, 1, .seq_cst) +% 1;
        return @as(i64, generation & LIVE) << 32 | @as(i64, @intCast(number));
    }
    return fail(error.TooManyVoices, "256 voices are in use; free some");
}

export fn htex_model_voice_render(voice: i64, out: ?[*]align(1) f32, frames: usize) i64 {
    const slot = find(voice) catch |err| return parts.statusOf(err);
    const samples = parts.buffer(f32, out, frames) orelse
        return parts.statusOf(fail(error.InvalidArgument, "`out` is not a usable buffer"));
    for (samples) |*sample| sample.* = slot.voice.nextSample();
    return c.HTEX_OK;
}

export fn htex_model_voice_retune(voice: i64, parameters: Numbers, parameters_len: usize) i64 {
    const slot = find(voice) catch |err| return parts.statusOf(err);
    const v = &slot.voice;
    const p = checkShape(parameters, parameters_len, v.band.low_hz, v.band.high_hz) catch |err|
        return parts.statusOf(err);
    v.pending = v.toneOf(p);
    v.waiting = true;
    return c.HTEX_OK;
}

export fn htex_model_voice_free(voice: i64) i64 {
    const slot = find(voice) catch |err| return parts.statusOf(err);
    const live: u32 = @intCast(@as(u64, @bitCast(voice)) >> 32);
    const generation = live | (@atomicLoad(u32, &slot.generation, .seq_cst) & ~@as(u32, LIVE));
    if (@cmpxchgStrong(u32, &slot.generation, generation, generation +% 1, .seq_cst, .seq_cst) != null)
        return parts.statusOf(fail(error.BadHandle, "no such voice; it may have been freed"));
    @atomicStore(bool, &slot.taken, false, .seq_cst);
    return c.HTEX_OK;
}

/// The model has no extensions.
export fn htex_model_extension(id: ?[*]const u8, id_len: usize) i64 {
    _ = id;
    _ = id_len;
    return 0;
}
