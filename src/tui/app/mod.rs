//! The state of the program, what changes it, and the screen as a whole.
//!
//! ```text
//! document   the document on the matrix, and its reading   history: all its states
//! message    what a key means
//! page       the trait of pages                        question: the smallest of them
//! state      App                                       update: all changes begin there
//! change     changes of the document                   mouse: what clicks and drags do
//! unsaved    what would be lost: the question before the end, the journal, the offer after a crash
//! view       the layout                                menu, status: the lines above and below
//! ```

pub mod document;

pub mod message;

pub mod page;

pub(crate) mod question;

pub mod state;

pub mod history;

pub mod unsaved;

pub mod change;

pub mod mouse;

pub mod update;

pub mod menu;

pub mod status;

pub mod view;

pub(in crate::tui) use change::*;
pub use document::*;
pub use history::*;
pub use message::*;
pub use page::*;
pub(in crate::tui) use question::Question;
pub use state::*;
