meta:
  id: htexlib
  title: Library of htex textures
  file-extension: htexlib
  license: MIT OR Apache-2.0
  endian: le
doc: |
  The index of a `.htexlib` file (htexlib-1.md): the header, the root page, the leaf pages with their
  entries, and the pages of spectra. A texture is its own bytes in the payload, with shared objects
  inserted; each texture is an `.htex` file.

  Pages are raw deflate streams (RFC 1951). The program supplies the routine `raw_deflate`, which
  unpacks at most as many bytes as `len_contents` says. Checksums and hashes are not checked here.
seq:
  - id: header
    size: 128
    type: header
instances:
  root_page:
    pos: header.root.first
    size: header.root.length
    type: root_page
  leaves:
    pos: header.leaves.first
    size: header.leaves.length
    type: leaf_pages
  spectra:
    pos: header.shared.first + header.shared.length - root_page.contents.len_spectra
    size: root_page.contents.len_spectra
    type: spectra_pages
    if: header.minor >= 1
enums:
  contact:
    0: finger
    1: tool
    2: unknown
  source:
    0: measured
    1: given
    2: assumed
  quantity:
    0: lateral_force
    1: normal_force
    2: acceleration
    3: velocity
    4: displacement
types:
  header:
    seq:
      - id: magic
        contents: [0x89, HTL, 0x0d, 0x0a, 0x1a, 0x0a]
      - id: major
        type: u2
        valid: 1
      - id: minor
        type: u2
      - id: reserved
        size: 4
      - id: root
        type: part
      - id: leaves
        type: part
      - id: shared
        type: part
      - id: payload
        type: part
      - id: num_entries
        type: u8
      - id: num_leaves
        type: u4
      - id: hash_index
        size: 32
        doc: BLAKE3 of the root and the leaves.
      - id: crc
        type: u4
        doc: CRC-32 of the bytes before it.
  part:
    seq:
      - id: first
        type: u8
      - id: length
        type: u8
  root_page:
    seq:
      - id: crc
        type: u4
      - id: len_contents
        type: u4
      - id: contents
        size-eos: true
        process: raw_deflate(len_contents)
        type: root_contents
  leaf_pages:
    seq:
      - id: pages
        size: _root.root_page.contents.lengths[_index].value
        type: leaf_page
        repeat: expr
        repeat-expr: _root.root_page.contents.num_leaves.value
  leaf_page:
    seq:
      - id: crc
        type: u4
      - id: len_contents
        type: u4
      - id: contents
        size-eos: true
        process: raw_deflate(len_contents)
        type: leaf_contents
  spectra_pages:
    seq:
      - id: pages
        size: _root.root_page.contents.spectra[_index].length.value
        type: spectra_page
        repeat: expr
        repeat-expr: _root.root_page.contents.num_leaves.value
        doc: One for each leaf; that of a leaf without spectra is empty.
  spectra_page:
    seq:
      - id: crc
        type: u4
        if: not _io.eof
      - id: len_contents
        type: u4
        if: not _io.eof
      - id: contents
        size-eos: true
        process: raw_deflate(len_contents)
        type: spectra_contents
        if: not _io.eof
  root_contents:
    seq:
      - id: name
        type: text
      - id: num_leaves
        type: varint
      - id: separators
        type: following_text
        repeat: expr
        repeat-expr: num_leaves.value
      - id: lengths
        type: varint
        repeat: expr
        repeat-expr: num_leaves.value
      - id: len_metadata
        type: varint
        if: _root.header.minor >= 1
      - id: metadata
        type: str
        encoding: UTF-8
        size: len_metadata.value
        if: _root.header.minor >= 1
        doc: A JSON object.
      - id: spectra
        type: 'summed(_index == 0 ? 0 : spectra[_index - 1].sum)'
        repeat: expr
        repeat-expr: num_leaves.value
        if: _root.header.minor >= 1
        doc: Lengths of the pages of spectra.
      - id: hash_spectra
        size: 32
        if: _root.header.minor >= 1
    instances:
      len_spectra:
        value: 'num_leaves.value == 0 ? 0 : spectra.last.sum'
        if: _root.header.minor >= 1
  summed:
    doc: A length, and the sum of the lengths up to it.
    params:
      - id: before
        type: u8
    seq:
      - id: length
        type: varint
    instances:
      sum:
        value: before + length.value
  leaf_contents:
    doc: The entries in columns. Indices of words and rights count from 0.
    seq:
      - id: num_entries
        type: varint
      - id: num_words
        type: varint
      - id: words
        type: text
        repeat: expr
        repeat-expr: num_words.value
      - id: names
        type: following_text
        repeat: expr
        repeat-expr: num_entries.value
      - id: tags
        type: word_list
        repeat: expr
        repeat-expr: num_entries.value
      - id: models
        type: word_list
        repeat: expr
        repeat-expr: num_entries.value
      - id: conditions
        type: motion_range
        repeat: expr
        repeat-expr: num_entries.value
      - id: laws
        type: law
        repeat: expr
        repeat-expr: num_entries.value
      - id: start
        type: varint
        doc: First own byte of the first entry, from the start of the payload.
      - id: lengths
        type: varint
        repeat: expr
        repeat-expr: num_entries.value
        doc: Number of own bytes of each entry.
      - id: objects
        type: object_list
        repeat: expr
        repeat-expr: num_entries.value
      - id: hashes
        size: 32
        repeat: expr
        repeat-expr: num_entries.value
        doc: BLAKE3 of each texture.
      - id: num_rights
        type: varint
        if: _root.header.minor >= 1
      - id: rights
        type: text
        repeat: expr
        repeat-expr: num_rights.value
        if: _root.header.minor >= 1
      - id: licences
        type: varint
        repeat: expr
        repeat-expr: num_entries.value
        if: _root.header.minor >= 1
        doc: 0, or one more than an index of the rights.
      - id: authors
        type: varint
        repeat: expr
        repeat-expr: num_entries.value
        if: _root.header.minor >= 1
        doc: 0, or one more than an index of the rights.
      - id: quantities
        type: u1
        enum: quantity
        repeat: expr
        repeat-expr: num_entries.value
        if: _root.header.minor >= 1
      - id: felt
        type: varint
        repeat: expr
        repeat-expr: num_entries.value
        if: _root.header.minor >= 1
        doc: 0, or one more than the felt difference in hundredths of a decibel.
      - id: held_out
        type: varint
        repeat: expr
        repeat-expr: num_entries.value
        if: _root.header.minor >= 1
        doc: 0, or one more than the held-out error in hundredths of a decibel.
  spectra_contents:
    seq:
      - id: num_entries
        type: varint
      - id: known
        type: u1
        repeat: expr
        repeat-expr: num_entries.value
        doc: 1 if the entry has a spectrum, else 0.
      - id: spectra
        type: spectrum
        repeat: eos
  spectrum:
    seq:
      - id: largest_db
        type: f4
      - id: levels
        size: 48
        doc: Each level is (255 - byte) * 40 / 255 dB below the largest; 0 is 40 dB below or less.
  varint:
    doc: An unsigned integer in LEB128, here below 2^63.
    seq:
      - id: groups
        type: u1
        repeat: until
        repeat-until: _ < 128
    instances:
      len:
        value: groups.size
      value:
        value: >-
          (groups[0] % 128)
          + (len > 1 ? (groups[1] % 128) * 128 : 0)
          + (len > 2 ? (groups[2] % 128) * 16384 : 0)
          + (len > 3 ? (groups[3] % 128) * 2097152 : 0)
          + (len > 4 ? (groups[4] % 128) * 268435456 : 0)
          + (len > 5 ? (groups[5] % 128) * 34359738368 : 0)
          + (len > 6 ? (groups[6] % 128) * 4398046511104 : 0)
          + (len > 7 ? (groups[7] % 128) * 562949953421312 : 0)
          + (len > 8 ? (groups[8] % 128) * 72057594037927936 : 0)
  text:
    seq:
      - id: len
        type: varint
      - id: value
        type: str
        encoding: UTF-8
        size: len.value
  following_text:
    doc: The start that it shares with the text before it in its column, and the bytes after that.
    seq:
      - id: len_common
        type: varint
      - id: len_rest
        type: varint
      - id: rest
        size: len_rest.value
  word_list:
    seq:
      - id: len
        type: varint
      - id: words
        type: varint
        repeat: expr
        repeat-expr: len.value
  motion_range:
    seq:
      - id: flags
        type: u1
        valid:
          max: 15
      - id: least_speed
        type: f8
        if: flags & 1 != 0
      - id: greatest_speed
        type: f8
        if: flags & 5 == 1
      - id: least_force
        type: f8
        if: flags & 2 != 0
      - id: greatest_force
        type: f8
        if: flags & 10 == 2
  law:
    seq:
      - id: flags
        type: u1
      - id: frequency_speed
        type: f8
      - id: level_speed
        type: f8
      - id: level_force
        type: f8
    instances:
      contact:
        value: flags & 3
        enum: contact
      source_frequency_speed:
        value: (flags >> 2) & 3
        enum: source
      source_level_speed:
        value: (flags >> 4) & 3
        enum: source
      source_level_force:
        value: (flags >> 6) & 3
        enum: source
  object_list:
    seq:
      - id: len
        type: varint
      - id: objects
        type: shared_object
        repeat: expr
        repeat-expr: len.value
  shared_object:
    seq:
      - id: gap
        type: varint
        doc: Own bytes between the object before it, or the start, and this one.
      - id: first
        type: varint
        doc: First byte, from the start of the shared part.
      - id: length
        type: varint
