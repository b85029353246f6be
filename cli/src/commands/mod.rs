//! The subcommands, one file each, with their arguments and execution.

mod bake;
mod compare;
#[cfg(feature = "wasm")]
mod compile_module;
#[cfg(feature = "terminal")]
mod completions;
#[cfg(feature = "check")]
mod conformance;
mod demo;
mod device;
mod edit;
pub(crate) mod explain;
#[cfg(feature = "exchange")]
mod export;
mod fit;
#[cfg(feature = "exchange")]
mod formats;
mod gain;
mod guard;
#[cfg(feature = "exchange")]
mod import;
mod info;
mod key;
mod lib;
#[cfg(feature = "build")]
mod library_build;
mod make;
#[cfg(feature = "terminal")]
mod manual;
mod mix;
mod plan;
mod play;
mod plugin;
mod process;
#[cfg(feature = "lab")]
mod record;
#[cfg(feature = "build")]
mod registry;
mod render;
#[cfg(feature = "lab")]
mod response;
#[cfg(feature = "schemas")]
mod schema;
mod sign;
mod simulate;
mod spectrum;
#[cfg(feature = "lab")]
mod studio;
#[cfg(feature = "lab")]
mod study;
mod synth;
mod tradeoff;
mod validate;
mod verify;

/// Defines an enum of subcommands, each of which runs itself.
macro_rules! subcommands {
    ($name:ident {
        $($(#[$meta:meta])* $variant:ident($args:ty) $(if $cfg:meta)?,)*
    }) => {
        #[derive(clap::Subcommand)]
        pub(crate) enum $name {
            $($(#[$meta])* $(#[cfg($cfg)])? $variant($args),)*
        }

        impl $name {
            pub(crate) fn run(self) -> crate::failure::Result {
                match self {
                    $($(#[cfg($cfg)])? Self::$variant(args) => args.run(),)*
                }
            }
        }
    };
}
use subcommands;

subcommands! {
    Command {
        Demo(demo::Demo),
        Simulate(simulate::Simulate),
        Process(process::Process),
        Record(Box<record::Record>) if feature = "lab",
        Response(Box<response::Response>) if feature = "lab",
        Fit(Box<fit::Fit>),
        Info(info::Info),
        Edit(edit::Edit),
        Validate(validate::Validate),
        Explain(explain::Explain),
        Spectrum(spectrum::Spectrum),
        Synth(synth::Synth),
        Bake(bake::Bake),
        Build(library_build::Build) if feature = "build",
        Make(make::Make),
        Mix(mix::Mix),
        Import(Box<import::Import>) if feature = "exchange",
        Export(export::Export) if feature = "exchange",
        Formats(formats::Formats) if feature = "exchange",
        Compare(compare::Compare),
        Tradeoff(tradeoff::Tradeoff),
        Studio(studio::Studio) if feature = "lab",
        Study(study::Study) if feature = "lab",
        Plan(plan::Plan),
        Render(render::Render),
        Play(play::Play),
        Gain(gain::Gain),
        Guard(guard::Guard),
        CompileModule(compile_module::CompileModule) if feature = "wasm",
        Lib(lib::Lib),
        Completions(completions::Completions) if feature = "terminal",
        Man(manual::Manual) if feature = "terminal",
        Schema(schema::Schema) if feature = "schemas",
        Conformance(conformance::Conformance) if feature = "check",
        Key(key::Key),
        Sign(sign::Sign),
        Verify(verify::Verify),
        Plugin(plugin::Plugin),
        Registry(registry::Registry) if feature = "build",
        Device(device::Device),
    }
}
