//! Messages: the only things that change the state.
//!
//! A key becomes a message by the table of keys, a `:` command by its text, a click by what it points at. Effects
//! answer with messages, too. A script sends the same ones.

use std::sync::Arc;

use crate::formats::StoredShape;
use crate::imprint::Imprint;
use crate::tui::app::document::Document;
use crate::tui::app::library::{LibraryEvent, LibraryRequest};
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::explore::message::ExploreMessage;
use crate::tui::keys::key::{Arrow, Key};
use crate::tui::live::message::LiveMessage;
use crate::tui::live::request::WatchRequest;
use crate::tui::recognise::message::RecogniseMessage;

/// A message, from a key, a click, a command, a script, or as the answer to an effect.
#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    /// Empty the matrix.
    New,
    /// Bring a stored shape onto the matrix.
    Load,
    /// Open the form of a figure.
    Figure,
    /// Place a stored shape as a picture.
    Picture,
    /// Store what is on the matrix.
    Save,
    /// Remove a stored shape.
    Delete,
    /// Leave, after a question if work would be lost.
    Quit,
    /// Leave at once, giving up what is not saved.
    QuitNow,
    /// Leave at once, after a signal from outside; unsaved work stays in the journal.
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
    /// Switch the taxel under the cursor on or off.
    Toggle,
    /// Give all fields of a form their defaults.
    Defaults,
    /// Undo the last change.
    Undo,
    /// Redo the change that was undone last.
    Redo,
    /// Select the region this many further on; negative goes back. The first follows the last.
    Region(i8),
    /// Show the matrix in the next way: imprint, shades, percent.
    Display,
    /// Show a layer over the taxels, or hide it.
    Layer(Layer),
    /// Change between the matrix and the descriptors where there is no room for both.
    SwitchPane,
    /// Hold the shape, so that the arrows move it, or let it go.
    Hold,
    /// Put the held shape back to where it was taken.
    PutBack,
    /// Compare the imprint on the matrix with the one that is selected, or with the state before the last step.
    Compare,
    /// Show all steps of the history.
    History,
    /// Move the shape by a step.
    Nudge(Arrow),
    /// Move the shape by a distance in cells along x and y.
    Move(f64, f64),
    /// Turn the shape clockwise as seen, by degrees.
    Turn(f64),
    /// Another step of nudging, larger or smaller.
    NudgeStep(i8),
    /// Go to the field of a form this many further on; negative goes back.
    Field(i8),
    /// Go to the field of this index. None is the kind in a form of a figure, and the anchor in the form of ranges.
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
    /// Accept the input on the page, or answer yes.
    Accept,
    /// Close the page and change nothing.
    Cancel,
    /// Answer no to a question.
    Decline,
    /// Scroll or move in a list by this many lines.
    Scroll(i16),
    /// Scroll by this many screens; negative goes up.
    ScrollScreen(i8),
    /// Go to the first or the last line of a list.
    ScrollTo(Endpoint),
    /// Select a row of a list, by its number from 0.
    Select(usize),
    /// Open the prompt that searches in help.
    Search,
    /// Go to the match this many further on; negative goes back. The first follows the last.
    Match(i8),
    /// Open the form of the sensor.
    Sensor,
    /// Scale the shape up or down.
    Zoom(i8),
    /// An event of the mouse.
    Mouse(Mouse),
    /// The size of the screen has changed: columns, rows.
    Resized(u16, u16),
    /// Recover the unsaved work of a program that crashed.
    Recover,
    /// Move the unsaved work of a program that crashed to the trash.
    GiveUp,
    /// A request to the library.
    Request(LibraryRequest),
    /// An answer of the library.
    Library(LibraryEvent),
    /// Put a document in place of the present one.
    Become(Box<Document>),
    /// Open the command line at the foot.
    Command,
    /// Put something into the clipboard of the user's terminal.
    Copy(Copied),
    /// A message about the imprints of all poses.
    Explore(ExploreMessage),
    /// A message about recognition.
    Recognise(RecogniseMessage),
    /// Open a file.
    OpenFile(String),
    /// Write what is on the matrix to a file.
    WriteFile(String),
    /// Write this content over a file that exists, given its name.
    Overwrite(String, Vec<u8>),
    /// The answer to a request about files.
    File(FileEvent),
    /// A message about the frames of a sensor.
    Live(LiveMessage),
    /// An event of a worker.
    Worker(WorkerEvent),
    /// A key that means nothing here.
    Unknown(Key),
    /// Redraw the whole screen.
    Redraw,
    /// Suspend the program, as Ctrl-Z does, until the shell continues it.
    Suspend,
}

impl Message {
    /// Returns true if the message moves the shape, or sets how far it moves.
    pub(in crate::tui) fn moves_shape(&self) -> bool {
        use Message::{Move, Nudge, NudgeStep, PutBack, Turn, Zoom};
        matches!(
            self,
            Nudge(_) | Move(..) | Turn(_) | Zoom(_) | NudgeStep(_) | PutBack
        )
    }
}

/// The answer to a request about files. Errors are sentences.
#[derive(Clone, Debug, PartialEq)]
pub enum FileEvent {
    /// The file of this name was opened.
    Opened(String, OpenedFile),
    /// The file of this name was written.
    Written(String),
    /// The file was not written, because one of this name exists; with the content to write.
    Exists(String, Vec<u8>),
    /// The reason why the request failed.
    Failed(String),
    /// The source of frames can be watched.
    Source(Arc<WatchRequest>),
    /// The paths that were asked for.
    Paths(Vec<String>),
}

/// The content of an opened file.
#[derive(Clone, Debug, PartialEq)]
pub enum OpenedFile {
    /// A shape.
    Shape(Box<StoredShape>),
    /// An imprint alone.
    Imprint(Box<Imprint>),
}

/// A layer over the taxels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// The true outline of the source.
    Outline,
    /// The circumscribed rectangle, CG and CD.
    Rectangle,
}

/// Something to copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Copied {
    /// The imprint as rows of text.
    Imprint,
    /// The descriptors of the region that is described, a line each.
    Descriptors,
}

/// An event of the mouse, and its position on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mouse {
    /// The kind of event.
    pub kind: MouseKind,
    /// The column of the screen.
    pub column: u16,
    /// The row of the screen.
    pub row: u16,
}

/// A kind of mouse event. The button is the left one.
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

/// The part of a field's text to delete.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Erase {
    /// The character before the cursor.
    Before,
    /// The character under the cursor.
    Under,
    /// Everything.
    All,
}
