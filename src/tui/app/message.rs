//! Messages: the only things that change the state.
//!
//! A key becomes a message by the table of keys, a `:` command by its text, a click by what it points at. Effects
//! answer with messages, too. A script sends the same ones.

use crate::formats::StoredShape;
use crate::storage::{Expected, LibraryEntry, LoadedShape};
use crate::tui::app::document::Document;
use crate::tui::explore::message::{ExploreMessage, WorkerEvent};
use crate::tui::keys::key::Arrow;

/// A request, whoever makes it: a key, a script, a paste.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// Empty the matrix.
    New,
    /// Bring a stored shape onto the matrix.
    Load,
    /// Open the form of a figure.
    Figure,
    /// Move a stored shape about.
    Picture,
    /// Store what is on the matrix.
    Save,
    /// Remove a stored shape.
    Delete,
    /// Leave, after a question where work would be lost.
    Quit,
    /// Leave at once, giving up what is not saved.
    QuitNow,
    /// The end comes from outside, by a signal: leave at once, what is not saved stays in the journal.
    Terminate,
    /// Show all keys.
    Help,
    /// Move the cursor by one taxel.
    Cursor(Arrow),
    /// Move the cursor to the first or last column.
    ToColumn(Endpoint),
    /// Move the cursor to the first or last row.
    ToRow(Endpoint),
    /// Move the cursor to a taxel: column, row.
    PointAt(u8, u8),
    /// Turn the taxel under the cursor over.
    Toggle,
    /// Take the last change back.
    Undo,
    /// Make it again.
    Redo,
    /// Select another region, so many further on.
    Region(i8),
    /// Show the matrix in the next way: imprint, shades, percent.
    Display,
    /// Change between the matrix and the descriptors where there is no room for both.
    SwitchPage,
    /// Take hold of the shape, or let it go.
    Grab,
    /// Move the shape by a step.
    Nudge(Arrow),
    /// Move the shape by so many cells along x and along y.
    Move(f64, f64),
    /// Turn the shape clockwise as seen, by whole degrees.
    Turn(i16),
    /// Another step of nudging, larger or smaller.
    NudgeStep(i8),
    /// Go to another field of a form, so many further on.
    Field(i8),
    /// Go to the field of that number; none: to the kind of a form, or what follows the fields of ranges.
    ToField(Option<usize>),
    /// An arrow in a form: moves within a field, or chooses.
    Choose(Arrow),
    /// Change a field by its last decimal.
    Step(i8),
    /// A character for the field, or for a choice.
    Type(char),
    /// Delete in the field.
    Erase(Erase),
    /// Move in the field to its start or end.
    ToEdge(Endpoint),
    /// Text that was pasted.
    Paste(String),
    /// Take what the dialog says, or answer yes.
    Accept,
    /// Leave the dialog and everything as it was.
    Cancel,
    /// No to a question.
    Decline,
    /// Scroll or go on in a list by lines.
    Scroll(i16),
    /// To the first or the last line of a list.
    ScrollTo(Endpoint),
    /// The form of the sensor.
    Sensor,
    /// Scale the shape up or down.
    Zoom(i8),
    /// What the mouse did.
    Mouse(Mouse),
    /// The screen has this many columns and rows.
    Resized(u16, u16),
    /// Store the shape, with what is expected to be in its place.
    Store(Box<StoredShape>, Expected),
    /// Ask whether the shape shall be stored over a file that holds this.
    Replace(Box<StoredShape>, u64),
    /// Remove the shape of that name.
    Remove(String),
    /// Bring back work that a program left when it died.
    Recover,
    /// Throw such work away.
    GiveUp,
    /// What the library answers.
    Library(LibraryEvent),
    /// Ask whether the shape of that name shall be removed.
    AskRemove(String),
    /// Bring the shape of that name onto the matrix.
    LoadNamed(String),
    /// Move the shape of that name about.
    PictureNamed(String),
    /// Bring back the shape of that name that was removed last.
    Restore(String),
    /// Put a document in place of the present one.
    Become(Box<Document>),
    /// Open the command line at the foot.
    Command,
    /// Put something into the clipboard of the user's terminal.
    Copy(Copied),
    /// Have the mouse reported, or leave it to the terminal.
    MouseOnOff,
    /// Something about the imprints of all poses.
    Explore(ExploreMessage),
    /// What a worker tells.
    Worker(WorkerEvent),
    /// Draw everything anew.
    Redraw,
    /// Give the terminal back to the shell until it calls again.
    Suspend,
}

/// What a shape is chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// To put it onto the matrix.
    Load,
    /// To delete it.
    Delete,
    /// To place it as a picture.
    Picture,
}

/// What can be copied.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Copied {
    /// The imprint as rows of text.
    Imprint,
    /// The descriptors of the region that is described, a line each.
    Descriptors,
}

/// What the library answers to a request. Errors are sentences.
#[derive(Clone, Debug, PartialEq)]
pub enum LibraryEvent {
    /// Its list.
    List(Result<Vec<LibraryEntry>, String>),
    /// The names of its shapes that were deleted.
    Trash(Result<Vec<String>, String>),
    /// Some of its shapes, by their place in the list.
    Read(Vec<(usize, Result<LoadedShape, String>)>),
    /// The shape that was asked for by its name, and what for.
    Named(Purpose, Result<Box<LoadedShape>, String>),
    /// A shape was stored under this name, and this is what its file holds.
    Stored(String, u64),
    /// It was not: the file holds something else, which is to be asked about.
    Differs(Box<StoredShape>, u64, String),
    /// It was removed.
    Removed(String),
    /// It was brought back.
    Restored(String),
    /// Work that a program left when it died.
    Recovered(Box<StoredShape>),
    /// A program left work when it died.
    Found(Leftover),
    /// Such work was thrown into the trash, under this name; and what is left then.
    GivenUp(String, Option<Leftover>),
    /// It was not, and why.
    NotGivenUp(String),
    /// Nothing came of it.
    Failed(String),
}

/// Work that programs left when they died.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Leftover {
    /// What the one that is offered is, in a few words.
    pub what: String,
    /// How many there are with it.
    pub waiting: usize,
}

/// What the mouse did, and where on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mouse {
    /// What.
    pub kind: MouseKind,
    /// Column of the screen.
    pub column: u16,
    /// Row of the screen.
    pub row: u16,
}

/// What a mouse can do. The left button is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MouseKind {
    /// The button went down.
    Press,
    /// The mouse moved while the button was down.
    Drag,
    /// The button went up.
    Release,
    /// The wheel turned up.
    ScrollUp,
    /// The wheel turned down.
    ScrollDown,
}

/// One of two ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Endpoint {
    /// The first.
    First,
    /// The last.
    Last,
}

/// What to delete in a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Erase {
    /// The character before the cursor.
    Before,
    /// The character under the cursor.
    Under,
    /// Everything.
    All,
}
