//! The areas of the list of shapes and of the preview beside it.
//!
//! The selected row stays as near to the middle of the list as its ends allow.

use ratatui::layout::{Position, Rect};

use crate::tui::shapes::state::ListDialog;
use crate::tui::widget::write::first_of;

/// The number of lines of a list above its first row.
pub const LIST_HEAD: u16 = 2;

/// Returns the pane of the list and, if there is room, that of the preview.
pub fn list(body: Rect) -> (Rect, Option<Rect>) {
    let width = body.width.saturating_sub(36);
    if body.width < 66 {
        return (body, None);
    }
    let left = Rect {
        width: width.min(60),
        ..body
    };
    let right = Rect {
        x: left.right() + 1,
        width: body.right() - left.right() - 1,
        ..body
    };
    (left, Some(right))
}

/// Returns the index of the first visible row of a list.
pub fn list_first(area: Rect, rows: usize, selected: usize) -> usize {
    first_of(area.height.saturating_sub(LIST_HEAD), rows, selected)
}

/// Returns the index of the list's row at a position of the screen.
pub fn list_row(body: Rect, dialog: &ListDialog, at: Position) -> Option<usize> {
    let (area, _) = list(body);
    let line = at.y.checked_sub(area.y + LIST_HEAD)?;
    let rows = dialog.rows().len();
    let index = list_first(area, rows, dialog.selected()) + usize::from(line);
    (area.contains(at) && index < rows).then_some(index)
}
