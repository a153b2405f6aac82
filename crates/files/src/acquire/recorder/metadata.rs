//! The metadata beside an array: `touch.json` for `touch.npy`.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::acquire::recorder::error::{MetadataFileError, RecorderError, refused};
use crate::acquire::recorder::record_array::{HEADER, is_own};
use crate::formats::file::has_ending;
use crate::formats::recording::RecordingMetadata;
use crate::storage::{Existing, FileId, FinishedFile, persist_beside};

/// The size limit of metadata in bytes, 4 MiB.
const LARGEST_METADATA: u64 = 1 << 22;

/// Metadata that is to be written. Writing it takes as long as the disk does, and needs no recorder: meanwhile,
/// frames can be added to the recorder.
/// ```text
/// set_view -> MetadataDraft -> prepare -> take_metadata -> PreparedMetadata -> give_name
/// ```
#[derive(Debug)]
pub struct MetadataDraft {
    /// The path of the array.
    pub(super) path: PathBuf,
    pub(super) metadata: RecordingMetadata,
}

impl MetadataDraft {
    /// Writes the metadata to the disk, without its name. A file under that name does not matter yet: meanwhile, the
    /// array and the previous metadata may get their names.
    ///
    /// # Errors
    /// Returns the system's error.
    pub fn prepare(&self) -> Result<FinishedFile, RecorderError> {
        prepared(&self.path, Existing::Replaced, &self.metadata)
    }
}

/// Metadata on the disk, which must get its name at once, beside an array that already has its name.
#[derive(Debug)]
pub struct PreparedMetadata {
    pub(super) file: FinishedFile,
    /// The array, which is open until the metadata has its name.
    pub(super) array: FileId,
    /// The path of the array.
    pub(super) path: PathBuf,
}

impl PreparedMetadata {
    /// Gives the metadata its name.
    ///
    /// # Errors
    /// Returns [`RecorderError::Replaced`] if the name of the array now belongs to another file, which the metadata
    /// does not describe, or the system's error.
    pub fn give_name(self) -> Result<(), RecorderError> {
        let Self { file, array, path } = self;
        if persist_beside((array, &path), file).map_err(refused)? {
            Ok(())
        } else {
            Err(RecorderError::Replaced { path })
        }
    }
}

/// Writes metadata to the disk, without its name.
///
/// # Errors
/// Returns the system's error.
pub(super) fn prepared(
    array: &Path,
    existing: Existing,
    metadata: &RecordingMetadata,
) -> Result<FinishedFile, RecorderError> {
    let path = array.with_extension("json");
    FinishedFile::new(&path, &metadata.text(), existing).map_err(refused)
}

/// Writes the metadata over the old one, if a full disk has no room for both.
///
/// # Errors
/// Returns the system's error.
pub(super) fn overwrite(array: &Path, metadata: &RecordingMetadata) -> io::Result<()> {
    let text = metadata.text();
    let path = array.with_extension("json");
    let mut file = File::options().write(true).open(path)?;
    let old = file.seek(SeekFrom::End(0))?;
    let missing = (text.len() as u64).saturating_sub(old);
    // Blanks after the text change nothing. The text is replaced only if there is room for them.
    if let Err(error) = io::copy(&mut io::repeat(b' ').take(missing), &mut file) {
        file.set_len(old)?;
        return Err(error);
    }
    file.seek(SeekFrom::Start(0))?;
    file.write_all(&text)?;
    file.set_len(text.len() as u64)?;
    file.sync_all()
}

/// Returns true if a path ends like the file of an array.
pub(super) fn is_array(path: &Path) -> bool {
    has_ending(path, "npy")
}

/// Reads the metadata beside an array: `touch.json` for `touch.npy`. Returns None if an array of another program has no
/// metadata beside it.
///
/// # Errors
/// Returns an error if the metadata is damaged, of another version or cannot be read; or if there is none although
/// taxel has recorded the array.
pub fn metadata_beside(path: &Path) -> Option<Result<RecordingMetadata, MetadataFileError>> {
    if !is_array(path) {
        return None;
    }
    read_beside(path).or_else(|| {
        if !is_recorded(path) {
            return None;
        }
        let path = path.with_extension("json");
        Some(Err(if path.exists() {
            MetadataFileError::Foreign { path }
        } else {
            MetadataFileError::Missing { path }
        }))
    })
}

/// Returns true if taxel has recorded an array.
fn is_recorded(path: &Path) -> bool {
    let start = || {
        let mut start = Vec::new();
        // Opening a pipe would wait for its writer.
        if path.metadata()?.is_file() {
            File::open(path)?.take(HEADER).read_to_end(&mut start)?;
        }
        Ok::<_, io::Error>(start)
    };
    start().is_ok_and(|start| is_own(&start))
}

/// Reads the metadata beside an array. Returns None if there is no such file, or if it is not metadata.
///
/// # Errors
/// Returns an error if the metadata is too large, damaged, of another version or cannot be read.
pub(super) fn read_beside(path: &Path) -> Option<Result<RecordingMetadata, MetadataFileError>> {
    let path = path.with_extension("json");
    let content = || {
        let mut bytes = Vec::new();
        // Opening a pipe would wait for its writer.
        if path.metadata()?.is_file() {
            let file = File::open(&path)?;
            file.take(LARGEST_METADATA + 1).read_to_end(&mut bytes)?;
        }
        Ok::<_, io::Error>(bytes)
    };
    match content() {
        Ok(bytes) => {
            let read = RecordingMetadata::read(&bytes)?;
            if bytes.len() as u64 > LARGEST_METADATA {
                return Some(Err(MetadataFileError::Large { path }));
            }
            Some(read.map_err(|error| MetadataFileError::Broken { path, error }))
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => None,
        Err(error) => Some(Err(MetadataFileError::Io { path, error })),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn metadata_that_is_too_large_is_not_called_damaged() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a.npy");
        let text = RecordingMetadata::default().text();
        for (size, is_read) in [(1 << 22, true), ((1 << 22) + 1, false)] {
            let blanks = vec![b' '; size - text.len()];
            let written = [&blanks[..], &text].concat();
            std::fs::write(path.with_extension("json"), written).expect("written");
            match metadata_beside(&path).expect("there") {
                Ok(_) => assert!(is_read),
                Err(error) => {
                    let message = error.to_string();
                    assert!(
                        !is_read && message.contains("larger than 4 MiB"),
                        "{message}"
                    );
                }
            }
        }
    }
}
