//! The log of the stored shapes that the program has used, for a recorded script that does the same again elsewhere.
//!
//! A shape is used when its imprint is shown, loaded, compared, or in the way of another one. A list shows only the
//! names of the others: these are logged as shapes without an active taxel, so that a list has the same rows again.

use std::collections::HashMap;
use std::fmt;

use crate::formats::{Name, StoredShape};
use crate::imprint::Imprint;
use crate::sensor::{MatrixSize, Sensor};
use crate::storage::{LibraryEntry, LoadedShape, ShapeOrigin};
use crate::tui::app::library::LibraryEvent;

/// A receiver of the logged shapes. A shape replaces an earlier one of the same name.
pub type ShapeSink = Box<dyn FnMut(StoredShape)>;

/// The shapes logged so far, and their receiver.
#[derive(Default)]
pub(in crate::tui::runtime) struct ShapeLog {
    sink: Option<ShapeSink>,
    /// The stamp of each shape's file by its name; None where only the name was needed.
    logged: HashMap<String, Option<u64>>,
}

impl fmt::Debug for ShapeLog {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ShapeLog")
            .field("logged", &self.logged)
            .finish_non_exhaustive()
    }
}

impl ShapeLog {
    /// Returns a log that gives its shapes to `sink`.
    pub(in crate::tui::runtime) fn of(sink: ShapeSink) -> Self {
        Self {
            sink: Some(sink),
            logged: HashMap::new(),
        }
    }

    /// Logs the shapes that were read in the library.
    pub(in crate::tui::runtime) fn event(&mut self, event: &LibraryEvent) {
        match event {
            LibraryEvent::List(Ok(entries)) => self.list(entries),
            LibraryEvent::Read(read) => {
                let loaded = read.iter().filter_map(|(_, loaded)| loaded.as_ref().ok());
                loaded.for_each(|loaded| self.shape(loaded));
            }
            LibraryEvent::Named(_, Ok(loaded)) => self.shape(loaded),
            _ => {}
        }
    }

    /// Logs the names of a list. Shapes that come with the program are left out: they are there anyway.
    fn list(&mut self, entries: &[LibraryEntry]) {
        let Some(sink) = &mut self.sink else { return };
        let own = entries.iter();
        for entry in own.filter(|entry| entry.origin == ShapeOrigin::Own) {
            if let Ok(name) = Name::new(&entry.name)
                && !self.logged.contains_key(&entry.name)
            {
                self.logged.insert(entry.name.clone(), None);
                sink(StoredShape {
                    name,
                    sensor: Sensor::of_size(MatrixSize::SMALLEST),
                    imprint: Imprint::empty(MatrixSize::SMALLEST),
                    source: None,
                });
            }
        }
    }

    /// Notes a shape that the program has stored itself, without logging it: a replay stores it again.
    pub(in crate::tui::runtime) fn stored(&mut self, name: &str, stamp: u64) {
        if self.sink.is_some() {
            self.logged.insert(name.to_owned(), Some(stamp));
        }
    }

    /// Logs a shape that was read.
    pub(in crate::tui::runtime) fn shape(&mut self, loaded: &LoadedShape) {
        let Some(sink) = &mut self.sink else { return };
        if loaded.origin != ShapeOrigin::Own {
            return;
        }
        let name = loaded.shape.name.to_string();
        let before = self.logged.insert(name, Some(loaded.stamp));
        if before.flatten() != Some(loaded.stamp) {
            sink(loaded.shape.clone());
        }
    }
}
