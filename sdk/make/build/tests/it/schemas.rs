//! The published schemas of recipes and of reports.

#[test]
fn generated_schemas_are_fresh() {
    for (name, schema) in [
        ("recipe-1.json", htex_build::recipe_schema()),
        ("build-report-1.json", htex_build::report_schema()),
        ("registry-entry-1.json", htex_build::registry::entry_schema()),
    ] {
        let text = format!("{schema:#}\n");
        xtask::generated::file(format!("spec/schemas/{name}"), text.as_bytes());
    }
}
