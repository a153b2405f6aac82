//! Pairs of shapes that are confused, each with an example imprint.

use std::collections::BTreeMap;

use crate::formats::value::counted;
use crate::imprint::Imprint;
use crate::recognition::{Evaluation, Model, ShapeCount};

#[derive(Clone, Debug, PartialEq)]
pub struct Example {
    /// The imprint, cut to its box; None for a touch that leaves nothing.
    pub imprint: Option<Imprint>,
    counts: Vec<ShapeCount>,
}

/// An example imprint for each cell of the confusion matrix. All are found in advance: a model may have millions of
/// imprints, and no key must wait for them.
#[derive(Clone, Debug)]
pub struct Examples {
    /// For each cell, given by the touching shape and the named shape: the number of poses in which the first leaves
    /// the example, and the index of that imprint in the model.
    cells: BTreeMap<(usize, usize), (u64, usize)>,
}

impl Examples {
    /// Finds the examples of a model: of the imprints that one shape leaves and that are named as another, the one
    /// that the first shape leaves in the most poses; the first of several.
    pub fn of(model: &Model) -> Self {
        let mut cells = BTreeMap::new();
        for key in 0..model.keys().len() {
            let counts = model.counts(key);
            let (named, _) = model.most_frequent(key);
            for own in counts {
                let cell = cells.entry((own.shape.into(), named)).or_insert((0, 0));
                if own.poses > cell.0 {
                    *cell = (own.poses, key);
                }
            }
        }
        Self { cells }
    }

    /// Returns the example of a cell of the same model; None if there is none.
    pub fn get(&self, model: &Model, cell: (usize, usize)) -> Option<Example> {
        let &(_, key) = self.cells.get(&cell)?;
        Some(Example {
            imprint: model.keys().imprint(key),
            counts: model.counts(key).to_vec(),
        })
    }
}

impl Example {
    /// Describes which shapes leave the imprint, and in how many poses. The two shapes of its cell come first: there may
    /// be no room for all.
    pub fn in_words<'a>(&self, cell: (usize, usize), name: impl Fn(usize) -> &'a str) -> String {
        let mut counts = self.counts.clone();
        counts.sort_by_key(|own| match usize::from(own.shape) {
            shape if shape == cell.0 => 0,
            shape if shape == cell.1 => 1,
            _ => 2,
        });
        let leaves = counts.iter().map(|own| {
            let name = name(own.shape.into());
            format!("{name} in {}", counted(own.poses, "pose"))
        });
        let leaves: Vec<String> = leaves.collect();
        format!("an imprint left by {}", leaves.join(", "))
    }
}

/// Returns the cell beside the diagonal with the most touches, the first of several: the touching shape and the named
/// shape. None for a single shape.
pub fn worst_cell(evaluation: &Evaluation) -> Option<(usize, usize)> {
    let cells = evaluation.confusion.cells();
    let wrong = cells.filter(|(row, column, _)| row != column);
    let most = wrong.rev().max_by_key(|&(_, _, touches)| touches);
    let first = (evaluation.confusion.shapes() > 1).then_some((0, 1));
    most.map(|(row, column, _)| (row, column)).or(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;
    use crate::pose::{Anchor, Axis, Ranges};
    use crate::recognition::{NamedShape, Training};
    use crate::sensor::Sensor;

    #[test]
    fn the_example_of_a_cell_is_the_most_frequent_imprint_that_is_named_so() {
        let sensor = Sensor::default();
        let shape = |name: &str, length: f64| {
            let bar = Figure::rectangle(length, 2.0).on(&sensor);
            NamedShape::new(name, bar.expect("in range"))
        };
        let shapes = [shape("a", 4.0), shape("b", 4.2), shape("c", 4.4)];
        let ranges = Ranges::default().with(Axis::Angle, "0:80:10".parse().expect("a range"));
        let training = Training::new(shapes, sensor, Anchor::Centre, ranges).expect("a set");
        let model = training.run().expect("not stopped");
        let examples = Examples::of(&model);
        let evaluation = Evaluation::of(&model);
        for cell in (0..9).map(|cell| (cell / 3, cell % 3)) {
            let (touched, named) = cell;
            let poses = |counts: &[ShapeCount]| {
                let mut own = counts.iter();
                let own = own.find(|count| usize::from(count.shape) == touched);
                own.map(|own| own.poses)
            };
            let keys = 0..model.keys().len();
            let keys = keys.filter(|&key| model.most_frequent(key).0 == named);
            let most = keys.filter_map(|key| poses(model.counts(key)));
            let example = examples.get(&model, cell);
            let found = example.as_ref().and_then(|own| poses(&own.counts));
            assert_eq!(found, most.max(), "{cell:?}");
            let touches = evaluation.confusion.get(touched, named);
            assert_eq!(example.is_some(), touches > 0, "{cell:?}");
            if let Some(example) = example {
                let text = example.in_words(cell, |shape| ["a", "b", "c"][shape]);
                let shapes = text.trim_start_matches("an imprint left by ").split(", ");
                let shapes: Vec<&str> = shapes.filter_map(|own| own.get(..1)).collect();
                let (touching, naming) = (["a", "b", "c"][touched], ["a", "b", "c"][named]);
                let mut pair = vec![touching, naming];
                pair.dedup();
                assert!(shapes.starts_with(&pair), "{text}");
            }
        }
        assert_eq!(examples.get(&model, (3, 0)), None);
    }
}
