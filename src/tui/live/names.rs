//! The sets of shapes that name imprints: the one in use, the step to the next one, and the one that returns if a set
//! cannot be read.

use crate::imprint::Imprint;
use crate::recognition::Noise;
use crate::storage::ModelChoice;
use crate::tui::live::naming::{NamedImprint, Naming, NamingRequest};
use crate::tui::live::request::WatchRequest;
use crate::tui::widget::number::other;

#[derive(Clone, Debug)]
pub struct ShapeNames {
    /// The set that was requested with the source; None if none was.
    asked: Option<ModelChoice>,
    /// The noise: how often a taxel flips.
    noise: Option<Noise>,
    /// The model that names imprints, and its last answer; None if imprints are not named.
    naming: Option<Naming>,
    /// The set that returns if the next one cannot be read; None if imprints were not named.
    before: Option<ModelChoice>,
    /// The set that could not be read last: the next step through the sets goes on from there.
    unreadable: Option<ModelChoice>,
    pub awaits_models: bool,
}

impl ShapeNames {
    pub fn new(request: &WatchRequest, number: u64) -> Self {
        let mut names = Self {
            asked: request.model.clone(),
            noise: request.noise(),
            naming: None,
            before: request.model.clone(),
            unreadable: None,
            awaits_models: false,
        };
        names.begin(request.model.clone(), number);
        names
    }

    /// Returns the model that names imprints, and its last answer; None if imprints are not named.
    pub fn naming(&self) -> Option<&Naming> {
        self.naming.as_ref()
    }

    /// Returns the request to name imprints; None if imprints are not named.
    pub fn request(&self) -> Option<&NamingRequest> {
        self.naming.as_ref().map(|naming| &naming.request)
    }

    pub fn is_by(&self, number: u64) -> bool {
        self.request()
            .is_some_and(|request| request.number == number)
    }

    /// Names imprints by a set, as the work of this number; None stops naming. Earlier answers are dropped.
    fn begin(&mut self, choice: Option<ModelChoice>, number: u64) {
        let noise = self.noise;
        self.naming = choice.map(|choice| {
            Naming::new(NamingRequest {
                number,
                choice,
                noise,
            })
        });
    }

    pub fn restart(&mut self, number: u64) {
        let choice = self.naming.take().map(|naming| naming.request.choice);
        self.begin(choice, number);
    }

    /// Names imprints by the next set: first the requested one, then the built-in ones, then the user's own models,
    /// then none. `number` is the number of this work.
    pub fn next(&mut self, own: impl Iterator<Item = ModelChoice>, number: u64) {
        let asked = self.asked.clone();
        let sets = ModelChoice::BUILT_IN.iter().cloned().chain(own);
        let sets = sets.filter(|set| Some(set) != asked.as_ref()).map(Some);
        let mut all: Vec<Option<ModelChoice>> = std::iter::once(None).chain(sets).collect();
        if asked.is_some() {
            all.insert(1, asked);
        }
        let chosen = self.request().map(|naming| naming.choice.clone());
        let failed = self.unreadable.take().map(Some);
        let next = other(all, &chosen, failed.as_ref(), 1);
        // A model in a file is sure to be readable only once it has named something.
        if chosen.as_ref().is_none_or(|chosen| !chosen.is_read()) {
            self.before = chosen;
        }
        self.begin(next, number);
    }

    pub fn ask(&mut self, imprint: &Imprint) -> bool {
        self.naming
            .as_mut()
            .is_some_and(|naming| naming.ask(imprint))
    }

    pub fn take(&mut self, number: u64, named: NamedImprint) {
        if self.is_by(number)
            && let Some(naming) = &mut self.naming
        {
            self.before = Some(naming.request.choice.clone());
            naming.take(named);
        }
    }

    /// Takes the reason why the model cannot be used. The set before it returns, as the work of this number; if there
    /// was no other, the reason stays visible.
    pub fn fail(&mut self, reason: &str, number: u64) {
        let Some(naming) = &mut self.naming else {
            return;
        };
        if self.before.as_ref() == Some(&naming.request.choice) {
            naming.fail(reason.to_owned());
        } else {
            self.unreadable = Some(naming.request.choice.clone());
            self.begin(self.before.clone(), number);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::tui::live::request::WatchRequest;
    use crate::tui::live::state::Live;

    #[test]
    fn sets_are_the_requested_one_the_built_in_ones_the_own_ones_and_none() {
        let own = ["asked", "other"].map(ModelChoice::from_text);
        let mut request = WatchRequest::new("none");
        request.model = Some(own[0].clone());
        let mut page = Live::new(Arc::new(request), 1);
        let mut sets = Vec::new();
        while let Some(naming) = page.names.request().cloned() {
            sets.push(naming.choice);
            page.names.next(own.clone().into_iter(), naming.number + 1);
        }
        let [asked, other] = own;
        let built_in = ModelChoice::BUILT_IN.to_vec();
        assert_eq!(sets, [vec![asked.clone()], built_in, vec![other]].concat());
        page.names.next(std::iter::once(asked.clone()), 9);
        assert_eq!(
            page.names.request().map(|naming| &naming.choice),
            Some(&asked)
        );
    }
}
