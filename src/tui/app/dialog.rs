//! What lies over the matrix: a form, the list of shapes, a name, a question, the list of keys, what a sweep found. They
//! are a stack; the top one gets the keys.

use crate::tui::app::message::Message;
use crate::tui::explore::export::ExportDialog;
use crate::tui::explore::message::ExplorePage;
use crate::tui::explore::ranges::state::RangesForm;
use crate::tui::explore::results::Results;
use crate::tui::explore::running::state::Running;
use crate::tui::form::state::FormDialog;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::{HelpLine, Keymap, help};
use crate::tui::prompt::name::NameDialog;
use crate::tui::prompt::state::CommandDialog;
use crate::tui::shapes::state::ListDialog;
use crate::tui::widget::columns::broken;

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

    /// Its lines where there is room for so many columns and lines, and which of them stands first.
    pub fn lines(&self, keymap: &Keymap, room: (u16, u16)) -> (Vec<HelpLine>, usize) {
        let (columns, rows) = (usize::from(room.0), usize::from(room.1));
        let lines: Vec<HelpLine> = help(self.context, keymap)
            .into_iter()
            .flat_map(|line| broken_line(line, columns))
            .collect();
        let last_top = lines.len().saturating_sub(rows);
        let top = self.top.min(last_top);
        (lines, top)
    }

    /// Goes on by lines, where there is room for so many columns and lines.
    pub fn scroll(&mut self, lines: i16, keymap: &Keymap, room: (u16, u16)) {
        let (_, top) = self.lines(keymap, room);
        self.top = top.saturating_add_signed(isize::from(lines));
        (_, self.top) = self.lines(keymap, room);
    }
}

/// Where what keys do begins in a line of so many columns: behind the keys, or under them where little room is left
/// there.
pub fn help_indent(columns: usize) -> usize {
    const BEHIND: usize = 26;
    if columns >= BEHIND + 20 { BEHIND } else { 4 }
}

/// A line of help in as many as it needs.
fn broken_line(line: HelpLine, columns: usize) -> Vec<HelpLine> {
    let HelpLine::Keys(keys, text) = line else {
        return vec![line];
    };
    let indent = help_indent(columns);
    let mut pieces = broken(text, columns.saturating_sub(indent)).into_iter();
    let beside = (keys.len() + 2 < indent).then(|| pieces.next()).flatten();
    let first = HelpLine::Keys(keys, beside.unwrap_or_default());
    std::iter::once(first)
        .chain(pieces.map(HelpLine::More))
        .collect()
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
