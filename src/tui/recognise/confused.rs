//! Pairs of shapes that are confused, each with an example imprint.

use crate::formats::value::counted;
use crate::imprint::Imprint;
use crate::recognition::{Evaluation, Model, ShapeCount, share};

/// An imprint of a cell of the confusion matrix, the most frequent one.
#[derive(Clone, Debug, PartialEq)]
pub struct Example {
    /// The imprint, cut to its box; None of a touch that leaves nothing.
    pub imprint: Option<Imprint>,
    /// The shapes that leave it.
    counts: Vec<ShapeCount>,
}

impl Example {
    /// The imprint that a shape leaves in the most poses among those that are named as another one; the first of equals.
    /// None if there is none.
    pub fn of(model: &Model, (touched, named): (usize, usize)) -> Option<Self> {
        let poses_of = |key: usize| {
            let counts = model.counts(key);
            let own = counts
                .iter()
                .find(|count| usize::from(count.shape) == touched)?;
            (model.most_frequent(key).0 == named).then_some(own.poses)
        };
        let found = (0..model.keys().len()).filter_map(|key| Some((poses_of(key)?, key)));
        let (_, key) = found.rev().max_by_key(|(poses, _)| *poses)?;
        Some(Self {
            imprint: model.keys().imprint(key),
            counts: model.counts(key).to_vec(),
        })
    }

    /// Which shapes leave it, and in how many poses.
    pub fn in_words<'a>(&self, name: impl Fn(usize) -> &'a str) -> String {
        let leaves = self.counts.iter().map(|own| {
            let name = name(own.shape.into());
            format!("{name} in {}", counted(own.poses, "pose"))
        });
        let leaves: Vec<String> = leaves.collect();
        format!("one imprint of it: {}", leaves.join(", "))
    }
}

/// The cell beside the diagonal with the most touches, of equals the first: the shape that touches, the shape that is
/// named. None of a single shape.
pub fn worst_cell(evaluation: &Evaluation) -> Option<(usize, usize)> {
    let cells = evaluation.confusion.cells();
    let wrong = cells.filter(|(row, column, _)| row != column);
    let most = wrong.rev().max_by_key(|&(_, _, touches)| touches);
    let first = (evaluation.confusion.shapes() > 1).then_some((0, 1));
    most.map(|(row, column, _)| (row, column)).or(first)
}

/// A shape that is taken for another one.
#[derive(Clone, Debug, PartialEq)]
pub struct ConfusedPair {
    /// The number of the shape that touches.
    pub touched: usize,
    /// The number of the shape that is named.
    pub named: usize,
    /// The share of the touches of the first that are named so.
    pub share: f64,
    /// An imprint that is taken so.
    pub example: Option<Example>,
}

impl ConfusedPair {
    /// The pair of a model that is confused in the most touches; None if none is confused.
    pub fn worst(model: &Model, evaluation: &Evaluation) -> Option<Self> {
        let (touched, named) = worst_cell(evaluation)?;
        let confusion = &evaluation.confusion;
        let wrong = confusion.get(touched, named);
        (wrong > 0).then(|| Self {
            touched,
            named,
            share: share(wrong, confusion.touches_of(touched)),
            example: Example::of(model, (touched, named)),
        })
    }
}
