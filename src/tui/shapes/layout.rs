//! The areas of the list of shapes and of the preview beside it.
//!
//! The selected row stays as near to the middle of the list as its ends allow.

use ratatui::layout::Rect;

use crate::tui::shapes::state::ListDialog;
use crate::tui::widget::rows::ListRows;
use crate::tui::widget::write;

pub const LIST_HEAD: u16 = 2;

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

pub fn list_rows(pane: Rect, dialog: &ListDialog) -> ListRows {
    let area = write::below(pane, LIST_HEAD);
    ListRows::around(area, dialog.rows().len(), dialog.selected())
}
