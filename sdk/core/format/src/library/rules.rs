//! The validation rules for libraries, in one table.

use htex_base::finding::{colophon, rule_table, rules_page};

rule_table! {
    LIBRARY_UNRECOGNISED Error:
        "The file does not begin as a library.",
        "Every library begins with the eight bytes 89 48 54 4C 0D 0A 1A 0A.",
        "Check that it is a `.htexlib` file; one that was transferred as text is damaged, so get it again.";
    LIBRARY_TRUNCATED Error:
        "The file is shorter than its header says.",
        "The textures at its end are missing.",
        "Get the file again, or pack it again.";
    LIBRARY_EXTRA_DATA Error:
        "The file has bytes that belong to no part of it.",
        "Bytes that a reader ignores can hide other contents.",
        "Pack the library again.";
    LIBRARY_VERSION_UNSUPPORTED Error:
        "The reader does not support the library's major version.",
        "The same bytes may have another meaning in another major version.",
        "Read it with a program that supports that version, or pack it again.";
    LIBRARY_VERSION_NEWER Info:
        "The library has a newer minor version.",
        "It can be used; what is new in its pages is ignored.",
        "Update the program to use what is new.";
    LIBRARY_HEADER_CHECKSUM Error:
        "The header does not match its checksum.",
        "The file was damaged, or changed by hand.",
        "Get the file again, or pack it again.";
    LIBRARY_HEADER_INVALID Error:
        "The header contradicts itself.",
        "The parts of a library follow each other without gaps, in the order of the header.",
        "Pack the library again.";
    LIBRARY_ENTRIES_TOO_MANY Error:
        "The library has more textures than the limit.",
        "A reader limits what it reads from an untrusted file.",
        "Split the library, or raise `entries` if you trust the file.";
    LIBRARY_LEAVES_TOO_MANY Error:
        "The index has more pages than the limit.",
        "A reader limits what it reads from an untrusted file.",
        "Write larger pages, or raise `leaves` if you trust the file.";
    LIBRARY_PAGE_TOO_LARGE Error:
        "A page of the index is larger than the limit.",
        "A reader limits what it unpacks from an untrusted file, before it unpacks it.",
        "Write smaller pages, or raise `root_bytes` or `leaf_bytes` if you trust the file.";
    LIBRARY_PAGE_CHECKSUM Error:
        "A page of the index does not match its checksum.",
        "The file was damaged, or changed by hand.",
        "Get the file again, or pack it again.";
    LIBRARY_PAGE_CORRUPT Error:
        "A page of the index cannot be unpacked.",
        "Its deflate stream is invalid, or does not have the stated length.",
        "Pack the library again.";
    LIBRARY_PAGE_INVALID Error:
        "A page of the index does not follow the format.",
        "A value ends outside the page, is out of range or is not in its only form.",
        "Pack the library again.";
    LIBRARY_NAME_INVALID Error:
        "A name is not allowed.",
        "Each name is a relative path of a file too, on every system: a name with `..` could write outside a folder, and one with an invisible character could look like another name.",
        "Rename the texture and pack the library again.";
    LIBRARY_NAMES_ALIKE Error:
        "Two names differ only in case or in Unicode normalisation.",
        "Some systems take both for one file, so that one texture would replace the other.",
        "Rename one of the textures and pack the library again.";
    LIBRARY_METADATA_INVALID Error:
        "The library's metadata are not what the format demands.",
        "Programs show them to users, and make links of them.",
        "Describe the library again with `htex lib edit --describe`.";
    LIBRARY_ORDER_INVALID Error:
        "Names are not sorted, or one appears twice.",
        "A reader finds a texture by the order of the names.",
        "Pack the library again.";
    LIBRARY_RANGE_INVALID Error:
        "A texture's bytes are outside of their part of the file, or are not where the texture before it ends.",
        "Textures that overlap, or gaps between them, can hide contents and make a small file a large one.",
        "Pack the library again.";
    LIBRARY_ASSET_TOO_LARGE Error:
        "A texture is larger than the limit.",
        "A reader limits what it reads from an untrusted file.",
        "Make the texture smaller, or raise `asset_bytes` if you trust the file.";
    LIBRARY_OBJECTS_TOO_MANY Error:
        "There are more shared objects than the limit.",
        "A reader limits what it keeps of an untrusted file.",
        "Share fewer objects, or raise `objects` if you trust the file.";
    LIBRARY_RATIO Error:
        "The textures together are larger than the file by more than the limit.",
        "Shared objects make a file smaller; a small file with huge contents is usually an attack.",
        "Raise `ratio` if you trust the file.";
    LIBRARY_ASSET_CHANGED Error:
        "A texture's bytes do not match its hash.",
        "The file was damaged, or changed by hand.",
        "Get the file again, or pack it again.";
    LIBRARY_ASSET_INVALID Error:
        "A texture is not a valid asset.",
        "It can be found and cannot be opened.",
        "Take it out with `htex lib cat`, see `htex validate`, correct it and pack the library again.";
    LIBRARY_ENTRY_WRONG Error:
        "The index states something else of a texture than the texture does.",
        "There is a finding for each of tags, models, conditions, contact, law, licence, author and quantity that differs: searches find the wrong textures.",
        "Pack the library again.";
    LIBRARY_OBJECT_UNUSED Error:
        "Shared bytes are used by no texture.",
        "Bytes that no texture uses can hide other contents.",
        "Pack the library again.";
    LIBRARY_COUNT_WRONG Error:
        "The library states a wrong number of textures or pages.",
        "Programs differ in which of the two they use.",
        "Pack the library again.";
    LIBRARY_INDEX_CHANGED Error:
        "The index does not match its hash.",
        "The hash names the library: two with the same hash have the same textures.",
        "Get the file again, or pack it again.";
}

const HEAD: &str = "\
# Findings of libraries

A finding has a code, a severity, a place and a message. The place is `/header`, `/root`, `/leaves/N`, `/leaves/N/entries/M` or `/spectra/N`, counted
from 0, and empty for the file as a whole. A library is valid when no finding is an error. The meaning of a code never changes.
[htexlib-1.md](htexlib-1.md) is the format.
";

/// Generates the page of all rules: `spec/library-findings.md`.
pub fn findings_page() -> String {
    rules_page(HEAD, RULES) + &colophon("sdk/core/format/src/library/rules.rs")
}
