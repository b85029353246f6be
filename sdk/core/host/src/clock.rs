//! Measures the duration of calls.

#[cfg(not(target_family = "wasm"))]
pub use std::time::Instant;

/// A point in time on the browser's clock. The standard library cannot read the clock of a browser.
/// On other systems, `Instant` is the type of the standard library.
#[cfg(target_family = "wasm")]
#[derive(Debug, Clone, Copy)]
pub struct Instant {
    ms: f64,
}

#[cfg(target_family = "wasm")]
#[allow(unsafe_code)]
mod imported {
    #[link(wasm_import_module = "htex")]
    unsafe extern "C" {
        /// Milliseconds since a fixed moment. JavaScript provides the function
        /// (`sdk/bindings/web/src/guests.js`).
        pub(super) safe fn now_ms() -> f64;
    }
}

#[cfg(target_family = "wasm")]
impl Instant {
    /// Returns the current time.
    #[must_use]
    pub fn now() -> Self {
        Self { ms: imported::now_ms() }
    }

    /// Returns the time elapsed since this instant.
    #[must_use]
    pub fn elapsed(self) -> std::time::Duration {
        Self::now().saturating_duration_since(self)
    }

    /// Returns the time from `earlier` to this instant, or zero if `earlier` is later.
    #[must_use]
    pub fn saturating_duration_since(self, earlier: Self) -> std::time::Duration {
        std::time::Duration::try_from_secs_f64((self.ms - earlier.ms) / 1e3).unwrap_or_default()
    }
}
