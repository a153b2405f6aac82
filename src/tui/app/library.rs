//! What the screen asks of the library, and what it answers.

use crate::formats::StoredShape;
use crate::storage::{Expected, LibraryEntry, LoadedShape};

/// What a shape is chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To put it onto the matrix.
    Load,
    /// To delete it.
    Delete,
    /// To place it as a picture.
    Picture,
    /// To compare it with the matrix.
    Compare,
}

/// Requests to the library.
#[derive(Clone, Debug, PartialEq)]
pub enum LibraryRequest {
    /// List its shapes.
    List,
    /// List the names of stored models.
    Models,
    /// List the names of deleted shapes.
    Trash,
    /// Read the shapes of these names.
    Read(Vec<String>),
    /// Read one shape by name, and what for.
    Named(Purpose, String),
    /// Save a shape, given what its file is expected to hold.
    Store(Box<StoredShape>, Expected),
    /// Look whether the shape of that name can be deleted.
    Deletable(String),
    /// Delete a shape.
    Remove(String),
    /// Restore the shape that was deleted last, of that name or of any.
    Restore(Option<String>),
}

impl LibraryRequest {
    /// Whether it changes the library.
    pub fn is_change(&self) -> bool {
        matches!(self, Self::Store(..) | Self::Remove(_) | Self::Restore(_))
    }
}

/// An answer of the library to a request. Errors are sentences.
#[derive(Clone, Debug, PartialEq)]
pub enum LibraryEvent {
    /// Its list.
    List(Result<Vec<LibraryEntry>, String>),
    /// The names of the models beside it.
    Models(Vec<String>),
    /// The names of its shapes that were deleted.
    Trash(Result<Vec<String>, String>),
    /// Some of its shapes, by their names in the list.
    Read(Vec<(String, Result<LoadedShape, String>)>),
    /// The shape that was asked for by its name, and what for.
    Named(Purpose, Result<Box<LoadedShape>, String>),
    /// A shape was stored under this name, and this is what its file holds.
    Stored(String, u64),
    /// It was not stored, and why.
    NotStored(String),
    /// It was not stored, because the file holds something else; the question whether to replace it.
    Differs(Box<StoredShape>, u64, String),
    /// The shape of that name can be deleted, or not, and why.
    Deletable(Result<String, String>),
    /// It was removed.
    Removed(String),
    /// It was brought back.
    Restored(String),
    /// Unsaved work of a program that crashed was recovered.
    Recovered(Box<StoredShape>),
    /// There is unsaved work of a program that crashed.
    Found(Leftover),
    /// Such work was moved to the trash under this name; and the next offer, if there is one.
    GivenUp(String, Option<Leftover>),
    /// It could not be moved to the trash, and why.
    NotGivenUp(String),
    /// The request failed, and why.
    Failed(String),
}

/// An offer of unsaved work of programs that crashed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Leftover {
    /// What is offered, in a few words.
    pub what: String,
    /// How many offers there are, this one included.
    pub waiting: usize,
}
