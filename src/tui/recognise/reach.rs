//! Access to the state of recognition, on its open page or kept while the page is closed; and putting an imprint onto
//! the matrix.

use crate::imprint::Imprint;
use crate::sensor::Sensor;
use crate::storage::ModelChoice;
use crate::tui::app::change::begin;
use crate::tui::app::dialog::topmost;
use crate::tui::app::document::Document;
use crate::tui::app::history::DocumentOrigin;
use crate::tui::app::state::App;
use crate::tui::recognise::state::Recognition;

/// Returns the state of recognition, from its open page or as kept while the page is closed.
pub(super) fn state(app: &mut App) -> Option<&mut Recognition> {
    let page = topmost!(&mut app.dialogs, Recognition).or(app.recognition.as_mut())?;
    Some(page)
}

/// Returns the chosen set, once its model is ready.
pub(in crate::tui) fn trained_set(app: &App) -> Option<&ModelChoice> {
    let page = topmost!(&app.dialogs, Recognition).or(app.recognition.as_ref())?;
    page.trained().map(|trained| &trained.choice)
}

/// Puts an imprint onto the matrix as if it were drawn, without any trace of what made it. `brought_by` is the name
/// of the step in the history.
pub(super) fn put(app: &mut App, sensor: Sensor, imprint: &Imprint, brought_by: &str) {
    let document = Document::drawn(sensor, *imprint);
    let origin = DocumentOrigin::of(&document).called(brought_by);
    begin(app, origin, document);
}
