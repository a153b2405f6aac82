//! The map tab: which imprint each x0 and y0 leaves, at one angle and zoom.
//!
//! If letters for all poses do not fit, the map begins as a picture of its whole range, in which each half of a
//! character is a pose: every n-th one along both axes. Zooming in halves n, down to every pose, and then changes to
//! letters. A map that is larger than its tab scrolls with its cursor. A letter is two columns wide if the whole map
//! fits that way.

use std::cell::RefCell;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use ratatui::layout::{Position, Rect};
use ratatui::style::Style;
use taxel_core::index::index;
use taxel_core::pose::{Axis, PoseIndex};
use taxel_core::touch::Plane;
use taxel_files::formats::value::{counted, grouped};

use crate::tui::app::{App, Canvas, Endpoint, Message, Wheel, refuse};
use crate::tui::explore::ExploreMessage;
use crate::tui::explore::results::{Results, Tab};
use crate::tui::grid::draw_thumbnail;
use crate::tui::keys::{Context, action};
use crate::tui::widget::write::{self, below, narrow};
use crate::tui::widget::{Role, Theme};

pub(super) static TAB: Tab = Tab {
    title: "map",
    context: Context::Map,
    wheel: Wheel::Rows,
    draw,
    click: |results, area, at| {
        let (x0, y0) = Pane::of(area, results).pose(at)?;
        Some(Message::Explore(ExploreMessage::Point(x0, y0)))
    },
    on,
};

const LETTERS: u8 = 62;
const TINTS: u8 = 6;
const SHADE_COUNT: u8 = 5;
/// Coverages with different shades: what a picture has instead of colours.
const SHADES: [f64; SHADE_COUNT as usize] = [0.0, 0.1, 0.3, 0.7, 1.0];

#[derive(Default)]
pub(super) struct MapState {
    zoom: usize,
    /// The imprints that were drawn last, and the poses that leave them: finding them takes a sweep.
    drawn: RefCell<Option<(Visible, Vec<Option<u32>>)>>,
}

/// Poses of a map: every `stride`-th one of both axes from the first on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Visible {
    first: PoseIndex,
    count: (u64, u64),
    stride: u64,
}

impl Visible {
    fn find(&self, results: &Results) -> Vec<Option<u32>> {
        let ([x, y, ..], (width, height)) = (self.first.into_array(), self.count);
        let end = x + width.saturating_sub(1) * self.stride + 1;
        let rows = (0..height).map(|row| y + row * self.stride);
        let ids = |row| results.sweep().ids(self.first, x..end, row..row + 1);
        if self.stride == 1 {
            return results.sweep().ids(self.first, x..x + width, y..y + height);
        }
        rows.flat_map(|row| ids(row).into_iter().step_by(index(self.stride)))
            .collect()
    }
}

struct Pane {
    cells: Rect,
    /// The columns of a cell, and the poses in a line, one above the other: two in a picture.
    cell: u16,
    lines: u16,
    /// The closest zoom; the others are pictures.
    closest: usize,
    shown: Visible,
    /// Beside the map: the imprint at its cursor.
    side: Option<Rect>,
}

impl Pane {
    fn of(area: Rect, results: &Results) -> Self {
        let grid = &results.sweep().grid;
        let [width, height, ..] = grid.counts().into_array();
        let label = narrow(results.width_of(Axis::Y0) + 1).min(area.width);
        let side = u16::from(grid.sensor().columns()).clamp(22, 32);
        let side = (area.width >= label + side + 22).then_some(side);
        let room = area.width - label - side.map_or(0, |side| side + 2);
        let body = below(area, 2);
        let height_of_body = body.height.saturating_sub(1);
        let strides = strides((width, height), (room, height_of_body));
        let closest = strides.len();
        let (stride, lines) = match strides.get(results.map.zoom) {
            Some(stride) => (*stride, 2),
            None => (1, 1),
        };
        let is_double = lines == 1 && 2 * width <= u64::from(room);
        let cell = 1 + u16::from(is_double);
        let [x0, y0, ..] = results.place.into_array();
        let (x, columns) = seen(x0, width, stride, u64::from(room / cell), 1);
        let rows = u64::from(height_of_body) * u64::from(lines);
        let (y, rows) = seen(y0, height, stride, rows, lines.into());
        Self {
            cells: Rect {
                x: area.x + label,
                width: narrow(columns) * cell,
                height: narrow(rows.div_ceil(lines.into())),
                ..body
            },
            cell,
            lines,
            closest,
            shown: Visible {
                first: results.place.with(Axis::X0, x).with(Axis::Y0, y),
                count: (columns, rows),
                stride,
            },
            side: side.map(|side| write::right_of(area, area.right() - side)),
        }
    }

    fn is_picture(&self) -> bool {
        self.lines == 2
    }

    fn pose(&self, at: Position) -> Option<(u64, u64)> {
        let [x, y, ..] = self.shown.first.into_array();
        let right = u64::from(at.x.checked_sub(self.cells.x)? / self.cell);
        let down = u64::from(at.y.checked_sub(self.cells.y)? * self.lines);
        let stride = self.shown.stride;
        (self.cells.contains(at)).then_some((x + right * stride, y + down * stride))
    }

    fn cursor(&self, place: PoseIndex) -> Position {
        let [x, y, ..] = self.shown.first.into_array();
        let [right, down] = [place[Axis::X0] - x, place[Axis::Y0] - y];
        let stride = self.shown.stride;
        Position::new(
            self.cells.x + narrow(right / stride) * self.cell,
            self.cells.y + narrow(down / stride / u64::from(self.lines)),
        )
    }
}

/// Returns the strides of pictures, from the whole range to every pose; none if letters fit at once.
fn strides((width, height): (u64, u64), (columns, lines): (u16, u16)) -> Vec<u64> {
    let (columns, lines) = (u64::from(columns.max(1)), u64::from(lines.max(1)));
    if width <= columns && height <= lines {
        return Vec::new();
    }
    let whole = width.div_ceil(columns).max(height.div_ceil(2 * lines));
    let closer = |stride: &u64| (*stride > 1).then(|| stride.div_ceil(2));
    std::iter::successors(Some(whole), closer).collect()
}

/// Returns the first visible pose along an axis, and the number of visible ones. One in `stride` of `all` poses is
/// shown, at most `room` of these are visible, and the pose `at` is as near to the middle as the ends allow. `block`
/// of them share a line.
fn seen(at: u64, all: u64, stride: u64, room: u64, block: u64) -> (u64, u64) {
    let shown = all.div_ceil(stride);
    let seen = shown.min(room);
    // Rounded up to whole blocks, because otherwise the last pose could not be reached if its block is not full.
    let last = (shown - seen).next_multiple_of(block);
    let first = (at / stride).saturating_sub(seen / 2).min(last);
    let first = first - first % block;
    (first * stride, seen.min(shown.saturating_sub(first)))
}

fn on(results: &mut Results, app: &mut App, message: &Message, area: Rect) {
    let pane = Pane::of(area, results);
    let stride = i64::try_from(pane.shown.stride).unwrap_or(i64::MAX);
    match *message {
        Message::Cursor(arrow) => {
            let (dx, dy) = arrow.step();
            step(results, Axis::X0, i64::from(dx) * stride);
            step(results, Axis::Y0, i64::from(dy) * stride);
        }
        Message::Scroll(lines) => step(results, Axis::Y0, i64::from(lines) * stride),
        Message::ScrollTo(Endpoint::First) => step(results, Axis::X0, i64::MIN),
        Message::ScrollTo(Endpoint::Last) => step(results, Axis::X0, i64::MAX),
        Message::Explore(ExploreMessage::Point(x0, y0)) => {
            results.place[Axis::X0] = x0;
            results.place[Axis::Y0] = y0;
        }
        Message::Explore(ExploreMessage::Angle(by)) => turn(results, app, by),
        Message::Explore(ExploreMessage::Zoom) => next_zoom(results, app),
        Message::Zoom(by) => {
            let now = results.map.zoom.min(pane.closest);
            results.map.zoom = now.saturating_add_signed(by.into()).min(pane.closest);
            if results.map.zoom == now {
                let end = ["this is the whole range", "every pose has its letter"];
                refuse(app, end[usize::from(by > 0)]);
            }
        }
        _ => {}
    }
}

fn step(results: &mut Results, axis: Axis, by: i64) {
    let last = results.sweep().grid.counts()[axis] - 1;
    results.place[axis] = results.place[axis].saturating_add_signed(by).min(last);
}

/// Goes to another angle; the first follows the last, as angles may go all around.
fn turn(results: &mut Results, app: &mut App, by: i8) {
    let count = results.sweep().grid.counts()[Axis::Angle];
    if count == 1 {
        return only_one(results, app, "angle");
    }
    let now = results.place[Axis::Angle];
    let step = i64::from(by).rem_euclid(i64::try_from(count).unwrap_or(i64::MAX));
    results.place[Axis::Angle] = (now + step.unsigned_abs()) % count;
}

/// Goes to the next zoom along x; after the last one to the next along y.
fn next_zoom(results: &mut Results, app: &mut App) {
    let counts = results.sweep().grid.counts();
    if !results.sweep().grid.axes().any(|axis| axis == Axis::ZoomX) {
        return refuse(app, "a figure has no zoom");
    }
    if counts[Axis::ZoomX] * counts[Axis::ZoomY] == 1 {
        return only_one(results, app, "zoom");
    }
    for axis in [Axis::ZoomX, Axis::ZoomY] {
        results.place[axis] = (results.place[axis] + 1) % counts[axis];
        if results.place[axis] > 0 {
            break;
        }
    }
}

fn only_one(results: &Results, app: &mut App, what: &str) {
    let ranges = app.keymap.label(results.tab().context, &action::RANGES);
    let text = format!("only one {what} was swept; {ranges} explores other ranges");
    refuse(app, text);
}

pub(super) fn closest(results: &Results, area: Rect) -> usize {
    Pane::of(area, results).closest
}

fn draw(results: &Results, mut canvas: Canvas<'_>, area: Rect) -> Option<Position> {
    let pane = Pane::of(area, results);
    let left = pane
        .side
        .map_or(area, |side| write::left_of(area, side.x - 2));
    let (sign, count) = match (pane.is_picture(), has_colours(canvas.theme)) {
        (false, _) => ("letter", LETTERS),
        (true, true) => ("colour", TINTS),
        (true, false) => ("shade", SHADE_COUNT),
    };
    let mut meaning = format!("  each {sign} an imprint");
    if pane.shown.stride > 1 {
        meaning += &format!("; 1 in {0} × {0}", pane.shown.stride);
    }
    let heading = heading(results);
    if write::width(&heading) + write::width(&meaning) > left.width.into() {
        meaning.clear();
    }
    canvas.line(left, [(&*heading, Role::Title), (&*meaning, Role::Quiet)]);
    draw_pose(&mut canvas, results, &pane, area);
    if pane.cells.is_empty() {
        canvas.text(write::row(area, 1), "no room for the map", Role::Quiet);
        return None;
    }
    draw_rulers(&mut canvas, results, &pane, left);
    Some(draw_cells(&mut canvas, results, &pane, count))
}

/// Says the angle and the zoom: `angle 30° 4/36  zoom x 1.00`.
fn heading(results: &Results) -> String {
    let grid = &results.sweep().grid;
    let mut parts = Vec::new();
    for axis in grid
        .axes()
        .filter(|axis| !matches!(axis, Axis::X0 | Axis::Y0))
    {
        let (at, count) = (results.place[axis], grid.counts()[axis]);
        let value = axis.parameter().format(grid.ranges()[axis].value(at));
        let unit = if axis == Axis::Angle { "°" } else { "" };
        let mut text = format!("{} {value}{unit}", axis.parameter().row().short);
        if count > 1 {
            text += &format!(" {}/{}", grouped(at + 1), grouped(count));
        }
        parts.push(text);
    }
    parts.join("  ")
}

/// Returns the position of the cursor.
fn draw_cells(canvas: &mut Canvas<'_>, results: &Results, pane: &Pane, count: u8) -> Position {
    let theme = canvas.theme;
    let mut drawn = results.map.drawn.borrow_mut();
    let (_, ids) = match drawn.take() {
        Some(last) if last.0 == pane.shown => drawn.insert(last),
        _ => drawn.insert((pane.shown, pane.shown.find(results))),
    };
    let columns = index(pane.shown.count.0).max(1);
    let signs = signs(ids, columns, count);
    let lines = signs.chunks(columns * usize::from(pane.lines));
    for (line, row) in lines.zip(pane.cells.rows()) {
        for (column, place) in row.columns().enumerate() {
            let column = column / usize::from(pane.cell);
            let sign = |at: usize| line.get(at).copied().flatten();
            let (upper, lower) = (sign(column), sign(columns + column));
            let (sign, style) = if pane.is_picture() {
                halves(theme, upper, lower)
            } else {
                let style = upper.map_or(Style::new(), |sign| theme.tint(sign.into()));
                (upper.map_or(' ', letter), style)
            };
            canvas.buffer[place.as_position()]
                .set_char(sign)
                .set_style(style);
        }
    }
    let cursor = pane.cursor(results.place);
    for column in 0..pane.cell {
        let cell = &mut canvas.buffer[(cursor.x + column, cursor.y)];
        // A reversed block would look like its neighbours.
        if pane.is_picture() {
            cell.reset();
            cell.set_char(if theme.ascii { 'X' } else { '+' });
        }
        cell.set_style(theme.style(Role::Cursor));
    }
    cursor
}

fn has_colours(theme: &Theme) -> bool {
    !theme.ascii && theme.tint(0).fg.is_some()
}

/// Returns the character of two poses, one above the other; where there are no colours, of the upper one alone.
fn halves(theme: &Theme, upper: Option<u8>, lower: Option<u8>) -> (char, Style) {
    let tint = |sign: u8| theme.tint(sign.into());
    if !has_colours(theme) {
        let shade = upper.map(|sign| theme.shade(SHADES[usize::from(sign)])[0]);
        return (shade.unwrap_or(' '), upper.map_or(Style::new(), tint));
    }
    match (upper, lower) {
        (None, None) => (' ', Style::new()),
        (Some(upper), None) => ('▀', tint(upper)),
        (None, Some(lower)) => ('▄', tint(lower)),
        (Some(upper), Some(lower)) if upper == lower => ('█', tint(upper)),
        (Some(upper), Some(lower)) => {
            let behind = tint(lower).fg.unwrap_or_default();
            ('▀', tint(upper).bg(behind))
        }
    }
}

fn draw_rulers(canvas: &mut Canvas<'_>, results: &Results, pane: &Pane, area: Rect) {
    let value = |axis: Axis, index: u64| {
        let range = results.sweep().grid.ranges()[axis];
        axis.parameter().format(range.value(index))
    };
    let [x, y, ..] = pane.shown.first.into_array();
    let label = usize::from(pane.cells.x - area.x).saturating_sub(1);
    let step = pane.shown.stride * u64::from(pane.lines);
    for (row, index) in pane.cells.rows().zip(0..) {
        let text = format!("{:>label$}", value(Axis::Y0, y + index * step));
        let (x, width) = (area.x, pane.cells.x - area.x);
        canvas.text(Rect { x, width, ..row }, &text, Role::Quiet);
    }
    let last = x + (pane.shown.count.0 - 1) * pane.shown.stride;
    let (mut text, last) = (format!("x0 {}", value(Axis::X0, x)), value(Axis::X0, last));
    let rest = usize::from(pane.cells.width).saturating_sub(text.len());
    if last.len() < rest {
        text += &format!("{last:>rest$}");
    }
    let row = write::row(area, 1);
    canvas.text(row, "y0", Role::Quiet);
    canvas.text(write::right_of(row, pane.cells.x), &text, Role::Quiet);
}

fn draw_pose(canvas: &mut Canvas<'_>, results: &Results, pane: &Pane, area: Rect) {
    let (grid, atlas) = (&results.sweep().grid, &results.sweep().atlas);
    let number = grid.number(results.place);
    let imprint = Plane::new(*grid.sensor()).touch(&grid.placed(number));
    let entry = atlas.find(&imprint).and_then(|id| atlas.entry(id));
    let (which, poses) = entry.map_or(("not swept".to_owned(), String::new()), |entry| {
        let poses = counted(entry.count, "pose");
        (format!("imprint {}", entry.id), poses)
    });
    let text = format!("{which} at {}; {poses}", results.pose_text(number));
    let foot = write::row(area, area.height.saturating_sub(1).into());
    canvas.text(foot, text.trim_end_matches("; "), Role::Text);
    if let Some(side) = pane.side {
        canvas.text(side, &which, Role::Title);
        canvas.text(write::row(side, 1), &poses, Role::Text);
        let mut picture = below(side, 3);
        picture.height = picture.height.saturating_sub(1);
        draw_thumbnail(canvas.theme, &imprint, canvas.buffer, picture);
    }
}

/// Returns the sign of each cell of a map as a number below `count`, or None where there is no imprint. `width` is the
/// number of cells in a row. Different imprints have different signs until all are used; then signs are repeated, but
/// not for cells that touch, also across corners. Only around an imprint that touches `count` others can they run out.
/// By default the imprint's number decides, so that most signs stay when the map moves.
fn signs(ids: &[Option<u32>], width: usize, count: u8) -> Vec<Option<u8>> {
    let all = ids.iter().flatten().map(|&id| (id, BTreeSet::new()));
    let mut neighbours: BTreeMap<u32, BTreeSet<u32>> = all.collect();
    for (index, one) in ids.iter().enumerate() {
        let column = index % width.max(1);
        let (is_first, is_last) = (column == 0, column + 1 == width);
        let beside = if is_last { 0..0 } else { index + 1..index + 2 };
        let from = index + width - usize::from(!is_first);
        let under = from..index + width + 1 + usize::from(!is_last);
        for other in beside.chain(under).filter_map(|at| ids.get(at)) {
            if let (Some(one), Some(other)) = (one, other)
                && one != other
            {
                neighbours.entry(*one).or_default().insert(*other);
                neighbours.entry(*other).or_default().insert(*one);
            }
        }
    }
    // Imprints with the most neighbours come first: an imprint with fewer neighbours than there are signs always finds
    // one.
    let mut order: Vec<u32> = neighbours.keys().copied().collect();
    order.sort_by_key(|id| Reverse(neighbours[id].len()));
    let mut chosen: BTreeMap<u32, u8> = BTreeMap::new();
    let mut used: BTreeSet<u8> = BTreeSet::new();
    for id in order {
        let [own, ..] = (id % u32::from(count)).to_le_bytes();
        let others = || (0..count).map(|step| (own + step) % count);
        let is_free = |sign: &u8| {
            let mut around = neighbours[&id].iter();
            around.all(|other| chosen.get(other) != Some(sign))
        };
        let unused = others().find(|sign| !used.contains(sign));
        let sign = unused.or_else(|| others().find(is_free)).unwrap_or(own);
        used.insert(sign);
        chosen.insert(id, sign);
    }
    ids.iter()
        .map(|id| chosen.get(id.as_ref()?).copied())
        .collect()
}

fn letter(number: u8) -> char {
    const ALL: &[u8; LETTERS as usize] =
        b"abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
    ALL[usize::from(number % LETTERS)].into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_is_shown_whole_first_and_then_closer() {
        assert!(
            strides((40, 17), (40, 17)).is_empty(),
            "letters fit at once"
        );
        assert_eq!(strides((41, 17), (40, 17)), [2, 1]);
        assert_eq!(strides((40, 34), (40, 17)), [1]);
        assert_eq!(strides((100, 100), (52, 17)), [3, 2, 1]);
    }

    #[test]
    fn the_visible_poses_include_the_cursor_and_begin_at_a_block() {
        for (all, stride, room, block) in [
            (100, 3, 20, 2),
            (101, 2, 34, 2),
            (101, 1, 34, 2),
            (7, 2, 9, 2),
            (50, 1, 4, 1),
            (5, 5, 0, 2),
        ] {
            for at in 0..all {
                let (first, count) = seen(at, all, stride, room, block);
                assert!(first.is_multiple_of(stride * block) && count <= room);
                assert!((first + count * stride).saturating_sub(all) < stride * block.max(2));
                let here = first <= at && at < first + count * stride;
                assert!(here || room == 0, "{at} of {all}: {first}, {count}");
            }
        }
    }

    #[test]
    fn neighbours_differ_and_an_imprint_has_one_letter() {
        // These numbers would all have the same letter.
        for (width, height) in [(1, 9), (9, 1), (7, 8), (40, 30)] {
            let id = |x: usize, y: usize| {
                let block = (x / 3 * 7 + y / 2 * 5) % 23;
                (block % 6 != 5).then(|| u32::try_from(block * 62).expect("small"))
            };
            let places = || (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
            let ids: Vec<_> = places().map(|(x, y)| id(x, y)).collect();
            let found = signs(&ids, width, LETTERS);
            let at = |x: usize, y: usize| (ids[y * width + x], found[y * width + x]);
            for (x, y) in places() {
                let (own, letter) = at(x, y);
                assert_eq!(own.is_some(), letter.is_some());
                for (other_x, other_y) in places() {
                    let (other, other_letter) = at(other_x, other_y);
                    let near = x.abs_diff(other_x) <= 1 && y.abs_diff(other_y) <= 1;
                    if own.is_some() && own == other {
                        assert_eq!(letter, other_letter);
                    } else if near && own.is_some() && other.is_some() {
                        assert_ne!(letter, other_letter, "{x},{y} and {other_x},{other_y}");
                    }
                }
            }
        }
        // 62 would have the letter of 0.
        let found = signs(&[Some(0), Some(62), None, Some(3)], 2, LETTERS);
        assert_eq!(found, [Some(0), Some(1), None, Some(3)]);
        // As many imprints as there are letters: no letter twice, whatever their numbers.
        let ids: Vec<_> = (0..u32::from(LETTERS)).map(|id| Some(id * 31)).collect();
        let different: BTreeSet<_> = signs(&ids, 8, LETTERS).into_iter().flatten().collect();
        assert_eq!(different.len(), ids.len());
    }
}
