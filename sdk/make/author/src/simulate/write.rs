//! Writes simulations as CSV with a fixed number of decimals, so that the bytes are equal on every
//! machine.

use std::io::{self, Write};

use super::{Motion, Simulation};

/// Number of decimals for each kind of column: 1 us, 0.1 uN (the noise is 0.2 mN), 0.1 um.
const TIME_DECIMALS: u32 = 6;
pub(super) const FORCE_DECIMALS: u32 = 7;
pub(super) const POSITION_DECIMALS: u32 = 4;
/// Number of bytes that are collected before they are written.
const CHUNK: usize = 1 << 16;

/// Rounds to the given number of decimals. The result is the value that is read back from the file.
pub(super) fn rounded(value: f64, decimals: u32) -> f64 {
    let scale = 10_u32.pow(decimals) as f64;
    libm::round(value * scale) / scale
}

impl Simulation {
    /// Writes the columns `t_s,fx_n,fy_n,fz_n,x_mm,y_mm`. A comment line before the columns states
    /// that the file is simulated, and names the surface, the seed, the motion, the rate and the
    /// version.
    ///
    /// Reading the file gives back exactly the same forces, bit for bit.
    ///
    /// # Errors
    /// When the writer fails.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        let options = &self.options;
        let motion = match options.motion {
            Motion::Sweeps => format!("{} mm/s, {} N", options.speed_mm_s, options.force_n),
            Motion::Free(free) => {
                let ([slow, fast], [light, firm]) = (free.speed_mm_s, free.force_n);
                format!("free motion, {slow} to {fast} mm/s, {light} to {firm} N")
            }
        };
        writeln!(
            out,
            "# simulated recording, no finger and no sensor: surface {}, seed {}, {motion}{}, {} Hz, htex {}",
            options.surface,
            options.seed,
            options.departures.description(),
            options.rate_hz,
            env!("CARGO_PKG_VERSION")
        )?;
        writeln!(out, "t_s,fx_n,fy_n,fz_n,x_mm,y_mm")?;
        let mut chunk = Vec::with_capacity(CHUNK + 256);
        for sample in 0..self.t_s.len() {
            self.push_row(&mut chunk, sample);
            if chunk.len() >= CHUNK {
                out.write_all(&chunk)?;
                chunk.clear();
            }
        }
        out.write_all(&chunk)
    }

    fn push_row(&self, row: &mut Vec<u8>, sample: usize) {
        let columns = [
            (&self.t_s, TIME_DECIMALS),
            (&self.fx_n, FORCE_DECIMALS),
            (&self.fy_n, FORCE_DECIMALS),
            (&self.fz_n, FORCE_DECIMALS),
            (&self.x_mm, POSITION_DECIMALS),
            (&self.y_mm, POSITION_DECIMALS),
        ];
        for (values, decimals) in columns {
            push_decimal(row, values[sample], decimals);
            row.push(b',');
        }
        if let Some(last) = row.last_mut() {
            *last = b'\n';
        }
    }
}

/// Appends `value` with exactly `decimals` decimals, at most 9.
fn push_decimal(row: &mut Vec<u8>, value: f64, decimals: u32) {
    let scale = 10_u64.pow(decimals);
    let units = libm::round(value.abs() * scale as f64) as u64;
    if value < 0.0 && units > 0 {
        row.push(b'-');
    }
    push_digits(row, units / scale, 1);
    row.push(b'.');
    push_digits(row, units % scale, decimals as usize);
}

/// Appends an integer, padded with zeros to `width` digits.
fn push_digits(row: &mut Vec<u8>, mut value: u64, width: usize) {
    let mut digits = [b'0'; 20];
    let mut first = digits.len();
    while value > 0 || digits.len() - first < width {
        first -= 1;
        digits[first] = b'0' + (value % 10) as u8;
        value /= 10;
    }
    row.extend_from_slice(&digits[first..]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn decimals_are_what_the_standard_library_prints(value in -1e4..1e4_f64) {
            let value = rounded(value, 4);
            let mut text = Vec::new();
            push_decimal(&mut text, value, 4);
            let text = String::from_utf8(text).unwrap();
            prop_assert_eq!(&text, &format!("{:.4}", value + 0.0));
            prop_assert_eq!(text.parse::<f64>().unwrap(), value);
        }
    }
}
