meta:
  id: htex_parameters
  title: Parameter block of an htex asset
  file-extension: bin
  license: MIT OR Apache-2.0
  endian: le
  bit-endian: be
doc: |
  The numbers of one representation of an `.htex` file, as they are stored (htex-1.md, *Stores* and
  *Parameter block*). The manifest says how many conditions there are, and which fields. A number that
  is stored as a step q means `offset + scale * q`, or `exp(offset + scale * q)` with `log`.

  Coded fields (`org.htex.coded/1`) are not described: they are a range code.
params:
  - id: num_conditions
    type: u4
    doc: Number of elements of `at`.
  - id: stores
    type: bytes
    doc: The store of each field, one byte each, from the enumeration `store`.
  - id: lists
    type: bytes
    doc: For each field 1 if it is a list, else 0.
seq:
  - id: conditions
    type: condition
    repeat: expr
    repeat-expr: num_conditions
enums:
  store:
    0: f64
    1: f32
    2: u16
    3: u8
    4: packed
types:
  condition:
    doc: The fields of one condition, in the order of the manifest.
    seq:
      - id: fields
        type: field(_root.stores[_index], _root.lists[_index])
        repeat: expr
        repeat-expr: _root.stores.length
  field:
    params:
      - id: code
        type: u1
      - id: is_list
        type: u1
    seq:
      - id: len_list
        type: length
        if: is_list == 1
      - id: numbers
        type:
          switch-on: store
          cases:
            store::f64: f8
            store::f32: f4
            store::u16: u2
            store::u8: u1
        repeat: expr
        repeat-expr: count
        if: store != store::packed
      - id: packed
        type: packed_list(count)
        if: store == store::packed and count > 0
    instances:
      store:
        value: code
        enum: store
      count:
        value: 'is_list == 1 ? len_list.value : 1'
  length:
    doc: An unsigned integer in its shortest form.
    seq:
      - id: first
        type: u1
        valid:
          max: 0xfd
      - id: two
        type: u2
        if: first == 0xfb
        valid:
          min: 251
      - id: four
        type: u4
        if: first == 0xfc
        valid:
          min: 65536
      - id: eight
        type: u8
        if: first == 0xfd
        valid:
          min: 4294967296
    instances:
      value:
        value: 'first < 0xfb ? first : first == 0xfb ? two : first == 0xfc ? four : eight'
  packed_list:
    doc: |
      Steps from 0 to 255, each as its difference to the one before. The parts are types of their own,
      because bits go on from one part to the next.
    params:
      - id: count
        type: u8
    seq:
      - id: start
        type: packed_start
      - id: rest
        type: 'packed_step(start.k, _index == 0 ? start.first : rest[_index - 1].step)'
        repeat: expr
        repeat-expr: count - 1
      - id: end
        type: packed_end
  packed_start:
    seq:
      - id: k
        type: b3
      - id: first
        type: b8
  packed_step:
    params:
      - id: k
        type: u1
      - id: before
        type: s4
    seq:
      - id: ones
        type: b1
        repeat: until
        repeat-until: not _
        doc: Ones, and the zero that ends them.
      - id: low1
        type: b1
        if: k == 1
      - id: low2
        type: b2
        if: k == 2
      - id: low3
        type: b3
        if: k == 3
      - id: low4
        type: b4
        if: k == 4
      - id: low5
        type: b5
        if: k == 5
      - id: low6
        type: b6
        if: k == 6
      - id: low7
        type: b7
        if: k == 7
    instances:
      low:
        value: 'k == 0 ? 0 : k == 1 ? low1.to_i : k == 2 ? low2 : k == 3 ? low3 : k == 4 ? low4 : k == 5 ? low5 : k == 6 ? low6 : low7'
      z:
        value: ((ones.size - 1) << k) + low
      step:
        value: 'z % 2 == 0 ? before + z / 2 : before - (z + 1) / 2'
  packed_end:
    doc: Nothing; after bits, the next part begins at a byte.
    seq:
      - id: no_bits
        type: b1
        repeat: expr
        repeat-expr: 0
      - id: no_bytes
        size: 0
