//! The state of the list of shapes: its purpose, the filter, the selected row, and the shapes that were read.
//!
//! Matches come in this order: the name itself, names that begin with the filter, names that contain it; each in the
//! order of the library. Shapes are read as they come into sight, so a large library opens at once.

use std::collections::{HashMap, HashSet};

use crate::formats::name::{LONGEST, folded};
use crate::storage::{LibraryEntry, LoadedShape, ShapeOrigin};
use crate::tui::app::message::Message;
use crate::tui::widget::text_field::TextField;

/// The number of shapes that are read at once before and after the selected one: more than any screen shows.
const AHEAD: usize = 64;

/// The purpose for which a shape of the list is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListPurpose {
    /// The shape is put onto the matrix.
    Load,
    /// The shape is deleted.
    Delete,
    /// The shape is placed as a picture.
    Picture,
}

/// The page with the list of shapes.
#[derive(Clone, Debug)]
pub struct ListDialog {
    /// The purpose for which a shape is chosen.
    purpose: ListPurpose,
    /// All shapes of the list.
    entries: Vec<LibraryEntry>,
    /// The names of the shapes that are left out because they cannot be deleted.
    undeletable: Vec<String>,
    /// The typed filter.
    filter: TextField,
    /// The entries that match the filter, as indices into `entries`.
    matching: Vec<usize>,
    /// The index of the selected row in `matching`.
    selected: usize,
    /// The content of shapes that were read, by name.
    read: HashMap<String, Result<LoadedShape, String>>,
    /// The names of the shapes whose content was asked for.
    asked: HashSet<String>,
    /// Whether the shapes of the list are known.
    listed: bool,
    /// Whether the selected shape is taken as soon as it has been read.
    accepted: bool,
}

impl ListDialog {
    /// Returns a list that waits for the library.
    pub fn new(purpose: ListPurpose) -> Self {
        Self {
            purpose,
            entries: Vec::new(),
            undeletable: Vec::new(),
            filter: TextField::new("", LONGEST),
            matching: Vec::new(),
            selected: 0,
            read: HashMap::new(),
            asked: HashSet::new(),
            listed: false,
            accepted: false,
        }
    }

    /// Takes the shapes of the library, once, and applies the filter that was typed meanwhile. Only the user's own
    /// shapes can be deleted.
    pub fn fill(&mut self, mut entries: Vec<LibraryEntry>) {
        if self.listed {
            return;
        }
        if self.purpose == ListPurpose::Delete {
            let shipped = entries.extract_if(.., |entry| entry.origin != ShapeOrigin::Own);
            self.undeletable = shipped.map(|entry| entry.name).collect();
        }
        self.entries = entries;
        self.listed = true;
        self.apply_filter();
    }

    /// Returns true if the shapes of the list are known.
    pub fn is_listed(&self) -> bool {
        self.listed
    }

    /// Notes whether the selected shape is to be taken as soon as it has been read.
    pub fn accept(&mut self, accepted: bool) {
        self.accepted = accepted;
    }

    /// Returns true if the selected shape is to be taken and has been read.
    pub fn is_accepted(&self) -> bool {
        self.accepted && self.choice().is_some_and(|(_, read)| read.is_some())
    }

    /// Returns the purpose for which a shape is chosen.
    pub fn purpose(&self) -> ListPurpose {
        self.purpose
    }

    /// Returns the typed filter.
    pub fn filter(&self) -> &str {
        self.filter.text()
    }

    /// Returns a shipped shape that would match the filter if it could be deleted.
    pub fn undeletable(&self) -> Option<&str> {
        let wanted = folded(self.filter());
        let mut fitting = self.undeletable.iter().map(String::as_str);
        fitting.find(|name| !wanted.is_empty() && folded(name).contains(&wanted))
    }

    /// Returns the number of shapes without the filter.
    pub fn total(&self) -> usize {
        self.entries.len()
    }

    /// Returns the shapes that match the filter, with their content if it was read.
    pub fn rows(
        &self,
    ) -> impl ExactSizeIterator<Item = (&LibraryEntry, Option<&Result<LoadedShape, String>>)> {
        self.matching
            .iter()
            .map(|index| &self.entries[*index])
            .map(|entry| (entry, self.read.get(&entry.name)))
    }

    /// Returns the index of the selected row.
    pub fn selected(&self) -> usize {
        self.selected
    }

    /// Returns the selected shape, with its content if it was read.
    pub fn choice(&self) -> Option<(&LibraryEntry, Option<&Result<LoadedShape, String>>)> {
        self.rows().nth(self.selected)
    }

    /// Selects a row, or the last one if it lies beyond.
    pub fn select(&mut self, row: usize) {
        self.selected = row.min(self.matching.len().saturating_sub(1));
    }

    /// Types or deletes in the filter, if the message does that.
    pub fn edit(&mut self, message: &Message) {
        if self.filter.take(message) {
            self.apply_filter();
        }
    }

    /// Applies the filter; the best match is selected.
    fn apply_filter(&mut self) {
        let wanted = folded(self.filter());
        // The order: the name itself, names that begin with the typed filter, names that contain it.
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

    /// Returns the names of the shapes near the selected one that were not asked for yet, and notes them as asked
    /// for.
    pub fn ask(&mut self) -> Vec<String> {
        let first = self.selected.saturating_sub(AHEAD);
        let near = self.matching.iter().skip(first).take(2 * AHEAD);
        let near = near.map(|&index| &self.entries[index].name);
        let unread: Vec<String> = near
            .filter(|name| !self.asked.contains(*name))
            .cloned()
            .collect();
        self.asked.extend(unread.iter().cloned());
        unread
    }

    /// Takes the content of shapes, by name.
    pub fn take(&mut self, read: Vec<(String, Result<LoadedShape, String>)>) {
        self.read.extend(read);
    }
}
