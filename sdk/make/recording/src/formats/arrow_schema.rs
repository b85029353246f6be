//! Reads an Arrow schema: the columns, and the position of each column's buffers in a batch.

use arrow_ipc::{Endianness, Field, Precision, Type};

use crate::formats::bytes::{Endian, NumberType};

/// Deepest allowed nesting of types.
const MOST_DEEP: usize = 32;

/// The columns of a file.
#[derive(Debug)]
pub(crate) struct Schema {
    pub(crate) columns: Vec<Column>,
    pub(crate) endian: Endian,
}

impl Default for Schema {
    fn default() -> Self {
        Self { columns: Vec::new(), endian: Endian::Little }
    }
}

/// A column at the top level of the schema.
#[derive(Debug)]
pub(crate) struct Column {
    pub(crate) name: String,
    /// Name of its type, for messages.
    pub(crate) kind: String,
    /// `None` if the type is not numeric, or if the column comes after a type whose buffers cannot
    /// be counted.
    pub(crate) number: Option<NumberType>,
    /// Index of the column's node, and of the first of its buffers.
    pub(crate) node: usize,
    pub(crate) buffer: usize,
}

/// Number of nodes and buffers of a field, including all fields inside it.
#[derive(Debug, Clone, Copy)]
struct Extent {
    nodes: usize,
    buffers: usize,
}

impl Schema {
    /// Counts the nodes and buffers of a schema's fields.
    pub(crate) fn from_ipc(schema: &arrow_ipc::Schema<'_>) -> Self {
        let mut place = Some(Extent { nodes: 0, buffers: 0 });
        let fields = schema.fields().into_iter().flatten();
        let columns = fields.map(|field| {
            let here = place;
            place = here.and_then(|here| {
                let own = extent(&field, 0)?;
                Some(Extent {
                    nodes: here.nodes.checked_add(own.nodes)?,
                    buffers: here.buffers.checked_add(own.buffers)?,
                })
            });
            let kind = field.type_type().variant_name().unwrap_or("unknown");
            Column {
                name: field.name().unwrap_or_default().to_owned(),
                kind: match here {
                    Some(_) => kind.to_owned(),
                    None => format!("{kind}, behind a column of views or unions"),
                },
                number: here.and_then(|_| number(&field)),
                node: here.map_or(0, |here| here.nodes),
                buffer: here.map_or(0, |here| here.buffers),
            }
        });
        Self {
            columns: columns.collect(),
            endian: match schema.endianness() {
                Endianness::Big => Endian::Big,
                _ => Endian::Little,
            },
        }
    }
}

/// Returns the number type of a field. Times are read as numbers in their own unit.
fn number(field: &Field<'_>) -> Option<NumberType> {
    if field.dictionary().is_some() {
        return None;
    }
    Some(match field.type_type() {
        Type::FloatingPoint => match field.type_as_floating_point()?.precision() {
            Precision::SINGLE => NumberType::F32,
            Precision::DOUBLE => NumberType::F64,
            _ => return None,
        },
        Type::Int => {
            let int = field.type_as_int()?;
            match (int.bitWidth(), int.is_signed()) {
                (8, true) => NumberType::I8,
                (16, true) => NumberType::I16,
                (32, true) => NumberType::I32,
                (64, true) => NumberType::I64,
                (8, false) => NumberType::U8,
                (16, false) => NumberType::U16,
                (32, false) => NumberType::U32,
                (64, false) => NumberType::U64,
                _ => return None,
            }
        }
        Type::Timestamp | Type::Duration => NumberType::I64,
        _ => return None,
    })
}

/// Counts a field's nodes and buffers; `None` if the schema does not determine them.
fn extent(field: &Field<'_>, depth: usize) -> Option<Extent> {
    if depth == MOST_DEEP {
        return None;
    }
    let own = match field.type_type() {
        // A dictionary's values are in messages of their own; the batch has only indices.
        _ if field.dictionary().is_some() => {
            return Some(Extent { nodes: 1, buffers: 2 });
        }
        Type::Null => 0,
        Type::Struct_ | Type::FixedSizeList => 1,
        Type::List | Type::LargeList | Type::Map => 2,
        Type::Utf8 | Type::LargeUtf8 | Type::Binary | Type::LargeBinary => 3,
        Type::Int
        | Type::FloatingPoint
        | Type::Bool
        | Type::Decimal
        | Type::Date
        | Type::Time
        | Type::Timestamp
        | Type::Interval
        | Type::Duration
        | Type::FixedSizeBinary => 2,
        _ => return None,
    };
    let mut sum = Extent { nodes: 1, buffers: own };
    for child in field.children().into_iter().flatten() {
        let inner = extent(&child, depth + 1)?;
        sum.nodes = sum.nodes.checked_add(inner.nodes)?;
        sum.buffers = sum.buffers.checked_add(inner.buffers)?;
    }
    Some(sum)
}
