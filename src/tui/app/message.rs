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
use crate::tui::live::message::{LiveMessage, WatchRequest};
use crate::tui::recognise::state::RecogniseMessage;

#[derive(Clone, Debug, PartialEq)]
pub enum Message {
    New,
    Load,
    Figure,
    Picture,
    Save,
    Delete,
    /// Leave, after a question if work would be lost.
    Quit,
    QuitNow,
    Terminate,
    Help,
    Cursor(Arrow),
    ToColumn(Endpoint),
    ToRow(Endpoint),
    PointAt(u8, u8),
    Toggle,
    Defaults,
    Undo,
    Redo,
    /// Select the region this many further on; negative goes back. The first follows the last.
    Region(i8),
    Display,
    Layer(Layer),
    SwitchPane,
    /// Hold the shape, so that the arrows move it, or let it go.
    Hold,
    PutBack,
    Compare,
    History,
    Nudge(Arrow),
    Move(f64, f64),
    /// Turn the shape clockwise as seen, by degrees.
    Turn(f64),
    NudgeStep(i8),
    /// Go to the field of a form this many further on; negative goes back.
    Field(i8),
    /// None is the kind in a form of a figure, and the anchor in the form of ranges.
    ToField(Option<usize>),
    Choose(Arrow),
    Step(i8),
    Type(char),
    Erase(Erase),
    ToEdge(Endpoint),
    Paste(String),
    Accept,
    Cancel,
    Decline,
    Scroll(i16),
    /// Scroll by this many screens; negative goes up.
    ScrollScreen(i8),
    ScrollTo(Endpoint),
    /// Select a row of a list, by its number from 0.
    Select(usize),
    Search,
    /// Go to the match this many further on; negative goes back. The first follows the last.
    Match(i8),
    Sensor,
    Zoom(i8),
    Mouse(Mouse),
    Resized(u16, u16),
    Recover,
    GiveUp,
    Request(LibraryRequest),
    Library(LibraryEvent),
    Become(Box<Document>),
    Command,
    Copy(Copied),
    Explore(ExploreMessage),
    Recognise(RecogniseMessage),
    OpenFile(String),
    WriteFile(String),
    Overwrite(String, Vec<u8>),
    File(FileEvent),
    Live(LiveMessage),
    Worker(WorkerEvent),
    Unknown(Key),
    Redraw,
    /// Suspend the program, as Ctrl-Z does, until the shell continues it.
    Suspend,
}

impl Message {
    pub(in crate::tui) fn moves_shape(&self) -> bool {
        use Message::{Move, Nudge, NudgeStep, PutBack, Turn, Zoom};
        matches!(
            self,
            Nudge(_) | Move(..) | Turn(_) | Zoom(_) | NudgeStep(_) | PutBack
        )
    }
}

/// Errors are sentences.
#[derive(Clone, Debug, PartialEq)]
pub enum FileEvent {
    Opened(String, OpenedFile),
    Written(String),
    /// The file was not written, because one of this name exists; with the content to write.
    Exists(String, Vec<u8>),
    Failed(String),
    Source(Arc<WatchRequest>),
    Paths(Vec<String>),
}

#[derive(Clone, Debug, PartialEq)]
pub enum OpenedFile {
    Shape(Box<StoredShape>),
    Imprint(Box<Imprint>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    Outline,
    Rectangle,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Copied {
    Imprint,
    Descriptors,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mouse {
    pub kind: MouseKind,
    pub column: u16,
    pub row: u16,
}

/// The button is the left one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MouseKind {
    Press,
    Drag,
    Release,
    ScrollUp,
    ScrollDown,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Endpoint {
    First,
    Last,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Erase {
    Before,
    Under,
    All,
}
