//! What the mouse points at.

use ratatui::layout::{Position, Rect};

use crate::tui::app::dialog::Dialog;
use crate::tui::app::layout::{FormRows, LIST_HEAD, Panes, TaxelGrid, list, list_first, menu};
use crate::tui::app::message::Message;
use crate::tui::app::state::{App, NarrowPage};
use crate::tui::explore::point;
use crate::tui::explore::ranges::layout::RangeRows;

/// Something on the screen.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// An option of the menu.
    Option(Message),
    /// A taxel; and whether the whole matrix is visible, so that the cursor may go there without scrolling it.
    Taxel(u8, u8, bool),
    /// The heading of the descriptors, or a descriptor.
    Panel,
    /// The kind in a form.
    Kind,
    /// A field of a form.
    Field(usize),
    /// A row of the list.
    Row(usize),
    /// Something that means what a key would.
    Means(Message),
}

/// What is at a place of the screen; nothing on a screen that is too small.
pub fn at(app: &App, column: u16, row: u16) -> Option<Target> {
    let screen = Rect::new(0, 0, app.screen.0, app.screen.1);
    let imprint = app.reading().imprint;
    let panes = Panes::of(screen, &imprint)?;
    let place = Position::new(column, row);
    let inside = |area: Rect| area.contains(place);
    if inside(panes.menu) {
        let mut items = menu(panes.menu, app.keymap()).into_iter();
        let option = items.find(|item| inside(item.area));
        return option.map(|item| Target::Option(item.message.clone()));
    }
    match app.dialogs.last() {
        Some(Dialog::Form(dialog)) if inside(panes.form) => {
            let rows = FormRows::of(panes.form, dialog);
            let line = row - panes.form.y;
            if rows.kind == Some(line) {
                return Some(Target::Kind);
            }
            let mut fields = rows.fields(dialog.form().fields().len());
            fields
                .find(|(_, first)| (*first..first + rows.spacing).contains(&line))
                .map(|(index, _)| Target::Field(index))
        }
        Some(Dialog::List(dialog)) => {
            let (area, _) = list(panes.body);
            let line = row
                .checked_sub(area.y + LIST_HEAD)
                .filter(|_| inside(area))?;
            let index =
                list_first(area, dialog.rows().len(), dialog.selected()) + usize::from(line);
            (index < dialog.rows().len()).then_some(Target::Row(index))
        }
        Some(Dialog::Results(results)) => point::at(&panes, results, place).map(Target::Means),
        Some(Dialog::Ranges(form)) if inside(panes.form) => {
            let rows = RangeRows::of(panes.form, form);
            rows.row(row - panes.form.y).map(Target::Field)
        }
        None if panes.panel.is_some_and(inside) => Some(Target::Panel),
        // The descriptors have the matrix's place.
        None if panes.panel.is_none() && app.page == NarrowPage::Panel => {
            inside(panes.body).then_some(Target::Panel)
        }
        None if inside(panes.matrix) => {
            let grid = TaxelGrid::of(panes.matrix, &imprint, app.cursor());
            grid.taxel(column, row)
                .map(|(column, row)| Target::Taxel(column, row, grid.whole))
        }
        _ => None,
    }
}
