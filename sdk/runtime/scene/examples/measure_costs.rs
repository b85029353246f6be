//! Measures the run times of models and stages, and prints the file of costs that this crate
//! embeds: `cargo run --release -p htex-scene --example measure_costs -- "name of the machine" >
//! sdk/runtime/scene/src/costs.json`.

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let machine = std::env::args().nth(1).unwrap_or_default();
    let costs = htex_scene::Costs::measure(&htex_play::Registry::builtin(), &machine)?;
    println!("{}", serde_json::to_string_pretty(&costs)?);
    Ok(())
}
