//! Models of shapes as files: the user's own, by name in the folder `models` of the library, and a cache of models that
//! can be trained again. A built-in set is united from models of single shapes, so of a set that has changed only the new
//! shapes are trained.

use std::ffi::OsStr;
use std::fmt;
use std::fs;
use std::io::{BufRead, BufReader, Cursor};
use std::path::{Path, PathBuf};

use taxel_core::progress::Progress;
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
use crate::formats::{Name, model_header, read_model, write_model};
use crate::memory::MemoryGuard;
use crate::storage::error::FileError;
use crate::storage::file::{
    self, Existing, check_writable, make_folder, open, paths_in, sync_folder, wrong,
};
use crate::storage::library::{Library, LibraryEntry, below_home};
use crate::storage::shipped;

/// The folder of the models in that of a library.
pub(super) const FOLDER: &str = "models";

const ENDING: &str = "npz";

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
pub fn load_whole_model(path: &Path) -> Result<Model, ReadError> {
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

    /// Makes the folder and checks whether a model can be saved in it, so that an error comes before the training.
    ///
    /// # Errors
    /// Those of [`Self::save`].
    pub fn check(&self, name: &Name, existing: Existing) -> Result<(), FileError> {
        make_folder(&self.own)?;
        check_writable(&self.target(name), existing)
    }

    /// The file that a model of this name gets.
    fn target(&self, name: &Name) -> PathBuf {
        let new = || self.own.join(format!("{name}.{ENDING}"));
        let own = self.find(name).filter(|path| path.starts_with(&self.own));
        own.unwrap_or_else(new)
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
        let path = self.target(name);
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

/// A cache of models of single shapes, which are trained again when they are missing.
///
/// The name of a file is a hash of what was trained, by which version, so another shape or grid has another file. A file
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

/// The model of a shape from the cache, or trained and kept there. Both report all poses, so it does not depend on the
/// cache whether a script stays within its poses.
fn part(
    shape: &NamedShape,
    steps: GridSteps,
    cache: Option<&ModelCache>,
    progress: &dyn Progress,
) -> Result<Model, TrainingError> {
    let training = Training::fitting([shape.clone()], steps)?.with_progress(progress);
    let path = cache.map(|cache| cache.file(&training));
    let kept = path.as_ref().and_then(|path| load_model(path).ok());
    if let Some(model) = kept.filter(|model| *model.head() == training.head()) {
        let goes_on = progress.add(training.poses()).is_continue();
        return goes_on.then_some(model).ok_or(TrainingError::Stopped);
    }
    let model = training.run()?;
    if let Some(path) = path
        && make_folder(file::folder_of(&path)).is_ok()
    {
        // A cache that cannot be written to is not an error: the model is trained again next time.
        let _ = save_model(&model, &path, Existing::Replaced);
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
    /// Every stored shape: the user's own, and those that come with the program.
    Library,
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

impl ModelChoice {
    /// The sets that need no model's file; the first one is the default everywhere.
    pub const BUILT_IN: &'static [Self] = &[
        Self::Library,
        Self::Figures,
        Self::EqualFigures,
        Self::Shipped,
    ];

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

    /// The name that is used after `:recognise`.
    pub fn name(&self) -> &str {
        match self {
            Self::Library => "library",
            Self::Figures => "figures",
            Self::EqualFigures => "figures-30",
            Self::Shipped => "shapes",
            Self::Stored(name) => name.as_str(),
            Self::File(path) => path.file_name().and_then(OsStr::to_str).unwrap_or("file"),
        }
    }

    /// Whether the model is read from a file of the user's rather than trained.
    pub fn is_read(&self) -> bool {
        matches!(self, Self::Stored(_) | Self::File(_))
    }

    /// Whether its model may be another one the next time.
    pub fn may_change(&self) -> bool {
        self.is_read() || *self == Self::Library
    }
}

impl fmt::Display for ModelChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "model {}", self.name())
    }
}

/// The models that can be chosen: built-in sets, those of a library, and files.
#[derive(Clone, Debug)]
pub struct Models {
    /// The library, which has the stored models, too.
    pub library: Library,
    /// Where models of the shapes of built-in sets are kept; None to train them each time.
    pub cache: Option<ModelCache>,
}

impl Models {
    fn folder(&self) -> ModelFolder {
        ModelFolder::of(self.library.folder())
    }

    /// The names of the stored models.
    pub fn names(&self) -> Vec<Name> {
        self.folder().names()
    }

    /// The file of a choice, if it is read from one. A path may begin with `~`.
    pub fn file(&self, choice: &ModelChoice) -> Option<PathBuf> {
        match choice {
            ModelChoice::Stored(name) => self.folder().find(name),
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

    /// Reads the model of a file, or gathers the shapes of a built-in set.
    ///
    /// # Errors
    /// If there is no such model, or its file cannot be read as one.
    pub fn find(&self, choice: ModelChoice) -> Result<FoundModel, ReadError> {
        let choice = self.locate(choice)?;
        if let Some(path) = self.file(&choice) {
            return Ok(FoundModel::Read(Box::new(load_whole_model(&path)?)));
        }
        let mut left_out = Vec::new();
        // Figures have few edges, so fine steps take no longer. Pictures in fine steps leave millions of imprints.
        let (shapes, steps) = match choice {
            ModelChoice::Library => (self.stored_shapes(&mut left_out), GridSteps::COARSE),
            ModelChoice::Figures => (default_figures(), GridSteps::FINE),
            ModelChoice::EqualFigures => (equal_figures(), GridSteps::FINE),
            ModelChoice::Shipped => {
                let shapes = shipped::all().map(|own| own.of_set());
                (shapes.collect(), GridSteps::COARSE)
            }
            // It was deleted in between.
            ModelChoice::Stored(_) | ModelChoice::File(_) => {
                return Err(ReadError::new(unknown_set(choice.name(), &self.names())));
            }
        };
        match Training::fitting(shapes, steps) {
            Ok(set) => Ok(FoundModel::BuiltIn {
                set,
                steps,
                left_out,
                cache: self.cache.clone(),
            }),
            Err(error) => Err(ReadError::new(error.to_string())),
        }
    }

    /// All shapes of the library that can be trained; the others are described in `left_out`.
    fn stored_shapes(&self, left_out: &mut Vec<String>) -> Vec<NamedShape> {
        let Ok(entries) = self.library.list() else {
            left_out.push("your own shapes (unreadable folder)".to_owned());
            return shipped::all().map(|own| own.of_set()).collect();
        };
        let trainable = |name: &str| {
            let stored = self.library.load(name).map_err(|_| "unreadable")?.shape;
            if stored.imprint.is_empty() {
                return Err("no active taxel");
            }
            let shape = stored.of_set();
            let fits = Training::fitting([shape.clone()], GridSteps::COARSE);
            fits.map(|_| shape).map_err(|_| "too large")
        };
        let shapes = entries.into_iter().filter_map(|LibraryEntry { name, .. }| {
            let shape = trainable(&name);
            let left = shape.map_err(|reason| left_out.push(format!("{name} ({reason})")));
            left.ok()
        });
        shapes.collect()
    }
}

/// A model that was found but may have to be trained first, so that other errors can be reported before a training.
#[derive(Clone, Debug)]
pub enum FoundModel {
    /// From a file.
    Read(Box<Model>),
    /// A built-in set.
    BuiltIn {
        /// The training of all its shapes, which says what the model will be.
        set: Training<'static>,
        /// The steps of its poses.
        steps: GridSteps,
        /// The stored shapes that are not in the set, each with the reason.
        left_out: Vec<String>,
        /// Where models of its shapes are kept.
        cache: Option<ModelCache>,
    },
}

impl FoundModel {
    /// The shapes in their order.
    pub fn shapes(&self) -> &[NamedShape] {
        match self {
            Self::Read(model) => model.shapes(),
            Self::BuiltIn { set, .. } => &set.shapes,
        }
    }

    /// The sensor that touched them.
    pub fn sensor(&self) -> Sensor {
        match self {
            Self::Read(model) => *model.sensor(),
            Self::BuiltIn { set, .. } => *set.grids[0].sensor(),
        }
    }

    /// The model itself: as it was read, or united from those of its shapes, of which the cache has some. `progress` is
    /// told the poses of these.
    ///
    /// # Errors
    /// A sentence, if the training is stopped or memory runs short.
    pub fn ready(self, progress: &dyn Progress) -> Result<Model, String> {
        let (set, steps, cache) = match self {
            Self::Read(model) => return Ok(*model),
            Self::BuiltIn {
                set, steps, cache, ..
            } => (set, steps, cache),
        };
        let memory = MemoryGuard::new("train a model of fewer shapes (taxel model train)");
        let parts = memory.limit(progress, |progress| {
            let shapes = set.shapes.iter();
            let parts = shapes.map(|shape| part(shape, steps, cache.as_ref(), progress));
            parts.collect::<Result<Vec<Model>, TrainingError>>()
        })?;
        let model = parts.and_then(|parts| Ok(Model::united(&parts)?));
        model.map_err(|error| match error {
            TrainingError::Stopped => "training was stopped".to_owned(),
            error => error.to_string(),
        })
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
    use std::sync::atomic::{AtomicU64, Ordering};

    use taxel_core::figure::Figure;
    use taxel_core::imprint::Imprint;
    use taxel_core::pose::{Anchor, Axis, Ranges};
    use taxel_core::progress::{ToTheEnd, stop_if};
    use taxel_core::recognition::Evaluation;

    use super::*;
    use crate::formats::StoredShape;
    use crate::storage::library::Expected;

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
        let (_folder, models) = folder_and_models();
        assert_eq!(models.names().len(), 0);
        let model = training(4.0).run().expect("not stopped");
        let name = Name::new("set").expect("a name");
        let save = |existing| models.save(&model, &name, existing);
        models.check(&name, Existing::Kept).expect("free");
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
        save_model(&model, &earlier.join("set.npz"), Existing::Kept).expect("written");
        let name = Name::new("set").expect("a name");
        let found = models.find(&name).expect("it is there");
        assert!(load_model(&found).is_ok());
        let path = models.save(&model, &name, Existing::Kept).expect("written");
        assert_eq!(path, folder.path().join("library/models/set.npz"));
        assert_eq!(paths_in(&earlier).expect("read"), [earlier.join("set.npz")]);
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

    /// An empty library, and its models with a cache.
    fn library(folder: &Path) -> (Library, Models) {
        let library = Library::open(folder.join("library"));
        let models = Models {
            library: library.clone(),
            cache: Some(ModelCache::in_folder(folder.join("cache"))),
        };
        (library, models)
    }

    fn stored(library: &Library, name: &str, rows: &str) {
        let imprint: Imprint = rows.parse().expect("an imprint");
        let sensor = Sensor::new(imprint.columns(), imprint.rows()).expect("a sensor");
        let name = Name::new(name).expect("a name");
        let shape = StoredShape::new(name, sensor, imprint, None).expect("it fits");
        library.save(&shape, Expected::Anything).expect("saved");
    }

    fn found(models: &Models) -> (FoundModel, Vec<String>) {
        let found = models.find(ModelChoice::Library).expect("a set");
        let left_out = match &found {
            FoundModel::BuiltIn { left_out, .. } => left_out.clone(),
            FoundModel::Read(_) => panic!("it is trained"),
        };
        (found, left_out)
    }

    #[test]
    fn the_library_is_every_stored_shape_that_can_be_trained() {
        let folder = tempfile::tempdir().expect("a folder");
        let (library, models) = library(folder.path());
        let names = || -> Vec<String> {
            let (found, _) = found(&models);
            found.shapes().iter().map(|own| own.name.clone()).collect()
        };
        let shipped: Vec<String> = shipped::names().map(str::to_owned).collect();
        assert_eq!(names(), shipped);
        stored(&library, "Mine", "##\n#.");
        stored(&library, "blank", "..\n..");
        stored(
            &library,
            "too large",
            &format!("{}\n", "#".repeat(64)).repeat(64),
        );
        // A copy by hand takes the place of the shipped shape, whatever the case of its name.
        let folder = library.folder();
        fs::copy(folder.join("Mine.json"), folder.join("WASHER.json")).expect("copied");
        fs::write(folder.join("broken.json"), "{").expect("written");
        let mut expected = vec!["Mine".to_owned(), "WASHER".to_owned()];
        expected.extend(shipped.into_iter().filter(|name| name != "washer"));
        assert_eq!(names(), expected);
        let reasons = [
            "blank (no active taxel)",
            "broken (unreadable)",
            "too large (too large)",
        ];
        assert_eq!(found(&models).1, reasons);
        // The set of shipped shapes stays as it is.
        let shapes = models.find(ModelChoice::Shipped).expect("a set");
        assert_eq!(shapes.shapes().len(), 28);
    }

    #[test]
    fn only_changed_shapes_are_trained() {
        let folder = tempfile::tempdir().expect("a folder");
        let (library, models) = library(folder.path());
        let files = || paths_in(&folder.path().join("cache")).expect("read");
        let ready = || found(&models).0.ready(&ToTheEnd).expect("not stopped");
        stored(&library, "own", "##\n#.");
        let first = ready();
        assert_eq!((first.shapes().len(), files().len()), (29, 29));
        // The model of all shapes together is that of one training.
        let FoundModel::BuiltIn { set, .. } = found(&models).0 else {
            panic!("it is trained");
        };
        assert_eq!(set.run().as_ref(), Ok(&first));
        let before = files();
        let written = || {
            let time = |path: &PathBuf| path.metadata().and_then(|file| file.modified());
            before
                .iter()
                .map(|path| time(path).expect("it is there"))
                .collect::<Vec<_>>()
        };
        let first_written = written();
        stored(&library, "own", "##\n##");
        assert_ne!(ready(), first);
        assert_eq!(files().len(), 30);
        stored(&library, "own", "##\n#.");
        assert!(ready() == first);
        assert_eq!(written(), first_written, "none was trained again");
        // A damaged file is made again.
        let damaged = fs::read(&before[0]).expect("read");
        fs::write(&before[0], &damaged[..damaged.len() / 2]).expect("written");
        assert!(ready() == first);
        assert_eq!(fs::read(&before[0]).expect("read"), damaged);
        // That of another shape is, too.
        fs::copy(&before[1], &before[0]).expect("copied");
        assert!(ready() == first);
        // Whether it is trained or read, it can be stopped, and all poses are counted.
        let counted = AtomicU64::new(0);
        let count = |poses: u64| {
            counted.fetch_add(poses, Ordering::Relaxed);
            stop_if(false)
        };
        assert!(found(&models).0.ready(&count).is_ok());
        assert_eq!(counted.into_inner(), 29 * 3000);
        let stopped = found(&models).0.ready(&|_: u64| stop_if(true));
        assert_eq!(stopped.err().as_deref(), Some("training was stopped"));
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
            let grid = &whole.grids[0];
            let other = Training::new(shapes.to_vec(), *grid.sensor(), anchor, *grid.ranges());
            other.expect("a set")
        };
        let mut heavier = whole.shapes.clone();
        heavier[0].weight = 3;
        for (index, other) in [
            training(4.1),
            of(&whole.shapes[..1], Anchor::Centre),
            of(&whole.shapes, Anchor::Corner),
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
