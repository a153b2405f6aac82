//! What lies over the matrix: a form, the list of shapes, a name, a question, the list of keys, what a sweep found. They
//! are a stack; the top one gets the keys.

use super::binding::Context;
use super::command_dialog::CommandDialog;
use super::explore::export::ExportDialog;
use super::explore::ranges::RangesForm;
use super::explore::results::Results;
use super::explore::running::Running;
use super::exploring::ExplorePage;
use super::form_dialog::FormDialog;
use super::list::ListDialog;
use super::message::Message;
use super::name_dialog::NameDialog;
use super::remap::{HelpLine, Keymap, help};

/// One of them.
#[derive(Clone, Debug)]
pub enum Dialog {
    /// The form of a figure, a picture or the sensor.
    Form(Box<FormDialog>),
    /// The shapes of the library.
    List(ListDialog),
    /// A name to store under.
    Name(NameDialog),
    /// A command.
    Command(CommandDialog),
    /// A question.
    Question(Question),
    /// The list of keys.
    Help(Help),
    /// The ranges of a sweep.
    Ranges(Box<RangesForm>),
    /// Work under way.
    Running(Running),
    /// What a sweep found.
    Results(Box<Results>),
    /// The name of a file to write that to.
    Export(ExportDialog),
}

/// A question, and what happens at each answer; leaving it open is none.
#[derive(Clone, Debug)]
pub struct Question {
    /// What is asked.
    pub text: String,
    /// What yes does.
    pub yes: Message,
    /// What no does, where that is more than nothing.
    pub no: Option<Message>,
}

impl Question {
    /// A question where only yes does something.
    pub fn new(text: impl Into<String>, yes: Message) -> Self {
        Self {
            text: text.into(),
            yes,
            no: None,
        }
    }
}

/// The list of the keys that mean something in a place.
#[derive(Clone, Debug)]
pub struct Help {
    context: Context,
    top: usize,
}

impl Help {
    /// The list of a place, from its first line on.
    pub fn new(context: Context) -> Self {
        Self { context, top: 0 }
    }

    /// Its lines, and which of them stands first where there is room for so many.
    pub fn lines<'a>(&self, keymap: &'a Keymap, room: usize) -> (Vec<HelpLine<'a>>, usize) {
        let lines = help(self.context, keymap);
        let last_top = lines.len().saturating_sub(room);
        (lines, self.top.min(last_top))
    }

    /// Goes on by lines, where there is room for so many.
    pub fn scroll(&mut self, lines: i16, keymap: &Keymap, room: usize) {
        let (_, top) = self.lines(keymap, room);
        self.top = top.saturating_add_signed(isize::from(lines));
        (_, self.top) = self.lines(keymap, room);
    }
}

impl Dialog {
    /// Where keys are looked up.
    pub fn context(&self) -> Context {
        match self {
            Self::Form(_) => Context::Form,
            Self::List(_) => Context::List,
            Self::Name(_) => Context::Name,
            Self::Command(_) => Context::Command,
            Self::Question(_) => Context::Question,
            Self::Help(_) => Context::Help,
            Self::Ranges(_) => Context::Ranges,
            Self::Running(_) => Context::Running,
            Self::Results(results) => match results.page() {
                ExplorePage::Imprints => Context::Imprints,
                ExplorePage::Statistics => Context::Statistics,
                ExplorePage::Histogram => Context::Histogram,
                ExplorePage::Map => Context::Map,
            },
            Self::Export(_) => Context::Export,
        }
    }

    /// Whether it is drawn in a pane; the others have the line of notices, over whatever lies below.
    pub fn has_pane(&self) -> bool {
        !matches!(
            self,
            Self::Name(_) | Self::Command(_) | Self::Question(_) | Self::Export(_)
        )
    }
}
