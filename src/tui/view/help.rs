//! The list of the keys that mean something in a place, as they are now.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::write;
use crate::tui::app::App;
use crate::tui::dialog::Help;
use crate::tui::remap::HelpLine;
use crate::tui::theme::Role;

/// Columns of the keys.
const KEYS: usize = 23;

/// Draws the list as far as there is room.
pub fn draw(app: &App, help: &Help, buffer: &mut Buffer, area: Rect) {
    let theme = app.theme();
    write::clear(buffer, area);
    let room = usize::from(area.height);
    let (lines, top) = help.lines(app.keymap(), room);
    for (index, line) in lines.into_iter().skip(top).take(room).enumerate() {
        let row = write::row(area, index);
        match line {
            HelpLine::Place(context) => {
                write::line(buffer, row, theme, [(context.title(), Role::Title)]);
            }
            HelpLine::Keys(binding) => {
                let keys = format!("  {:KEYS$} ", binding.labels());
                let pieces = [(keys.as_str(), Role::Key), (binding.help, Role::Text)];
                write::line(buffer, row, theme, pieces);
            }
        }
    }
}
