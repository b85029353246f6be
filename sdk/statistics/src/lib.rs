//! Statistics of rating studies: repeated measures, paired comparisons, regression, power. Independent of textures and files.
//!
//! A study in which each participant rates each condition is a [`Table`]; one with two crossed factors is a [`TwoFactors`]. Degenerate
//! data are an error with a name, [`StatisticsError`]: no result holds NaN or an infinite number.
//!
//! | question | function | source |
//! |---|---|---|
//! | are the values normal? | [`kolmogorov_smirnov`], [`lilliefors`], [`shapiro_wilk`] | exact distribution of D; Dallal and Wilkinson 1986; Royston 1995, AS R94 |
//! | do the means differ? | [`anova`], [`TwoFactors::anova`] | Greenhouse and Geisser 1959, Huynh and Feldt 1976, Mauchly 1940 |
//! | do the ranks differ? | [`friedman`] | Friedman 1937, Kendall's W |
//! | which means differ? | [`paired_t`], [`bonferroni`], [`holm`] | Student 1908, Holm 1979 |
//! | what predicts the ratings? | [`regression`], [`cross_validated_r2`] | least squares by Householder's QR |
//! | how many participants? | [`Power`] | G*Power 3.1, "repeated measures, within factors" |
//!
//! Distribution functions ([`distributions`]) are computed with `libm`, so that results have the same digits on every processor.
//!
//! ```
//! use htex_statistics::{Table, anova};
//! // Three participants rate two conditions.
//! let table = Table::new(3, 2, vec![4.0, 2.0, 5.0, 2.5, 3.0, 2.0])?;
//! let test = anova(&table)?;
//! assert_eq!(test.df, [1.0, 2.0]);
//! assert!((test.p - 0.0533).abs() < 1e-3);
//! # Ok::<(), htex_statistics::StatisticsError>(())
//! ```
#![forbid(unsafe_code)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

mod anova;
mod contrasts;
mod describe;
pub mod distributions;
mod error;
mod friedman;
mod kolmogorov;
mod linear;
mod normality;
mod pairs;
mod power;
mod regression;
mod shapiro;
mod sphericity;
mod table;

pub use anova::{Anova, TwoWayAnova, anova};
pub use describe::{Summary, pearson, summary, z_scores};
pub use error::StatisticsError;
pub use friedman::{Friedman, friedman};
pub use kolmogorov::kolmogorov_sf;
pub use normality::{Test, kolmogorov_smirnov, lilliefors};
pub use pairs::{PairedT, bonferroni, holm, paired_t};
pub use power::{Power, PowerResult};
pub use regression::{Matrix, Regression, cross_validated_r2, regression};
pub use shapiro::shapiro_wilk;
pub use sphericity::Sphericity;
pub use table::{Table, TwoFactors};
