use clap::Args;
use htex_exchange::{FORMATS, Format, PROFILES, Reads};
use serde_json::json;

use crate::exit::Exit;
use crate::failure::Failure;
use crate::output::{print, print_json};

/// List the formats to import and export
///
/// Prints what each format keeps and loses, and the profiles of actuators.
#[derive(Args)]
pub(crate) struct Formats {
    /// Print JSON instead of lists
    #[arg(long)]
    json: bool,
}

impl Formats {
    pub(crate) fn run(self) -> Result<Exit, Failure> {
        if self.json {
            print_json(&json!({ "formats": FORMATS, "profiles": &*PROFILES }))?
        } else {
            print(&text())?
        }
        Ok(Exit::SUCCESS)
    }
}

fn text() -> String {
    let mut text = String::new();
    for format in FORMATS {
        text += &format!(
            "{:8} {} ({}): {}\n         licence and author: {}\n         keeps {}\n         loses {}\n",
            format.name,
            format.title,
            format.dotted(),
            ways(format),
            format.rights.place,
            format.keeps,
            format.loses,
        );
    }
    text += "\nprofiles of actuators:\n";
    for profile in PROFILES.iter() {
        text += &format!("{:10} {}\n", profile.name, profile.title);
    }
    text
}

/// Says in words how files of this format are imported and exported.
fn ways(format: &Format) -> String {
    let import = format.reads.as_ref().map(|reads| match reads {
        Reads::Asset(_) => "import",
        Reads::Map => "import with --full-scale, --speed, --force and --pitch",
        _ => "import with --full-scale, --speed and --force",
    });
    let ways = [import, format.writes.map(|_| "export")];
    Vec::from_iter(ways.into_iter().flatten()).join("; ")
}
