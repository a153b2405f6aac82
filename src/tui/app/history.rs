//! Every earlier and later state of the document, and where each comes from.

use taxel_core::parameter::Parameter;
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_core::source::Source;
use taxel_core::touch::Plane;
use taxel_files::formats::name::folded;
use taxel_files::formats::value::counted;
use taxel_files::storage::ShapeOrigin;

use crate::tui::app::document::Document;

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
        Self {
            brought_by: Some(brought_by.into()),
            ..self
        }
    }

    #[must_use]
    pub fn proposing(self, name: impl Into<String>) -> Self {
        Self {
            proposed: Some(name.into()),
            ..self
        }
    }

    #[must_use]
    pub fn loaded(self, name: StoredName) -> Self {
        Self {
            brought_by: Some(format!("{} loaded", name.name)),
            name: Some(name),
            ..self
        }
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

#[derive(Clone, Debug)]
struct Revision {
    document: Document,
    origin: usize,
    chosen: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StatePlace {
    Earlier,
    Present,
    Later,
}

/// A document of the history that would be lost with it.
#[derive(Clone, Copy, Debug)]
pub struct UnsavedState<'a> {
    pub document: &'a Document,
    pub origin: &'a DocumentOrigin,
    pub place: StatePlace,
}

/// Going back to a state brings back its name too.
#[derive(Clone, Debug)]
pub struct History {
    past: Vec<Revision>,
    present: Revision,
    future: Vec<Revision>,
    /// While the last change can go on: the states that could be redone before it. They can be redone again if the
    /// change comes to nothing.
    future_before: Option<Vec<Revision>>,
    pub(in crate::tui) origins: Vec<DocumentOrigin>,
}

impl History {
    pub fn new(document: Document) -> Self {
        let origins = vec![DocumentOrigin::of(&document)];
        Self {
            past: Vec::new(),
            present: Revision {
                document,
                origin: 0,
                chosen: None,
            },
            future: Vec::new(),
            future_before: None,
            origins,
        }
    }

    pub fn present(&self) -> &Document {
        &self.present.document
    }

    pub fn chosen(&self) -> Option<usize> {
        self.present.chosen
    }

    /// Chooses a region of the present document. It stays chosen on the documents after it.
    pub fn choose(&mut self, region: Option<usize>) {
        self.present.chosen = region;
    }

    pub fn origin(&self) -> &DocumentOrigin {
        // The index is in the list: only `begin` makes indices.
        self.origins
            .get(self.present.origin)
            .unwrap_or(&self.origins[0])
    }

    /// Returns true if a document of this name was loaded or saved since the start of the program.
    pub fn knows(&self, name: &str) -> bool {
        let names = self.origins.iter().filter_map(|own| own.name.as_ref());
        names
            .map(|own| folded(&own.name))
            .any(|own| own == folded(name))
    }

    pub fn begun(&self) -> &Document {
        let past = self.past.iter().rev();
        let own = past.take_while(|state| state.origin == self.present.origin);
        own.last().map_or(self.present(), |state| &state.document)
    }

    /// A change that changes nothing leaves no trace.
    pub fn push(&mut self, document: Document) {
        if document != self.present.document {
            self.replace(document, self.present.origin);
        }
    }

    pub fn begin(&mut self, document: Document, origin: DocumentOrigin) {
        self.origins.push(origin);
        self.replace(document, self.origins.len() - 1);
    }

    /// Adds a document that is stored nowhere and comes from an earlier run. Drops the states before it if nothing is
    /// lost by that: undo would go back to them, and quitting there without a question would lose the document.
    pub fn resume(&mut self, document: Document, origin: DocumentOrigin) {
        self.begin(document, origin);
        let is_earlier = |state: UnsavedState| state.place == StatePlace::Earlier;
        if !self.unsaved().any(is_earlier) {
            self.past.clear();
        }
    }

    pub(crate) fn origin_index(&self) -> usize {
        self.present.origin
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
        let gone = folded(name);
        for origin in &mut self.origins {
            let own = origin.name.as_ref();
            let own = own.filter(|stored| stored.owner == ShapeOrigin::Own);
            if own.is_some_and(|stored| folded(&stored.name) == gone) {
                origin.name = None;
                origin.saved = Document::empty(origin.saved.sensor);
            }
        }
    }

    /// Returns the documents that would be lost, in the order of the history. Of the states of one origin, the last
    /// one counts. Where the present document comes from the same origin, that one counts: what was undone on it was
    /// given up. An empty matrix does not count as a state of a document, so what undo took off it would be lost.
    pub fn unsaved(&self) -> impl Iterator<Item = UnsavedState<'_>> {
        let present = &self.present;
        let at = |place| move |state| (state, place);
        let earlier = self.past.iter().map(at(StatePlace::Earlier));
        let later = self.later().map(at(StatePlace::Later));
        let now = [(present, StatePlace::Present)];
        let mut states = earlier.chain(now).chain(later).peekable();
        std::iter::from_fn(move || {
            let (state, place) = states.next()?;
            let next = states.peek().map(|(next, _)| next.origin);
            Some((state, place, next != Some(state.origin)))
        })
        .filter(|(state, place, is_last)| match place {
            StatePlace::Earlier => *is_last,
            StatePlace::Present => true,
            StatePlace::Later => {
                *is_last && (state.origin != present.origin || present.document.is_empty())
            }
        })
        .filter_map(|(state, place, _)| {
            let (document, origin) = (&state.document, self.origins.get(state.origin)?);
            origin.would_lose(document).then_some(UnsavedState {
                document,
                origin,
                place,
            })
        })
    }

    fn later(&self) -> impl Iterator<Item = &Revision> {
        let before = self.future_before.as_ref();
        let future = before.filter(|_| self.last_step_is_empty());
        future.unwrap_or(&self.future).iter().rev()
    }

    fn last_step_is_empty(&self) -> bool {
        let Revision {
            document, origin, ..
        } = &self.present;
        let last = self.past.last();
        last.is_some_and(|past| past.document == *document && past.origin == *origin)
    }

    /// What could be redone before it can be redone again.
    fn drop_empty_step(&mut self) {
        if self.last_step_is_empty()
            && let Some(future) = self.future_before.take()
        {
            self.past.pop();
            self.future = future;
        }
    }

    fn replace(&mut self, document: Document, origin: usize) {
        self.drop_empty_step();
        let chosen = self.present.chosen;
        let state = Revision {
            document,
            origin,
            chosen,
        };
        self.past.push(std::mem::replace(&mut self.present, state));
        self.future_before = Some(std::mem::take(&mut self.future));
    }

    /// Continues the last change, which stays one change. If it came to nothing and was dropped, or after undo and
    /// redo, this is a new change.
    pub fn amend(&mut self, document: Document) {
        match self.future_before {
            Some(_) => self.present.document = document,
            None => self.push(document),
        }
    }

    pub fn undo(&mut self) -> Option<String> {
        self.drop_empty_step();
        let earlier = self.past.pop()?;
        let undone = self.step(&earlier, &self.present);
        let left = self.travel(earlier);
        self.future.push(left);
        Some(undone)
    }

    pub fn can_undo(&self) -> bool {
        let dropped = self.future_before.is_some() && self.last_step_is_empty();
        self.past.len() > usize::from(dropped)
    }

    pub fn redo(&mut self) -> Option<String> {
        self.drop_empty_step();
        let later = self.future.pop()?;
        let redone = self.step(&self.present, &later);
        let left = self.travel(later);
        self.past.push(left);
        Some(redone)
    }

    /// The region that was chosen there is chosen again; if none was, the choice stays.
    fn travel(&mut self, mut state: Revision) -> Revision {
        self.future_before = None;
        state.chosen = state.chosen.or(self.present.chosen);
        std::mem::replace(&mut self.present, state)
    }

    fn step(&self, from: &Revision, to: &Revision) -> String {
        let origin = self.origins.get(to.origin);
        let brought_by = origin.and_then(|origin| origin.brought_by.clone());
        let brought_by = brought_by.filter(|_| from.origin != to.origin);
        brought_by.unwrap_or_else(|| difference(&from.document, &to.document))
    }

    pub fn steps(&mut self) -> (Vec<String>, usize) {
        self.drop_empty_step();
        let later = self.future.iter().rev();
        let states = || self.past.iter().chain([&self.present]).chain(later.clone());
        let steps = states().zip(states().skip(1));
        let steps = steps.map(|(from, to)| self.step(from, to)).collect();
        (steps, self.past.len())
    }

    pub fn start(&self) -> Option<&str> {
        let oldest = self.past.first().unwrap_or(&self.present);
        self.origins.get(oldest.origin)?.brought_by.as_deref()
    }

    pub fn before(&self) -> Option<&Document> {
        let past = self.past.iter().rev();
        let mut others = past.filter(|state| state.document != self.present.document);
        others.next().map(|state| &state.document)
    }

    pub fn after(&self, step: usize) -> Option<&Document> {
        let later = self.future.iter().rev();
        let mut states = self.past.iter().chain([&self.present]).chain(later);
        states.nth(step).map(|state| &state.document)
    }

    pub fn go_to(&mut self, step: usize) {
        while self.past.len() > step && self.undo().is_some() {}
        while self.past.len() < step && self.redo().is_some() {}
    }
}

pub fn difference(from: &Document, to: &Document) -> String {
    let sensor = of_sensor(&from.sensor, &to.sensor);
    let mut parts = vec![sensor, of_source(from.source.as_ref(), to.source.as_ref())];
    let fits = from.edits.columns() == to.edits.columns() && from.edits.rows() == to.edits.rows();
    if parts.iter().all(String::is_empty) && is_emptied(from, to) {
        parts.push("emptied".to_owned());
    }
    // A new source starts without edits, so this is not mentioned.
    if fits && parts.iter().all(String::is_empty) {
        parts.push(of_edits(from, to));
    }
    parts.retain(|part| !part.is_empty());
    parts.join(", ")
}

fn is_emptied(from: &Document, to: &Document) -> bool {
    let is_empty = to.source.is_none() && to.edits.is_empty();
    is_empty && (from.source.is_some() || from.edits.count() > 1)
}

fn of_sensor(from: &Sensor, to: &Sensor) -> String {
    let value = |sensor: &Sensor, parameter| sensor.get(parameter);
    values(SENSOR_PARAMETERS, |p| value(from, p), |p| value(to, p))
}

/// Returns the changes of the source: its values if it is the same kind of figure or the same picture, otherwise the
/// whole new source. Empty if there is no source any more.
fn of_source(from: Option<&Source>, to: Option<&Source>) -> String {
    match (from, to) {
        (_, None) => String::new(),
        (Some(from), Some(to)) if alike(from, to) => {
            values(to.parameters(), |p| from.get(p), |p| to.get(p))
        }
        (_, Some(to)) => to.to_string(),
    }
}

fn alike(from: &Source, to: &Source) -> bool {
    match (from, to) {
        (Source::Figure(from), Source::Figure(to)) => from.kind() == to.kind(),
        (Source::Picture(from), Source::Picture(to)) => from.imprint() == to.imprint(),
        _ => false,
    }
}

fn values(
    parameters: &[Parameter],
    from: impl Fn(Parameter) -> Option<f64>,
    to: impl Fn(Parameter) -> Option<f64>,
) -> String {
    let text = |parameter: Parameter, value: Option<f64>| {
        value.map_or("none".to_owned(), |value| parameter.format(value))
    };
    let changed = parameters.iter().filter(|&&p| from(p) != to(p));
    let changed = changed.map(|&parameter| {
        let (before, after) = (from(parameter), to(parameter));
        let label = parameter.row().label;
        format!(
            "{label} {} → {}",
            text(parameter, before),
            text(parameter, after)
        )
    });
    changed.collect::<Vec<_>>().join(", ")
}

fn of_edits(from: &Document, to: &Document) -> String {
    let switched = from.edits.differing(&to.edits);
    match (switched.count(), switched.active().next()) {
        (0, _) | (_, None) => String::new(),
        (1, Some((column, row))) => {
            let touched = to.source.as_ref().is_some_and(|source| {
                let touched = Plane::new(to.sensor).touch(source);
                touched.get(column, row)
            });
            let is_on = touched != to.edits.get(column, row);
            let state = if is_on { "on" } else { "off" };
            format!("taxel {column}, {row} {state}")
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
