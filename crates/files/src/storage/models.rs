//! Models of shapes as files: the user's own, by name in a folder beside the library, and a cache of models that can
//! be trained again.
//!
//! ```text
//! taxel/library/washer.json      the library
//! taxel/models/parts.npz         a model
//! ```

use std::ffi::{OsStr, OsString};
use std::io::{self, BufReader, Cursor, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;
use std::time::SystemTime;
use std::{fmt, fs};

use taxel_core::picture::Picture;
use taxel_core::quote::{did_you_mean, shortened};
use taxel_core::recognition::{
    GridSteps, Model, NamedShape, Training, TrainingError, default_figures, equal_figures,
};
use taxel_core::sweep::Shard;
use xxhash_rust::xxh3::xxh3_128;

use crate::formats::file::without_mark;
use crate::formats::name::folded;
use crate::formats::{ArchiveError, Name, StoredShape, model_header, read_model, write_model};
use crate::storage::error::{ArchiveFileError, LibraryError};
use crate::storage::file::{self, Existing, NewFile, sync_folder};
use crate::storage::sweep_file::{FirstErrorWriter, open_archive};
use crate::storage::{folder, shipped};

const ENDING: &str = "npz";

/// The largest size of a cached model, in bytes.
const MAX_CACHED: usize = 64 << 20;

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

/// Whether a file begins like a JSON object, as a set of shapes does.
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
/// The errors of [`load_model`], or [`ArchiveError::PartOfModel`] for a shard, which knows some of the poses
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
    bytes: u64,
    modified: SystemTime,
}

impl FileVersion {
    /// The version of the file at a path; None if there is no file, or if the system keeps no time.
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
/// The system's error, with the file's name; also if a file exists and must be kept.
pub fn save_model(
    model: &Model,
    path: &Path,
    existing: Existing,
    stopped: &AtomicBool,
) -> Result<(), ArchiveFileError> {
    let mut file = NewFile::begin(path, existing)?;
    let mut output = FirstErrorWriter::new(&mut file.output, stopped);
    let written = write_model(model, &mut output);
    let written = output.finish(written);
    written.map_err(|error| ArchiveFileError::new(path, error))?;
    file.persist()?;
    Ok(())
}

/// The folder of the user's models.
#[derive(Clone, Debug)]
pub struct ModelFolder(PathBuf);

impl ModelFolder {
    /// The folder `models` beside the folder of a library.
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

    /// The path of the folder; it may not exist yet.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// The file of a model. Upper and lower case count as the same, as for shapes, so a folder can move to a
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

    /// The names of all models, sorted regardless of case; files that do not look like models are left out.
    ///
    /// # Errors
    /// The system's error, except if the folder does not exist.
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
    /// The system's error, with the folder's name.
    pub fn make(&self) -> Result<(), ArchiveFileError> {
        folder::make(&self.0).map_err(|error| match error {
            LibraryError::System(refused) => refused.into(),
            LibraryError::InTheWay {
                path,
                what,
                expected,
            } => {
                let text = format!("is {what}, expected {expected}");
                ArchiveFileError::new(&path, io::Error::other(text))
            }
            other => ArchiveFileError::new(&self.0, io::Error::other(other)),
        })
    }

    /// Writes a model under a name, and makes the folder for it.
    ///
    /// # Errors
    /// The errors of [`save_model`].
    pub fn save(
        &self,
        model: &Model,
        name: &Name,
        existing: Existing,
        stopped: &AtomicBool,
    ) -> Result<PathBuf, ArchiveFileError> {
        self.make()?;
        let path = self.file(name);
        save_model(model, &path, existing, stopped)?;
        Ok(path)
    }

    /// Removes a model for good: it can be trained again. Returns its name as it was stored.
    ///
    /// # Errors
    /// The system's error, with the file's name.
    pub fn delete(&self, name: &Name) -> Result<Name, ArchiveFileError> {
        let stored = self.stored_name(name);
        let path = self.path_of(&stored);
        fs::remove_file(&path).map_err(|error| ArchiveFileError::new(&path, error))?;
        sync_folder(&self.0)
            .map_err(|error| ArchiveFileError::doing("delete", &path, &error.error))?;
        Ok(stored)
    }
}

/// A cache of models, which are trained again when they are missing.
///
/// The name of a file is a hash of what was trained, by which version, so another set or grid has another file. A file
/// that is damaged, of an older version, or of something else is not used.
#[derive(Clone, Debug)]
pub struct ModelCache(PathBuf);

impl ModelCache {
    /// The user's cache; None if the user has no home folder.
    pub fn of_user() -> Option<Self> {
        let own = directories::ProjectDirs::from("", "", "taxel")?;
        Some(Self(own.cache_dir().join("models")))
    }

    /// Returns a cache in any folder.
    pub fn in_folder(folder: impl Into<PathBuf>) -> Self {
        Self(folder.into())
    }

    fn file(&self, training: &Training<'_>) -> PathBuf {
        let mut content = format!("{} {COUNTING} ", env!("CARGO_PKG_VERSION")).into_bytes();
        content.extend(model_header(&training.head()));
        self.0.join(format!("{:032x}.{ENDING}", xxh3_128(&content)))
    }

    /// Keeps a model. A cache that cannot be written to is not an error: the model is trained again next time. A
    /// model that takes more than 64 MiB is not kept.
    fn keep(&self, path: &Path, model: &Model) {
        let bytes = file_content(model);
        if bytes.len() <= MAX_CACHED && folder::make(&self.0).is_ok() {
            let _ = file::write(path, &bytes, Existing::Replaced);
        }
    }
}

/// The model of a training from the cache. If the cache does not have it, `train` makes it, and it is kept
/// there. Without a cache it is trained each time.
///
/// # Errors
/// The errors of `train`.
pub fn cached_or_trained<'a, E>(
    cache: Option<&ModelCache>,
    training: Training<'a>,
    train: impl FnOnce(Training<'a>) -> Result<Model, E>,
) -> Result<Model, E> {
    let Some(cache) = cache else {
        return train(training);
    };
    let path = cache.file(&training);
    let kept = load_model(&path).ok();
    if let Some(model) = kept.filter(|model| training.would_make(model)) {
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

fn file_content(model: &Model) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write_model(model, &mut bytes)
        .expect("memory takes every byte, and an array may have any length");
    bytes.into_inner()
}

/// A set of shapes that can be chosen for recognition.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum ModelChoice {
    /// The seven figures at the sizes that forms propose.
    Figures,
    /// The seven figures of about 30 cells.
    EqualFigures,
    /// The shapes that come with the program.
    Shipped,
    /// A stored model.
    Stored(Name),
    /// A model in a file.
    File(PathBuf),
}

/// The steps of the grid of the shapes that come with the program. In hundredths and whole degrees they leave 5.2
/// million imprints; in these steps they are trained in a second or two.
const SHIPPED_STEPS: GridSteps = GridSteps::COARSE;

impl ModelChoice {
    /// The choices that need no file.
    pub const BUILT_IN: &'static [Self] = &[Self::Figures, Self::EqualFigures, Self::Shipped];

    /// The choice of that name: a built-in one, otherwise a stored model.
    pub fn from_name(name: Name) -> Self {
        let own = Self::BUILT_IN.iter().find(|own| name.same(own.name()));
        own.cloned().unwrap_or(Self::Stored(name))
    }

    /// Reads the text after `:recognise`: the name of a set or model, otherwise the path of a file.
    pub fn from_text(text: &str) -> Self {
        Name::new(text).map_or_else(|_| Self::File(text.into()), Self::from_name)
    }

    /// The name that is used after `:recognise`.
    pub fn name(&self) -> &str {
        match self {
            Self::Figures => "figures",
            Self::EqualFigures => "figures-30",
            Self::Shipped => "shapes",
            Self::Stored(name) => name.as_str(),
            Self::File(path) => path.file_name().and_then(OsStr::to_str).unwrap_or("file"),
        }
    }

    /// The training of a built-in set; None for a stored model or a file. How far its shapes reach is
    /// computed once.
    ///
    /// # Errors
    /// If the set cannot be trained.
    pub fn training(&self) -> Option<Result<Training<'static>, TrainingError>> {
        static FITTED: [OnceLock<Result<Training<'static>, TrainingError>>; 3] =
            [const { OnceLock::new() }; 3];
        let (number, shapes, steps): (_, fn() -> Vec<NamedShape>, _) = match self {
            Self::Figures => (0, default_figures, GridSteps::FINE),
            Self::EqualFigures => (1, equal_figures, GridSteps::FINE),
            Self::Shipped => (2, shipped_shapes, SHIPPED_STEPS),
            Self::Stored(_) | Self::File(_) => return None,
        };
        let fitted = FITTED[number].get_or_init(|| Training::fitting(shapes(), steps));
        Some(fitted.clone())
    }

    /// Whether the model is read from a file of the user's rather than trained.
    pub fn is_read(&self) -> bool {
        matches!(self, Self::Stored(_) | Self::File(_))
    }
}

/// The message for an unknown set; it lists the built-in sets and the stored models.
pub fn unknown_set(name: &str, stored: &[Name]) -> String {
    let own = ModelChoice::BUILT_IN.iter().map(ModelChoice::name);
    let is_own = |stored: &&Name| {
        let mut own = ModelChoice::BUILT_IN.iter();
        own.any(|own| stored.same(own.name()))
    };
    let stored = stored.iter().filter(|stored| !is_own(stored));
    let all: Vec<&str> = own.chain(stored.map(Name::as_str)).collect();
    format!(
        "no model or file named {:?}; models: {}{}",
        shortened(name),
        all.join(", "),
        did_you_mean(name, all.iter().copied())
    )
}

impl fmt::Display for ModelChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "model {}", self.name())
    }
}

fn shipped_shapes() -> Vec<NamedShape> {
    let picture = |shape: StoredShape| {
        NamedShape::new(shape.name.to_string(), Picture::at_home(shape.imprint))
    };
    shipped::all().map(picture).collect()
}

#[cfg(test)]
mod tests {
    use taxel_core::figure::Figure;
    use taxel_core::pose::{Anchor, Axis, Ranges};
    use taxel_core::recognition::Evaluation;
    use taxel_core::sensor::Sensor;

    use super::*;

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
        assert!(model(4.0).0);
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
    fn models_are_listed_by_alphabet_and_an_exact_name_comes_first() {
        let folder = tempfile::tempdir().expect("a folder");
        let models = ModelFolder::beside(&folder.path().join("library"));
        models.make().expect("made");
        for name in ["Bar", "apple", "cup", "CUP"] {
            fs::write(models.path().join(format!("{name}.npz")), "").expect("written");
        }
        let names = models.names().expect("there");
        // There is only one cup if the file system ignores case.
        let shown: Vec<&str> = names.iter().map(Name::as_str).take(2).collect();
        assert_eq!(shown, ["apple", "Bar"]);
        for name in names {
            let file = models.path().join(format!("{name}.npz"));
            assert_eq!(models.file(&name), file);
        }
        let other_case = Name::new("BAR").expect("a name");
        assert_eq!(models.file(&other_case), models.path().join("Bar.npz"));
    }

    #[test]
    fn another_training_has_another_file() {
        let cache = ModelCache::in_folder("cache");
        let whole = training(4.0);
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
            assert_ne!(cache.file(&other), cache.file(&whole), "{index}");
        }
    }
}
