//! Times of calls.

#[cfg(not(target_family = "wasm"))]
pub(crate) use std::time::Instant;

/// A time of the browser, which the standard library cannot read.
#[cfg(target_family = "wasm")]
#[derive(Debug, Clone, Copy)]
pub(crate) struct Instant {
    ms: f64,
}

#[cfg(target_family = "wasm")]
impl Instant {
    pub(crate) fn now() -> Self {
        Self {
            ms: crate::wasm::now_ms(),
        }
    }

    pub(crate) fn elapsed(self) -> std::time::Duration {
        Self::now().saturating_duration_since(self)
    }

    pub(crate) fn saturating_duration_since(self, earlier: Self) -> std::time::Duration {
        std::time::Duration::try_from_secs_f64((self.ms - earlier.ms) / 1e3).unwrap_or_default()
    }
}
