//! What lies over the matrix: a form, the list of shapes, a name, a question, the list of keys. They are a stack; the
//! top one gets the keys.

use super::binding::Context;
use super::command_dialog::CommandDialog;
use super::form_dialog::FormDialog;
use super::list::ListDialog;
use super::message::Message;
use super::name_dialog::NameDialog;

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
    /// The list of keys, from a line on.
    Help(usize),
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
        }
    }
}
