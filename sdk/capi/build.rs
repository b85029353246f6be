//! The name by which programs find the shared library.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let major = std::env::var("CARGO_PKG_VERSION_MAJOR").unwrap_or_default();
    let system = std::env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    let name = match system.as_str() {
        "linux" | "freebsd" => format!("-Wl,-soname,libhtex.so.{major}"),
        "macos" => format!("-Wl,-install_name,@rpath/libhtex.{major}.dylib"),
        _ => return,
    };
    println!("cargo:rustc-cdylib-link-arg={name}");
}
