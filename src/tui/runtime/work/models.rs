//! Models for recognition: trained or read.
//!
//! ```text
//! Prepare(number, set)  -> Begun, Progress …, then Prepared: the model, or why there is none
//! ```
//! A built-in set is trained once; the cache keeps its model, if the world has one. A stored model is read from the
//! folder of the library, any other from its file. Training goes on while a sweep begins, and stops only on
//! request.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;

use taxel_core::quote::shortened;
use taxel_core::recognition::{Model, TrainingError};
use taxel_files::formats::Name;
use taxel_files::memory::MemoryGuard;
use taxel_files::storage::{
    Library, ModelCache, ModelChoice, ModelFolder, Models, below_home, cached_or_trained,
    load_whole_model, unknown_set,
};

use crate::tui::app::message::WorkerEvent;
use crate::tui::recognise::state::{Prepared, RecognitionEvent};
use crate::tui::recognise::trained::TrainedModel;
use crate::tui::runtime::work::execution::{
    Execution, ProgressReporter, StopFlag, WorkProgress, guarded, on_a_thread,
};

#[derive(Clone, Debug, Default)]
pub(crate) struct ModelStore {
    folder: Option<ModelFolder>,
    pub(crate) cache: Option<ModelCache>,
}

impl ModelStore {
    pub(crate) fn beside(library: &Library) -> Self {
        Self {
            folder: Some(ModelFolder::of(library.folder())),
            cache: None,
        }
    }

    pub(crate) fn models(&self) -> Models {
        Models {
            folder: self.folder.clone(),
            cache: self.cache.clone(),
        }
    }

    /// Returns the names of the user's models; none if the folder cannot be read.
    pub(crate) fn names(&self) -> Vec<Name> {
        self.folder.iter().flat_map(ModelFolder::names).collect()
    }

    pub(crate) fn model(
        &self,
        choice: &ModelChoice,
        begins: &dyn Fn(u64),
        progress: &WorkProgress<'_>,
    ) -> Result<Model, String> {
        let Some(training) = choice.training() else {
            return load_whole_model(&self.file(choice)?).map_err(|error| error.to_string());
        };
        let training = training.map_err(|error| error.to_string())?;
        cached_or_trained(self.cache.as_ref(), training, |training| {
            begins(training.poses());
            let memory = MemoryGuard::new(
                None,
                "take fewer shapes or coarser steps, or train it in shards on the command line (taxel model train --shard)",
            );
            progress
                .within(&memory, |progress| training.with_progress(progress).run())?
                .map_err(|error| match error {
                    TrainingError::Stopped => "training was stopped".to_owned(),
                    error => error.to_string(),
                })
        })
    }

    /// Returns the file of a stored model or of a model in a file, whose path may begin with `~`; None for any other.
    fn path(&self, choice: &ModelChoice) -> Option<PathBuf> {
        match choice {
            ModelChoice::Stored(name) => self.folder.as_ref()?.find(name),
            ModelChoice::File(path) => {
                let below_home = path.to_str().and_then(below_home);
                Some(below_home.unwrap_or_else(|| path.clone()))
            }
            _ => None,
        }
    }

    pub(crate) fn file(&self, choice: &ModelChoice) -> Result<PathBuf, String> {
        let name = match choice {
            ModelChoice::File(path) => path.to_string_lossy().into_owned(),
            choice => choice.name().to_owned(),
        };
        let path = self.path(choice);
        let path = path.ok_or_else(|| unknown_set(&name, &self.names()))?;
        match path.metadata() {
            // Opening a pipe waits, and opening a serial line may reset its device.
            Ok(kind) if !kind.is_file() => Err(format!("{}: not a regular file", shortened(&name))),
            Err(error) if error.kind() == ErrorKind::NotFound => {
                Err(unknown_set(&name, &self.names()))
            }
            // Reading it reports any other error.
            _ => Ok(path),
        }
    }

    /// Resolves a choice: as on the command line, a name that no model has may be the name of a file in the working
    /// folder.
    pub(crate) fn located(&self, choice: ModelChoice) -> ModelChoice {
        let ModelChoice::Stored(name) = &choice else {
            return choice;
        };
        let folder = self.folder.as_ref();
        let is_stored = folder.is_some_and(|folder| folder.find(name).is_some());
        let path = Path::new(name.as_str());
        if is_stored || !path.exists() {
            return choice;
        }
        ModelChoice::File(path.to_owned())
    }
}

#[derive(Debug, Default)]
pub(crate) struct ModelWorker {
    pub(crate) store: ModelStore,
    stop: StopFlag,
    thread: Option<JoinHandle<()>>,
}

impl ModelWorker {
    /// Prepares a model on a thread of its own. If work is done at once, returns the event instead. `known` is the
    /// model of the set so far, which stays if its file was not written again.
    pub(crate) fn prepare(
        &mut self,
        number: u64,
        choice: ModelChoice,
        known: Option<Arc<TrainedModel>>,
        execution: &Execution,
    ) -> Option<WorkerEvent> {
        let stop = self.stop.renew();
        let store = self.store.clone();
        let post = match execution {
            Execution::AtOnce(limit) => {
                let progress = WorkProgress::up_to(*limit);
                return Some(prepare(&store, number, choice, known, (&|_| {}, &progress)));
            }
            Execution::OnThreads(post) => post,
        };
        let thread = on_a_thread(number, post, move |post| {
            let clock = ProgressReporter::new(number, post);
            let begins = |poses| {
                let begun = RecognitionEvent::Begun(number, poses);
                post(WorkerEvent::Recognition(begun));
            };
            let progress = WorkProgress::until(&stop, Some(&clock));
            post(guarded(number, || {
                prepare(&store, number, choice, known, (&begins, &progress))
            }));
        });
        match thread {
            Ok(thread) => self.thread = Some(thread),
            Err(refused) => return Some(refused),
        }
        None
    }

    pub(crate) fn stop(&self) {
        self.stop.stop();
    }

    pub(crate) fn end(&mut self) -> Option<JoinHandle<()>> {
        self.stop.stop();
        self.thread.take()
    }
}

type Calls<'a> = (&'a dyn Fn(u64), &'a WorkProgress<'a>);

/// Reads a model from the cache or trains it, and evaluates it. The event also has the names of stored models, which
/// may have changed.
fn prepare(
    store: &ModelStore,
    number: u64,
    choice: ModelChoice,
    known: Option<Arc<TrainedModel>>,
    (begins, progress): Calls<'_>,
) -> WorkerEvent {
    let choice = store.located(choice);
    // Before it is read: if it is written meanwhile, it is read again the next time.
    let found = store.path(&choice).and_then(|path| path.metadata().ok());
    let version = found.and_then(|found| Some((found.len(), found.modified().ok()?)));
    let known = known.filter(|known| version.is_some() && known.version == version);
    let trained = match known.filter(|known| known.choice == choice) {
        Some(known) => Ok(known),
        None => (store.model(&choice, begins, progress))
            .map(|model| Arc::new(TrainedModel::new(choice, model, version))),
    };
    WorkerEvent::Recognition(RecognitionEvent::Prepared(Box::new(Prepared {
        number,
        stored: store.names(),
        trained,
    })))
}
