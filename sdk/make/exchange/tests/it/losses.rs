//! The generated parts of `docs/exchange.md`: the formats, the profiles, and what five textures
//! lose.

use crate::textures;

use htex_author::simulate::Surface;
use htex_exchange::{Coding, Export, Format, Loss, Profile, export, formats_table, profiles_table};
use textures::texture;

const PAGE: &str = "docs/exchange.md";
/// Three actuators that can play every format.
const PROFILES: [&str; 3] = ["quest", "lra-175", "console"];
/// Formats, with the codings of `.hjif`.
const WAYS: [(&str, Option<Coding>); 6] = [
    ("haptic", None),
    ("ahap", None),
    ("android", None),
    ("hjif", Some(Coding::Vectorial)),
    ("hjif", Some(Coding::Wavelet)),
    ("wav", None),
];

#[test]
fn generated_formats_are_fresh() {
    xtask::generated::section(PAGE, "formats", &formats_table());
}

#[test]
fn generated_profiles_are_fresh() {
    xtask::generated::section(PAGE, "profiles", &profiles_table());
}

fn way(format: &str, coding: Option<Coding>) -> String {
    match coding {
        None => format!("`{format}`"),
        Some(Coding::Vectorial) => format!("`{format}`, vectorial"),
        Some(Coding::Wavelet) => format!("`{format}`, wavelet"),
    }
}

#[test]
fn generated_losses_are_fresh() {
    let mut text = String::from("| texture | format |");
    text += &PROFILES.map(|name| format!(" `{name}` |")).concat();
    text += "\n|---|---|---|---|---|\n";
    for surface in Surface::ALL {
        let asset = texture(surface);
        for (format, coding) in WAYS {
            text += &format!("| {surface} | {} |", way(format, coding));
            for name in PROFILES {
                let mut how = Export::new(Format::find(format).unwrap());
                how = how.with_profile(Profile::find(name).unwrap());
                how.coding = coding;
                text += &cell(&export(&asset, &how).unwrap().lost.unwrap());
            }
            text.push('\n');
        }
    }
    xtask::generated::section(PAGE, "losses", &text);
}

fn cell(lost: &Loss) -> String {
    let felt = &lost.difference.felt.error;
    format!(" {:.1}, {:+.1} |", felt.error_rms_db, lost.level_db)
}
