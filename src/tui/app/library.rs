//! The requests of the screen to the library, and its answers.

use crate::formats::StoredShape;
use crate::storage::{Expected, LibraryEntry, LoadedShape};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Load,
    Delete,
    Picture,
    Compare,
}

#[derive(Clone, Debug, PartialEq)]
pub enum LibraryRequest {
    List,
    Models,
    Trash,
    Read(Vec<String>),
    Named(Purpose, String),
    Store(Box<StoredShape>, Expected),
    Deletable(String),
    Remove(String),
    Restore(Option<String>),
}

impl LibraryRequest {
    pub fn is_change(&self) -> bool {
        matches!(self, Self::Store(..) | Self::Remove(_) | Self::Restore(_))
    }
}

/// Errors are sentences.
#[derive(Clone, Debug, PartialEq)]
pub enum LibraryEvent {
    List(Result<Vec<LibraryEntry>, String>),
    Models(Vec<String>),
    Trash(Result<Vec<String>, String>),
    Read(Vec<(String, Result<LoadedShape, String>)>),
    Named(Purpose, Result<Box<LoadedShape>, String>),
    Stored(String, u64),
    NotStored(String),
    /// The shape that was not stored because its file holds something else, the stamp of that content, and the reason
    /// in words.
    Differs(Box<StoredShape>, u64, String),
    /// The name of a shape that can be deleted, or the reason why it cannot.
    Deletable(Result<String, String>),
    Removed(String),
    Restored(String),
    Recovered(Box<StoredShape>),
    Found(Leftover),
    GivenUp(String, Option<Leftover>),
    NotGivenUp(String),
    Failed(String),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Leftover {
    pub what: String,
    pub waiting: usize,
}
