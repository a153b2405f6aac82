//! The lines of a form in its pane.
//!
//! If there is enough room, the kind and each field have two lines, the second one for errors; otherwise one. The
//! field with the focus is always visible: in a low pane, fields above it scroll out.

use ratatui::layout::Rect;

use crate::tui::form::state::FormDialog;
use crate::tui::widget::number::narrow;

/// The positions of a form's lines.
#[derive(Clone, Copy, Debug)]
pub struct FormRows {
    /// The line of the kind; None if the form has no kind.
    pub kind: Option<u16>,
    /// The number of lines above the fields.
    head: u16,
    /// The number of lines per field: 2 if there is room for an error under it, otherwise 1.
    pub spacing: u16,
    /// The index of the first visible field.
    first: usize,
    /// The number of fields that fit.
    visible: usize,
}

impl FormRows {
    /// Computes the lines of a form in its pane, so that the field with the focus is visible.
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

    /// Returns the index of each visible field, with its line from the top of the pane.
    pub fn fields(&self, count: usize) -> impl Iterator<Item = (usize, u16)> {
        let rows = *self;
        (rows.first..count.min(rows.first + rows.visible))
            .map(move |index| (index, rows.head + narrow(index - rows.first) * rows.spacing))
    }
}
