//! The spectrum of one resonance, and its fit to a recorded spectrum.

const parts = @import("parts.zig");
const clamp = parts.clamp;
const within = parts.within;
const GRID_HZ = parts.c.HTEX_GRID_HZ;

/// The indices of the parameters.
pub const CENTRE = 0;
pub const BANDWIDTH = 1;

/// The ranges of the parameters, as the descriptor states them.
pub const MIN = [_]f64{ 5.0, 20.0 };
pub const MAX = [_]f64{ 2000.0, 2000.0 };

pub const Parameters = [2]f64;

// ---- the spectrum ----

pub const Band = struct {
    low_hz: f64,
    high_hz: f64,
    pass_low_hz: f64,
    pass_high_hz: f64,

    /// A filter cuts the noise off half a bin below the band, because a bin stands for 5 Hz around
    /// its frequency. At the upper edge it cuts off from 13 % inside the band. So less than 2 % of
    /// the power of the widest resonance lies outside the band.
    pub fn init(low_hz: f64, high_hz: f64) Band {
        const cut = low_hz - 0.5 * GRID_HZ;
        return .{
            .low_hz = low_hz,
            .high_hz = high_hz,
            .pass_low_hz = if (cut < 0.5 * low_hz) 0.5 * low_hz else cut,
            .pass_high_hz = 0.87 * high_hz,
        };
    }
};

fn power16(x: f64) f64 {
    var y = x;
    for (0..4) |_| y *= y;
    return y;
}

/// Returns the magnitude of the filters at a frequency, in any scale; 0 outside the band.
pub fn shapeAt(p: Parameters, band: Band, f: f64) f64 {
    if (!within(f, band.low_hz, band.high_hz)) return 0.0;
    const detuned = (f / p[CENTRE] - p[CENTRE] / f) * p[CENTRE] / p[BANDWIDTH];
    const edges = (1.0 + power16(band.pass_low_hz / f)) * (1.0 + power16(f / band.pass_high_hz));
    return 1.0 / @sqrt((1.0 + detuned * detuned) * edges);
}

/// Returns the RMS of the shape on the grid; 0 if no multiple of 5 Hz lies in the band.
pub fn shapeRms(p: Parameters, band: Band) f64 {
    var power: f64 = 0.0;
    const first: usize = @intFromFloat(band.low_hz / GRID_HZ);
    const last: usize = @intFromFloat(band.high_hz / GRID_HZ);
    for (first..last + 1) |bin| {
        const m = shapeAt(p, band, @as(f64, @floatFromInt(bin)) * GRID_HZ);
        power += m * m;
    }
    return @sqrt(power / 3.0);
}

// ---- fit ----

pub const Spectrum = struct {
    hz: []const f64,
    magnitude: []const f64,
    largest: f64,

    /// Returns the squared distance of the best scaled shape to the spectrum, divided by the square
    /// of the spectrum.
    fn misfit(s: Spectrum, p: Parameters, band: Band) f64 {
        var hm: f64 = 0.0;
        var hh: f64 = 0.0;
        var mm: f64 = 0.0;
        for (s.hz, s.magnitude) |hz, magnitude| {
            const h = shapeAt(p, band, hz);
            const m = magnitude / s.largest;
            hm += h * m;
            hh += h * h;
            mm += m * m;
        }
        return if (hh > 0.0 and mm > 0.0) 1.0 - hm * hm / (hh * mm) else 1.0;
    }

    /// Tries one step from `p`. Keeps the step if the fit is better.
    fn tryStep(s: Spectrum, p: *Parameters, best: *f64, field: usize, factor: f64, band: Band) bool {
        var at = p.*;
        at[field] = clamp(at[field] * factor, MIN[field], MAX[field]);
        // The centre stays inside the band, because an asset rounds its numbers, and because a
        // resonance at the upper edge would have half of its power outside.
        at[CENTRE] = clamp(at[CENTRE], band.low_hz * 1.0001, band.high_hz * 0.9);
        const value = s.misfit(at, band);
        if (!(value < best.*)) return false;
        best.* = value;
        p.* = at;
        return true;
    }

    /// Searches from the best point of a coarse grid, by steps that are halved until they are
    /// 0.01 %.
    pub fn search(s: Spectrum, band: Band) Parameters {
        var best: f64 = 2.0;
        const middle = @sqrt(band.low_hz * band.high_hz);
        var p = Parameters{ clamp(middle, MIN[CENTRE], MAX[CENTRE]), 100.0 };
        var hz = band.low_hz;
        while (hz < band.high_hz) : (hz *= 1.2) {
            var width: f64 = 20.0;
            while (width < 2000.0) : (width *= 2.0) {
                var at = Parameters{ clamp(hz, MIN[CENTRE], MAX[CENTRE]), width };
                var value: f64 = 2.0;
                if (s.tryStep(&at, &value, CENTRE, 1.0, band) and value < best) {
                    best = value;
                    p = at;
                }
            }
        }
        var step: f64 = 1.2;
        while (step > 1.0001) {
            var is_better = false;
            for ([_]usize{ CENTRE, BANDWIDTH }) |field| {
                if (s.tryStep(&p, &best, field, step, band) or s.tryStep(&p, &best, field, 1.0 / step, band))
                    is_better = true;
            }
            if (!is_better) step = @sqrt(step);
        }
        return p;
    }
};
