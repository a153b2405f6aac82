//! Every earlier and later state of the document, and where each comes from.

use taxel_core::parameter::Parameter;
use taxel_core::sensor::SENSOR_PARAMETERS;
use taxel_files::formats::name::folded;
use taxel_files::formats::value::counted;
use taxel_files::storage::ShapeOrigin;

use crate::tui::app::{Document, Reading};

/// All states from one origin to the next belong together, and share the name that they are stored under.
#[derive(Clone, Debug)]
pub struct DocumentOrigin {
    /// Saving under another name does not change it.
    pub brought_by: Option<String>,
    pub proposed: Option<String>,
    pub name: Option<StoredName>,
    /// The document that is not lost: as it was loaded, saved or begun. An empty one if all of it would be lost.
    pub saved: Document,
}

impl DocumentOrigin {
    pub fn of(document: &Document) -> Self {
        Self {
            brought_by: None,
            proposed: None,
            name: None,
            saved: document.clone(),
        }
    }

    /// Returns the origin of a document that is stored nowhere: all of it would be lost.
    pub fn unsaved(document: &Document) -> Self {
        Self::of(&Document::empty(document.sensor))
    }

    #[must_use]
    pub fn called(self, brought_by: impl Into<String>) -> Self {
        let brought_by = Some(brought_by.into());
        Self { brought_by, ..self }
    }

    /// Returns true if a document of this origin is unsaved work, which would be lost. An empty document has nothing
    /// to lose.
    pub fn would_lose(&self, document: &Document) -> bool {
        !document.is_empty() && *document != self.saved
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredName {
    pub name: String,
    pub stamp: u64,
    pub owner: ShapeOrigin,
}

impl StoredName {
    pub fn is_own(&self) -> bool {
        self.owner == ShapeOrigin::Own
    }
}

#[derive(Clone, Debug)]
struct State {
    document: Document,
    origin: usize,
    /// The region that is chosen, also on the documents after it.
    chosen: Option<usize>,
}

/// Going back to a state brings back its name too.
#[derive(Clone, Debug)]
pub struct History {
    states: Vec<State>,
    present: usize,
    /// Whether the last change can go on.
    goes_on: bool,
    pub(crate) origins: Vec<DocumentOrigin>,
}

impl History {
    pub fn new(document: Document) -> Self {
        Self {
            origins: vec![DocumentOrigin::of(&document)],
            states: vec![State {
                document,
                origin: 0,
                chosen: None,
            }],
            present: 0,
            goes_on: false,
        }
    }

    fn until_now(&self) -> &[State] {
        &self.states[..=self.present]
    }

    pub fn present(&self) -> &Document {
        &self.states[self.present].document
    }

    pub fn chosen(&self) -> Option<usize> {
        self.states[self.present].chosen
    }

    pub fn choose(&mut self, region: Option<usize>) {
        self.states[self.present].chosen = region;
    }

    pub(crate) fn origin_index(&self) -> usize {
        self.states[self.present].origin
    }

    pub fn origin(&self) -> &DocumentOrigin {
        &self.origins[self.origin_index()]
    }

    /// Whether a document of this name was loaded or saved since the start of the program.
    pub fn knows(&self, name: &str) -> bool {
        let mut names = self.origins.iter().filter_map(|own| own.name.as_ref());
        names.any(|own| folded(&own.name) == folded(name))
    }

    /// The document with which the present one began.
    pub fn begun(&self) -> &Document {
        let mut runs = self
            .until_now()
            .chunk_by(|state, next| state.origin == next.origin);
        runs.next_back()
            .map_or(self.present(), |own| &own[0].document)
    }

    /// A change that changes nothing leaves no trace.
    pub fn push(&mut self, document: Document) {
        if document != *self.present() {
            self.add(document, self.origin_index());
        }
    }

    pub fn begin(&mut self, document: Document, origin: DocumentOrigin) {
        self.origins.push(origin);
        self.add(document, self.origins.len() - 1);
    }

    /// Adds a document that is stored nowhere and comes from an earlier run. Drops the states before it if nothing is
    /// lost by that: undo would go back to them, and quitting there without a question would lose the document.
    pub fn resume(&mut self, document: Document, origin: DocumentOrigin) {
        self.begin(document, origin);
        if self.unsaved().count() < 2 {
            self.states.drain(..self.present);
            self.present = 0;
        }
    }

    fn add(&mut self, document: Document, origin: usize) {
        let chosen = self.chosen();
        self.present += 1;
        self.states.truncate(self.present);
        self.states.push(State {
            document,
            origin,
            chosen,
        });
        self.goes_on = true;
    }

    /// Continues the last change, which stays one change, or leaves no trace once it has come to nothing; after undo
    /// and redo, this is a new change.
    pub fn amend(&mut self, document: Document) {
        match self.until_now() {
            _ if !self.goes_on => self.push(document),
            [.., before, now] if before.document == document && before.origin == now.origin => {
                self.states[self.present - 1].chosen = now.chosen;
                self.states.remove(self.present);
                self.present -= 1;
                self.goes_on = false;
            }
            _ => self.states[self.present].document = document,
        }
    }

    /// Notes that a document of that origin is stored now, so that it can be found again.
    pub fn stored(&mut self, origin: usize, saved: Document, name: StoredName) {
        if let Some(origin) = self.origins.get_mut(origin) {
            origin.name = Some(name);
            origin.saved = saved;
        }
    }

    /// Notes that the stored shape of that name is gone: everything that came from it would be lost.
    pub fn removed(&mut self, name: &str) {
        for origin in &mut self.origins {
            let own = origin.name.as_ref();
            if own.is_some_and(|own| own.is_own() && folded(&own.name) == folded(name)) {
                origin.name = None;
                origin.saved = Document::empty(origin.saved.sensor);
            }
        }
    }

    /// The documents that would be lost, the present one last. Of the states of one origin the last one counts; what
    /// was undone was given up.
    pub fn unsaved(&self) -> impl Iterator<Item = (&Document, &DocumentOrigin)> {
        let runs = self
            .until_now()
            .chunk_by(|state, next| state.origin == next.origin);
        let last = runs.filter_map(<[State]>::last);
        let last = last.map(|state| (&state.document, &self.origins[state.origin]));
        last.filter(|(document, origin)| origin.would_lose(document))
    }

    pub fn undo(&mut self) -> Option<String> {
        let earlier = self.present.checked_sub(1)?;
        let undone = self.step(earlier);
        self.go_to(earlier);
        Some(undone)
    }

    pub fn can_undo(&self) -> bool {
        self.present > 0
    }

    pub fn redo(&mut self) -> Option<String> {
        let later = self.present + 1;
        let redone = (later < self.states.len()).then(|| self.step(self.present))?;
        self.go_to(later);
        Some(redone)
    }

    /// The region that was chosen there is chosen again; if none was, the choice stays.
    fn go_to(&mut self, state: usize) {
        let chosen = self.chosen();
        self.present = state;
        self.goes_on = false;
        let state = &mut self.states[self.present];
        state.chosen = state.chosen.or(chosen);
    }

    /// What led from this state to the next, in words.
    fn step(&self, state: usize) -> String {
        let (from, to) = (&self.states[state], &self.states[state + 1]);
        let brought_by = self.origins[to.origin].brought_by.clone();
        let brought_by = brought_by.filter(|_| from.origin != to.origin);
        brought_by.unwrap_or_else(|| difference(&from.document, &to.document))
    }

    pub fn before(&self) -> Option<&Document> {
        let mut past = self.until_now().iter().rev().map(|state| &state.document);
        past.find(|document| *document != self.present())
    }
}

/// What changed from one document to the next, in words.
pub fn difference(from: &Document, to: &Document) -> String {
    let mut changes = Vec::new();
    let mut add = |parameter: Parameter, before: Option<f64>, after: Option<f64>| {
        if before != after {
            let text = |value| match value {
                Some(value) => parameter.format(value),
                None => "none".to_owned(),
            };
            let (label, before, after) = (parameter.row().label, text(before), text(after));
            changes.push(format!("{label} {before} → {after}"));
        }
    };
    for &own in SENSOR_PARAMETERS {
        add(own, from.sensor.get(own), to.sensor.get(own));
    }
    match (&from.source, &to.source) {
        (_, None) => {}
        (Some(from), Some(to)) if from.is_alike(to) => {
            for &own in to.parameters() {
                add(own, from.get(own), to.get(own));
            }
        }
        (_, Some(to)) => changes.push(to.to_string()),
    }
    // A new source starts without edits, so this is not mentioned.
    if changes.is_empty() {
        changes.push(edits(from, to));
    }
    changes.join(", ")
}

fn edits(from: &Document, to: &Document) -> String {
    let switched = from.edits.differing(&to.edits);
    match (switched.count(), switched.active().next()) {
        (count, _) if to.is_empty() && (from.source.is_some() || count > 1) => "emptied".to_owned(),
        (1, Some((column, row))) => {
            let is_on = Reading::of(to).imprint.get(column, row);
            format!("taxel {column}, {row} {}", if is_on { "on" } else { "off" })
        }
        (count, _) => format!("{} switched", counted(count, "taxel")),
    }
}

#[cfg(test)]
mod tests {
    use taxel_core::sensor::Sensor;

    use super::*;

    #[test]
    fn a_change_that_is_amended_to_nothing_leaves_no_step() {
        let empty = Document::empty(Sensor::default());
        let mut drawn = empty.clone();
        drawn.edits.toggle(3, 4);
        let mut history = History::new(empty.clone());
        history.push(drawn.clone());
        history.amend(empty.clone());
        assert!(history.undo().is_none(), "there is nothing to take back");
        // Nor does an empty step stay between others, though the change may first go on.
        history.push(drawn.clone());
        history.amend(empty.clone());
        history.amend(drawn.clone());
        drawn.edits.toggle(5, 6);
        history.push(drawn.clone());
        history.amend(empty.clone());
        history.push(drawn);
        assert!(history.undo().is_some() && history.present() == &empty);
        assert!(history.undo().is_some() && history.present().edits.count() == 1);
        assert!(history.undo().is_some() && history.present() == &empty);
        assert!(history.undo().is_none());
    }
}
