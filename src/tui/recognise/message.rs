//! Requests to recognition on the screen, and reports from its worker.

use std::sync::Arc;

use crate::formats::Name;
use crate::imprint::Imprint;
use crate::recognition::{Nearest, PlacedSource, PoseEstimate};
use crate::storage::ModelChoice;
use crate::tui::recognise::separate::found::SizesFound;
use crate::tui::recognise::separate::request::SeparationFlags;
use crate::tui::recognise::trained::TrainedModel;

/// What a key or a command asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum RecogniseMessage {
    /// To open the page.
    Open,
    /// To open it with a set.
    Choose(ModelChoice),
    /// Another set, by how many places it comes after the present one.
    NextSet(i8),
    /// A random shape of the set touches the matrix.
    Touch,
    /// To keep the touch on the matrix as one of several of the same shape.
    Keep,
    /// To forget the touches that were kept.
    Forget,
    /// To show the outlines of the poses that may have left the imprint, or hide them.
    Poses,
    /// The confusion matrix.
    Confusion,
    /// The limit of the set against the size of its shapes.
    Separate(SeparationFlags),
    /// Another wanted error there: a smaller one below 0.
    Want(i8),
    /// Random touches from this seed on.
    Seed(u64),
    /// To select a row of a list, counted from 0.
    Select(usize),
    /// To write the sizes into a file of that name.
    WriteSizes(String),
    /// To select a cell of the confusion matrix: row, column.
    SelectCell(usize, usize),
}

/// A search over a whole model.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseSearch {
    /// The model.
    pub trained: Arc<TrainedModel>,
    /// The imprint.
    pub imprint: Imprint,
    /// The number of the shape that the answer names; None if it names none.
    pub named: Option<usize>,
}

/// What it found.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// The nearest imprint that a shape of the set leaves.
    pub nearest: Option<Nearest>,
    /// The number of the named shape, or of that of the nearest imprint if none is named, and in which poses it leaves
    /// the nearest imprint.
    pub pose: Option<(usize, PoseEstimate)>,
    /// Some of these poses, the likeliest first.
    pub poses: Vec<PlacedSource>,
    /// Why the poses were not found, if they need more memory than there is.
    pub refused: Option<String>,
}

/// A model, or why there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Prepared {
    /// The number of the piece of work.
    pub number: u64,
    /// The names of the models that are stored.
    pub stored: Vec<Name>,
    /// The model, or why there is none.
    pub trained: Result<Arc<TrainedModel>, String>,
}

/// What the worker reports.
#[derive(Clone, Debug, PartialEq)]
pub enum RecognitionEvent {
    /// A training of that number began; how many poses it has.
    Begun(u64, u64),
    /// The work of that number is no longer waited for; what it does, in a few words.
    GivenUp(u64, String),
    /// A model is ready, or there is none.
    Prepared(Box<Prepared>),
    /// The search of that number is over: what it found, or why it failed.
    Looked(u64, Result<Box<Look>, String>),
    /// Sizes were looked at.
    Sizes(Box<SizesFound>),
}
