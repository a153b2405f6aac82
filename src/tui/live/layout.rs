//! Where the taxels of the heat map and the numbers beside it stand.
//!
//! ```text
//! title                                       what is shown
//! taxels               numbers                beside each other, or on a narrow screen one above the other, unless that
//!                                             hides taxels
//! ```
//! A taxel has two columns where all fit so; else half a character, so that two stand above each other; else a window of
//! these follows the contact. Numbers have rulers, as their window rarely shows all.

use ratatui::layout::Rect;

use crate::tui::matrix::layout::{AxisWindow, RULER};
use crate::tui::widget::write::{below, right_of};

/// Columns of the numbers beside the heat map, at least.
const PANEL: u16 = 26;

/// The same on a narrow screen, where they are cut short.
const NARROW_PANEL: u16 = 18;

/// Columns between the heat map and the numbers.
const GAP: u16 = 2;

/// Lines of the numbers below the heat map; at most half of all lines.
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
    /// Columns of the row ruler and lines of the column ruler, before the first taxel; 0 without one.
    pub(super) rulers: (u16, u16),
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
        let rulers = if form == CellForm::Number {
            let across = ruler(u16::from(columns) * wide, area.width, RULER, wide);
            (across, ruler(u16::from(rows), area.height, 1, 1))
        } else {
            (0, 0)
        };
        let (width, lines) = (area.width - rulers.0, area.height - rulers.1);
        let columns = AxisWindow::new(columns, width / wide, near.0);
        // Which two share a character does not change while the window moves.
        let step = if form == CellForm::Half { 2 } else { 1 };
        let rows = AxisWindow::in_steps(rows, lines.saturating_mul(high), near.1, step);
        Self {
            form,
            columns,
            rows,
            rulers,
        }
    }

    /// How many taxels are visible.
    fn visible(&self) -> u16 {
        u16::from(self.columns.count) * u16::from(self.rows.count)
    }

    /// The columns of the screen that the visible taxels have, with their ruler.
    fn width(&self) -> u16 {
        self.rulers.0 + u16::from(self.columns.count) * self.form.size().0
    }
}

/// How much of a side of the screen a ruler takes: nothing where only the ruler would hide a taxel, or all of them.
fn ruler(taxels: u16, side: u16, ruler: u16, taxel: u16) -> u16 {
    let hides = taxels <= side && side < taxels + ruler;
    if hides || side < ruler + taxel {
        0
    } else {
        ruler
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
        let narrow = rest.width < 2 * PANEL;
        let least = if narrow { NARROW_PANEL } else { PANEL };
        let room = Rect {
            width: rest.width.saturating_sub(GAP + least),
            ..rest
        };
        let map_above = Rect {
            height: rest.height - LOW_PANEL.min(rest.height / 2),
            ..rest
        };
        let grid = |area: Rect| HeatGrid::of(area, size, numbers, (0, 0));
        let beside = grid(room);
        if narrow && grid(map_above).visible() >= beside.visible() {
            return Self {
                title,
                map: map_above,
                panel: below(rest, map_above.height),
            };
        }
        let width = beside.width();
        Self {
            title,
            map: Rect { width, ..rest },
            panel: right_of(rest, rest.x + width + GAP),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many taxels of 16 x 16 are visible on a screen of that many columns and rows.
    fn visible(columns: u16, rows: u16, numbers: bool) -> u16 {
        // Menu, notice and hints have a line each.
        let area = Rect::new(0, 1, columns, rows - 3);
        let panes = LivePanes::of(area, (16, 16), numbers);
        assert!(panes.panel.width >= NARROW_PANEL && panes.panel.height > 0);
        HeatGrid::of(panes.map, (16, 16), numbers, (0, 0)).visible()
    }

    #[test]
    fn all_taxels_are_visible_on_small_screens() {
        for (columns, rows) in [(40, 12), (40, 20), (60, 20), (80, 16), (80, 24), (200, 60)] {
            assert_eq!(visible(columns, rows, false), 256, "{columns} x {rows}");
        }
        // Numbers in all rows.
        assert_eq!(visible(80, 24, true), 8 * 16);
        assert_eq!(visible(60, 20, true), 4 * 16);
        // The smallest of all.
        assert!(visible(20, 6, false) >= 32);
    }

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
