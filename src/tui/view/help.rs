//! The list of all keys, from the table of keys.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;

use super::write;
use crate::tui::app::App;
use crate::tui::binding::Context;
use crate::tui::keymap::{KEYMAP, help_lines};
use crate::tui::theme::Role;

/// Columns of the keys.
const KEYS: usize = 23;

/// Draws the list from line `top` on, or its end where that is nearer.
pub fn draw(app: &App, top: usize, buffer: &mut Buffer, area: Rect) {
    let theme = app.theme();
    write::clear(buffer, area);
    let top = top.min(help_lines().saturating_sub(usize::from(area.height)));
    let lines = Context::ALL.iter().flat_map(|&context| {
        let bindings = KEYMAP
            .iter()
            .filter(move |binding| binding.context == context);
        std::iter::once(None)
            .chain(bindings.map(Some))
            .map(move |binding| (context, binding))
    });
    for (index, (context, binding)) in lines.enumerate().skip(top).take(usize::from(area.height)) {
        let row = write::row(area, index - top);
        if let Some(binding) = binding {
            let keys = format!("  {:KEYS$} ", binding.labels());
            write::line(
                buffer,
                row,
                theme,
                [(keys.as_str(), Role::Key), (binding.help, Role::Text)],
            );
        } else {
            write::line(buffer, row, theme, [(context.title(), Role::Title)]);
        }
    }
}
