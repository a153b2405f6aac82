//! The requests to the disk: to the library, to files and to recordings; how each is carried out, and its answer.

use std::io::ErrorKind;
use std::sync::Arc;
use std::time::Duration;

use rustix::fs::{Access, access};
use rustix::io::Errno;
use taxel_core::source::Source;
use taxel_files::formats::recording::{RecordedView, RecordingMetadata};
use taxel_files::formats::value::counted;
use taxel_files::formats::{Name, StoredShape};
use taxel_files::storage::{
    Expected, Library, LibraryError, ModelChoice, Orphan, RememberedFile, UNNAMED,
};

use crate::tui::app::message::{FileEvent, LibraryEvent, LibraryRequest, Purpose};
use crate::tui::app::state::App;
use crate::tui::explore::ranges::about;
use crate::tui::live::message::LiveEvent;
use crate::tui::runtime::disk::files::{self, WriteAccess};
use crate::tui::runtime::disk::queue::DiskQueue;
use crate::tui::runtime::effect::FileRequest;
use crate::tui::runtime::frames::recording::Recording;
use crate::tui::runtime::work::models::ModelStore;

#[derive(Debug)]
pub(in crate::tui::runtime) enum DiskRequest {
    /// Read or change the library.
    Library(LibraryRequest),
    /// Move unsaved work of a program that crashed to the trash.
    ThrowAway(Box<Orphan>),
    File(FileRequest),
    /// Remember lines for the next run.
    Remember(RememberedFile, Vec<String>),
    BeginRecording(u64, Box<RecordingMetadata>),
    WriteMetadata(u64, Arc<Recording>, Box<RecordedView>),
    FlushRecording(u64, Arc<Recording>),
    EndRecording(u64, Arc<Recording>),
}

#[derive(Debug)]
pub(in crate::tui::runtime) enum DiskAnswer {
    /// The shape that was to be saved; the stamp of its file, or the error.
    Stored(Box<StoredShape>, Result<u64, LibraryError>),
    /// The name of the unsaved work in the trash, or the error.
    ThrownAway(Result<String, LibraryError>),
    File(FileEvent),
    Library(LibraryEvent),
    Recording(u64, Result<(String, Arc<Recording>), String>),
    Live(u64, LiveEvent),
    Nothing,
}

impl DiskRequest {
    pub(super) fn words(&self) -> String {
        match self {
            Self::Library(request) => request_words(request),
            Self::ThrowAway(_) => "Moving it to the trash".to_owned(),
            Self::File(FileRequest::Write(name, ..)) => format!("Writing {name}"),
            Self::File(FileRequest::Open(name)) => format!("Opening {name}"),
            Self::File(FileRequest::Source(request)) => format!("Opening {}", request.name()),
            Self::File(FileRequest::Paths(_)) => "Listing files".to_owned(),
            Self::Remember(..) => "Remembering it".to_owned(),
            Self::BeginRecording(..) => "Starting a recording".to_owned(),
            Self::WriteMetadata(_, recording, _) => {
                format!("Saving the metadata of {}", recording.path().display())
            }
            Self::FlushRecording(_, recording) | Self::EndRecording(_, recording) => {
                format!("Saving {}", recording.path().display())
            }
        }
    }

    pub(super) fn locks(&self) -> bool {
        match self {
            Self::Library(request) => request.is_change(),
            Self::ThrowAway(_) => true,
            _ => false,
        }
    }

    pub(super) fn perform(self, library: &Library, access: &WriteAccess) -> DiskAnswer {
        match self {
            Self::Library(request) => answer(library, request),
            Self::ThrowAway(orphan) => DiskAnswer::ThrownAway(throw_away(library, *orphan)),
            Self::File(request) => {
                let models = ModelStore::beside(library);
                DiskAnswer::File(files::perform(request, &models, access))
            }
            Self::Remember(file, lines) => {
                file.add(lines);
                DiskAnswer::Nothing
            }
            Self::BeginRecording(number, metadata) => {
                DiskAnswer::Recording(number, Recording::in_free_file(access, &metadata))
            }
            Self::WriteMetadata(number, of, view) => written(number, of.write_metadata(*view)),
            Self::FlushRecording(number, recording) => written(number, recording.flush().map(drop)),
            Self::EndRecording(number, recording) => {
                let ended = recording.finish();
                ended.map_or(DiskAnswer::Nothing, |event| DiskAnswer::Live(number, event))
            }
        }
    }
}

fn request_words(request: &LibraryRequest) -> String {
    match request {
        LibraryRequest::List => "Listing the shapes".to_owned(),
        LibraryRequest::Models => "Listing the models".to_owned(),
        LibraryRequest::Trash => "Listing the deleted shapes".to_owned(),
        LibraryRequest::Read(_) => "Reading the shapes".to_owned(),
        LibraryRequest::Named(Purpose::Load, name) => format!("Loading {name}"),
        LibraryRequest::Named(_, name) => format!("Reading {name}"),
        LibraryRequest::Store(shape, _) => format!("Saving {}", shape.name),
        LibraryRequest::Deletable(name) => format!("Looking for {name}"),
        LibraryRequest::Remove(name) => format!("Deleting {name}"),
        LibraryRequest::Restore(Some(name)) => format!("Restoring {name}"),
        LibraryRequest::Restore(None) => "Restoring a shape".to_owned(),
    }
}

fn answer(library: &Library, request: LibraryRequest) -> DiskAnswer {
    let sentence = |error| sentence(library, &error);
    DiskAnswer::Library(match request {
        LibraryRequest::List => LibraryEvent::List(library.list().map_err(sentence)),
        LibraryRequest::Models => {
            let names = ModelStore::beside(library).names().into_iter();
            LibraryEvent::Models(names.map(|name| name.to_string()).collect())
        }
        LibraryRequest::Trash => LibraryEvent::Trash(library.deleted().map_err(sentence)),
        LibraryRequest::Read(names) => {
            let read = names.into_iter().map(|name| {
                let loaded = library.load(&name).map_err(sentence);
                (name, loaded)
            });
            LibraryEvent::Read(read.collect())
        }
        LibraryRequest::Named(purpose, name) => {
            let loaded = library.load(&name).map(Box::new);
            LibraryEvent::Named(purpose, loaded.map_err(sentence))
        }
        LibraryRequest::Store(shape, expected) => return store(library, shape, expected),
        LibraryRequest::Deletable(name) => {
            let found = library.deletable(&name).map_err(sentence);
            LibraryEvent::Deletable(match found {
                Ok(_) if is_read_only(library) => Err(format!("not deleted: {READ_ONLY}")),
                found => found,
            })
        }
        LibraryRequest::Remove(name) => {
            let removed = library.delete(&name);
            let removed = removed.map_err(|error| not_changed(library, "not deleted", &error));
            removed.map_or_else(LibraryEvent::Failed, LibraryEvent::Removed)
        }
        LibraryRequest::Restore(name) => {
            let restored = library.restore(name.as_deref());
            let restored = restored.map_err(|error| not_changed(library, "not restored", &error));
            restored.map_or_else(LibraryEvent::Failed, LibraryEvent::Restored)
        }
    })
}

/// Why nothing in the library can be changed.
const READ_ONLY: &str = "the library is read-only";

/// Returns true if the system lets nobody, or not this user, write in the library's folder.
fn is_read_only(library: &Library) -> bool {
    let writable = access(library.folder(), Access::WRITE_OK);
    matches!(writable, Err(Errno::ACCESS | Errno::PERM | Errno::ROFS))
}

/// Returns true if an error says that nothing in the library can be changed. A file system that went read-only after an
/// error of the disk may still call its folders writable, so the error itself decides first.
fn says_read_only(library: &Library, error: &LibraryError) -> bool {
    match error {
        LibraryError::System(refused) => {
            refused.error.kind() == ErrorKind::ReadOnlyFilesystem || is_read_only(library)
        }
        _ => false,
    }
}

/// Returns the sentence about a refused change: `what` says what was not done. In a read-only library each file would
/// be refused, so the file's name would only mislead.
fn not_changed(library: &Library, what: &str, error: &LibraryError) -> String {
    if says_read_only(library, error) {
        format!("{what}: {READ_ONLY}")
    } else {
        sentence(library, error)
    }
}

fn store(library: &Library, shape: Box<StoredShape>, expected: Expected) -> DiskAnswer {
    match library.save(&shape, expected) {
        Err(error) if says_read_only(library, &error) => {
            let text = format!("not saved: {READ_ONLY}; :write FILE saves elsewhere");
            DiskAnswer::Library(LibraryEvent::NotStored(text))
        }
        stored => DiskAnswer::Stored(shape, stored),
    }
}

/// Returns the answer after something was written to a recording of the source of that number: a failure ends the
/// recording.
fn written(number: u64, written: Result<(), String>) -> DiskAnswer {
    let failed = |reason| DiskAnswer::Live(number, LiveEvent::NotRecorded(reason));
    written.map_or_else(failed, |()| DiskAnswer::Nothing)
}

/// Returns a line about a recording that could not be finished or continued, if the answer says so.
pub(in crate::tui::runtime) fn not_recorded(answer: &DiskAnswer) -> Option<String> {
    match answer {
        DiskAnswer::Live(_, LiveEvent::NotFinished(reason) | LiveEvent::NotRecorded(reason)) => {
            Some(format!("{reason}\n"))
        }
        _ => None,
    }
}

fn sentence(library: &Library, error: &LibraryError) -> String {
    format!("{error}{}", library.suggestion(error))
}

fn throw_away(library: &Library, orphan: Orphan) -> Result<String, LibraryError> {
    let mut shape = orphan.shape.clone();
    if let Ok(name) = Name::new(UNNAMED) {
        shape = shape.renamed(name);
    }
    let thrown = library.throw_away(&shape)?;
    orphan.discard();
    Ok(thrown)
}

/// Returns the name, the size and the age of the work: `hexagon side 4.00, 40 taxels, about 12 minutes ago`.
pub(in crate::tui::runtime) fn described(orphan: &Orphan) -> String {
    let shape = &orphan.shape;
    let called = match (shape.name.as_str(), &shape.source) {
        (UNNAMED, Some(Source::Figure(figure))) => Some(figure.kind_and_sizes()),
        (UNNAMED, Some(Source::Picture(picture))) => picture.name().map(str::to_owned),
        (UNNAMED, None) => None,
        (name, _) => Some(name.to_owned()),
    };
    let taxels = counted(shape.imprint.count(), "taxel");
    let pieces = [called, Some(taxels), orphan.age().map(ago)];
    pieces.into_iter().flatten().collect::<Vec<_>>().join(", ")
}

/// Returns how long ago something happened, in words. Within the first minute, seconds would say nothing useful.
fn ago(time: Duration) -> String {
    if time < Duration::from_secs(60) {
        "less than a minute ago".to_owned()
    } else {
        format!("{} ago", about(time))
    }
}

/// Scripts and recorded runs remember nothing, so that they do the same every time.
#[derive(Debug)]
pub(in crate::tui::runtime) struct Reminders {
    commands: RememberedFile,
    remembered: usize,
    set: RememberedFile,
    chosen: Option<ModelChoice>,
}

impl Reminders {
    pub(in crate::tui::runtime) fn of(library: &Library) -> Self {
        Self {
            commands: RememberedFile::commands(library),
            remembered: 0,
            set: RememberedFile::recognised_set(library),
            chosen: None,
        }
    }

    pub(in crate::tui::runtime) fn remind(&mut self, app: &mut App) {
        app.commands = self.commands.read();
        self.remembered = app.commands.len();
        let set = self.set.read().pop();
        self.chosen = set
            .and_then(|name| Name::new(&name).ok())
            .map(ModelChoice::from_name);
        if let Some(own) = &self.chosen {
            app.recognition.begin_with(own.clone());
        }
    }

    /// Remembers everything new. A set is remembered once its model is ready, so that it surely exists. A model from
    /// a file is not, since the next run may begin in another folder.
    pub(in crate::tui::runtime) fn note(&mut self, app: &App, queue: &mut DiskQueue) {
        if let Some(new @ [_, ..]) = app.commands.get(self.remembered..) {
            let (file, new) = (self.commands.clone(), new.to_vec());
            queue.begin(DiskRequest::Remember(file, new));
            self.remembered = app.commands.len();
        }
        let is_new = |now: &&ModelChoice| {
            !matches!(now, ModelChoice::File(_)) && self.chosen.as_ref() != Some(*now)
        };
        let trained = app.recognition.trained();
        let now = trained.map(|trained| &trained.choice).filter(is_new);
        if let Some(now) = now {
            let name = vec![now.name().to_owned()];
            queue.begin(DiskRequest::Remember(self.set.clone(), name));
            self.chosen = Some(now.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use taxel_files::storage::FileError;

    use super::*;

    #[test]
    fn the_error_itself_says_that_a_library_is_read_only() {
        let folder = tempfile::tempdir().expect("a folder");
        let library = Library::open(folder.path().to_owned());
        let said = |kind: ErrorKind| {
            let error = FileError::cannot("write", folder.path())(kind.into());
            not_changed(&library, "not deleted", &error.into())
        };
        let expected = "not deleted: the library is read-only";
        assert_eq!(said(ErrorKind::ReadOnlyFilesystem), expected);
        assert!(said(ErrorKind::StorageFull).contains("cannot write"));
    }

    #[test]
    fn an_age_is_given_in_the_unit_that_fits() {
        let said = [0, 59, 60, 720, 400_000].map(|seconds| ago(Duration::from_secs(seconds)));
        assert_eq!(
            said,
            [
                "less than a minute ago",
                "less than a minute ago",
                "about 60 seconds ago",
                "about 12 minutes ago",
                "about 5 days ago",
            ]
        );
    }
}
