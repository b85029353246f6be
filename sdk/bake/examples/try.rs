use htex_bake::{Grid, bake};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let asset = htex_play::Asset::open(&args[1]).unwrap();
    let nums = |s: &str| s.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
    let grid = Grid::new(nums(&args[2]), nums(&args[3])).unwrap();
    for model in args[4..].iter() {
        let t = std::time::Instant::now();
        let b = bake(&asset, Some(model), &grid, 8000.0, 0.3).unwrap();
        println!("{model} {} bytes {} taps {} filters {} conditions at {:.3} between {:.3} beyond {:?} in {:.2} s internal {:.0} law {:?}",
            b.bytes.len(), b.taps, b.filters, b.grid.motions().count(), b.at_conditions_db, b.between_db, b.beyond_db, t.elapsed().as_secs_f64(), b.internal_rate_hz, b.law);
    }
}
