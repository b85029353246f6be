//! Measures and prints the costs that are embedded in this crate:
//! `cargo run --release -p htex-scene --example measure_costs -- "name of the machine" > sdk/runtime/scene/src/costs.json`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let machine = std::env::args().nth(1).unwrap_or_default();
    let costs = htex_scene::Costs::measure(&htex_play::Registry::builtin(), &machine)?;
    println!("{}", serde_json::to_string_pretty(&costs)?);
    Ok(())
}
