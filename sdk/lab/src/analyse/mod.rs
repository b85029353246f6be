//! Analysis of a rating study: tables of ratings and of felt spectra in, every test of the paper and its remedies out.
//!
//! [`Ratings`] and [`Spectra`] are read from CSV and checked; [`analyse`] computes an [`Analysis`], which serialises to JSON, and from
//! which text, CSV and the report are made. A test that the data do not allow is left out and named in [`Analysis::notes`]: no number of
//! an analysis is NaN.
//!
//! ```
//! use htex_lab::analyse::{Incomplete, Ratings, analyse};
//! let csv = "participant,texture,model,repetition,rating\n\
//!            p1,vinyl,ar,1,3\np1,vinyl,sbeta,1,5\n\
//!            p2,vinyl,ar,1,2\np2,vinyl,sbeta,1,3\n";
//! let ratings = Ratings::read(csv.as_bytes(), Incomplete::Refuse)?;
//! let analysis = analyse(&ratings.table, None, "example");
//! assert_eq!(analysis.pairs_model[0].mean_difference, -1.5);
//! // Two models in one texture: there is no two-way ANOVA, and the notes say why.
//! assert!(analysis.notes.iter().any(|note| note.group == "anova_two_way"));
//! # Ok::<(), htex_lab::analyse::Invalid>(())
//! ```

mod analysis;
mod answers;
mod bands;
mod correlation;
mod figures;
mod inference;
mod methods;
mod page;
mod ratings;
mod results;
mod rules;
mod run;
mod sheet;
mod spectra;
mod tables;
mod text;
mod words;

pub use analysis::{Analysis, CellMean, Mean, Note};
pub use ratings::{Incomplete, Ratings};
pub use results::{
    AnovaResult, BandResult, BestBanks, Correlation, FriedmanResult, Normality, PairResult,
    PairTest, PowerRow, SpectralCorrelation,
};
pub use rules::{RULES, explain, findings_page};
pub use run::{analyse, analysis_schema};
pub use sheet::{Checked, Invalid};
pub use spectra::Spectra;
