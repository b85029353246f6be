//! An analysis as CSV tables.

use super::analysis::{Analysis, Mean};
use super::results::{AnovaResult, PairResult};

impl Analysis {
    /// Returns the tables as CSV files: name and text. What is not defined is an empty field.
    pub fn to_csv(&self) -> Vec<(&'static str, String)> {
        let mut files = vec![
            ("cell-means.csv", self.cells_csv()),
            ("means.csv", means_csv(&self.means, &self.means_model)),
            ("effects.csv", self.effects_csv()),
            ("pairs.csv", self.pairs_csv()),
        ];
        if let Some(correlation) = &self.spectral_correlation {
            let means = means_csv(&correlation.means, &correlation.means_model);
            files.push(("spectral-correlation.csv", means));
            files.push(("bands.csv", self.bands_csv()));
        }
        files
    }

    fn cells_csv(&self) -> String {
        let mut csv = Csv::new(&["participant", "texture", "model", "repetitions", "mean"]);
        for cell in &self.cell_means {
            let numbers = [cell.repetitions.to_string(), number(cell.mean)];
            let names = [&cell.participant, &cell.texture, &cell.model].map(String::clone);
            csv.row(names.into_iter().chain(numbers));
        }
        csv.text
    }

    fn effects_csv(&self) -> String {
        let mut csv = Csv::new(&[
            "test",
            "texture",
            "effect",
            "statistic",
            "df1",
            "df2",
            "p",
            "p_gg",
            "p_hf",
            "eps_gg",
            "eps_hf",
            "partial_eta_squared",
            "kendall_w",
            "mauchly_w",
            "mauchly_p",
        ]);
        let overall = self.anova_model.iter().map(|test| ("", "model", test));
        let two = self
            .anova_two_way
            .iter()
            .filter(|(effect, _)| *effect != "model");
        let two = two.map(|(effect, test)| ("", &effect[..], test));
        let own = self
            .anova_by_texture
            .iter()
            .map(|(texture, test)| (&texture[..], "model", test));
        for (texture, effect, test) in overall.chain(two).chain(own) {
            csv.row(anova_row(texture, effect, test));
        }
        let overall = self.friedman.iter().map(|test| ("", test));
        let own = self
            .friedman_by_texture
            .iter()
            .map(|(texture, test)| (&texture[..], test));
        for (texture, test) in overall.chain(own) {
            let mut row = vec![
                "friedman".to_owned(),
                texture.to_owned(),
                "model".to_owned(),
            ];
            row.extend([test.chi2, test.df].map(number));
            row.extend([String::new(), number(test.p)]);
            row.extend(vec![String::new(); 5]);
            row.extend([number(test.kendall_w), String::new(), String::new()]);
            csv.row(row);
        }
        csv.text
    }

    fn pairs_csv(&self) -> String {
        let mut csv = Csv::new(&[
            "texture",
            "a",
            "b",
            "mean_difference",
            "t",
            "df",
            "p",
            "p_bonferroni",
            "p_holm",
            "ci95_low",
            "ci95_high",
            "cohen_dz",
            "cohen_d_av",
            "hedges_g",
        ]);
        self.pairs_model
            .iter()
            .for_each(|pair| csv.row(pair_row("", pair)));
        for (texture, list) in &self.pairs_by_texture {
            list.iter()
                .for_each(|pair| csv.row(pair_row(texture, pair)));
        }
        csv.text
    }

    fn bands_csv(&self) -> String {
        let mut csv = Csv::new(&[
            "filters",
            "r2",
            "adjusted_r2",
            "cross_validated_r2",
            "f",
            "df1",
            "df2",
            "p",
            "rmse",
            "aic",
            "bic",
        ]);
        for band in &self.bands {
            let checked = maybe(band.cross_validated_r2);
            let start = [
                band.filters.to_string(),
                number(band.r2),
                number(band.adjusted_r2),
                checked,
            ];
            let [df1, df2] = band.df;
            let rest = [band.f, df1, df2, band.p, band.rmse, band.aic, band.bic];
            csv.row(start.into_iter().chain(rest.map(number)));
        }
        csv.text
    }
}

fn anova_row(texture: &str, effect: &str, test: &AnovaResult) -> Vec<String> {
    let mut row = vec!["anova".to_owned(), texture.to_owned(), effect.to_owned()];
    let [df1, df2] = test.df;
    let numbers = [
        test.f,
        df1,
        df2,
        test.p,
        test.p_gg,
        test.p_hf,
        test.eps_gg,
        test.eps_hf,
        test.partial_eta_squared,
    ];
    row.extend(numbers.map(number));
    row.extend([String::new(), maybe(test.mauchly_w), maybe(test.mauchly_p)]);
    row
}

fn pair_row(texture: &str, pair: &PairResult) -> Vec<String> {
    let names = [texture, &pair.a, &pair.b].map(str::to_owned);
    let mut row: Vec<String> = names
        .into_iter()
        .chain([number(pair.mean_difference)])
        .collect();
    match &pair.test {
        Some(test) => {
            row.extend([number(test.t), test.df.to_string()]);
            let numbers = [
                test.p,
                test.p_bonferroni,
                test.p_holm,
                test.ci95[0],
                test.ci95[1],
                test.cohen_dz,
            ];
            row.extend(numbers.map(number));
            row.extend([maybe(test.cohen_d_av), maybe(test.hedges_g)]);
        }
        None => row.extend(vec![String::new(); 10]),
    }
    row
}

fn means_csv(by_texture: &[Mean], overall: &[Mean]) -> String {
    let mut csv = Csv::new(&["texture", "model", "count", "mean", "sd"]);
    for mean in by_texture.iter().chain(overall) {
        let texture = mean.texture.clone().unwrap_or_default();
        let numbers = [mean.count.to_string(), number(mean.mean), number(mean.sd)];
        csv.row([texture, mean.model.clone()].into_iter().chain(numbers));
    }
    csv.text
}

fn maybe(value: Option<f64>) -> String {
    value.map_or(String::new(), number)
}

/// A number with all its digits; small ones with an exponent.
fn number(value: f64) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}

/// A table that is being written.
struct Csv {
    text: String,
}

impl Csv {
    fn new(heads: &[&str]) -> Self {
        let text = heads.join(",") + "\n";
        Self { text }
    }

    fn row(&mut self, fields: impl IntoIterator<Item = String>) {
        let fields: Vec<String> = fields.into_iter().map(quoted).collect();
        self.text += &(fields.join(",") + "\n");
    }
}

/// Quotes a field where CSV needs it (RFC 4180).
fn quoted(field: String) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field
    }
}
