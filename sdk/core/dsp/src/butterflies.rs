//! Fourier transforms of two to seven numbers: the butterflies of the FFTs.

use core::ops::{Add, Sub};

use crate::lanes::Lanes;

/// One number, or several numbers side by side.
pub(crate) trait Number: Copy + Add<Output = Self> + Sub<Output = Self> {
    /// Multiplies by a constant, which is first rounded to the precision of the number.
    fn times(self, factor: f64) -> Self;
}

impl Number for Lanes {
    #[inline(always)]
    fn times(self, factor: f64) -> Self {
        self * factor as f32
    }
}

impl Number for f64 {
    #[inline(always)]
    fn times(self, factor: f64) -> Self {
        self * factor
    }
}

/// A transform of `R` numbers with positive exponents; real and imaginary parts are separate. It is
/// a trait and not a function argument, because compilers do not always inline a function argument
/// into the function that uses the wide registers.
pub(crate) trait Butterfly<const R: usize> {
    fn turn<T: Number>(re: [T; R], im: [T; R]) -> ([T; R], [T; R]);
}

pub(crate) struct Two;
pub(crate) struct Three;
pub(crate) struct Four;
pub(crate) struct Five;
pub(crate) struct Seven;

impl Butterfly<2> for Two {
    #[inline(always)]
    fn turn<T: Number>([a, b]: [T; 2], [ai, bi]: [T; 2]) -> ([T; 2], [T; 2]) {
        ([a + b, a - b], [ai + bi, ai - bi])
    }
}

impl Butterfly<3> for Three {
    #[inline(always)]
    fn turn<T: Number>(re: [T; 3], im: [T; 3]) -> ([T; 3], [T; 3]) {
        // The sine of a third of a turn.
        const SIN: f64 = 0.866_025_403_784_438_6;
        let (sum, sum_i) = (re[1] + re[2], im[1] + im[2]);
        let (turned, turned_i) = ((im[2] - im[1]).times(SIN), (re[1] - re[2]).times(SIN));
        let (mean, mean_i) = (re[0] - sum.times(0.5), im[0] - sum_i.times(0.5));
        (
            [re[0] + sum, mean + turned, mean - turned],
            [im[0] + sum_i, mean_i + turned_i, mean_i - turned_i],
        )
    }
}

impl Butterfly<4> for Four {
    #[inline(always)]
    fn turn<T: Number>(re: [T; 4], im: [T; 4]) -> ([T; 4], [T; 4]) {
        let (even, even_i) = Two::turn([re[0], re[2]], [im[0], im[2]]);
        let (odd, odd_i) = Two::turn([re[1], re[3]], [im[1], im[3]]);
        (
            [even[0] + odd[0], even[1] - odd_i[1], even[0] - odd[0], even[1] + odd_i[1]],
            [even_i[0] + odd_i[0], even_i[1] + odd[1], even_i[0] - odd_i[0], even_i[1] - odd[1]],
        )
    }
}

impl Butterfly<5> for Five {
    #[inline(always)]
    fn turn<T: Number>(re: [T; 5], im: [T; 5]) -> ([T; 5], [T; 5]) {
        let (sum, sum_i) = (sums(re), sums(im));
        let (mean, mean_i) = (fifths(re[0], sum), fifths(im[0], sum_i));
        let (t, t_i) = (turned(im), turned(re));
        (
            [
                re[0] + (sum[0] + sum[1]),
                mean[0] - t[0],
                mean[1] - t[1],
                mean[1] + t[1],
                mean[0] + t[0],
            ],
            [
                im[0] + (sum_i[0] + sum_i[1]),
                mean_i[0] + t_i[0],
                mean_i[1] + t_i[1],
                mean_i[1] - t_i[1],
                mean_i[0] - t_i[0],
            ],
        )
    }
}

#[inline(always)]
fn sums<T: Number>(x: [T; 5]) -> [T; 2] {
    [x[1] + x[4], x[2] + x[3]]
}

/// Sums weighted by the cosines of one and two fifths of a turn.
#[inline(always)]
fn fifths<T: Number>(first: T, [a, b]: [T; 2]) -> [T; 2] {
    const COS: [f64; 2] = [0.309_016_994_374_947_45, -0.809_016_994_374_947_5];
    [first + (a.times(COS[0]) + b.times(COS[1])), first + (a.times(COS[1]) + b.times(COS[0]))]
}

/// Sums weighted by the sines of one and two fifths of a turn.
#[inline(always)]
fn turned<T: Number>(x: [T; 5]) -> [T; 2] {
    const SIN: [f64; 2] = [0.951_056_516_295_153_5, 0.587_785_252_292_473_1];
    let [a, b] = [x[1] - x[4], x[2] - x[3]];
    [a.times(SIN[0]) + b.times(SIN[1]), a.times(SIN[1]) - b.times(SIN[0])]
}

impl Butterfly<7> for Seven {
    #[inline(always)]
    fn turn<T: Number>(re: [T; 7], im: [T; 7]) -> ([T; 7], [T; 7]) {
        let (mut out_re, mut out_im) = (re, im);
        for j in 1..7 {
            out_re[0] = out_re[0] + re[j];
            out_im[0] = out_im[0] + im[j];
        }
        for k in 1..4 {
            let (mean, mean_i) = (sevenths(re, k), sevenths(im, k));
            let (t, t_i) = (seventh_turns(im, k), seventh_turns(re, k));
            (out_re[k], out_re[7 - k]) = (mean - t, mean + t);
            (out_im[k], out_im[7 - k]) = (mean_i + t_i, mean_i - t_i);
        }
        (out_re, out_im)
    }
}

/// Sum weighted by the cosines of `k`, `2 k` and `3 k` sevenths of a turn.
#[inline(always)]
fn sevenths<T: Number>(x: [T; 7], k: usize) -> T {
    const COS: [f64; 4] =
        [1.0, 0.623_489_801_858_733_5, -0.222_520_933_956_314_4, -0.900_968_867_902_419_1];
    (1..4).fold(x[0], |sum, j| {
        let turn = j * k % 7;
        sum + (x[j] + x[7 - j]).times(COS[turn.min(7 - turn)])
    })
}

/// Sum weighted by the sines of `k`, `2 k` and `3 k` sevenths of a turn.
#[inline(always)]
fn seventh_turns<T: Number>(x: [T; 7], k: usize) -> T {
    const SIN: [f64; 7] = [
        0.0,
        0.781_831_482_468_029_8,
        0.974_927_912_181_823_6,
        0.433_883_739_117_558_1,
        -0.433_883_739_117_558_1,
        -0.974_927_912_181_823_6,
        -0.781_831_482_468_029_8,
    ];
    let by = |j: usize| (x[j] - x[7 - j]).times(SIN[j * k % 7]);
    by(1) + by(2) + by(3)
}
