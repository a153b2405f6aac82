//! The menu in the first line: the paper's seven options, and Help.
//!
//! ```text
//! n New   l Load   f Figure   p Picture   s Save   d Delete   q Quit   ? Help      from 70 columns on
//! New  Load  Figure  Picture  Save  Delete  Quit  ? Help                           the key is the bold letter
//! ```
//! Names and keys are those of the table of keys as they are now. Options that do not fit are left out.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::app::message::Message;
use crate::tui::keys::binding::{Binding, Context};
use crate::tui::keys::default_keys::{DEFAULT_KEYS, MENU};
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::number::narrow;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// An option of the menu, and where it stands.
#[derive(Clone, Copy, Debug)]
pub struct MenuItem<'a> {
    /// Its place.
    pub area: Rect,
    /// Its key now, if it has one.
    pub binding: &'a Binding,
    /// What it does.
    pub message: &'static Message,
    /// Its name, which begins with its key but for Help.
    pub name: &'static str,
    /// Whether there is room for the key beside the name.
    pub with_key: bool,
}

/// The options of the menu; those that do not fit are left out.
pub fn items(area: Rect, keymap: &Keymap) -> Vec<MenuItem<'_>> {
    let with_key = area.width >= 70;
    let rows = || DEFAULT_KEYS.iter().zip(keymap.rows());
    let help = rows().filter(|(row, _)| row.context == Context::Matrix && row.does(&Message::Help));
    let mut x = area.x;
    let mut items = Vec::new();
    for (row, binding) in rows().take(MENU).chain(help) {
        let Some(message) = row.keys.first().and_then(|(_, action)| action.message()) else {
            continue;
        };
        let end = binding.help.find([':', ',']);
        let name = end.map_or(binding.help, |end| &binding.help[..end]);
        let label = binding.short_labels();
        // An option without a key can still be clicked on.
        let key = if label.is_empty() || !with_key && name.to_lowercase().starts_with(&label) {
            0
        } else {
            label.chars().count() + 1
        };
        let width = narrow(key + name.len());
        if x + width > area.right() {
            break;
        }
        items.push(MenuItem {
            area: Rect { x, width, ..area },
            binding,
            message,
            name,
            with_key: key > 0,
        });
        x += width + if with_key { 3 } else { 2 };
    }
    items
}

/// Draws the options: key and name, from the table of keys.
pub fn draw(theme: &Theme, keymap: &Keymap, buffer: &mut Buffer, area: Rect) {
    for item in items(area, keymap) {
        let label = item.binding.short_labels();
        let pieces = if item.with_key {
            [
                (label.as_str(), Role::Key),
                (" ", Role::Text),
                (item.name, Role::Text),
            ]
        } else if label.is_empty() {
            [(item.name, Role::Text), ("", Role::Text), ("", Role::Text)]
        } else {
            // The key is the first letter.
            let (first, rest) = item.name.split_at(1);
            [(first, Role::Key), (rest, Role::Text), ("", Role::Text)]
        };
        write::line(buffer, item.area, theme, pieces);
    }
}
