//! The state of the list of shapes: what it is for, the filter, the selected row, and the shapes that were read.
//!
//! Matches come in this order: the name itself, names that begin with the filter, names that contain it; each in the
//! order of the library. Shapes are read as they come into sight, so a large library opens at once.

use std::collections::HashMap;

use crate::formats::name::{LONGEST, folded};
use crate::storage::{LibraryEntry, LoadedShape, ShapeOrigin};
use crate::tui::app::message::{Message, Purpose};
use crate::tui::widget::text_field::TextField;

/// The number of shapes that are read at once before and after the selected one: more than any screen shows.
const AHEAD: usize = 64;

/// The list.
#[derive(Clone, Debug)]
pub struct ListDialog {
    /// What a shape is chosen for.
    purpose: Purpose,
    /// All shapes of the list.
    entries: Vec<LibraryEntry>,
    /// What was typed.
    filter: TextField,
    /// The entries that the filter leaves, by their place in `entries`.
    matching: Vec<usize>,
    /// The index of the selected row among them.
    selected: usize,
    /// The content of shapes that were read, by index in `entries`.
    read: HashMap<usize, Result<LoadedShape, String>>,
}

impl ListDialog {
    /// The list of a library. Only the user's own shapes can be removed.
    pub fn new(purpose: Purpose, mut entries: Vec<LibraryEntry>) -> Self {
        if purpose == Purpose::Delete {
            entries.retain(|entry| entry.origin == ShapeOrigin::Own);
        }
        let mut list = Self {
            purpose,
            entries,
            filter: TextField::new("", LONGEST),
            matching: Vec::new(),
            selected: 0,
            read: HashMap::new(),
        };
        list.sift();
        list
    }

    /// What a shape is chosen for.
    pub fn purpose(&self) -> Purpose {
        self.purpose
    }

    /// What was typed.
    pub fn filter(&self) -> &str {
        self.filter.text()
    }

    /// How many shapes there are without the filter.
    pub fn total(&self) -> usize {
        self.entries.len()
    }

    /// The shapes that the filter leaves, with their content where it was read.
    pub fn rows(
        &self,
    ) -> impl ExactSizeIterator<Item = (&LibraryEntry, Option<&Result<LoadedShape, String>>)> {
        self.matching
            .iter()
            .map(|index| (&self.entries[*index], self.read.get(index)))
    }

    /// Which of these rows is selected.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// The selected shape.
    pub fn choice(&self) -> Option<(&LibraryEntry, Option<&Result<LoadedShape, String>>)> {
        self.rows().nth(self.selected)
    }

    /// Selects the row this many further on; negative goes back.
    pub fn go(&mut self, lines: i16) {
        self.select(self.selected.saturating_add_signed(isize::from(lines)));
    }

    /// Selects a row, or the last one.
    pub fn select(&mut self, row: usize) {
        self.selected = row.min(self.matching.len().saturating_sub(1));
    }

    /// Types or deletes in the filter, where that is what a message means.
    pub fn edit(&mut self, message: &Message) {
        if self.filter.take(message) {
            self.sift();
        }
    }

    /// Applies the filter; the best match is selected.
    fn sift(&mut self) {
        let wanted = folded(self.filter());
        // The name itself, names that begin with what was typed, names that have it somewhere.
        let rank = |entry: &LibraryEntry| {
            let name = folded(&entry.name);
            let at = name.find(&wanted)?;
            Some(match at {
                _ if wanted.is_empty() => 0,
                0 if name == wanted => 1,
                0 => 2,
                _ => 3,
            })
        };
        let ranked = self.entries.iter().map(rank).zip(0..);
        let mut ranked: Vec<(u8, usize)> = ranked
            .filter_map(|(rank, index)| Some((rank?, index)))
            .collect();
        ranked.sort_unstable();
        self.matching = ranked.into_iter().map(|(_, index)| index).collect();
        self.selected = 0;
    }

    /// The shapes in sight that were not read yet, by their place in the list.
    pub fn unread(&self) -> Vec<(usize, String)> {
        let first = self.selected.saturating_sub(AHEAD);
        let near = self.matching.iter().skip(first).take(2 * AHEAD);
        near.filter(|index| !self.read.contains_key(index))
            .map(|&index| (index, self.entries[index].name.clone()))
            .collect()
    }

    /// Takes the content of shapes, by their place in the list.
    pub fn take(&mut self, read: Vec<(usize, Result<LoadedShape, String>)>) {
        self.read.extend(read);
    }
}
