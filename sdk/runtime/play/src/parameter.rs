//! Parameters with their names.

use htex_host::{Field, Kind};

/// The value of one field of a model.
///
/// ```
/// use htex::play::Parameter;
/// assert_ne!(Parameter::Number(1.0), Parameter::List(vec![1.0]));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Parameter {
    /// A field with one number.
    Number(f64),
    /// A field with a list of numbers.
    List(Vec<f64>),
}

/// Splits a flat array into the fields of its model.
pub(crate) fn with_names(fields: &[Field], flat: Vec<f64>) -> Vec<(String, Parameter)> {
    let mut rest = flat.into_iter();
    let value = |field: &Field| {
        let first = rest.next().unwrap_or(f64::NAN);
        let value = match field.kind {
            Kind::Scalar => Parameter::Number(first),
            Kind::List { .. } => Parameter::List(rest.by_ref().take(first as usize).collect()),
        };
        (field.name.to_string(), value)
    };
    fields.iter().map(value).collect()
}
