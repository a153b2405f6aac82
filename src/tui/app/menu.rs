//! The two lines of keys: the menu in the first line of the screen, and the hints in the last one.
//!
//! ```text
//! n New   l Load   f Figure   p Picture   s Save   d Delete   q Quit   ? Help      on the matrix
//! Enter accept   Esc cancel   ? help                                               in a form or a list
//! Tab page   d D descriptor   x export   e ranges   ? help   Esc close             on all tabs of Explore
//! ```
//! On the matrix the menu has the paper's seven options and Help; on other pages it has the keys that lead on from
//! the page or out of it. The hints have the other keys that mean something now, and those that the menu had no room
//! for. Both are made from the present table of keys, and a click does what the key does.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::tui::app::view::Panes;
use crate::tui::app::{App, Message, status};
use crate::tui::explore::ExploreMessage;
use crate::tui::keys::default_keys::MENU;
use crate::tui::keys::{Binding, Context, Key, Keymap};
use crate::tui::matrix::update::is_usable;
use crate::tui::widget::write::narrow;
use crate::tui::widget::{Role, Theme, write};

#[derive(Clone, Debug)]
pub struct Item<'a> {
    pub area: Rect,
    pub binding: &'a Binding,
    pub name: &'a str,
    pub keys: String,
    role: Role,
}

impl Item<'_> {
    /// None beside the item, and for the four arrows together.
    pub fn click(&self, at: Position) -> Option<Message> {
        if !self.area.contains(at) {
            return None;
        }
        let parts = self.binding.short_parts();
        let mut x = self.area.x;
        for (part, action) in &parts {
            x += narrow(part.chars().count());
            if at.x < x {
                return action.map(|action| action.message.clone());
            }
        }
        match parts.first() {
            Some((_, action)) => action.map(|action| action.message.clone()),
            // An option without a key can still be clicked on.
            None => by_default(self.binding),
        }
    }

    fn draw(&self, theme: &Theme, buffer: &mut Buffer) {
        let keys = (self.keys.as_str(), Role::Key);
        let gap = if self.keys.is_empty() { "" } else { " " };
        let pieces = [keys, (gap, Role::Text), (self.name, self.role)];
        write::line(buffer, self.area, theme, pieces);
    }
}

pub fn draw(theme: &Theme, buffer: &mut Buffer, items: &[Item<'_>]) {
    for item in items {
        item.draw(theme, buffer);
    }
}

pub fn menu(app: &App, area: Rect) -> Vec<Item<'_>> {
    let (context, keymap) = (app.context(), &app.keymap);
    let options = matches!(context, Context::Matrix | Context::Hold | Context::Draw);
    let rows: Vec<(&Binding, &str)> = if options {
        let all = keymap.rows.iter().take(MENU).chain(help(keymap));
        all.map(|row| (row, option(row))).collect()
    } else {
        let own = of_menu(context, keymap).into_iter();
        let own = own.filter(|row| useful(app, row));
        own.map(|row| (row, row.hint)).collect()
    };
    placed(area, 3, Role::Text, &rows)
}

pub fn hints<'a>(app: &'a App, panes: &Panes) -> Vec<Item<'a>> {
    let (context, keymap) = (app.context(), &app.keymap);
    let line = context.outer().filter(|&outer| outer == Context::Line);
    let screen = context.screen().filter(|&screen| screen != context);
    let taken = |key: Key| {
        let mut own = keymap.of(context).flat_map(|row| &row.keys);
        own.any(|(own, _)| *own == key)
    };
    // A key of the page may mean something else on the screen around it.
    let free = |row: &&Binding| {
        let first = row.keys.first();
        first.is_some_and(|(key, _)| row.context == context || !taken(*key))
    };
    let outer = screen.into_iter().chain(line);
    let outer = outer.flat_map(|screen| keymap.of(screen));
    let all = keymap.of(context).chain(outer).filter(free);
    let all = all.filter(|row| useful(app, row));
    let menu = menu(app, panes.menu);
    let rest = all.filter(|row| {
        !row.hint.is_empty() && menu.iter().all(|item| !std::ptr::eq(item.binding, *row))
    });
    // Where the descriptors have no room beside the matrix, their key comes first; elsewhere it does nothing.
    let switches = |row: &Binding| row.does(&Message::SwitchPane);
    let rest = rest.filter(|row| panes.panel.is_none() || !switches(row));
    // There, the key leads back to the matrix.
    let is_back = |row: &Binding| app.shows_panel && switches(row);
    let named = rest.map(|row| (row, if is_back(row) { "matrix" } else { row.hint }));
    let mut rows: Vec<_> = named.collect();
    rows.sort_by_key(|(row, _)| !switches(row));
    placed(panes.hints, 2, Role::Quiet, &rows)
}

/// Returns true if one of the keys of a row does something now: on the matrix if the row belongs to it, otherwise on the
/// top page.
fn useful(app: &App, row: &Binding) -> bool {
    let mut messages = row.keys.iter().map(|(_, action)| &action.message);
    if matches!(row.context, Context::Matrix | Context::Hold | Context::Draw) {
        return messages.any(|message| is_usable(app, message));
    }
    if row.context == Context::Recognise {
        return messages.any(|message| app.recognition.has_use_for(message));
    }
    let Some((page, panes)) = app.top_page().zip(app.panes()) else {
        return true;
    };
    let area = status::page_area(app, &panes, page);
    messages.any(|message| page.has_use_for(message, area))
}

/// For a form, a list, a prompt or a question: the rows that accept, leave or explain it.
fn of_menu(context: Context, keymap: &Keymap) -> Vec<&Binding> {
    let hinted = |row: &&Binding| {
        !row.hint.is_empty() && !row.keys.is_empty() && !row.does(&Message::SwitchPane)
    };
    match context.screen() {
        Some(Context::Matrix) => {
            let own = keymap.of(context).filter(hinted);
            own.chain(help(keymap)).collect()
        }
        Some(screen) => keymap.of(screen).filter(hinted).collect(),
        None => {
            let leading = |row: &&Binding| LEADING.iter().any(|message| row.does(message));
            keymap.of(context).filter(hinted).filter(leading).collect()
        }
    }
}

const LEADING: [Message; 7] = [
    Message::Accept,
    Message::Decline,
    Message::Save,
    Message::Cancel,
    Message::Quit,
    Message::Help,
    Message::Explore(ExploreMessage::Stop),
];

fn help(keymap: &Keymap) -> impl Iterator<Item = &Binding> {
    let all = keymap
        .rows
        .iter()
        .filter(|row| row.context == Context::Matrix);
    // Found by its place in the table, because its keys may have been taken away.
    all.filter(|row| by_default(row) == Some(Message::Help))
}

fn option(row: &Binding) -> &str {
    let end = row.help.find([':', ',']);
    end.map_or(row.help, |end| &row.help[..end])
}

fn placed<'a>(area: Rect, gap: u16, role: Role, rows: &[(&'a Binding, &'a str)]) -> Vec<Item<'a>> {
    let mut x = area.x;
    let mut items = Vec::new();
    for &(binding, name) in rows {
        let parts = binding.short_parts().into_iter();
        let keys: String = parts.map(|(label, _)| label).collect();
        let between = usize::from(!keys.is_empty());
        let width = narrow(keys.chars().count() + between + name.chars().count());
        if area.height == 0 || x.saturating_add(width) > area.right() {
            break;
        }
        items.push(Item {
            area: Rect { x, width, ..area },
            binding,
            name,
            keys,
            role,
        });
        x = x.saturating_add(width + gap);
    }
    items
}

/// Returns the message that the first key of a row has by default, though its keys may have been taken away.
fn by_default(row: &Binding) -> Option<Message> {
    row.actions.first().map(|action| action.message.clone())
}
