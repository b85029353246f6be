//! Bakes textures: computes blocks of data for microcontrollers.

use htex::Texture;
use htex::format::Asset;
use htex_format::Quantity;
use htex_play::bake::{BakeResult, Grid, bake as baked, c_header, c_name, rust_name, rust_source};
use serde::Serialize;
use serde_json::Value;

use crate::answer::{Answer, Files};
use crate::document::{Document, number};
use crate::refusal::Refusal;

/// Default rate and accuracy, the same as in the command.
const RATE_HZ: f64 = 8_000.0;
const WITHIN_DB: f64 = 0.3;

#[derive(Serialize)]
struct Block<'a> {
    model: &'a str,
    quantity: Quantity,
    unit: &'static str,
    full_scale: f64,
    rate_hz: f64,
    speeds: &'a [f64],
    forces: &'a [f64],
    error_at_conditions_db: f64,
    error_between_db: f64,
    error_beyond_db: Option<f64>,
    /// The block as an array in C and in Rust.
    c: String,
    rust: String,
}

/// Bakes a texture. The only file is the texture. The bytes of the answer are the block.
pub(crate) fn bake(mut call: Document, files: Files<'_>) -> Result<Answer, Refusal> {
    let name = call.text("name")?.unwrap_or_default();
    let model = call.text("model")?;
    let rate_hz = call.number("rate")?.unwrap_or(RATE_HZ);
    let within_db = call.number("within")?.unwrap_or(WITHIN_DB);
    let grid = call.object("grid")?;
    call.finish()?;
    if !(within_db > 0.0 && within_db.is_finite()) {
        return Err(Refusal::argument("within is a number of dB above 0"));
    }
    let [bytes] = files else {
        return Err(Refusal::argument("give one texture"));
    };
    let asset = Texture::new(Asset::from_bytes(bytes)?);
    let representation = asset.representation(model.as_deref())?;
    let grid = given(grid)?.map_or_else(|| Grid::for_default_condition(representation), Ok)?;
    let baked = baked(representation, &grid, rate_hz, within_db)?;
    Answer::new(&block(&baked, &name, rate_hz), baked.bytes.clone())
}

fn block<'a>(baked: &'a BakeResult, name: &str, rate_hz: f64) -> Block<'a> {
    Block {
        model: &baked.model,
        quantity: baked.quantity,
        unit: baked.quantity.unit(),
        full_scale: baked.full_scale,
        rate_hz,
        speeds: baked.grid.speeds_mm_s(),
        forces: baked.grid.forces_n(),
        error_at_conditions_db: baked.at_conditions_db,
        error_between_db: baked.between_db,
        error_beyond_db: baked.beyond_db,
        c: c_header(&c_name(name), baked),
        rust: rust_source(&rust_name(name), baked),
    }
}

/// Returns the grid of speeds and forces, if one is given.
fn given(mut grid: Document) -> Result<Option<Grid>, Refusal> {
    let (speeds, forces) = (grid.list("speed")?, grid.list("force")?);
    grid.finish()?;
    if speeds.is_empty() && forces.is_empty() {
        return Ok(None);
    }
    Ok(Some(Grid::new(numbers(&speeds)?, numbers(&forces)?)?))
}

fn numbers(all: &[Value]) -> Result<Vec<f64>, Refusal> {
    let numbers: Option<Vec<f64>> = all.iter().map(number).collect();
    numbers.ok_or_else(|| Refusal::argument("speeds and forces of a grid are numbers"))
}

impl From<htex::Error> for Refusal {
    fn from(error: htex::Error) -> Self {
        match error {
            htex::Error::Model(error) => error.into(),
            other => Self::argument(other),
        }
    }
}
