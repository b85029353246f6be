//! Linear regression by least squares, and how well it predicts people that it has not seen.

use std::f64::consts::PI;

use crate::StatisticsError;
use crate::describe::{is_constant, sum_of_squares};
use crate::distributions::f_sf;
use crate::linear::{LeastSquares, least_squares, triangle};
use crate::table::check_finite;

/// Predictors of a regression: a column for each, a row for each value.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: Vec<Vec<f64>>,
}

impl Matrix {
    /// Creates the predictors of `rows` values.
    ///
    /// # Errors
    /// A column has another length, or a value is not finite.
    pub fn new(rows: usize, columns: Vec<Vec<f64>>) -> Result<Self, StatisticsError> {
        for column in &columns {
            if column.len() != rows {
                return Err(StatisticsError::Shape {
                    found: column.len(),
                    participants: rows,
                    levels: 1,
                });
            }
            check_finite(column)?;
        }
        Ok(Self { rows, columns })
    }

    /// Returns the columns of the rows that `keep` holds for, with a column of ones before them.
    fn design(&self, keep: &[bool]) -> Vec<Vec<f64>> {
        let ones = vec![1.0; self.rows];
        let columns = std::iter::once(&ones).chain(&self.columns);
        columns.map(|column| kept(column, keep)).collect()
    }
}

/// A fitted regression with an intercept.
#[derive(Debug, Clone, PartialEq)]
pub struct Regression {
    /// Explained part of the variance, 0 to 1.
    pub r2: f64,
    /// The same with both variances by degrees of freedom: it falls when a predictor explains no more than chance.
    pub adjusted_r2: f64,
    /// F ratio of all predictors against the intercept alone.
    pub f: f64,
    /// Its degrees of freedom.
    pub df: [f64; 2],
    /// Its p-value.
    pub p: f64,
    /// Root of the residual sum of squares by residual degrees of freedom.
    pub rmse: f64,
    /// Akaike's information criterion, -2 ln L + 2 k with k coefficients, the intercept among them.
    pub aic: f64,
    /// Schwarz's (Bayesian) information criterion, -2 ln L + k ln n.
    pub bic: f64,
    /// The intercept, then a coefficient for each predictor.
    pub coefficients: Vec<f64>,
    /// Predictors (from 0) that are constant or depend on those before them; their coefficient is 0 and they count no degree of freedom.
    pub dependent: Vec<usize>,
}

/// Regresses `values` on `predictors` and an intercept.
///
/// # Errors
/// Lengths differ, a value is not finite, all values are equal, no predictor varies, there are not more values than coefficients, or no
/// residual is left.
///
/// ```
/// use htex_statistics::{Matrix, regression};
/// let predictors = Matrix::new(4, vec![vec![1.0, 2.0, 3.0, 4.0]])?;
/// let fit = regression(&predictors, &[1.1, 1.9, 3.2, 3.8])?;
/// assert!((fit.coefficients[1] - 0.94).abs() < 1e-12 && fit.r2 > 0.98);
/// # Ok::<(), htex_statistics::StatisticsError>(())
/// ```
pub fn regression(predictors: &Matrix, values: &[f64]) -> Result<Regression, StatisticsError> {
    check(predictors, values)?;
    let all = vec![true; values.len()];
    let design = predictors.design(&all);
    let solution = least_squares(&design, values);
    let dependent: Vec<usize> = solution.dependent.iter().map(|column| column - 1).collect();
    let coefficients = design.len() - dependent.len();
    if coefficients < 2 {
        return Err(StatisticsError::NoPredictor);
    }
    if coefficients >= values.len() {
        return Err(StatisticsError::TooFewRows {
            rows: values.len(),
            coefficients,
        });
    }
    let residual = residual_squares(&design, values, &solution);
    let total = sum_of_squares(values);
    if residual <= 1e-24 * total {
        return Err(StatisticsError::PerfectFit);
    }
    let mut fit = measures(values.len() as f64, coefficients as f64, residual, total);
    fit.coefficients = solution.coefficients;
    fit.dependent = dependent;
    Ok(fit)
}

fn check(predictors: &Matrix, values: &[f64]) -> Result<(), StatisticsError> {
    if predictors.rows != values.len() {
        return Err(StatisticsError::Shape {
            found: values.len(),
            participants: predictors.rows,
            levels: 1,
        });
    }
    check_finite(values)?;
    if values.is_empty() || is_constant(values) {
        return Err(StatisticsError::Constant {
            test: "a regression",
        });
    }
    Ok(())
}

fn measures(n: f64, k: f64, residual: f64, total: f64) -> Regression {
    let df = [k - 1.0, n - k];
    let explained = (total - residual).max(0.0);
    let f = (explained / df[0]) / (residual / df[1]);
    let deviance = n * (libm::log(2.0 * PI * residual / n) + 1.0);
    Regression {
        r2: explained / total,
        adjusted_r2: 1.0 - (residual / df[1]) / (total / (n - 1.0)),
        f,
        df,
        p: f_sf(f, df),
        rmse: libm::sqrt(residual / df[1]),
        aic: deviance + 2.0 * k,
        bic: deviance + k * libm::log(n),
        coefficients: Vec::new(),
        dependent: Vec::new(),
    }
}

fn residual_squares(design: &[Vec<f64>], values: &[f64], solution: &LeastSquares) -> f64 {
    let square = |row: usize| {
        let rest = values[row] - predicted(design, row, &solution.coefficients);
        rest * rest
    };
    (0..values.len()).map(square).sum()
}

fn predicted(design: &[Vec<f64>], row: usize, coefficients: &[f64]) -> f64 {
    design
        .iter()
        .zip(coefficients)
        .map(|(column, c)| column[row] * c)
        .sum()
}

/// Cross-validated r2: 1 less the squared errors of predictions for each group from the others, by those of the others' mean.
///
/// `groups` names the group of each value, such as its participant. Unlike r2 it falls, also below 0, when predictors fit noise.
///
/// # Errors
/// As of [`regression`] for the lengths and values; there is only one group, or the others of a group are fewer than the coefficients.
pub fn cross_validated_r2(
    predictors: &Matrix,
    values: &[f64],
    groups: &[usize],
) -> Result<f64, StatisticsError> {
    check(predictors, values)?;
    let mut names = groups.to_vec();
    names.sort_unstable();
    names.dedup();
    if names.len() < 2 || groups.len() != values.len() {
        return Err(StatisticsError::TooFewParticipants {
            test: "cross-validation by participants",
            found: names.len(),
            needed: 2,
        });
    }
    let folds = Folds::new(predictors, values, groups, &names);
    let (mut errors, mut baseline) = (0.0, 0.0);
    for fold in 0..names.len() {
        let (error, base) = folds.leave_out(fold)?;
        errors += error;
        baseline += base;
    }
    Ok(1.0 - errors / baseline)
}

/// Columns of a matrix: ones, the predictors, the values.
type Columns = Vec<Vec<f64>>;

/// The rows of each group, and the triangles of all groups before and after it: the time of all folds together grows with the rows, and not
/// with the rows times the groups.
struct Folds {
    rows: usize,
    sum: f64,
    groups: Vec<Columns>,
    /// Of the groups before the n-th.
    before: Vec<Columns>,
    /// Of the groups from the n-th on.
    from: Vec<Columns>,
}

impl Folds {
    fn new(predictors: &Matrix, values: &[f64], groups: &[usize], names: &[usize]) -> Self {
        let all = vec![true; values.len()];
        let mut columns = predictors.design(&all);
        columns.push(values.to_vec());
        let mut of_groups = vec![vec![Vec::new(); columns.len()]; names.len()];
        for (row, group) in groups.iter().enumerate() {
            // Each group is among the names, which are sorted.
            let at = names.partition_point(|name| name < group);
            let pairs = of_groups[at].iter_mut().zip(&columns);
            pairs.for_each(|(to, column)| to.push(column[row]));
        }
        let empty = vec![Vec::new(); columns.len()];
        let mut before = vec![empty.clone()];
        let mut from = vec![empty];
        for (first, last) in of_groups.iter().zip(of_groups.iter().rev()) {
            before.push(triangle(stacked(&before[before.len() - 1], first)));
            from.push(triangle(stacked(&from[from.len() - 1], last)));
        }
        from.reverse();
        Self {
            rows: values.len(),
            sum: values.iter().sum(),
            groups: of_groups,
            before,
            from,
        }
    }

    /// Returns the squared errors for a group: of the regression on the others, and of their mean.
    fn leave_out(&self, group: usize) -> Result<(f64, f64), StatisticsError> {
        let mut design = stacked(&self.before[group], &self.from[group + 1]);
        let target = design.pop().unwrap_or_default();
        let mut unseen = self.groups[group].clone();
        let values = unseen.pop().unwrap_or_default();
        let known = self.rows - values.len();
        if known <= design.len() {
            return Err(StatisticsError::TooFewRows {
                rows: known,
                coefficients: design.len(),
            });
        }
        let solution = least_squares(&design, &target);
        let centre = (self.sum - values.iter().sum::<f64>()) / known as f64;
        let errors = residual_squares(&unseen, &values, &solution);
        let baseline = values.iter().map(|v| (v - centre) * (v - centre)).sum();
        Ok((errors, baseline))
    }
}

/// The rows of one matrix under those of another.
fn stacked(above: &Columns, below: &Columns) -> Columns {
    let pairs = above.iter().zip(below);
    pairs.map(|(a, b)| [&a[..], &b[..]].concat()).collect()
}

fn kept(values: &[f64], keep: &[bool]) -> Vec<f64> {
    let pairs = values.iter().zip(keep);
    pairs.filter(|(_, keep)| **keep).map(|(v, _)| *v).collect()
}
