//! The models a program knows.

use std::sync::Arc;

use crate::builtin::tables;
use crate::table::TableModel;
use crate::{HostError, LoadedModel};

/// Models by id, in the order in which they are shown.
#[derive(Debug, Clone)]
pub struct Registry {
    models: Vec<LoadedModel>,
}

impl Registry {
    /// The models linked into this program.
    pub fn builtin() -> Self {
        let load = |table| LoadedModel::new("built in", Arc::new(TableModel(table)));
        // A built-in model that cannot be loaded is not there; the tests count them.
        let models = tables()
            .into_iter()
            .filter_map(|table| load(table).ok())
            .collect();
        Self { models }
    }

    /// All models.
    pub fn models(&self) -> &[LoadedModel] {
        &self.models
    }

    /// A model by its id or by its short name (`org.htex.sbeta` or `sbeta`, in any case).
    ///
    /// # Errors
    /// [`HostError::UnknownModel`] with the names there are.
    pub fn find(&self, name: &str) -> Result<&LoadedModel, HostError> {
        let by_id = self.models.iter().find(|m| m.id() == name);
        let by_name = || {
            self.models
                .iter()
                .find(|m| m.short_name().eq_ignore_ascii_case(name))
        };
        by_id
            .or_else(by_name)
            .ok_or_else(|| HostError::UnknownModel {
                wanted: name.to_owned(),
                known: self
                    .models
                    .iter()
                    .map(|m| m.short_name())
                    .collect::<Vec<_>>()
                    .join(", "),
            })
    }
}
