//! Formatting of sample rates.

/// Formats a sample rate with at most one decimal, or with at most three decimals below 10 Hz:
/// `524.7 Hz`, `20000 Hz`.
pub fn hertz(rate_hz: f64) -> String {
    let text = if rate_hz.abs() < 10.0 { format!("{rate_hz:.3}") } else { format!("{rate_hz:.1}") };
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} Hz")
}

#[cfg(test)]
mod tests {
    use crate::hertz;

    #[test]
    fn rates_have_the_digits_that_mean_something() {
        let cases = [
            (524.716_007_781_031_3, "524.7 Hz"),
            (20_000.0, "20000 Hz"),
            (44_099.96, "44100 Hz"),
            (10.0, "10 Hz"),
            (0.87, "0.87 Hz"),
        ];
        for (rate_hz, text) in cases {
            assert_eq!(hertz(rate_hz), text);
        }
    }
}
