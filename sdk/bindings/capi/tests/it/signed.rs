//! `only_signed_by`: what none of the keys signed is not opened, from wherever it comes.

use std::ffi::{CStr, CString, c_char};
use std::fs;
use std::path::Path;
use std::ptr::null;

use htex::format::signing::{PublicKey, SecretKey, SignedContent, signature_path};
use htex::library::{Library, Writer};
use htex_c::htex_status::*;
use htex_c::*;

fn text(path: &Path) -> CString {
    CString::new(path.to_str().unwrap()).unwrap()
}

/// The options that require one of two keys, and have a signature.
fn options(keys: &[*const c_char; 2], signature: &[u8]) -> htex_open_options {
    htex_open_options {
        size: size_of::<htex_open_options>() as u32,
        engine: 0,
        plugins: null(),
        plugins_len: 0,
        modules: null(),
        modules_len: 0,
        cache: null(),
        no_embedded: 0,
        installed: 0,
        only_signed_by: keys.as_ptr(),
        only_signed_by_len: keys.len(),
        signature: htex_bytes { data: signature.as_ptr(), len: signature.len() },
    }
}

/// A signed asset, a signed library, and scenes of both.
struct Signed {
    folder: tempfile::TempDir,
    asset: Vec<u8>,
    asset_signature: Vec<u8>,
    library: Vec<u8>,
    library_signature: Vec<u8>,
}

impl Signed {
    fn new(key: &SecretKey) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../examples/scenes");
        let asset = fs::read(examples.join("vinyl.htex")).unwrap();
        let file = folder.path().join("a.htexlib");
        let mut writer = Writer::create(&file, "A").unwrap();
        writer.add("vinyl", &asset).unwrap();
        writer.finish().unwrap();
        let opened = Library::open(&file).unwrap();
        let sign = |content: SignedContent| content.sign(key).to_json().into_bytes();
        let asset_signature = sign(SignedContent::asset(&asset).unwrap());
        let library_signature = sign(SignedContent::library(&opened).unwrap());
        let library = fs::read(&file).unwrap();
        fs::write(folder.path().join("vinyl.htex"), &asset).unwrap();
        for (scene, name) in [("asset", "vinyl.htex"), ("library", "a.htexlib#vinyl")] {
            let json = format!(
                r#"{{"htex_scene":"1.0","surfaces":[{{"asset":"{name}"}}],"motion":"live"}}"#
            );
            fs::write(folder.path().join(format!("{scene}.json")), json).unwrap();
        }
        let signed = Self { folder, asset, asset_signature, library, library_signature };
        fs::write(signature_path(&signed.path("vinyl.htex")), &signed.asset_signature).unwrap();
        fs::write(signature_path(&file), &signed.library_signature).unwrap();
        signed
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }

    /// The statuses of opening by path (an asset, a library's texture, scenes of both), and from
    /// memory (an asset, a library's texture), where the signatures are given.
    fn statuses(&self, key: PublicKey) -> Vec<htex_status> {
        let other = SecretKey::from_bytes(&[9; 32]).public();
        let keys = [key, other].map(|key| CString::new(key.to_string()).unwrap());
        let keys = [keys[0].as_ptr(), keys[1].as_ptr()];
        let by_path = options(&keys, &[]);
        let mut statuses = Vec::new();
        for name in ["vinyl.htex", "a.htexlib#vinyl"] {
            let (mut asset, path) = (htex_asset { id: 0 }, text(&self.path(name)));
            // SAFETY: live pointers.
            statuses.push(unsafe { htex_asset_open(path.as_ptr(), &by_path, &mut asset) });
        }
        for name in ["asset.json", "library.json"] {
            let (mut scene, path) = (htex_scene { id: 0 }, text(&self.path(name)));
            // SAFETY: live pointers.
            let status = unsafe { htex_scene_open(path.as_ptr(), &by_path, null(), &mut scene) };
            statuses.push(status);
        }
        let path = text(&self.path("a.htexlib"));
        let mut library = htex_library { id: 0 };
        // SAFETY: live pointers.
        assert_eq!(unsafe { htex_library_open(path.as_ptr(), &mut library) }, HTEX_STATUS_OK);
        statuses.push(texture(library, &by_path));
        let (bytes, in_memory) = (&self.asset, options(&keys, &self.asset_signature));
        let mut asset = htex_asset { id: 0 };
        // SAFETY: live pointers.
        statuses.push(unsafe {
            htex_asset_from_bytes(bytes.as_ptr(), bytes.len(), &in_memory, &mut asset)
        });
        let (bytes, in_memory) = (&self.library, options(&keys, &self.library_signature));
        // SAFETY: live pointers.
        let opened = unsafe { htex_library_from_bytes(bytes.as_ptr(), bytes.len(), &mut library) };
        assert_eq!(opened, HTEX_STATUS_OK);
        statuses.push(texture(library, &in_memory));
        statuses
    }
}

fn texture(library: htex_library, options: &htex_open_options) -> htex_status {
    let mut asset = htex_asset { id: 0 };
    // SAFETY: live pointers.
    unsafe { htex_library_asset(library, c"vinyl".as_ptr(), options, &mut asset) }
}

#[test]
fn what_is_not_signed_by_an_accepted_key_is_not_opened() {
    let key = SecretKey::from_bytes(&[7; 32]);
    let mallory = SecretKey::from_bytes(&[8; 32]).public();
    let mut signed = Signed::new(&key);
    assert_eq!(signed.statuses(key.public()), [HTEX_STATUS_OK; 7]);
    assert_eq!(signed.statuses(mallory), [HTEX_STATUS_NOT_SIGNED; 7]);
    // SAFETY: the text of the last error.
    let error = unsafe { CStr::from_ptr(htex_last_error()) }.to_str().unwrap();
    assert!(error.contains("signed by another key"), "{error}");
    for name in ["vinyl.htex", "a.htexlib"] {
        fs::remove_file(signature_path(&signed.path(name))).unwrap();
    }
    signed.asset_signature.clear();
    signed.library_signature.clear();
    assert_eq!(signed.statuses(key.public()), [HTEX_STATUS_NOT_SIGNED; 7]);
}

#[test]
fn options_that_would_have_no_effect_are_refused() {
    let signed = Signed::new(&SecretKey::from_bytes(&[7; 32]));
    let key = CString::new("7".repeat(63)).unwrap();
    let (path, mut asset) = (text(&signed.path("vinyl.htex")), htex_asset { id: 0 });
    let (keys, signature) = ([key.as_ptr(); 2], &signed.asset_signature);
    let malformed = options(&keys, &[]);
    let without_key = htex_open_options { only_signed_by_len: 0, ..options(&keys, signature) };
    for options in [malformed, without_key] {
        // SAFETY: live pointers.
        let status = unsafe { htex_asset_open(path.as_ptr(), &options, &mut asset) };
        assert_eq!(status, HTEX_STATUS_INVALID_ARGUMENT);
    }
}
