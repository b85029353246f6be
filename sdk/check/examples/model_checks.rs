//! Writes `spec/model-checks.md` again.

fn main() -> std::io::Result<()> {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../spec/model-checks.md");
    std::fs::write(page, htex_check::model_checks_page())
}
