//! Ticks of an axis.

use crate::report::axis::{Scale, sound_range};
use crate::report::number;

/// A tick of an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Position, in the axis' unit.
    pub value: f64,
    /// Label; empty for a minor tick.
    pub label: String,
    /// Priority of the label if not all fit: 0 is the highest.
    pub(crate) rank: u8,
}

/// Returns the ticks of an axis, increasing and within `low` to `high`. Steps are 1, 2 or 5 times a
/// power of ten, and about `count` ticks have labels. A log axis has ticks at 1, 2 and 5 of each
/// decade, with minor ticks between these. If the range covers many decades, the axis has ticks
/// only at whole decades.
pub fn ticks(scale: Scale, low: f64, high: f64, count: usize) -> Vec<Tick> {
    let (low, high) = sound_range(Some((low, high)), scale);
    let count = count.clamp(2, 50) as f64;
    match scale {
        // If the range covers less than a factor of three, it contains too few of the ticks at 1, 2
        // and 5.
        Scale::Log if high / low >= 3.0 => log(low, high, count),
        _ => linear(low, high, count),
    }
}

fn linear(low: f64, high: f64, count: f64) -> Vec<Tick> {
    let (mantissa, exponent) = nice_step((high - low) / count);
    let step = mantissa * 10f64.powi(exponent);
    // Because of the tolerances, a tick at an end of the axis is kept in spite of rounding errors.
    let first = (low / step - 1e-6).ceil();
    let steps = (high / step + 1e-6).floor() - first;
    (0..=steps.clamp(0.0, 200.0) as u32)
        .map(|k| {
            let value = ((first + f64::from(k)) * step).clamp(low, high);
            // A tick that misses zero only by rounding is labelled as zero.
            let near = if (value / step).abs() < 0.5 { 0.0 } else { value };
            tick(value, label(near, exponent), 0)
        })
        .collect()
}

/// Returns the smallest number that is 1, 2 or 5 times a power of ten and at least `step`, as
/// mantissa and exponent.
fn nice_step(step: f64) -> (f64, i32) {
    let exponent = step.log10().floor() as i32;
    let rest = step / 10f64.powi(exponent);
    // Without the tolerance, rounding of the logarithm could turn a step of 2 into 5.
    match [1.0, 2.0, 5.0].into_iter().find(|m| rest <= m * (1.0 + 1e-9)) {
        Some(mantissa) => (mantissa, exponent),
        None => (1.0, exponent + 1),
    }
}

fn log(low: f64, high: f64, count: f64) -> Vec<Tick> {
    let (first, last) = (low.log10().floor() as i32, high.log10().ceil() as i32);
    let decades = f64::from(last - first);
    let every = (decades / count).ceil().max(1.0) as i32;
    let dense = decades * 3.0 <= 2.5 * count.max(5.0);
    (first..=last)
        .flat_map(|exponent| (1..=9u8).map(move |m| (m, exponent)))
        .filter(|(m, _)| *m == 1 || every == 1)
        .map(|(m, exponent)| {
            let value = f64::from(m) * 10f64.powi(exponent);
            let labelled = match m {
                1 => (exponent - first) % every == 0,
                2 | 5 => dense,
                _ => false,
            };
            let text = if labelled { label(value, exponent) } else { String::new() };
            tick(value, text, log_rank(m))
        })
        .filter(|tick| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(&tick.value))
        .collect()
}

fn log_rank(mantissa: u8) -> u8 {
    match mantissa {
        1 => 0,
        5 => 1,
        _ => 2,
    }
}

fn tick(value: f64, label: String, rank: u8) -> Tick {
    Tick { value, label, rank }
}

/// Formats `value` with the decimals that a step of 10^`exponent` needs.
fn label(value: f64, exponent: i32) -> String {
    let size = value.abs();
    if size >= 1e6 || exponent < -4 {
        return number::brief(value).replace(".00e", "e");
    }
    number::fixed(value, exponent.min(0).unsigned_abs() as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(ticks: &[Tick]) -> Vec<&str> {
        let texts = ticks.iter().map(|t| t.label.as_str());
        texts.filter(|l| !l.is_empty()).collect()
    }

    #[test]
    fn the_tactile_band_is_marked_at_1_2_5() {
        let found = ticks(Scale::Log, 20.0, 1000.0, 5);
        assert_eq!(labels(&found), ["20", "50", "100", "200", "500", "1000"]);
        assert_eq!(found.len(), 18);
    }

    #[test]
    fn linear_labels_have_the_step_s_decimals() {
        let found = ticks(Scale::Linear, -0.2, 0.4, 4);
        assert_eq!(labels(&found), ["\u{2212}0.2", "0.0", "0.2", "0.4"]);
    }

    /// Checks that no gap, between ticks or at the ends, is wider than the 1-2-5 grid allows.
    fn check(scale: Scale, low: f64, high: f64, count: usize) -> Result<(), TestCaseError> {
        let values: Vec<f64> = ticks(scale, low, high, count).iter().map(|t| t.value).collect();
        let slack = (high - low) * 1e-6;
        prop_assert!(values.windows(2).all(|w| w[0] < w[1]), "{values:?}");
        prop_assert!(values.iter().all(|v| *v >= low - slack && *v <= high + slack));
        prop_assert!(!labels(&ticks(scale, low, high, count)).is_empty());
        let place = |v: f64| if scale == Scale::Log { v.log10() } else { v };
        let ends = [low, high];
        let mut all: Vec<f64> = ends.iter().chain(&values).map(|v| place(*v)).collect();
        all.sort_by(f64::total_cmp);
        let widest = all.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        let span = place(high) - place(low);
        let linear_limit = 2.51 * span / count as f64;
        let limit = if scale == Scale::Log { linear_limit.max(1.01) } else { linear_limit };
        prop_assert!(widest <= limit, "gap {widest} over {limit}: {values:?}");
        Ok(())
    }

    proptest! {
        #[test]
        fn ticks_cover_the_range_in_order(
            low in -1e6f64..1e6, width in -9f64..9.0, count in 3usize..12, decade in -8f64..8.0,
        ) {
            check(Scale::Linear, low * 10f64.powf(width - 6.0), low * 10f64.powf(width - 6.0) + 10f64.powf(width), count)?;
            let low = 10f64.powf(decade);
            check(Scale::Log, low, low * 10f64.powf(width.abs() + 0.1), count)?;
        }

        #[test]
        fn any_two_numbers_make_a_range(a in any::<f64>(), b in any::<f64>(), count in any::<usize>()) {
            for scale in [Scale::Linear, Scale::Log] {
                let found = ticks(scale, a, b, count);
                prop_assert!(found.len() <= 500 && found.iter().all(|t| t.value.is_finite()));
            }
        }
    }
}
