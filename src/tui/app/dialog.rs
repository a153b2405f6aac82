//! The table of pages that can lie over the matrix: forms, the list of shapes, prompts, questions, help, results of a
//! sweep. They are a stack; the top one receives the keys.
//!
//! A page is a variant of [`Dialog`], a row in [`Dialog::page`], and a row in [`crate::tui::app::update`].

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot};
use crate::tui::app::state::App;
use crate::tui::compare::Comparison;
use crate::tui::explain::Explain;
use crate::tui::explore::prompts::{ExportDialog, FilterDialog};
use crate::tui::explore::ranges::RangesForm;
use crate::tui::explore::results::Results;
use crate::tui::explore::work::Running;
use crate::tui::form::state::FormDialog;
use crate::tui::help::{Help, SearchDialog};
use crate::tui::history::HistoryDialog;
use crate::tui::keys::action;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::live::state::Live;
use crate::tui::prompt::state::{CommandDialog, NameDialog};
use crate::tui::recognise::confusion::Confusion;
use crate::tui::recognise::state::Recognition;
use crate::tui::shapes::state::ListDialog;
use crate::tui::widget::theme::Theme;

#[expect(
    missing_debug_implementations,
    reason = "answers to questions are closures"
)]
pub enum Dialog {
    Form(Box<FormDialog>),
    List(ListDialog),
    Name(NameDialog),
    Command(CommandDialog),
    Question(Question),
    Help(Help),
    Explain(Explain),
    Search(SearchDialog),
    Compare(Comparison),
    History(HistoryDialog),
    Ranges(Box<RangesForm>),
    Running(Running),
    Results(Box<Results>),
    Export(ExportDialog),
    Filter(FilterDialog),
    /// Recognition of the shape on the matrix. Its state outlasts the page, so the program keeps it.
    Recognition,
    Confusion(Box<Confusion>),
    Live(Box<Live>),
}

impl Dialog {
    pub fn page<'a>(&'a self, recognition: &'a Recognition) -> &'a dyn Page {
        match self {
            Self::Form(page) => &**page,
            Self::List(page) => page,
            Self::Name(page) => page,
            Self::Command(page) => page,
            Self::Question(page) => page,
            Self::Help(page) => page,
            Self::Explain(page) => page,
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

/// None if there is no such page.
macro_rules! topmost {
    ($dialogs:expr, $kind:ident) => {
        $dialogs.into_iter().rev().find_map(|dialog| match dialog {
            $crate::tui::app::dialog::Dialog::$kind(page) => Some(page),
            _ => None,
        })
    };
}

pub(in crate::tui) use topmost;

pub type Act = Box<dyn FnOnce(&mut App)>;

/// Leaving it without an answer does nothing.
#[expect(missing_debug_implementations, reason = "its answers are closures")]
pub struct Question {
    pub about: String,
    pub text: String,
    pub yes: Act,
    pub no: Option<Act>,
    pub prompt: Option<Box<Dialog>>,
    pub saves_first: bool,
    pub meanings: Option<[&'static str; 2]>,
    pub left: Option<&'static str>,
}

impl Question {
    pub fn new(
        about: impl Into<String>,
        text: impl Into<String>,
        yes: impl FnOnce(&mut App) + 'static,
    ) -> Self {
        Self {
            about: about.into(),
            text: text.into(),
            yes: Box::new(yes),
            no: None,
            prompt: None,
            saves_first: false,
            meanings: None,
            left: None,
        }
    }

    pub fn replaces(name: &str, yes: impl FnOnce(&mut App) + 'static) -> Self {
        Self::new(format!("{name:?} already exists."), "Replace it?", yes)
    }

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

    fn draw(&self, _: &Theme, _: &Keymap, _: &mut Buffer, _: Rect) -> Option<Position> {
        None
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        self.saves_first || *message != Message::Save
    }
}
