//! Files: the shape library (a folder with one JSON file per shape, and the shapes that come with the program),
//! sweeps and models.
//!
//! **Nothing is lost.** A file is written under another name, synced and renamed into place; then the folder is synced.
//! So at every moment, whatever fails, either the complete old file or the complete new one exists. Deleting a shape
//! moves its file to a trash inside the folder; a model is removed for good, because it can be trained again. Writers
//! of shapes hold the folder's lock while they write, so that two programs see each other's work; the files of what was
//! typed are written without it, and of two programs that add a line at once, one may lose it. A program that is
//! killed may leave a file `.taxel-…`, which another program removes a day later. Reading needs neither a lock nor write
//! access to the folder.
//!
//! ```text
//! FOLDER/washer.json                        a shape
//! FOLDER/models/parts.npz                   a model
//! FOLDER/.commands                          what was typed after `:`, a line each
//! FOLDER/.recognise                         the set of shapes that was recognised last
//! FOLDER/.lock                              held while writing
//! FOLDER/.taxel-4fQx0ZmW                    being written; the ending is random
//! FOLDER/.trash/washer-1764370000123.json   deleted at that time, in milliseconds since 1970
//! FOLDER/.journal/1764370000123-4711.json   unsaved work of a running program, which holds its lock, or of one that died
//! ```

mod error;
mod file;
mod journal;
mod library;
mod models;
pub mod shipped;
mod sweep_file;

pub use error::{FileError, LibraryError};
pub use file::{Existing, FileId, NewFile, check_writable, folder_of, open, write};
pub use journal::{Journal, Orphan, UNNAMED};
pub use library::{Expected, Library, LibraryEntry, LoadedShape, ShapeOrigin, TRASH_KEPT};
pub use library::{LIBRARY_VARIABLE, below_home, usual_folder};
pub use models::{
    FoundModel, ModelCache, ModelChoice, ModelFolder, Models, load_model, load_whole_model,
    model_hash, save_model,
};
pub use sweep_file::{PoseFile, atlas_path, load_atlas, write_atlas};
