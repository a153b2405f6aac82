//! A question in the line of notices, with what its answers do.

use ratatui::layout::{Position, Rect};

use crate::tui::app::{
    Act, App, Canvas, Flow, Message, Page, Place, Placed, Wheel, from_prompt, refuse,
};
use crate::tui::keys::{Context, Keymap, action};
use crate::tui::matrix;

/// Leaving it without an answer does nothing.
pub(crate) struct Question {
    pub(crate) about: String,
    pub(crate) text: String,
    pub(crate) yes: Option<Act>,
    pub(crate) no: Option<Act>,
    /// The prompt that led to it: without a yes, it opens again.
    pub(crate) prompt: Option<Box<dyn Page>>,
    pub(crate) saves_first: bool,
    pub(crate) meanings: Option<[&'static str; 2]>,
    pub(crate) left: Option<&'static str>,
}

impl Question {
    pub(crate) fn new(
        about: impl Into<String>,
        text: impl Into<String>,
        yes: impl FnOnce(&mut App) + 'static,
    ) -> Self {
        Self {
            about: about.into(),
            text: text.into(),
            yes: Some(Box::new(yes)),
            no: None,
            prompt: None,
            saves_first: false,
            meanings: None,
            left: None,
        }
    }

    pub(crate) fn replaces(name: String, yes: impl FnOnce(&mut App, String) + 'static) -> Self {
        let about = format!("{name:?} already exists.");
        Self::new(about, "Replace it?", |app| yes(app, name))
    }

    pub(crate) fn answers(&self, keymap: &Keymap) -> String {
        let key = |answer| keymap.label(Context::Question, answer);
        let (yes, no) = (key(&action::ACCEPT), key(&action::DECLINE));
        let mut answers = match self.meanings {
            Some([of_yes, of_no]) => format!("{yes}: {of_yes}, {no}: {of_no}"),
            None => format!("{yes}/{no}"),
        };
        let save = self.saves_first.then_some("save first");
        for (answer, meaning) in [(&action::SAVE, save), (&action::CANCEL, self.left)] {
            if let Some(meaning) = meaning {
                answers += &format!(", {}: {meaning}", key(answer));
            }
        }
        format!("({answers})")
    }
}

impl Page for Question {
    fn placed(&self) -> Placed {
        (Context::Question, Place::Question, Wheel::Idle)
    }

    fn draw(&self, _: Canvas<'_>, _: Rect) -> Option<Position> {
        None
    }

    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        match message {
            Message::Accept => match (self.yes.take(), self.prompt.take()) {
                (Some(yes), Some(prompt)) => from_prompt(app, prompt, yes),
                (Some(yes), None) => yes(app),
                _ => {}
            },
            Message::Decline => {
                app.pages.extend(self.prompt.take());
                if let Some(no) = self.no.take() {
                    no(app);
                }
            }
            Message::Save if self.saves_first => {
                matrix::update::save(app, true);
            }
            Message::Save => {
                let text = match self.prompt {
                    Some(_) => "this question has to be answered first",
                    None => "there is nothing to save first",
                };
                refuse(app, text);
                return Flow::Stay;
            }
            _ => return Flow::Stay,
        }
        Flow::Close
    }

    fn closed(self: Box<Self>, app: &mut App) {
        app.pages.extend(self.prompt);
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        self.saves_first || *message != Message::Save
    }
}
