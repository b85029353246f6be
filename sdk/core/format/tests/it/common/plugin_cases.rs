//! Assets with an invalid embedded module.

use htex_format::{Asset, Plugin};

use super::cases::Named;
use super::parts::{block, parts};
use super::raw_zip::{Entry, archive};
use super::{asset, sbeta};

/// An asset with the (empty) module of its model, signed; `change` is applied after signing.
pub(super) fn with_plugin(change: impl Fn(&mut Asset)) -> Vec<u8> {
    let mut asset = asset(1, vec![sbeta(1)]);
    let module = b"\0asm\x01\0\0\0".to_vec();
    let plugin = Plugin::new("org.htex.sbeta", "1.0.0", &module)
        .signed(&htex_format::signing::SecretKey::from_bytes(&[7; 32]));
    asset.manifest.plugins.push(plugin);
    asset.plugins.push(module);
    change(&mut asset);
    let manifest = serde_json::to_vec(&asset.manifest).unwrap();
    let mut parts = parts(&manifest, &block());
    for (plugin, module) in asset.manifest.plugins.iter().zip(&asset.plugins) {
        parts.push(Entry::stored(&plugin.file, module));
    }
    archive(&parts)
}

pub(super) fn plugins() -> Vec<Named> {
    vec![
        ("plugin_invalid", with_plugin(|a| a.manifest.plugins[0].blake3.make_ascii_uppercase())),
        ("plugin_duplicate", with_plugin(|a| a.manifest.plugins.extend_from_within(..))),
        (
            "plugin_unused",
            with_plugin(|a| {
                let module = &a.plugins[0];
                a.manifest.plugins[0] = Plugin::new("com.example.other", "1.0.0", module);
            }),
        ),
        (
            "plugin_not_wasm",
            with_plugin(|a| {
                a.plugins[0] = b"\x7fELF".to_vec();
                a.manifest.plugins[0] = Plugin::new("org.htex.sbeta", "1.0.0", &a.plugins[0]);
            }),
        ),
        ("plugin_hash_mismatch", with_plugin(|a| a.plugins[0].push(0))),
        (
            "plugin_signature_invalid",
            with_plugin(|a| a.manifest.plugins[0].version = "1.0.1".to_owned()),
        ),
    ]
}
