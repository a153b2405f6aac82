//! The prompts in the line of notices.
//!
//! ```text
//! Save as: my shape█                                  the name to save under; a broken rule stands above
//! :figure hex█   hexagon  heptagon … 2 more           a command, and what the last word could become
//! ```
//! Candidates that do not fit are counted.

use std::borrow::Cow;

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::formats::NameError;
use crate::tui::app::line_prompt::LinePrompt;
use crate::tui::keys::binding::Context;
use crate::tui::prompt::state::{CommandDialog, NameDialog};
use crate::tui::widget::number::narrow;
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

const MOST_OFFERS: u16 = 9;

const MOST_INDENT: usize = 40;

impl LinePrompt for NameDialog {
    const CONTEXT: Context = Context::Name;

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
        let error = self.name().err();
        let error = error.filter(|error| *error != NameError::Empty)?;
        Some(error.to_string())
    }
}

impl LinePrompt for CommandDialog {
    const CONTEXT: Context = Context::Command;

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
    fn a_path_is_shown_by_its_last_part() {
        for (path, shown) in [
            ("examples/cluster/", "cluster/"),
            ("examples/classifiers.py", "classifiers.py"),
            ("a b/c d", "c d"),
            ("/dev/", "dev/"),
            ("/", "/"),
            ("--side", "--side"),
        ] {
            assert_eq!(last_part(path), shown);
        }
    }

    #[test]
    fn the_number_of_other_candidates_is_never_cut() {
        let words = ["one", "three", "eleven", "two", "seventeen"];
        let least = as_many_as_fit(&words, 0).chars().count();
        for room in least..60 {
            let text = as_many_as_fit(&words, room);
            assert!(text.chars().count() <= room, "{room}: {text}");
        }
        assert_eq!(as_many_as_fit(&words, 24), "   one  three  … 3 more");
    }
}
