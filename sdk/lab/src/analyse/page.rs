//! An analysis as an HTML report.

use htex_report::{
    Cell, HeatScale, Page, Row, Table, code_block, details, figures, list, paragraph,
};

use super::analysis::{Analysis, Mean};
use super::figures::{bands, correlations, ratings};
use super::results::PairResult;
use super::words::{self, PAIR_HEADS, number_p};

impl Analysis {
    /// Returns the report as a self-contained page: the figures of the paper, every test, and its method.
    pub fn to_html(&self, command: &str) -> String {
        let mut page = Page::new("Analysis of a rating study");
        page.html(&paragraph(&format!("{}.", self.heading())));
        if !self.simulated.is_empty() {
            let text = "Simulated participants are among those analysed: these numbers say nothing about people.";
            page.html(&paragraph(text));
        }
        self.ratings_section(&mut page);
        self.tests_section(&mut page);
        self.pairs_section(&mut page);
        self.spectra_section(&mut page);
        self.power_section(&mut page);
        self.notes_section(&mut page);
        page.heading("How this page was made");
        page.html(&code_block(command));
        page.html(&paragraph(&self.program));
        page.render()
    }

    fn ratings_section(&self, page: &mut Page) {
        page.heading("Ratings");
        let text = "A dot is a participant's mean rating, a diamond the mean over participants, the shape behind them the distribution. Brackets join models \
            that differ: * p < 0.05, ** p < 0.01, *** p < 0.001, paired t-tests with Bonferroni's correction for the pairs of a picture.";
        page.html(&paragraph(text));
        page.html(&figures(&ratings(self)));
        page.html(&self.means_html(
            "Mean rating, and standard deviation between participants",
            &self.means,
            &self.means_model,
        ));
        self.method(page, &["means"]);
    }

    fn tests_section(&self, page: &mut Page) {
        page.heading("Effects");
        let mut lines = Vec::new();
        lines.extend(
            self.anova_model
                .iter()
                .map(|t| format!("model: {}", words::anova(t))),
        );
        let two = self
            .anova_two_way
            .iter()
            .filter(|(name, _)| *name != "model");
        lines.extend(two.map(|(name, t)| format!("{name}: {}", words::anova(t))));
        let own = self.anova_by_texture.iter();
        lines.extend(own.map(|(name, t)| format!("model in {name}: {}", words::anova(t))));
        page.html(&list(&lines));
        self.method(page, &["anova_model"]);
        let mut lines = Vec::new();
        lines.extend(
            self.friedman
                .iter()
                .map(|t| format!("model: {}", words::friedman(t))),
        );
        let own = self.friedman_by_texture.iter();
        lines.extend(own.map(|(name, t)| format!("model in {name}: {}", words::friedman(t))));
        page.html(&list(&lines));
        self.method(page, &["friedman"]);
        let mut lines = vec![format!(
            "all textures: {}",
            words::normality(&self.normality)
        )];
        let own = self.normality_by_texture.iter();
        lines.extend(own.map(|(name, t)| format!("{name}: {}", words::normality(t))));
        page.html(&paragraph("Normality of the mean ratings:"));
        page.html(&list(&lines));
        self.method(page, &["normality"]);
    }

    fn pairs_section(&self, page: &mut Page) {
        page.heading("Models compared");
        page.html(&pairs_html("Averaged over textures", &self.pairs_model));
        for (texture, pairs) in &self.pairs_by_texture {
            page.html(&details(texture, &pairs_html(texture, pairs)));
        }
        self.method(page, &["pairs_model"]);
    }

    fn spectra_section(&self, page: &mut Page) {
        if let Some(found) = &self.spectral_correlation {
            page.heading("Spectral correlation of felt with recorded");
            page.html(&figures(&correlations(self)));
            let caption = "Mean correlation, and standard deviation between participants";
            page.html(&self.means_html(caption, &found.means, &found.means_model));
            self.method(page, &["spectral_correlation"]);
        }
        if let Some(best) = &self.best_bands {
            page.heading("Ratings by differences of energy in bands");
            page.html(&paragraph(&format!("The {}.", best.sentence())));
            page.html(&figures(&bands(self)));
            page.html(&self.bands_html());
            self.method(page, &["bands", "best_bands"]);
        }
    }

    fn power_section(&self, page: &mut Page) {
        page.heading("Power for a medium effect");
        let columns = ["participants", "power"].map(str::to_owned).to_vec();
        let row = |p: &super::PowerRow| Row {
            header: p.participants.to_string(),
            cells: vec![Cell::Text(format!("{:.4}", p.power), String::new())],
        };
        let table = table(
            "",
            &columns[0],
            columns[1..].to_vec(),
            self.power.iter().map(row).collect(),
        );
        page.html(&details(
            "Power by number of participants",
            &table.to_html(),
        ));
        self.method(page, &["power"]);
    }

    fn notes_section(&self, page: &mut Page) {
        if self.notes.is_empty() {
            return;
        }
        page.heading("Notes");
        let lines = self
            .notes
            .iter()
            .map(|n| format!("{} ({}): {}", n.group, n.code, n.message));
        page.html(&list(&lines.collect::<Vec<_>>()));
    }

    /// The method of groups, below their numbers.
    fn method(&self, page: &mut Page, groups: &[&str]) {
        let texts = groups.iter().filter_map(|group| self.methods.get(*group));
        texts.for_each(|text| page.html(&paragraph(&format!("Method: {text}"))));
    }

    fn means_html(&self, caption: &str, by_texture: &[Mean], overall: &[Mean]) -> String {
        let row = |texture: Option<&String>| {
            let cell = |model: &String| {
                let mut all = by_texture.iter().chain(overall);
                let found = all.find(|m| m.texture.as_ref() == texture && m.model == *model);
                let text = |m: &Mean| {
                    Cell::Text(
                        format!("{:.3}", m.mean),
                        format!("sd {:.3}, n {}", m.sd, m.count),
                    )
                };
                found.map_or(Cell::Missing, text)
            };
            Row {
                header: texture.map_or("all textures", |name| name).to_owned(),
                cells: self.models.iter().map(cell).collect(),
            }
        };
        let rows = self
            .textures
            .iter()
            .map(Some)
            .chain([None])
            .map(row)
            .collect();
        table(caption, "texture", self.models.clone(), rows).to_html()
    }

    fn bands_html(&self) -> String {
        let columns = [
            "r\u{b2}",
            "adjusted r\u{b2}",
            "cross-validated r\u{b2}",
            "F",
            "p",
            "RMSE",
            "AIC",
            "BIC",
        ];
        let row = |b: &super::BandResult| {
            let checked = b.cross_validated_r2;
            let texts = [
                format!("{:.4}", b.r2),
                format!("{:.4}", b.adjusted_r2),
                checked.map_or(String::new(), |value| format!("{value:.4}")),
                format!("{:.2}", b.f),
                number_p(b.p),
                format!("{:.4}", b.rmse),
                format!("{:.1}", b.aic),
                format!("{:.1}", b.bic),
            ];
            Row {
                header: b.filters.to_string(),
                cells: texts.map(|text| Cell::Text(text, String::new())).to_vec(),
            }
        };
        let rows = self.bands.iter().map(row).collect();
        let columns = columns.map(str::to_owned).to_vec();
        table("Regressions by number of bands", "bands", columns, rows).to_html()
    }
}

fn pairs_html(caption: &str, pairs: &[PairResult]) -> String {
    let heads = ["difference"].iter().chain(&PAIR_HEADS);
    let row = |pair: &PairResult| {
        let start = [format!("{:.3}", pair.mean_difference)].into_iter();
        let texts = start.chain(words::pair(pair.test.as_ref()));
        Row {
            header: format!("{} \u{2013} {}", pair.a, pair.b),
            cells: texts.map(|text| Cell::Text(text, String::new())).collect(),
        }
    };
    let columns = heads.map(|head| (*head).to_owned()).collect();
    table(caption, "pair", columns, pairs.iter().map(row).collect()).to_html()
}

fn table(caption: &str, corner: &str, columns: Vec<String>, rows: Vec<Row>) -> Table {
    Table {
        caption: caption.to_owned(),
        corner: corner.to_owned(),
        columns,
        rows,
        scale: HeatScale::None,
        decimals: 3,
    }
}
