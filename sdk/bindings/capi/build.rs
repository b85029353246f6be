//! Sets the name under which programs find the shared library.

/// The major number of `HTEX_API_VERSION`.
const MAJOR: u32 = 1;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let system = std::env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    let name = match system.as_str() {
        "linux" | "freebsd" => format!("-Wl,-soname,libhtex.so.{MAJOR}"),
        "macos" => format!("-Wl,-install_name,@rpath/libhtex.{MAJOR}.dylib"),
        _ => return,
    };
    println!("cargo:rustc-cdylib-link-arg={name}");
}
