//! Where recognition is, on its page or kept while that is closed; and the way of an imprint onto the matrix.

use crate::imprint::Imprint;
use crate::sensor::Sensor;
use crate::storage::ModelChoice;
use crate::tui::app::change::begin_by;
use crate::tui::app::dialog::Dialog;
use crate::tui::app::document::Document;
use crate::tui::app::state::App;
use crate::tui::recognise::state::Recognition;

/// The state, wherever it is: on the page, or kept while that is closed.
pub(super) fn state(app: &mut App) -> Option<&mut Recognition> {
    let mut dialogs = app.dialogs.iter_mut().rev();
    let open = dialogs.find_map(|dialog| match dialog {
        Dialog::Recognition(page) => Some(page),
        _ => None,
    });
    open.or(app.recognition.as_mut()).map(|page| &mut **page)
}

/// The chosen set, once its model is there.
pub(in crate::tui) fn trained_set(app: &App) -> Option<&ModelChoice> {
    let open = app.dialogs.iter().find_map(|dialog| match dialog {
        Dialog::Recognition(page) => Some(page),
        _ => None,
    });
    let page = open.or(app.recognition.as_ref())?;
    page.trained().map(|trained| &trained.choice)
}

/// Puts an imprint onto the matrix as if it were drawn: nothing there says what made it. `brought_by` is
/// the history's name for the step.
pub(super) fn put(app: &mut App, sensor: Sensor, imprint: &Imprint, brought_by: &str) {
    let mut document = Document::empty(sensor);
    document.edits = *imprint;
    begin_by(app, document, brought_by);
}
