//! The list of imprints: columns that there is room for, and thumbnails beside them.

use ratatui::layout::{Position, Rect};

use crate::formats::value::grouped;
use crate::pose::Axis;
use crate::tui::app::layout::below;
use crate::tui::explore::lines::{first, width_of};
use crate::tui::explore::results::Results;
use crate::tui::widget::columns::narrow;

/// Characters of a value of a descriptor.
pub const VALUE: usize = 8;
/// Characters of a share in percent.
pub const SHARE: usize = 6;
/// Characters of the sign of the selected row.
const SIGN: usize = 2;

/// The list of imprints.
#[derive(Clone, Debug)]
pub struct ImprintList {
    /// The headings.
    pub head: Rect,
    /// The rows.
    pub rows: Rect,
    /// All about the selected one.
    pub detail: Rect,
    /// Thumbnails, where there is room beside the rows.
    pub gallery: Option<Rect>,
    /// The row that comes first.
    pub first: usize,
    /// Characters of a number of an imprint.
    pub id: usize,
    /// Characters of a number of poses.
    pub poses: usize,
    /// Characters of the values of the first pose, where there is room for it.
    pub place: Vec<(Axis, usize)>,
}

impl ImprintList {
    /// The list on its page.
    pub fn of(page: Rect, results: &Results) -> Self {
        let result = results.sweep();
        let grid = &result.grid;
        let id = result.atlas.len().to_string().len().max(2);
        let poses = grouped(result.poses).len().max(6);
        let place: Vec<(Axis, usize)> = grid
            .axes()
            .map(|axis| (axis, width_of(grid, axis)))
            .collect();
        let short = SIGN + id + 1 + poses + 1 + SHARE + 1 + 2 + 1 + 2 + 1 + VALUE;
        let full = short + place.iter().map(|(_, width)| width + 1).sum::<usize>();
        let room = usize::from(page.width);
        let thumbnail = usize::from(grid.sensor().columns().min(16)) + 2;
        let (width, beside) = if full + thumbnail <= room {
            (full, true)
        } else if short + thumbnail <= room {
            (short, true)
        } else {
            (if full <= room { full } else { short }, false)
        };
        let table = Rect {
            width: narrow(width).min(page.width),
            ..page
        };
        let x = table.right().saturating_add(2).min(page.right());
        let gallery = Rect {
            x,
            width: page.right() - x,
            height: page.height.saturating_sub(1),
            ..page
        };
        let rows = Rect {
            height: page.height.saturating_sub(2),
            ..below(table, 1)
        };
        Self {
            head: Rect {
                height: page.height.min(1),
                ..table
            },
            first: first(usize::from(rows.height), results.selected()),
            rows,
            detail: Rect {
                height: u16::from(page.height > 1),
                ..below(page, page.height.saturating_sub(1))
            },
            gallery: beside.then_some(gallery),
            id,
            poses,
            place: if width == full { place } else { Vec::new() },
        }
    }

    /// The row at a place of the screen.
    pub fn row(&self, place: Position, results: &Results) -> Option<usize> {
        let row = self.first + usize::from(place.y.checked_sub(self.rows.y)?);
        (self.rows.contains(place) && row < results.row_count()).then_some(row)
    }
}
