//! What can go wrong with a library: which file, what it is, what was expected.

use std::io;
use std::path::PathBuf;

use crate::formats::{NameError, ShapeError};

/// Why something was not done. Whatever it was, nothing was lost.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LibraryError {
    /// No name.
    #[error(transparent)]
    Name(#[from] NameError),
    /// No such shape.
    #[error("no shape is called {name:?}")]
    Unknown {
        /// What was asked for.
        name: String,
    },
    /// Nothing of that name in the trash.
    #[error("nothing called {name:?} is in the trash")]
    NotInTrash {
        /// What was asked for.
        name: String,
    },
    /// A shape that cannot be changed.
    #[error("{name:?} comes with the program; it can be copied under another name")]
    Shipped {
        /// Its name.
        name: String,
    },
    /// The name is taken.
    #[error("{name:?} is there already")]
    Exists {
        /// The name that is taken, as the file has it.
        name: String,
        /// What the file holds now.
        stamp: u64,
    },
    /// Somebody else has written meanwhile.
    #[error("{name:?} was changed by another program since it was loaded")]
    Changed {
        /// The name.
        name: String,
        /// What the file holds now.
        stamp: u64,
    },
    /// Something else is in the way.
    #[error("{}: is {what}, expected {expected}", path.display())]
    InTheWay {
        /// Where.
        path: PathBuf,
        /// What it is.
        what: &'static str,
        /// What should be there.
        expected: &'static str,
    },
    /// A file without a shape.
    #[error("{}: {error}", path.display())]
    Broken {
        /// Where.
        path: PathBuf,
        /// What is wrong with it.
        error: ShapeError,
    },
    /// The system refused.
    #[error("{}: cannot {doing}: {error}", path.display())]
    System {
        /// What was to be done.
        doing: &'static str,
        /// Where.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// The system does not tell where a user's data belong.
    #[error("no home folder: name a folder for the library with --library DIR or TAXEL_LIBRARY")]
    NoPlace,
}
