//! A model of shapes as an archive of numpy arrays, which can be read back and merged.

use std::io::{self, Read, Seek, Write};

use taxel_core::imprint::Imprint;
use taxel_core::index::index;
use taxel_core::recognition::{ImprintKey, KeyTable, Model, ModelHead, NamedShape, ShapeCount};
use taxel_core::sensor::{MatrixSize, Sensor};
use taxel_core::source::Source;

use crate::error::ReadError;
use crate::formats::header::{ArchiveHeader, MODEL_FORMAT, ShapeHeader};
use crate::formats::numpy::Number;
use crate::formats::numpy::archive::{ArrayReader, ArrayWriter, in_header, unexpected};
use crate::formats::record::no_names;

/// Writes a model as an archive of numpy arrays (`numpy.load`). Equal models are equal files.
///
/// Per key, in order of height, width and taxels: `height` and `width` of its box, and `rows` (a word per row, bit
/// `i` for column `i`; keys × rows of the highest key, in the smallest unsigned type that holds the widest). Per key
/// and shape that leaves it, key after key: `key` (its number), `shape` (its number in the header) and `count` (the
/// number of poses). Before them comes `header`, JSON as bytes: format, shapes, sensor, anchor, ranges, shard, poses
/// of each shape, and the number of poses in which it is cut off.
///
/// # Errors
/// Returns the errors of the writer.
pub fn write(model: &Model, mut output: impl Write + Seek) -> io::Result<()> {
    let mut archive = ArrayWriter::new(&mut output, &header(model.head()))?;
    let keys = model.keys();
    let imprints = || (0..keys.len()).map(|key| keys.imprint(key));
    let side = |of: fn(&Imprint) -> u8| {
        let sides = imprints().map(move |imprint| imprint.as_ref().map_or(0, of));
        sides.collect::<Vec<u8>>()
    };
    let (heights, widths) = (side(Imprint::rows), side(Imprint::columns));
    let count = keys.len() as u64;
    archive.add("height", Number::U8, &[count], &heights)?;
    archive.add("width", Number::U8, &[count], &widths)?;
    let highest = largest(&heights);
    let number = row_type(largest(&widths));
    let mut rows = Vec::with_capacity(keys.len() * usize::from(highest) * number.size());
    for imprint in imprints() {
        let words = imprint.as_ref().map_or(&[][..], Imprint::words);
        let words = words.iter().chain(std::iter::repeat(&0));
        for word in words.take(highest.into()) {
            rows.extend_from_slice(&word.to_le_bytes()[..number.size()]);
        }
    }
    archive.add("rows", number, &[count, highest.into()], &rows)?;
    let entries =
        || (0..keys.len()).flat_map(|key| model.counts(key).iter().map(move |c| (key, c)));
    let numbers: Vec<u64> = entries().map(|(key, _)| key as u64).collect();
    let length = [numbers.len() as u64];
    archive.add_words("key", &numbers)?;
    let shapes: Vec<u8> = entries()
        .flat_map(|(_, count)| count.shape.to_le_bytes())
        .collect();
    archive.add("shape", Number::U16, &length, &shapes)?;
    let counts: Vec<u64> = entries().map(|(_, count)| count.poses).collect();
    archive.add_words("count", &counts)?;
    archive.finish()
}

fn largest(sides: &[u8]) -> u8 {
    sides.iter().fold(0, |largest, &side| largest.max(side))
}

/// Returns the smallest type for rows of that many columns.
fn row_type(columns: u8) -> Number {
    match columns {
        0..=8 => Number::U8,
        9..=16 => Number::U16,
        17..=32 => Number::U32,
        _ => Number::U64,
    }
}

/// Returns the header of a model as JSON, which begins its file. Equal heads have equal headers.
pub fn header(head: &ModelHead) -> Vec<u8> {
    let own = (&head.sensor, head.anchor, &head.ranges, head.shard);
    let mut header = ArchiveHeader::new(MODEL_FORMAT, own, head.poses);
    let shapes = head.shapes.iter().zip(&head.cut);
    let shapes = shapes.map(|(shape, &cut)| ShapeHeader {
        name: shape.name.clone(),
        weight: shape.weight,
        cut,
        pitch_mm: match &shape.source {
            Source::Outline(outline) => outline.pitch_mm(),
            _ => None,
        },
        source: &shape.source,
    });
    header.shapes = Some(shapes.collect());
    header.bytes()
}

/// Reads a model that [`write_model`](crate::formats::write_model) has written.
///
/// A file is refused if it has another format or an unknown key in the header; arrays of other types or lengths; keys
/// that are not cut to their boxes or occur twice; counts that are not in the order of the shapes, or do not add up
/// to the number of poses. So every model that can be read is one that training could have written.
///
/// # Errors
/// Returns an error that says what is wrong; the input may be any bytes.
pub fn read(input: impl Read + Seek) -> Result<Model, ReadError> {
    let mut archive = ArrayReader::new(input)?;
    let header = archive.header(MODEL_FORMAT)?;
    let (sensor, anchor, ranges, shard) = header.grid()?;
    let (Some(records), None, None) = (header.shapes, header.source, header.partly_off) else {
        return Err(in_header("expected shapes, and no source or partly_off"));
    };
    let mut shapes = Vec::with_capacity(records.len());
    for shape in &records {
        let source = &shape.source;
        let source = source.source(&Sensor::LARGEST, shape.pitch_mm, &no_names);
        let source = source.map_err(in_header)?;
        shapes.push(NamedShape::new(shape.name.clone(), source).weighted(shape.weight));
    }
    let mut head = ModelHead::new(shapes, sensor, anchor, ranges, header.poses);
    head.shard = shard;
    head.cut = records.iter().map(|shape| shape.cut).collect();
    let keys = keys(&mut archive)?;
    let counts = counts(&mut archive, keys.len())?;
    archive.finish()?;
    let counts_of = |key: usize| counts[key].iter().copied();
    Model::of_table(head, &keys, counts_of).map_err(|error| ReadError::new(error.to_string()))
}

/// Reads the keys in the order of the file. A duplicate is refused at once, so the table never takes much more memory
/// than the file.
fn keys<R: Read + Seek>(archive: &mut ArrayReader<R>) -> Result<KeyTable, ReadError> {
    let heights = archive.bytes("height", Number::U8)?;
    let widths = archive.bytes("width", Number::U8)?;
    let highest = usize::from(largest(&heights));
    let number = row_type(largest(&widths));
    let rows = archive.bytes("rows", number)?;
    let stride = highest * number.size();
    if heights.len() != widths.len() || rows.len() != heights.len() * stride {
        return Err(unexpected("rows"));
    }
    let mut keys = KeyTable::default();
    let empty = Imprint::empty(MatrixSize::SMALLEST);
    let mut key = ImprintKey::of(&empty);
    for (index, (&height, &width)) in heights.iter().zip(&widths).enumerate() {
        let rows = &rows[index * stride..][..stride];
        if (width, height) == (0, 0) && rows.iter().all(|&byte| byte == 0) {
            key.set(&empty);
        } else {
            let imprint = imprint(rows, number, (width, height));
            key.set(&imprint.ok_or_else(|| unexpected("rows"))?);
        }
        if !keys.add(&key) {
            return Err(ReadError::new("a key is there twice"));
        }
    }
    Ok(keys)
}

fn counts<R: Read + Seek>(
    archive: &mut ArrayReader<R>,
    keys: usize,
) -> Result<Vec<Vec<ShapeCount>>, ReadError> {
    let (numbers, counts) = (archive.words("key")?, archive.words("count")?);
    let shapes = archive.bytes("shape", Number::U16)?;
    if numbers.len() != counts.len() || shapes.len() != 2 * counts.len() {
        return Err(unexpected("count"));
    }
    let shapes = shapes.chunks_exact(2);
    let mut of_keys = vec![Vec::new(); keys];
    for ((number, poses), shape) in numbers.into_iter().zip(counts).zip(shapes) {
        let own = of_keys.get_mut(index(number));
        let own = own.ok_or_else(|| unexpected("key"))?;
        own.push(ShapeCount::new(
            u16::from_le_bytes([shape[0], shape[1]]),
            poses,
        ));
    }
    Ok(of_keys)
}

/// Returns the imprint of a key that has taxels; None if it is not cut to its box.
fn imprint(rows: &[u8], number: Number, (width, height): (u8, u8)) -> Option<Imprint> {
    let mut imprint = Imprint::empty(MatrixSize::new(width, height).ok()?);
    for (row, bytes) in rows.chunks_exact(number.size()).enumerate() {
        let mut word = [0; 8];
        word[..number.size()].copy_from_slice(bytes);
        let word = u64::from_le_bytes(word);
        if word & !imprint.mask() != 0 || row >= height.into() && word != 0 {
            return None;
        }
        imprint.set_word(row, word);
    }
    let bounds = imprint.bounds()?;
    (bounds.columns() == (0..width) && bounds.rows() == (0..height)).then_some(imprint)
}
