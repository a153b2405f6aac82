//! The trait of pages: all forms, lists, prompts, questions and results that lie over the matrix.
//!
//! [`crate::tui::app::dialog`] has the table of pages. Through this trait the screen draws them, shows their keys and
//! finds what the mouse points at, without naming any of them.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::imprint::Imprint;
use crate::recognition::PlacedSource;
use crate::tui::app::message::Message;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::theme::{Role, Theme};

/// The place of a page on the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// Between the menu and the line of notices. It hides the lines about the matrix, too.
    Screen,
    /// Between the menu and the lines at the foot.
    Body,
    /// Beside the matrix, which stays visible.
    Form,
    /// In place of the descriptors: beside the matrix, or where that is too narrow, in place of it.
    Panel,
    /// In the line of notices, over the page below. Notices stand above it.
    Prompt,
    /// In place of a notice, over the page below.
    Question,
}

/// The effect of a notch of the mouse wheel on a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wheel {
    /// Nothing.
    Idle,
    /// One step, where only the chosen item is visible: more would skip the items between.
    Step,
    /// Three rows of a list, or of a content that is larger than the screen.
    Rows,
}

impl Wheel {
    /// Returns the number of lines that a notch scrolls; None if it does nothing.
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
    /// The poses, the likeliest one first.
    pub sources: &'a [PlacedSource],
    /// Whether they are shown; None to decide by the room.
    pub shown: Option<bool>,
}

/// A page that lies over the matrix. The top one receives the keys.
pub trait Page {
    /// Returns the context in which its keys are looked up.
    fn context(&self) -> Context;

    /// Returns its place on the screen.
    fn slot(&self) -> Slot;

    /// Returns true if the page has a pane of its own. Prompts and questions stand in the line of notices, over the
    /// page below.
    fn has_pane(&self) -> bool {
        !matches!(self.slot(), Slot::Prompt | Slot::Question)
    }

    /// Draws the page into the area of its slot, which is empty. Returns the position of the text cursor, None if the
    /// page has none.
    fn draw(
        &self,
        theme: &Theme,
        keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position>;

    /// Draws over the page below; `body` is the area between the menu and the lines at the foot. Does nothing by
    /// default.
    fn draw_over(&self, _theme: &Theme, _buffer: &mut Buffer, _body: Rect) {}

    /// Returns the message of a click at a position of its area, None if there is nothing to click on.
    fn click(&self, _area: Rect, _at: Position) -> Option<Message> {
        None
    }

    /// Returns the effect of the mouse wheel.
    fn wheel(&self) -> Wheel {
        Wheel::Idle
    }

    /// Returns true if its own update handles Cancel and Quit. Otherwise they close the page.
    fn cancels_itself(&self) -> bool {
        false
    }

    /// Returns true while the page waits for work whose end changes what keys do. False by default.
    fn awaits_work(&self) -> bool {
        false
    }

    /// Returns true if the page can do something with a message now, in the area of its slot. Hints leave out keys
    /// whose messages it has no use for; pressing one shows why it does nothing.
    fn has_use_for(&self, _message: &Message, _area: Rect) -> bool {
        true
    }

    /// Returns the imprint that the matrix is compared with: taxels that differ have marks. None for no comparison.
    fn compared_with(&self) -> Option<&Imprint> {
        None
    }

    /// Returns shapes in poses that may have left the imprint on the matrix, to be drawn over it. There are none by
    /// default.
    fn poses(&self) -> PoseLayer<'_> {
        PoseLayer::default()
    }

    /// Returns true if the matrix takes the keys, clicks and the cursor that the page has no use for.
    fn leaves_matrix(&self) -> bool {
        false
    }

    /// Returns the text of the page for the line of notices. It is shown while there is no notice.
    fn remark(&self, _keymap: &Keymap, _body: Rect) -> Option<(String, Role)> {
        None
    }

    /// Returns true if the page ends above a notice of several lines instead of being covered by it: where messages
    /// stay as long as their reason. False by default.
    fn makes_room(&self) -> bool {
        false
    }

    /// Returns an error that a notice must not hide: it is shown after the notice. None by default.
    fn alarm(&self) -> Option<String> {
        None
    }
}
