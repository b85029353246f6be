//! Nelder–Mead simplex minimisation with the standard coefficients, as in SciPy's `fmin` and
//! MATLAB's `fminsearch` (Lagarias et al. 1998).
//!
//! The project has its own implementation: a model in a sandbox has no clock, but the maintained
//! Rust library reads one.

/// Stopping criteria, and the size of the initial simplex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Tolerance of the position. The search stops when every vertex is within this distance of the
    /// best vertex along every axis, provided that `f_tolerance` is also met.
    pub x_tolerance: f64,
    /// Tolerance of the function value. The search stops when the value at every vertex is at most
    /// this much above the best value, provided that `x_tolerance` is also met.
    pub f_tolerance: f64,
    /// Maximum number of function calls.
    pub max_evaluations: usize,
    /// Initial step along each axis, as a fraction of the start point's coordinate.
    pub initial_step: f64,
    /// Initial step along an axis whose start coordinate is zero.
    pub initial_step_at_zero: f64,
}

impl Default for Options {
    /// SciPy's initial simplex, and tolerances near the f64 resolution at a smooth minimum.
    fn default() -> Self {
        Self {
            x_tolerance: 1e-10,
            f_tolerance: 1e-10,
            max_evaluations: 4000,
            initial_step: 0.05,
            initial_step_at_zero: 0.00025,
        }
    }
}

/// The best point found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Minimum<const N: usize> {
    /// Position.
    pub x: [f64; N],
    /// Function value at `x`; +∞ if the function was NaN at every evaluated point.
    pub value: f64,
    /// Number of function calls.
    pub evaluations: usize,
    /// Whether both tolerances were met within the allowed number of function calls.
    pub converged: bool,
}

/// Minimises `f`, starting at `start`. To exclude a region, `f` may return +∞ or NaN, which counts
/// as +∞.
///
/// The search is deterministic: with the same function, start and options it evaluates the same
/// points. Reaching `max_evaluations` is not an error; the function then returns the best point so
/// far.
///
/// ```
/// use htex_dsp::nelder_mead::{Options, minimize};
/// let bowl = |x: &[f64; 2]| (x[0] - 1.0).powi(2) + 10.0 * (x[1] + 2.0).powi(2);
/// let found = minimize(bowl, [0.0, 0.0], &Options::default());
/// assert!((found.x[0] - 1.0).abs() < 1e-6 && (found.x[1] + 2.0).abs() < 1e-6);
/// ```
pub fn minimize<const N: usize>(
    f: impl FnMut(&[f64; N]) -> f64,
    start: [f64; N],
    options: &Options,
) -> Minimum<N> {
    let mut search = Search::start(f, start, options);
    let mut converged = search.has_converged(options);
    while !converged && search.evaluations < options.max_evaluations {
        search.step(options.max_evaluations);
        search.sort();
        converged = search.has_converged(options);
    }
    Minimum {
        x: search.best.x,
        value: search.best.value,
        evaluations: search.evaluations,
        converged,
    }
}

#[derive(Clone, Copy)]
struct Vertex<const N: usize> {
    x: [f64; N],
    value: f64,
}

/// The simplex: its best vertex and the N others, sorted by value after each step.
struct Search<F, const N: usize> {
    f: F,
    best: Vertex<N>,
    others: [Vertex<N>; N],
    evaluations: usize,
}

impl<F: FnMut(&[f64; N]) -> f64, const N: usize> Search<F, N> {
    fn start(f: F, start: [f64; N], options: &Options) -> Self {
        let unknown = Vertex { x: start, value: f64::INFINITY };
        let mut search = Self { f, best: unknown, others: [unknown; N], evaluations: 0 };
        search.best = search.evaluate(start);
        for axis in 0..N {
            // A vertex that was not evaluated keeps the value +∞.
            if search.evaluations >= options.max_evaluations {
                break;
            }
            let mut x = start;
            x[axis] = match start[axis] {
                0.0 => options.initial_step_at_zero,
                coordinate => coordinate * (1.0 + options.initial_step),
            };
            search.others[axis] = search.evaluate(x);
        }
        search.sort();
        search
    }

    // The function may be large, and is called in six places. Without inlining, modules are 4 % smaller.
    #[inline(never)]
    fn evaluate(&mut self, x: [f64; N]) -> Vertex<N> {
        self.evaluations += 1;
        let value = (self.f)(&x);
        let value = if value.is_nan() { f64::INFINITY } else { value };
        Vertex { x, value }
    }

    fn sort(&mut self) {
        // An insertion sort does not allocate, and is stable: equal values keep their order.
        for i in 1..N {
            for j in (1..=i).rev() {
                if self.others[j].value < self.others[j - 1].value {
                    self.others.swap(j, j - 1);
                }
            }
        }
        if N > 0 && self.others[0].value < self.best.value {
            let demoted = core::mem::replace(&mut self.best, self.others[0]);
            self.others[0] = demoted;
            for j in 1..N {
                if self.others[j].value < self.others[j - 1].value {
                    self.others.swap(j, j - 1);
                }
            }
        }
    }

    fn has_converged(&self, options: &Options) -> bool {
        self.others.iter().all(|vertex| {
            let near = (0..N).all(|i| (vertex.x[i] - self.best.x[i]).abs() <= options.x_tolerance);
            // The difference of two infinite values is NaN, which does not count as converged.
            near && vertex.value - self.best.value <= options.f_tolerance
        })
    }

    /// The centroid of all vertices except the worst, moved by `factor` away from the worst.
    fn away_from_worst(&self, factor: f64) -> [f64; N] {
        let mut x = self.best.x;
        for vertex in &self.others[..N - 1] {
            for i in 0..N {
                x[i] += vertex.x[i];
            }
        }
        let worst = &self.others[N - 1].x;
        for i in 0..N {
            let centroid = x[i] / N as f64;
            x[i] = centroid + factor * (centroid - worst[i]);
        }
        x
    }

    /// One iteration: reflect, then expand, contract or shrink.
    fn step(&mut self, max_evaluations: usize) {
        let Some(worst) = self.others.last().copied() else {
            self.evaluations = max_evaluations;
            return;
        };
        let second_worst = if N > 1 { self.others[N - 2].value } else { self.best.value };
        let reflected = self.evaluate(self.away_from_worst(1.0));
        if self.evaluations >= max_evaluations {
            self.keep_if_better(reflected);
        } else if reflected.value < self.best.value {
            let expanded = self.evaluate(self.away_from_worst(2.0));
            self.others[N - 1] =
                if expanded.value < reflected.value { expanded } else { reflected };
        } else if reflected.value < second_worst {
            self.others[N - 1] = reflected;
        } else {
            self.contract(reflected, worst, max_evaluations);
        }
    }

    fn contract(&mut self, reflected: Vertex<N>, worst: Vertex<N>, max_evaluations: usize) {
        let outside = reflected.value < worst.value;
        let contracted = self.evaluate(self.away_from_worst(if outside { 0.5 } else { -0.5 }));
        let accepted = if outside {
            // An outside contraction uses `<=`, and an inside contraction uses `<`, as in Lagarias
            // et al. and in SciPy.
            contracted.value <= reflected.value
        } else {
            contracted.value < worst.value
        };
        if accepted {
            self.others[N - 1] = contracted;
        } else {
            self.shrink(max_evaluations);
        }
    }

    fn shrink(&mut self, max_evaluations: usize) {
        for j in 0..N {
            if self.evaluations >= max_evaluations {
                return;
            }
            let mut x = self.others[j].x;
            for i in 0..N {
                x[i] = self.best.x[i] + 0.5 * (x[i] - self.best.x[i]);
            }
            self.others[j] = self.evaluate(x);
        }
    }

    fn keep_if_better(&mut self, vertex: Vertex<N>) {
        if let Some(worst) = self.others.last_mut()
            && vertex.value < worst.value
        {
            *worst = vertex;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64) -> f64 {
        x * x
    }

    fn valley(x: &[f64; 2]) -> f64 {
        square(1.0 - x[0]) + 100.0 * square(x[1] - x[0] * x[0])
    }

    fn crease(x: &[f64; 3]) -> f64 {
        (x[0] - 0.7).abs() + 4.0 * (x[1] + 0.4).abs() + (x[2] + x[0]).abs()
    }

    #[test]
    fn rosenbrock_is_found_from_the_classic_start() {
        let found = minimize(valley, [-1.2, 1.0], &Options::default());
        assert!(found.converged && found.evaluations < 400);
        assert!((found.x[0] - 1.0).abs() < 1e-6 && (found.x[1] - 1.0).abs() < 1e-6);
    }

    /// Compares with SciPy 1.17's `fmin` with these tolerances: the search needs no more
    /// evaluations, and finds a minimum that is as low.
    fn is_as_scipy<const N: usize>(
        f: impl FnMut(&[f64; N]) -> f64,
        start: [f64; N],
        tolerance: f64,
        (evaluations, value): (usize, f64),
    ) {
        let options =
            Options { x_tolerance: tolerance, f_tolerance: tolerance, ..Options::default() };
        let found = minimize(f, start, &options);
        assert!(found.converged);
        assert_eq!(found.evaluations, evaluations);
        let off = (found.value - value).abs();
        assert!(off <= 1e-6 * value.max(1e-6), "{} {value}", found.value);
    }

    #[test]
    fn minima_match_scipy() {
        is_as_scipy(valley, [-1.2, 1.0], 1e-4, (159, 8.177_661_197_416_674e-10));
        is_as_scipy(|x| (x[0] - 0.3).abs(), [3.0], 1e-2, (22, 0.0));
        let far = [4.0, -3.0, 2.0];
        is_as_scipy(crease, far, 1e-2, (98, 4.724_163_151_593_016));
        let steps = |x: &[f64; 3]| {
            let [a, b] = [3.0 * (x[0] - 0.7).abs(), 2.0 * (x[1] + 0.4).abs()];
            libm::floor(a) + libm::floor(b) + x[2].abs()
        };
        is_as_scipy(steps, far, 1e-2, (69, 10.552_659_338_007_429));
        let powell = |x: &[f64; 4]| {
            let (a, b) = (square(x[0] + 10.0 * x[1]), 5.0 * square(x[2] - x[3]));
            let (c, d) = (square(x[1] - 2.0 * x[2]), square(x[0] - x[3]));
            a + b + square(c) + 10.0 * square(d)
        };
        is_as_scipy(powell, [3.0, -1.0, 0.0, 1.0], 1e-2, (161, 1.172_335_029_864_933_5e-4));
    }

    #[test]
    fn nan_excludes_a_region_and_the_evaluation_limit_holds() {
        let mut calls = 0;
        let walled = |x: &[f64; 1]| {
            calls += 1;
            if x[0] < 0.5 { f64::NAN } else { x[0] }
        };
        let found = minimize(walled, [3.0], &Options::default());
        assert!((found.x[0] - 0.5).abs() < 1e-6);
        assert_eq!(calls, found.evaluations);
        for budget in 1..100 {
            let options = Options { max_evaluations: budget, ..Options::default() };
            let mut least = f64::INFINITY;
            let seen = |x: &[f64; 3]| {
                let value = crease(x);
                least = least.min(value);
                value
            };
            let found = minimize(seen, [4.0, -3.0, 2.0], &options);
            assert!(found.evaluations <= budget);
            assert_eq!(found.value, least);
        }
        let nowhere = minimize(|_: &[f64; 2]| f64::NAN, [1.0, 1.0], &Options::default());
        assert_eq!(nowhere.value, f64::INFINITY);
    }
}
