use std::fmt::{Display, Formatter};

use clap::Args;
use htex_exchange::{FORMATS, Format, PROFILES, Reads};
use serde::{Serialize, Serializer};
use serde_json::json;

use crate::failure::Result;
use crate::output::show;

/// List the formats to import and export
///
/// For each format, prints which parts of a texture a file of this format keeps and which parts it
/// loses. Also lists the profiles of actuators for `htex export --profile`.
#[derive(Args)]
pub(crate) struct Formats {
    /// Print JSON instead of lists
    #[arg(long)]
    json: bool,
}

impl Formats {
    pub(crate) fn run(self) -> Result {
        show(&FormatList, self.json)
    }
}

/// The formats and the profiles of actuators.
struct FormatList;

impl Serialize for FormatList {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        json!({ "formats": FORMATS, "profiles": &*PROFILES }).serialize(serializer)
    }
}

impl Display for FormatList {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        for format in FORMATS {
            writeln!(
                f,
                "{:8} {} ({}): {}\n         licence and author: {}\n         keeps {}\n         loses {}",
                format.name,
                format.title,
                format.dotted(),
                ways(format),
                format.rights.place,
                format.keeps,
                format.loses,
            )?;
        }
        writeln!(f, "\nprofiles of actuators:")?;
        for profile in PROFILES.iter() {
            writeln!(f, "{:10} {}", profile.name, profile.title)?;
        }
        Ok(())
    }
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
