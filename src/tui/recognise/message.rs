//! Requests to recognition on the screen, and reports from its worker.

use std::sync::Arc;

use crate::formats::Name;
use crate::imprint::Imprint;
use crate::recognition::{Nearest, PlacedSource, PoseEstimate};
use crate::storage::ModelChoice;
use crate::tui::recognise::trained::TrainedModel;

/// A request by a key or a command.
#[derive(Clone, Debug, PartialEq)]
pub enum RecogniseMessage {
    /// Opens the page.
    Open,
    /// Opens the page with a model.
    Choose(ModelChoice),
    /// Chooses the model this many places after the present one.
    NextModel(i8),
    /// Touches the matrix with a random shape of the set.
    Touch,
    /// Keeps the touch on the matrix as one of several of the same shape.
    Keep,
    /// Forgets the kept touches.
    Forget,
    /// Shows or hides the outlines of the poses that may have left the imprint.
    Poses,
    /// Shows the confusion matrix.
    Confusion,
    /// Starts the random touches from this seed.
    Seed(u64),
    /// Selects a cell of the confusion matrix: row, column.
    SelectCell(usize, usize),
}

/// A search over a whole model.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseSearch {
    /// The model.
    pub trained: Arc<TrainedModel>,
    /// The imprint.
    pub imprint: Imprint,
    /// The index of the shape that the answer names; None if it names none.
    pub named: Option<usize>,
}

/// The result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseSearchResult {
    /// The nearest imprint that a shape of the set leaves.
    pub nearest: Option<Nearest>,
    /// The index of the named shape, or of the nearest imprint's shape if none is named, and the poses in which it
    /// leaves the nearest imprint.
    pub pose: Option<(usize, PoseEstimate)>,
    /// Some of these poses, the most likely first.
    pub poses: Vec<PlacedSource>,
    /// The reason why the poses were not found, if they need more memory than there is.
    pub refused: Option<String>,
}

#[cfg(test)]
impl PoseSearchResult {
    /// Returns the result of a search that found nothing.
    pub(super) fn of_nothing() -> Box<Self> {
        Box::new(Self {
            nearest: None,
            pose: None,
            poses: Vec::new(),
            refused: None,
        })
    }
}

/// A model, or the reason why there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// The number of the piece of work.
    pub number: u64,
    /// The names of the stored models.
    pub stored: Vec<Name>,
    /// The model, or the reason why there is none.
    pub trained: Result<Arc<TrainedModel>, String>,
}

/// A report from the worker.
#[derive(Clone, Debug, PartialEq)]
pub enum RecognitionEvent {
    /// A training began: its number, and its number of poses.
    Begun(u64, u64),
    /// A model is ready, or there is none.
    Prepared(Box<Prepared>),
    /// The search with this number has ended: its result, or the reason why it failed.
    Searched(u64, Result<Box<PoseSearchResult>, String>),
}
