//! The model of a set of shapes: in how many poses each shape leaves each key.

use std::borrow::Cow;
use std::collections::HashSet;
use std::sync::OnceLock;

use crate::atlas::{ImprintKey, KeyRef, KeyTable};
use crate::imprint::Imprint;
use crate::pose::{Anchor, Axis, MAX_POSES, Ranges};
use crate::quote::shortened;
use crate::recognition::fit::StartPoses;
use crate::recognition::scan::KeyIndex;
use crate::recognition::training::{CellPositions, GridSteps, Training};
use crate::sensor::Sensor;
use crate::source::Source;
use crate::sweep::{MergeError, Shard};

/// A shape and the name that answers use for it.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedShape {
    /// The name; no other shape of the set has it.
    pub name: String,
    /// The shape; its position does not matter.
    pub source: Source,
    /// The prior weight: how likely the shape is before the touch, relative to the others; at least 1.
    pub weight: u32,
}

impl NamedShape {
    /// Creates a shape of weight 1, as likely as any other.
    pub fn new(name: impl Into<String>, source: impl Into<Source>) -> Self {
        Self {
            name: name.into(),
            source: source.into(),
            weight: 1,
        }
    }

    /// Returns the same shape with another weight.
    #[must_use]
    pub fn weighted(self, weight: u32) -> Self {
        Self { weight, ..self }
    }
}

/// The number of poses in which a shape leaves a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShapeCount {
    /// The index of the shape in the set.
    pub shape: u16,
    /// The number of its poses with this key; at least 1.
    pub poses: u64,
}

impl ShapeCount {
    /// Creates a count for the shape with this index.
    pub fn new(shape: u16, poses: u64) -> Self {
        Self { shape, poses }
    }
}

/// The shapes to tell apart, the poses in which each was touched, and the keys that they left.
///
/// A model is made by [`Training`](crate::recognition::Training), or read from a file.
#[derive(Clone, Debug)]
pub struct Model {
    head: ModelHead,
    keys: KeyTable,
    /// The index of each key's first count, and at the end the number of counts.
    starts: Vec<usize>,
    counts: Vec<ShapeCount>,
    /// The keys again, in the order in which a scan compares them; made by the first scan.
    scan: OnceLock<ScanTables>,
    /// The poses from which fits of each shape start; made by its first fit.
    fits: Vec<OnceLock<Option<StartPoses>>>,
}

impl PartialEq for Model {
    fn eq(&self, other: &Self) -> bool {
        // Tables for scans and fits follow from the others.
        self.head == other.head
            && self.keys == other.keys
            && self.starts == other.starts
            && self.counts == other.counts
    }
}

/// The tables that scans of a model need besides its keys.
#[derive(Clone, Debug)]
pub(super) struct ScanTables {
    pub(super) index: KeyIndex,
    /// For each box of the index, the number of poses in which each shape leaves a key of that box.
    pub(super) poses: Vec<u64>,
}

/// The shapes of a model and the poses in which they were touched: everything except the keys.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelHead {
    /// The shapes, at least one.
    pub shapes: Vec<NamedShape>,
    /// The sensor that they were touched with.
    pub sensor: Sensor,
    /// The point of the shape that x0 and y0 locate.
    pub anchor: Anchor,
    /// The ranges of the poses.
    pub ranges: Ranges,
    /// The part of the poses that the model holds.
    pub shard: Shard,
    /// The number of poses of each shape in that part.
    pub poses: u64,
    /// The number of poses of each shape that reach beyond the sensor.
    pub cut: Vec<u64>,
}

impl ModelHead {
    /// Creates a head of a whole training, of shapes that the sensor never cuts off; `poses` is the number of poses of
    /// each shape in the ranges.
    pub fn new(
        shapes: Vec<NamedShape>,
        sensor: Sensor,
        anchor: Anchor,
        ranges: Ranges,
        poses: u64,
    ) -> Self {
        Self {
            cut: vec![0; shapes.len()],
            shapes,
            sensor,
            anchor,
            ranges,
            shard: Shard::WHOLE,
            poses,
        }
    }

    /// Returns true if the poses of both differ at most in where the positions begin.
    fn same_poses(&self, other: &Self) -> bool {
        let within_a_cell = |own: &Self| {
            Axis::ALL.map(|axis| {
                let [start, step] = own.ranges[axis].exact();
                let start = match axis {
                    Axis::X0 | Axis::Y0 => start.checked_rem_euclid(step).unwrap_or(start),
                    _ => start,
                };
                (start, step, own.ranges[axis].count())
            })
        };
        within_a_cell(self) == within_a_cell(other)
            && (self.anchor, self.shard) == (other.anchor, other.shard)
            && self.sensor.threshold() == other.sensor.threshold()
    }

    pub(super) fn same_training(&self, other: &Self) -> bool {
        self.shapes == other.shapes
            && self.sensor == other.sensor
            && self.anchor == other.anchor
            && self.ranges == other.ranges
            && self.shard.of() == other.shard.of()
    }
}

pub(super) const MAX_SHAPES: usize = 1 << 15;

const LONGEST_NAME: usize = 64;

/// The error for shapes or numbers that do not make a model; the message says what is wrong.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ModelError(Cow<'static, str>);

impl ModelError {
    const fn invalid(message: &'static str) -> Self {
        Self(Cow::Borrowed(message))
    }
}

/// Checks the names and weights of a set.
pub(super) fn check_shapes(shapes: &[NamedShape]) -> Result<(), ModelError> {
    let refused = |message: String| Err(ModelError(message.into()));
    if shapes.is_empty() || shapes.len() > MAX_SHAPES {
        let found = shapes.len();
        return refused(format!("{found} shapes, expected 1 to {MAX_SHAPES}"));
    }
    let mut names = HashSet::new();
    for (number, shape) in (1..).zip(shapes) {
        let (name, length) = (shortened(&shape.name), shape.name.chars().count());
        if shape.name.trim().is_empty() {
            return refused(format!("shape {number} has no name"));
        }
        if shape.name.contains(char::is_control) {
            return refused(format!(
                "name {name:?} of shape {number} has a line break or another control character"
            ));
        }
        if length > LONGEST_NAME {
            return refused(format!(
                "name {name:?} of shape {number} has {length} characters (allowed: up to {LONGEST_NAME})"
            ));
        }
        if !names.insert(shape.name.as_str()) {
            return refused(format!(
                "two shapes are named {name:?}; give each its own name"
            ));
        }
        if shape.weight == 0 {
            return refused(format!("weight of {name:?}: 0, expected at least 1"));
        }
    }
    Ok(())
}

impl Model {
    /// Builds a model from the keys of a table, in any order, and the counts of each key, by shape.
    ///
    /// # Errors
    /// Returns an error if numbers contradict each other.
    pub fn of_table<I: IntoIterator<Item = ShapeCount>>(
        head: ModelHead,
        table: &KeyTable,
        counts_of: impl Fn(usize) -> I,
    ) -> Result<Self, ModelError> {
        check_shapes(&head.shapes)?;
        let check = |holds: bool, what| holds.then_some(()).ok_or(ModelError::invalid(what));
        let shapes = head.shapes.len();
        check(head.cut.len() == shapes, "a shape without its cut poses")?;
        let (keys, order) = table.sorted();
        let (mut starts, mut counts) = (vec![0], Vec::new());
        let mut sums = vec![0_u64; shapes];
        for index in order {
            let start = counts.len();
            counts.extend(counts_of(index));
            let own: &[ShapeCount] = &counts[start..];
            let known = |count: &ShapeCount| usize::from(count.shape) < shapes && count.poses > 0;
            let what = "a count of a shape that is not in the set";
            check(own.iter().all(known), what)?;
            let ordered = own.windows(2).all(|pair| pair[0].shape < pair[1].shape);
            let what = "counts that are not in the order of the shapes";
            check(!own.is_empty() && ordered, what)?;
            for count in own {
                let sum = &mut sums[usize::from(count.shape)];
                *sum = sum
                    .checked_add(count.poses)
                    .ok_or(ModelError::invalid("counts beyond any number of poses"))?;
            }
            starts.push(counts.len());
        }
        let summed = sums.iter().all(|&sum| sum == head.poses);
        check(summed, "counts that do not sum up to the number of poses")?;
        let ranged = poses(&head.ranges, head.shard) == Some(head.poses);
        check(ranged, "a number of poses that is not that of the ranges")?;
        let cut = head.cut.iter().all(|&cut| cut <= head.poses);
        check(cut, "more poses cut off than there are")?;
        Ok(Self {
            fits: vec![OnceLock::new(); shapes],
            head,
            keys,
            starts,
            counts,
            scan: OnceLock::new(),
        })
    }

    /// Unites models of different shapes that [`Training::fitting`] made in the same steps: the model that one such
    /// training of all shapes makes. The sensor and the cell of positions are those of all shapes; where on a sensor the
    /// cell lies changes no key.
    ///
    /// # Errors
    /// Returns an error if there is no model, if their poses differ in more than where the cell lies, or if two shapes
    /// have the same name.
    pub fn united(models: &[Self]) -> Result<Self, ModelError> {
        let shapes: Vec<NamedShape> = models.iter().flat_map(Self::shapes).cloned().collect();
        check_shapes(&shapes)?;
        let other_poses = || ModelError::invalid("models of other poses");
        let ranges = models.first().map(Self::ranges).ok_or_else(other_poses)?;
        let steps = GridSteps {
            positions: CellPositions::of(ranges).ok_or_else(other_poses)?,
            angles: ranges[Axis::Angle],
        };
        let training = Training::fitting(shapes, steps);
        let training = training.map_err(|error| ModelError(error.to_string().into()))?;
        let mut head = training.head();
        head.cut.clear();
        let mut gathered = Gathered::default();
        for model in models {
            if !model.head.same_poses(&head) {
                return Err(other_poses());
            }
            gathered.add_all(model, u16::try_from(head.cut.len()).unwrap_or(u16::MAX));
            head.cut.extend_from_slice(&model.head.cut);
        }
        gathered.finish(head)
    }

    /// Returns everything except the keys.
    pub fn head(&self) -> &ModelHead {
        &self.head
    }

    /// Returns the shapes, in the order of the set.
    pub fn shapes(&self) -> &[NamedShape] {
        &self.head.shapes
    }

    /// Returns the sensor that the shapes were touched with.
    pub fn sensor(&self) -> &Sensor {
        &self.head.sensor
    }

    /// Returns the point of the shape that x0 and y0 locate.
    pub fn anchor(&self) -> Anchor {
        self.head.anchor
    }

    /// Returns the poses in which each shape was touched.
    pub fn ranges(&self) -> &Ranges {
        &self.head.ranges
    }

    /// Returns the part of the poses that the model holds. Only a model with [`Shard::WHOLE`] should answer touches.
    pub fn shard(&self) -> Shard {
        self.head.shard
    }

    /// Returns the number of poses of each shape.
    pub fn poses(&self) -> u64 {
        self.head.poses
    }

    /// Returns how many poses of each shape the sensor cuts off, in the order of the set.
    pub fn cut(&self) -> &[u64] {
        &self.head.cut
    }

    /// Returns the keys in their order.
    pub fn keys(&self) -> &KeyTable {
        &self.keys
    }

    /// Returns the shapes that leave the key of that index, in the order of the set; empty if there are not that many
    /// keys.
    pub fn counts(&self, key: usize) -> &[ShapeCount] {
        let end = key.checked_add(1).and_then(|next| self.starts.get(next));
        end.map_or(&[], |&end| &self.counts[self.starts[key]..end])
    }

    /// Returns the shapes that leave the key of an imprint; empty if no shape does.
    pub fn counts_of(&self, imprint: &Imprint) -> &[ShapeCount] {
        self.keys
            .find(&ImprintKey::of(imprint))
            .map_or(&[], |key| self.counts(key))
    }

    pub(super) fn scan_tables(&self) -> &ScanTables {
        self.scan.get_or_init(|| {
            let index = KeyIndex::new(&self.keys);
            let mut poses = vec![0; index.boxes().len() * self.head.shapes.len()];
            for (own, sums) in (index.boxes().iter()).zip(poses.chunks_mut(self.head.shapes.len()))
            {
                for count in own.keys.clone().flat_map(|key| self.counts(key)) {
                    sums[usize::from(count.shape)] += count.poses;
                }
            }
            ScanTables { index, poses }
        })
    }

    pub(super) fn start_poses(&self, shape: usize) -> Option<&StartPoses> {
        let starts = self.fits.get(shape)?;
        starts.get_or_init(|| StartPoses::new(self, shape)).as_ref()
    }

    pub(super) fn weighted(&self, count: ShapeCount) -> u128 {
        u128::from(count.poses) * u128::from(self.head.shapes[usize::from(count.shape)].weight)
    }

    /// Iterates over the shapes of some counts, each with its count times its weight.
    pub(super) fn weighted_shapes<'a>(
        &'a self,
        counts: &'a [ShapeCount],
    ) -> impl Iterator<Item = (usize, u128)> + Clone + 'a {
        let counts = counts.iter();
        counts.map(|&count| (usize::from(count.shape), self.weighted(count)))
    }

    pub(super) fn log_weights(&self) -> Vec<f64> {
        let weights = self.head.shapes.iter().map(|shape| f64::from(shape.weight));
        weights.map(libm::log).collect()
    }

    pub(super) fn weights(&self) -> u128 {
        let shapes = self.head.shapes.iter();
        shapes.map(|shape| u128::from(shape.weight)).sum()
    }
}

/// Returns the number of poses of a grid, or of a part of it; None if it is too large for any grid.
fn poses(ranges: &Ranges, shard: Shard) -> Option<u64> {
    let count = |axis: Axis| ranges[axis].count();
    let others = [Axis::Y0, Axis::Angle, Axis::ZoomX, Axis::ZoomY].map(count);
    let rows = others.into_iter().try_fold(1, u64::checked_mul);
    let own = rows.map(|rows| shard.rows(rows));
    let poses = own.and_then(|rows| (rows.end - rows.start).checked_mul(count(Axis::X0)));
    poses.filter(|&poses| poses <= MAX_POSES)
}

/// Adds ln n of a key to the logarithm of each shape of a set; −∞ for a shape that does not leave the key.
pub(super) fn add_log_counts(logarithms: &mut [f64], counts: &[ShapeCount]) {
    let mut counts = counts.iter().peekable();
    for (shape, logarithm) in logarithms.iter_mut().enumerate() {
        let own = counts.next_if(|count| usize::from(count.shape) == shape);
        *logarithm += own.map_or(f64::NEG_INFINITY, |own| libm::log(float(own.poses)));
    }
}

/// Converts a count to an `f64` for computing.
#[expect(
    clippy::cast_precision_loss,
    reason = "neither a mean nor a probability has more digits"
)]
pub(super) fn float(count: u64) -> f64 {
    count as f64
}

/// Returns the largest of some values, with the number of its shape; the first among equals. The values are in the
/// order of the set.
pub(super) fn first_of_most<T: PartialOrd>(
    values: impl IntoIterator<Item = (usize, T)>,
) -> Option<(usize, T)> {
    let larger = |best: (usize, T), next: (usize, T)| if next.1 > best.1 { next } else { best };
    values.into_iter().reduce(larger)
}

/// Keys with their counts, while they are gathered.
#[derive(Debug, Default)]
pub(super) struct Gathered {
    keys: KeyTable,
    counts: Vec<Vec<ShapeCount>>,
}

impl Gathered {
    /// Adds a count to those of a key of another table, which stay in the order of the shapes.
    pub(super) fn add(&mut self, key: KeyRef<'_>, more: ShapeCount) {
        let slot = self.keys.intern(key);
        if slot == self.counts.len() {
            self.counts.push(Vec::new());
        }
        add_count(&mut self.counts[slot], more);
    }

    /// Adds all counts of a model, whose first shape has this number.
    fn add_all(&mut self, model: &Model, first: u16) {
        for index in 0..model.keys.len() {
            for count in model.counts(index) {
                let shape = first.saturating_add(count.shape);
                self.add(model.keys.get(index), ShapeCount::new(shape, count.poses));
            }
        }
    }

    pub(super) fn finish(self, head: ModelHead) -> Result<Model, ModelError> {
        Model::of_table(head, &self.keys, |index| self.counts[index].iter().copied())
    }
}

/// Adds a count to others, which stay in the order of the shapes.
pub(super) fn add_count(counts: &mut Vec<ShapeCount>, more: ShapeCount) {
    match counts.binary_search_by_key(&more.shape, |count| count.shape) {
        Ok(index) => counts[index].poses += more.poses,
        Err(index) => counts.insert(index, more),
    }
}

/// The shards of a training that were added so far. Memory holds only what is already merged and one shard.
#[derive(Debug, Default)]
pub struct ModelMerge {
    head: Option<ModelHead>,
    gathered: Gathered,
}

impl ModelMerge {
    /// Adds the next shard: the first, then the second, and so on.
    ///
    /// # Errors
    /// Returns an error if it is not the next one, or of another training than the first. The merge then stays
    /// unchanged.
    pub fn add(&mut self, model: &Model) -> Result<(), MergeError> {
        let shard = model.shard();
        // Everything is checked before anything changes: after a refusal, the right shard can still be added.
        if let Some(head) = &self.head
            && !model.head().same_training(head)
        {
            let text = format!("shard {shard} belongs to another training");
            return Err(MergeError(text));
        }
        shard.check_after(self.head.as_ref().map(|head| head.shard))?;
        match &mut self.head {
            None => self.head = Some(model.head().clone()),
            Some(head) => {
                // Each is at most the number of poses of a grid.
                head.poses += model.poses();
                head.shard = shard;
                for (sum, cut) in head.cut.iter_mut().zip(model.cut()) {
                    *sum += cut;
                }
            }
        }
        self.gathered.add_all(model, 0);
        Ok(())
    }

    /// Returns the model of all shards.
    ///
    /// # Errors
    /// Returns an error if some or all are missing, or if their numbers contradict each other.
    pub fn finish(self) -> Result<Model, MergeError> {
        let mut head = self.head.ok_or_else(MergeError::nothing)?;
        head.shard.check_last()?;
        head.shard = Shard::WHOLE;
        let model = self.gathered.finish(head);
        model.map_err(|error| MergeError(error.to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Figure;

    #[test]
    fn a_set_may_have_as_many_shapes_as_the_error_says() {
        let bar = Figure::rectangle(2.0, 1.0).on(&Sensor::default());
        let bar = bar.expect("in range");
        let shape = |number: usize| NamedShape::new(number.to_string(), bar);
        let mut shapes: Vec<NamedShape> = (0..MAX_SHAPES).map(shape).collect();
        assert_eq!(check_shapes(&shapes), Ok(()));
        shapes.push(shape(MAX_SHAPES));
        let refused = check_shapes(&shapes).expect_err("one more");
        assert_eq!(refused.to_string(), "32769 shapes, expected 1 to 32768");
    }

    #[test]
    fn models_of_one_shape_each_are_united_to_the_model_of_all() {
        use crate::recognition::{GridSteps, Training, equal_figures};
        let steps = GridSteps::of(5, "0:330:30");
        // The disc's cell of positions begins between whole cells; the bar is too large for 16 × 16.
        let large = [Figure::ellipse(7.5, 7.5), Figure::rectangle(16.0, 9.0)];
        let large = large.map(|own| own.on(&Sensor::LARGEST).expect("in range"));
        let mut shapes = equal_figures();
        let trained = |shapes: Vec<NamedShape>| {
            let training = Training::fitting(shapes, steps).expect("they fit");
            training.run().expect("not stopped")
        };
        let parts = |shapes: &[NamedShape]| -> Vec<Model> {
            shapes
                .iter()
                .map(|own| trained(vec![own.clone()]))
                .collect()
        };
        for (name, figure) in ["disc", "bar"].into_iter().zip(large) {
            shapes.insert(2, NamedShape::new(name, figure).weighted(3));
            assert_eq!(Model::united(&parts(&shapes)), Ok(trained(shapes.clone())));
        }
        let parts = parts(&shapes[..2]);
        assert!(Model::united(&[parts[0].clone(), parts[0].clone()]).is_err());
        let other = Training::fitting(vec![shapes[1].clone()], GridSteps::of(5, "0:345:15"));
        let other = other.expect("it fits").run().expect("not stopped");
        assert!(Model::united(&[parts[0].clone(), other]).is_err());
    }
}
