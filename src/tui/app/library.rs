//! The requests of the screen to the library, and its answers.

use crate::formats::StoredShape;
use crate::storage::{Expected, LibraryEntry, LoadedShape};

/// The purpose for which a shape is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// The shape is put onto the matrix.
    Load,
    /// The shape is deleted.
    Delete,
    /// The shape is placed as a picture.
    Picture,
    /// The shape is compared with the matrix.
    Compare,
}

/// A request to the library.
#[derive(Clone, Debug, PartialEq)]
pub enum LibraryRequest {
    /// List the shapes.
    List,
    /// List the names of stored models.
    Models,
    /// List the names of deleted shapes.
    Trash,
    /// Read the shapes of these names.
    Read(Vec<String>),
    /// Read one shape by name, for this purpose.
    Named(Purpose, String),
    /// Save a shape, if its file holds what is expected.
    Store(Box<StoredShape>, Expected),
    /// Check whether the shape of this name can be deleted.
    Deletable(String),
    /// Delete a shape.
    Remove(String),
    /// Restore the shape that was deleted last: of this name, or of any name.
    Restore(Option<String>),
}

impl LibraryRequest {
    /// Returns true if the request changes the library.
    pub fn is_change(&self) -> bool {
        matches!(self, Self::Store(..) | Self::Remove(_) | Self::Restore(_))
    }
}

/// An answer of the library to a request. Errors are sentences.
#[derive(Clone, Debug, PartialEq)]
pub enum LibraryEvent {
    /// The list of the shapes.
    List(Result<Vec<LibraryEntry>, String>),
    /// The names of the models beside the library.
    Models(Vec<String>),
    /// The names of the deleted shapes.
    Trash(Result<Vec<String>, String>),
    /// The shapes that were read, by their names in the list.
    Read(Vec<(String, Result<LoadedShape, String>)>),
    /// The shape that was read by name, and the purpose.
    Named(Purpose, Result<Box<LoadedShape>, String>),
    /// The name of the stored shape, and the stamp of its file's content.
    Stored(String, u64),
    /// The reason why a shape was not stored.
    NotStored(String),
    /// The shape that was not stored because its file holds something else, the stamp of that content, and the reason
    /// in words.
    Differs(Box<StoredShape>, u64, String),
    /// The name of a shape that can be deleted, or the reason why it cannot.
    Deletable(Result<String, String>),
    /// The name of the deleted shape.
    Removed(String),
    /// The name of the restored shape.
    Restored(String),
    /// The recovered unsaved work of a program that crashed.
    Recovered(Box<StoredShape>),
    /// An offer of unsaved work of a program that crashed.
    Found(Leftover),
    /// The name of such work in the trash, and the next offer, if there is one.
    GivenUp(String, Option<Leftover>),
    /// The reason why such work could not be moved to the trash.
    NotGivenUp(String),
    /// The reason why a request failed.
    Failed(String),
}

/// An offer of unsaved work of programs that crashed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Leftover {
    /// The description of the work, in a few words.
    pub what: String,
    /// The number of offers, this one included.
    pub waiting: usize,
}
