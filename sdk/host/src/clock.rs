//! Times of calls.

#[cfg(not(target_family = "wasm"))]
pub use std::time::Instant;

/// A time of the browser, which the standard library cannot read; elsewhere it is that of the
/// standard library.
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
        /// Milliseconds since any moment; JavaScript provides it (`sdk/web/src/guests.js`).
        pub(super) safe fn now_ms() -> f64;
    }
}

#[cfg(target_family = "wasm")]
impl Instant {
    /// The time now.
    #[must_use]
    pub fn now() -> Self {
        Self { ms: imported::now_ms() }
    }

    /// The time since then.
    #[must_use]
    pub fn elapsed(self) -> std::time::Duration {
        Self::now().saturating_duration_since(self)
    }

    /// The time since an earlier one; zero if that is later.
    #[must_use]
    pub fn saturating_duration_since(self, earlier: Self) -> std::time::Duration {
        std::time::Duration::try_from_secs_f64((self.ms - earlier.ms) / 1e3).unwrap_or_default()
    }
}
