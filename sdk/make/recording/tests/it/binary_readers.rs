//! Reading recordings as WAV and NPY.

use crate::common::files;

use files::{at, has_warning, mapped, npy, npy_header, read, spec, wav};
use htex_recording::ReadOptions;

#[test]
fn wav_of_one_to_three_channels_and_all_depths() {
    for bits in [8, 16, 24, 32] {
        let bytes = wav(spec(3, bits), &[0.5, -0.25, -0.75, -0.5, 0.25, -0.5]);
        let plain = read("w.wav", &bytes, &ReadOptions::default()).unwrap();
        assert_eq!(plain.axes, [[0.5, -0.5], [-0.25, 0.25]]);
        assert_eq!(plain.normal_n, Some(vec![0.75, 0.5]));
        assert!(plain.rate_hz == 44_100.0 && has_warning(&plain, "give the scale"));
        let options = ReadOptions::default().with_scale(4.0);
        let scaled = read("w.dat", &bytes, &options).unwrap();
        assert_eq!((scaled.axes[0][0], scaled.warnings.len()), (2.0, 0));
    }
    let bytes = wav(spec(1, 16), &[0.1; 100]);
    let cut = read("w.wav", &bytes[..bytes.len() - 41], &ReadOptions::default()).unwrap_err();
    assert!(cut.contains("sample 79"), "{cut}");
    for (bytes, options, words) in [
        (wav(spec(4, 16), &[0.0; 8]), ReadOptions::default(), "4 channels"),
        (wav(spec(1, 32), &[0.0, f64::NAN]), ReadOptions::default(), "NaN at sample 1"),
        (wav(spec(1, 16), &[0.0]), ReadOptions::default(), "at least 2 samples"),
        (bytes[..30].to_vec(), ReadOptions::default(), "not a readable WAV"),
        (b"nonsense".to_vec(), ReadOptions::default(), "not a readable WAV"),
        (
            bytes.clone(),
            mapped("lateral=#2", None),
            "the map's column #2 does not exist; the columns are: ch1",
        ),
        (bytes.clone(), mapped("lateral=#1", None).with_scale(2.0), "put the scale into the map"),
        (bytes.clone(), at(48_000.0), "44100 Hz"),
    ] {
        let error = read("w.wav", bytes, &options).unwrap_err();
        assert!(error.contains(words), "{error}");
    }
}

/// Records are read as the columns of a table: by their names, with integers as they are.
#[test]
fn npy_of_records_is_a_table() {
    let rows = [(0.0_f64, 1_i16, 0.5_f32), (0.1, -2, 0.25), (0.2, 3, -0.5)];
    let header = |fields: &str| {
        format!("{{'descr': [{fields}], 'fortran_order': False, 'shape': (3,), }}\n")
    };
    let fields = "('time_s', '<f8'), ('shape', '>i2'), (\"fx_n\", '<f4')";
    let data: Vec<u8> = rows
        .iter()
        .flat_map(|(t, i, x)| [&t.to_le_bytes()[..], &i.to_be_bytes(), &x.to_le_bytes()].concat())
        .collect();
    let text = "time_s,shape,fx_n\n0,1,0.5\n0.1,-2,0.25\n0.2,3,-0.5\n";
    let options = ReadOptions::default();
    let [records, table] = [("r.npy", npy(&header(fields), &data)), ("r.csv", text.into())]
        .map(|(name, bytes)| read(name, &bytes, &options).unwrap());
    assert_eq!((&records.axes, records.rate_hz), (&table.axes, table.rate_hz));
    assert_eq!(records.axes, [[0.5, 0.25, -0.5]]);
    // Names are Latin-1 up to version 2.
    let mut latin = npy(&header("('time_s', '<f8'), ('\u{b5}', '>i2'), ('fx_n', '<f4')"), &data);
    let at = latin.windows(2).position(|two| two == "\u{b5}".as_bytes()).unwrap();
    latin.remove(at);
    latin[8] -= 1;
    assert_eq!(read("r.npy", &latin, &options).unwrap().axes, records.axes);
    let many = "('a', '<f4'), ".repeat(257);
    for (fields, words) in [
        ("('time_s', '<f8'), ('fx_n', '<f4', (3,))", "holds other records; save fields"),
        ("('time_s', '<f8'), ('fx_n', '<c8')", "f4, f8, i2 or i4"),
        ("(('title', 'time_s'), '<f8')", "holds other records"),
        ("('a\\'b', '<f8')", "holds other records"),
        ("('a', '<f8'", "holds other records"),
        ("'a'", "holds other records"),
        ("", "holds other records"),
        (&many, "expected (n,)"),
    ] {
        let error = read("r.npy", npy(&header(fields), &data), &options).unwrap_err();
        assert!(error.contains(words), "{fields}: {error}");
    }
}

#[test]
fn npy_in_either_order_and_endianness() {
    let rows = [0.5_f32, 0.25, -0.5, -0.25];
    let c: Vec<u8> = rows.iter().flat_map(|x| x.to_le_bytes()).collect();
    let fortran: Vec<u8> =
        [0.5_f64, -0.5, 0.25, -0.25].iter().flat_map(|x| x.to_be_bytes()).collect();
    let integer: Vec<u8> =
        rows.iter().flat_map(|x| ((x * 32_768.0) as i16).to_le_bytes()).collect();
    for bytes in [
        npy(&npy_header("<f4", "False", "(2, 2)"), &c),
        npy(&npy_header(">f8", "True", "(2, 2)"), &fortran),
        npy(&npy_header("<i2", "False", "(2, 2)"), &integer),
    ] {
        let recording = read("n.npy", &bytes, &at(20_000.0)).unwrap();
        assert_eq!(recording.axes, [[0.5, -0.5], [0.25, -0.25]]);
        assert!(
            read("n.npy", &bytes, &ReadOptions::default())
                .unwrap_err()
                .contains("no sample rate; give one")
        );
    }
    let deep = format!("{}1{}", "(".repeat(9000), ")".repeat(9000));
    for (header, words) in [
        (npy_header("<f4", "False", "(9,)"), "after 4 of 9 values"),
        (npy_header("<f4", "False", "(40000000,)"), "after 4 of 40000000"),
        (npy_header("<f4", "False", "(4294967296, 4294967296)"), "not describe a plain array"),
        (npy_header("<f4", "False", "(1, 4)"), "4 channels"),
        (npy_header("<f4", "False", "(1, 4000)"), "shape is [1, 4000]"),
        (npy_header("<f4", "False", "()"), "shape is []"),
        (npy_header("<c8", "False", "(2,)"), "f4, f8, i2 or i4"),
        (npy_header("|O", "False", "(2,)"), "f4, f8, i2 or i4"),
        (npy_header("<f4", "False", &deep), "longer"),
        ("{}".into(), "not an NPY"),
    ] {
        let error = read("n.npy", npy(&header, &c), &at(1.0)).unwrap_err();
        assert!(error.contains(words) || words == "longer" && error.contains("limit"), "{error}");
    }
}
