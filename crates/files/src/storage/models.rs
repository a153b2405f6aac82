//! Models of shapes as files: the user's own, by name in the folder `models` of the library, and a cache of models that
//! can be trained again.

use std::ffi::OsStr;
use std::fmt;
use std::fs;
use std::io::{BufRead, BufReader, Cursor, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use taxel_core::picture::Picture;
use taxel_core::quote::{did_you_mean, shortened};
use taxel_core::recognition::{
    GridSteps, Model, NamedShape, Training, TrainingError, default_figures, equal_figures,
};
use taxel_core::sensor::Sensor;
use taxel_core::sweep::Shard;
use xxhash_rust::xxh3::xxh3_128;

use crate::error::ReadError;
use crate::formats::file::without_mark;
use crate::formats::name::folded;
use crate::formats::{Name, StoredShape, model_header, read_model, write_model};
use crate::storage::error::FileError;
use crate::storage::file::{
    self, Existing, check_writable, make_folder, open, paths_in, sync_folder, wrong,
};
use crate::storage::library::below_home;
use crate::storage::shipped;

/// The folder of the models in that of a library.
pub(super) const FOLDER: &str = "models";

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
pub fn load_model(path: &Path) -> Result<Model, ReadError> {
    let mut file = BufReader::new(open(path)?);
    let is_set = |start: &[u8]| without_mark(start).trim_ascii_start().starts_with(b"{");
    let read = match file.fill_buf() {
        // A set of shapes, which is text, is given in place of its model now and then.
        Ok(start) if is_set(start) => Err(ReadError::new(
            "not a model; if it is a set of shapes, 'taxel model train' makes a model of it",
        )),
        _ => read_model(&mut file),
    };
    read.map_err(|error| wrong(path, error))
}

/// Reads a whole model from a file, so that it can answer touches.
///
/// # Errors
/// The errors of [`load_model`]; also for a shard, which knows some of the poses only.
fn load_whole_model(path: &Path) -> Result<Model, ReadError> {
    let model = load_model(path)?;
    let shard = model.shard();
    if shard == Shard::WHOLE {
        return Ok(model);
    }
    let part = format!("shard {shard} of a model only; 'taxel merge' puts shards together");
    Err(wrong(path, part))
}

/// Writes a model to a file: all of it or nothing.
///
/// # Errors
/// The system's error, with the file's name; also if a file exists and must be kept.
pub fn save_model(model: &Model, path: &Path, existing: Existing) -> Result<(), FileError> {
    file::write(path, &file_content(model), existing)
}

/// The user's models: files `NAME.npz` in the folder `models` of a library. Models of earlier versions, which kept them
/// in a folder `models` beside the library, are found there, too, but no file is written there.
///
/// Upper and lower case count as the same, as for shapes, so a folder can move to a file system that ignores case.
#[derive(Clone, Debug)]
pub struct ModelFolder {
    own: PathBuf,
    earlier: PathBuf,
}

impl ModelFolder {
    /// The models of the library in a folder.
    pub fn of(library: &Path) -> Self {
        let whole = std::path::absolute(library).unwrap_or_else(|_| library.to_owned());
        Self {
            own: library.join(FOLDER),
            earlier: whole.with_file_name(FOLDER),
        }
    }

    /// The file of a model; None if there is no model of that name.
    pub fn find(&self, name: &Name) -> Option<PathBuf> {
        let models = self.list().unwrap_or_default();
        let exact = models.iter().find(|(own, _)| own == name);
        let found = exact.or_else(|| models.iter().find(|(own, _)| name.same(own.as_str())));
        found.map(|(_, path)| path.clone())
    }

    /// The names of all models and their files, sorted regardless of case; files that do not look like models are left
    /// out.
    ///
    /// # Errors
    /// The system's error, except if the folder does not exist.
    pub fn list(&self) -> Result<Vec<(Name, PathBuf)>, FileError> {
        let mut paths = paths_in(&self.own)?;
        paths.extend(paths_in(&self.earlier).unwrap_or_default());
        let named = |path: PathBuf| {
            let name = Name::new(path.file_stem()?.to_str()?).ok()?;
            (path.extension()? == ENDING).then_some((name, path))
        };
        let mut models: Vec<(Name, PathBuf)> = paths.into_iter().filter_map(named).collect();
        // Of two of the same name, the one in the library comes first.
        models.sort_by_cached_key(|(name, _)| (folded(name.as_str()), name.clone()));
        models.dedup_by(|next, first| next.0 == first.0);
        Ok(models)
    }

    /// The names of all models, as [`Self::list`] has them; none if the folder cannot be read.
    pub fn names(&self) -> Vec<Name> {
        let models = self.list().unwrap_or_default().into_iter();
        models.map(|(name, _)| name).collect()
    }

    /// Checks whether a model can be saved, without making a folder for it, so that an error comes before the training.
    ///
    /// # Errors
    /// Those of [`Self::save`].
    pub fn check(&self, name: &Name, existing: Existing) -> Result<(), FileError> {
        let path = self.target(name, existing)?;
        if self.own.is_dir() {
            return check_writable(&path, existing);
        }
        // The folders that are still missing are made when the model is saved.
        let there = self.own.ancestors().find(|folder| folder.exists());
        let place = there.unwrap_or(Path::new(".")).join(name.as_str());
        check_writable(&place, Existing::Replaced)
    }

    /// The file that a model of this name gets.
    fn target(&self, name: &Name, existing: Existing) -> Result<PathBuf, FileError> {
        match self.find(name) {
            Some(path) if existing == Existing::Kept => {
                let exists = ErrorKind::AlreadyExists.into();
                Err(FileError::cannot("write", &path)(exists))
            }
            Some(path) if path.starts_with(&self.own) => Ok(path),
            _ => Ok(self.own.join(format!("{name}.{ENDING}"))),
        }
    }

    /// Writes a model under a name, and makes the folder for it. Returns the path.
    ///
    /// # Errors
    /// The system's error, with the file's name; also if a model of that name exists and must be kept.
    pub fn save(
        &self,
        model: &Model,
        name: &Name,
        existing: Existing,
    ) -> Result<PathBuf, FileError> {
        let path = self.target(name, existing)?;
        make_folder(&self.own)?;
        save_model(model, &path, existing)?;
        Ok(path)
    }

    /// Removes a model for good: it can be trained again. Returns its name as it was stored; None if there is no model
    /// of that name.
    ///
    /// # Errors
    /// The system's error, with the file's name.
    pub fn delete(&self, name: &Name) -> Result<Option<String>, FileError> {
        let Some(path) = self.find(name) else {
            return Ok(None);
        };
        fs::remove_file(&path).map_err(FileError::cannot("delete", &path))?;
        sync_folder(file::folder_of(&path))?;
        Ok(path
            .file_stem()
            .map(|stem| stem.to_string_lossy().into_owned()))
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
}

/// The model of a training from the cache. If the cache does not have it, `train` makes it, and it is kept
/// there, unless it takes more than 64 MiB. Without a cache it is trained each time.
///
/// # Errors
/// The errors of `train`.
fn cached_or_trained<'a, E>(
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
    let bytes = file_content(&model);
    if bytes.len() <= MAX_CACHED && make_folder(&cache.0).is_ok() {
        // A cache that cannot be written to is not an error: the model is trained again next time.
        let _ = file::write(&path, &bytes, Existing::Replaced);
    }
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

/// The name, the shapes and the steps of a set that needs no file.
type BuiltIn = (&'static str, fn() -> Vec<NamedShape>, GridSteps);

impl ModelChoice {
    /// The choices that need no file.
    pub const BUILT_IN: &'static [Self] = &[Self::Figures, Self::EqualFigures, Self::Shipped];

    /// The choice of that name: a built-in one, otherwise a stored model.
    pub fn from_name(name: Name) -> Self {
        let own = Self::BUILT_IN.iter().find(|own| name.same(own.name()));
        own.cloned().unwrap_or(Self::Stored(name))
    }

    /// Reads what a user types for a model: the name of a set or model, otherwise the path of a file.
    pub fn from_text(text: impl AsRef<OsStr>) -> Self {
        let text = text.as_ref();
        let name = text.to_str().and_then(|text| Name::new(text).ok());
        name.map_or_else(|| Self::File(text.into()), Self::from_name)
    }

    fn built_in(&self) -> Option<BuiltIn> {
        match self {
            Self::Figures => Some(("figures", default_figures, GridSteps::FINE)),
            Self::EqualFigures => Some(("figures-30", equal_figures, GridSteps::FINE)),
            // In hundredths and whole degrees they leave 5.2 million imprints; in these steps they are trained in a
            // second or two.
            Self::Shipped => Some(("shapes", shipped_shapes, GridSteps::COARSE)),
            Self::Stored(_) | Self::File(_) => None,
        }
    }

    /// The name that is used after `:recognise`.
    pub fn name(&self) -> &str {
        match self {
            Self::Stored(name) => name.as_str(),
            Self::File(path) => path.file_name().and_then(OsStr::to_str).unwrap_or("file"),
            own => own.built_in().map_or("", |(name, ..)| name),
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
        let (_, shapes, steps) = self.built_in()?;
        let number = Self::BUILT_IN.iter().position(|own| own == self)?;
        let fitted = FITTED[number].get_or_init(|| Training::fitting(shapes(), steps));
        Some(fitted.clone())
    }

    /// Whether the model is read from a file of the user's rather than trained.
    pub fn is_read(&self) -> bool {
        self.built_in().is_none()
    }
}

fn shipped_shapes() -> Vec<NamedShape> {
    let picture = |shape: StoredShape| {
        NamedShape::new(shape.name.to_string(), Picture::at_home(shape.imprint))
    };
    shipped::all().map(picture).collect()
}

impl fmt::Display for ModelChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "model {}", self.name())
    }
}

/// The models that can be chosen: built-in sets, those of a library, and files.
#[derive(Clone, Debug, Default)]
pub struct Models {
    /// The stored models; None without a library.
    pub folder: Option<ModelFolder>,
    /// Where trained built-in sets are kept; None to train them each time.
    pub cache: Option<ModelCache>,
}

impl Models {
    /// The names of the stored models.
    pub fn names(&self) -> Vec<Name> {
        self.folder.iter().flat_map(ModelFolder::names).collect()
    }

    /// The file of a choice, if it is read from one. A path may begin with `~`.
    pub fn file(&self, choice: &ModelChoice) -> Option<PathBuf> {
        match choice {
            ModelChoice::Stored(name) => self.folder.as_ref()?.find(name),
            ModelChoice::File(path) => {
                let below_home = path.to_str().and_then(below_home);
                Some(below_home.unwrap_or_else(|| path.clone()))
            }
            _ => None,
        }
    }

    /// What a choice means here: a name that no stored model has may be that of a file in the working folder.
    ///
    /// # Errors
    /// If there is neither a model nor a file of that name.
    pub fn locate(&self, choice: ModelChoice) -> Result<ModelChoice, ReadError> {
        let choice = match &choice {
            ModelChoice::Stored(name) if self.file(&choice).is_none() => {
                ModelChoice::File(name.as_str().into())
            }
            _ => choice,
        };
        match (self.file(&choice), &choice) {
            // A broken link is a file, too: the reason why it cannot be opened is reported.
            (Some(file), ModelChoice::File(path)) if file.symlink_metadata().is_err() => {
                let unknown = unknown_set(&path.to_string_lossy(), &self.names());
                Err(ReadError::new(unknown))
            }
            _ => Ok(choice),
        }
    }

    /// Reads the model of a file, or prepares the training of a built-in set.
    ///
    /// # Errors
    /// If there is no such model, or its file cannot be read as one.
    pub fn find(&self, choice: ModelChoice) -> Result<FoundModel, ReadError> {
        let choice = self.locate(choice)?;
        if let Some(path) = self.file(&choice) {
            return Ok(FoundModel::Read(Box::new(load_whole_model(&path)?)));
        }
        match choice.training() {
            Some(Ok(training)) => Ok(FoundModel::BuiltIn(training, self.cache.clone())),
            Some(Err(error)) => Err(ReadError::new(error.to_string())),
            // It was deleted in between.
            None => Err(ReadError::new(unknown_set(choice.name(), &self.names()))),
        }
    }
}

/// A model that was found but may have to be trained first, so that other errors can be reported before a training.
#[derive(Clone, Debug)]
pub enum FoundModel {
    /// From a file.
    Read(Box<Model>),
    /// A built-in set, and the cache that may have its model.
    BuiltIn(Training<'static>, Option<ModelCache>),
}

impl FoundModel {
    /// The shapes in their order.
    pub fn shapes(&self) -> &[NamedShape] {
        match self {
            Self::Read(model) => model.shapes(),
            Self::BuiltIn(training, _) => training.shapes(),
        }
    }

    /// The sensor that touched them.
    pub fn sensor(&self) -> Sensor {
        match self {
            Self::Read(model) => *model.sensor(),
            Self::BuiltIn(training, _) => *training.grids()[0].sensor(),
        }
    }

    /// The model itself: as it was read, from the cache, or else made by `train`.
    ///
    /// # Errors
    /// The errors of `train`.
    pub fn ready<E>(
        self,
        train: impl FnOnce(Training<'static>) -> Result<Model, E>,
    ) -> Result<Model, E> {
        match self {
            Self::Read(model) => Ok(*model),
            Self::BuiltIn(training, cache) => cached_or_trained(cache.as_ref(), training, train),
        }
    }
}

/// The message for an unknown set; it lists the built-in sets and the stored models.
fn unknown_set(name: &str, stored: &[Name]) -> String {
    let own = ModelChoice::BUILT_IN.iter().map(ModelChoice::name);
    let all: Vec<&str> = own.chain(stored.iter().map(Name::as_str)).collect();
    format!(
        "no model or file named {:?}; models: {}{}",
        shortened(name),
        all.join(", "),
        did_you_mean(name, all.iter().copied())
    )
}

#[cfg(test)]
mod tests {
    use taxel_core::figure::Figure;
    use taxel_core::pose::{Anchor, Axis, Ranges};
    use taxel_core::recognition::Evaluation;

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

    fn folder_and_models() -> (tempfile::TempDir, ModelFolder) {
        let folder = tempfile::tempdir().expect("a folder");
        let models = ModelFolder::of(&folder.path().join("library"));
        (folder, models)
    }

    #[test]
    fn a_model_comes_back_from_its_file_as_it_was() {
        let (folder, models) = folder_and_models();
        assert_eq!(models.names().len(), 0);
        let model = training(4.0).run().expect("not stopped");
        let name = Name::new("set").expect("a name");
        let save = |existing| models.save(&model, &name, existing);
        models.check(&name, Existing::Kept).expect("free");
        assert_eq!(
            paths_in(folder.path()).expect("read").len(),
            0,
            "nothing is left"
        );
        let path = save(Existing::Kept).expect("written");
        assert!(
            models
                .check(&name, Existing::Kept)
                .expect_err("there")
                .exists()
        );
        assert!(save(Existing::Kept).expect_err("there").exists());
        assert_eq!(save(Existing::Replaced).expect("written"), path);
        let again = load_model(&path).expect("read");
        assert_eq!(Evaluation::of(&again), Evaluation::of(&model));
        assert_eq!(again.shapes(), model.shapes());
        assert_eq!(model_hash(&again), model_hash(&model));
        assert_eq!(models.names().len(), 1);
        assert_eq!(
            models.delete(&name).expect("deleted").as_deref(),
            Some("set")
        );
        assert_eq!(models.delete(&name).expect("none"), None);
    }

    #[test]
    fn a_model_beside_the_library_is_found_but_none_is_written_there() {
        let (folder, models) = folder_and_models();
        let earlier = folder.path().join("models");
        fs::create_dir(&earlier).expect("made");
        let model = training(4.0).run().expect("not stopped");
        save_model(&model, &earlier.join("Set.npz"), Existing::Kept).expect("written");
        let name = Name::new("set").expect("a name");
        let found = models.find(&name).expect("it is there");
        assert!(load_model(&found).is_ok() && models.check(&name, Existing::Kept).is_err());
        let path = models
            .save(&model, &name, Existing::Replaced)
            .expect("written");
        assert_eq!(path, folder.path().join("library/models/set.npz"));
        assert_eq!(paths_in(&earlier).expect("read"), [earlier.join("Set.npz")]);
        assert_eq!(models.find(&name), Some(path));
    }

    #[test]
    fn a_file_in_place_of_the_folder_is_reported() {
        let (folder, models) = folder_and_models();
        fs::create_dir(folder.path().join("library")).expect("made");
        fs::write(&models.own, "").expect("written");
        let refused = models.list().expect_err("a file").to_string();
        let expected = format!("{}: cannot read the folder: ", models.own.display());
        assert!(refused.starts_with(&expected), "{refused}");
        let name = Name::new("set").expect("a name");
        assert!(models.check(&name, Existing::Kept).is_err());
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
        let (_folder, models) = folder_and_models();
        fs::create_dir_all(&models.own).expect("made");
        for name in ["Bar", "apple", "cup", "CUP"] {
            fs::write(models.own.join(format!("{name}.npz")), "").expect("written");
        }
        let names = models.names();
        // There is only one cup if the file system ignores case.
        let shown: Vec<&str> = names.iter().map(Name::as_str).take(2).collect();
        assert_eq!(shown, ["apple", "Bar"]);
        for name in names {
            let file = models.own.join(format!("{name}.npz"));
            assert_eq!(models.find(&name), Some(file));
        }
        let other_case = Name::new("BAR").expect("a name");
        assert_eq!(models.find(&other_case), Some(models.own.join("Bar.npz")));
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
