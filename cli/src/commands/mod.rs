//! The subcommands, one file each, with their arguments and execution.

mod bake;
mod compare;
#[cfg(feature = "wasm")]
mod compile_module;
mod completions;
mod demo;
mod device;
mod edit;
mod explain;
mod export;
mod fit;
mod formats;
mod gain;
mod guard;
mod import;
mod info;
mod lib;
#[cfg(feature = "build")]
mod library_build;
mod make;
mod manual;
mod mix;
mod plan;
mod play;
mod plugin;
mod process;
#[cfg(feature = "lab")]
mod record;
mod render;
#[cfg(feature = "lab")]
mod response;
mod schema;
mod simulate;
mod spectrum;
#[cfg(feature = "lab")]
mod studio;
#[cfg(feature = "lab")]
mod study;
mod synth;
mod tradeoff;
mod validate;

use crate::exit::Exit;
use crate::failure::Failure;

/// All subcommands.
#[derive(clap::Subcommand)]
pub(crate) enum Command {
    Demo(demo::Demo),
    Simulate(simulate::Simulate),
    Process(process::Process),
    #[cfg(feature = "lab")]
    Record(Box<record::Record>),
    #[cfg(feature = "lab")]
    Response(Box<response::Response>),
    Fit(Box<fit::Fit>),
    Info(info::Info),
    Edit(edit::Edit),
    Validate(validate::Validate),
    Explain(explain::Explain),
    Spectrum(spectrum::Spectrum),
    Synth(synth::Synth),
    Bake(bake::Bake),
    #[cfg(feature = "build")]
    Build(library_build::Build),
    Make(make::Make),
    Mix(mix::Mix),
    Import(Box<import::Import>),
    Export(export::Export),
    Formats(formats::Formats),
    Compare(compare::Compare),
    Tradeoff(tradeoff::Tradeoff),
    #[cfg(feature = "lab")]
    Studio(studio::Studio),
    #[cfg(feature = "lab")]
    Study(study::Study),
    Plan(plan::Plan),
    Render(render::Render),
    Play(play::Play),
    Gain(gain::Gain),
    Guard(guard::Guard),
    #[cfg(feature = "wasm")]
    CompileModule(compile_module::CompileModule),
    Lib(lib::Lib),
    Completions(completions::Completions),
    Man(manual::Manual),
    Schema(schema::Schema),
    Plugin(plugin::Plugin),
    Device(device::Device),
}

impl Command {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        match self {
            Self::Demo(args) => args.run(),
            Self::Simulate(args) => args.run(),
            Self::Process(args) => args.run(),
            #[cfg(feature = "lab")]
            Self::Record(args) => args.run(),
            #[cfg(feature = "lab")]
            Self::Response(args) => args.run(),
            Self::Fit(args) => args.run(),
            Self::Info(args) => args.run(),
            Self::Edit(args) => args.run(),
            Self::Validate(args) => args.run(),
            Self::Explain(args) => args.run(),
            Self::Spectrum(args) => args.run(),
            Self::Synth(args) => args.run(),
            Self::Bake(args) => args.run(),
            #[cfg(feature = "build")]
            Self::Build(args) => args.run(),
            Self::Make(args) => args.run(),
            Self::Mix(args) => args.run(),
            Self::Import(args) => args.run(),
            Self::Export(args) => args.run(),
            Self::Formats(args) => args.run(),
            Self::Compare(args) => args.run(),
            Self::Tradeoff(args) => args.run(),
            #[cfg(feature = "lab")]
            Self::Studio(args) => args.run(),
            #[cfg(feature = "lab")]
            Self::Study(args) => args.run(),
            Self::Plan(args) => args.run(),
            Self::Render(args) => args.run(),
            Self::Play(args) => args.run(),
            Self::Gain(args) => args.run(),
            Self::Guard(args) => args.run(),
            #[cfg(feature = "wasm")]
            Self::CompileModule(args) => args.run(),
            Self::Lib(args) => args.run(),
            Self::Completions(args) => args.run(),
            Self::Man(args) => args.run(),
            Self::Schema(args) => args.run(),
            Self::Plugin(args) => args.run(),
            Self::Device(args) => args.run(),
        }
    }
}
