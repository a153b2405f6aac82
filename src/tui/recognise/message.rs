//! Requests to recognition on the screen, and reports from its worker.

use std::sync::Arc;

use crate::formats::Name;
use crate::imprint::Imprint;
use crate::recognition::{Nearest, PlacedSource, PoseEstimate};
use crate::storage::ModelChoice;
use crate::tui::recognise::trained::TrainedModel;

#[derive(Clone, Debug, PartialEq)]
pub enum RecogniseMessage {
    Open,
    Choose(ModelChoice),
    NextModel(i8),
    Touch,
    Keep,
    Forget,
    Poses,
    Confusion,
    Seed(u64),
    /// Selects a cell of the confusion matrix: row, column.
    SelectCell(usize, usize),
}

#[derive(Clone, Debug, PartialEq)]
pub struct PoseSearch {
    pub trained: Arc<TrainedModel>,
    pub imprint: Imprint,
    /// The index of the shape that the answer names; None if it names none.
    pub named: Option<usize>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct PoseSearchResult {
    pub nearest: Option<Nearest>,
    /// The index of the named shape, or of the nearest imprint's shape if none is named, and the poses in which it
    /// leaves the nearest imprint.
    pub pose: Option<(usize, PoseEstimate)>,
    pub poses: Vec<PlacedSource>,
    pub refused: Option<String>,
}

#[cfg(test)]
impl PoseSearchResult {
    pub(super) fn of_nothing() -> Box<Self> {
        Box::new(Self {
            nearest: None,
            pose: None,
            poses: Vec::new(),
            refused: None,
        })
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    pub number: u64,
    pub stored: Vec<Name>,
    pub trained: Result<Arc<TrainedModel>, String>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum RecognitionEvent {
    /// A training began: its number, and its number of poses.
    Begun(u64, u64),
    Prepared(Box<Prepared>),
    /// The search with this number has ended: its result, or the reason why it failed.
    Searched(u64, Result<Box<PoseSearchResult>, String>),
}
