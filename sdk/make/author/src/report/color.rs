//! Colours: a palette for models and series, and the scales of the heat tables.
//!
//! The hues are based on Okabe and Ito's set. Darker hues replace the light hues, so that every
//! line has a contrast of at least 3 : 1 on white. A viewer with normal, protan, deutan or tritan
//! vision can distinguish the colours of any two models. A simulation after Machado et al. 2009
//! showed this: the CIE76 difference between any two of these colours is about 17 or more.

/// Colour of the recording: dark grey, distinct from the models' colours.
pub(crate) const RECORDING_COLOR: &str = "#4d4d4d";

/// Colours of the models, in the order of their registry; also used for series.
const PALETTE: [&str; 6] = ["#0072b2", "#009e73", "#d55e00", "#7d1f6b", "#5b2c00", "#006b7a"];

/// Colours of models beyond the palette, and of models that are not in the registry.
const OTHERS: [&str; 4] = ["#5b4fc4", "#8a8000", "#2a7f8e", "#5f7a1f"];

/// Returns the colour of the model `short_name` (such as `"sbeta"`). The colour of a built-in model
/// depends on the position of its short name in `builtin`, so the colour is the same in every
/// picture. Any other model gets one of four further colours, chosen by its name.
pub fn model_color(short_name: &str, builtin: &[&str]) -> &'static str {
    let name = short_name.to_ascii_lowercase();
    let place = builtin.iter().position(|known| known.eq_ignore_ascii_case(&name));
    let sum = name.bytes().map(usize::from).sum::<usize>();
    let color = place.and_then(|place| PALETTE.get(place));
    color.unwrap_or(&OTHERS[sum % OTHERS.len()])
}

/// Returns the colour of series number `index`, for series that are not models.
pub fn series_color(index: usize) -> &'static str {
    PALETTE[index % PALETTE.len()]
}

/// A colour: red, green and blue, each from 0 to 255.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rgb(pub(crate) [f64; 3]);

const WHITE: Rgb = Rgb([255.0, 255.0, 255.0]);
const BLACK: Rgb = Rgb([0.0, 0.0, 0.0]);
const PALE: Rgb = Rgb([243.0, 248.0, 252.0]);
const BLUE: Rgb = Rgb([8.0, 81.0, 146.0]);
const ORANGE: Rgb = Rgb([191.0, 84.0, 0.0]);

impl Rgb {
    /// Formats as `#rrggbb`.
    pub(crate) fn hex(self) -> String {
        let [r, g, b] = self.0.map(|part| part.round() as u8);
        format!("#{r:02x}{g:02x}{b:02x}")
    }

    /// Returns black or white, whichever has more contrast on this colour: at least 4.5 : 1.
    pub(crate) fn ink(self) -> &'static str {
        if self.contrast(BLACK) >= self.contrast(WHITE) { "#000" } else { "#fff" }
    }

    fn mix(self, other: Self, amount: f64) -> Self {
        let part = |i: usize| self.0[i] + (other.0[i] - self.0[i]) * amount;
        Self([part(0), part(1), part(2)])
    }

    /// Returns the WCAG 2.1 contrast ratio, 1 to 21.
    fn contrast(self, other: Self) -> f64 {
        let (a, b) = (self.luminance(), other.luminance());
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    /// Returns the WCAG 2.1 relative luminance, 0 to 1.
    fn luminance(self) -> f64 {
        let linear = self.0.map(|part| {
            let part = part / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }
}

/// Returns a shade from light blue (0) to dark blue (1).
pub(crate) fn sequential(amount: f64) -> Rgb {
    PALE.mix(BLUE, amount.clamp(0.0, 1.0))
}

/// Returns a shade from blue (-1) over white to orange (1).
pub(crate) fn diverging(amount: f64) -> Rgb {
    let end = if amount < 0.0 { BLUE } else { ORANGE };
    WHITE.mix(end, amount.abs().min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(hex: &str) -> Rgb {
        let part = |i: usize| f64::from(u8::from_str_radix(&hex[i..i + 2], 16).unwrap());
        Rgb([part(1), part(3), part(5)])
    }

    #[test]
    fn every_line_stands_out_from_white_and_no_two_models_share_a_colour() {
        let mut all: Vec<&str> = PALETTE.into_iter().chain(OTHERS).collect();
        all.push(RECORDING_COLOR);
        for color in &all {
            assert!(parse(color).contrast(WHITE) >= 3.0, "{color}");
        }
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), PALETTE.len() + OTHERS.len() + 1);
    }

    #[test]
    fn a_model_has_the_colour_of_its_place_whatever_its_case() {
        let builtin = ["ar", "sbeta", "", "", "", "", "texel"];
        assert_eq!(model_color("sBeta", &builtin), PALETTE[1]);
        for beyond in ["texel", "mine"] {
            assert!(OTHERS.contains(&model_color(beyond, &builtin)));
        }
    }

    #[test]
    fn text_is_legible_on_every_shade() {
        for step in -100..=100 {
            let amount = f64::from(step) / 100.0;
            for shade in [sequential(amount), diverging(amount)] {
                let ink = if shade.ink() == "#000" { BLACK } else { WHITE };
                assert!(shade.contrast(ink) >= 4.5, "{}", shade.hex());
            }
        }
    }
}
