//! Signed and unsigned models embedded in assets.

use htex::model::Search;
use htex::{Registry, Texture};
use htex_format::signing::SecretKey;
use htex_format::{Manifest, Plugin, Signature};

use crate::block;
use crate::container::container;
use crate::module::{limits, model};
use crate::promise::{findings, sentence};

/// Number of input bytes before the module.
const HEAD: usize = 4;
/// Base of a fuzzed secret key.
const KEY: [u8; 32] = [7; 32];

/// Opens an asset that embeds a model. The head of the input chooses what is signed and what is
/// changed afterwards. The module follows; if it is empty, a valid one is used.
pub fn signed_plugin(input: &[u8]) -> bool {
    let Some((&[how, place, change, key], module)) = input.split_first_chunk::<HEAD>() else {
        return false;
    };
    let sound;
    let module = if module.is_empty() {
        sound = wat::parse_str(model::text("1.0.0", &[], "")).expect("a sound module");
        &sound
    } else {
        module
    };
    let made = Plugin::new(model::ID, "1.0.0", module).signed(&SecretKey::from_bytes(&[key; 32]));
    let (mut plugin, mut stored) = (made.clone(), module.to_vec());
    if how & 1 != 0 {
        alter(how, place, change, &mut plugin, &mut stored);
    }
    let unsigned = how & 2 != 0;
    if unsigned {
        plugin.signature = None;
    }
    let manifest = manifest(plugin.clone());
    let json = serde_json::to_vec(&manifest).expect("a manifest is JSON");
    let name = plugin.file.as_str();
    let entries = [("parameters.bin", &[0u8; 4][..]), (name, &stored[..])];
    let bytes = container(&json, entries);
    let data = match htex_format::Asset::from_bytes(&bytes) {
        Ok(data) => data,
        Err(error) => {
            sentence(&error);
            let as_made = plugin == made && stored == module && module.starts_with(b"\0asm");
            assert!(!as_made, "what was signed is refused: {error}");
            return false;
        }
    };
    findings(&data.notes);
    assert!(stored == data.plugins[0], "another module than was stored");
    assert_eq!(blake3::hash(&stored).to_hex().as_str(), data.manifest.plugins[0].blake3);
    if !unsigned {
        assert_eq!(same_case(&plugin), same_case(&made), "opens, and is not what was signed");
        assert!(stored == module, "opens, and is not the module that was signed");
    }
    load(data);
    true
}

/// Changes one byte of the signature, of the signed text, or of the module, or uses the signature
/// of another version.
fn alter(how: u8, place: u8, change: u8, plugin: &mut Plugin, module: &mut [u8]) {
    let Plugin {
        model, version, blake3, signature: Some(Signature { public_key, ed25519 }), ..
    } = plugin
    else {
        return;
    };
    let text = match (how >> 2) % 7 {
        0 => model,
        1 => version,
        2 => blake3,
        3 => public_key,
        4 => ed25519,
        5 => {
            let other = Plugin::new(model, "1.0.1", module).signed(&SecretKey::from_bytes(&KEY));
            plugin.signature = other.signature;
            return;
        }
        _ => {
            let at = usize::from(place) % module.len();
            module[at] ^= change;
            // An attacker who changes a module can also change its hash.
            if how & 128 != 0 {
                plugin.blake3 = blake3::hash(module).to_hex().to_string();
            }
            return;
        }
    };
    let at = usize::from(place) % text.len();
    let mut changed = text.clone().into_bytes();
    changed[at] = change & 0x7f;
    if let Ok(changed) = String::from_utf8(changed) {
        *text = changed;
    }
}

/// Returns the plugin with its key and signature in lower case, because hexadecimal digits have two
/// cases.
fn same_case(plugin: &Plugin) -> Plugin {
    let mut plugin = plugin.clone();
    if let Some(Signature { public_key, ed25519 }) = &mut plugin.signature {
        public_key.make_ascii_lowercase();
        ed25519.make_ascii_lowercase();
    }
    plugin
}

fn manifest(plugin: Plugin) -> Manifest {
    let registry = Registry::builtin();
    let mut manifest = block::manifest(&registry.models()[0], 1);
    let representation = &mut manifest.representations[0];
    representation.model.clone_from(&plugin.model);
    representation.fields.truncate(1);
    representation.fields[0].list = false;
    representation.fields[0].store = htex_format::StoredAs::F32;
    manifest.plugins = vec![plugin];
    manifest
}

/// Loads the model under tight limits and plays it.
fn load(data: htex_format::Asset) {
    let search = Search::builtin().with_limits(limits()).with_builtin(false);
    let registry = Registry::search(&search).expect("nothing is searched");
    let asset = Texture::with_registry(data, registry).with_embedded();
    let mut block = [f32::NAN; 64];
    match asset.voice(&Default::default()) {
        Ok(mut voice) => {
            if let Err(error) = voice.render(&mut block) {
                sentence(&error);
            }
            assert!(block.iter().all(|x| x.is_finite()));
        }
        Err(error) => sentence(&error),
    }
}
