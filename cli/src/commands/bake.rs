use std::fmt::{Display, Formatter};
use std::path::{Path, PathBuf};

use clap::Args;
use htex::Motion;
use htex_base::files::AtFile;
use htex_play::bake::{BakeLimits, BakeResult, Grid};
use serde::{Serialize, Serializer};
use serde_json::json;

use crate::failure::{Failure, Result, for_file};
use crate::located;
use crate::output::{note, show, shown, warn, write_file};
use crate::outputs::check_outputs;
use crate::plugins::PlayerArgs;

/// Smallest and largest number of coefficients in a filter.
const FEWEST: i64 = BakeLimits::FEWEST as i64;
const MOST: i64 = BakeLimits::MOST as i64;

/// Write a texture for microcontrollers
///
/// Writes a block of bytes, from which a small player on the microcontroller renders samples (see
/// docs/microcontroller.md).
///
/// A condition is a pair of a finger speed and a normal force. The block stores the texture at the
/// conditions of a grid. Between the conditions, the player interpolates. The command prints the
/// size of the block and its error in nine frequency bands: once at the conditions, and once midway
/// between the conditions. This nine-band error is the largest difference between the spectrum of
/// the block and the spectrum of the asset in any of the nine frequency bands.
#[derive(Args)]
pub(crate) struct Bake {
    /// The asset
    #[arg(value_parser = located::ASSET)]
    asset: PathBuf,

    /// Model of the asset to use, by short name or id [default: the model with the smallest
    /// nine-band error]
    #[arg(long, value_name = "ID")]
    model: Option<String>,

    /// Store the texture at this condition, e.g. speed=80,force=0.4 (mm/s, N). May be given several
    /// times; then give all combinations of the speeds and the forces [default: the asset's first
    /// condition, or its strongest condition if the first is silent]
    #[arg(long, value_name = "CONDITION", conflicts_with = "grid")]
    at: Vec<String>,

    /// Store the texture at all conditions of this grid, e.g. speed=40:160:3,force=0.2:0.6:3 (mm/s,
    /// N). Give the speed and the force as FIRST:LAST:COUNT or as one number
    #[arg(long, value_name = "GRID")]
    grid: Option<String>,

    /// Sample rate of the player, Hz
    #[arg(long, default_value_t = 8_000.0, value_name = "HZ")]
    rate: f64,

    /// Largest nine-band error midway between two neighbouring conditions of the block, dB. htex
    /// adds conditions until this error is reached, or until the block has 64 conditions
    #[arg(long, default_value_t = 0.3, value_name = "DB")]
    within: f64,

    /// Maximum number of coefficients of a filter, 65 to 641. A filter with fewer coefficients
    /// takes less time per sample, but can be less accurate [default: 641]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(FEWEST..=MOST))]
    longest: Option<u16>,

    /// Also store how much the texture's strength fluctuates over time, if the asset contains this
    /// information (`htex info` shows it). The player then lets the strength of the texture
    /// fluctuate, with the same mean level. Nobody has tested whether this makes a texture feel
    /// more real
    #[arg(long)]
    fluctuation: bool,

    #[command(flatten)]
    player: PlayerArgs,

    /// The file to write: a C array (.h), a Rust array (.rs) or the bytes (.bin). For a C or Rust
    /// array, the command writes licence and author as comments into the file. For a .bin file, the
    /// command writes licence and author to FILE.license
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Name of the array in a .h or .rs file [default: made from the file's name]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,

    /// Print JSON instead of text
    #[arg(long)]
    json: bool,
}

impl Bake {
    pub(crate) fn run(self) -> Result {
        check_outputs([self.output.as_path()], [self.asset.as_path()])?;
        let (name, format) = name_and_format(&self.output, self.name.as_deref())?;
        let grid = self.grid()?;
        if !(self.within > 0.0 && self.within.is_finite()) {
            return Err(Failure::Usage(format!(
                "--within {}: a number of decibels above 0",
                self.within
            )));
        }
        let asset = self.player.open(&self.asset)?;
        let representation =
            asset.representation(self.model.as_deref()).map_err(for_file(&self.asset))?;
        let grid = match grid {
            Some(grid) => grid,
            None => Grid::for_default_condition(representation).map_err(for_file(&self.asset))?,
        };
        let longest = self.longest.map_or(BakeLimits::MOST, usize::from);
        let limits = BakeLimits::within_db(self.within)
            .with_longest(longest)
            .with_fluctuation(self.fluctuation);
        let baked = htex_play::bake::bake(representation, &grid, self.rate, limits)
            .map_err(for_file(&self.asset))?;
        let rights = match format {
            Format::Bytes => Some(&baked.rights),
            Format::C | Format::Rust => None,
        };
        let beside = rights.and_then(|rights| rights.beside(&self.output));
        // The licence goes to a second file, whose name the user did not give. Only the baked asset
        // tells whether there is a licence, so this file is checked only now.
        check_outputs(beside.as_deref(), [self.asset.as_path()])?;
        let written = match format {
            Format::Bytes => baked.bytes.clone(),
            Format::C => htex_play::bake::c_header(&name, &baked).into_bytes(),
            Format::Rust => htex_play::bake::rust_source(&name, &baked).into_bytes(),
        };
        write_file(&self.output, &written)?;
        if let Some(rights) = rights {
            rights.add_to_file(&self.output).writing(&self.output)?;
        }
        let error_db = baked.at_conditions_db.max(baked.between_db);
        if error_db > self.within {
            warn(&[format!(
                "the block is up to {error_db:.2} dB from the model: a narrower grid, or a lower rate, is more accurate \
                 (see --grid, --rate)"
            )]);
        }
        warn_of_frequencies(&baked);
        match (asset.manifest().fluctuation, baked.fluctuation) {
            (Some(fluctuation), None) => note(&[format!(
                "the block plays stationary noise: the asset's fluctuation in time ({fluctuation}) is not in it \
                 (see --fluctuation)"
            )]),
            (None, _) if self.fluctuation => {
                note(
                    &["the asset states no fluctuation in time, so the block has none".to_owned()],
                );
            }
            _ => {}
        }
        show(&BakeReport { output: &self.output, baked: &baked, rate_hz: self.rate }, self.json)
    }

    /// Reads the conditions from the command line.
    fn grid(&self) -> Result<Option<Grid>> {
        if let Some(text) = &self.grid {
            let [speeds, forces] = axes("--grid", text, span)?;
            return Grid::new(speeds, forces).map(Some).map_err(for_file(&self.asset));
        }
        let mut motions = Vec::new();
        for text in &self.at {
            let [speed, force] = axes("--at", text, |value| value.trim().parse().ok())?;
            motions.push(Motion::new(speed, force));
        }
        if motions.is_empty() {
            Ok(None)
        } else {
            Grid::from_conditions(&motions).map(Some).map_err(for_file(&self.asset))
        }
    }
}

/// Warns if the texture's law changes frequencies with the speed, but the grid has only one speed
/// or covers fewer speeds than the recordings. Outside the grid, a filter cannot change its
/// frequencies.
fn warn_of_frequencies(baked: &BakeResult) {
    let speeds = baked.grid.speeds_mm_s();
    let (Some(beyond_db), [lowest, .., highest] | [lowest @ highest]) = (baked.beyond_db, speeds)
    else {
        return;
    };
    let is_narrow = match baked.recorded_speeds_mm_s {
        Some((low, high)) => low < *lowest || high > *highest || lowest == highest,
        None => lowest == highest,
    };
    if is_narrow {
        warn(&[format!(
            "beyond {lowest:.1} to {highest:.1} mm/s the player keeps the frequencies of this model, which the texture's law moves by the \
             speed to the power {}: {beyond_db:.1} dB at half or twice the speed; bake all speeds that will be played (see --grid)",
            baked.law.frequency_speed
        )]);
    }
}

enum Format {
    Bytes,
    C,
    Rust,
}

/// Returns the name of the array and the format of the file. Checks the name that the user gave, or
/// else makes one from the file's name.
fn name_and_format(output: &Path, given: Option<&str>) -> Result<(String, Format)> {
    let text = |part: Option<&std::ffi::OsStr>| part.and_then(|p| p.to_str()).map(str::to_owned);
    let stem = text(output.file_stem()).unwrap_or_default();
    let (format, is_name, rule): (_, fn(&str) -> bool, _) = match text(output.extension())
        .as_deref()
    {
        Some("bin") => (Format::Bytes, |_| false, "bytes in a .bin file have no name"),
        Some("h") => (
            Format::C,
            htex_play::bake::is_c_name,
            "a name in C begins with a letter, has letters, digits and single underscores, and is no keyword",
        ),
        Some("rs") => (
            Format::Rust,
            htex_play::bake::is_rust_name,
            "a constant in Rust has capital letters, digits and underscores, and begins with a letter",
        ),
        _ => {
            return Err(Failure::Usage(format!(
                "{}: the name ends in .bin, .h or .rs",
                shown(output)
            )));
        }
    };
    let name = match (given, &format) {
        (Some(given), _) if is_name(given) => given.to_owned(),
        (Some(given), _) => return Err(Failure::Usage(format!("--name {given}: {rule}"))),
        (None, Format::Rust) => htex_play::bake::rust_name(&stem),
        (None, _) => htex_play::bake::c_name(&stem),
    };
    Ok((name, format))
}

/// Reads `speed=…,force=…`.
fn axes<T>(flag: &str, text: &str, read: impl Fn(&str) -> Option<T>) -> Result<[T; 2]> {
    let (mut speed, mut force) = (None, None);
    for part in text.split(',') {
        match part.split_once('=').map(|(key, value)| (key.trim(), value)) {
            Some(("speed", value)) => speed = read(value),
            Some(("force", value)) => force = read(value),
            // An unknown or repeated key is refused below, because then a value is missing or there
            // are three parts.
            _ => {}
        }
    }
    match (speed, force, text.split(',').count()) {
        (Some(speed), Some(force), 2) => Ok([speed, force]),
        _ => Err(Failure::Usage(format!(
            "{flag} {text}: a speed and a force, such as speed=80,force=0.4{}",
            match flag {
                "--grid" => " or speed=40:160:3,force=0.2:0.6:3 (first, last, count from 2 to 32)",
                _ => " (mm/s, N)",
            }
        ))),
    }
}

/// Reads `FIRST:LAST:COUNT`, or one number.
fn span(text: &str) -> Option<Vec<f64>> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    match parts[..] {
        [one] => Some(vec![one.parse().ok()?]),
        [first, last, count] => {
            let (first, last): (f64, f64) = (first.parse().ok()?, last.parse().ok()?);
            let count: u32 = count.parse().ok()?;
            // If the count is 1, this divides by zero. The range below refuses it.
            let step = (last - first) / f64::from(count.checked_sub(1)?);
            (2..=32)
                .contains(&count)
                .then(|| (0..count).map(|i| first + f64::from(i) * step).collect())
        }
        _ => None,
    }
}

/// The report on a block that was written.
struct BakeReport<'a> {
    output: &'a Path,
    baked: &'a BakeResult,
    rate_hz: f64,
}

impl Serialize for BakeReport<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { baked, rate_hz, .. } = self;
        json!({
            "model": baked.model,
            "bytes": baked.bytes.len(),
            "quantity": baked.quantity.name(),
            "unit": baked.quantity.unit(),
            "full_scale": baked.full_scale,
            "rate_hz": rate_hz,
            "internal_rate_hz": baked.internal_rate_hz,
            "taps": baked.taps,
            "filters": baked.filters,
            "tones": baked.tones,
            "speeds_mm_s": baked.grid.speeds_mm_s(),
            "forces_n": baked.grid.forces_n(),
            "law": {
                "frequency_speed": baked.law.frequency_speed,
                "level_speed": baked.law.level_speed,
                "level_force": baked.law.level_force,
            },
            "fluctuation": baked.fluctuation,
            "ceiling": baked.ceiling,
            "error_at_conditions_db": baked.at_conditions_db,
            "error_between_db": baked.between_db,
            "error_beyond_db": baked.beyond_db,
        })
        .serialize(serializer)
    }
}

impl Display for BakeReport<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { output, baked, rate_hz } = self;
        let BakeResult { model, quantity, law, at_conditions_db, between_db, .. } = baked;
        let content = match (baked.taps, baked.filters) {
            (0, _) => format!("{} sinusoids", baked.tones),
            (taps, 1) => format!("a filter of {taps} coefficients"),
            (taps, filters) => format!("{filters} filters of {taps} coefficients"),
        };
        let conditions = baked.grid.motions().count();
        let between = match conditions {
            1 => String::new(),
            _ => format!(", {between_db:.2} dB midway between them"),
        };
        let beyond = baked.beyond_db.map_or(String::new(), |error| format!(
            ", {error:.1} dB at half the lowest and twice the highest speed, where frequencies do not follow"
        ));
        writeln!(
            f,
            "{}: {} bytes, {model} at {rate_hz} Hz, {conditions} conditions, {content} at {:.1} Hz\n\
             samples: {}, {}, full scale {}\n\
             beyond the grid: frequency over speed ^{:.2}, level over speed ^{:.2}, level over force ^{:.2}, level at most {}\n\
             largest error of nine bands: {at_conditions_db:.2} dB at the conditions{between}{beyond}",
            shown(output),
            baked.bytes.len(),
            baked.internal_rate_hz,
            quantity.words(),
            quantity.unit(),
            quantity.text(baked.full_scale),
            law.frequency_speed,
            law.level_speed,
            law.level_force,
            quantity.text(baked.ceiling),
        )
    }
}
