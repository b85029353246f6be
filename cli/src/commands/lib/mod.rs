//! The subcommand `htex lib` for libraries of textures.

mod cat;
mod diff;
mod find;
mod given;
mod listing;
mod ls;
mod pack;
mod sources;
mod unpack;
mod verify;

use clap::{Args, Subcommand};

pub(super) use verify::check;

use crate::exit::Exit;
use crate::failure::Failure;

/// Pack, list, verify and unpack libraries
///
/// A library is one file (.htexlib) with any number of textures.
///
/// Textures are read one at a time, also over a network (https://, s3://, gs://, az://), where only
/// the needed parts of the file are downloaded. Parts that textures have in common are stored once.
#[derive(Args)]
pub(crate) struct Lib {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Pack(pack::Pack),
    Unpack(unpack::Unpack),
    Ls(ls::Ls),
    Find(find::Find),
    Cat(cat::Cat),
    Diff(diff::Diff),
    Verify(verify::Verify),
}

impl Lib {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        match self.command {
            Command::Pack(args) => args.run(),
            Command::Unpack(args) => args.run(),
            Command::Ls(args) => args.run(),
            Command::Find(args) => args.run(),
            Command::Cat(args) => args.run(),
            Command::Diff(args) => args.run(),
            Command::Verify(args) => args.run(),
        }
    }
}
