//! The names of the shapes that leave the imprints of a source.

use std::sync::Arc;

use taxel_core::imprint::Imprint;
use taxel_core::recognition::{Answer, Model};
use taxel_files::storage::ModelChoice;

use crate::frames::WatchRequest;
use crate::naming::{Terms, nearest_in_words, verdict};
use crate::tui::app::{App, inform, refuse};
use crate::tui::jobs::{Slot, answer};
use crate::tui::live::update;
use crate::tui::live::view::{Lines, SHAPE};
use crate::tui::recognise::next_model;
use crate::tui::widget::Theme;

/// The model that names imprints, and its last answer.
#[derive(Clone, Debug)]
pub struct ShapeNames {
    /// The model that was requested with the source.
    asked: ModelChoice,
    pub terms: Terms,
    /// None if imprints are not named.
    pub choice: Option<ModelChoice>,
    /// The model, or why it cannot be used; None while it is being trained or read.
    model: Option<Result<Arc<Model>, String>>,
    /// The imprint that was named last, and its answer. A single touch is the evidence, because the frames of a source may
    /// show different shapes.
    answer: Option<(Imprint, Answer)>,
}

impl ShapeNames {
    pub fn new(request: &WatchRequest) -> Self {
        Self {
            asked: request.model.clone().unwrap_or(ModelChoice::Library),
            terms: request.terms,
            choice: request.model.clone(),
            model: None,
            answer: None,
        }
    }

    /// Names an imprint, unless it is the one that was named last. `dead` has the cells of the mask.
    pub fn name(&mut self, imprint: Option<&Imprint>, dead: Option<&Imprint>) {
        let imprint = imprint.filter(|imprint| !imprint.is_empty());
        if let (Some(imprint), Some(Ok(model))) = (imprint, &self.model) {
            if self.answer.as_ref().map(|(own, _)| own) != Some(imprint) {
                let answer = self.terms.answer(model, &[*imprint], dead);
                self.answer = Some((*imprint, answer));
            }
        } else {
            self.answer = None;
        }
    }

    /// Returns the imprint of the shape that was fitted; None if none was.
    pub fn fitted(&self) -> Option<&Imprint> {
        let (_, answer) = self.answer.as_ref()?;
        answer.fit.as_ref().map(|fit| &fit.imprint)
    }

    /// Returns the lines about the shape, the nearest imprint if no shape was fitted, and the model with its terms; none
    /// if imprints are not named. There is no name where nothing is active.
    pub fn lines(&self, any: bool, theme: &Theme) -> Lines {
        let Some(choice) = &self.choice else {
            return Vec::new();
        };
        let mut nearest = None;
        let shape = match (&self.model, &self.answer) {
            (Some(Err(reason)), _) => format!("! {reason}"),
            (Some(Ok(model)), Some((_, answer))) => {
                nearest = nearest_in_words(answer, model);
                verdict(answer, model)
            }
            (None, _) if any => "training or reading the model".to_owned(),
            _ => theme.none().to_owned(),
        };
        let mut lines = vec![(SHAPE, shape)];
        lines.extend(nearest.map(|nearest| ("nearest", nearest)));
        let terms = self.terms.in_words().map(|terms| format!(", {terms}"));
        let terms = terms.unwrap_or_default();
        lines.push(("model", format!("{}{terms}", choice.name())));
        lines
    }
}

/// Names the imprints of the source by a model, or no more.
pub(super) fn name_by(app: &mut App, choice: Option<ModelChoice>) {
    app.jobs.forget(Slot::Names);
    let Some(page) = update::page(app) else {
        return;
    };
    (page.names.model, page.names.answer) = (None, None);
    page.names.choice.clone_from(&choice);
    let Some(choice) = choice else { return };
    let models = app.jobs.models.clone();
    app.jobs.run(Slot::Names, move |progress| {
        let found = models.find(choice).map_err(|error| error.to_string());
        let model = found.and_then(|found| found.ready(progress)).map(Arc::new);
        answer(move |app| {
            if let Some(page) = update::page(app) {
                page.names.model = Some(model);
                page.name();
            }
        })
    });
}

/// Names the imprints of the source on these terms.
pub(super) fn name_on(app: &mut App, terms: Terms) {
    let Some(page) = update::page(app) else {
        return refuse(app, update::NO_SOURCE);
    };
    (page.names.terms, page.names.answer) = (terms, None);
    page.name();
}

/// Trains shapes of the library that are new, if it names the imprints.
pub(crate) fn library_changed(app: &mut App) {
    let page = update::page(app);
    if page.is_some_and(|page| page.names.choice == Some(ModelChoice::Library)) {
        name_by(app, Some(ModelChoice::Library));
    }
}

/// Names the imprints of the source by the next model; after the last one, they are named no more.
pub(super) fn name_by_next(app: &mut App, names: &ShapeNames) {
    next_model(
        app,
        names.asked.clone(),
        names.choice.clone(),
        |app, next| {
            let text = match &next {
                Some(choice) => format!("shapes are named by {choice}"),
                None => "shapes are not named".to_owned(),
            };
            name_by(app, next);
            inform(app, text);
        },
    );
}
