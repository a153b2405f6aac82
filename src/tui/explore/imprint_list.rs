//! The list of imprints of a sweep: its order, its filter, the selected row and the first one on the screen.

use crate::atlas::{Atlas, AtlasFilter, SortDirection};
use crate::index::wide;
use crate::sweep::SweepResult;
use crate::tui::explore::column::ListColumn;

/// The list of imprints, by their numbers in the atlas.
#[derive(Clone, Debug)]
pub struct ImprintList {
    /// The column that rows are sorted by, and the direction.
    sort: (ListColumn, SortDirection),
    /// The chosen heading, which the sort key sorts by.
    heading: ListColumn,
    /// The filter of the rows, as it was typed; empty for none.
    filter: String,
    /// The numbers of all imprints, sorted. They are kept because a filter is typed letter by letter, which does not
    /// change the order.
    order: Vec<u32>,
    /// Whether the filter keeps each imprint, by number; empty if it keeps all.
    kept: Vec<bool>,
    /// The numbers of the imprints that the filter keeps, sorted.
    rows: Vec<u32>,
    /// The index of the selected row.
    selected: usize,
    /// The index of the row that came first when the list was last used.
    top: usize,
}

impl ImprintList {
    /// Creates the list of imprints in this order, the most frequent one first.
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

    /// Returns the column that rows are sorted by, and the direction.
    pub fn sort_key(&self) -> (ListColumn, SortDirection) {
        self.sort
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

    /// Returns the chosen heading.
    pub fn heading(&self) -> ListColumn {
        self.heading
    }

    /// Chooses the heading `by` further on among the shown ones; at the ends it stays.
    pub fn move_heading(&mut self, by: i8, shown: &[ListColumn]) {
        let now = shown.iter().position(|&column| column == self.heading);
        let next = now.map_or(0, |now| now.saturating_add_signed(isize::from(by)));
        if let Some(&column) = shown.get(next.min(shown.len().saturating_sub(1))) {
            self.heading = column;
        }
    }

    /// Returns the filter of the rows, as it was typed; empty for none.
    pub fn filter(&self) -> &str {
        &self.filter
    }

    /// Keeps only the rows that pass a filter, given as it was typed and as it was read. The selected imprint stays
    /// selected if it is kept.
    pub fn keep(&mut self, typed: &str, filter: &AtlasFilter, atlas: &Atlas) {
        typed.trim().clone_into(&mut self.filter);
        self.kept = if filter.is_empty() {
            Vec::new()
        } else {
            filter.keeps(atlas)
        };
        self.apply_filter();
    }

    /// Returns true if the filter keeps an imprint.
    pub fn keeps(&self, id: u32) -> bool {
        let kept = self.kept.get(wide(id));
        kept.is_none_or(|&kept| kept)
    }

    /// Sorts and filters the rows; `values` are those of the chosen descriptor, by the imprints' numbers.
    pub fn arrange(&mut self, sweep: &SweepResult, values: &[Option<f64>]) {
        let (by, direction) = self.sort;
        self.order = by.order(sweep, values, direction);
        self.apply_filter();
    }

    /// Filters the rows, and keeps the selected imprint selected; if the filter removes it, a row at about the same
    /// place is selected.
    fn apply_filter(&mut self) {
        let selected = self.rows.get(self.selected).copied();
        let rows = self.order.iter().copied();
        self.rows = rows.filter(|&id| self.keeps(id)).collect();
        if !selected.is_some_and(|id| self.find(id)) {
            self.select(self.selected);
        }
    }

    /// Returns the number of rows in the list of imprints.
    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// Returns the numbers of the imprints in the list.
    pub fn rows(&self) -> impl Iterator<Item = u32> + '_ {
        self.rows.iter().copied()
    }

    /// Returns the index of the selected row.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// Selects a row by its index; an index too large selects the last one.
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

    /// Stores the first row of a list that shows `visible` rows.
    pub fn keep_first_row(&mut self, visible: usize) {
        self.top = self.first_row(visible);
    }

    /// Selects an imprint by its number. Returns false if the list does not have it.
    pub fn find(&mut self, id: u32) -> bool {
        let row = self.rows.iter().position(|&row| row == id);
        self.selected = row.unwrap_or(self.selected);
        row.is_some()
    }
}
