//! Hostile WASM models. Each fault becomes an error of its call, within the time limit, and names
//! the model, the call and the reason. The host, the model's other voices and its later calls
//! continue.

use crate::common;

use std::time::{Duration, Instant};

use common::{ID, SAMPLE, limits, load, load_within, text, with_descriptor};
use htex_host::{Band, FitCondition, FitInput, HostError, LoadedModel, ModelVoice};

const BAND: Band = Band::TACTILE;

fn fit(model: &LoadedModel) -> Result<(), HostError> {
    let request = FitInput {
        band: BAND,
        frequency_hz: &[20.0, 25.0],
        magnitude: &[1.0, 1.0],
        signal: &[],
        signal_rate_hz: 2000.0,
        options: &[],
        condition: FitCondition::default(),
    };
    model.fit(&request).map(drop)
}

fn voice(model: &LoadedModel) -> Result<ModelVoice, HostError> {
    model.voice(&[0.5], BAND, 2000.0, 1)
}

fn render(voice: &mut ModelVoice) -> Result<(), HostError> {
    let mut out = [f32::NAN; 100];
    let result = voice.render(&mut out);
    let expected = if result.is_ok() { SAMPLE } else { 0.0 };
    assert_eq!(out, [expected; 100]);
    result
}

/// Makes the call of this name.
fn make(call: &str, model: &LoadedModel) -> Result<(), HostError> {
    match call {
        "fit" => fit(model),
        "magnitude" => model.magnitude(&[0.5], BAND, &[50.0]).map(drop),
        "interpolate" => model.interpolate(&[&[0.5]], &[1.0]).map(drop),
        "voice_rate" => model.voice_rate_hz(&[0.5], BAND, 2000.0).map(drop),
        "voice_new" => voice(model).map(drop),
        "voice_render" => render(&mut voice(model)?),
        "voice_retune" => voice(model)?.retune(&[0.5]),
        "voice_free" => voice(model)?.free_and_keep_handle(),
        "extension" => model.has_extension("org.example.x/1").map(drop),
        other => panic!("no call {other}"),
    }
}

const CALLS: [&str; 9] = [
    "fit",
    "magnitude",
    "interpolate",
    "voice_rate",
    "voice_new",
    "voice_render",
    "voice_retune",
    "voice_free",
    "extension",
];

/// Function bodies that trap or do not return, with the text of the expected error.
const HARM: [(&str, &str); 5] = [
    ("(loop $l (br $l)) unreachable", "ran longer than"),
    ("unreachable", "panicked"),
    ("(drop (i32.load (i32.const -4))) unreachable", "out of bounds memory access"),
    ("(drop (memory.grow (i32.const 60000))) unreachable", "67108864 bytes"),
    ("(drop (call $deep (i32.const -1))) unreachable", "bytes of stack"),
];

#[test]
fn harm_in_any_call_is_an_error_of_that_call() {
    for call in CALLS {
        for (body, reason) in HARM {
            let model = load(&[(call, body)]).unwrap();
            let mut other = (!call.starts_with("voice_")).then(|| voice(&model).unwrap());
            let start = Instant::now();
            let error = make(call, &model).unwrap_err().to_string();
            let time = start.elapsed();
            assert!(time < Duration::from_millis(1200), "{call}: {body}: {time:?}");
            assert!(
                error.contains(ID) && error.contains(call) && error.contains(reason),
                "{call}: {body}: {error}"
            );
            other.as_mut().map_or(Ok(()), render).unwrap();
            // Other calls continue with a new shared instance.
            for fine in ["fit", "magnitude", "extension"] {
                assert_eq!(make(fine, &model).is_ok(), fine != call, "{fine} after {call}");
            }
        }
    }
}

#[test]
fn a_voice_that_traps_leaves_the_others_alone() {
    // Counts down while it renders; the retune to 1.0 makes it trap at the next block.
    let model = load_within(
        &text(
            "1.0.0",
            &[
                (
                    "voice_retune",
                    "(global.set $armed (f64.gt (f64.load (local.get 1)) (f64.const 0.9)))
                     (i64.const 0)",
                ),
                (
                    "voice_render",
                    "(if (global.get $armed) (then unreachable))
                     (memory.fill (local.get 1) (i32.const 0x3e)
                       (i32.shl (local.get 2) (i32.const 2)))
                     (i64.const 0)",
                ),
            ],
            "(global $armed (mut i32) (i32.const 0))",
        ),
        &limits(),
    )
    .unwrap();
    let (mut bad, mut good) = (voice(&model).unwrap(), voice(&model).unwrap());
    bad.retune(&[1.0]).unwrap();
    for _ in 0..3 {
        assert!(render(&mut bad).unwrap_err().to_string().contains("panicked"));
        render(&mut good).unwrap();
    }
    // The voice is not called again: the state of its memory is unknown.
    assert!(bad.retune(&[0.0]).is_err());
    render(&mut voice(&model).unwrap()).unwrap();
}

#[test]
fn harm_before_the_first_call_is_an_error_of_loading() {
    let cases =
        [("abi_version", "htex_model_abi_version"), ("descriptor", "htex_model_descriptor")];
    for (function, named) in cases {
        for (body, reason) in HARM {
            let error = load(&[(function, body)]).unwrap_err().to_string();
            assert!(
                error.contains("test.htex") && error.contains(named) && error.contains(reason),
                "{function}: {error}"
            );
        }
    }
    for (body, reason) in HARM {
        let start = format!("(func $start {body}) (start $start)");
        let begun = Instant::now();
        let error = load_within(&text("1.0.0", &[], &start), &limits()).unwrap_err().to_string();
        assert!(begun.elapsed() < Duration::from_millis(1500));
        assert!(
            error.contains("test.htex") && error.contains("start") && error.contains(reason),
            "{error}"
        );
    }
    for body in ["(i32.const -16)", "(i32.const 524272)", "(i32.const 12)", "(i32.const 0)"] {
        let error = load(&[("alloc", body)]).unwrap_err().to_string();
        assert!(error.contains("htex_model_alloc") && error.contains("test.htex"), "{error}");
    }
}

#[test]
fn answers_that_no_model_may_give() {
    let fill = |byte| {
        format!(
            "(memory.fill (local.get 1) (i32.const {byte}) (i32.shl (local.get 2) (i32.const 2)))
             (i64.const 0)"
        )
    };
    let (nan, infinite) = (fill("0xff"), "(f32.store (local.get 1) (f32.const inf)) (i64.const 0)");
    let level = "(f64.store (local.get 12) (f64.const nan)) (i64.const 1)";
    let more = "(i64.add (i64.extend_i32_u (local.get 11)) (i64.const 44))";
    let outside = "(f64.store (local.get 10) (f64.const 7))
                   (f64.store (local.get 12) (f64.const 1)) (i64.const 1)";
    let magnitude = "(f64.store (local.get 5) (f64.const -1)) (i64.const 0)";
    let cases = [
        ("voice_render", nan.as_str(), "NaN"),
        ("voice_render", infinite, "inf"),
        ("voice_render", "(i64.const -99)", "no reason given"),
        ("fit", level, "level is NaN"),
        ("fit", more, "344 parameters"),
        ("fit", "(i64.const 0x7fffffffffffffff)", "parameters"),
        ("fit", outside, "`x`[0] is 7"),
        ("magnitude", magnitude, "-1 at 50 Hz"),
        ("interpolate", "(i64.const 70000)", "70000 parameters"),
        ("voice_rate", "(f64.const nan)", "NaN Hz"),
        ("voice_rate", "(f64.const 1e30)", "Hz"),
        ("voice_new", "(i64.const 0)", "handle 0"),
        ("voice_new", "(i64.const -6)", "no reason given"),
        ("extension", "(i64.const 2)", "returns 2"),
    ];
    for (call, body, reason) in cases {
        let model = load(&[(call, body)]).unwrap();
        let error = make(call, &model).unwrap_err().to_string();
        let named = error.contains(ID) && error.contains(call) && error.contains(reason);
        assert!(named, "{call}: {body}: {error}");
    }
    // The last-error text has an invalid length, or there is no text. In a message, each zero byte
    // is escaped.
    for body in ["(i64.const 0x7fffffffffffffff)", "(i64.const -1)"] {
        let model = load(&[("last_error", body), ("fit", "(i64.const -4)")]).unwrap();
        let error = fit(&model).unwrap_err().to_string();
        assert!(error.contains("fit") && error.len() < 5000, "{error}");
    }
    let stuck = [("last_error", "(loop $l (br $l)) unreachable"), ("fit", "(i64.const -4)")];
    let error = fit(&load(&stuck).unwrap()).unwrap_err().to_string();
    assert!(error.contains("ran longer"), "{error}");
}

#[test]
fn invalid_descriptors() {
    let giant = [("descriptor", "(i64.const 1000000000)")];
    let negative = [("descriptor", "(i64.const -8)")];
    let growing = [("descriptor", "(i64.extend_i32_u (i32.add (local.get 1) (i32.const 9)))")];
    let valid = text("1.0.0", &[], "");
    let option = |name: &str| {
        let values = vec!["0"; 40].join(",");
        format!(
            r#"{{"name":"{name}","unit":"1","min":0,"max":1,"default":0,"sweep":[{values}],"description":"O."}}"#
        )
    };
    let sweeps = format!(
        r#"{{"id":"{ID}","name":"H","version":"1.0.0","summary":"S.","fields":[{{"name":"x","unit":"1","kind":{{"type":"scalar"}},"min":0,"max":1,"store":{{"type":"f32"}},"description":"X."}}],"options":[{},{}]}}"#,
        option("a"),
        option("b")
    );
    let cases = [
        (with_descriptor(&sweeps, &[], ""), "1600 combinations"),
        (text("1.0.0", &giant, ""), "1000000000 bytes"),
        (text("1.0.0", &negative, ""), "no reason given"),
        (text("1.0.0", &growing, ""), "in the next"),
        (text("one", &[], ""), "semantic version"),
        (with_descriptor("\\ff\\fe", &[], ""), "utf-8"),
        (with_descriptor("{", &[], ""), "EOF"),
        (with_descriptor(r#"{"id":1}"#, &[], ""), "string"),
        (valid.replace(ID, "hostile............"), "reverse-DNS"),
        (valid.replace("0x48540100", "0x48540200"), "0x48540200"),
        (valid.replace("0x48540100", "0"), "marker"),
        (valid.replace("htex_model_fit", "fit"), "`htex_model_fit`"),
        (valid.replace("htex_model_alloc", "alloc"), "`htex_model_alloc`"),
        (
            valid.replace("(param i64) (result i64)", "(param i64 i64) (result i64)"),
            "`htex_model_voice_free`",
        ),
        (valid.replace("(export \"memory\") ", ""), "`memory`"),
    ];
    for (wat, reason) in cases {
        let error = load_within(&wat, &limits()).unwrap_err().to_string();
        assert!(error.contains("test.htex") && error.contains(reason), "{reason}: {error}");
    }
}

/// The table in `docs/stability.md` of the versions with which a model may be built.
#[test]
fn the_table_of_versions_is_true() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/stability.md");
    let page = std::fs::read_to_string(page).unwrap();
    let (valid, mut rows) = (text("1.0.0", &[], ""), 0);
    for row in page.lines().filter_map(|line| line.strip_prefix("| ABI ")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        // Other tables have rows about ABIs, too.
        let number = |text: &str| text.parse::<u32>().ok();
        let version = cells[0].split_once('.');
        let version = version.and_then(|(major, minor)| Some((number(major)?, number(minor)?)));
        let Some((major, minor)) = version else { continue };
        let marker = format!("{:#x}", 0x4854_0000 | major << 8 | minor);
        let loaded = load_within(&valid.replace("0x48540100", &marker), &limits());
        assert_eq!(loaded.is_ok(), cells[1].starts_with("loads"), "{row}");
        rows += 1;
    }
    assert_eq!(rows, 3);
}

#[test]
fn imports_and_invalid_modules() {
    let import = "(module (import \"env\" \"clock\" (func)) (memory (export \"memory\") 1))";
    let error = load_within(import, &limits()).unwrap_err().to_string();
    assert!(error.contains("`env.clock`"), "{error}");
    let memory = "(module (import \"env\" \"memory\" (memory 1)) (export \"memory\" (memory 0)))";
    let error = load_within(memory, &limits()).unwrap_err().to_string();
    assert!(error.contains("`env.memory`"), "{error}");
    let whole = wat::parse_str(text("1.0.0", &[], "")).unwrap();
    for bytes in [b"".as_slice(), b"\0asm", b"MZ", &whole[..whole.len() / 2]] {
        let error = LoadedModel::from_wasm_bytes("test.htex", bytes, &limits()).unwrap_err();
        assert!(error.to_string().contains("invalid module"), "{error}");
    }
}
