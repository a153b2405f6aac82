//! The map tab: which imprint each x0 and y0 leaves at one angle.
//!
//! ```text
//! layout    cells, rulers, the pose at the cursor
//! ```

pub mod layout;

use std::sync::Arc;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use taxel_core::index::index;
use taxel_core::parameter::Parameter;
use taxel_core::pose::{Axis, PoseGrid};
use taxel_core::touch::Plane;
use taxel_files::formats::PoseMap;
use taxel_files::formats::value::{counted, grouped};

use crate::tui::app::message::{Endpoint, Message};
use crate::tui::app::page::Wheel;
use crate::tui::explore::map::layout::{LETTERS, MapPane, VisiblePoses, letter, signs};
use crate::tui::explore::message::ExploreMessage;
use crate::tui::explore::results::Results;
use crate::tui::explore::view::{NOTHING_TO_DRAW, ResultsTab};
use crate::tui::grid::draw_thumbnail;
use crate::tui::keys::keymap::Context;
use crate::tui::widget::plot::draw_no_room;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

pub static TAB: ResultsTab = ResultsTab {
    title: "map",
    context: Context::Map,
    filtered: false,
    drawing: Some(drawing),
    table: None,
    wheel: Wheel::Rows,
    draw,
    click,
    update,
};

fn click(results: &Results, area: Rect, at: Position) -> Option<Message> {
    let (x0, y0) = MapPane::of(area, results).pose(at)?;
    Some(Message::Explore(ExploreMessage::Point(x0, y0)))
}

/// Zooms the map.
fn update(results: &mut Results, message: &Message, area: Rect) {
    let pane = MapPane::of(area, results);
    let stride = i64::try_from(pane.stride).unwrap_or(i64::MAX);
    match *message {
        Message::Cursor(arrow) => {
            let (dx, dy) = arrow.step();
            results.move_along(Axis::X0, i64::from(dx) * stride);
            results.move_along(Axis::Y0, i64::from(dy) * stride);
        }
        Message::Zoom(by) => results.zoom_map(by, pane.closest),
        Message::Scroll(lines) => results.move_along(Axis::Y0, i64::from(lines) * stride),
        Message::ScrollTo(Endpoint::First) => results.move_along(Axis::X0, i64::MIN),
        Message::ScrollTo(Endpoint::Last) => results.move_along(Axis::X0, i64::MAX),
        _ => {}
    }
}

const TINTS: u8 = 6;
const SHADES: u8 = 5;
const COVERAGES: [f64; 5] = [0.0, 0.1, 0.3, 0.7, 1.0];

/// The maximum number of cells along a side of a drawing: more would not be distinguishable.
const DRAWN: u64 = 400;

fn meaning(theme: &Theme, pane: &MapPane) -> Vec<String> {
    let sign = match (pane.is_picture(), has_colours(theme)) {
        (false, _) => "letter",
        (true, true) => "colour",
        (true, false) => "shade",
    };
    let full = format!("  each {sign} an imprint");
    if pane.stride == 1 {
        return vec![full];
    }
    let stride = format!("{0} × {0}", pane.stride);
    vec![
        format!("{full}; 1 pose in {stride}"),
        format!("{full}; 1 in {stride}"),
        format!("  1 pose in {stride}"),
    ]
}

pub(in crate::tui) fn draw(
    results: &Results,
    theme: &Theme,
    buffer: &mut Buffer,
    area: Rect,
) -> Option<Position> {
    let pane = MapPane::of(area, results);
    let grid = &results.sweep().grid;
    let head = heading(results);
    let end = write::text(buffer, pane.head, theme, &head, Role::Title);
    let legend = write::right_of(pane.head, end);
    let fits = |text: &&String| write::width(text) <= usize::from(legend.width);
    if let Some(text) = meaning(theme, &pane).iter().find(fits) {
        write::text(buffer, legend, theme, text, Role::Quiet);
    }
    if pane.cells.is_empty() {
        draw_no_room(theme, buffer, area);
        draw_pose(theme, results, &pane, buffer);
        return None;
    }
    let cursor = draw_cells(theme, results, &pane, buffer);
    draw_rulers(theme, grid, &pane, buffer, area);
    draw_pose(theme, results, &pane, buffer);
    cursor
}

pub(in crate::tui) fn drawing(results: &Results) -> Result<String, String> {
    let grid = &results.sweep().grid;
    let [width, height, ..] = grid.counts().into_array();
    let stride = width.max(height).div_ceil(DRAWN).max(1);
    let (across, down) = (width.div_ceil(stride), height.div_ceil(stride));
    let ids = sampled(results, (0, 0), (across, down), stride);
    let ends = |axis: Axis, count: u64| {
        let range = grid.ranges()[axis];
        (range.value(0), range.value((count - 1) * stride))
    };
    let (x0, y0) = (ends(Axis::X0, across), ends(Axis::Y0, down));
    let mut map = PoseMap::new(x0, y0, index(across), &ids).ok_or(NOTHING_TO_DRAW)?;
    map.title = format!("{}; {}", results.summary(false), heading(results));
    Ok(map.svg())
}

fn heading(results: &Results) -> String {
    let grid = &results.sweep().grid;
    let (place, counts) = (results.pose_index, grid.counts());
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

fn ids(results: &Results, pane: &MapPane) -> Arc<[Option<u32>]> {
    let (x, y) = pane.first;
    let poses = VisiblePoses {
        first: results.pose_index.with(Axis::X0, x).with(Axis::Y0, y),
        count: pane.count,
        stride: pane.stride,
    };
    let find = || sampled(results, pane.first, pane.count, pane.stride);
    results.visible_imprints.of(poses, find)
}

fn sampled(
    results: &Results,
    (x, y): (u64, u64),
    (width, height): (u64, u64),
    stride: u64,
) -> Vec<Option<u32>> {
    let place = results.pose_index;
    if stride == 1 {
        return results.sweep().ids(place, x..x + width, y..y + height);
    }
    let end = x + width.saturating_sub(1) * stride + 1;
    let rows = (0..height).map(|row| y + row * stride);
    let ids = rows.flat_map(|row| {
        let ids = results.sweep().ids(place, x..end, row..row + 1);
        ids.into_iter().step_by(index(stride))
    });
    ids.collect()
}

fn draw_cells(
    theme: &Theme,
    results: &Results,
    pane: &MapPane,
    buffer: &mut Buffer,
) -> Option<Position> {
    let ids = ids(results, pane);
    let columns = usize::try_from(pane.count.0).unwrap_or(1).max(1);
    let count = if pane.is_picture() {
        signs_of_pictures(theme)
    } else {
        LETTERS
    };
    let signs = signs(&ids, columns, count);
    let lines = usize::from(pane.lines);
    for (index, line) in signs.chunks(columns * lines).enumerate() {
        let row = write::row(pane.cells, index);
        for (column, place) in row.columns().enumerate() {
            let column = column / usize::from(pane.cell);
            let upper = line.get(column).copied().flatten();
            let (sign, style) = if pane.is_picture() {
                let lower = line.get(columns + column).copied().flatten();
                halves(theme, upper, lower)
            } else {
                let sign = upper.map_or(' ', letter);
                let tint = upper.map(|number| theme.tint(number.into()));
                (sign, tint.unwrap_or(theme.style(Role::Quiet)))
            };
            if let Some(cell) = buffer.cell_mut(place.as_position()) {
                cell.set_char(sign).set_style(style);
            }
        }
    }
    let [x0, y0, ..] = results.pose_index.into_array();
    let (cursor, _) = pane.position((x0, y0))?;
    for column in 0..pane.cell {
        if let Some(cell) = buffer.cell_mut(Position::new(cursor.x + column, cursor.y)) {
            // A reversed block would look like its neighbours.
            if pane.is_picture() {
                cell.reset();
                cell.set_char(cursor_sign(theme));
            }
            cell.set_style(theme.style(Role::Cursor));
        }
    }
    Some(cursor)
}

fn cursor_sign(theme: &Theme) -> char {
    if theme.ascii { 'X' } else { '+' }
}

fn signs_of_pictures(theme: &Theme) -> u8 {
    if has_colours(theme) { TINTS } else { SHADES }
}

fn has_colours(theme: &Theme) -> bool {
    !theme.ascii && theme.tint(0).fg.is_some()
}

fn halves(theme: &Theme, upper: Option<u8>, lower: Option<u8>) -> (char, Style) {
    let tint = |sign: u8| theme.tint(sign.into());
    if !has_colours(theme) {
        let [shade, _] = upper.map_or([' '; 2], |sign| {
            theme.shade(COVERAGES[usize::from(sign % SHADES)])
        });
        return (shade, upper.map_or(Style::new(), tint));
    }
    match (upper, lower) {
        (None, None) => (' ', Style::new()),
        (Some(upper), None) => ('▀', tint(upper)),
        (None, Some(lower)) => ('▄', tint(lower)),
        (Some(upper), Some(lower)) if upper == lower => ('█', tint(upper)),
        (Some(upper), Some(lower)) => {
            let behind = tint(lower).fg;
            (
                '▀',
                behind.map_or(tint(upper), |color| tint(upper).bg(color)),
            )
        }
    }
}

fn draw_rulers(theme: &Theme, grid: &PoseGrid, pane: &MapPane, buffer: &mut Buffer, area: Rect) {
    let ranges = grid.ranges();
    let label = usize::from(pane.cells.x.saturating_sub(area.x)).saturating_sub(1);
    let step = pane.stride * u64::from(pane.lines);
    for line in 0..pane.cells.height {
        let index = pane.first.1 + u64::from(line) * step;
        let row = Rect {
            x: area.x,
            y: pane.cells.y + line,
            width: pane.cells.x.saturating_sub(area.x),
            height: 1,
        };
        let value = Parameter::Y0.format(ranges[Axis::Y0].value(index));
        let text = format!("{value:>label$}");
        write::text(buffer, row, theme, &text, Role::Quiet);
    }
    let value = |index: u64| Parameter::X0.format(ranges[Axis::X0].value(index));
    let (first, last) = (
        value(pane.first.0),
        value(pane.first.0 + (pane.count.0.max(1) - 1) * pane.stride),
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
    write::text(buffer, pane.ruler, theme, "y0", Role::Quiet);
    write::text(buffer, ruler, theme, &text, Role::Quiet);
}

fn draw_pose(theme: &Theme, results: &Results, pane: &MapPane, buffer: &mut Buffer) {
    let result = results.sweep();
    let grid = &result.grid;
    let number = grid.number(results.pose_index);
    let pose = grid.pose(number);
    let imprint = Plane::new(*grid.sensor()).touch(&grid.placed(number));
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
    write::text(buffer, pane.detail, theme, detail, Role::Text);
    if let Some(side) = pane.side {
        write::text(buffer, side, theme, &which, Role::Title);
        let row = write::row(side, 1);
        write::text(buffer, row, theme, &poses, Role::Text);
        let below = write::below(side, 3);
        let below = Rect {
            height: below.height.saturating_sub(1),
            ..below
        };
        draw_thumbnail(theme, &imprint, buffer, below);
    }
}
