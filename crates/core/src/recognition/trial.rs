//! Tries a model out on touches whose true shapes are known, random ones or those of a labelled recording, and counts
//! the answers: an evaluation on a test set.
//!
//! An [`Evaluation`](crate::recognition::Evaluation) counts the poses of the model exactly. Real touches lie between
//! these poses, and may be of shapes that the model does not have.

use std::collections::BTreeMap;

use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::imprint::Imprint;
use crate::pose::{Axis, Pose, PoseGrid};
use crate::progress::Progress;
use crate::recognition::answer::Answer;
use crate::recognition::evaluation::ConfusionMatrix;
use crate::recognition::model::{Model, NamedShape};
use crate::recognition::simulation::{generator, unit};
use crate::recognition::training::{GridSteps, Training, TrainingError, grids};
use crate::touch::Plane;

/// The answers of a model to touches of known shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Touches of shapes of the model, with a row for each, in the order of the set. Their names are right.
    pub known: Tally,
    /// Touches of other shapes. Unknown is right.
    pub foreign: Tally,
}

/// Answers to touches, by their true shapes. A tied answer counts as the first of the tied shapes, a rejected one as
/// unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct Tally {
    /// The names of the true shapes.
    pub labels: Vec<String>,
    /// A row for each of them; a column for each shape of the model, then one for unknown.
    pub confusion: ConfusionMatrix,
    /// The number of touches by how many taxels differ from the best fit. Touches that were not fitted are left out.
    pub differs: BTreeMap<u32, u64>,
    is_foreign: bool,
}

impl Tally {
    fn new(model: &Model, labels: Vec<String>, is_foreign: bool) -> Self {
        let columns = model.shapes().len() + 1;
        Self {
            confusion: ConfusionMatrix::new(labels.len(), columns),
            labels,
            differs: BTreeMap::new(),
            is_foreign,
        }
    }

    fn add(&mut self, row: usize, (named, differs): Counted) {
        let column = named.unwrap_or(self.column_of_unknown());
        self.confusion.add(row, column, 1);
        if let Some(differs) = differs {
            *self.differs.entry(differs).or_default() += 1;
        }
    }

    fn column_of_unknown(&self) -> usize {
        self.confusion.names() - 1
    }

    fn right_column(&self, row: usize) -> usize {
        if self.is_foreign {
            self.column_of_unknown()
        } else {
            row
        }
    }

    /// Returns the number of touches.
    pub fn touches(&self) -> u128 {
        self.confusion.cells().map(|(_, _, touches)| touches).sum()
    }

    /// Returns the number of touches with the right answer.
    pub fn right(&self) -> u128 {
        let rows = 0..self.labels.len();
        rows.map(|row| self.confusion.get(row, self.right_column(row)))
            .sum()
    }

    /// Returns the number of touches that get the name of another shape.
    pub fn wrong(&self) -> u128 {
        let neither = if self.is_foreign { 0 } else { self.unknown() };
        self.touches() - self.right() - neither
    }

    /// Returns the number of touches without a name.
    pub fn unknown(&self) -> u128 {
        self.confusion.touches_named(self.column_of_unknown())
    }

    /// Returns the median number of taxels that differ from a fit, the lower one of two; None if nothing was fitted.
    pub fn median_differs(&self) -> Option<u32> {
        let half = self.differs.values().sum::<u64>().div_ceil(2);
        let mut below = 0;
        let mut counts = self.differs.iter();
        let median = counts.find(|&(_, count)| {
            below += count;
            below >= half
        });
        median.map(|(&differs, _)| differs)
    }
}

/// What of an answer is counted: the shape, and how many taxels differ from the fit.
type Counted = (Option<usize>, Option<u32>);

fn counted(answer: &Answer) -> Counted {
    (answer.shape, answer.fit.as_ref().map(|fit| fit.differs))
}

impl Trial {
    /// Creates a trial without touches.
    pub fn new(model: &Model) -> Self {
        let names = model.shapes().iter().map(|shape| shape.name.clone());
        Self {
            known: Tally::new(model, names.collect(), false),
            foreign: Tally::new(model, Vec::new(), true),
        }
    }

    /// Counts the answer to a touch of the shape with a label. `is_same` compares the label with a name; if no shape
    /// of the model has it, the touch is foreign.
    pub fn add(&mut self, label: &str, is_same: impl Fn(&str) -> bool, answer: &Answer) {
        let row_in = |tally: &Tally| tally.labels.iter().position(|name| is_same(name));
        if let Some(row) = row_in(&self.known) {
            return self.known.add(row, counted(answer));
        }
        let row = row_in(&self.foreign).unwrap_or_else(|| {
            self.foreign.labels.push(label.to_owned());
            self.foreign.labels.len() - 1
        });
        self.foreign.add(row, counted(answer));
    }
}

/// Random touches to try a model out: exact touches in continuous poses, without noise.
///
/// Each pose of a model stands for the cell of the grid that begins there. So x0, y0, the angle and the zooms are uniform
/// from the first value of their range to one step beyond the last; an axis of one value keeps it. Foreign shapes are
/// touched as [`Training::fitting`] places them, at the angles of the model: in one cell around the middle of the
/// smallest square sensor that holds them and is at least as large as the model's.
///
/// ```
/// use taxel_core::prelude::*;
/// use taxel_core::progress::ToTheEnd;
/// use taxel_core::recognition::{Evidence, NamedShape, RandomTouches, Training};
///
/// let sensor = Sensor::default();
/// let square = NamedShape::new("square", Figure::rectangle(4.0, 4.0).on(&sensor)?);
/// let bar = NamedShape::new("bar", Figure::rectangle(9.0, 2.0).on(&sensor)?);
/// let ranges = Ranges::default().with(Axis::Angle, "0:345:15".parse()?);
/// let model = Training::new([square], sensor, Anchor::Centre, ranges)?.run()?;
///
/// let answer = |touch: &Imprint| model.recognise(Evidence::of(std::slice::from_ref(touch)));
/// let touches = RandomTouches::new(&model, vec![bar], 50, 1)?;
/// let trial = touches.answer(&model, &answer, &ToTheEnd).expect("not stopped");
/// assert_eq!((trial.known.right(), trial.known.median_differs()), (50, Some(0)));
/// assert_eq!((trial.foreign.right(), trial.foreign.wrong()), (50, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RandomTouches {
    known: Vec<PoseGrid>,
    foreign: Option<Training<'static>>,
    per_shape: u64,
    seed: u64,
}

impl RandomTouches {
    /// Creates `per_shape` touches of each shape of a model and of each foreign shape. The same seed gives the same
    /// touches on every machine, and the foreign shapes do not change those of the model.
    ///
    /// # Errors
    /// Returns an error for foreign shapes without names of their own, or if they do not fit on any sensor at the
    /// angles of the model.
    pub fn new(
        model: &Model,
        foreign: Vec<NamedShape>,
        per_shape: u64,
        seed: u64,
    ) -> Result<Self, TrainingError> {
        let (shapes, sensor) = (model.shapes(), *model.sensor());
        let foreign = Some(foreign).filter(|foreign| !foreign.is_empty());
        let steps = GridSteps {
            angles: model.ranges()[Axis::Angle],
            ..GridSteps::FINE
        };
        let foreign = foreign.map(|own| Training::on_a_sensor_like(&sensor, own, steps));
        Ok(Self {
            known: grids(shapes, sensor, model.anchor(), *model.ranges())?,
            foreign: foreign.transpose()?,
            per_shape,
            seed,
        })
    }

    /// Returns the number of touches.
    pub fn count(&self) -> u64 {
        let foreign = self.foreign.as_ref().map_or(0, |own| own.grids.len());
        self.per_shape
            .saturating_mul((self.known.len() + foreign) as u64)
    }

    /// Counts the answers to all touches, which are given on rayon's current thread pool; the result is the same for any
    /// number of threads. `answer` is usually [`Model::recognise`]. `progress` is called with 1 after each touch. None
    /// if it stopped the trial.
    pub fn answer(
        &self,
        model: &Model,
        answer: &(dyn Fn(&Imprint) -> Answer + Sync),
        progress: &dyn Progress,
    ) -> Option<Trial> {
        let mut trial = Trial::new(model);
        let mut first = 0;
        let mut add = |tally: &mut Tally, grids: &[PoseGrid]| {
            for (row, grid) in grids.iter().enumerate() {
                let touches = (first..first + self.per_shape).into_par_iter();
                let answers = touches.map(|number| {
                    // Each touch has its own generator, so that none waits for another.
                    let touch = random_touch(grid, &mut generator(self.seed, number));
                    let counted = counted(&answer(&touch));
                    progress.add(1).is_continue().then_some(counted)
                });
                for counted in answers.collect::<Option<Vec<_>>>()? {
                    tally.add(row, counted);
                }
                first += self.per_shape;
            }
            Some(())
        };
        add(&mut trial.known, &self.known)?;
        if let Some(foreign) = &self.foreign {
            let names = foreign.shapes.iter().map(|shape| shape.name.clone());
            trial.foreign.labels = names.collect();
            add(&mut trial.foreign, &foreign.grids)?;
        }
        Some(trial)
    }
}

/// Touches with a shape in a random pose, which may lie between those of the grid.
pub fn random_touch(grid: &PoseGrid, random: &mut Pcg64) -> Imprint {
    let pose = Pose::from_fn(|axis| {
        let range = grid.ranges()[axis];
        match range.count() {
            1 => range.value(0),
            count => range.value(0) + unit(random) * (range.value(count) - range.value(0)),
        }
    });
    Plane::new(*grid.sensor()).touch(&grid.placed_in(pose))
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::*;
    use crate::figure::Figure;
    use crate::pose::Anchor;
    use crate::progress::{ToTheEnd, stop_if};
    use crate::recognition::{Evidence, equal_figures};
    use crate::sensor::Sensor;

    /// The model of six of the seven figures of 30 cells.
    fn model() -> Model {
        let steps = GridSteps::of(5, "0:345:15");
        let training = Training::fitting(equal_figures().split_off(1), steps);
        training.expect("they fit").run().expect("not stopped")
    }

    /// The seventh figure, and one that is too large for the sensor of the others.
    fn foreign() -> Vec<NamedShape> {
        let large = Figure::rectangle(16.0, 5.0).on(&Sensor::default());
        let large = NamedShape::new("large", large.expect("in range"));
        equal_figures().into_iter().take(1).chain([large]).collect()
    }

    fn tried(model: &Model, foreign: Vec<NamedShape>, seed: u64) -> Trial {
        let touches = RandomTouches::new(model, foreign, 20, seed).expect("they fit");
        let answer = |touch: &Imprint| model.recognise(Evidence::of(&[*touch]));
        let trial = touches.answer(model, &answer, &ToTheEnd);
        trial.expect("not stopped")
    }

    #[test]
    fn every_touch_is_counted_once() {
        let model = model();
        let trial = tried(&model, foreign(), 3);
        for (tally, touches) in [(&trial.known, 120_u64), (&trial.foreign, 40)] {
            let cells = || tally.confusion.cells();
            assert_eq!(tally.touches(), touches.into());
            assert_eq!(tally.differs.values().sum::<u64>(), touches);
            let named = cells().filter(|(_, named, _)| *named < 6);
            let named: u128 = named.map(|(_, _, touches)| touches).sum();
            assert_eq!(named + tally.unknown(), touches.into());
        }
        let known = &trial.known;
        assert_eq!(known.right() + known.wrong() + known.unknown(), 120);
        assert_eq!(
            (0..6)
                .map(|row| known.confusion.get(row, row))
                .sum::<u128>(),
            known.right()
        );
        assert!(known.right() > 80 && known.unknown() < 5, "{known:?}");
        let large = &trial.foreign.confusion;
        // Nothing of 30 cells fits 80 of them.
        assert_eq!((large.get(1, 6), large.touches_of(1)), (20, 20));
        assert_eq!(trial.foreign.right(), trial.foreign.unknown());
        assert_eq!(trial.foreign.wrong(), 40 - trial.foreign.unknown());
    }

    #[test]
    fn a_seed_repeats_its_touches_on_any_number_of_threads() {
        let model = model();
        let trial = tried(&model, foreign(), 3);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let alone = pool
            .expect("a thread")
            .install(|| tried(&model, foreign(), 3));
        assert_eq!(trial, alone);
        assert_eq!(trial.known, tried(&model, Vec::new(), 3).known);
        assert_ne!(trial.known, tried(&model, Vec::new(), 4).known);
    }

    #[test]
    fn poses_are_uniform_over_the_cells_of_the_grid() {
        let bar = Figure::rectangle(4.0, 2.0).on(&Sensor::default());
        let ranges = crate::pose::Ranges::default()
            .with(Axis::X0, "3:3.5:0.5".parse().expect("a range"))
            .with(Axis::Y0, "6".parse().expect("a range"))
            .with(Axis::Angle, "0".parse().expect("a range"));
        let grid = PoseGrid::new(
            bar.expect("in range").into(),
            Sensor::default(),
            Anchor::Corner,
            ranges,
        );
        let grid = grid.expect("in range");
        // The left edge covers half of column 3 up to x0 = 3.5, and the touch begins in column 4 beyond.
        let lefts = (0..400).map(|number| {
            let bounds = random_touch(&grid, &mut generator(1, number))
                .bounds()
                .expect("active taxels");
            assert_eq!((bounds.top, bounds.bottom), (6, 8));
            usize::from(bounds.left)
        });
        let mut counts = [0; 6];
        lefts.for_each(|left| counts[left] += 1);
        assert_eq!(counts[3] + counts[4], 400);
        assert!((160..240).contains(&counts[3]), "{counts:?}");
    }

    #[test]
    fn progress_stops_a_trial() {
        let model = model();
        let touches = RandomTouches::new(&model, foreign(), 20, 0).expect("they fit");
        assert_eq!(touches.count(), 160);
        let answer = |touch: &Imprint| model.recognise(Evidence::of(&[*touch]));
        let done = AtomicU64::new(0);
        let progress = |more| stop_if(done.fetch_add(more, Ordering::Relaxed) >= 30);
        assert_eq!(touches.answer(&model, &answer, &progress), None);
    }

    #[test]
    fn labels_that_no_shape_has_are_foreign() {
        let model = model();
        let mut trial = Trial::new(&model);
        let touch: Imprint = "######\n######\n######\n######\n######"
            .parse()
            .expect("rows");
        let answer = model.recognise(Evidence::of(&[touch]));
        for label in ["Rectangle", "cup", "CUP", "hexagon"] {
            trial.add(label, |name| name.eq_ignore_ascii_case(label), &answer);
        }
        let known = &trial.known;
        assert_eq!((known.right(), known.wrong(), known.unknown()), (1, 1, 0));
        assert_eq!(trial.foreign.labels, ["cup"]);
        assert_eq!((trial.foreign.right(), trial.foreign.wrong()), (0, 2));
        let medians = [vec![], vec![3], vec![0, 0, 5, 5], vec![0, 4, 5]];
        let medians = medians.map(|all| {
            let mut tally = Trial::new(&model).known;
            for own in all {
                *tally.differs.entry(own).or_default() += 1;
            }
            tally.median_differs()
        });
        assert_eq!(medians, [None, Some(3), Some(0), Some(4)]);
    }
}
