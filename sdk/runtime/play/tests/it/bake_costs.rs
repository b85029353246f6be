//! Tests that `docs/microcontroller.md` states the instructions and the memory that a block takes
//! on a Cortex-M4F, for all models and all surfaces of the simulator.

use crate::bake_common as common;
use crate::compilers;

use std::fmt::Write;
use std::path::Path;

use common::asset_of;
use compilers::{CORTEX_M4F, has};
use htex_author::simulate::Surface;
use htex_play::Registry;
use htex_play::bake::{BakeResult, Grid, bake};
use xtask::generated::{is_written, section_with};
use xtask::needs::{ARM_GCC, QEMU_ARM};

const PAGE: &str = "docs/microcontroller.md";
const RATE_HZ: f64 = 8_000.0;
/// The surface for which `docs/microcontroller.md` states all costs.
const TOLD: Surface = Surface::CoarseFabric;
/// Largest number of instructions per sample.
const MOST: u32 = 700;
/// Largest number of instructions to set the same motion again.
const MOST_AGAIN: u32 = 80;
/// Relative difference that other versions of the compiler may have.
const TOLERANCE: f64 = 0.05;

/// Instructions and bytes, in the order in which `c/tests/cost.c` prints them.
struct Cost {
    sample: u32,
    gliding: u32,
    motion: u32,
    again: u32,
    bytes: u32,
}

impl Cost {
    fn of(program: &Path, block: &[u8]) -> Self {
        let output = CORTEX_M4F.run(program, block);
        let number = |label: &str| {
            let line = output.lines().find_map(|line| line.strip_prefix(label));
            line.unwrap_or_else(|| unreachable!("no {label} in {output}")).parse().unwrap()
        };
        Self {
            sample: number("sample "),
            gliding: number("gliding "),
            motion: number("motion "),
            again: number("again "),
            bytes: number("bytes "),
        }
    }
}

type Row = (&'static str, BakeResult, Cost);

/// Returns the costs of the blocks of all models for a surface, on the grid that the page states.
fn costs(surface: Surface) -> Vec<Row> {
    let name = format!("cost-{surface}");
    let ram = "-Wl,--defsym=ram=128K";
    let program = CORTEX_M4F.program(&["cost.c", "board.c"], ram, &name);
    let asset = asset_of(surface);
    let grid = Grid::new(vec![40.0, 100.0, 160.0], vec![0.2, 0.4, 0.6]).unwrap();
    let row = |model| {
        let baked = bake(asset.representation(model).unwrap(), &grid, RATE_HZ, 0.3).unwrap();
        let cost = Cost::of(&program, &baked.bytes);
        (model, baked, cost)
    };
    Registry::placeless_names().into_iter().map(row).collect()
}

/// The table of the costs of one surface, with a row for each model.
fn table_of(rows: &[Row]) -> String {
    let mut text = "| model | block | filter | filters mixed | one sample | while a motion changes | to set a motion | RAM |\n\
                    |---|---|---|---|---|---|---|---|\n"
        .to_owned();
    for (model, baked, cost) in rows {
        let (kind, filters) = match baked.taps {
            0 => (format!("{} sinusoids", baked.tones), String::new()),
            taps => (format!("{taps} coefficients"), baked.filters.to_string()),
        };
        let kilobytes = baked.bytes.len() as f64 / 1000.0;
        let Cost { sample, gliding, motion, bytes, .. } = cost;
        let _ = writeln!(
            text,
            "| {model} | {kilobytes:.1} kB | {kind} | {filters} | {sample} | {gliding} | {motion} | {bytes} bytes |"
        );
    }
    text
}

/// The table of the costs per sample of all surfaces, with a row for each model and a column for
/// each surface.
fn table_of_all(all: &[(Surface, Vec<Row>)]) -> String {
    let names = all.iter().map(|(surface, _)| surface.name());
    let names: Vec<&str> = names.collect();
    let mut text =
        format!("| model | {} |\n|{}\n", names.join(" | "), "---|".repeat(names.len() + 1));
    for (i, model) in Registry::placeless_names().into_iter().enumerate() {
        let cells = all.iter().map(|(_, rows)| rows[i].2.sample.to_string());
        let _ = writeln!(text, "| {model} | {} |", cells.collect::<Vec<_>>().join(" | "));
    }
    text
}

/// Whether two texts are equal, apart from numbers that differ by at most the tolerance.
fn is_near(kept: &str, measured: &str) -> bool {
    let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let (kept, measured) = (words(kept), words(measured));
    let near = |(a, b): (&String, &String)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= TOLERANCE * b,
        _ => a == b,
    };
    kept.len() == measured.len() && kept.iter().zip(&measured).all(near)
}

#[test]
fn generated_costs_are_those_of_the_page_and_within_the_limit() {
    if !(QEMU_ARM.met(has("qemu-system-arm")) && ARM_GCC.met(has("arm-none-eabi-gcc"))) {
        return;
    }
    // Measuring all surfaces takes minutes.
    let takes_all = xtask::prove::whole() || is_written();
    let taken = |surface: &Surface| takes_all || *surface == TOLD;
    let all: Vec<(Surface, Vec<Row>)> = std::thread::scope(|scope| {
        let surfaces = Surface::ALL.into_iter().filter(taken);
        let threads: Vec<_> =
            surfaces.map(|surface| scope.spawn(move || (surface, costs(surface)))).collect();
        let joined = threads.into_iter().map(|thread| thread.join().unwrap());
        joined.collect()
    });
    for (surface, rows) in &all {
        for (model, _, cost) in rows {
            let Cost { sample, again, .. } = cost;
            assert!((50..=MOST).contains(sample), "{surface} {model}: {sample}");
            assert!(*again <= MOST_AGAIN, "{surface} {model}: {again}");
        }
    }
    let told = all.iter().find(|(surface, _)| *surface == TOLD).unwrap();
    let mut tables = vec![("costs of a surface", table_of(&told.1))];
    if takes_all {
        tables.push(("costs of all surfaces", table_of_all(&all)));
    }
    for (name, text) in &tables {
        section_with(PAGE, name, text, |kept| is_near(kept, text));
    }
}
