use std::collections::BTreeMap;

use crate::parameter::number::share;
use crate::recognition::model::{Model, ShapeCount, first_of_most};

/// The result of the best classifier of one touch, over every touch of a model.
///
/// A touch is a shape in a pose. A shape of weight w counts as if it were touched w times in each pose. All counts are
/// exact; `right` of `touches` is the *Bayes accuracy*, which no classifier of one touch exceeds on these poses.
///
/// ```
/// use taxel_core::prelude::*;
/// use taxel_core::recognition::{Evaluation, NamedShape, Training};
///
/// let sensor = Sensor::default();
/// let shapes = [
///     NamedShape::new("square", Figure::rectangle(4.0, 4.0).on(&sensor)?),
///     NamedShape::new("other", Figure::rectangle(4.0, 4.0).on(&sensor)?),
/// ];
/// let ranges = Ranges::default().with(Axis::Angle, "0:80:10".parse()?);
/// let model = Training::new(shapes, sensor, Anchor::Centre, ranges)?.run()?;
/// let limit = Evaluation::of(&model);
/// // Two names for one shape: half of the touches are named right, none is certain, a touch tells nothing.
/// assert_eq!((limit.error(), limit.information_bits), (0.5, 0.0));
/// assert_eq!(limit.certainty.map(|certainty| certainty.touches), Some(0));
/// assert_eq!(limit.tied, limit.touches);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// The names of the shapes.
    pub labels: Vec<String>,
    /// The number of touches.
    pub touches: u128,
    /// Touches that are named right.
    pub right: u128,
    /// The touches and keys that only one shape can leave; None for a [`Classifier`](crate::recognition::Classifier),
    /// which does not know when it is certain.
    pub certainty: Option<Certainty>,
    /// Touches with a key that two or more shapes leave equally often, and no other shape more often. The first of
    /// these shapes in the set is the answer.
    pub tied: u128,
    /// Touches whose shape is one of the two most frequent.
    pub right_in_top_two: u128,
    /// The information that a touch gives about the shape on average, in bits: H(S) − H(S | key).
    pub information_bits: f64,
    /// The information needed to name the shape, in bits: H(S).
    pub prior_bits: f64,
    /// The number of distinct keys, or of distinct values if descriptors are given instead of keys.
    pub keys: usize,
    /// The confusion matrix: which shapes are named as which.
    pub confusion: ConfusionMatrix,
    weights: u128,
}

/// The touches and the keys of which the best classifier knows that no other shape can leave them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Certainty {
    /// Touches that only one shape can leave.
    pub touches: u128,
    /// The number of keys that only one shape leaves, or of values if descriptors are given instead of keys.
    pub keys: usize,
}

impl Evaluation {
    /// Evaluates a model: all poses that it holds, so only those of the shard if it is one ([`Model::shard`]).
    pub fn of(model: &Model) -> Self {
        let keys = 0..model.keys().len();
        Self::of_classes(model, keys.map(|key| model.counts(key)))
    }

    /// Evaluates the best classifier of a model's touches, which fall into classes that it can tell apart. Each class
    /// has at least one touch.
    pub(super) fn of_classes<'a>(
        model: &Model,
        classes: impl IntoIterator<Item = &'a [ShapeCount]>,
    ) -> Self {
        let mut evaluation = Self::new(model);
        let mut certainty = Certainty::default();
        for counts in classes {
            let touches = evaluation.add(model, counts);
            if counts.len() == 1 {
                certainty.touches += touches;
                certainty.keys += 1;
            }
        }
        evaluation.certainty = Some(certainty);
        evaluation.finished()
    }

    pub(super) fn new(model: &Model) -> Self {
        let shapes = model.shapes();
        Self {
            labels: shapes.iter().map(|shape| shape.name.clone()).collect(),
            touches: u128::from(model.poses()) * model.weights(),
            right: 0,
            certainty: None,
            tied: 0,
            right_in_top_two: 0,
            information_bits: 0.0,
            prior_bits: prior_bits(model),
            keys: 0,
            confusion: ConfusionMatrix::new(shapes.len(), shapes.len()),
            weights: model.weights(),
        }
    }

    /// Adds all touches of one key, or of one value if descriptors are given; at least one touch. Returns their
    /// number.
    fn add(&mut self, model: &Model, counts: &[ShapeCount]) -> u128 {
        self.keys += 1;
        let shapes = model.weighted_shapes(counts);
        let sum: u128 = shapes.clone().map(|(_, touches)| touches).sum();
        let Some((named, most)) = first_of_most(shapes.clone()) else {
            return sum;
        };
        let others = shapes.clone().filter(|&(shape, _)| shape != named);
        let second = others.map(|(_, touches)| touches).fold(0, u128::max);
        self.right += most;
        self.right_in_top_two += most + second;
        if second == most {
            self.tied += sum;
        }
        for (shape, touches) in shapes {
            self.confusion.add(shape, named, touches);
            // `joint` is P(shape, key), `ratio` is P(shape | key) / P(shape).
            let prior = u128::from(model.shapes()[shape].weight);
            let joint = share(touches, self.touches);
            let ratio = share(touches, sum) / share(prior, self.weights);
            self.information_bits += joint * libm::log2(ratio);
        }
        sum
    }

    pub(super) fn finished(mut self) -> Self {
        self.information_bits = self.information_bits.clamp(0.0, self.prior_bits);
        self
    }

    /// Returns true if a shape has a weight above 1, so that each touch counts with the weight of its shape.
    pub fn is_weighted(&self) -> bool {
        self.weights > self.labels.len() as u128
    }

    /// Returns the share of touches that are named right.
    pub fn accuracy(&self) -> f64 {
        share(self.right, self.touches)
    }

    /// Returns the share of touches that are named wrong: the Bayes error.
    pub fn error(&self) -> f64 {
        share(self.touches - self.right, self.touches)
    }

    /// Returns the recall of a shape: the share of its touches that get its name; None if it has no touch, or if
    /// there is no such shape.
    pub fn recall(&self, shape: usize) -> Option<f64> {
        let touches = self.confusion.touches_of(shape);
        (touches > 0).then(|| share(self.confusion.get(shape, shape), touches))
    }

    /// Returns the precision of a shape: the share of the touches with its name that are really its own; None if no
    /// touch gets its name.
    pub fn precision(&self, shape: usize) -> Option<f64> {
        let named = self.confusion.touches_named(shape);
        (named > 0).then(|| share(self.confusion.get(shape, shape), named))
    }

    /// Returns the pairs of shapes of which one is taken for the other, with the touches of both together, the most
    /// confused first.
    pub fn worst_pairs(&self) -> Vec<((usize, usize), u128)> {
        let mut sums = BTreeMap::new();
        for (touched, named, touches) in self.confusion.cells() {
            if touched != named {
                let pair = (touched.min(named), touched.max(named));
                *sums.entry(pair).or_insert(0) += touches;
            }
        }
        let mut pairs: Vec<_> = sums.into_iter().collect();
        pairs.sort_by_key(|&(pair, touches)| (std::cmp::Reverse(touches), pair));
        pairs
    }
}

fn prior_bits(model: &Model) -> f64 {
    let weights = model.weights();
    let bits = model.shapes().iter().map(|shape| {
        let prior = share(u128::from(shape.weight), weights);
        // 0 − x, since a negative zero would be shown as −0.
        0.0 - prior * libm::log2(prior)
    });
    bits.sum()
}

impl Model {
    /// Returns the shapes whose touches are never certain, because each of their keys is also left by another shape of
    /// the set.
    pub fn never_certain(&self) -> Vec<usize> {
        if self.poses() == 0 {
            return Vec::new();
        }
        let mut certain = vec![false; self.shapes().len()];
        for key in 0..self.keys().len() {
            if let [only] = self.counts(key) {
                certain[usize::from(only.shape)] = true;
            }
        }
        (0..certain.len())
            .filter(|&shape| !certain[shape])
            .collect()
    }
}

/// A confusion matrix: how many touches of each shape are named as which shape.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ConfusionMatrix {
    /// For each shape, the names that its touches are given, with the number of touches.
    rows: Vec<BTreeMap<usize, u128>>,
    /// The sum of each column.
    named: Vec<u128>,
}

impl ConfusionMatrix {
    pub(super) fn new(shapes: usize, names: usize) -> Self {
        Self {
            rows: vec![BTreeMap::new(); shapes],
            named: vec![0; names],
        }
    }

    /// Counts touches of a shape, for which a row is added if there is none.
    pub(super) fn add(&mut self, touched: usize, named: usize, touches: u128) {
        self.named[named] += touches;
        let rows = self.rows.len().max(touched + 1);
        self.rows.resize(rows, BTreeMap::new());
        *self.rows[touched].entry(named).or_default() += touches;
    }

    /// Returns the number of shapes that were touched: the rows.
    pub fn shapes(&self) -> usize {
        self.rows.len()
    }

    /// Returns the number of names: the columns.
    pub fn names(&self) -> usize {
        self.named.len()
    }

    /// Returns how many touches of one shape are named as another one; 0 if there is no such shape.
    pub fn get(&self, touched: usize, named: usize) -> u128 {
        let row = self.rows.get(touched);
        row.and_then(|row| row.get(&named).copied())
            .unwrap_or_default()
    }

    /// Returns how many touches of a shape got any name; 0 if there is no such shape.
    pub fn touches_of(&self, shape: usize) -> u128 {
        self.rows.get(shape).map_or(0, |row| row.values().sum())
    }

    /// Returns how many touches are named as a shape; 0 if there is no such shape.
    pub fn touches_named(&self, shape: usize) -> u128 {
        self.named.get(shape).copied().unwrap_or_default()
    }

    /// Iterates over the cells above 0, row by row: (touched shape, named shape, touches).
    pub fn cells(&self) -> impl DoubleEndedIterator<Item = (usize, usize, u128)> + '_ {
        let rows = self.rows.iter().enumerate();
        rows.flat_map(|(touched, row)| {
            let cells = row.iter();
            cells.map(move |(&named, &touches)| (touched, named, touches))
        })
    }

    /// Iterates over the rows with all their cells: row i has the touches of shape i that are named 0, 1, 2 and so
    /// on.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = Vec<u128>> + ExactSizeIterator {
        self.rows.iter().map(|row| {
            let mut cells = vec![0; self.names()];
            for (&named, &touches) in row {
                cells[named] = touches;
            }
            cells
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atlas::{ImprintKey, KeyTable};
    use crate::figure::Figure;
    use crate::pose::{Anchor, Axis, Ranges};
    use crate::recognition::model::{ModelHead, NamedShape};
    use crate::sensor::Sensor;

    #[test]
    fn a_large_set_takes_memory_only_for_confused_pairs() {
        const SHAPES: u16 = 20_000;
        let bar = Figure::rectangle(4.0, 2.0).on(&Sensor::default());
        let bar = bar.expect("in range");
        let shapes = (0..SHAPES).map(|number| NamedShape::new(number.to_string(), bar));
        let ranges = [Axis::X0, Axis::Y0, Axis::Angle].map(|axis| (axis, "0"));
        let ranges = ranges
            .into_iter()
            .fold(Ranges::default(), |all, (axis, at)| {
                all.with(axis, at.parse().expect("a range"))
            });
        let (shapes, sensor) = (shapes.collect(), Sensor::default());
        let head = ModelHead::new(shapes, sensor, Anchor::Centre, ranges, 1);
        let counts = (0..SHAPES).map(|shape| ShapeCount::new(shape, 1));
        let mut keys = KeyTable::default();
        keys.add(&ImprintKey::of(&"####\n####".parse().expect("rows")));
        let model = Model::of_table(head, &keys, |_| counts.clone());
        let limit = Evaluation::of(&model.expect("a model"));
        assert_eq!((limit.touches, limit.right), (SHAPES.into(), 1));
        assert_eq!(limit.worst_pairs().len(), usize::from(SHAPES) - 1);
        let worst = limit.worst_pairs()[0];
        assert_eq!(worst, ((0, 1), 1));
        assert_eq!((limit.recall(0), limit.recall(1)), (Some(1.0), Some(0.0)));
        assert_eq!(
            (limit.recall(1_000_000), limit.precision(1_000_000)),
            (None, None)
        );
        let precisions: Vec<Option<f64>> = (0..SHAPES.into())
            .map(|shape| limit.precision(shape))
            .collect();
        assert_eq!(precisions[..2], [Some(1.0 / f64::from(SHAPES)), None]);
    }
}
