//! Dates of answers: converts milliseconds since 1970 to UTC.

/// Milliseconds of a day.
const DAY_MS: u64 = 86_400_000;
/// Number of days in 400 years. The calendar repeats after this period.
const ERA_DAYS: u64 = 146_097;
/// Days from 0000-03-01 to 1970-01-01.
const TO_1970: u64 = 719_468;

/// Converts milliseconds since 1970 to date and time in UTC, with a precision of one second, in the
/// form `2026-11-25T10:25:25Z` (ISO 8601).
///
/// ```
/// assert_eq!(htex_lab::study::utc(951_827_696_789), "2000-02-29T12:34:56Z");
/// ```
pub fn utc(ms: u64) -> String {
    let [year, month, day] = date(ms / DAY_MS);
    let second = ms % DAY_MS / 1000;
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

/// Returns the year, month and day that lie `days` days after 1970-01-01 in the Gregorian calendar
/// (Hinnant 2013, "chrono-compatible low-level date algorithms"). Years begin in March here, so
/// that the leap day is the last day.
fn date(days: u64) -> [u64; 3] {
    let days = days + TO_1970;
    let (era, day_of_era) = (days / ERA_DAYS, days % ERA_DAYS);
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = (month_from_march + 2) % 12 + 1;
    let year = year_of_era + 400 * era + u64::from(month <= 2);
    [year, month, day]
}

#[cfg(test)]
mod tests {
    use super::utc;

    #[test]
    fn leap_years_and_ends_of_years_are_right() {
        for (ms, expected) in [
            (0, "1970-01-01T00:00:00Z"),
            (1_709_164_800_000, "2024-02-29T00:00:00Z"),
            (1_735_689_599_999, "2024-12-31T23:59:59Z"),
            (4_107_542_400_000, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(utc(ms), expected);
        }
    }
}
