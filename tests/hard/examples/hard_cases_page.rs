//! Writes `spec/hard-cases.md` again.

fn main() -> std::io::Result<()> {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec/hard-cases.md");
    std::fs::write(page, htex_hard_cases::page())
}
