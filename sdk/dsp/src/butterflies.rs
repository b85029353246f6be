//! Transforms of two to five numbers.

use crate::lanes::Lanes;

/// A transform of `R` numbers, real and imaginary parts apart. A trait, as functions that are passed are not always
/// compiled into the one that has the wide registers.
pub(crate) trait Butterfly<const R: usize> {
    fn turn(re: [Lanes; R], im: [Lanes; R]) -> ([Lanes; R], [Lanes; R]);
}

pub(crate) struct Two;
pub(crate) struct Three;
pub(crate) struct Four;
pub(crate) struct Five;

impl Butterfly<2> for Two {
    #[inline(always)]
    fn turn([a, b]: [Lanes; 2], [ai, bi]: [Lanes; 2]) -> ([Lanes; 2], [Lanes; 2]) {
        ([a + b, a - b], [ai + bi, ai - bi])
    }
}

impl Butterfly<3> for Three {
    #[inline(always)]
    fn turn(re: [Lanes; 3], im: [Lanes; 3]) -> ([Lanes; 3], [Lanes; 3]) {
        const SIN: f32 = 0.866_025_4;
        let (sum, sum_i) = (re[1] + re[2], im[1] + im[2]);
        let (turned, turned_i) = ((im[2] - im[1]) * SIN, (re[1] - re[2]) * SIN);
        let (mean, mean_i) = (re[0] - sum * 0.5, im[0] - sum_i * 0.5);
        (
            [re[0] + sum, mean + turned, mean - turned],
            [im[0] + sum_i, mean_i + turned_i, mean_i - turned_i],
        )
    }
}

impl Butterfly<4> for Four {
    #[inline(always)]
    fn turn(re: [Lanes; 4], im: [Lanes; 4]) -> ([Lanes; 4], [Lanes; 4]) {
        let (even, even_i) = Two::turn([re[0], re[2]], [im[0], im[2]]);
        let (odd, odd_i) = Two::turn([re[1], re[3]], [im[1], im[3]]);
        (
            [
                even[0] + odd[0],
                even[1] - odd_i[1],
                even[0] - odd[0],
                even[1] + odd_i[1],
            ],
            [
                even_i[0] + odd_i[0],
                even_i[1] + odd[1],
                even_i[0] - odd_i[0],
                even_i[1] - odd[1],
            ],
        )
    }
}

impl Butterfly<5> for Five {
    #[inline(always)]
    fn turn(re: [Lanes; 5], im: [Lanes; 5]) -> ([Lanes; 5], [Lanes; 5]) {
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
fn sums(x: [Lanes; 5]) -> [Lanes; 2] {
    [x[1] + x[4], x[2] + x[3]]
}

/// By the cosines of one and of two fifths of a turn.
#[inline(always)]
fn fifths(first: Lanes, [a, b]: [Lanes; 2]) -> [Lanes; 2] {
    const COS: [f32; 2] = [0.309_017, -0.809_017];
    [
        first + (a * COS[0] + b * COS[1]),
        first + (a * COS[1] + b * COS[0]),
    ]
}

/// By the sines of one and of two fifths of a turn.
#[inline(always)]
fn turned(x: [Lanes; 5]) -> [Lanes; 2] {
    const SIN: [f32; 2] = [0.951_056_54, 0.587_785_25];
    let [a, b] = [x[1] - x[4], x[2] - x[3]];
    [a * SIN[0] + b * SIN[1], a * SIN[1] - b * SIN[0]]
}
