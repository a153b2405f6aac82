//! Files: the shape library (a folder with one JSON file per shape, and the shapes that come with the program),
//! sweeps and models.
//!
//! **Nothing is lost.** A file is written under another name, synced and renamed into place; then the folder is synced.
//! So at every moment, whatever fails, either the complete old file or the complete new one exists; of the two files of
//! a sweep, the second may be missing ([`persist_pair`]). Deleting a shape moves its file to a trash inside the folder;
//! a model is removed for good, because it can be trained again. Writers of shapes hold the folder's lock while they
//! write, so that two programs see each other's work; the three files of what was typed are written without it, and of
//! two programs that add a line at once, one may lose it. A half-written file for which nobody holds a lock was left by
//! a program that died, and is removed (one of a journal together with that journal). Reading needs neither a lock nor
//! write access to the folder.
//!
//! ```text
//! FOLDER/washer.json                    a shape
//! FOLDER/.commands                      what was typed after `:`, a line each
//! FOLDER/.recognise                     the set of shapes that was recognised last
//! FOLDER/.forms                         the values that forms were accepted with, a line each
//! FOLDER/.lock                          held while writing
//! FOLDER/.taxel-tmp                     being written by the holder of the lock
//! FOLDER/.taxel-tmp-4fQx0ZmW2k9bT7cR    being written, or a file that is being replaced; the ending is random
//! FOLDER/.trash/0000000007 washer.json  deleted
//! FOLDER/.trash/.taxel-tmp              being written
//! FOLDER/.journal/4711-0.json           unsaved work of a running program, or of one that died
//! FOLDER/.journal/4711-0.lock           held as long as that program runs
//! FOLDER/.journal/4711-0.tmp            being written
//! ```

mod error;

mod access;

mod atomic_file;

mod temporary;

mod scratch_folder;

pub mod location;

mod file_id;

mod folder;

mod lock;

mod name_index;

pub mod shipped;

mod trash;

mod library;

mod journal;

mod remembered;

mod first_error;

mod sweep_file;

mod models;

mod model_choice;

pub use atomic_file::{Existing, FinishedFile, UnfinishedFile, check_writable, persist_pair};

pub use file_id::FileId;

pub(crate) use atomic_file::persist_beside;

pub use atomic_file::folder_of;

pub use error::FileError;

pub use scratch_folder::ScratchFolder;

pub use error::LibraryError;

pub use remembered::RememberedFile;

pub use journal::{Journal, Orphan, UNNAMED};

pub use library::{Expected, Library, LibraryEntry, LoadedShape, ShapeOrigin};

pub use trash::TRASH_KEPT;

pub use error::ArchiveFileError;

pub use sweep_file::{AtlasEndingError, AtlasFile, PoseFile, is_poses, load_atlas, open_archive};

pub use models::{
    FileVersion, MadeFolder, ModelCache, ModelFolder, cached_or_trained, load_model,
    load_whole_model, model_hash, save_model,
};

pub use model_choice::ModelChoice;

pub use model_choice::unknown_set;
