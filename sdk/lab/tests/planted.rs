//! The regression on made-up ratings whose truth is known, over 200 seeds.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use htex_dsp::Band;
use htex_dsp::bands::BandBank;
use htex_lab::analyse::{Analysis, Incomplete, Ratings, Spectra, analyse};

const PEOPLE: usize = 14;
const TEXTURES: usize = 5;
const MODELS: usize = 5;
const SEEDS: u64 = 200;

/// SplitMix64.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Standard normal, by Box and Muller.
    fn normal(&mut self) -> f64 {
        let (a, b) = (1.0 - self.uniform(), self.uniform());
        (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
    }
}

/// Felt spectra whose bins differ from a flat recording independently, and what each felt in every bin: z-scores over the models.
struct Felt {
    table: String,
    scores: Vec<Vec<f64>>,
}

fn felt(seed: u64) -> Felt {
    let (grid, mut random) = (Band::TACTILE.grid_hz(), Random(seed));
    let header: Vec<String> = grid.iter().map(f64::to_string).collect();
    let mut table = format!("participant,texture,model,{}\n", header.join(","));
    let flat = vec!["0.01"; grid.len()].join(",");
    (0..TEXTURES).for_each(|t| table += &format!("recorded,t{t},recorded,{flat}\n"));
    let mut scores = Vec::new();
    for p in 0..PEOPLE {
        for t in 0..TEXTURES {
            let mut rows = vec![Vec::new(); MODELS];
            for (m, row) in rows.iter_mut().enumerate() {
                let spectrum: Vec<f64> = grid
                    .iter()
                    .map(|_| 0.01 * (0.5 * random.normal()).exp())
                    .collect();
                let text: Vec<String> = spectrum.iter().map(f64::to_string).collect();
                table += &format!("p{p:02},t{t},m{m},{}\n", text.join(","));
                row.extend(spectrum.iter().map(|s| (s * s - 1e-4).abs()));
            }
            for bin in 0..grid.len() {
                let column: Vec<f64> = rows.iter().map(|row| row[bin]).collect();
                let scored = htex_statistics::z_scores(&column).unwrap();
                rows.iter_mut()
                    .zip(scored)
                    .for_each(|(row, score)| row[bin] = score);
            }
            scores.extend(rows);
        }
    }
    Felt { table, scores }
}

fn analysed(felt: &Felt, ratings: &[f64]) -> Analysis {
    let mut table = "participant,texture,model,repetition,rating\n".to_owned();
    for (row, rating) in ratings.iter().enumerate() {
        let (p, t, m) = (
            row / (TEXTURES * MODELS),
            row / MODELS % TEXTURES,
            row % MODELS,
        );
        table += &format!("p{p:02},t{t},m{m},1,{rating}\n");
    }
    let ratings = Ratings::read(table.as_bytes(), Incomplete::Refuse)
        .unwrap()
        .table;
    let spectra = Spectra::read(felt.table.as_bytes(), &ratings)
        .unwrap()
        .table;
    analyse(&ratings, Some(&spectra), "test")
}

/// Ratings that fall with the difference of energy in each of nine bands, by coefficients of both signs, with as much noise again.
fn of_nine_bands(felt: &Felt, seed: u64) -> Vec<f64> {
    let bank = BandBank::new(9, Band::TACTILE, &Band::TACTILE.grid_hz());
    let mut random = Random(seed);
    let sizes: Vec<f64> = (0..9)
        .map(|band| {
            let squares: f64 = (0..197)
                .map(|bin| bank.filters().weight(band, bin).powi(2))
                .sum();
            (if band % 2 == 0 { -1.0 } else { 1.0 }) / squares.sqrt()
        })
        .collect();
    let rate = |row: &Vec<f64>| {
        let mut sums = [0.0; 9];
        bank.filters().apply(row, &mut sums);
        let signal: f64 = sums.iter().zip(&sizes).map(|(sum, size)| sum * size).sum();
        3.0 + signal / 3.0 + random.normal()
    };
    felt.scores.iter().map(rate).collect()
}

/// What was found over seeds.
#[derive(Default)]
struct Rates {
    /// Ratings of nine bands whose best bank by BIC has nine.
    nine: u32,
    /// Ratings of noise for which BIC prefers no bands.
    none: u32,
    /// Ratings of noise for which 20 bands predict other participants worse than the mean.
    negative: u32,
    /// r2 of 20 bands on noise, and r2 for participants that were left out: sums.
    r2: [f64; 2],
}

impl Rates {
    fn add(&mut self, seed: u64) {
        let felt = felt(seed);
        let found = analysed(&felt, &of_nine_bands(&felt, seed + 1000))
            .best_bands
            .unwrap();
        self.nine += u32::from(found.bic == 9 && found.better_than_none);
        let mut random = Random(seed + 2000);
        let noise: Vec<f64> = felt.scores.iter().map(|_| random.normal()).collect();
        let analysis = analysed(&felt, &noise);
        self.none += u32::from(!analysis.best_bands.unwrap().better_than_none);
        let twenty = analysis.bands.last().unwrap();
        let checked = twenty.cross_validated_r2.unwrap();
        self.negative += u32::from(checked < 0.0);
        self.r2[0] += twenty.r2;
        self.r2[1] += checked;
    }
}

/// Found when this was written: nine bands in 200 of 200 seeds; on noise no bands in 191, and worse than the mean in 199, with a mean r2 of
/// 0.073 and a mean cross-validated r2 of -0.080.
#[test]
fn nine_planted_bands_are_found_and_noise_has_none() {
    let rates = |first: u64| {
        let mut rates = Rates::default();
        (first..SEEDS).step_by(2).for_each(|seed| rates.add(seed));
        rates
    };
    let (a, b) = std::thread::scope(|scope| {
        let other = scope.spawn(|| rates(1));
        (rates(0), other.join().unwrap())
    });
    assert!(a.nine + b.nine >= 198, "{} of {SEEDS}", a.nine + b.nine);
    assert!(a.none + b.none >= 180, "{} of {SEEDS}", a.none + b.none);
    assert!(
        a.negative + b.negative >= 195,
        "{} of {SEEDS}",
        a.negative + b.negative
    );
    let mean = |k: usize| (a.r2[k] + b.r2[k]) / SEEDS as f64;
    assert!(
        mean(0) > 0.06 && mean(1) < -0.06,
        "{} and {}",
        mean(0),
        mean(1)
    );
}
