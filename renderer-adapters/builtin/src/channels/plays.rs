//! The assignment of signals to channels.

use htex_device::DeviceError;

/// What the channels of a DualSense play: the two channels of its loudspeaker and headset are off,
/// and its two actuators play the texture.
pub(crate) const DUALSENSE: &str = "off,off,texture,texture";
/// Maximum number of channels.
const MOST: usize = 32;

/// Parses a list such as `off,off,texture,-0.5`, with one item for each channel. Returns the factor
/// of each channel, by which the channel multiplies each sample.
///
/// # Errors
/// Returns an error if an item is invalid, or no channel plays.
pub(crate) fn factors(list: &str) -> Result<Vec<f32>, DeviceError> {
    let factors: Vec<f32> = list.split(',').map(factor).collect::<Result<_, _>>()?;
    if factors.len() > MOST {
        return Err(refused(format!("it has {} channels, and {MOST} are the most", factors.len())));
    }
    if factors.iter().all(|factor| *factor == 0.0) {
        Err(refused("no channel plays the texture".to_owned()))
    } else {
        Ok(factors)
    }
}

fn factor(item: &str) -> Result<f32, DeviceError> {
    match item.trim() {
        "off" => Ok(0.0),
        "texture" => Ok(1.0),
        number => match number.parse::<f32>() {
            Ok(factor) if (-1.0..=1.0).contains(&factor) => Ok(factor),
            _ => Err(refused(format!(
                "`{number}` is neither `off` nor `texture` nor a factor of it from -1 to 1"
            ))),
        },
    }
}

fn refused(what: String) -> DeviceError {
    DeviceError::setting("plays", what)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_has_an_item_for_each_channel() {
        assert_eq!(factors(DUALSENSE), Ok(vec![0.0, 0.0, 1.0, 1.0]));
        assert_eq!(factors("texture, -0.5"), Ok(vec![1.0, -0.5]));
        for (list, says) in [
            ("", "neither"),
            ("off,off", "no channel plays"),
            ("0", "no channel plays"),
            ("texture,", "neither"),
            ("1.5", "-1 to 1"),
            ("NaN", "-1 to 1"),
            (&["texture"; 33].join(","), "33 channels"),
        ] {
            let error = factors(list).unwrap_err().to_string();
            assert!(error.starts_with("setting `plays`") && error.contains(says), "{error}");
        }
    }
}
