//! Where the taxels of the heat map and the numbers beside it stand.
//!
//! ```text
//! title                                       what is shown
//! taxels               numbers                beside each other, or on a narrow screen one above the other
//! ```
//! A taxel has two columns where all fit so; else half a character, so that two stand above each other; else a window of
//! these follows the contact.

use ratatui::layout::Rect;

use crate::tui::matrix::layout::AxisWindow;
use crate::tui::widget::write::{below, right_of};

/// Columns of the numbers beside the heat map, at least.
const PANEL: u16 = 26;

/// Lines of the numbers below the heat map.
const LOW_PANEL: u16 = 7;

/// Columns of a taxel that is shown as a number, with its mark and a space.
pub(super) const NUMBER: u16 = 6;

/// How a taxel is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellForm {
    /// Two columns of one row.
    Wide,
    /// Two taxels, one above the other, in one character.
    Half,
    /// A number.
    Number,
}

impl CellForm {
    /// Columns of the screen that a taxel has, and rows of taxels in a row of the screen.
    fn size(self) -> (u16, u16) {
        match self {
            Self::Wide => (2, 1),
            Self::Half => (1, 2),
            Self::Number => (NUMBER, 1),
        }
    }
}

/// The visible taxels.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeatGrid {
    /// The form of all taxels: it does not differ within a map.
    pub(super) form: CellForm,
    pub(super) columns: AxisWindow,
    pub(super) rows: AxisWindow,
}

impl HeatGrid {
    /// The taxels of a matrix in an area, as near to a taxel as the ends allow where not all are visible.
    pub(super) fn of(area: Rect, (columns, rows): (u8, u8), numbers: bool, near: (u8, u8)) -> Self {
        let fits = |form: CellForm| {
            let (wide, high) = form.size();
            u16::from(columns) * wide <= area.width && u16::from(rows).div_ceil(high) <= area.height
        };
        let form = if numbers {
            CellForm::Number
        } else if fits(CellForm::Wide) {
            CellForm::Wide
        } else {
            CellForm::Half
        };
        let (wide, high) = form.size();
        let columns = AxisWindow::new(columns, area.width / wide, near.0);
        // Which two share a character does not change while the window moves.
        let step = if form == CellForm::Half { 2 } else { 1 };
        let rows = AxisWindow::in_steps(rows, area.height.saturating_mul(high), near.1, step);
        Self {
            form,
            columns,
            rows,
        }
    }

    /// The columns of the screen that the visible taxels have.
    fn width(&self) -> u16 {
        u16::from(self.columns.count) * self.form.size().0
    }
}

/// The panes of the page.
#[derive(Clone, Copy, Debug)]
pub(super) struct LivePanes {
    /// One line: the source and the frame.
    pub(super) title: Rect,
    /// The taxels.
    pub(super) map: Rect,
    /// The numbers; on a low screen only those that there are lines for.
    pub(super) panel: Rect,
}

impl LivePanes {
    /// The panes for a matrix of this many columns and rows.
    pub(super) fn of(area: Rect, size: (u8, u8), numbers: bool) -> Self {
        let title = Rect {
            height: area.height.min(1),
            ..area
        };
        let rest = below(area, 1);
        if rest.width < 2 * PANEL {
            let height = rest.height.saturating_sub(LOW_PANEL);
            return Self {
                title,
                map: Rect { height, ..rest },
                panel: below(rest, height),
            };
        }
        let room = Rect {
            width: rest.width - 1 - PANEL,
            ..rest
        };
        let width = HeatGrid::of(room, size, numbers, (0, 0)).width();
        Self {
            title,
            map: Rect { width, ..rest },
            panel: right_of(rest, rest.x + width + 2),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_row_of_an_odd_number_is_visible() {
        let area = Rect::new(0, 0, 40, 22);
        let visible = |near: u8| {
            let rows = HeatGrid::of(area, (40, 63), false, (0, near)).rows;
            (rows.first, rows.first + rows.count - 1)
        };
        assert_eq!(visible(62), (20, 62));
        assert!((0..63).all(|near| {
            let (first, last) = visible(near);
            first % 2 == 0 && (first..=last).contains(&near)
        }));
    }
}
