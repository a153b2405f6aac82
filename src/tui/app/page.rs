//! What the screen knows about a page: each form, list, prompt, question or result that lies over the matrix.
//!
//! [`crate::tui::app::dialog`] has the table of pages. The screen draws them, shows their keys and finds what the mouse
//! points at through this trait, and so never names one of them.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::imprint::Imprint;
use crate::recognition::PlacedSource;
use crate::tui::app::message::Message;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::theme::{Role, Theme};

/// Where a page stands on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// Between the menu and the line of notices. It hides the lines about the matrix, too.
    Screen,
    /// Between the menu and the lines at the foot.
    Body,
    /// Beside the matrix, which stays visible.
    Form,
    /// In place of the descriptors: beside the matrix, or where that is too narrow, a page of its own.
    Panel,
    /// In the line of notices, over the page below. Notices stand above it.
    Prompt,
    /// In place of a notice, over the page below.
    Question,
}

/// What a notch of the mouse wheel does on a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wheel {
    /// Nothing.
    Idle,
    /// One step, where only what is chosen is visible: more would skip what lies between.
    Step,
    /// Three rows of a list, or of what is larger than the screen.
    Rows,
}

impl Wheel {
    /// By how many lines a notch scrolls; None where it does nothing.
    pub fn lines(self) -> Option<i16> {
        match self {
            Self::Idle => None,
            Self::Step => Some(1),
            Self::Rows => Some(3),
        }
    }
}

/// Poses that are drawn over the matrix.
#[derive(Clone, Copy, Debug, Default)]
pub struct PoseLayer<'a> {
    /// The likeliest one first.
    pub sources: &'a [PlacedSource],
    /// Whether they are shown; None for what suits the room.
    pub shown: Option<bool>,
}

/// A page that lies over the matrix. The top one receives the keys.
pub trait Page {
    /// The place where its keys are looked up.
    fn context(&self) -> Context;

    /// Where it stands.
    fn slot(&self) -> Slot;

    /// Draws it into the area of its slot. Returns where the text cursor is, None if the page has none.
    fn draw(
        &self,
        theme: &Theme,
        keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position>;

    /// Draws what stands over the page below it; `body` is the area between the menu and the lines at the foot. Nothing
    /// unless the page says otherwise.
    fn draw_over(&self, _theme: &Theme, _buffer: &mut Buffer, _body: Rect) {}

    /// What a click at a position of its area means, None if there is nothing to click on.
    fn click(&self, _area: Rect, _at: Position) -> Option<Message> {
        None
    }

    /// What the mouse wheel does on it.
    fn wheel(&self) -> Wheel {
        Wheel::Idle
    }

    /// Whether Cancel and Quit go to its own update. Otherwise they close it.
    fn cancels_itself(&self) -> bool {
        false
    }

    /// Whether it can do something with a message now, in the area of its slot. Hints leave out keys whose messages it
    /// has no use for; pressing one shows why it does nothing.
    fn has_use_for(&self, _message: &Message, _area: Rect) -> bool {
        true
    }

    /// The imprint that the matrix is compared with: taxels that differ have marks. None for no comparison.
    fn compared_with(&self) -> Option<&Imprint> {
        None
    }

    /// Shapes in poses that may have left the imprint on the matrix, which are drawn over it; none unless the page says
    /// otherwise.
    fn poses(&self) -> PoseLayer<'_> {
        PoseLayer::default()
    }

    /// Whether keys, clicks and the cursor that it has no use for are the matrix's.
    fn leaves_matrix(&self) -> bool {
        false
    }

    /// Its own text for the line of notices. It is shown while there is no notice; that of a question always.
    fn remark(&self, _keymap: &Keymap, _body: Rect) -> Option<(String, Role)> {
        None
    }

    /// An error that a notice must not hide: it is shown after the notice. None unless the page says otherwise.
    fn alarm(&self) -> Option<String> {
        None
    }
}
