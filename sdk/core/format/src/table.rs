//! Tables: arrays of objects that are written column by column.
//!
//! For example, a grid of 405 conditions stores 13 numbers for each condition. An array of objects
//! repeats the key of every number. Even after compression with Deflate, these keys take more bytes
//! than the whole table.

#[cfg(feature = "write")]
use std::collections::BTreeSet;

use serde_json::{Map, Value};

use crate::CODED;
use htex_base::finding::escape;

/// Key of the elements of `at`. A table leaves out this key if its value in each element equals the
/// element's index.
const CONDITION: &str = "condition";

/// Largest total number of rows of all tables in a manifest, including nested tables. A row takes
/// at least 630 bytes in memory, but may take only two bytes in the file.
const MOST_ROWS: usize = 1 << 18;

/// Largest number by which the values of a column are divided.
const MOST_PER: f64 = 1e6;
/// Divisors that a writer tries.
#[cfg(feature = "write")]
const PER: [f64; 2] = [100.0, 10_000.0];

/// The reason why a table does not encode an array: a JSON pointer, and what is wrong at this
/// place.
pub(crate) type TableError = (String, String);

/// Replaces the tables of a coded manifest by the arrays that they encode. Does not change other
/// manifests.
pub(crate) fn expand_tables(manifest: &mut Value) -> Result<(), TableError> {
    if !requires_coded(manifest) {
        return Ok(());
    }
    let mut left = MOST_ROWS;
    if let Some(conditions) = manifest.get_mut("conditions") {
        expand(conditions, "/conditions", &mut left)?;
    }
    let representations = manifest.get_mut("representations").and_then(Value::as_array_mut);
    for (i, representation) in representations.into_iter().flatten().enumerate() {
        let Some(at) = representation.get_mut("at").filter(|at| at.is_object()) else {
            continue;
        };
        expand(at, &format!("/representations/{i}/at"), &mut left)?;
        for (i, row) in at.as_array_mut().into_iter().flatten().enumerate() {
            if let Value::Object(row) = row {
                row.entry(CONDITION).or_insert_with(|| i.into());
            }
        }
    }
    Ok(())
}

/// Writes a manifest's conditions, and the elements of `at`, as tables. If no key occurs in all
/// objects of an array, it stays an array.
#[cfg(feature = "write")]
pub(crate) fn write_tables(manifest: &mut Value) {
    if let Some(conditions) = manifest.get_mut("conditions") {
        tabulate(conditions);
    }
    let representations = manifest.get_mut("representations").and_then(Value::as_array_mut);
    for representation in representations.into_iter().flatten() {
        let Some(at) = representation.get_mut("at") else {
            continue;
        };
        tabulate(at);
        let Some(columns) = at.get_mut("columns").and_then(Value::as_object_mut) else {
            continue;
        };
        let indices = columns.get(CONDITION).and_then(Value::as_array);
        if indices
            .is_some_and(|indices| (0..indices.len()).map(Value::from).eq(indices.iter().cloned()))
        {
            columns.remove(CONDITION);
        }
    }
}

fn requires_coded(manifest: &Value) -> bool {
    let required = manifest.get("extensions_required").and_then(Value::as_array);
    required.is_some_and(|required| required.iter().any(|name| name == CODED))
}

/// Replaces a table by its rows. Any other value stays.
fn expand(value: &mut Value, pointer: &str, left: &mut usize) -> Result<(), TableError> {
    let Value::Object(table) = value else {
        return Ok(());
    };
    let table = std::mem::take(table);
    let columns = columns_of(&table, pointer)?;
    // Each row has at least one value in the file. Therefore, the number of values in the file
    // limits the number of rows.
    let Some(rows) = columns.values().find_map(full_column) else {
        let message = "no column has a value for each row; write an array of objects";
        return Err((pointer.to_owned(), message.to_owned()));
    };
    let rows = rows.len();
    let rows = rows_of(columns, rows, pointer, left)?;
    *value = Value::Array(rows.into_iter().map(Value::Object).collect());
    Ok(())
}

/// Returns the values of a column if it has a value for each row.
fn full_column(column: &Value) -> Option<&Vec<Value>> {
    match column {
        Value::Object(part) if part.contains_key("rows") => None,
        Value::Object(part) => part.get("values")?.as_array(),
        _ => column.as_array(),
    }
}

fn columns_of<'a>(
    table: &'a Map<String, Value>,
    pointer: &str,
) -> Result<&'a Map<String, Value>, TableError> {
    match table.get("columns") {
        Some(Value::Object(columns)) => Ok(columns),
        _ => Err((pointer.to_owned(), "a table needs the object `columns`".to_owned())),
    }
}

/// Returns the rows of these columns, and subtracts their number from `left`.
fn rows_of(
    columns: &Map<String, Value>,
    count: usize,
    pointer: &str,
    left: &mut usize,
) -> Result<Vec<Map<String, Value>>, TableError> {
    *left = left.checked_sub(count).ok_or_else(|| {
        (pointer.to_owned(), format!("the tables have more than {MOST_ROWS} rows"))
    })?;
    let mut rows = vec![Map::new(); count];
    for (key, column) in columns {
        let pointer = format!("{pointer}/columns/{}", escape(key));
        let (places, values) = match column {
            Value::Array(values) => ((0..count).collect(), values.clone()),
            Value::Object(part) => {
                let places = places(part, count, &pointer)?;
                let values = match part.get("values") {
                    Some(values) => divided_values(values, part.get("per"), &pointer)?,
                    None => {
                        let rows =
                            rows_of(columns_of(part, &pointer)?, places.len(), &pointer, left)?;
                        rows.into_iter().map(Value::Object).collect()
                    }
                };
                (places, values)
            }
            _ => return Err((pointer, "a column is an array or an object".to_owned())),
        };
        if values.len() != places.len() {
            let message = format!("there are {} values for {} rows", values.len(), places.len());
            return Err((pointer, message));
        }
        for (place, value) in places.into_iter().zip(values) {
            rows[place].insert(key.clone(), value);
        }
    }
    Ok(rows)
}

/// Returns the values of a column, each divided by `per` if it is given.
fn divided_values(
    values: &Value,
    per: Option<&Value>,
    pointer: &str,
) -> Result<Vec<Value>, TableError> {
    let Value::Array(values) = values else {
        return Err((format!("{pointer}/values"), "it is no array".to_owned()));
    };
    let Some(per) = per else {
        return Ok(values.clone());
    };
    let Some(per) = per.as_f64().filter(|per| (1.0..=MOST_PER).contains(per)) else {
        return Err((format!("{pointer}/per"), format!("it is no number from 1 to {MOST_PER}")));
    };
    let divided = values.iter().map(|value| divided(value, per)).collect::<Option<_>>();
    divided.ok_or_else(|| {
        (format!("{pointer}/values"), "with `per`, values are numbers or arrays of them".to_owned())
    })
}

fn divided(value: &Value, per: f64) -> Option<Value> {
    match value {
        Value::Array(values) => values.iter().map(|value| divided(value, per)).collect(),
        _ => Some((value.as_f64()? / per).into()),
    }
}

/// Returns the rows that have a value in this column: the rows listed in `rows`, or all rows if
/// there is no such list.
fn places(
    part: &Map<String, Value>,
    count: usize,
    pointer: &str,
) -> Result<Vec<usize>, TableError> {
    let Some(rows) = part.get("rows") else {
        return Ok((0..count).collect());
    };
    // An integer may be written with a decimal point or an exponent. For numbers above `count`, the
    // result of the cast does not matter.
    let index =
        |row: &Value| row.as_f64().filter(|r| *r >= 0.0 && r.fract() == 0.0).map(|r| r as usize);
    let indices = rows.as_array().map(|rows| rows.iter().map(index).collect::<Option<Vec<_>>>());
    match indices.flatten() {
        Some(rows) if rows.is_sorted_by(|a, b| a < b) && rows.last().is_none_or(|l| *l < count) => {
            Ok(rows)
        }
        _ => {
            let message = format!("`rows` is no ascending array of integers below {count}");
            Err((format!("{pointer}/rows"), message))
        }
    }
}

/// Replaces an array of objects by a table, if some key is in all objects.
#[cfg(feature = "write")]
fn tabulate(array: &mut Value) {
    let Some(rows) = array.as_array() else {
        return;
    };
    let rows: Option<Vec<&Map<String, Value>>> = rows.iter().map(Value::as_object).collect();
    let columns = columns(&rows.unwrap_or_default());
    if columns.values().any(|column| full_column(column).is_some()) {
        *array = Value::Object(Map::from_iter([("columns".to_owned(), columns.into())]));
    }
}

#[cfg(feature = "write")]
fn columns(rows: &[&Map<String, Value>]) -> Map<String, Value> {
    let keys: BTreeSet<&String> = rows.iter().flat_map(|row| row.keys()).collect();
    keys.into_iter().map(|key| (key.clone(), column(key, rows))).collect()
}

#[cfg(feature = "write")]
fn column(key: &str, rows: &[&Map<String, Value>]) -> Value {
    let there = rows.iter().enumerate().filter_map(|(i, row)| Some((i, row.get(key)?)));
    let (places, values): (Vec<usize>, Vec<&Value>) = there.unzip();
    let is_full = places.len() == rows.len();
    let objects: Option<Vec<_>> = values.iter().map(|value| value.as_object()).collect();
    let mut part = Map::new();
    if let Some(objects) = objects {
        part.insert("columns".to_owned(), columns(&objects).into());
    } else {
        let whole = |per: &f64| {
            let values = values.iter().map(|value| multiplied(value, *per));
            Some((*per, values.collect::<Option<Value>>()?))
        };
        match PER.iter().find_map(whole) {
            Some((per, values)) => {
                part.insert("per".to_owned(), (per as u64).into());
                part.insert("values".to_owned(), values);
            }
            None if is_full => return values.into_iter().cloned().collect(),
            None => {
                part.insert("values".to_owned(), values.into_iter().cloned().collect());
            }
        }
    }
    if !is_full {
        part.insert("rows".to_owned(), places.into());
    }
    Value::Object(part)
}

/// Returns a number that is written with a decimal point, or an array of such numbers, multiplied
/// by `per`. Returns `None` if a product is not whole, or if dividing it by `per` would not give
/// the number again.
#[cfg(feature = "write")]
fn multiplied(value: &Value, per: f64) -> Option<Value> {
    match value {
        Value::Array(values) => values.iter().map(|value| multiplied(value, per)).collect(),
        Value::Number(number) if number.is_f64() => {
            let number = number.as_f64()?;
            let whole = (number * per).round();
            // Only up to 2^53, because floats represent all integers up to this number exactly.
            let is_exact = whole.abs() <= 9_007_199_254_740_992.0;
            // The bits are compared, because a negative zero would become 0.
            let is_same = (whole as i64) as f64 / per;
            (is_exact && is_same.to_bits() == number.to_bits()).then(|| (whole as i64).into())
        }
        _ => None,
    }
}

#[cfg(all(test, feature = "write"))]
#[allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
mod tests {
    use super::*;
    use proptest::prelude::*;
    use serde_json::json;

    fn manifest(conditions: &Value, at: &Value) -> Value {
        json!({
            "extensions_required": [CODED], "conditions": conditions,
            "representations": [{ "at": at }]
        })
    }

    #[test]
    fn a_table_is_that_of_the_specification() {
        let conditions = json!([{ "speed_mm_s": 20 }, { "speed_mm_s": 40, "force_n": 0.5 }]);
        let at = json!([
            { "condition": 0, "level_rms": 1.23456, "quality": { "x": 1.5, "y": [1.25, 2.0], "z": [1] } },
            { "condition": 1, "level_rms": 2.5 }
        ]);
        let mut written = manifest(&conditions, &at);
        write_tables(&mut written);
        let expected = manifest(
            &json!({ "columns": {
                "force_n": { "per": 100, "rows": [1], "values": [50] }, "speed_mm_s": [20, 40]
            } }),
            &json!({ "columns": {
                "level_rms": [1.23456, 2.5],
                "quality": { "columns": {
                    "x": { "per": 100, "values": [150] },
                    "y": { "per": 100, "values": [[125, 200]] },
                    "z": [[1]]
                }, "rows": [0] }
            } }),
        );
        assert_eq!(written, expected);
        expand_tables(&mut written).unwrap();
        assert_eq!(written, manifest(&conditions, &at));
    }

    #[test]
    fn a_table_that_stands_for_no_array_is_refused_where_it_is_wrong() {
        let all = json!([{ "condition": 0 }]);
        for (conditions, pointer) in [
            (json!({}), ""),
            (json!({ "columns": [] }), ""),
            (json!({ "columns": {} }), ""),
            (json!({ "columns": { "a": { "rows": [], "values": [] } } }), ""),
            (json!({ "columns": { "a": [1, 2], "b": [1] } }), "/columns/b"),
            (json!({ "columns": { "a": [1, 2], "b": 1 } }), "/columns/b"),
            (json!({ "columns": { "a": [1, 2], "b": {} } }), "/columns/b"),
            (json!({ "columns": { "a": { "columns": { "b": [1] } } } }), ""),
            (json!({ "columns": { "a": { "values": [1, 2] }, "b": [1] } }), "/columns/b"),
            (json!({ "columns": { "a": [1, 2], "b": { "values": 1 } } }), "/columns/b/values"),
            (json!({ "columns": { "a": { "per": 0.5, "values": [1] } } }), "/columns/a/per"),
            (json!({ "columns": { "a": { "per": "1", "values": [1] } } }), "/columns/a/per"),
            (json!({ "columns": { "a": { "per": 2, "values": [[true]] } } }), "/columns/a/values"),
            (json!({ "columns": { "a": [1, 2], "b~": { "values": [1] } } }), "/columns/b~0"),
            (
                json!({ "columns": { "a": [1], "b": { "columns": { "c": [] } } } }),
                "/columns/b/columns/c",
            ),
        ] {
            let mut manifest = manifest(&conditions, &all);
            let pointer = format!("/conditions{pointer}");
            assert_eq!(expand_tables(&mut manifest).unwrap_err().0, pointer, "{conditions}");
        }
        let points = json!({ "columns": { "a": [1, 2], "b": { "rows": [1.0], "values": [3] } } });
        let mut accepted = manifest(&points, &all);
        expand_tables(&mut accepted).unwrap();
        assert_eq!(accepted["conditions"], json!([{ "a": 1 }, { "a": 2, "b": 3 }]));
        for rows in [json!(1), json!([2]), json!([1, 0]), json!([1, 1]), json!([0.5]), json!([-1])]
        {
            let values = vec![1; rows.as_array().map_or(1, Vec::len)];
            let table =
                json!({ "columns": { "a": [1, 2], "b": { "rows": rows, "values": values } } });
            let error = expand_tables(&mut manifest(&table, &all)).unwrap_err();
            assert_eq!(error.0, "/conditions/columns/b/rows", "{rows}");
        }
    }

    #[test]
    fn nested_tables_do_not_multiply_rows_beyond_the_limit() {
        let nested = |count: usize, depth: usize| {
            let column = (0..depth)
                .fold(json!(vec![0; count]), |inner, _| json!({ "columns": { "a": inner } }));
            json!({ "columns": { "a": vec![0; count], "b": column } })
        };
        let mut fits = manifest(&nested(MOST_ROWS / 4, 3), &json!([]));
        assert!(expand_tables(&mut fits).is_ok());
        let mut exceeds = manifest(&nested(MOST_ROWS / 4, 4), &json!([]));
        let pointer = "/conditions/columns/b/columns/a/columns/a/columns/a";
        assert_eq!(expand_tables(&mut exceeds).unwrap_err().0, pointer);
    }

    proptest! {
        #[test]
        fn rows_come_back(
            rows in prop::collection::vec(
                (any::<bool>(), any::<bool>(), any::<bool>(), any::<u32>()), 0..20,
            ),
        ) {
            let row = |(a, b, c, number): &(bool, bool, bool, u32)| {
                let level = f64::from(*number) / if *c { 100.0 } else { 10_000.0 };
                let mut row = json!({ "condition": number % 7, "level_rms": level });
                if *a {
                    row["a"] = json!([number, 1]);
                }
                if *b {
                    row["b"] = if *c { json!({ "c": number }) } else { json!({}) };
                }
                row
            };
            let rows: Value = rows.iter().map(row).collect();
            let before = manifest(&rows, &rows);
            let mut after = before.clone();
            write_tables(&mut after);
            expand_tables(&mut after).unwrap();
            prop_assert_eq!(after, before);
        }
    }
}
