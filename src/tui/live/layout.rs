//! The places of the taxels of the heat map, and of the numbers beside it.
//!
//! ```text
//! title                                       what is shown
//! taxels               numbers                beside each other, or on a narrow screen one above the other, unless
//!                                             that hides taxels
//! ```
//! A taxel is two columns wide, or a multiple of that, if all fit; otherwise it is half a character, so that two
//! stand above each other. If not all fit even then, a window follows the contact until keys move it. Numbers have
//! rulers, as their window rarely shows all.

use ratatui::layout::Rect;

use crate::tui::keys::key::Arrow;
use crate::tui::matrix::layout::{AxisWindow, RULER};
use crate::tui::widget::write::{below, right_of};

const PANEL: u16 = 26;

const NARROW_PANEL: u16 = 18;

/// The number of columns for the numbers that must remain if taxels are enlarged.
const WIDE_PANEL: u16 = 44;

const GAP: u16 = 2;

/// The number of lines for the numbers below the heat map; at most half of all lines.
const LOW_PANEL: u16 = 7;

pub(super) const NUMBER: u16 = 6;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CellForm {
    Wide(u16),
    Half,
    Number,
}

impl CellForm {
    /// Returns the columns and lines of the screen that a taxel takes; one each for two taxels that share a
    /// character.
    fn size(self) -> (u16, u16) {
        match self {
            Self::Wide(times) => (2 * times, times),
            Self::Half => (1, 1),
            Self::Number => (NUMBER, 1),
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct HeatGrid {
    /// The form of all taxels; it is the same within a map.
    pub(super) form: CellForm,
    pub(super) columns: AxisWindow,
    pub(super) rows: AxisWindow,
    /// The columns of the row ruler and the lines of the column ruler, before the first taxel; 0 without a ruler.
    pub(super) rulers: (u16, u16),
}

impl HeatGrid {
    pub(super) fn of(area: Rect, (columns, rows): (u8, u8), numbers: bool, near: (u8, u8)) -> Self {
        let times = (area.width / (2 * u16::from(columns))).min(area.height / u16::from(rows));
        let form = match times {
            _ if numbers => CellForm::Number,
            0 => CellForm::Half,
            times => CellForm::Wide(times),
        };
        let (wide, high) = form.size();
        let rulers = if form == CellForm::Number {
            let across = ruler(u16::from(columns) * wide, area.width, RULER, wide);
            (across, ruler(u16::from(rows), area.height, 1, 1))
        } else {
            (0, 0)
        };
        let (width, lines) = (area.width - rulers.0, area.height - rulers.1);
        let columns = AxisWindow::showing(columns, width / wide, near.0..near.0 + 1, 1);
        // The same two taxels share a character while the window moves.
        let (step, lines) = match form {
            CellForm::Half => (2, lines.saturating_mul(2)),
            _ => (1, lines / high),
        };
        let rows = AxisWindow::showing(rows, lines, near.1..near.1 + 1, step);
        Self {
            form,
            columns,
            rows,
            rulers,
        }
    }

    /// Returns the nearest hidden taxel in a direction from a given one; None if there is none.
    pub(super) fn beyond(&self, towards: Arrow, (column, row): (u8, u8)) -> Option<(u8, u8)> {
        let next = |axis: AxisWindow| {
            let (before, after) = axis.hidden();
            let last = axis.first + axis.count;
            (before.then(|| axis.first - 1), after.then_some(last))
        };
        let (columns, rows) = (next(self.columns), next(self.rows));
        match towards {
            Arrow::Left => Some((columns.0?, row)),
            Arrow::Right => Some((columns.1?, row)),
            Arrow::Up => Some((column, rows.0?)),
            Arrow::Down => Some((column, rows.1?)),
        }
    }

    fn visible(&self) -> u16 {
        u16::from(self.columns.count) * u16::from(self.rows.count)
    }

    fn width(&self) -> u16 {
        self.rulers.0 + u16::from(self.columns.count) * self.form.size().0
    }
}

/// Returns the columns or lines that a ruler takes: 0 if the ruler alone would hide a taxel, or if no taxel would
/// fit.
fn ruler(taxels: u16, side: u16, ruler: u16, taxel: u16) -> u16 {
    let hides = taxels <= side && side < taxels + ruler;
    if hides || side < ruler + taxel {
        0
    } else {
        ruler
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct LivePanes {
    /// The title line: the source and the frame.
    pub(super) title: Rect,
    pub(super) map: Rect,
    /// The numbers; a low screen shows only the first of them.
    pub(super) panel: Rect,
}

impl LivePanes {
    pub(super) fn of(area: Rect, size: Option<(u8, u8)>, numbers: bool) -> Self {
        let title = Rect {
            height: area.height.min(1),
            ..area
        };
        let rest = below(area, 1);
        let Some(size) = size else {
            let map = Rect { width: 0, ..rest };
            return Self {
                title,
                map,
                panel: rest,
            };
        };
        let narrow = rest.width < 2 * PANEL;
        let least = if narrow { NARROW_PANEL } else { PANEL };
        let room = |panel: u16| Rect {
            width: rest.width.saturating_sub(GAP + panel),
            ..rest
        };
        let map_above = Rect {
            height: rest.height - LOW_PANEL.min(rest.height / 2),
            ..rest
        };
        let grid = |area: Rect| HeatGrid::of(area, size, numbers, (0, 0));
        let beside = grid(room(least));
        if narrow && grid(map_above).visible() >= beside.visible() {
            return Self {
                title,
                map: map_above,
                panel: below(rest, map_above.height),
            };
        }
        let large = grid(room(WIDE_PANEL));
        let width = match (large.form, beside.form) {
            (CellForm::Wide(_), _) => large.width(),
            (_, CellForm::Wide(_)) => 2 * u16::from(size.0),
            _ => beside.width(),
        };
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

    fn visible(columns: u16, rows: u16, numbers: bool) -> u16 {
        // Menu, notice and hints have a line each.
        let area = Rect::new(0, 1, columns, rows - 3);
        let panes = LivePanes::of(area, Some((16, 16)), numbers);
        assert!(panes.panel.width >= NARROW_PANEL && panes.panel.height > 0);
        HeatGrid::of(panes.map, (16, 16), numbers, (0, 0)).visible()
    }

    #[test]
    fn all_taxels_are_visible_on_small_screens() {
        for (columns, rows) in [(40, 12), (40, 20), (60, 20), (80, 16), (80, 24), (200, 60)] {
            assert_eq!(visible(columns, rows, false), 256, "{columns} x {rows}");
        }
        // As numbers, all rows are visible.
        assert_eq!(visible(80, 24, true), 8 * 16);
        assert_eq!(visible(60, 20, true), 4 * 16);
        // Taxels are larger if the numbers beside them keep their room.
        let map = |columns, rows: u16| {
            let area = Rect::new(0, 1, columns, rows - 3);
            LivePanes::of(area, Some((16, 16)), false).map.width
        };
        assert_eq!([map(80, 24), map(120, 40), map(200, 60)], [32, 64, 96]);
        // The smallest screen.
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
