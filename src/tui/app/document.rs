//! What is on the matrix, what can be read off it, and its history.
//!
//! A [`Document`] is a sensor, what touched it, and the taxels set by hand since then. Everything else follows from it
//! and is a [`Reading`]. The [`History`] is a list of documents; it also knows where each came from, so that going back
//! restores the name, too.
//!
//! ```
//! use taxel::prelude::*;
//! use taxel::tui::app::document::{Document, History, Reading};
//!
//! let mut history = History::new(Document::empty(Sensor::default()));
//! let mut drawn = history.present().clone();
//! drawn.edits.toggle(3, 4);
//! history.push(drawn);
//! assert_eq!(Reading::of(history.present()).imprint.count(), 1);
//! assert!(history.undo() && history.present().edits.is_empty());
//! assert!(!history.undo(), "there is nothing before the first document");
//! ```

use crate::description::{Description, Region, main_region, regions};
use crate::formats::name::folded;
use crate::formats::{Name, StoredShape};
use crate::imprint::Imprint;
use crate::sensor::Sensor;
use crate::source::Source;
use crate::storage::ShapeOrigin;
use crate::touch::{Plane, reaches_beyond};

/// What is on the matrix. Plain and small, so that a list of earlier documents is the undo history.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The sensor.
    pub sensor: Sensor,
    /// What touched it; nothing on a matrix that is only drawn on.
    pub source: Option<Source>,
    /// The taxels switched by hand since then.
    pub edits: Imprint,
}

impl Document {
    /// An empty matrix.
    pub fn empty(sensor: Sensor) -> Self {
        Self {
            sensor,
            source: None,
            edits: Imprint::empty(sensor.columns(), sensor.rows()),
        }
    }

    /// A matrix touched by a figure or a picture.
    pub fn touched(sensor: Sensor, source: Source) -> Self {
        Self {
            source: Some(source),
            ..Self::empty(sensor)
        }
    }
}

impl Document {
    /// The document of a stored shape: touched by its source, and by hand what differs from that.
    pub fn of_shape(shape: &StoredShape) -> Self {
        let mut document = Self {
            source: shape.source.clone(),
            ..Self::empty(shape.sensor)
        };
        let touched = Reading::of(&document).imprint;
        document.edits = touched.differing(&shape.imprint);
        document
    }

    /// The shape to store under a name; `reading` is that of this document.
    pub fn to_shape(&self, name: Name, reading: &Reading) -> StoredShape {
        let imprint = reading.imprint;
        StoredShape {
            name,
            sensor: self.sensor,
            imprint,
            source: self.source.clone(),
        }
    }

    /// The same on another sensor. A source whose values this sensor does not allow becomes a drawing.
    #[must_use]
    pub fn on(&self, sensor: Sensor) -> Self {
        let allowed = |source: &Source| {
            let mut values = source
                .parameters()
                .iter()
                .filter_map(|&p| Some((p, source.get(p)?)));
            values.all(|(parameter, value)| sensor.check(parameter, value).is_ok())
        };
        let (columns, rows) = (sensor.columns(), sensor.rows());
        match &self.source {
            Some(source) if allowed(source) => Self {
                sensor,
                source: Some(source.clone()),
                edits: self.edits.resized(columns, rows),
            },
            _ => Self {
                sensor,
                source: None,
                edits: Reading::of(self).imprint.resized(columns, rows),
            },
        }
    }
}

/// What can be read off a document. Computed here and nowhere else, once per change: see [`ReadDocument`].
#[derive(Clone, Debug)]
pub struct Reading {
    /// The active taxels.
    pub imprint: Imprint,
    /// How much of each cell is covered, in reading order; none of a matrix that is only drawn on.
    pub coverages: Option<Vec<f64>>,
    /// Pieces and holes.
    pub regions: Vec<Region<'static>>,
    /// What is described unless another region was chosen.
    pub main: Option<usize>,
    /// Whether the source reaches beyond the sensor.
    pub beyond: bool,
}

impl Reading {
    /// What can be seen of a document.
    pub fn of(document: &Document) -> Self {
        let mut imprint = document.edits;
        let mut coverages = None;
        if let Some(source) = &document.source {
            let mut plane = Plane::new(document.sensor);
            let touched = plane.touch(source);
            imprint = imprint.differing(&touched);
            coverages = Some(plane.coverages());
        }
        let regions = regions(&imprint);
        let main = main_region(&regions);
        let beyond = document
            .source
            .as_ref()
            .is_some_and(|source| reaches_beyond(source, &document.sensor));
        Self {
            imprint,
            coverages,
            regions,
            main,
            beyond,
        }
    }

    /// How much of a cell is covered; none on a matrix that is only drawn on.
    pub fn coverage(&self, column: u8, row: u8) -> Option<f64> {
        let index = usize::from(row) * usize::from(self.imprint.columns()) + usize::from(column);
        self.coverages.as_ref()?.get(index).copied()
    }

    /// A region with its number, counted from 0: the chosen one where it exists, else the main one.
    pub fn region(&self, chosen: Option<usize>) -> Option<(usize, &Region<'_>)> {
        let index = chosen
            .filter(|&index| index < self.regions.len())
            .or(self.main)?;
        Some((index, self.regions.get(index)?))
    }

    /// Counts and sums of that region.
    pub fn description(&self, chosen: Option<usize>) -> Option<Description> {
        self.region(chosen)
            .map(|(_, region)| Description::of(region))
    }
}

/// A document with its reading: the only place where the screen keeps one.
#[derive(Clone, Debug)]
pub struct ReadDocument {
    /// What was read.
    document: Document,
    reading: Reading,
}

impl ReadDocument {
    /// Reads a document.
    pub fn new(document: Document) -> Self {
        Self {
            reading: Reading::of(&document),
            document,
        }
    }

    /// The document.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Its reading.
    pub fn reading(&self) -> &Reading {
        &self.reading
    }
}

/// Where documents come from: New, a loaded shape, a form. All states between two of these belong together, and know
/// under which name they are stored.
#[derive(Clone, Debug)]
pub struct DocumentOrigin {
    /// The name that the document was loaded from or stored under.
    pub name: Option<StoredName>,
    /// What would be found again: work that differs from it is unsaved.
    pub saved: Document,
}

/// Where a document is stored.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredName {
    /// The shape's name.
    pub name: String,
    /// What its file held when it was read or written last.
    pub stamp: u64,
    /// Whether the file is the user's.
    pub owner: ShapeOrigin,
}

/// A document and the number of its origin.
#[derive(Clone, Debug, PartialEq)]
struct Revision {
    /// The state itself.
    document: Document,
    /// The index of its origin in the list of the history.
    origin: usize,
}

/// A document with all its earlier and, after undoing, later states. Going back to one brings back its name too.
#[derive(Clone, Debug)]
pub struct History {
    /// Earlier states, the oldest first.
    past: Vec<Revision>,
    /// The state now.
    present: Revision,
    /// States that were undone, the next one last.
    future: Vec<Revision>,
    /// All origins; revisions refer to them by index.
    origins: Vec<DocumentOrigin>,
}

impl History {
    /// Begins with a document that there is nothing to save of.
    pub fn new(document: Document) -> Self {
        let origins = vec![DocumentOrigin {
            name: None,
            saved: document.clone(),
        }];
        Self {
            past: Vec::new(),
            present: Revision {
                document,
                origin: 0,
            },
            future: Vec::new(),
            origins,
        }
    }

    /// The document as it is now.
    pub fn present(&self) -> &Document {
        &self.present.document
    }

    /// Where it comes from.
    pub fn origin(&self) -> &DocumentOrigin {
        // The number is that of one in the list: only `begin` makes numbers.
        self.origins
            .get(self.present.origin)
            .unwrap_or(&self.origins[0])
    }

    /// A change. One that changes nothing leaves no trace.
    pub fn push(&mut self, document: Document) {
        if document != self.present.document {
            let origin = self.present.origin;
            self.replace(Revision { document, origin });
        }
    }

    /// A document that comes from somewhere else.
    pub fn begin(&mut self, document: Document, origin: DocumentOrigin) {
        self.origins.push(origin);
        self.replace(Revision {
            document,
            origin: self.origins.len() - 1,
        });
    }

    /// The present document is stored now; so it is found again.
    pub fn stored(&mut self, name: StoredName) {
        let saved = self.present.document.clone();
        if let Some(origin) = self.origins.get_mut(self.present.origin) {
            *origin = DocumentOrigin {
                name: Some(name),
                saved,
            };
        }
    }

    /// The stored shape of that name is gone: nothing would be found again of what came from it.
    pub fn removed(&mut self, name: &str) {
        let gone = folded(name);
        for origin in &mut self.origins {
            let own = origin.name.as_ref();
            let own = own.filter(|stored| stored.owner == ShapeOrigin::Own);
            if own.is_some_and(|stored| folded(&stored.name) == gone) {
                *origin = DocumentOrigin {
                    name: None,
                    saved: Document::empty(origin.saved.sensor),
                };
            }
        }
    }

    /// Whether something was drawn and left for a document from elsewhere without being saved: only undoing would bring
    /// it back. Of an empty matrix there is nothing to save.
    pub fn left_unsaved(&self) -> bool {
        let states = || self.past.iter().chain([&self.present]);
        states().zip(states().skip(1)).any(|(state, next)| {
            state.origin != next.origin
                && state.document != Document::empty(state.document.sensor)
                && (self.origins.get(state.origin))
                    .is_some_and(|origin| origin.saved != state.document)
        })
    }

    /// Amended until it was as before, a change is none, and leaves no trace either.
    fn drop_empty_step(&mut self) {
        let present = &self.present;
        self.past.pop_if(|past| *past == *present);
    }

    /// Makes a state the present one and the former one the last of the past.
    fn replace(&mut self, state: Revision) {
        self.drop_empty_step();
        self.past.push(std::mem::replace(&mut self.present, state));
        self.future.clear();
    }

    /// Goes on with the last change, which stays one change.
    pub fn amend(&mut self, document: Document) {
        self.present.document = document;
        self.future.clear();
    }

    /// Back by one change; false where there is none.
    pub fn undo(&mut self) -> bool {
        self.drop_empty_step();
        let Some(earlier) = self.past.pop() else {
            return false;
        };
        self.future
            .push(std::mem::replace(&mut self.present, earlier));
        true
    }

    /// Forth again by one change; false where there is none.
    pub fn redo(&mut self) -> bool {
        let Some(later) = self.future.pop() else {
            return false;
        };
        self.past.push(std::mem::replace(&mut self.present, later));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_that_is_amended_away_is_none() {
        let empty = Document::empty(Sensor::default());
        let mut drawn = empty.clone();
        drawn.edits.toggle(3, 4);
        let mut history = History::new(empty.clone());
        history.push(drawn.clone());
        history.amend(empty.clone());
        assert!(!history.undo(), "there is nothing to take back");
        // Nor does it stand between others, though the change may go on first.
        history.push(drawn.clone());
        history.amend(empty.clone());
        history.amend(drawn.clone());
        drawn.edits.toggle(5, 6);
        history.push(drawn.clone());
        history.amend(empty.clone());
        history.push(drawn);
        assert!(history.undo() && history.present() == &empty);
        assert!(history.undo() && history.present().edits.count() == 1);
        assert!(history.undo() && history.present() == &empty);
        assert!(!history.undo());
    }
}
