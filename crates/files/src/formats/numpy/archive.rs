//! Archives of numpy arrays (`numpy.load`), as taxel writes atlases and models: a zip without compression and without
//! dates, so that equal contents are equal files. The first array, `header`, is JSON as bytes.

use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};

use serde::Deserialize;
use taxel_core::quote::shortened;
use taxel_core::sweep::Shard;
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use crate::error::{ReadError, ReadErrorKind};
use crate::formats::header::{ATLAS_FORMAT, ArchiveHeader, MODEL_FORMAT};
use crate::formats::json;
use crate::formats::numpy::{self, Header, Number};

/// The name of the array that describes the archive.
pub(crate) const HEADER: &str = "header";

/// The output of an archive. Writing to a reference to this trait compiles the code of zip, which is large, once
/// instead of once for each kind of output.
pub(crate) trait WriteSeek: Write + Seek {}

impl<W: Write + Seek> WriteSeek for W {}

/// Writes arrays one after the other.
pub(crate) struct ArrayWriter<'a>(ZipWriter<&'a mut dyn WriteSeek>);

impl<'a> ArrayWriter<'a> {
    /// Begins an archive with its header.
    pub(crate) fn new(output: &'a mut dyn WriteSeek, header: &[u8]) -> io::Result<Self> {
        let mut archive = Self(ZipWriter::new(output));
        archive.add(HEADER, Number::U8, &[header.len() as u64], header)?;
        Ok(archive)
    }

    /// Writes an array of that shape; `numbers` are its bytes, the last axis fastest.
    pub(crate) fn add(
        &mut self,
        name: &str,
        number: Number,
        shape: &[u64],
        numbers: &[u8],
    ) -> io::Result<()> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::default())
            .large_file(numbers.len() >= 1 << 31);
        self.0.start_file(format!("{name}.npy"), options)?;
        self.0.write_all(&numpy::header(number, shape))?;
        self.0.write_all(numbers)
    }

    /// Writes an array of one axis.
    pub(crate) fn add_words(&mut self, name: &str, words: &[u64]) -> io::Result<()> {
        let numbers = little_endian(words);
        self.add(name, Number::U64, &[words.len() as u64], &numbers)
    }

    pub(crate) fn finish(self) -> io::Result<()> {
        self.0.finish()?.flush()
    }
}

pub(crate) fn little_endian(words: &[u64]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

pub(crate) struct ArrayReader<R> {
    archive: ZipArchive<R>,
    read: Vec<&'static str>,
}

impl<R: Read + Seek> ArrayReader<R> {
    pub(crate) fn new(mut input: R) -> Result<Self, ReadError> {
        let mut rest = input.seek(SeekFrom::End(0))?;
        let named = |error: ReadError| {
            let what = "cannot be read as an atlas or a model, an .npz file written by taxel";
            ReadError::new(format!("{what}: {error}")).of_kind(error.kind)
        };
        let mut archive = ZipArchive::new(input).map_err(|error| named(refused(error)))?;
        for index in 0..archive.len() {
            let file = archive.by_index(index).map_err(refused)?;
            let name = file.name().map_err(refused)?;
            let name = name.trim_end_matches(".npy");
            // Decompressed, a short file could fill all memory.
            if file.compression() != CompressionMethod::Stored {
                let name = shortened(name);
                let expected = "expected one as taxel writes it, without compression";
                return Err(ReadError::new(format!(
                    "array {name:?} is compressed, {expected}"
                )));
            }
            // Arrays that share their bytes could take for ever.
            let left = rest.checked_sub(file.compressed_size());
            rest = left.ok_or_else(|| damaged(name))?;
        }
        let read = Vec::new();
        Ok(Self { archive, read })
    }

    /// The numbers of an array of this type as bytes, little-endian.
    pub(crate) fn bytes(
        &mut self,
        name: &'static str,
        number: Number,
    ) -> Result<Vec<u8>, ReadError> {
        let mut file = match self.archive.by_name(&format!("{name}.npy")) {
            Err(ZipError::FileNotFound) => return Err(unexpected(name)),
            file => file.map_err(refused)?,
        };
        self.read.push(name);
        let header = Header::read(&mut file).map_err(|error| match error.kind {
            ReadErrorKind::Io(_) => in_array(name, error),
            _ => unexpected(name),
        })?;
        if header.fortran_order || header.number() != Some(number) {
            return Err(unexpected(name));
        }
        let mut bytes = Vec::new();
        let read = file.read_to_end(&mut bytes);
        read.map_err(|error| in_array(name, error.into()))?;
        Ok(bytes)
    }

    pub(crate) fn words(&mut self, name: &'static str) -> Result<Vec<u64>, ReadError> {
        let bytes = self.bytes(name, Number::U64)?;
        let (words, rest) = bytes.as_chunks::<8>();
        if !rest.is_empty() {
            return Err(unexpected(name));
        }
        Ok(words.iter().map(|&word| u64::from_le_bytes(word)).collect())
    }

    /// Reads the header, and checks that it is of this format.
    pub(crate) fn header(&mut self, format: &str) -> Result<ArchiveHeader, ReadError> {
        let header = self.bytes(HEADER, Number::U8)?;
        // Another format has other keys, so the format is reported before a missing key.
        let found = parsed::<Head>(&header)?.format;
        if found == format {
            return parsed(&header);
        }
        let text = match found.as_str() {
            ATLAS_FORMAT => "an atlas of taxel sweep, expected a model".to_owned(),
            MODEL_FORMAT => "a model, expected an atlas of taxel sweep".to_owned(),
            _ => {
                let found = shortened(&found);
                format!("format: {found:?} is unknown to this version, which reads {format:?}")
            }
        };
        Err(ReadError::new(text))
    }

    /// Reads and discards all other arrays: damage to an array is only found at its end, and an archive must not pass
    /// as intact if one of them is damaged.
    pub(crate) fn finish(mut self) -> Result<(), ReadError> {
        for index in 0..self.archive.len() {
            let mut file = self.archive.by_index(index).map_err(refused)?;
            let name = file.name().map_err(refused)?.into_owned();
            let name = name.trim_end_matches(".npy");
            if !self.read.contains(&name) {
                let read = io::copy(&mut file, &mut io::sink());
                read.map_err(|error| in_array(name, error.into()))?;
            }
        }
        Ok(())
    }
}

/// The error for an array that is missing, or not of the expected type or size.
pub(crate) fn unexpected(name: &str) -> ReadError {
    ReadError::new(format!("array {name:?} is not as taxel writes it"))
}

fn damaged(name: &str) -> ReadError {
    ReadError::new(format!("array {:?} is damaged", shortened(name)))
}

/// The error for an array of an archive: bytes that cannot be unpacked, or that have another checksum, are damage to
/// the array, not to the disk.
pub(crate) fn in_array(name: &str, error: ReadError) -> ReadError {
    match error.kind {
        ReadErrorKind::Io(
            ErrorKind::InvalidData | ErrorKind::InvalidInput | ErrorKind::UnexpectedEof,
        ) => damaged(name),
        ReadErrorKind::Io(_) => error,
        kind => ReadError::new(format!("array {:?}: {error}", shortened(name))).of_kind(kind),
    }
}

/// The error for a file that is not an archive, in words that require no knowledge of its layout.
pub(crate) fn refused(error: ZipError) -> ReadError {
    let message = match error {
        ZipError::Io(error) if error.raw_os_error().is_some() => return error.into(),
        ZipError::UnsupportedArchive(what) => format!("an archive: {what}"),
        _ => "an archive that is cut short or damaged, or a file of another kind".to_owned(),
    };
    ReadError::new(message).of_kind(ReadErrorKind::UnknownFormat)
}

/// Returns the format of an archive and the shard of the sweep or model that it holds, reading only its header.
///
/// # Errors
/// Returns an error if it is not an archive with such a header.
pub fn kind_of(input: impl Read + Seek) -> Result<(String, Shard), ReadError> {
    let head: Head = parsed(&ArrayReader::new(input)?.bytes(HEADER, Number::U8)?)?;
    Ok((head.format, head.shard.parse().map_err(in_header)?))
}

/// The keys that the headers of all formats have.
#[derive(Deserialize)]
#[serde(expecting = "an object")]
struct Head {
    format: String,
    #[serde(default)]
    shard: String,
}

fn parsed<'a, T: Deserialize<'a>>(header: &'a [u8]) -> Result<T, ReadError> {
    json::object(header).map_err(|error| in_header(json::message(&error)))
}

/// The error for something in a header.
pub(crate) fn in_header(error: impl std::fmt::Display) -> ReadError {
    ReadError::new(format!("header: {error}"))
}
