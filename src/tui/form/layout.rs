//! The lines of a form in its pane.
//!
//! With enough room each field has two lines, the second for errors, and so has the kind; otherwise one. The field that has the focus is
//! always visible: fields above it scroll out of a low pane.

use ratatui::layout::Rect;

use crate::tui::form::state::FormDialog;
use crate::tui::widget::number::narrow;

/// Where the lines of a form are.
#[derive(Clone, Copy, Debug)]
pub struct FormRows {
    /// The line of the kind, where there is one.
    pub kind: Option<u16>,
    /// Lines above the fields.
    head: u16,
    /// Lines a field has: two where there is room for an error under it.
    pub spacing: u16,
    /// The index of the first visible field.
    first: usize,
    /// How many fields there is room for.
    visible: usize,
}

impl FormRows {
    /// The lines of a form in its pane; the field that has the focus is visible.
    pub fn of(area: Rect, dialog: &FormDialog) -> Self {
        let fields = dialog.form().fields().len();
        let kinds = u16::from(dialog.kind().is_some());
        let spacing = if area.height > 2 * (kinds + narrow(fields)) {
            2
        } else {
            1
        };
        let head = 1 + kinds * spacing;
        let visible = usize::from(area.height.saturating_sub(head) / spacing);
        let first = dialog
            .form()
            .focus()
            .map_or(0, |focus| (focus + 1).saturating_sub(visible));
        Self {
            kind: dialog.kind().map(|_| 1),
            head,
            spacing,
            first,
            visible,
        }
    }

    /// The visible fields, by number, each with its line from the top of the pane.
    pub fn fields(&self, count: usize) -> impl Iterator<Item = (usize, u16)> {
        let rows = *self;
        (rows.first..count.min(rows.first + rows.visible))
            .map(move |index| (index, rows.head + narrow(index - rows.first) * rows.spacing))
    }
}
