//! Parts that most models need: the text of the last error, checks of arguments, second-order
//! sections and white noise. They are not part of the ABI: a model may use other code.

const std = @import("std");

/// The constants of the ABI.
pub const c = @cImport(@cInclude("htex_model.h"));

// ---- errors ----

pub const Error = error{
    InvalidArgument,
    InvalidParameters,
    InvalidOption,
    CannotFit,
    BadHandle,
    TooManyVoices,
};

threadlocal var last_error: []const u8 = "";

/// Keeps the text of an error, which the host asks for by `htex_model_last_error`.
pub fn fail(err: Error, text: []const u8) Error {
    last_error = text;
    return err;
}

/// Returns the status of an error in the ABI.
pub fn statusOf(err: Error) i64 {
    return switch (err) {
        error.InvalidArgument => c.HTEX_INVALID_ARGUMENT,
        error.InvalidParameters => c.HTEX_INVALID_PARAMETERS,
        error.InvalidOption => c.HTEX_INVALID_OPTION,
        error.CannotFit => c.HTEX_CANNOT_FIT,
        error.BadHandle => c.HTEX_BAD_HANDLE,
        error.TooManyVoices => c.HTEX_TOO_MANY_VOICES,
    };
}

pub fn copyText(text: []const u8, out: []u8) i64 {
    const len = @min(text.len, out.len);
    @memcpy(out[0..len], text[0..len]);
    return @intCast(text.len);
}

export fn htex_model_last_error(out: ?[*]u8, capacity: usize) i64 {
    return copyText(last_error, buffer(u8, out, capacity) orelse return c.HTEX_INVALID_ARGUMENT);
}

// ---- checks of arguments ----

fn isUsable(comptime T: type, address: usize, len: usize) bool {
    return address % @alignOf(T) == 0 and len <= std.math.maxInt(isize) / @sizeOf(T);
}

/// Returns the array of an argument, or null if it is not usable. The pointer has the type of an
/// unaligned one, because a caller may pass any address.
pub fn array(comptime T: type, pointer: ?[*]align(1) const T, len: usize) ?[]const T {
    if (len == 0) return &.{};
    const first = pointer orelse return null;
    if (!isUsable(T, @intFromPtr(first), len)) return null;
    return @as([*]const T, @alignCast(first))[0..len];
}

/// Returns the array to which a function writes, or null if it is not usable.
pub fn buffer(comptime T: type, pointer: ?[*]align(1) T, len: usize) ?[]T {
    if (len == 0) return &.{};
    const first = pointer orelse return null;
    if (!isUsable(T, @intFromPtr(first), len)) return null;
    return @as([*]T, @alignCast(first))[0..len];
}

pub fn within(x: f64, low: f64, high: f64) bool {
    return x >= low and x <= high; // NaN is not
}

pub fn clamp(x: f64, low: f64, high: f64) f64 {
    return if (x < low) low else if (x > high) high else x;
}

pub fn checkBand(low_hz: f64, high_hz: f64) Error!void {
    if (low_hz > 0.0 and low_hz < high_hz and high_hz <= c.HTEX_MAX_BAND_HZ) return;
    return fail(error.InvalidArgument, "band: 0 < low < high <= 1 MHz is allowed");
}

pub fn checkRate(rate_hz: f64) Error!void {
    if (within(rate_hz, c.HTEX_MIN_RATE_HZ, c.HTEX_MAX_RATE_HZ)) return;
    return fail(error.InvalidArgument, "rate: 1 Hz to 10 MHz is allowed");
}

pub fn checkSpectrum(hz: []const f64, magnitude: []const f64) Error!void {
    if (hz.len < c.HTEX_MIN_BINS) return fail(error.InvalidArgument, "a spectrum needs three bins or more");
    for (hz, magnitude, 0..) |f, m, i| {
        if (!within(f, -1e300, 1e300) or (i > 0 and f <= hz[i - 1]))
            return fail(error.InvalidArgument, "`frequency_hz` does not ascend");
        if (!within(m, 0.0, 1e300))
            return fail(error.InvalidArgument, "`magnitude` is negative or not finite");
    }
}

pub fn checkSignal(signal: []const f64, rate_hz: f64) Error!void {
    for (signal) |x| {
        if (!within(x, -1e300, 1e300)) return fail(error.InvalidArgument, "`signal` is not finite");
    }
    if (signal.len > 0) try checkRate(rate_hz);
}

// ---- filters and noise ----

/// Smaller state is set to zero, so that no processor meets slow subnormal numbers.
pub fn withoutSubnormals(x: f64) f64 {
    return if (within(x, -1e-30, 1e-30)) 0.0 else x;
}

/// tan of an angle from 0 to 0.45 pi, by the series of sine and cosine.
pub fn tangent(x: f64) f64 {
    var sine: f64 = 0.0;
    var cosine: f64 = 0.0;
    var term: f64 = 1.0;
    var n: f64 = 0.0;
    while (n < 26.0) : (n += 2.0) {
        cosine += term;
        term *= x / (n + 1.0);
        sine += term;
        term *= -x / (n + 2.0);
    }
    return sine / cosine;
}

pub const Biquad = struct {
    b0: f64,
    b1: f64,
    b2: f64,
    a1: f64,
    a2: f64,
    s1: f64 = 0.0,
    s2: f64 = 0.0,

    /// A section by the bilinear transform. `numerator` weighs 1, s and s^2 over the corner.
    pub fn init(corner_hz: f64, q: f64, rate_hz: f64, numerator: [3]f64) Biquad {
        const t = tangent(3.14159265358979323846 * corner_hz / rate_hz);
        const norm = 1.0 / (1.0 + t / q + t * t);
        const low = numerator[0] * t * t;
        const mid = numerator[1] * t / q;
        const high = numerator[2];
        return .{
            .b0 = (low + mid + high) * norm,
            .b1 = 2.0 * (low - high) * norm,
            .b2 = (low - mid + high) * norm,
            .a1 = 2.0 * (t * t - 1.0) * norm,
            .a2 = (1.0 - t / q + t * t) * norm,
        };
    }

    pub fn tick(f: *Biquad, x: f64) f64 {
        const y = f.b0 * x + f.s1;
        f.s1 = withoutSubnormals(f.b1 * x - f.a1 * y + f.s2);
        f.s2 = withoutSubnormals(f.b2 * x - f.a2 * y);
        return y;
    }
};

/// White noise of unit variance (splitmix64; uniform, which filters make Gaussian).
pub fn noise(state: *u64) f64 {
    state.* +%= 0x9e3779b97f4a7c15;
    var z = state.*;
    z = (z ^ (z >> 30)) *% 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) *% 0x94d049bb133111eb;
    z ^= z >> 31;
    const uniform = @as(f64, @floatFromInt(z >> 11)) * 0x1p-53;
    return (uniform - 0.5) * 3.4641016151377544; // sqrt(12)
}

// ---- memory that the host asks a WASM module for ----

const Room = extern struct { bytes: [c.HTEX_ALLOC_ALIGN]u8 align(c.HTEX_ALLOC_ALIGN) };

fn roomsFor(len: usize) usize {
    return len / @sizeOf(Room) + @intFromBool(len % @sizeOf(Room) != 0);
}

const wasm = struct {
    export fn htex_model_alloc(len: usize) ?*Room {
        if (len == 0) return null;
        const rooms = std.heap.wasm_allocator.alloc(Room, roomsFor(len)) catch return null;
        @memset(std.mem.sliceAsBytes(rooms), 0);
        return &rooms[0];
    }

    export fn htex_model_free(pointer: ?[*]Room, len: usize) void {
        const rooms = pointer orelse return;
        std.heap.wasm_allocator.free(rooms[0..roomsFor(len)]);
    }
};

comptime {
    if (@import("builtin").cpu.arch == .wasm32) _ = wasm;
}
