//! The settings of the command as keywords of the Python package: types and descriptions are those
//! of the flags.

use std::any::TypeId;
use std::path::PathBuf;

use clap::{Arg, ArgAction, Args, Command};
use htex_author::settings::{FitSettings, GivenLaw, Metadata, ReadingSettings};
use htex_lab::response::ResponseSettings;
use xtask::generated::file;

#[test]
fn generated_settings_of_python_are_fresh() {
    let module = [
        "\"\"\"The settings of the command: generated from the definitions of the Rust sources by `cargo xtask generate`.\"\"\"\n\n\
         from __future__ import annotations\n\nimport os\nfrom collections.abc import Mapping, Sequence\n\
         from typing import Annotated, Literal, TypedDict\n"
            .to_owned(),
        // `response` also accepts a measured response.
        class::<ReadingSettings>("ReadingSettings", "How recordings are read.", &["response"]),
        // In Python, `grid` is a mapping.
        class::<FitSettings>("FitSettings", "How models are fitted.", &["grid"]),
        class::<Metadata>("Metadata", "What a texture is, who made it, and how it was recorded.", &[]),
        class::<ResponseSettings>("ResponseSettings", "How a response is measured.", &[]),
    ];
    file("sdk/bindings/python/python/htex/_settings.py", module.join("\n\n").as_bytes());
}

/// A class of keywords, without those that the package defines by itself.
fn class<T: Args>(name: &str, about: &str, own: &[&str]) -> String {
    let command = T::augment_args(Command::new("settings"));
    let flags: Vec<&Arg> = command.get_arguments().collect();
    let shared = flags.iter().filter(|flag| !own.contains(&flag.get_id().as_str()));
    let fields = shared.map(|flag| {
        let (id, kind) = (flag.get_id(), python_type(flag));
        let text = description(flag, &flags);
        format!("    {id}: Annotated[{kind} | None, {text:?}]\n")
    });
    let fields: String = fields.collect();
    format!("class {name}(TypedDict, total=False):\n    \"\"\"{about}\"\"\"\n\n{fields}")
}

fn python_type(flag: &Arg) -> String {
    let kind = flag.get_value_parser().type_id();
    let choices = flag.get_possible_values();
    let one = if matches!(flag.get_action(), ArgAction::SetTrue) {
        "bool".to_owned()
    } else if !choices.is_empty() {
        let names =
            choices.iter().map(|choice| format!("\"{}\"", choice.get_name().replace('-', "_")));
        format!("Literal[{}]", names.collect::<Vec<_>>().join(", "))
    } else if kind == TypeId::of::<f64>() {
        "float".to_owned()
    } else if kind == TypeId::of::<usize>() {
        "int".to_owned()
    } else if kind == TypeId::of::<GivenLaw>() {
        "Mapping[str, float]".to_owned()
    } else if kind == TypeId::of::<PathBuf>() {
        "str | os.PathLike[str]".to_owned()
    } else {
        assert!(kind == TypeId::of::<String>(), "{flag}: a type without a counterpart");
        "str".to_owned()
    };
    match flag.get_action() {
        ArgAction::Append => format!("{one} | Sequence[{one}]"),
        _ => one,
    }
}

/// The help of a flag, with keywords in place of flags, and its default.
fn description(flag: &Arg, flags: &[&Arg]) -> String {
    let mut text = flag.get_help().unwrap().to_string();
    for other in flags {
        let long = format!("--{}", other.get_long().unwrap());
        text = text.replace(&long, &format!("`{}`", other.get_id()));
    }
    let defaults = flag.get_default_values().iter();
    let defaults: Vec<_> =
        defaults.map(|value| value.to_string_lossy().replace('-', "_")).collect();
    if !defaults.is_empty() && !matches!(flag.get_action(), ArgAction::SetTrue) {
        text += &format!(" [default: {}]", defaults.join(", "));
    }
    text
}
