//! The table of pages that can lie over the matrix: forms, the list of shapes, prompts, questions, help, results of a
//! sweep. They are a stack; the top one receives the keys.
//!
//! A page is a variant of [`Dialog`], a row in [`Dialog::page`], and a row in [`crate::tui::app::update`].

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot};
use crate::tui::compare::page::Comparison;
use crate::tui::explore::export::ExportDialog;
use crate::tui::explore::filter::FilterDialog;
use crate::tui::explore::ranges::state::RangesForm;
use crate::tui::explore::results::Results;
use crate::tui::explore::running::Running;
use crate::tui::form::state::FormDialog;
use crate::tui::help::page::Help;
use crate::tui::history::page::HistoryDialog;
use crate::tui::keys::action;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::live::state::Live;
use crate::tui::prompt::state::{CommandDialog, NameDialog};
use crate::tui::recognise::confusion::Confusion;
use crate::tui::recognise::state::Recognition;
use crate::tui::search::page::SearchDialog;
use crate::tui::shapes::state::ListDialog;
use crate::tui::widget::theme::Theme;

/// A page that lies over the matrix, with its state.
#[derive(Clone, Debug)]
pub enum Dialog {
    /// The form of a figure, a picture or the sensor.
    Form(Box<FormDialog>),
    /// The shapes of the library.
    List(ListDialog),
    /// The prompt for the name to save under.
    Name(NameDialog),
    /// The `:` prompt.
    Command(CommandDialog),
    /// A question.
    Question(Question),
    /// The list of keys.
    Help(Help),
    /// The prompt that searches in help.
    Search(SearchDialog),
    /// The comparison of two imprints.
    Compare(Comparison),
    /// The steps of the history.
    History(HistoryDialog),
    /// The ranges of a sweep.
    Ranges(Box<RangesForm>),
    /// A sweep or an export in progress.
    Running(Running),
    /// The results of a sweep.
    Results(Box<Results>),
    /// The prompt for the name of the file to export to.
    Export(ExportDialog),
    /// The prompt for the filter of the list of imprints.
    Filter(FilterDialog),
    /// Recognition of the shape on the matrix. Its state outlasts the page, so the program keeps it.
    Recognition,
    /// The confusion matrix of a model.
    Confusion(Box<Confusion>),
    /// The frames of a sensor.
    Live(Box<Live>),
}

impl Dialog {
    /// Returns what the screen knows of the page, given the state of recognition.
    pub fn page<'a>(&'a self, recognition: &'a Recognition) -> &'a dyn Page {
        match self {
            Self::Form(page) => &**page,
            Self::List(page) => page,
            Self::Name(page) => page,
            Self::Command(page) => page,
            Self::Question(page) => page,
            Self::Help(page) => page,
            Self::Search(page) => page,
            Self::History(page) => page,
            Self::Compare(page) => page,
            Self::Ranges(page) => &**page,
            Self::Running(page) => page,
            Self::Results(page) => &**page,
            Self::Export(page) => page,
            Self::Filter(page) => page,
            Self::Recognition => recognition,
            Self::Confusion(page) => &**page,
            Self::Live(page) => &**page,
        }
    }
}

/// Finds the topmost page of a kind among the pages of the program, for reading or for changing it:
/// `topmost!(&app.dialogs, Live)`, `topmost!(&mut app.dialogs, Live)`. None if there is no such page.
macro_rules! topmost {
    ($dialogs:expr, $kind:ident) => {
        $dialogs.into_iter().rev().find_map(|dialog| match dialog {
            $crate::tui::app::dialog::Dialog::$kind(page) => Some(page),
            _ => None,
        })
    };
}

pub(in crate::tui) use topmost;

/// A question, and what each answer does. Leaving it without an answer does nothing.
#[derive(Clone, Debug)]
pub struct Question {
    /// The sentences before the question; empty if it says all.
    pub about: String,
    /// The question.
    pub text: String,
    /// The message that yes sends.
    pub yes: Message,
    /// The message that no sends, None for nothing.
    pub no: Option<Message>,
    /// The prompt whose request led to the question; it opens again without the answer yes.
    pub prompt: Option<Box<Dialog>>,
    /// Whether the document on the matrix may be saved first.
    pub saves_first: bool,
    /// The meanings of yes and no, in a few words; None if the question says them.
    pub meanings: Option<[&'static str; 2]>,
    /// The meaning of leaving it without an answer, in a few words; None if that does nothing.
    pub left: Option<&'static str>,
}

impl Question {
    /// Returns a question where only yes does something, with the sentences before it.
    pub fn new(about: impl Into<String>, text: impl Into<String>, yes: Message) -> Self {
        Self {
            about: about.into(),
            text: text.into(),
            yes,
            no: None,
            prompt: None,
            saves_first: false,
            meanings: None,
            left: None,
        }
    }

    /// Creates the question whether to replace the file or the shape of this name; yes sends the message `yes`.
    pub fn replaces(name: &str, yes: Message) -> Self {
        Self::new(format!("{name:?} already exists."), "Replace it?", yes)
    }

    /// Returns the keys of the answers and their meanings: `(y: lose it, n: stay, s: save first)`.
    pub fn answers(&self, keymap: &Keymap) -> String {
        let key = |answer| keymap.label(Context::Question, answer);
        let (yes, no) = (key(&action::ACCEPT), key(&action::DECLINE));
        let mut answers = match self.meanings {
            Some([of_yes, of_no]) => format!("{yes}: {of_yes}, {no}: {of_no}"),
            None => format!("{yes}/{no}"),
        };
        let save = self.saves_first.then_some("save first");
        for (answer, meaning) in [(&action::SAVE, save), (&action::CANCEL, self.left)] {
            let key = key(answer);
            if let Some(meaning) = meaning.filter(|_| !key.is_empty()) {
                answers += &format!(", {key}: {meaning}");
            }
        }
        format!("({answers})")
    }
}

impl Page for Question {
    fn context(&self) -> Context {
        Context::Question
    }

    fn slot(&self) -> Slot {
        Slot::Question
    }

    /// Draws nothing: a question stands in the line of notices, see [`crate::tui::app::notice`].
    fn draw(&self, _: &Theme, _: &Keymap, _: &mut Buffer, _: Rect) -> Option<Position> {
        None
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        self.saves_first || *message != Message::Save
    }
}
