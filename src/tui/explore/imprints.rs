//! The imprints tab: a list of the distinct imprints.
//!
//! ```text
//!    #  ↓poses      %   x0   y0 pieces holes       na   >7      #12     headings, an arrow at the sort column
//! >  7     366   0.47 5.00 5.00      1     0       36   ·▄▄·    ▄██▄    the selected row, thumbnails from it on
//!   12     360   0.46 5.05 5.00      1     1       34   ·▀▀·    ·▀▀·
//! imprint 7 at x0 5.00, y0 5.00; 1 piece, 0 holes, na 36                everything about the selected imprint
//! ```
//! Left and right choose a heading, and `s` sorts by it; a click on a heading does both. Columns of a single value
//! are left out: the last line has the whole pose.

use ratatui::layout::{Constraint, Layout, Position, Rect};
use taxel_core::atlas::AtlasEntry;
use taxel_core::index::index;
use taxel_core::pose::Axis;
use taxel_files::formats::atlas::pose_share;
use taxel_files::formats::value::{counted, grouped, percentage};

use crate::tui::app::{App, Canvas, Message, Wheel};
use crate::tui::explore::results::{Chosen, Results, Tab, row_style};
use crate::tui::explore::{ExploreMessage, Findings};
use crate::tui::grid::{draw_thumbnail, thumbnail_size};
use crate::tui::keys::Context;
use crate::tui::widget::write::{self, narrow};
use crate::tui::widget::{ListRows, Role, Theme, moved};

const VALUE: usize = 8;
const SHARE: usize = 6;
const SIGN: usize = 2;

pub(super) static TAB: Tab = Tab {
    title: "imprints",
    context: Context::Imprints,
    wheel: Wheel::Rows,
    draw,
    click,
    on,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SortColumn {
    FirstPose,
    Poses,
    Position(Axis),
    Pieces,
    Holes,
    Value,
}

/// What it sorts by, its title, and its width.
type Column = (SortColumn, &'static str, usize);

fn columns(results: &Results) -> Vec<Column> {
    let (sweep, grid) = (results.sweep(), &results.sweep().grid);
    let id = sweep.atlas.len().to_string().len().max(2);
    let poses = grouped(sweep.poses).len().max(6) + 1 + SHARE;
    let key = &results.chosen.feature().key;
    let mut columns = vec![
        (SortColumn::FirstPose, "#", id),
        (SortColumn::Poses, "poses      %", poses),
    ];
    for axis in grid.axes().filter(|&axis| grid.ranges()[axis].count() > 1) {
        let (title, width) = (axis.parameter().row().short, results.width_of(axis));
        columns.push((SortColumn::Position(axis), title, width));
    }
    columns.extend([
        (SortColumn::Pieces, "pieces", 6),
        (SortColumn::Holes, "holes", 5),
        (
            SortColumn::Value,
            key.get(..VALUE - 1).unwrap_or(key),
            VALUE,
        ),
    ]);
    columns
}

fn text_of(theme: &Theme, results: &Results, entry: &AtlasEntry, by: SortColumn) -> String {
    match by {
        SortColumn::FirstPose => entry.id.to_string(),
        SortColumn::Poses => {
            let share = percentage(pose_share(results.sweep(), entry), 2);
            format!("{} {share:>SHARE$}", grouped(entry.count))
        }
        SortColumn::Position(axis) => {
            let pose = results.sweep().grid.pose(entry.first_pose);
            axis.parameter().format(pose[axis])
        }
        SortColumn::Pieces => entry.summary.pieces.to_string(),
        SortColumn::Holes => entry.summary.holes.to_string(),
        SortColumn::Value => results.chosen.text(theme, entry.id, VALUE - 1),
    }
}

struct Panes {
    columns: Vec<Column>,
    head: Rect,
    rows: ListRows,
    detail: Rect,
    /// Thumbnails, where there is room for one beside the table.
    gallery: Option<Rect>,
}

impl Panes {
    fn of(area: Rect, results: &Results) -> Self {
        let columns = columns(results);
        let width = SIGN - 1 + columns.iter().map(|column| 1 + column.2).sum::<usize>();
        let lines = [
            Constraint::Length(1),
            Constraint::Fill(1),
            Constraint::Length(1),
        ];
        let [head, rows, detail] = Layout::vertical(lines).areas(area);
        let table = |line: Rect| write::left_of(line, line.x.saturating_add(narrow(width)));
        let gallery = Rect {
            height: area.height.saturating_sub(1),
            ..write::right_of(area, table(area).right().saturating_add(2))
        };
        let thumbnail = u16::from(results.sweep().grid.sensor().columns().min(16));
        let rows = table(rows);
        Self {
            head: table(head),
            rows: ListRows {
                // The list scrolls by whole screenfuls, so that a clicked row stays where it is.
                first: results.list.first_row(rows.height.into()),
                count: results.list.rows.len(),
                area: rows,
            },
            detail,
            gallery: (thumbnail <= gallery.width).then_some(gallery),
            columns,
        }
    }
}

fn click(results: &Results, area: Rect, at: Position) -> Option<Message> {
    let panes = Panes::of(area, results);
    if !panes.head.contains(at) {
        return panes.rows.click(at, results.list.selected);
    }
    let mut end = usize::from(panes.head.x) + SIGN - 1;
    let heading = panes.columns.iter().position(|column| {
        end += 1 + column.2;
        usize::from(at.x) < end
    })?;
    Some(Message::Explore(ExploreMessage::Point(heading as u64, 0)))
}

fn on(results: &mut Results, _app: &mut App, message: &Message, area: Rect) {
    let visible = Panes::of(area, results).rows.area.height.into();
    results.list.top = results.list.first_row(visible);
    if let Some(row) = moved(results.list.selected, message) {
        results.list.select(row);
    }
    let headings: Vec<SortColumn> = columns(results).iter().map(|column| column.0).collect();
    match *message {
        Message::Explore(ExploreMessage::Columns(by)) => {
            let mut now = headings.iter();
            let now = now.position(|&by| by == results.list.heading).unwrap_or(0);
            let next = now.saturating_add_signed(by.into());
            results.list.heading = headings[next.min(headings.len() - 1)];
        }
        Message::Explore(ExploreMessage::Point(heading, _)) => {
            let heading = headings.get(index(heading));
            results.list.heading = *heading.unwrap_or(&SortColumn::Poses);
            results.list.sort(&results.findings, &results.chosen);
        }
        Message::Explore(ExploreMessage::Sort) => {
            results.list.sort(&results.findings, &results.chosen);
        }
        _ => {}
    }
    results.list.top = results.list.first_row(visible);
}

/// Returns the position of the selected row.
fn draw(results: &Results, mut canvas: Canvas<'_>, area: Rect) -> Option<Position> {
    let (panes, list, theme) = (Panes::of(area, results), &results.list, canvas.theme);
    let mut headings = vec![(" ".repeat(SIGN - 1), Role::Title)];
    for &(by, title, width) in &panes.columns {
        let arrow = (list.sort.0 == by).then(|| theme.sorted(list.sort.1));
        let title: String = arrow.into_iter().chain(title.chars()).collect();
        let gap = (1 + width).saturating_sub(write::width(&title));
        let is_chosen = by == list.heading;
        let role = if is_chosen { Role::Focus } else { Role::Title };
        headings.extend([(" ".repeat(gap), Role::Title), (title, role)]);
    }
    let headings = headings.iter().map(|(text, role)| (text.as_str(), *role));
    canvas.line(panes.head, headings);
    let rows = results.rows_from(panes.rows.first);
    for ((index, entry), row) in rows.zip(panes.rows.area.rows()) {
        let (sign, role) = row_style(index == list.selected);
        let cells = panes.columns.iter().map(|&(by, _, width)| {
            let text = text_of(theme, results, &entry, by);
            format!("{text:>width$}")
        });
        let text = cells.collect::<Vec<_>>().join(" ");
        canvas.line(row, [(sign, Role::Key), (&*text, role)]);
    }
    let selected = results.selected()?;
    let (id, pose) = (selected.id, results.pose_text(selected.first_pose));
    let pieces = counted(selected.summary.pieces, "piece");
    let holes = counted(selected.summary.holes, "hole");
    let key = &results.chosen.feature().key;
    let value = results.chosen.text(theme, id, VALUE - 1);
    let text = format!("imprint {id} at {pose}; {pieces}, {holes}, {key} {value}");
    canvas.text(panes.detail, &text, Role::Text);
    if let Some(area) = panes.gallery {
        draw_gallery(results, &selected, &mut canvas, area);
    }
    panes.rows.position(list.selected)
}

/// Each thumbnail has a caption above it.
fn draw_gallery(results: &Results, first: &AtlasEntry, canvas: &mut Canvas<'_>, area: Rect) {
    let (width, height) = thumbnail_size(canvas.theme, &first.imprint);
    let width = width.min(area.width);
    let height = 1 + height.min(area.height.max(1) - 1);
    let across = (area.width + 2) / (width + 2);
    let down = (area.height / height).max(1);
    let places = (0..down).flat_map(|line| (0..across).map(move |column| (column, line)));
    let selected = results.list.selected;
    for ((column, line), (index, entry)) in places.zip(results.rows_from(selected)) {
        let (x, y) = (area.x + column * (width + 2), area.y + line * height);
        let place = Rect::new(x, y, width, height).intersection(area);
        let sign = if index == selected { ">" } else { " " };
        canvas.text(place, &format!("{sign} imprint {}", entry.id), Role::Key);
        let below = write::below(place, 1);
        draw_thumbnail(canvas.theme, &entry.imprint, canvas.buffer, below);
    }
}

/// The rows of the list: the numbers of the imprints. The selected imprint stays selected when they are sorted.
pub(super) struct ImprintList {
    /// What they are sorted by, and whether the smallest comes first.
    pub(super) sort: (SortColumn, bool),
    heading: SortColumn,
    pub(super) rows: Vec<u32>,
    pub(super) selected: usize,
    top: usize,
}

impl ImprintList {
    pub(super) fn new(findings: &Findings) -> Self {
        let poses = findings.sweep.atlas.counts().map(number);
        Self {
            sort: (SortColumn::Poses, false),
            heading: SortColumn::Poses,
            rows: sorted(poses, false),
            selected: 0,
            top: 0,
        }
    }

    /// Sorts by the chosen heading; by the same one again, reverses the order.
    fn sort(&mut self, findings: &Findings, chosen: &Chosen) {
        let is_ascending = match self.heading {
            heading if heading == self.sort.0 => !self.sort.1,
            SortColumn::FirstPose | SortColumn::Position(_) => true,
            _ => false,
        };
        self.sort = (self.heading, is_ascending);
        self.arrange(findings, chosen);
    }

    pub(super) fn arrange(&mut self, Findings { sweep, .. }: &Findings, chosen: &Chosen) {
        let atlas = &sweep.atlas;
        let summaries = atlas.summaries().iter();
        let keys: Vec<Option<f64>> = match self.sort.0 {
            SortColumn::FirstPose => atlas.first_poses().map(number).collect(),
            SortColumn::Poses => atlas.counts().map(number).collect(),
            SortColumn::Pieces => summaries.map(|own| Some(own.pieces.into())).collect(),
            SortColumn::Holes => summaries.map(|own| Some(own.holes.into())).collect(),
            SortColumn::Value => chosen.values.clone(),
            SortColumn::Position(axis) => {
                let at = |pose| Some(sweep.grid.pose(pose)[axis]);
                atlas.first_poses().map(at).collect()
            }
        };
        let selected = self.rows.get(self.selected).copied();
        self.rows = sorted(keys.into_iter(), self.sort.1);
        if let Some(id) = selected {
            self.find(id);
        }
    }

    pub(super) fn select(&mut self, row: usize) {
        self.selected = row.min(self.rows.len().saturating_sub(1));
    }

    pub(super) fn find(&mut self, id: u32) {
        let row = self.rows.iter().position(|&row| row == id);
        self.selected = row.unwrap_or(self.selected);
    }

    /// Returns the first of `visible` rows. It stays while the selected row is visible; otherwise the list scrolls by
    /// whole screenfuls, of which the last one is full.
    fn first_row(&self, visible: usize) -> usize {
        let visible = visible.max(1);
        let last = self.rows.len().saturating_sub(visible);
        let top = self.top.min(last);
        if (top..top + visible).contains(&self.selected) {
            return top;
        }
        (self.selected - self.selected % visible).min(last)
    }
}

#[expect(
    clippy::cast_precision_loss,
    clippy::unnecessary_wraps,
    reason = "poses are below 2⁵³; a key"
)]
fn number(poses: u64) -> Option<f64> {
    Some(poses as f64)
}

/// Returns the numbers of all imprints, sorted by a key each. In both directions, equal keys stay in the order of the
/// numbers, and imprints without a key come last.
fn sorted(keys: impl Iterator<Item = Option<f64>>, is_ascending: bool) -> Vec<u32> {
    let mut ids: Vec<(Option<f64>, u32)> = keys.zip(0..).collect();
    ids.sort_by(|(one, _), (other, _)| match (one, other) {
        (Some(one), Some(other)) if is_ascending => one.total_cmp(other),
        (Some(one), Some(other)) => other.total_cmp(one),
        _ => other.is_some().cmp(&one.is_some()),
    });
    ids.into_iter().map(|(_, id)| id).collect()
}

#[cfg(test)]
mod tests {
    use super::sorted;
    use crate::tui::explore::results::tests::results;

    #[test]
    fn equal_keys_keep_their_order_and_missing_ones_come_last() {
        let keys = [None, Some(2.0), Some(1.0), Some(2.0), None];
        assert_eq!(sorted(keys.into_iter(), true), [2, 1, 3, 0, 4]);
        assert_eq!(sorted(keys.into_iter(), false), [1, 3, 2, 0, 4]);
    }

    #[test]
    fn the_last_screenful_is_full_and_the_list_scrolls_only_when_needed() {
        let mut list = results();
        let (all, visible) = (list.rows.len(), 10);
        assert!(all > 25 && all % visible != 0, "{all}");
        let mut first = |row| {
            list.select(row);
            list.top = list.first_row(visible);
            list.top
        };
        assert_eq!([first(9), first(10), first(19)], [0, 10, 10]);
        let last = all - visible;
        assert_eq!([first(usize::MAX), first(last)], [last, last]);
        assert_eq!(first(last - 1), (last - 1) / visible * visible);
        first(usize::MAX);
        list.rows.truncate(15);
        list.select(14);
        assert_eq!(list.first_row(visible), 5, "no line stays empty");
        assert_eq!(list.first_row(20), 0);
    }
}
