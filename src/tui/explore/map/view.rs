//! The map page: which imprint each x0 and y0 leaves, at one angle and zoom.
//!
//! ```text
//! angle 0° 1/36  zoom x 1.00 1/3           imprint 0       what is fixed, and how many others there are
//! y0   x0 5.00                5.90         366 poses       rulers
//! 5.00 aaaaaaaabbcccccc                                    a letter for each imprint
//! 5.05 aaaaaaaaddcccccc                    ··▄▄··          the imprint at the cursor
//! imprint 0 at x0 5.00, y0 5.00; 366 poses                 and its pose
//! ```
//! Neighbouring imprints have different letters, so that borders are visible without colours; the same letter elsewhere
//! may be another imprint. A pose that the stopped sweep did not reach is blank.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::formats::value::{counted, grouped};
use crate::parameter::Parameter;
use crate::pose::{Axis, PoseGrid};
use crate::touch::Plane;
use crate::tui::explore::map::layout::MapPane;
use crate::tui::explore::map::letters::{letter, letters};
use crate::tui::explore::results::Results;
use crate::tui::widget::number::narrow;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::{thumbnail, write};

/// What letters mean.
const LEGEND: &str = "  letter: an imprint";

/// Draws the page. Returns where the cursor is.
pub(in crate::tui) fn draw(
    results: &Results,
    theme: &Theme,
    buffer: &mut Buffer,
    page: Rect,
) -> Option<Position> {
    let pane = MapPane::of(page, results);
    let grid = &results.sweep().grid;
    let head = heading(results);
    let end = write::line(buffer, pane.head, theme, [(head.as_str(), Role::Title)]);
    // Only where there is room for all of it.
    let legend = write::right_of(pane.head, end);
    if write::width(LEGEND) <= usize::from(legend.width) {
        write::line(buffer, legend, theme, [(LEGEND, Role::Quiet)]);
    }
    let cursor = draw_cells(theme, results, &pane, buffer);
    draw_rulers(theme, grid, &pane, buffer, page);
    draw_pose(theme, results, &pane, buffer);
    cursor
}

/// The angle and the zooms, and how many others there are.
fn heading(results: &Results) -> String {
    let grid = &results.sweep().grid;
    let (place, counts) = (results.place(), grid.counts());
    let parts = grid
        .axes()
        .filter(|axis| !matches!(axis, Axis::X0 | Axis::Y0))
        .map(|axis| {
            let parameter = axis.parameter();
            let value = parameter.format(grid.ranges()[axis].value(place[axis]));
            let unit = if axis == Axis::Angle { "°" } else { "" };
            let which = if counts[axis] > 1 {
                format!(" {}/{}", grouped(place[axis] + 1), grouped(counts[axis]))
            } else {
                String::new()
            };
            format!("{} {value}{unit}{which}", parameter.row().short)
        });
    parts.collect::<Vec<_>>().join("  ")
}

/// Draws the letters of the visible poses. Returns where the cursor is, None if there is no room for any cell.
fn draw_cells(
    theme: &Theme,
    results: &Results,
    pane: &MapPane,
    buffer: &mut Buffer,
) -> Option<Position> {
    let ((x, y), (width, height)) = (pane.first, pane.count);
    let ids = results
        .sweep()
        .ids(results.place(), x..x + width, y..y + height);
    let columns = usize::try_from(width).unwrap_or(1).max(1);
    let letters = letters(&ids, columns);
    let [at_x, at_y, ..] = results.place().into_array();
    let here =
        pane.count != (0, 0) && (x..x + width).contains(&at_x) && (y..y + height).contains(&at_y);
    let step = |from: u64, to: u64| narrow(to - from);
    let cursor = here.then(|| {
        Position::new(
            pane.cells.x + step(x, at_x) * pane.cell,
            pane.cells.y + step(y, at_y),
        )
    });
    for (place, number) in pane
        .cells
        .rows()
        .flat_map(Rect::columns)
        .filter(|place| (place.x - pane.cells.x).is_multiple_of(pane.cell))
        .zip(letters)
    {
        let (text, style) = match number {
            Some(number) => (letter(number), theme.tint(number.into())),
            None => (' ', theme.style(Role::Quiet)),
        };
        for column in 0..pane.cell {
            let position = Position::new(place.x + column, place.y);
            let style = if cursor == Some(Position::new(place.x, place.y)) {
                theme.style(Role::Cursor)
            } else {
                style
            };
            if let Some(cell) = buffer.cell_mut(position) {
                cell.set_char(text).set_style(style);
            }
        }
    }
    cursor
}

/// y0 left of the cells; above them the first x0 and the last.
fn draw_rulers(theme: &Theme, grid: &PoseGrid, pane: &MapPane, buffer: &mut Buffer, page: Rect) {
    let ranges = grid.ranges();
    let label = usize::from(pane.cells.x.saturating_sub(page.x)).saturating_sub(1);
    for (line, index) in (0..pane.cells.height).zip(pane.first.1..) {
        let row = Rect {
            x: page.x,
            y: pane.cells.y + line,
            width: pane.cells.x.saturating_sub(page.x),
            height: 1,
        };
        let value = Parameter::Y0.format(ranges[Axis::Y0].value(index));
        let text = format!("{value:>label$}");
        write::line(buffer, row, theme, [(text.as_str(), Role::Quiet)]);
    }
    let value = |index: u64| Parameter::X0.format(ranges[Axis::X0].value(index));
    let (first, last) = (
        value(pane.first.0),
        value(pane.first.0 + pane.count.0.max(1) - 1),
    );
    let ruler = write::right_of(pane.ruler, pane.cells.x);
    let width = usize::from(pane.cells.width);
    let first = format!("x0 {first}");
    let text = if first.len() + last.len() < width {
        let rest = width - first.len();
        format!("{first}{last:>rest$}")
    } else {
        first
    };
    write::line(buffer, pane.ruler, theme, [("y0", Role::Quiet)]);
    write::line(buffer, ruler, theme, [(text.as_str(), Role::Quiet)]);
}

/// The pose at the cursor: its imprint, which one it is, where it is.
fn draw_pose(theme: &Theme, results: &Results, pane: &MapPane, buffer: &mut Buffer) {
    let result = results.sweep();
    let grid = &result.grid;
    let pose = grid.pose(grid.number(results.place()));
    let imprint = Plane::new(*grid.sensor()).touch(&grid.placed(pose));
    let entry = results.id(&imprint).and_then(|id| result.atlas.entry(id));
    let (which, poses) = match entry {
        Some(entry) => (
            format!("imprint {}", entry.id),
            counted(entry.count, "pose"),
        ),
        None => ("not swept".to_owned(), String::new()),
    };
    let detail = format!("{which} at {}; {poses}", results.pose_text(&pose));
    let detail = detail.trim_end_matches("; ");
    write::line(buffer, pane.detail, theme, [(detail, Role::Text)]);
    if let Some(side) = pane.side {
        write::line(buffer, side, theme, [(which.as_str(), Role::Title)]);
        let row = write::row(side, 1);
        write::line(buffer, row, theme, [(poses.as_str(), Role::Text)]);
        let below = write::below(side, 3);
        let below = Rect {
            height: below.height.saturating_sub(1),
            ..below
        };
        thumbnail::draw(theme, &imprint, buffer, below);
    }
}
