//! Models of shapes as files: the user's own, by name in a folder beside the library, and a cache of models that can
//! be trained again.
//!
//! ```text
//! taxel/library/washer.json      the library
//! taxel/models/parts.npz         a model
//! ```

use std::ffi::OsString;
use std::fs;
use std::io::{self, BufReader, Cursor, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::SystemTime;

use xxhash_rust::xxh3::xxh3_128;

use crate::formats::file::without_mark;
use crate::formats::name::folded;
use crate::formats::{ArchiveError, Name, model_header, read_model, write_model};
use crate::recognition::{Model, Training};
use crate::storage::atomic_file::{Existing, FinishedFile, UnfinishedFile, sync_folder};
use crate::storage::error::{ArchiveFileError, LibraryError};
use crate::storage::first_error::FirstErrorWriter;
use crate::storage::folder;
use crate::storage::sweep_file::open_archive;
use crate::sweep::Shard;

/// The ending of a model's file.
const ENDING: &str = "npz";

/// The largest size of a cached model, in bytes.
const MAX_CACHED: u64 = 64 << 20;

/// The version of the algorithms that count the keys of a model. Increase it when the same training makes another
/// model, so that models cached before are not used.
const COUNTING: u32 = 1;

/// Reads a model from a file.
///
/// # Errors
/// Returns an error with the file's name if the file cannot be read or is not a model.
pub fn load_model(path: &Path) -> Result<Model, ArchiveFileError> {
    let mut file = BufReader::new(open_archive(path)?);
    read_model(&mut file).map_err(|error| {
        let error = match error {
            ArchiveError::Zip if is_json(&mut file) => ArchiveError::Untrained,
            error => error,
        };
        ArchiveFileError::new(path, error)
    })
}

/// Returns true if a file begins like a JSON object, as a set of shapes does.
fn is_json(file: &mut (impl Read + Seek)) -> bool {
    let mut start = Vec::new();
    let read = file
        .rewind()
        .and_then(|()| file.take(1 << 10).read_to_end(&mut start));
    let start = without_mark(&start);
    read.is_ok() && start.trim_ascii_start().starts_with(b"{")
}

/// Reads a whole model from a file, so that it can answer touches.
///
/// # Errors
/// Returns the errors of [`load_model`], or [`ArchiveError::PartOfModel`] for a shard, which knows some of the poses
/// only.
pub fn load_whole_model(path: &Path) -> Result<Model, ArchiveFileError> {
    let model = load_model(path)?;
    let shard = model.shard();
    if shard == Shard::WHOLE {
        return Ok(model);
    }
    Err(ArchiveFileError::new(
        path,
        ArchiveError::PartOfModel { shard },
    ))
}

/// The version of a file: another one once the file was written again, as far as its size and its time show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileVersion {
    /// The size of the file, in bytes.
    bytes: u64,
    /// The time when it was written.
    modified: SystemTime,
}

impl FileVersion {
    /// Returns the version of the file at a path; None if there is no file, or if the system keeps no time.
    pub fn of(path: &Path) -> Option<Self> {
        let found = path.metadata().ok()?;
        Some(Self {
            bytes: found.len(),
            modified: found.modified().ok()?,
        })
    }
}

/// Writes a model to a file: all of it or nothing. Nothing is written if `stopped` becomes true on the way.
///
/// # Errors
/// Returns the system's error, with the file's name; also if a file exists and must be kept.
pub fn save_model(
    model: &Model,
    path: &Path,
    existing: Existing,
    stopped: &AtomicBool,
) -> Result<(), ArchiveFileError> {
    let mut file = UnfinishedFile::new(path, existing)?;
    let mut output = FirstErrorWriter::new(&mut file.output, u64::MAX, stopped);
    let written = write_model(model, &mut output);
    let written = output.finish(written);
    written.map_err(|error| ArchiveFileError::new(path, error))?;
    Ok(file.finish()?.persist()?)
}

/// The folder of the user's models.
#[derive(Clone, Debug)]
pub struct ModelFolder(PathBuf);

impl ModelFolder {
    /// Returns the folder `models` beside the folder of a library.
    pub fn beside(library: &Path) -> Self {
        // `.` has no name that could be replaced by another one.
        let whole = match library.file_name() {
            Some(_) => library.to_owned(),
            None => library
                .canonicalize()
                .unwrap_or_else(|_| library.to_owned()),
        };
        Self(whole.with_file_name("models"))
    }

    /// Returns the path of the folder; it may not exist yet.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Returns the file of a model. Upper and lower case count as the same, as for shapes, so a folder can move to a
    /// file system that ignores case.
    pub fn file(&self, name: &Name) -> PathBuf {
        self.path_of(&self.stored_name(name))
    }

    fn path_of(&self, name: &Name) -> PathBuf {
        self.0.join(format!("{name}.{ENDING}"))
    }

    /// Returns a model's name as its file has it; the given name if there is no file.
    fn stored_name(&self, name: &Name) -> Name {
        if self.path_of(name).exists() {
            return name.clone();
        }
        let names = self.names().into_iter().flatten();
        let alike = names.into_iter().find(|other| name.same(other.as_str()));
        alike.unwrap_or_else(|| name.clone())
    }

    /// Returns the names of all models, sorted regardless of case; files that do not look like models are left out.
    ///
    /// # Errors
    /// Returns the system's error, except if the folder does not exist.
    pub fn names(&self) -> Result<Vec<Name>, ArchiveFileError> {
        let files = folder::names(&self.0)
            .map_err(|error| ArchiveFileError::doing(error.doing, &error.path, &error.error))?;
        let name = |file: &OsString| {
            let path = Path::new(file);
            let stem = path.file_stem().and_then(|stem| stem.to_str())?;
            let is_model = path.extension().is_some_and(|ending| ending == ENDING);
            Name::new(stem).ok().filter(|_| is_model)
        };
        let mut names: Vec<Name> = files.iter().filter_map(name).collect();
        names.sort_by_cached_key(|name| (folded(name.as_str()), name.clone()));
        Ok(names)
    }

    /// Creates the folder if there is none, for a model that will be written there.
    ///
    /// # Errors
    /// Returns the system's error, with the folder's name.
    pub fn make(&self) -> Result<MadeFolder, ArchiveFileError> {
        let is_new = !self.0.is_dir();
        match folder::make(&self.0) {
            Ok(()) => Ok(MadeFolder(is_new.then(|| self.0.clone()))),
            Err(LibraryError::System(refused)) => Err(refused.into()),
            Err(LibraryError::InTheWay {
                path,
                what,
                expected,
            }) => {
                let text = format!("is {what}, expected {expected}");
                Err(ArchiveFileError::new(&path, io::Error::other(text)))
            }
            Err(other) => Err(ArchiveFileError::new(&self.0, io::Error::other(other))),
        }
    }

    /// Writes a model under a name, and makes the folder for it.
    ///
    /// # Errors
    /// Returns the errors of [`save_model`].
    pub fn save(
        &self,
        model: &Model,
        name: &Name,
        existing: Existing,
        stopped: &AtomicBool,
    ) -> Result<PathBuf, ArchiveFileError> {
        let _folder = self.make()?;
        let path = self.file(name);
        save_model(model, &path, existing, stopped)?;
        Ok(path)
    }

    /// Removes a model for good: it can be trained again. Returns its name as it was stored.
    ///
    /// # Errors
    /// Returns the system's error, with the file's name.
    pub fn delete(&self, name: &Name) -> Result<Name, ArchiveFileError> {
        let stored = self.stored_name(name);
        let path = self.path_of(&stored);
        fs::remove_file(&path).map_err(|error| ArchiveFileError::new(&path, error))?;
        sync_folder(&self.0)
            .map_err(|error| ArchiveFileError::doing("delete", &path, &error.into_io()))?;
        Ok(stored)
    }
}

/// A folder that exists. If it is new and still empty when this is dropped, it is removed again.
#[derive(Debug)]
#[must_use = "an empty folder is removed when this is dropped"]
pub struct MadeFolder(Option<PathBuf>);

impl Drop for MadeFolder {
    fn drop(&mut self) {
        if let Some(folder) = &self.0 {
            // The system refuses if something is in it.
            let _ = fs::remove_dir(folder);
        }
    }
}

/// A cache of models, which are trained again when they are missing.
///
/// The name of a file is a hash of what was trained, by which version, so another set or grid has another file. A file
/// that is damaged, of an older version, or of something else is not used.
#[derive(Clone, Debug)]
pub struct ModelCache(PathBuf);

impl ModelCache {
    /// Returns the user's cache; None if the user has no home folder.
    pub fn of_user() -> Option<Self> {
        let own = directories::ProjectDirs::from("", "", "taxel")?;
        Some(Self(own.cache_dir().join("models")))
    }

    /// Returns a cache in any folder.
    pub fn in_folder(folder: impl Into<PathBuf>) -> Self {
        Self(folder.into())
    }

    /// Returns the file that holds the model of a training.
    fn file(&self, training: &Training<'_>) -> PathBuf {
        let mut content = format!("{} {COUNTING} ", env!("CARGO_PKG_VERSION")).into_bytes();
        content.extend(model_header(&training.head()));
        self.0.join(format!("{:032x}.{ENDING}", xxh3_128(&content)))
    }

    /// Returns the model of a training if its file exists and is complete.
    fn load(path: &Path, training: &Training<'_>) -> Option<Model> {
        let model = load_model(path).ok()?;
        training.would_make(&model).then_some(model)
    }

    /// Keeps a model. A cache that cannot be written to is not an error: the model is trained again next time. A
    /// model that takes more than 64 MiB is not kept.
    fn keep(&self, path: &Path, model: &Model) {
        self.keep_up_to(MAX_CACHED, path, model);
    }

    fn keep_up_to(&self, most: u64, path: &Path, model: &Model) {
        // In memory first, so that nothing of a model that is too large is written to the disk.
        let mut bytes = Cursor::new(Vec::new());
        let stopped = AtomicBool::new(false);
        let mut output = FirstErrorWriter::new(&mut bytes, most, &stopped);
        let written = write_model(model, &mut output);
        if output.finish(written).is_ok() && folder::make(&self.0).is_ok() {
            let _ = FinishedFile::new(path, bytes.get_ref(), Existing::Replaced)
                .and_then(FinishedFile::persist);
        }
    }
}

/// Returns the model of a training from the cache. If the cache does not have it, `train` makes it, and it is kept
/// there. Without a cache it is trained each time.
///
/// # Errors
/// Returns the errors of `train`.
pub fn cached_or_trained<'a, E>(
    cache: Option<&ModelCache>,
    training: Training<'a>,
    train: impl FnOnce(Training<'a>) -> Result<Model, E>,
) -> Result<Model, E> {
    let Some(cache) = cache else {
        return train(training);
    };
    let path = cache.file(&training);
    if let Some(model) = ModelCache::load(&path, &training) {
        return Ok(model);
    }
    let model = train(training)?;
    cache.keep(&path, &model);
    Ok(model)
}

/// Returns a short text that differs between models with different contents: 32 hexadecimal digits.
pub fn model_hash(model: &Model) -> String {
    format!("{:032x}", xxh3_128(&file_content(model)))
}

/// Returns the bytes of a model's file.
fn file_content(model: &Model) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write_model(model, &mut bytes)
        .expect("memory takes every byte, and an array may have any length");
    bytes.into_inner()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::pose::{Anchor, Axis, Ranges};
    use crate::recognition::{Evaluation, NamedShape};
    use crate::sensor::Sensor;

    fn training(side: f64) -> Training<'static> {
        let sensor = Sensor::default();
        let square = Figure::rectangle(side, side).on(&sensor).expect("in range");
        let disc = Figure::ellipse(2.0, 2.0).on(&sensor).expect("in range");
        let shapes = [
            NamedShape::new("square", square),
            NamedShape::new("disc", disc).weighted(2),
        ];
        let ranges = Ranges::default().with(Axis::Angle, "0:80:10".parse().expect("a range"));
        Training::new(shapes, sensor, Anchor::Centre, ranges).expect("a set")
    }

    #[test]
    fn a_model_comes_back_from_its_file_as_it_was() {
        let folder = tempfile::tempdir().expect("a folder");
        let models = ModelFolder::beside(&folder.path().join("library"));
        assert_eq!(models.path(), folder.path().join("models"));
        assert_eq!(models.names().expect("none").len(), 0);
        let model = training(4.0).run().expect("not stopped");
        let name = Name::new("set").expect("a name");
        let stopped = AtomicBool::new(false);
        let path = models.save(&model, &name, Existing::Kept, &stopped);
        let path = path.expect("written");
        assert!(
            models
                .save(&model, &name, Existing::Kept, &stopped)
                .is_err()
        );
        let again = load_model(&path).expect("read");
        assert_eq!(Evaluation::of(&again), Evaluation::of(&model));
        assert_eq!(again.shapes(), model.shapes());
        assert_eq!(model_hash(&again), model_hash(&model));
        assert_eq!(models.names().expect("one").len(), 1);
        models.delete(&name).expect("it is there");
        assert!(models.delete(&name).is_err());
    }

    #[test]
    fn a_file_in_place_of_the_folder_cannot_be_read_as_a_folder() {
        let folder = tempfile::tempdir().expect("a folder");
        let models = ModelFolder::beside(&folder.path().join("library"));
        fs::write(models.path(), "").expect("written");
        let refused = models.names().expect_err("a file").to_string();
        let expected = format!("{}: cannot read the folder: ", models.path().display());
        assert!(refused.starts_with(&expected), "{refused}");
    }

    #[test]
    fn a_cache_returns_only_models_of_the_same_training() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = ModelCache::in_folder(folder.path().join("cache"));
        // Returns whether a model was trained, and the model.
        let model = |side: f64| {
            let mut is_trained = false;
            let model = cached_or_trained(Some(&cache), training(side), |training| {
                is_trained = true;
                training.run()
            });
            (is_trained, model.expect("not stopped"))
        };
        let trained = training(4.0).run().expect("not stopped");
        let path = cache.file(&training(4.0));
        // A model that is too large is not written.
        cache.keep_up_to(99, &path, &trained);
        assert!(!folder.path().join("cache").exists());
        assert!(model(4.0).0);
        cache.keep_up_to(99, &path, &trained);
        let (is_trained, cached) = model(4.0);
        assert!(!is_trained);
        assert_eq!(Evaluation::of(&cached), Evaluation::of(&trained));
        assert!(model(4.1).0);
        // After damage the model is trained again, and a training that was stopped is not kept.
        let mut bytes = fs::read(&path).expect("it is there");
        bytes.truncate(bytes.len() / 2);
        fs::write(&path, bytes).expect("written");
        let stopped = cached_or_trained(Some(&cache), training(4.0), |_| Err("stopped"));
        assert_eq!(stopped.err(), Some("stopped"));
        assert!(model(4.0).0);
        assert!(!model(4.0).0);
        // Nothing is kept without a cache.
        let trained = cached_or_trained(None, training(4.0), |_| Err("trained"));
        assert_eq!(trained.err(), Some("trained"));
    }

    #[test]
    fn an_exact_name_comes_before_one_that_differs_in_case() {
        let folder = tempfile::tempdir().expect("a folder");
        let models = ModelFolder::beside(&folder.path().join("library"));
        fs::create_dir_all(models.path()).expect("made");
        for name in ["SET", "set"] {
            fs::write(models.path().join(format!("{name}.npz")), "").expect("written");
        }
        // There is only one of them if the file system ignores case.
        for name in models.names().expect("there") {
            let file = models.path().join(format!("{name}.npz"));
            assert_eq!(models.file(&name), file);
        }
    }

    #[test]
    fn models_are_listed_in_the_order_of_the_alphabet_as_shapes_are() {
        let folder = tempfile::tempdir().expect("a folder");
        let models = ModelFolder::beside(&folder.path().join("library"));
        fs::create_dir_all(models.path()).expect("made");
        for name in ["Bar", "apple", "cup"] {
            fs::write(models.path().join(format!("{name}.npz")), "").expect("written");
        }
        let names = models.names().expect("there");
        let names: Vec<&str> = names.iter().map(Name::as_str).collect();
        assert_eq!(names, ["apple", "Bar", "cup"]);
    }

    #[test]
    fn a_model_of_other_shapes_or_poses_is_not_taken_for_that_of_a_training() {
        let folder = tempfile::tempdir().expect("a folder");
        let cache = ModelCache::in_folder(folder.path());
        let whole = training(4.0);
        let own = cache.file(&whole);
        let of = |shapes: &[NamedShape], anchor| {
            let grid = &whole.grids()[0];
            let other = Training::new(shapes.to_vec(), *grid.sensor(), anchor, *grid.ranges());
            other.expect("a set")
        };
        let mut heavier = whole.shapes().to_vec();
        heavier[0].weight = 3;
        for (index, other) in [
            training(4.1),
            of(&whole.shapes()[..1], Anchor::Centre),
            of(whole.shapes(), Anchor::Corner),
            of(&heavier, Anchor::Centre),
            whole.clone().with_shard("1/2".parse().expect("a shard")),
        ]
        .into_iter()
        .enumerate()
        {
            assert_ne!(cache.file(&other), own, "{index}");
            let model = other.clone().run().expect("not stopped");
            let stopped = AtomicBool::new(false);
            save_model(&model, &own, Existing::Replaced, &stopped).expect("written");
            assert!(ModelCache::load(&own, &other).is_some(), "{index}");
            assert!(ModelCache::load(&own, &whole).is_none(), "{index}");
        }
    }

    #[test]
    fn a_model_of_poses_that_are_cut_off_is_only_for_a_training_that_allows_them() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("cut.npz");
        let sensor = Sensor::default();
        let shapes = [NamedShape::new(
            "bar",
            Figure::rectangle(8.0, 2.0).on(&sensor).expect("in range"),
        )];
        let ranges = Ranges::default().with(Axis::X0, "12:12.9:0.1".parse().expect("a range"));
        let training = Training::new(shapes, sensor, Anchor::Corner, ranges).expect("a set");
        let allowed = training.clone().allow_cut(true);
        let model = allowed.clone().run().expect("not stopped");
        save_model(&model, &path, Existing::Kept, &AtomicBool::new(false)).expect("written");
        assert!(ModelCache::load(&path, &allowed).is_some());
        assert!(ModelCache::load(&path, &training).is_none());
    }
}
