//! Recognise: names the shape on the matrix from one or several touches, and shows how far the name can be trusted.
//!
//! ```text
//! page      the page beside the matrix: the set and its model, the touches, what keys do
//! trained   a model, how well it tells its shapes apart, a random touch
//! panel     how the page is drawn: what the model says about the touches, in words
//! ```

pub(crate) mod page;
pub(crate) mod panel;
pub(crate) mod trained;

use taxel_files::storage::ModelChoice;

use crate::naming::Terms;
use crate::tui::app::App;
use crate::tui::jobs::answer;

#[derive(Clone, Debug, PartialEq)]
pub enum RecogniseMessage {
    Open,
    Choose(ModelChoice),
    /// Goes on to the next model.
    NextModel,
    Touch,
    Keep,
    Forget,
    Seed(u64),
    Terms(Terms),
}

/// Lists the models, and goes on with the one after `now`: after `first`, the built-in ones, then the user's own, then
/// none.
pub(crate) fn next_model(
    app: &mut App,
    first: ModelChoice,
    now: Option<ModelChoice>,
    go_on: fn(&mut App, Option<ModelChoice>),
) {
    let models = app.jobs.models.clone();
    app.jobs.read("Listing the models", move |_| {
        let own = models.names().into_iter().map(ModelChoice::from_name);
        let others = ModelChoice::BUILT_IN.iter().cloned().chain(own);
        let others = others.filter(|other| *other != first);
        let mut all = std::iter::once(first.clone()).chain(others);
        let next = match now {
            None => all.next(),
            Some(now) => all.skip_while(|own| *own != now).nth(1),
        };
        answer(move |app| go_on(app, next))
    });
}
