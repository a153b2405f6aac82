//! The state of the prompts: the name to save under, and a `:` command with the earlier commands.
//!
//! The earlier commands are those of the running program. The arrows step through them; after the last one, the line
//! that was being typed comes back.

use std::borrow::Cow;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use taxel_files::ReadError;
use taxel_files::formats::Name;
use taxel_files::formats::name::LONGEST;

use crate::tui::app::message::Message;
use crate::tui::app::page::{Flow, LinePrompt};
use crate::tui::app::state::App;
use crate::tui::keys::keymap::Context;
use crate::tui::prompt::commands::{Offer, complete, offers};
use crate::tui::prompt::update::{in_command, in_name};
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};

const LONGEST_COMMAND: usize = 200;

/// The largest number of characters in the field for a name. It is more than a name may have, so that one sees the
/// message about a long name.
const LONGEST_NAME: usize = LONGEST + 8;

#[derive(Clone, Debug)]
pub struct NameDialog {
    pub field: TextField,
    /// Whether the program ends once the shape is saved.
    pub(crate) quits: bool,
}

impl NameDialog {
    pub fn new(name: &str) -> Self {
        Self {
            field: TextField::new(name, LONGEST_NAME),
            quits: false,
        }
    }

    pub fn proposing(name: &str) -> Self {
        let mut dialog = Self::new(name);
        dialog.field.enter();
        dialog
    }

    pub fn name(&self) -> Result<Name, ReadError> {
        Name::new(self.field.text())
    }
}

#[derive(Clone, Debug)]
pub struct CommandDialog {
    /// The page that the prompt lies over.
    page: Context,
    pub field: TextField,
    pub candidates: Vec<String>,
    asked: Option<String>,
    given: Vec<String>,
    shown: ShownLine,
}

/// A line that is edited or completed counts as typed.
#[derive(Clone, Debug)]
enum ShownLine {
    Typed,
    Earlier { index: usize, typed: String },
    Offered { index: usize, typed: String },
}

impl CommandDialog {
    pub fn new(page: Context, given: &[String]) -> Self {
        Self {
            page,
            given: given.to_vec(),
            shown: ShownLine::Typed,
            field: TextField::new("", LONGEST_COMMAND),
            candidates: Vec::new(),
            asked: None,
        }
    }

    pub fn offers(&self) -> (Vec<Offer>, Option<usize>) {
        let (picked, typed) = match &self.shown {
            ShownLine::Offered { index, typed } => (Some(*index), typed.as_str()),
            ShownLine::Typed | ShownLine::Earlier { .. } => (None, self.field.text()),
        };
        (offers(typed, &self.given, self.page), picked)
    }

    pub fn pick(&mut self, down: bool) -> bool {
        let (offers, picked) = self.offers();
        let typed = match &self.shown {
            ShownLine::Offered { typed, .. } => typed.clone(),
            ShownLine::Typed | ShownLine::Earlier { .. } => self.field.text().to_owned(),
        };
        // The usage of a command whose arguments are being typed comes last, and would replace them.
        let begun = typed.trim_start();
        let lines: Vec<String> = (offers.into_iter().map(|offer| offer.line))
            .filter(|line| line.starts_with(begun) || !begun.contains(' '))
            .collect();
        let next = match (picked, down) {
            (None, false) => return false,
            (None, true) => Some(0),
            (Some(now), true) => Some(now + 1),
            (Some(now), false) => now.checked_sub(1),
        };
        self.candidates.clear();
        match next {
            None => {
                self.field.set(typed);
                self.shown = ShownLine::Typed;
            }
            Some(next) => {
                let index = next.min(lines.len().saturating_sub(1));
                if let Some(line) = lines.get(index) {
                    self.field.set(line.clone());
                    self.shown = ShownLine::Offered { index, typed };
                }
            }
        }
        true
    }

    pub fn set_given(&mut self, given: &[String]) {
        given.clone_into(&mut self.given);
    }

    pub fn edit(&mut self, message: &Message) {
        self.candidates.clear();
        if self.field.take(message) {
            self.shown = ShownLine::Typed;
        }
    }

    pub fn complete(&mut self, names: &[String]) {
        self.shown = ShownLine::Typed;
        let (line, candidates) = complete(self.field.text(), names, self.page);
        self.field.set(line);
        self.candidates = candidates;
        if self.candidates.len() == 1 {
            self.candidates.clear();
        }
    }

    pub fn ask(&mut self) {
        self.asked = Some(self.field.text().to_owned());
    }

    /// Completes the last word with the names that were asked for, unless something else was typed meanwhile.
    pub fn complete_asked(&mut self, names: &[String]) {
        if self.asked.take().as_deref() == Some(self.field.text()) {
            self.complete(names);
        }
    }

    /// Does nothing at the first one.
    pub fn earlier(&mut self) {
        let (index, typed) = match &self.shown {
            ShownLine::Earlier { index, typed } => (index + 1, typed.clone()),
            ShownLine::Typed | ShownLine::Offered { .. } => (0, self.field.text().to_owned()),
        };
        if let Some(line) = self.given.iter().rev().nth(index) {
            self.candidates.clear();
            self.field.set(line.clone());
            self.shown = ShownLine::Earlier { index, typed };
        }
    }

    pub fn later(&mut self) -> bool {
        let ShownLine::Earlier { index, typed } = &self.shown else {
            return false;
        };
        let (typed, next) = (typed.clone(), index.checked_sub(1));
        let line = next.and_then(|index| self.given.iter().rev().nth(index));
        self.candidates.clear();
        self.field.set(line.unwrap_or(&typed).clone());
        self.shown = match next {
            Some(index) => ShownLine::Earlier { index, typed },
            None => ShownLine::Typed,
        };
        true
    }
}

const MOST_OFFERS: u16 = 9;

const MOST_INDENT: usize = 40;

impl LinePrompt for NameDialog {
    const CONTEXT: Context = Context::Name;

    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        in_name(self, app, message)
    }

    fn label(&self) -> &'static str {
        "Save as: "
    }

    fn field(&self) -> &TextField {
        &self.field
    }

    fn behind(&self, _columns: u16) -> Cow<'_, str> {
        "".into()
    }

    fn wrong(&self) -> Option<String> {
        let error = self.name().err()?;
        (!self.field.text().is_empty()).then(|| error.to_string())
    }
}

impl LinePrompt for CommandDialog {
    const CONTEXT: Context = Context::Command;

    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        in_command(self, app, message)
    }

    fn label(&self) -> &'static str {
        ":"
    }

    fn field(&self) -> &TextField {
        &self.field
    }

    fn behind(&self, columns: u16) -> Cow<'_, str> {
        let used = 1 + write::width(self.field.text());
        let room = usize::from(columns).saturating_sub(used);
        let words: Vec<&str> = self.candidates.iter().map(|path| last_part(path)).collect();
        as_many_as_fit(&words, room).into()
    }

    fn draw_offers(&self, theme: &Theme, buffer: &mut Buffer, body: Rect) {
        let (offers, picked) = self.offers();
        let room = body.height.min(MOST_OFFERS);
        let height = room.min(narrow(offers.len()));
        let area = Rect {
            y: body.bottom() - height,
            height,
            ..body
        };
        write::clear(buffer, area);
        let visible = offers.len().min(usize::from(height));
        let first = write::first_of(height, offers.len(), picked.unwrap_or_default());
        let widest = offers.iter().map(|offer| write::width(&offer.line)).max();
        let indent = widest.map_or(0, |widest| widest.min(MOST_INDENT));
        for (index, offer) in offers.iter().enumerate().skip(first).take(visible) {
            let row = write::row(area, index - first);
            let here = picked == Some(index);
            let sign = if here { "> " } else { "  " };
            let role = if here { Role::Focus } else { Role::Key };
            let line = format!("{:indent$}", offer.line);
            let help = offer.help.as_deref().unwrap_or("earlier");
            let pieces = [
                (sign, Role::Text),
                (line.as_str(), role),
                ("  ", Role::Text),
                (help, Role::Quiet),
            ];
            write::line(buffer, row, theme, pieces);
        }
    }
}

/// Returns any other word as it is.
fn last_part(path: &str) -> &str {
    let inner = path.strip_suffix('/').unwrap_or(path);
    let start = inner.rfind('/').map_or(0, |slash| slash + 1);
    &path[start..]
}

/// Returns as many words as fit, after a gap, and the number of the others. Two spaces separate words, because a name
/// may contain one.
fn as_many_as_fit(words: &[&str], room: usize) -> String {
    let mut text = String::new();
    for (index, word) in words.iter().enumerate() {
        let gap = if index == 0 { "   " } else { "  " };
        let left = words.len() - index;
        // The last word needs no room behind it for the number of the others.
        let behind = match left {
            1 => String::new(),
            _ => format!("  … {} more", left - 1),
        };
        let used = text.chars().count() + gap.len() + word.chars().count();
        if used + behind.chars().count() > room {
            return text + &format!("{gap}… {left} more");
        }
        text += gap;
        text += word;
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_offer_never_replaces_typed_arguments() {
        let given = ["figure ellipse", "figure octagon --side 3"].map(str::to_owned);
        let after = |typed: &str, keys: usize| {
            let mut dialog = CommandDialog::new(Context::Matrix, &given);
            dialog.field.set(typed.to_owned());
            for _ in 0..keys {
                dialog.pick(true);
            }
            dialog.field.text().to_owned()
        };
        assert_eq!(after("fig", 1), "figure octagon --side 3");
        assert_eq!(after("fig", 3), "figure");
        assert_eq!(after("figure ell", 2), "figure ellipse");
        assert_eq!(after(" fig", 1), after("fig", 1));
        let typed = "figure ellipse --radius-x 3";
        assert_eq!(after(typed, 1), typed);
    }

    #[test]
    fn an_earlier_line_that_is_completed_counts_as_typed() {
        let mut dialog = CommandDialog::new(Context::Matrix, &["load wash".to_owned()]);
        dialog.earlier();
        dialog.complete(&["washer".to_owned()]);
        assert_eq!(dialog.field.text(), "load washer");
        assert!(!dialog.later(), "it is no earlier line");
        dialog.earlier();
        assert_eq!(dialog.field.text(), "load wash");
        assert!(dialog.later());
        assert_eq!(dialog.field.text(), "load washer");
    }
}
