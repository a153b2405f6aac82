//! The imprints tab: a list of the distinct imprints.
//!
//! ```text
//!    #  ↓poses      %   x0   y0 pc ho       na   >7      #12     headings, an arrow at the sort column
//! >  7     366   0.47 5.00 5.00  1  0       36   ·▄▄·    ▄██▄    the selected row, thumbnails from it on
//!   12     360   0.46 5.05 5.00  1  1       34   ·▀▀·    ·▀▀·
//! imprint 7 at x0 5.00, y0 5.00; 1 piece, 0 holes, na 36         everything about the selected imprint
//! ```
//! A row has the number of the imprint, how many poses leave it and their share, its first pose, pieces and holes,
//! and the value of the chosen descriptor. If there is little room, the thumbnails are omitted first, then the first
//! pose. Left and right choose a heading, and `s` sorts by it; a click on a heading does both.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::atlas::{Atlas, AtlasEntry, AtlasFilter, SortDirection};
use taxel_core::index::wide;
use taxel_core::pose::Axis;
use taxel_core::sweep::SweepResult;
use taxel_files::formats::value::{counted, grouped, percentage};

use crate::tui::app::message::Message;
use crate::tui::app::page::Wheel;
use crate::tui::explore::message::{ExploreMessage, ListColumn};
use crate::tui::explore::results::Results;
use crate::tui::explore::view::ResultsTab;
use crate::tui::grid::{draw_thumbnail, thumbnail_size};
use crate::tui::keys::keymap::Context;
use crate::tui::widget::rows::{ListRows, moved};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};

const VALUE: usize = 8;
const SHARE: usize = 6;
const SIGN: usize = 2;

pub static TAB: ResultsTab = ResultsTab {
    title: "imprints",
    context: Context::Imprints,
    filtered: true,
    drawing: None,
    table: None,
    wheel: Wheel::Rows,
    draw,
    click,
    update,
};

fn click(results: &Results, area: Rect, at: Position) -> Option<Message> {
    let list = ImprintTable::of(area, results);
    if let Some(column) = list.heading(at) {
        return Some(Message::Explore(ExploreMessage::Sort(column)));
    }
    list.rows.click(at, results.list.selected())
}

fn update(results: &mut Results, message: &Message, area: Rect) {
    let visible = ImprintTable::of(area, results).rows.area.height.into();
    results.list.keep_first_row(visible);
    if let Some(row) = moved(results.list.selected(), message) {
        results.list.select(row);
    }
    if let Message::Explore(ExploreMessage::Columns(by)) = *message {
        let shown = ImprintTable::of(area, results).columns();
        let shown: Vec<ListColumn> = shown.into_iter().map(|(column, _)| column).collect();
        results.list.move_heading(by, &shown);
    }
    results.list.keep_first_row(visible);
}

#[derive(Clone, Debug)]
pub struct ImprintTable {
    pub head: Rect,
    pub rows: ListRows,
    pub detail: Rect,
    pub gallery: Option<Rect>,
    pub id: usize,
    pub poses: usize,
    pub place: Vec<(Axis, usize)>,
}

impl ImprintTable {
    pub fn of(area: Rect, results: &Results) -> Self {
        let result = results.sweep();
        let grid = &result.grid;
        let id = result.atlas.len().to_string().len().max(2);
        let poses = grouped(result.poses).len().max(6);
        // A column of equal values would say nothing; the line about the selected imprint gives its whole pose.
        let varying = grid.axes().filter(|&axis| grid.ranges()[axis].count() > 1);
        let place: Vec<(Axis, usize)> =
            varying.map(|axis| (axis, results.width_of(axis))).collect();
        let short = SIGN + id + 1 + poses + 1 + SHARE + 1 + 2 + 1 + 2 + 1 + VALUE;
        let full = short + place.iter().map(|(_, width)| width + 1).sum::<usize>();
        let room = usize::from(area.width);
        let thumbnail = usize::from(grid.sensor().columns().min(16)) + 2;
        let width = if full <= room { full } else { short };
        let beside = width + thumbnail <= room;
        let table = Rect {
            width: narrow(width).min(area.width),
            ..area
        };
        let x = table.right().saturating_add(2).min(area.right());
        let (above, below) = (area.height.min(1), u16::from(area.height > 1));
        let gallery = Rect {
            x,
            width: area.right() - x,
            height: area.height - below,
            ..area
        };
        let rows = Rect {
            height: area.height - above - below,
            ..write::below(table, above)
        };
        Self {
            head: Rect {
                height: above,
                ..table
            },
            rows: ListRows {
                // The list scrolls by whole screenfuls, so that a clicked row stays where it is.
                first: results.list.first_row(rows.height.into()),
                count: results.list.row_count(),
                area: rows,
            },
            detail: write::below(area, area.height - below),
            gallery: beside.then_some(gallery),
            id,
            poses,
            place: if width == full { place } else { Vec::new() },
        }
    }

    pub fn columns(&self) -> Vec<(ListColumn, usize)> {
        let place = self.place.iter();
        let place = place.map(|&(axis, width)| (ListColumn::Position(axis), width + 1));
        let first = [
            (ListColumn::FirstPose, SIGN + self.id),
            (ListColumn::Poses, 1 + self.poses + 1 + SHARE),
        ];
        let last = [
            (ListColumn::Pieces, 3),
            (ListColumn::Holes, 3),
            (ListColumn::Value, 1 + VALUE),
        ];
        first.into_iter().chain(place).chain(last).collect()
    }

    fn heading(&self, place: Position) -> Option<ListColumn> {
        if !self.head.contains(place) {
            return None;
        }
        let mut rest = usize::from(place.x - self.head.x);
        self.columns().into_iter().find_map(|(column, width)| {
            let inside = rest < width;
            rest = rest.saturating_sub(width);
            inside.then_some(column)
        })
    }
}

pub(super) fn no_row(results: &Results) -> String {
    format!("no imprint fits {}", results.list.filter())
}

/// Returns the position of the selected row.
fn draw(results: &Results, theme: &Theme, buffer: &mut Buffer, area: Rect) -> Option<Position> {
    let list = ImprintTable::of(area, results);
    draw_headings(theme, results, &list, buffer);
    if results.list.row_count() == 0 {
        let text = no_row(results);
        write::text(buffer, list.rows.area, theme, &text, Role::Quiet);
    }
    let rows = results.rows_from(list.rows.first);
    for ((index, entry), row) in rows.zip(list.rows.area.rows()) {
        let selected = index == results.list.selected();
        let (sign, role) = if selected {
            ("> ", Role::Focus)
        } else {
            ("  ", Role::Text)
        };
        let text = row_text(theme, results, &list, &entry);
        let pieces = [(sign, Role::Key), (text.as_str(), role)];
        write::line(buffer, row, theme, pieces);
        if selected {
            let texts = detail(theme, results, &entry);
            let texts = texts.each_ref().map(String::as_str);
            let text = write::first_fitting(&texts, list.detail.width.into());
            write::text(buffer, list.detail, theme, text, Role::Text);
        }
    }
    if let Some(area) = list.gallery {
        draw_gallery(theme, results, buffer, area);
    }
    list.rows.position(results.list.selected())
}

/// The chosen heading looks like the selected row.
fn draw_headings(theme: &Theme, results: &Results, list: &ImprintTable, buffer: &mut Buffer) {
    let (by, direction) = results.list.sort;
    let key: String = results.feature().key.chars().take(VALUE - 1).collect();
    let mut pieces: Vec<(String, Role)> = Vec::new();
    for (column, width) in list.columns() {
        let title = match column {
            ListColumn::FirstPose => "#",
            ListColumn::Poses => "poses",
            ListColumn::Position(axis) => axis.parameter().row().short,
            ListColumn::Pieces => "pc",
            ListColumn::Holes => "ho",
            ListColumn::Value => &key,
        };
        let arrow = (by == column).then(|| theme.sorted(direction));
        let title: String = arrow.into_iter().chain(title.chars()).collect();
        let behind = if column == ListColumn::Poses {
            1 + SHARE
        } else {
            0
        };
        let room = width - behind;
        let gap = room.saturating_sub(write::width(&title));
        let role = if column == results.list.heading() {
            Role::Focus
        } else {
            Role::Title
        };
        pieces.push((" ".repeat(gap), Role::Title));
        pieces.push((title, role));
        if behind > 0 {
            pieces.push((format!("{:>behind$}", "%"), Role::Title));
        }
    }
    let pieces = pieces.iter().map(|(text, role)| (text.as_str(), *role));
    write::line(buffer, list.head, theme, pieces);
}

fn row_text(theme: &Theme, results: &Results, list: &ImprintTable, entry: &AtlasEntry) -> String {
    let (id, poses) = (list.id, list.poses);
    let mut text = format!(
        "{:>id$} {:>poses$} {:>SHARE$}",
        entry.id,
        grouped(entry.count),
        share(results, entry)
    );
    let pose = results.sweep().grid.pose(entry.first_pose);
    for &(axis, width) in &list.place {
        text += &format!(" {:>width$}", axis.parameter().format(pose[axis]));
    }
    text += &format!(" {:>2} {:>2}", entry.summary.pieces, entry.summary.holes);
    text += &format!(" {:>VALUE$}", number(theme, results, entry));
    text
}

fn share(results: &Results, entry: &AtlasEntry) -> String {
    percentage(
        taxel_files::formats::atlas::pose_share(results.sweep(), entry),
        2,
    )
}

fn number(theme: &Theme, results: &Results, entry: &AtlasEntry) -> String {
    let value = results.values().get(wide(entry.id)).copied().flatten();
    theme.number(value, VALUE - 1)
}

/// Describes an imprint in one line; the shorter form leaves out what its row says too.
fn detail(theme: &Theme, results: &Results, entry: &AtlasEntry) -> [String; 2] {
    let pose = results.sweep().grid.pose(entry.first_pose);
    let count = |count: u16, noun: &str| counted(count, noun);
    let short = format!("imprint {} at {}", entry.id, results.pose_text(&pose));
    let full = format!(
        "{short}; {}, {}, {} {}",
        count(entry.summary.pieces, "piece"),
        count(entry.summary.holes, "hole"),
        results.feature().key,
        number(theme, results, entry)
    );
    [full, short]
}

fn draw_gallery(theme: &Theme, results: &Results, buffer: &mut Buffer, area: Rect) {
    let Some((_, first)) = results.rows_from(results.list.selected()).next() else {
        return;
    };
    let (width, height) = thumbnail_size(theme, &first.imprint);
    let (width, height) = (
        width.min(area.width),
        height.min(area.height.saturating_sub(1)),
    );
    if width == 0 || height == 0 {
        return;
    }
    let across = (area.width + 2) / (width + 2);
    // Each thumbnail has a caption above it.
    let down = area.height / (height + 1);
    let places =
        (0..down.max(1)).flat_map(|line| (0..across.max(1)).map(move |column| (column, line)));
    for ((column, line), (index, entry)) in places.zip(results.rows_from(results.list.selected())) {
        let place = Rect {
            x: area.x + column * (width + 2),
            y: area.y + line * (height + 1),
            width,
            height: height + 1,
        };
        let place = place.intersection(area);
        let sign = if index == results.list.selected() {
            ">"
        } else {
            " "
        };
        let caption = format!("{sign} imprint {}", entry.id);
        write::text(buffer, place, theme, &caption, Role::Key);
        draw_thumbnail(theme, &entry.imprint, buffer, write::below(place, 1));
    }
}

#[derive(Clone, Debug)]
pub struct ImprintList {
    pub(in crate::tui::explore) sort: (ListColumn, SortDirection),
    heading: ListColumn,
    filter: String,
    /// The numbers of all imprints, sorted. They are kept because a filter is typed letter by letter, which does not
    /// change the order.
    order: Vec<u32>,
    kept: Vec<bool>,
    rows: Vec<u32>,
    selected: usize,
    top: usize,
}

impl ImprintList {
    pub fn new(by_poses: Vec<u32>) -> Self {
        Self {
            sort: (ListColumn::Poses, SortDirection::Descending),
            heading: ListColumn::Poses,
            filter: String::new(),
            rows: by_poses.clone(),
            order: by_poses,
            kept: Vec::new(),
            selected: 0,
            top: 0,
        }
    }

    /// Sorts by a column, which becomes the chosen heading; by the same column again, reverses the order. The
    /// selected imprint stays selected. `values` are those of the chosen descriptor, by the imprints' numbers.
    pub fn sort(&mut self, by: ListColumn, sweep: &SweepResult, values: &[Option<f64>]) {
        self.sort = if self.sort.0 == by {
            (by, self.sort.1.reversed())
        } else {
            (by, by.first_direction())
        };
        self.heading = by;
        self.arrange(sweep, values);
    }

    pub fn heading(&self) -> ListColumn {
        self.heading
    }

    pub fn move_heading(&mut self, by: i8, shown: &[ListColumn]) {
        let now = shown.iter().position(|&column| column == self.heading);
        let next = now.map_or(0, |now| now.saturating_add_signed(isize::from(by)));
        if let Some(&column) = shown.get(next.min(shown.len().saturating_sub(1))) {
            self.heading = column;
        }
    }

    pub fn filter(&self) -> &str {
        &self.filter
    }

    /// The selected imprint stays selected if it is kept.
    pub fn keep(&mut self, typed: &str, filter: &AtlasFilter, atlas: &Atlas) {
        typed.trim().clone_into(&mut self.filter);
        self.kept = if filter.is_empty() {
            Vec::new()
        } else {
            filter.keeps(atlas)
        };
        self.apply_filter();
    }

    pub fn keeps(&self, id: u32) -> bool {
        let kept = self.kept.get(wide(id));
        kept.is_none_or(|&kept| kept)
    }

    pub fn arrange(&mut self, sweep: &SweepResult, values: &[Option<f64>]) {
        let (by, direction) = self.sort;
        self.order = by.order(sweep, values, direction);
        self.apply_filter();
    }

    fn apply_filter(&mut self) {
        let selected = self.rows.get(self.selected).copied();
        let rows = self.order.iter().copied();
        self.rows = rows.filter(|&id| self.keeps(id)).collect();
        if !selected.is_some_and(|id| self.find(id)) {
            self.select(self.selected);
        }
    }

    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    pub fn rows(&self) -> impl Iterator<Item = u32> + '_ {
        self.rows.iter().copied()
    }

    pub fn selected(&self) -> usize {
        self.selected
    }

    pub fn select(&mut self, row: usize) {
        self.selected = row.min(self.rows.len().saturating_sub(1));
    }

    /// Returns the index of the first row of a list that shows `visible` rows. It stays the same while the selected
    /// row is visible; otherwise the list scrolls by whole screenfuls. The last one is full.
    pub fn first_row(&self, visible: usize) -> usize {
        let visible = visible.max(1);
        let last = self.rows.len().saturating_sub(visible);
        let top = self.top.min(last);
        let first = if (top..top + visible).contains(&self.selected) {
            top
        } else {
            self.selected - self.selected % visible
        };
        first.min(last)
    }

    pub fn keep_first_row(&mut self, visible: usize) {
        self.top = self.first_row(visible);
    }

    pub fn find(&mut self, id: u32) -> bool {
        let row = self.rows.iter().position(|&row| row == id);
        self.selected = row.unwrap_or(self.selected);
        row.is_some()
    }
}
