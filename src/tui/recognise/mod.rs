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

#[derive(Clone, Debug, PartialEq)]
pub enum RecogniseMessage {
    Open,
    Choose(ModelChoice),
    Touch,
    Keep,
    Forget,
    Seed(u64),
    Terms(Terms),
}
