//! The list of imprints of a sweep: its order, its filter, the selected row and the first one on the screen.

use crate::atlas::{Atlas, AtlasFilter, SortDirection};
use crate::index::wide;
use crate::sweep::SweepResult;
use crate::tui::explore::column::ListColumn;

#[derive(Clone, Debug)]
pub struct ImprintList {
    sort: (ListColumn, SortDirection),
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
