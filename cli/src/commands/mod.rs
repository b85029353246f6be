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

/// Defines an enum of subcommands, each of which runs itself. In a program without a subcommand's
/// feature, the subcommand is hidden and says so.
macro_rules! subcommands {
    ($name:ident {
        $($(#[$meta:meta])* $variant:ident($args:ty) $(if feature = $feature:literal)?,)*
    }) => {
        #[derive(clap::Subcommand)]
        pub(crate) enum $name {
            $(
                $(#[$meta])* $(#[cfg(feature = $feature)])?
                $variant($args),
                $(
                    #[cfg(not(feature = $feature))]
                    #[command(hide = true, disable_help_flag = true)]
                    $variant($crate::commands::Absent),
                )?
            )*
        }

        impl $name {
            pub(crate) fn run(self) -> crate::failure::Result {
                match self {
                    $(
                        $(#[cfg(feature = $feature)])?
                        Self::$variant(args) => args.run(),
                        $(
                            #[cfg(not(feature = $feature))]
                            Self::$variant(absent) => absent.run($feature),
                        )?
                    )*
                }
            }
        }
    };
}
use subcommands;

/// This command is not part of this program.
#[derive(clap::Args)]
pub(crate) struct Absent {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<std::ffi::OsString>,
}

impl Absent {
    #[allow(dead_code, reason = "with all features, no command is absent")]
    fn run(self, feature: &str) -> crate::failure::Result {
        Err(crate::failure::Failure::Usage(format!(
            "this program was built without this command; build it with the Cargo feature `{feature}`, which is on by default"
        )))
    }
}

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
