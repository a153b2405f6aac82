//! Names a shape from one touch, and computes how well any method can do this.
//!
//! A sweep finds *every* imprint of a shape and how often it occurs, so the best classifier of one touch is not
//! learned but counted. The place of a touch is unknown, so only the [`ImprintKey`] of an imprint counts: the active
//! taxels, cropped to their bounding box. A [`Model`] holds, for each key, in how many poses each shape leaves it,
//! `n[s, k]`. These integers give the posterior of a touch and, exactly, the [`Evaluation`]:
//! which touches the best classifier names right, which are certain, and how much a touch tells in bits. No
//! classifier of one touch makes fewer errors on these poses.
//!
//! ```text
//! shapes + poses -> Training -> Model -> Answer       to an imprint: posterior, fit, state, nearest imprint
//!                                     -> Fit          a pose between the trained ones that leaves nearly the imprint
//!                                     -> Noise        the same with taxels that flip or are dead
//!                                     -> scan         all keys in all places: the nearest, and those within a distance
//!                                     -> Evaluation   of the model: the limit of one touch
//!                                     -> given        the same if only some descriptors are known
//!                                     -> Trial        answers to random touches and labelled recordings
//!                                     -> classifiers  the paper's way: classifiers on descriptors, and templates
//! shards of a training -> ModelMerge -> Model          the same bytes as from a training in one piece
//! shapes + sizes                      -> Separation   the limit against size and threshold
//! ```
//!
//! This is a convention of this project, based on the definition of the Bayes classifier (R. O. Duda, P. E. Hart and D.
//! G. Stork, *Pattern Classification*, 2001, chapter 2).

mod answer;
mod classifiers;
mod evaluation;
mod fit;
mod given;
mod likelihood;
mod model;
mod pose_estimate;
mod posterior;
mod scan;
mod separation;
mod simulation;
mod training;
mod trial;

pub use crate::atlas::{ImprintKey, KeyTable};
pub use answer::{Answer, AnswerState, Evidence};
pub use classifiers::{Classifier, ClassifierEvaluation, ClassifierSettings};
pub use evaluation::{Certainty, ConfusionMatrix, Evaluation};
pub use fit::Fit;
pub use given::{ChosenDescriptor, GivenDescriptors, GivenError, Rounding, ShapeDescriptor};
pub use likelihood::{Distances, Noise, NoiseError, SearchMethod};
pub use model::{Model, ModelError, ModelHead, ModelMerge, NamedShape, ShapeCount};
pub use pose_estimate::{AngleEstimate, PoseEstimate};
pub use scan::Nearest;
pub use separation::{Separation, SeparationPoint, SizeAxis, SmallestSize};
pub use simulation::{MOST_TOUCHES, RecognitionRate, TouchesUntil, below};
pub use training::{
    CellPositions, GridSteps, LEAST_SIDE, Training, TrainingError, default_figures, equal_figures,
};
pub use trial::{RandomTouches, Tally, Trial, random_touch};
