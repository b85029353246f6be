//! A checked and compiled module.

use std::sync::Arc;

use super::imports::Guest;
use super::sections::{CompileError, limited};
use super::shared::Shared;
use crate::WasmLimits;
use crate::clock::Instant;
use crate::sandbox::{Budget, Sandbox};

/// A compiled module, and the data that its instances share.
pub(super) struct WasmModule {
    pub(super) guest: Guest,
    pub(super) limits: WasmLimits,
    pub(super) budget: Arc<Budget>,
    pub(super) shared: Arc<Shared>,
}

impl WasmModule {
    /// Checks and compiles a module.
    pub(super) fn new(bytes: &[u8], sandbox: &Sandbox) -> Result<Self, CompileError> {
        let limits = &sandbox.limits;
        let bytes = limited(bytes, limits)?;
        sandbox.budget.time_left()?;
        let start = Instant::now();
        let guest = Guest::new(&bytes);
        sandbox.budget.spend(start.elapsed());
        Ok(Self {
            guest: guest.map_err(|what| CompileError::Invalid { what })?,
            limits: limits.clone(),
            budget: Arc::clone(&sandbox.budget),
            shared: Arc::default(),
        })
    }
}
