//! Reader of HDF5 files. MATLAB files of version 7.3 are also HDF5. Data sets are addressed by
//! path.
//!
//! The crate `hdf5-reader` limits chunks, headers and depth, has no C code, and does not follow
//! links to other files. Two other crates were not chosen: `hdf5` needs the C library, and
//! `hdf5-pure` also contains a writer and has 120,000 lines.

use std::collections::HashSet;
use std::sync::Arc;

use hdf5_reader::group::Group;
use hdf5_reader::{
    Attribute, Dataset, Datatype, H5Type, Hdf5File, OpenOptions, SliceInfo, SliceInfoElem, Storage,
    StorageBuffer,
};

use crate::error::{Fault, ReadProblem};
use crate::formats::matrix::{Arrays, MOST_COLUMNS, Shape, is_rate_name};
use crate::formats::shared::SharedInput;
use crate::input::InputFile;
use crate::sheet::{Columns, Numbers, Sheet};
use crate::value_limit::ValueLimit;

/// Deepest allowed nesting of groups.
const MOST_DEEP: usize = 16;
/// Largest number of groups and data sets.
const MOST_OBJECTS: usize = 65_536;
/// Number of values that are read at once.
const AT_ONCE: u64 = 64 << 10;
/// Largest chunk and largest object header that are read, bytes.
const MOST_CHUNK: usize = 256 << 20;
const MOST_HEADER: usize = 4 << 20;
/// Largest size of a data set's numbers, as a multiple of the file's length. Deflate, the filter of
/// HDF5 and MATLAB, compresses by a factor of up to 1032. Parts of a data set that were never
/// written take no bytes at all, so without a limit a small file could claim any size.
const MOST_EXPANSION: u64 = 2048;

/// An opened file.
pub(crate) struct Hdf5 {
    columns: Columns,
    arrays: Arrays<Dataset>,
    limit: ValueLimit,
    /// Length of the file, bytes.
    bytes: u64,
}

struct SharedFile(SharedInput);

impl Storage for SharedFile {
    fn len(&self) -> u64 {
        self.0.length()
    }

    fn read_range(&self, offset: u64, len: usize) -> hdf5_reader::error::Result<StorageBuffer> {
        Ok(StorageBuffer::from_vec(self.0.read(offset, len as u64)?))
    }
}

impl Hdf5 {
    /// Finds the names of all data sets. Links to other files are not followed.
    pub(crate) fn open(opened: InputFile<'_>, limit: ValueLimit) -> Result<Self, Fault> {
        let shared = SharedInput::new(opened.random()?)?;
        let bytes = shared.length();
        let options = OpenOptions::default()
            .with_max_chunk_bytes(MOST_CHUNK)
            .with_max_read_bytes(MOST_CHUNK)
            .with_max_object_header_bytes(MOST_HEADER);
        let mut scan = Scan { arrays: Arrays::new('/'), seen: HashSet::new(), objects: 0 };
        let hdf5 = Hdf5File::from_storage_with_options(Arc::new(SharedFile(shared)), options);
        let root = hdf5.and_then(|hdf5| hdf5.root_group()).map_err(|error| damaged("/", &error))?;
        scan.group(&root, "", 0)?;
        Ok(Self { columns: scan.arrays.columns(), arrays: scan.arrays, limit, bytes })
    }
}

impl Sheet for Hdf5 {
    fn columns(&self) -> &Columns {
        &self.columns
    }

    fn rate_hz(&self, wanted: &[usize]) -> Result<Option<f64>, Fault> {
        self.arrays.rate_hz(&self.columns, wanted)
    }

    fn numbers(&mut self, wanted: &[usize]) -> Result<Numbers, Fault> {
        let columns = self.arrays.numbers(self.limit, wanted, |dataset, shape, keep| {
            fits(self.bytes, dataset, shape)?;
            read(dataset, shape, keep).map_err(|error| damaged(dataset.name(), &error))
        })?;
        Ok(Numbers { columns, ..Numbers::default() })
    }
}

/// The data sets found so far.
struct Scan {
    arrays: Arrays<Dataset>,
    /// Addresses of groups already visited: a group may contain a link to a group around it.
    seen: HashSet<u64>,
    objects: usize,
}

impl Scan {
    fn group(&mut self, group: &Group, path: &str, depth: usize) -> Result<(), Fault> {
        if !self.seen.insert(group.address()) {
            return Ok(());
        }
        let failed = |error| damaged(&format!("{path}/"), &error);
        let (groups, datasets) = group.members().map_err(failed)?;
        self.objects += groups.len() + datasets.len();
        if depth == MOST_DEEP || self.objects > MOST_OBJECTS {
            let problem = format!(
                "more than {MOST_DEEP} groups within each other, or more than {MOST_OBJECTS} objects; copy the objects of the \
                 recording to a separate file"
            );
            return Err(ReadProblem::Invalid(problem).at_place(htex_base::finding::plain(path)));
        }
        // Attributes that cannot be read do not state a rate; these include kinds that are not
        // numbers.
        self.attributes(path, group.attributes().unwrap_or_default());
        for dataset in datasets {
            self.dataset(dataset, path)?;
        }
        for inner in groups {
            self.group(&inner, &format!("{path}/{}", inner.name()), depth + 1)?;
        }
        Ok(())
    }

    fn attributes(&mut self, path: &str, attributes: Vec<Attribute>) {
        for attribute in attributes.iter().filter(|attribute| is_rate_name(&attribute.name)) {
            if let Ok(value) = attribute.read_as_f64() {
                self.arrays.add_scalar(&format!("{path}/{}", &attribute.name), value);
            }
        }
    }

    fn dataset(&mut self, dataset: Dataset, group: &str) -> Result<(), Fault> {
        let path = format!("{group}/{}", dataset.name());
        self.attributes(&path, dataset.attributes());
        let shape = match *dataset.shape() {
            [samples] => Shape::of_array(1, samples),
            [outer, inner] => Shape::of_array(outer, inner),
            _ => None,
        };
        let is_number = is_number(dataset.dtype());
        if let (Some(shape), true) = (shape, is_number) {
            if !self.arrays.add(&path, shape, dataset) {
                let problem = format!(
                    "more than {MOST_COLUMNS} columns; copy the columns of the recording to a separate file"
                );
                return Err(
                    ReadProblem::Invalid(problem).at_place(htex_base::finding::plain(&path))
                );
            }
        } else if is_number
            && is_rate_name(dataset.name())
            && dataset.shape().iter().all(|size| *size == 1)
        {
            let mut value = f64::NAN;
            let whole = SliceInfo::all(dataset.ndim());
            slab(&dataset, &whole, &mut |_, read| value = read)
                .map_err(|error| damaged(&path, &error))?;
            self.arrays.add_scalar(&path, value);
        }
        Ok(())
    }
}

fn is_number(kind: &Datatype) -> bool {
    matches!(
        kind,
        Datatype::FixedPoint { size: 1 | 2 | 4 | 8, .. }
            | Datatype::FloatingPoint { size: 4 | 8, .. }
    )
}

/// Refuses a data set with more numbers than a file of this length can hold.
fn fits(bytes: u64, dataset: &Dataset, shape: Shape) -> Result<(), Fault> {
    let size = match dataset.dtype() {
        Datatype::FixedPoint { size, .. } | Datatype::FloatingPoint { size, .. } => *size,
        _ => 1,
    };
    let numbers = shape.samples.saturating_mul(shape.channels);
    if numbers.saturating_mul(size.into()) <= bytes.saturating_mul(MOST_EXPANSION) {
        return Ok(());
    }
    let problem = format!(
        "it states {} samples of {} channels in a file of {bytes} bytes; write the file again without space that has no data",
        shape.samples, shape.channels
    );
    Err(ReadProblem::Invalid(problem).at_place(htex_base::finding::plain(dataset.name())))
}

/// Reads a data set in slabs: some samples of all its channels at once.
fn read(
    dataset: &Dataset,
    shape: Shape,
    keep: &mut dyn FnMut(u64, f64),
) -> hdf5_reader::error::Result<()> {
    // All channels at once, because they often share the same chunks, each of which has to be
    // decompressed as a whole.
    let at_once = (AT_ONCE / shape.channels).max(1);
    let mut from = 0;
    while from < shape.samples {
        let to = (from + at_once).min(shape.samples);
        let part = |start, end| SliceInfoElem::Slice { start, end, step: 1 };
        let (time, channels) = (part(from, to), part(0, shape.channels));
        let selections = match (dataset.ndim(), shape.is_planar) {
            (1, _) => vec![time],
            (_, true) => vec![channels, time],
            (_, false) => vec![time, channels],
        };
        let here = to - from;
        slab(dataset, &SliceInfo { selections }, &mut |index, value| {
            // Converts an index in the slab to an index in the data set.
            let index = if shape.is_planar {
                index / here * shape.samples + from + index % here
            } else {
                from * shape.channels + index
            };
            keep(index, value);
        })?;
        from = to;
    }
    Ok(())
}

/// Reads a part of a data set and passes on each value with its index in the part.
fn slab(
    dataset: &Dataset,
    part: &SliceInfo,
    keep: &mut dyn FnMut(u64, f64),
) -> hdf5_reader::error::Result<()> {
    match dataset.dtype() {
        Datatype::FloatingPoint { size: 4, .. } => typed(dataset, part, keep, |x: f32| x.into()),
        Datatype::FloatingPoint { .. } => typed(dataset, part, keep, |x: f64| x),
        Datatype::FixedPoint { size, signed, .. } => match (size, signed) {
            (1, true) => typed(dataset, part, keep, |x: i8| x.into()),
            (1, false) => typed(dataset, part, keep, |x: u8| x.into()),
            (2, true) => typed(dataset, part, keep, |x: i16| x.into()),
            (2, false) => typed(dataset, part, keep, |x: u16| x.into()),
            (4, true) => typed(dataset, part, keep, |x: i32| x.into()),
            (4, false) => typed(dataset, part, keep, |x: u32| x.into()),
            (_, true) => typed(dataset, part, keep, |x: i64| x as f64),
            (_, false) => typed(dataset, part, keep, |x: u64| x as f64),
        },
        _ => Ok(()),
    }
}

fn typed<T: H5Type + Copy>(
    dataset: &Dataset,
    part: &SliceInfo,
    keep: &mut dyn FnMut(u64, f64),
    to_f64: impl Fn(T) -> f64,
) -> hdf5_reader::error::Result<()> {
    let values = dataset.read_slice::<T>(part)?;
    (0..).zip(values.iter()).for_each(|(index, value)| keep(index, to_f64(*value)));
    Ok(())
}

fn damaged(place: &str, error: &hdf5_reader::error::Error) -> Fault {
    let error = error.to_string();
    let problem = format!(
        "not readable HDF5: {}; copy the file again, or write it again by h5py or MATLAB",
        htex_base::finding::plain(&error)
    );
    ReadProblem::Invalid(problem).at_place(htex_base::finding::plain(place))
}
