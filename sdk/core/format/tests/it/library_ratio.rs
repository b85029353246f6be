//! A small file whose textures are large together is refused in the same way by checking and by
//! unpacking.

use crate::library_common as common;

use common::cases::sharing;
use common::pack;
use htex_format::library::{Library, LibraryError, Limits, validate_source};

#[test]
fn what_is_unpacked_is_counted_as_what_is_checked() {
    let bytes = pack("Shared", &sharing()).1;
    for ratio in [0, Limits::default().ratio] {
        let limits = Limits { ratio, ..Limits::default() };
        let checked = validate_source(bytes.as_slice(), &limits).unwrap();
        let library = Library::open_source_with(bytes.as_slice(), limits).unwrap();
        let mut count = library.ratio();
        let unpacked: Result<Vec<()>, LibraryError> =
            library.entries().map(|entry| count.add(&entry?)).collect();
        assert_eq!(checked.valid, unpacked.is_ok());
        match unpacked {
            Err(LibraryError::Invalid { findings }) => {
                assert_eq!(findings[0].code, "LIBRARY_RATIO")
            }
            other => assert!(ratio > 0 && other.is_ok()),
        }
    }
}
