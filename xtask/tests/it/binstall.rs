//! The metadata that `cargo binstall` reads from the command's package leads to the archives of a
//! release.

use std::path::Path;

use xtask::platform::{PLATFORMS, System};

#[test]
fn every_platform_has_its_archive() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cli/Cargo.toml");
    let text = std::fs::read_to_string(manifest).unwrap();
    for platform in PLATFORMS {
        let (name, triple) = (platform.name, platform.triple);
        let (ending, format) = match platform.system {
            System::Windows => ("zip", "zip"),
            _ => ("tar.xz", "txz"),
        };
        let expected = format!(
            "[package.metadata.binstall.overrides.{triple}]
pkg-url = \"{{ repo }}/releases/download/v{{ version }}/htex-{{ version }}-{name}.{ending}\"
pkg-fmt = \"{format}\"
bin-dir = \"htex-{{ version }}-{name}/bin/{{ bin }}{{ binary-ext }}\"
"
        );
        assert!(text.contains(&expected), "{expected}");
    }
}
