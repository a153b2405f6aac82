//! The trait of pages: all forms, lists, prompts, questions and results that lie over the matrix.
//!
//! They are a stack; the top one receives the keys. Through this trait the screen draws them, shows their keys and
//! finds what the mouse points at, without naming any of them.

use std::any::Any;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::{App, Message};
use crate::tui::keys::{Context, Keymap};
use crate::tui::widget::{Role, TextField, Theme, write};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Between the menu and the line of notices. It hides the lines about the matrix, too.
    Screen,
    Body,
    Form,
    Panel,
    /// Notices stand above it.
    Prompt,
    Question,
}

/// How far a notch of the wheel scrolls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wheel {
    Idle = 0,
    /// Where only the chosen item is visible: more would skip the items between.
    Step = 1,
    Rows = 3,
}

/// The keys of a page, its place, and how far the wheel scrolls it.
pub type Placed = (Context, Place, Wheel);

pub type Act = Box<dyn FnOnce(&mut App)>;

/// What a page wants after a message.
#[expect(missing_debug_implementations, reason = "pages and acts have no text")]
pub enum Flow {
    Stay,
    Close,
    Push(Box<dyn Page>),
    /// Closes the page and does this. If that is refused, at once or by the answer of a job, the page opens again.
    Ask(Act),
}

impl Flow {
    pub(crate) fn push(page: impl Page) -> Self {
        Self::Push(Box::new(page))
    }

    pub(crate) fn ask(act: impl FnOnce(&mut App) + 'static) -> Self {
        Self::Ask(Box::new(act))
    }
}

/// The topmost page of this kind.
pub(crate) fn find<T: Page>(pages: &[Box<dyn Page>]) -> Option<&T> {
    let mut pages = pages.iter().rev();
    pages.find_map(|page| (&**page as &dyn Any).downcast_ref())
}

pub(crate) fn find_mut<T: Page>(pages: &mut [Box<dyn Page>]) -> Option<&mut T> {
    let mut pages = pages.iter_mut().rev();
    pages.find_map(|page| (&mut **page as &mut dyn Any).downcast_mut())
}

impl dyn Page {
    pub(crate) fn is<T: Page>(&self) -> bool {
        (self as &dyn Any).is::<T>()
    }
}

/// What a page is drawn with.
#[derive(Debug)]
pub struct Canvas<'a> {
    /// For the page whose state outlasts it.
    pub app: &'a App,
    pub theme: &'a Theme,
    pub keymap: &'a Keymap,
    pub buffer: &'a mut Buffer,
}

impl<'a> Canvas<'a> {
    pub(crate) fn of(app: &'a App, buffer: &'a mut Buffer) -> Self {
        Self {
            app,
            theme: &app.theme,
            keymap: &app.keymap,
            buffer,
        }
    }

    /// Writes into the first line of an area; what does not fit is cut short.
    pub(crate) fn text(&mut self, area: Rect, text: &str, role: Role) {
        write::text(self.buffer, area, self.theme, text, role);
    }

    /// Draws a prompt, with a remark behind what is typed. Returns the position of the cursor.
    pub(crate) fn prompt(
        self,
        area: Rect,
        label: &str,
        field: &TextField,
        remark: &str,
    ) -> Position {
        write::prompt(self.buffer, area, self.theme, label, field, remark)
    }

    /// The same with pieces in several roles.
    pub(crate) fn line<'b>(
        &mut self,
        area: Rect,
        pieces: impl IntoIterator<Item = (&'b str, Role)>,
    ) {
        write::line(self.buffer, area, self.theme, pieces);
    }
}

/// One place of the screen: what its keys do and what it shows.
pub trait Page: Any {
    /// Handles a message. The page is not on the stack meanwhile; pages that are opened lie above it.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow;

    /// Called when it was closed.
    fn closed(self: Box<Self>, _app: &mut App) {}

    fn placed(&self) -> Placed;

    fn context(&self) -> Context {
        self.placed().0
    }

    fn place(&self) -> Place {
        self.placed().1
    }

    fn wheel(&self) -> Wheel {
        self.placed().2
    }

    /// Prompts and questions stand in the line of notices, over the page below.
    fn has_pane(&self) -> bool {
        !matches!(self.place(), Place::Prompt | Place::Question)
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position>;

    /// Does nothing by default.
    fn draw_over(&self, _theme: &Theme, _buffer: &mut Buffer, _body: Rect) {}

    fn click(&self, _area: Rect, _at: Position) -> Option<Message> {
        None
    }

    /// Returns true if its own update handles Cancel and Quit. Otherwise they close the page.
    fn cancels_itself(&self) -> bool {
        false
    }

    /// Hints leave out keys whose messages it has no use for; pressing one shows why it does nothing.
    fn has_use_for(&self, _message: &Message, _area: Rect) -> bool {
        true
    }

    /// Returns the text of the page for the line of notices. It is shown while there is no notice.
    fn remark(&self, _keymap: &Keymap, _body: Rect) -> Option<(String, Role)> {
        None
    }

    /// Returns an error that a notice must not hide: it is shown after the notice. None by default.
    fn alarm(&self) -> Option<String> {
        None
    }
}
