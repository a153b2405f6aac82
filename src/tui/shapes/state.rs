//! The state of the list of shapes: its purpose, the filter, the selected row, and the shapes that were read.
//!
//! Matches come in this order: the name itself, names that begin with the filter, names that contain it; each in the
//! order of the library. Shapes are read as they come into sight, so a large library opens at once.

use std::collections::{HashMap, HashSet};

use taxel_files::formats::name::{LONGEST, folded};
use taxel_files::storage::{LibraryEntry, LoadedShape, ShapeOrigin};

use crate::tui::app::message::Message;
use crate::tui::widget::text_field::TextField;

const AHEAD: usize = 64;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ListPurpose {
    Load,
    Delete,
    Picture,
}

#[derive(Clone, Debug)]
pub struct ListDialog {
    pub(super) purpose: ListPurpose,
    entries: Vec<LibraryEntry>,
    /// The names of the shapes that are left out because they cannot be deleted.
    undeletable: Vec<String>,
    filter: TextField,
    matching: Vec<usize>,
    selected: usize,
    read: HashMap<String, Result<LoadedShape, String>>,
    asked: HashSet<String>,
    pub(super) listed: bool,
}

impl ListDialog {
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
        }
    }

    /// Only the user's own shapes can be deleted.
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

    pub fn filter(&self) -> &str {
        self.filter.text()
    }

    /// Returns a shipped shape that would match the filter if it could be deleted.
    pub fn undeletable(&self) -> Option<&str> {
        let wanted = folded(self.filter());
        let mut fitting = self.undeletable.iter().map(String::as_str);
        fitting.find(|name| !wanted.is_empty() && folded(name).contains(&wanted))
    }

    pub fn total(&self) -> usize {
        self.entries.len()
    }

    pub fn rows(
        &self,
    ) -> impl ExactSizeIterator<Item = (&LibraryEntry, Option<&Result<LoadedShape, String>>)> {
        self.matching
            .iter()
            .map(|index| &self.entries[*index])
            .map(|entry| (entry, self.read.get(&entry.name)))
    }

    pub fn selected(&self) -> usize {
        self.selected
    }

    pub fn choice(&self) -> Option<(&LibraryEntry, Option<&Result<LoadedShape, String>>)> {
        self.rows().nth(self.selected)
    }

    pub fn select(&mut self, row: usize) {
        self.selected = row.min(self.matching.len().saturating_sub(1));
    }

    pub fn edit(&mut self, message: &Message) {
        if self.filter.take(message) {
            self.apply_filter();
        }
    }

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

    pub fn take(&mut self, read: Vec<(String, Result<LoadedShape, String>)>) {
        self.read.extend(read);
    }
}
