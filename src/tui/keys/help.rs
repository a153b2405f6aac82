//! The list of the keys that mean something in a place, as they are now.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use crate::tui::app::dialog::{Help, help_indent};
use crate::tui::app::state::App;
use crate::tui::keys::keymap::HelpLine;
use crate::tui::widget::theme::Role;
use crate::tui::widget::write;

/// Draws the list as far as there is room.
pub fn draw(app: &App, help: &Help, buffer: &mut Buffer, area: Rect) {
    let theme = app.theme();
    write::clear(buffer, area);
    let (lines, top) = help.lines(app.keymap(), area.as_size().into());
    let indent = help_indent(area.width.into());
    for (index, line) in lines.into_iter().skip(top).enumerate() {
        let row = write::row(area, index);
        match line {
            HelpLine::Place(context) => {
                write::line(buffer, row, theme, [(context.title(), Role::Title)]);
            }
            HelpLine::Keys(keys, text) => {
                let keys = format!("{:indent$}", format!("  {keys}"));
                let pieces = [(keys.as_str(), Role::Key), (text, Role::Text)];
                write::line(buffer, row, theme, pieces);
            }
            HelpLine::More(text) => {
                let text = format!("{:indent$}{text}", "");
                write::line(buffer, row, theme, [(text.as_str(), Role::Text)]);
            }
        }
    }
}
