//! Messages: the only things that change the state.
//!
//! A key becomes a message by the table of keys, a `:` command by its text, a click by what it points at. Effects
//! answer with messages, too. A script sends the same ones.

use taxel_files::formats::Name;

use crate::tui::app::Document;
use crate::tui::explore::ExploreMessage;
use crate::tui::files::FileToOpen;
use crate::tui::keys::{Arrow, Key};
use crate::tui::live::LiveMessage;
use crate::tui::recognise::RecogniseMessage;

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
    /// Begin to draw with the cursor, or stop.
    Draw,
    Explain,
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
    Sensor,
    Zoom(i8),
    Mouse(Mouse),
    Resized(u16, u16),
    SaveAs(Name),
    Named(Purpose, String),
    Restore(Option<String>),
    Become(Box<Document>),
    Command,
    Copy(Copied),
    Explore(ExploreMessage),
    Recognise(RecogniseMessage),
    OpenFile(Box<FileToOpen>),
    WriteFile(String),
    Live(LiveMessage),
    /// There are answers of jobs.
    Answered,
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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    Outline,
    Rectangle,
    /// The outline of the shape that was fitted to the imprint.
    Fit,
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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Load,
    Delete,
    Picture,
    Compare,
}
