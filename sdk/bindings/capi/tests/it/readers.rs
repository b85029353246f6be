//! Assets, libraries and scenes that a program reads play like files, and are closed once.

use std::ffi::{CStr, CString, c_char, c_void};
use std::fs;
use std::path::{Path, PathBuf};
use std::ptr::null;
use std::sync::atomic::{AtomicUsize, Ordering};

use htex_c::htex_status::*;
use htex_c::*;

fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../examples/scenes")
}

/// A file of the program. It counts reads and closes, and refuses reads beyond `most` bytes.
struct File {
    bytes: Vec<u8>,
    most: u64,
    reads: AtomicUsize,
    closed: AtomicUsize,
}

impl File {
    fn new(bytes: Vec<u8>) -> Box<Self> {
        Box::new(Self {
            bytes,
            most: u64::MAX,
            reads: AtomicUsize::new(0),
            closed: AtomicUsize::new(0),
        })
    }

    fn reader(&self) -> htex_reader {
        htex_reader {
            size: size_of::<htex_reader>() as u32,
            len: self.bytes.len() as u64,
            context: std::ptr::from_ref(self).cast_mut().cast(),
            read: Some(read),
            close: Some(close),
        }
    }

    fn closed(&self) -> usize {
        self.closed.load(Ordering::Relaxed)
    }
}

unsafe extern "C" fn read(context: *mut c_void, offset: u64, buffer: *mut u8, len: usize) -> i32 {
    // SAFETY: the context is a file.
    let file = unsafe { &*context.cast::<File>() };
    file.reads.fetch_add(1, Ordering::Relaxed);
    if offset + len as u64 > file.most {
        return 5;
    }
    let from = &file.bytes[offset as usize..offset as usize + len];
    // SAFETY: the buffer has as many bytes.
    unsafe { buffer.copy_from_nonoverlapping(from.as_ptr(), len) };
    0
}

unsafe extern "C" fn close(context: *mut c_void) {
    // SAFETY: the context is a file.
    let file = unsafe { &*context.cast::<File>() };
    file.closed.fetch_add(1, Ordering::Relaxed);
}

fn manifest(asset: htex_asset) -> String {
    let mut text = vec![0 as c_char; 1 << 16];
    // SAFETY: live pointers.
    unsafe {
        let status =
            htex_asset_manifest_json(asset, text.as_mut_ptr(), text.len(), std::ptr::null_mut());
        assert_eq!(status, HTEX_STATUS_OK);
        CStr::from_ptr(text.as_ptr()).to_str().unwrap().to_owned()
    }
}

#[test]
fn an_asset_is_read_whole_and_closed() {
    let path = scenes().join("vinyl.htex");
    let mut file = File::new(fs::read(&path).unwrap());
    let path = CString::new(path.to_str().unwrap()).unwrap();
    let (mut read, mut opened) = (htex_asset { id: 0 }, htex_asset { id: 0 });
    // SAFETY: live pointers.
    unsafe {
        let status = htex_asset_open_reader(&file.reader(), null(), &mut read);
        assert_eq!((status, file.closed()), (HTEX_STATUS_OK, 1));
        let status = htex_asset_open(path.as_ptr(), null(), &mut opened);
        assert_eq!(status, HTEX_STATUS_OK);
        assert_eq!(manifest(read), manifest(opened));
        file.most = 100;
        let status = htex_asset_open_reader(&file.reader(), null(), &mut read);
        assert_eq!((status, file.closed()), (HTEX_STATUS_IO, 2));
        // The library does not allocate a length that no asset can have.
        let endless = htex_reader { len: u64::MAX, ..file.reader() };
        let status = htex_asset_open_reader(&endless, null(), &mut read);
        assert_eq!((status, file.closed()), (HTEX_STATUS_IO, 3));
        let small = htex_reader { size: 8, ..file.reader() };
        for (reader, bad) in [(&raw const small, file.closed()), (null(), file.closed())] {
            let status = htex_asset_open_reader(reader, null(), &mut read);
            assert_eq!((status, file.closed()), (HTEX_STATUS_INVALID_ARGUMENT, bad));
        }
    }
}

#[test]
fn a_library_is_read_in_parts_until_it_is_freed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.htexlib");
    let mut writer = htex::library::Writer::create(&path, "A").unwrap();
    let vinyl = fs::read(scenes().join("vinyl.htex")).unwrap();
    writer.add("floor/vinyl", &vinyl).unwrap();
    writer.finish().unwrap();
    let file = File::new(fs::read(&path).unwrap());
    let (mut library, mut asset) = (htex_library { id: 0 }, htex_asset { id: 0 });
    // SAFETY: live pointers.
    unsafe {
        for way in 0..2 {
            let status = match way {
                0 => htex_library_open_reader(&file.reader(), &mut library),
                _ => htex_library_from_bytes(file.bytes.as_ptr(), file.bytes.len(), &mut library),
            };
            assert_eq!(status, HTEX_STATUS_OK);
            let status = htex_library_asset(library, c"floor/vinyl".as_ptr(), null(), &mut asset);
            assert_eq!(status, HTEX_STATUS_OK);
            assert!(manifest(asset).contains("vinyl"));
            assert_eq!(file.closed(), way);
            assert_eq!(htex_library_free(library), HTEX_STATUS_OK);
            assert_eq!(file.closed(), 1);
        }
        assert!(file.reads.load(Ordering::Relaxed) > 0);
        let status = htex_library_from_bytes(vinyl.as_ptr(), vinyl.len(), &mut library);
        assert_eq!(status, HTEX_STATUS_INVALID_LIBRARY);
    }
}

/// Opens files of the example scenes.
unsafe extern "C" fn open_file(
    context: *mut c_void,
    name: *const c_char,
    out: *mut htex_reader,
) -> i32 {
    // SAFETY: the context is a list of files, and the name ends with a zero.
    let (files, name) = unsafe {
        let files = &mut *context.cast::<Vec<Box<File>>>();
        (files, CStr::from_ptr(name).to_str().unwrap())
    };
    let Ok(bytes) = fs::read(scenes().join(name)) else {
        return 1;
    };
    files.push(File::new(bytes));
    // SAFETY: a place for a reader.
    unsafe { *out = files.last().unwrap().reader() };
    0
}

fn rendered(scene: htex_scene) -> Vec<f32> {
    let (mut samples, mut count) = (vec![0.0f32; 4_000], 0);
    // SAFETY: live pointers.
    unsafe {
        let status = htex_scene_render(scene, samples.as_mut_ptr(), samples.len(), &mut count);
        assert_eq!((status, count), (HTEX_STATUS_OK, samples.len()));
    }
    assert_eq!(htex_scene_free(scene), HTEX_STATUS_OK);
    samples
}

#[test]
fn a_scene_in_memory_plays_as_its_file_does() {
    let mut played = 0;
    for entry in fs::read_dir(scenes()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let bytes = fs::read(&path).unwrap();
        let text = CString::new(path.to_str().unwrap()).unwrap();
        let (mut of_file, mut of_memory) = (htex_scene { id: 0 }, htex_scene { id: 0 });
        let mut opened: Vec<Box<File>> = Vec::new();
        let files = htex_files {
            size: size_of::<htex_files>() as u32,
            context: (&raw mut opened).cast(),
            open: Some(open_file),
        };
        // SAFETY: live pointers.
        unsafe {
            if htex_scene_open(text.as_ptr(), null(), null(), &mut of_file) != HTEX_STATUS_OK {
                continue;
            }
            let status = htex_scene_from_bytes(
                bytes.as_ptr(),
                bytes.len(),
                &files,
                null(),
                null(),
                &mut of_memory,
            );
            let error = CStr::from_ptr(htex_last_error());
            assert_eq!(status, HTEX_STATUS_OK, "{}: {error:?}", path.display());
            assert_eq!(rendered(of_memory), rendered(of_file), "{}", path.display());
            assert!(!opened.is_empty() && opened.iter().all(|file| file.closed() == 1));
            let nothing = htex_files { open: None, ..files };
            let status = htex_scene_from_bytes(
                bytes.as_ptr(),
                bytes.len(),
                &nothing,
                null(),
                null(),
                &mut of_memory,
            );
            assert_eq!(status, HTEX_STATUS_INVALID_ARGUMENT);
        }
        played += 1;
    }
    assert!(played > 1, "{played} scenes");
    let missing = br#"{"htex_scene":"1.0","surfaces":[{"asset":"none.htex"}],"motion":"live"}"#;
    let mut opened: Vec<Box<File>> = Vec::new();
    let files = htex_files {
        size: size_of::<htex_files>() as u32,
        context: (&raw mut opened).cast(),
        open: Some(open_file),
    };
    let mut scene = htex_scene { id: 0 };
    // SAFETY: live pointers.
    let status = unsafe {
        htex_scene_from_bytes(missing.as_ptr(), missing.len(), &files, null(), null(), &mut scene)
    };
    assert_eq!(status, HTEX_STATUS_INVALID_SCENE);
}
