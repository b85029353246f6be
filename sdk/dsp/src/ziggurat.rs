//! Normal numbers by Doornik's ziggurat (2005): 256 layers of equal area that cover the density.
//!
//! A point of a layer is drawn; it nearly always lies in the part of the layer that is under the
//! density for sure. The table is made by the compiler, so every machine has the same bits.

use crate::noise::Uniform;

const LAYERS: usize = 256;
/// Where the tail begins, and the area of a layer.
const TAIL: f64 = 3.654_152_885_361_009;
const AREA: f64 = 0.004_928_673_233_99;

/// Right edges of the layers, from the bottom one, which has the tail's area too, to 0.
const EDGE: [f64; LAYERS + 1] = edges();

/// A layer: what a place of 24 bits with sign is multiplied by, and below which size it surely lies
/// under the density.
struct Layer {
    scale: f64,
    sure: u32,
}

static LAYER: [Layer; LAYERS] = layers();

/// Fills a block with normal numbers: one of 32 bits each from `uniform`, and what the few that lie at
/// an edge need from `rare`, so that the one that nearly all come from stays in registers.
pub(crate) fn fill(uniform: &mut Uniform, rare: &mut Uniform, out: &mut [[f64; 2]]) {
    uniform.each_bits(out, |pair, bits| {
        *pair = [bits as u32, (bits >> 32) as u32].map(|bits| {
            let (layer, place) = point(bits);
            let x = f64::from(place) * LAYER[layer].scale;
            if place.unsigned_abs() < LAYER[layer].sure {
                x
            } else {
                at_edge(rare, layer, x)
            }
        });
    });
}

/// Layer by the lowest bits, place by the others: they do not overlap.
#[inline(always)]
fn point(bits: u32) -> (usize, i32) {
    ((bits % LAYERS as u32) as usize, (bits as i32) >> 8)
}

/// The points that may lie outside the density, one in a hundred.
#[cold]
#[inline(never)]
fn at_edge(uniform: &mut Uniform, mut layer: usize, mut x: f64) -> f64 {
    loop {
        if layer == 0 {
            return libm::copysign(tail(uniform), x);
        }
        let density = |edge: f64| libm::exp(0.5 * (x * x - edge * edge));
        let (low, high) = (density(EDGE[layer]), density(EDGE[layer + 1]));
        if low + uniform.next_unit() * (high - low) < 1.0 {
            return x;
        }
        let place;
        (layer, place) = point(uniform.next_bits() as u32);
        x = f64::from(place) * LAYER[layer].scale;
        if place.unsigned_abs() < LAYER[layer].sure {
            return x;
        }
    }
}

/// A number beyond [`TAIL`] (Marsaglia).
fn tail(uniform: &mut Uniform) -> f64 {
    loop {
        // 1 - u is never 0.
        let x = -libm::log(1.0 - uniform.next_unit()) / TAIL;
        let y = -libm::log(1.0 - uniform.next_unit());
        if 2.0 * y > x * x {
            return TAIL + x;
        }
    }
}

const fn layers() -> [Layer; LAYERS] {
    let mut layers = [const {
        Layer {
            scale: 0.0,
            sure: 0,
        }
    }; LAYERS];
    let mut i = 0;
    while i < LAYERS {
        let whole = (1u32 << 23) as f64;
        layers[i].scale = EDGE[i] / whole;
        layers[i].sure = (EDGE[i + 1] / EDGE[i] * whole) as u32;
        i += 1;
    }
    layers
}

const fn edges() -> [f64; LAYERS + 1] {
    let mut edge = [0.0; LAYERS + 1];
    let mut density = exp(-0.5 * TAIL * TAIL);
    edge[0] = AREA / density;
    edge[1] = TAIL;
    let mut i = 2;
    while i < LAYERS {
        density += AREA / edge[i - 1];
        edge[i] = sqrt(-2.0 * ln(density));
        i += 1;
    }
    edge
}

/// For exponents in -7 to 0.
const fn exp(x: f64) -> f64 {
    let (small, mut sum, mut term, mut n) = (x / 64.0, 1.0, 1.0, 1.0);
    while n < 16.0 {
        term *= small / n;
        sum += term;
        n += 1.0;
    }
    let mut squared = 0;
    while squared < 6 {
        sum *= sum;
        squared += 1;
    }
    sum
}

/// For numbers in 0.001 to 1, by Newton's method.
const fn ln(x: f64) -> f64 {
    let (mut y, mut i) = (0.0, 0);
    while i < 24 {
        y += x * exp(-y) - 1.0;
        i += 1;
    }
    y
}

const fn sqrt(x: f64) -> f64 {
    let (mut y, mut i) = (1.0, 0);
    while i < 32 {
        y = 0.5 * (y + x / y);
        i += 1;
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_have_the_same_area() {
        let density = |x: f64| libm::exp(-0.5 * x * x);
        for i in 1..LAYERS {
            let area = EDGE[i] * (density(EDGE[i + 1]) - density(EDGE[i]));
            assert!((area - AREA).abs() < 1e-10, "layer {i}: {area}");
        }
    }
}
