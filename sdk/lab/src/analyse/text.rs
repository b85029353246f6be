//! An analysis as text tables.

use super::analysis::{Analysis, Mean};
use super::results::PairResult;
use super::words::{self, PAIR_HEADS, number_p};

impl Analysis {
    /// Returns the analysis as text: tables, tests in sentences, then the methods and notes.
    pub fn to_text(&self) -> String {
        let mut text = self.heading() + "\n";
        text += "\nRatings: mean (standard deviation between participants)\n";
        text += &self.means_table(&self.means, &self.means_model);
        text += "\nNormality of the mean ratings\n";
        text += &format!("  {}\n", words::normality(&self.normality));
        text += &self.effects();
        text += "\nModels compared, averaged over textures (paired t-tests)\n";
        text += &pairs(&self.pairs_model);
        for (texture, list) in &self.pairs_by_texture {
            let any = list.iter().filter(|pair| significant(pair));
            let any: Vec<String> = any
                .map(|pair| format!("{}\u{2013}{}", pair.a, pair.b))
                .collect();
            let found = if any.is_empty() {
                "none".to_owned()
            } else {
                any.join(", ")
            };
            text += &format!("  in {texture}, p Bonferroni < 0.05: {found}\n");
        }
        text += &self.spectral();
        text += "\nMethods\n";
        text += &self.methods_text();
        if !self.notes.is_empty() {
            text += "\nNotes\n";
            let lines = self.notes.iter();
            let lines = lines.map(|n| format!("  {} {}: {}\n", n.code, n.group, n.message));
            text += &lines.collect::<String>();
        }
        text
    }

    /// What was rated.
    pub(super) fn heading(&self) -> String {
        let simulated = match self.simulated.len() {
            0 => String::new(),
            count => format!(" ({count} SIMULATED)"),
        };
        format!(
            "{} participants{simulated}, {} textures, {} models, {} repetitions",
            self.participants.len(),
            self.textures.len(),
            self.models.len(),
            self.repetitions
        )
    }

    fn means_table(&self, by_texture: &[Mean], overall: &[Mean]) -> String {
        let mut rows = vec![
            std::iter::once(String::new())
                .chain(self.models.iter().cloned())
                .collect(),
        ];
        let names = self.textures.iter().map(Some).chain([None]);
        for name in names {
            let cell = |model: &String| {
                let all = by_texture.iter().chain(overall);
                let found = all
                    .clone()
                    .find(|m| m.texture.as_ref() == name && m.model == *model);
                found.map_or(String::new(), |m| format!("{:.3} ({:.3})", m.mean, m.sd))
            };
            let head = name.map_or("all textures".to_owned(), String::clone);
            rows.push(
                std::iter::once(head)
                    .chain(self.models.iter().map(cell))
                    .collect(),
            );
        }
        table(&rows)
    }

    fn effects(&self) -> String {
        let mut text = "\nEffects (repeated-measures ANOVA)\n".to_owned();
        let overall = self.anova_model.as_ref().map(|test| ("model", test));
        let two = self
            .anova_two_way
            .iter()
            .filter(|(name, _)| *name != "model");
        for (name, test) in overall
            .into_iter()
            .chain(two.map(|(name, test)| (&name[..], test)))
        {
            text += &format!("  {name}: {}\n", words::anova(test));
        }
        for (texture, test) in &self.anova_by_texture {
            text += &format!("  model in {texture}: {}\n", words::anova(test));
        }
        text += "\nEffects on ranks\n";
        if let Some(test) = &self.friedman {
            text += &format!("  model: {}\n", words::friedman(test));
        }
        for (texture, test) in &self.friedman_by_texture {
            text += &format!("  model in {texture}: {}\n", words::friedman(test));
        }
        text
    }

    fn spectral(&self) -> String {
        let mut text = String::new();
        if let Some(correlation) = &self.spectral_correlation {
            text += "\nSpectral correlation of felt with recorded: mean (standard deviation)\n";
            text += &self.means_table(&correlation.means, &correlation.means_model);
        }
        if let Some(best) = &self.best_bands {
            text += "\nRatings by differences of energy in bands\n";
            let heads = [
                "bands",
                "r2",
                "adjusted",
                "cross-validated",
                "F",
                "p",
                "RMSE",
                "AIC",
                "BIC",
            ];
            let mut rows = vec![heads.map(str::to_owned).to_vec()];
            rows.extend(self.bands.iter().map(|b| {
                let checked = b.cross_validated_r2;
                vec![
                    b.filters.to_string(),
                    format!("{:.4}", b.r2),
                    format!("{:.4}", b.adjusted_r2),
                    checked.map_or(String::new(), |value| format!("{value:.4}")),
                    format!("{:.2}", b.f),
                    number_p(b.p),
                    format!("{:.4}", b.rmse),
                    format!("{:.1}", b.aic),
                    format!("{:.1}", b.bic),
                ]
            }));
            text += &table(&rows);
            text += &format!("  {}\n", best.sentence());
        }
        text
    }

    fn methods_text(&self) -> String {
        let mut all: Vec<(&String, Vec<&str>)> = Vec::new();
        for (key, method) in &self.methods {
            match all.iter_mut().find(|(known, _)| *known == method) {
                Some((_, keys)) => keys.push(key),
                None => all.push((method, vec![key])),
            }
        }
        let line =
            |(method, keys): (&String, Vec<&str>)| format!("  {}: {method}\n", keys.join(", "));
        all.into_iter().map(line).collect()
    }
}

impl super::BestBanks {
    /// What the criteria prefer, in a sentence.
    pub(super) fn sentence(&self) -> String {
        let checked = self.cross_validated_r2;
        let checked = checked.map_or(String::new(), |n| format!(", {n} by cross-validated r2"));
        let none = match self.better_than_none {
            true => "",
            false => "; but the mean alone has a lower BIC, so that the bands explain nothing",
        };
        format!(
            "best number of bands: {} by BIC, {} by AIC{checked}{none}",
            self.bic, self.aic
        )
    }
}

pub(super) fn significant(pair: &PairResult) -> bool {
    pair.test
        .as_ref()
        .is_some_and(|test| test.p_bonferroni < 0.05)
}

fn pairs(list: &[PairResult]) -> String {
    let heads = ["a", "b", "difference"].iter().chain(&PAIR_HEADS);
    let mut rows = vec![heads.map(|head| (*head).to_owned()).collect::<Vec<_>>()];
    rows.extend(list.iter().map(|pair| {
        let start = [
            pair.a.clone(),
            pair.b.clone(),
            format!("{:.3}", pair.mean_difference),
        ];
        start
            .into_iter()
            .chain(words::pair(pair.test.as_ref()))
            .collect()
    }));
    table(&rows)
}

/// Aligns columns: the first to the left, others to the right.
fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.map(|(index, (cell, width))| match index {
            0 => format!("  {cell:<width$}"),
            _ => format!("  {cell:>width$}"),
        });
        cells.collect::<String>().trim_end().to_owned() + "\n"
    };
    rows.iter().map(line).collect()
}
