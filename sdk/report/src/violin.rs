//! Shapes of distributions: violins, and dots beside one another.

/// Fewest values that have a violin.
const FEWEST: usize = 5;
const STEPS: usize = 32;

/// Returns the outline of a violin: values from the least to the largest, each with half its width, at most `half`; nothing for few or
/// equal values. A Gaussian kernel with Silverman's bandwidth (1986).
pub(crate) fn outline(values: &[f64], half: f64) -> Vec<(f64, f64)> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if values.len() < FEWEST || !(high - low).is_finite() || high <= low {
        return Vec::new();
    }
    let bandwidth = bandwidth(values);
    let density = |at: f64| {
        let kernel = |v: &f64| (-0.5 * ((at - v) / bandwidth).powi(2)).exp();
        values.iter().map(kernel).sum::<f64>()
    };
    let at = |step: usize| low + (high - low) * step as f64 / STEPS as f64;
    let all: Vec<(f64, f64)> = (0..=STEPS)
        .map(|step| (at(step), density(at(step))))
        .collect();
    let most = all
        .iter()
        .map(|(_, d)| *d)
        .fold(f64::MIN_POSITIVE, f64::max);
    all.into_iter().map(|(v, d)| (v, half * d / most)).collect()
}

fn bandwidth(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    1.06 * (squares / (count - 1.0)).sqrt() * count.powf(-0.2)
}

/// Returns how far to move each dot aside, pixels, so that dots of radius `radius` at the heights `ys` overlap little; at most `most`.
pub(crate) fn offsets(ys: &[f64], radius: f64, most: f64) -> Vec<f64> {
    let mut placed: Vec<(f64, f64)> = Vec::new();
    let steps = (most / radius).floor().max(0.0) as usize;
    for &y in ys {
        let free = |x: f64| {
            let far = |(a, b): &(f64, f64)| (a - x).hypot(b - y) >= 1.8 * radius;
            placed.iter().all(far)
        };
        let sides = (0..=2 * steps).map(|step| {
            let side = if step % 2 == 0 { 1.0 } else { -1.0 };
            side * step.div_ceil(2) as f64 * radius
        });
        let x = sides.into_iter().find(|x| free(*x)).unwrap_or(0.0);
        placed.push((x, y));
    }
    placed.into_iter().map(|(x, _)| x).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_dots_stand_side_by_side_and_a_violin_is_widest_at_its_mode() {
        assert_eq!(
            offsets(&[5.0, 5.0, 5.0, 40.0], 3.0, 20.0),
            [0.0, -6.0, 6.0, 0.0]
        );
        let outline = outline(&[1.0, 2.0, 2.0, 2.1, 3.0], 10.0);
        let widest = outline.iter().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
        assert!((widest.0 - 2.0).abs() < 0.1 && (widest.1 - 10.0).abs() < 1e-12);
        assert!(super::outline(&[2.0; 9], 10.0).is_empty());
    }
}
