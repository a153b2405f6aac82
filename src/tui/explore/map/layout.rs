//! Where the map's cells, its rulers and the pose at its cursor are.
//!
//! A map that is larger than its page scrolls with its cursor. A pose is two columns wide if the whole map fits so.

use ratatui::layout::{Position, Rect};

use crate::pose::Axis;
use crate::tui::explore::results::Results;
use crate::tui::widget::number::narrow;
use crate::tui::widget::write::below;

/// The map of x0 and y0.
#[derive(Clone, Copy, Debug)]
pub struct MapPane {
    /// Angle and zooms.
    pub head: Rect,
    /// x0 above the cells.
    pub ruler: Rect,
    /// The cells; left of them stands y0.
    pub cells: Rect,
    /// Characters of a cell.
    pub cell: u16,
    /// The first x0 and y0, by number.
    pub first: (u64, u64),
    /// How many of them are visible.
    pub count: (u64, u64),
    /// The pose at the cursor, where there is room beside the cells.
    pub side: Option<Rect>,
    /// The same in one line.
    pub detail: Rect,
}

impl MapPane {
    /// The map on its page, the cursor as near to the middle as the ends allow.
    pub fn of(page: Rect, results: &Results) -> Self {
        let grid = &results.sweep().grid;
        let [width, height, ..] = grid.counts().into_array();
        let label = narrow(results.width_of(Axis::Y0) + 1);
        let side = u16::from(grid.sensor().columns()).clamp(22, 32);
        let with_side = page.width >= label + side + 22;
        let room = page.width - if with_side { side + 2 } else { 0 };
        let body = below(page, 2);
        let body = Rect {
            height: body.height.saturating_sub(1),
            ..body
        };
        let across = room.saturating_sub(label);
        let cell = if 2 * width <= u64::from(across) { 2 } else { 1 };
        let seen_x = width.min(u64::from(across / cell));
        let seen_y = height.min(u64::from(body.height));
        let [x0, y0, ..] = results.place().into_array();
        let from = |at: u64, seen: u64, all: u64| at.saturating_sub(seen / 2).min(all - seen);
        let cells = Rect {
            x: page.x + label.min(page.width),
            width: narrow(seen_x) * cell,
            height: narrow(seen_y),
            ..body
        };
        let line = |index: u16| Rect {
            height: u16::from(index < page.height),
            width: room,
            ..below(page, index)
        };
        Self {
            head: line(0),
            ruler: line(1),
            cells,
            cell,
            first: (from(x0, seen_x, width), from(y0, seen_y, height)),
            count: (seen_x, seen_y),
            side: with_side.then_some(Rect {
                x: page.x + room + 2,
                width: side,
                ..page
            }),
            detail: Rect {
                height: u16::from(page.height > 2),
                ..below(page, page.height.saturating_sub(1))
            },
        }
    }

    /// The x0 and y0 at a place of the screen, by number.
    pub fn pose(&self, place: Position) -> Option<(u64, u64)> {
        self.cells.contains(place).then(|| {
            let x = u64::from((place.x - self.cells.x) / self.cell);
            let y = u64::from(place.y - self.cells.y);
            (self.first.0 + x, self.first.1 + y)
        })
    }
}
