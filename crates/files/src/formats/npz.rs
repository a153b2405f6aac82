//! Archives of numpy arrays (`numpy.load`): a zip without compression and without dates, so that equal contents are
//! equal files.

use std::io::{self, Read, Seek, SeekFrom, Write};

use serde::Deserialize;
use taxel_core::pose::{GridError, RangeError};
use taxel_core::quote::shortened;
use taxel_core::sweep::{PartsError, Shard, ShardError};
use zip::read::ZipFile;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use crate::error::ReadError;
use crate::formats::file::system_reason;
use crate::formats::json;
use crate::formats::npy::{self, Dtype};
use crate::formats::value::{counted, grouped};

/// The name of the array that describes the archive: JSON as bytes.
pub(crate) const HEADER: &str = "header";

/// The size limit of a header in bytes: a shape of 64 × 64 taxels takes a few thousand.
const MAX_HEADER: u64 = 1 << 26;

/// The size limit of an array in bytes; a larger one is not read.
const MAX_BYTES: u64 = 1 << 34;

/// The length of the longest archive that is read: 1 GiB in a 32-bit program, no limit in practice in a 64-bit one. The
/// values read from an archive may take four times its length.
const LONGEST: u64 = (usize::MAX / 4) as u64;

/// The output of an archive. Writing to a reference to this trait compiles the code of zip, which is large, once
/// instead of once for each kind of output.
pub(crate) trait WriteSeek: Write + Seek {}

impl<W: Write + Seek> WriteSeek for W {}

/// Writes arrays one after the other.
pub(crate) struct ArrayWriter<'a>(ZipWriter<&'a mut dyn WriteSeek>);

impl<'a> ArrayWriter<'a> {
    pub(crate) fn new(output: &'a mut dyn WriteSeek) -> Self {
        Self(ZipWriter::new(output))
    }

    /// Writes an array of that shape; `numbers` are its bytes, the last axis fastest.
    pub(crate) fn add<const N: usize>(
        &mut self,
        name: &str,
        kind: Dtype,
        shape: &[u64; N],
        numbers: &[u8],
    ) -> Result<(), ArchiveError> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::default())
            .large_file(numbers.len() >= 1 << 31);
        let file = format!("{name}.npy");
        self.0.start_file(file, options).map_err(zip_error)?;
        self.0.write_all(&npy::header(kind, shape))?;
        self.0.write_all(numbers)?;
        Ok(())
    }

    pub(crate) fn finish(self) -> Result<(), ArchiveError> {
        self.0.finish().map_err(zip_error)?.flush()?;
        Ok(())
    }
}

pub(crate) struct ArrayReader<R> {
    archive: ZipArchive<R>,
    length: u64,
    read: Vec<&'static str>,
}

impl<R: Read + Seek> ArrayReader<R> {
    pub(crate) fn new(mut input: R) -> Result<Self, ArchiveError> {
        let length = input.seek(SeekFrom::End(0))?;
        check_length(length, LONGEST)?;
        Ok(Self {
            length,
            archive: ZipArchive::new(input).map_err(zip_error)?,
            read: Vec::new(),
        })
    }

    fn file(&mut self, name: &'static str) -> Result<Vec<u8>, ArchiveError> {
        self.read.push(name);
        let mut file = match self.archive.by_name(&format!("{name}.npy")) {
            Err(ZipError::FileNotFound) => return Err(ArchiveError::Array(name)),
            file => file.map_err(zip_error)?,
        };
        is_stored(&file, name)?;
        let most = if name == HEADER {
            MAX_HEADER
        } else {
            MAX_BYTES
        };
        if file.size() > most {
            return Err(ArchiveError::Array(name));
        }
        let mut bytes = Vec::new();
        // The size that the archive gives may be wrong.
        let read = file.by_ref().take(most).read_to_end(&mut bytes);
        read.map_err(|error| damaged(name, error))?;
        Ok(bytes)
    }

    /// Reads and discards all other arrays: damage to an array is only found at its end, and an archive must not pass
    /// as intact if one of them is damaged.
    pub(crate) fn finish(mut self) -> Result<(), ArchiveError> {
        // Arrays that share their bytes could take for ever, however short the archive.
        let mut rest = self.length;
        for index in 0..self.archive.len() {
            let mut file = self.archive.by_index(index).map_err(zip_error)?;
            let name = file
                .name()
                .map_err(zip_error)?
                .trim_end_matches(".npy")
                .to_owned();
            is_stored(&file, &name)?;
            if self.read.contains(&name.as_str()) {
                continue;
            }
            let Some(left) = rest.checked_sub(file.compressed_size()) else {
                return Err(ArchiveError::Damaged(shortened(&name)));
            };
            rest = left;
            let read = io::copy(&mut file.by_ref().take(MAX_BYTES), &mut io::sink());
            read.map_err(|error| damaged(&name, error))?;
        }
        Ok(())
    }

    /// Returns the numbers of an array as bytes, little-endian.
    pub(crate) fn bytes(
        &mut self,
        name: &'static str,
        kind: Dtype,
    ) -> Result<Vec<u8>, ArchiveError> {
        let mut file = self.file(name)?;
        let numbers = npy::content(&file, kind).ok_or(ArchiveError::Array(name))?;
        let start = file.len() - numbers.len();
        file.drain(..start);
        Ok(file)
    }

    pub(crate) fn words(&mut self, name: &'static str) -> Result<Vec<u64>, ArchiveError> {
        npy::words(&self.file(name)?).ok_or(ArchiveError::Array(name))
    }

    pub(crate) fn header(&mut self) -> Result<Vec<u8>, ArchiveError> {
        self.bytes(HEADER, Dtype::U8)
    }
}

fn check_length(length: u64, longest: u64) -> Result<(), ArchiveError> {
    if length > longest {
        return Err(ArchiveError::Long { length, longest });
    }
    Ok(())
}

/// Checks that an array is not compressed: decompressed, a short file could fill all memory.
fn is_stored(file: &ZipFile<'_, impl Read>, name: &str) -> Result<(), ArchiveError> {
    if file.compression() == CompressionMethod::Stored {
        return Ok(());
    }
    Err(ArchiveError::Compressed(shortened(name)))
}

/// Returns the error for an array that cannot be read to its end: the system's reason, or a wrong checksum.
fn damaged(name: &str, error: io::Error) -> ArchiveError {
    if error.raw_os_error().is_some() || error.kind() == io::ErrorKind::OutOfMemory {
        return error.into();
    }
    ArchiveError::Damaged(shortened(name))
}

pub(crate) fn little_endian(words: &[u64]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

/// The kind of an archive and its shard, from the header.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArchiveKind {
    /// The value of the key `format`.
    pub format: String,
    /// The shard of the sweep or model that the file holds.
    pub shard: Shard,
}

/// Returns the kind of an archive, reading only its header.
///
/// # Errors
/// Returns an error if it is not an archive with such a header.
pub fn kind_of(input: impl Read + Seek) -> Result<ArchiveKind, ArchiveError> {
    #[derive(Deserialize)]
    #[serde(expecting = "an object")]
    struct Part {
        shard: String,
    }
    let header = ArrayReader::new(input)?.header()?;
    let format = format_in(&header)?;
    let part: Part = parsed(&header)?;
    let shard = part.shard.parse()?;
    Ok(ArchiveKind { format, shard })
}

/// Returns the format in a header, without checking the other keys.
fn format_in(header: &[u8]) -> Result<String, ArchiveError> {
    #[derive(Deserialize)]
    #[serde(expecting = "an object")]
    struct Format {
        format: String,
    }
    let format: Format = parsed(header)?;
    Ok(format.format)
}

fn parsed<'a, T: Deserialize<'a>>(header: &'a [u8]) -> Result<T, ArchiveError> {
    json::object(header).map_err(|error| ArchiveError::Header(json::message(&error)))
}

/// Parses a header of the format `expected`.
pub(crate) fn header_of<'a, T: Deserialize<'a>>(
    header: &'a [u8],
    expected: &'static str,
) -> Result<T, ArchiveError> {
    // Another format has other keys, so the format is reported before a missing key.
    let found = format_in(header)?;
    if found != expected {
        let found = shortened(&found);
        return Err(ArchiveError::Format { found, expected });
    }
    parsed(header)
}

/// Returns the error for an archive, in words that require no knowledge of its layout. The error type of the zip
/// crate is not part of the interface.
fn zip_error(error: ZipError) -> ArchiveError {
    match error {
        ZipError::Io(error) if error.raw_os_error().is_some() => ArchiveError::Io(error),
        ZipError::UnsupportedArchive(what) => ArchiveError::Unsupported(what.to_string()),
        _ => ArchiveError::Zip,
    }
}

/// Returns the message for an archive of another format: another kind, or another version.
fn other_format(found: &str, expected: &str) -> String {
    let kind = |format: &str| match format.split_once('/')? {
        ("taxel-atlas", _) => Some("an atlas of taxel sweep"),
        ("taxel-model", _) => Some("a model"),
        _ => None,
    };
    match (kind(found), kind(expected)) {
        (Some(found), Some(expected)) if found != expected => {
            format!("{found}, expected {expected}")
        }
        _ => format!("format: {found:?} is unknown to this version, which reads {expected:?}"),
    }
}

/// The beginning of the message for a file that is not an archive of taxel's.
const NOT_READ: &str = "cannot be read as an atlas or a model, an .npz file written by taxel";

/// The error for an archive that cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum ArchiveError {
    /// An error of the system. It is part of the message, so it is not the source of this error, too.
    #[error("{}", system_reason(.0))]
    Io(io::Error),
    /// Not a zip, or a broken one.
    #[error("{NOT_READ}: cut short, damaged, or a file of another kind")]
    Zip,
    /// A zip of a kind that is not supported, in words.
    #[error("{NOT_READ}: {0}")]
    Unsupported(String),
    /// The archive is too long for the address space of this program.
    #[error("an archive of {}; this {}-bit program reads at most {}", counted(*length, "byte"), usize::BITS, grouped(*longest))]
    Long {
        /// The length in bytes.
        length: u64,
        /// The length of the longest archive that is read, in bytes.
        longest: u64,
    },
    /// An array whose bytes have changed since they were written.
    #[error("array {0:?} is damaged")]
    Damaged(String),
    /// An array that another program has compressed.
    #[error("array {0:?} is compressed, expected one as taxel writes it, without compression")]
    Compressed(String),
    /// An array that is missing, or not of the expected type or size.
    #[error("array {0:?} is not as taxel writes it")]
    Array(&'static str),
    /// Another format, perhaps a newer version.
    #[error("{}", other_format(found, expected))]
    Format {
        /// The format of the archive.
        found: String,
        /// The format that can be read here.
        expected: &'static str,
    },
    /// An invalid header.
    #[error("header: {0}")]
    Header(String),
    /// An invalid source or sensor. Like the following three, it is part of the message, so it is not the source of this
    /// error, too.
    #[error("header: {0}")]
    Record(ReadError),
    /// An invalid range.
    #[error("header: {0}")]
    Range(RangeError),
    /// An invalid shard.
    #[error("header: {0}")]
    Shard(ShardError),
    /// An invalid grid.
    #[error("header: {0}")]
    Grid(GridError),
    /// Numbers that contradict each other.
    #[error(transparent)]
    Parts(#[from] PartsError),
    /// A shard of a model where a whole one is wanted.
    #[error("shard {shard} of a model only; 'taxel merge' puts shards together")]
    PartOfModel {
        /// The shard.
        shard: Shard,
    },
    /// Text where a model is expected, perhaps a set of shapes to train one on.
    #[error("not a model; if it is a set of shapes, 'taxel model train' makes a model of it")]
    Untrained,
    /// Shapes or numbers that do not make a model.
    #[error(transparent)]
    Model(#[from] taxel_core::recognition::ModelError),
}

impl From<io::Error> for ArchiveError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl From<ReadError> for ArchiveError {
    fn from(error: ReadError) -> Self {
        Self::Record(error)
    }
}

impl From<RangeError> for ArchiveError {
    fn from(error: RangeError) -> Self {
        Self::Range(error)
    }
}

impl From<ShardError> for ArchiveError {
    fn from(error: ShardError) -> Self {
        Self::Shard(error)
    }
}

impl From<GridError> for ArchiveError {
    fn from(error: GridError) -> Self {
        Self::Grid(error)
    }
}

#[cfg(test)]
mod tests {
    use std::error::Error;

    use super::*;

    #[test]
    fn the_error_of_a_broken_zip_has_no_source() {
        let broken = ArrayReader::new(io::Cursor::new(b"PK")).err();
        let broken = broken.expect("two bytes are no archive");
        assert_eq!(
            broken.to_string(),
            "cannot be read as an atlas or a model, an .npz file written by taxel: cut short, damaged, or a file of another kind"
        );
        assert!(broken.source().is_none());
    }

    #[cfg(unix)]
    #[test]
    fn an_error_of_the_system_is_without_its_number() {
        let full = ArchiveError::from(io::Error::from_raw_os_error(28));
        assert_eq!(full.to_string(), "No space left on device");
        assert!(full.source().is_none());
    }

    #[test]
    fn an_error_of_the_header_is_printed_once() {
        let wrong = "5:1"
            .parse::<taxel_core::pose::DecimalRange>()
            .expect_err("the end is before the start");
        let error = ArchiveError::from(wrong.clone());
        assert_eq!(error.to_string(), format!("header: {wrong}"));
        assert!(error.source().is_none(), "its message has the reason");
    }

    #[test]
    fn an_archive_that_does_not_fit_into_memory_is_not_called_damaged() {
        let error = damaged("rows", io::ErrorKind::OutOfMemory.into());
        assert!(matches!(error, ArchiveError::Io(_)), "{error}");
        let error = damaged("rows", io::ErrorKind::UnexpectedEof.into());
        assert_eq!(error.to_string(), "array \"rows\" is damaged");
    }

    #[test]
    fn an_archive_that_is_too_long_is_refused() {
        assert!(check_length(1 << 30, 1 << 30).is_ok());
        let error = check_length(3_000_000_000, 1 << 30).expect_err("too long");
        assert_eq!(
            error.to_string(),
            format!(
                "an archive of 3,000,000,000 bytes; this {}-bit program reads at most 1,073,741,824",
                usize::BITS
            )
        );
    }

    #[test]
    fn the_error_of_a_model_keeps_its_message() {
        let shards =
            taxel_core::recognition::ModelError::from(taxel_core::sweep::ShardOrderError::Nothing);
        let wrapped = ArchiveError::from(shards.clone());
        assert_eq!(wrapped.to_string(), shards.to_string());
        assert!(wrapped.source().is_none());
    }
}
