//! The sets of shapes that can be chosen, and how each is trained.

use std::ffi::OsStr;
use std::fmt;
use std::path::PathBuf;
use std::sync::OnceLock;

use rand_core::SeedableRng;
use rand_pcg::Pcg64;

use crate::formats::{Name, StoredShape};
use crate::picture::Picture;
use crate::pose::{Axis, DecimalRange, PoseGrid, Ranges};
use crate::quote::{did_you_mean, shortened};
use crate::recognition::{
    Evaluation, GridSteps, Model, NamedShape, Training, TrainingError, below, default_figures,
    equal_figures,
};
use crate::storage::shipped;
use crate::touch::Plane;
use crate::tui::recognise::confused::Examples;

/// A set of shapes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ModelChoice {
    /// The seven figures at the sizes that forms propose.
    Figures,
    /// The seven figures of about 30 cells.
    EqualFigures,
    /// The shapes that come with the program.
    Shipped,
    /// A stored model.
    Stored(Name),
    /// A model in a file.
    File(PathBuf),
}

/// The steps of the grid of the shapes that come with the program. In hundredths and whole degrees they leave 5.2
/// million imprints; in these steps they are trained in a second or two.
const SHIPPED_STEPS: GridSteps = GridSteps::COARSE;

impl ModelChoice {
    /// Those that need no file.
    pub const BUILT_IN: [Self; 3] = [Self::Figures, Self::EqualFigures, Self::Shipped];

    /// The choice of that name: a built-in one, otherwise a stored model.
    pub fn from_name(name: Name) -> Self {
        let own = Self::BUILT_IN.into_iter().find(|own| name.same(own.name()));
        own.unwrap_or(Self::Stored(name))
    }

    /// What stands after `:recognise`: the name of a set or model, otherwise the path of a file.
    pub fn from_text(text: &str) -> Self {
        Name::new(text).map_or_else(|_| Self::File(text.into()), Self::from_name)
    }

    /// Its name after `:recognise`.
    pub fn name(&self) -> &str {
        match self {
            Self::Figures => "figures",
            Self::EqualFigures => "figures-30",
            Self::Shipped => "shapes",
            Self::Stored(name) => name.as_str(),
            Self::File(path) => path.file_name().and_then(OsStr::to_str).unwrap_or("file"),
        }
    }

    /// The training of a built-in set; None of a stored model. How far its shapes reach is computed once.
    ///
    /// # Errors
    /// Why it cannot be trained.
    pub fn training(&self) -> Option<Result<Training<'static>, TrainingError>> {
        static FITTED: [OnceLock<Result<Training<'static>, TrainingError>>; 3] =
            [const { OnceLock::new() }; 3];
        let (number, shapes, steps): (_, fn() -> Vec<NamedShape>, _) = match self {
            Self::Figures => (0, default_figures, GridSteps::FINE),
            Self::EqualFigures => (1, equal_figures, GridSteps::FINE),
            Self::Shipped => (2, shipped_shapes, SHIPPED_STEPS),
            Self::Stored(_) | Self::File(_) => return None,
        };
        let fitted = FITTED[number].get_or_init(|| Training::fitting(shapes(), steps));
        Some(fitted.clone())
    }
}

/// That there is no set of a name, and which ones there are: the built-in ones and `stored` models.
pub(crate) fn unknown_set(name: &str, stored: &[Name]) -> String {
    let own = ModelChoice::BUILT_IN.iter().map(ModelChoice::name);
    let is_own = |stored: &&Name| {
        let mut own = ModelChoice::BUILT_IN.iter();
        own.any(|own| stored.same(own.name()))
    };
    let stored = stored.iter().filter(|stored| !is_own(stored));
    let all: Vec<&str> = own.chain(stored.map(Name::as_str)).collect();
    format!(
        "no model or file {:?}; there are {}{}",
        shortened(name),
        all.join(", "),
        did_you_mean(name, all.iter().copied())
    )
}

impl ModelChoice {
    /// Whether its model is read from a file of the user's rather than trained.
    pub fn is_read(&self) -> bool {
        matches!(self, Self::Stored(_) | Self::File(_))
    }
}

impl fmt::Display for ModelChoice {
    /// What it is, with its name after `:recognise`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "model {}", self.name())
    }
}

/// The shapes that come with the program, as pictures.
fn shipped_shapes() -> Vec<NamedShape> {
    let picture = |shape: StoredShape| {
        NamedShape::new(shape.name.to_string(), Picture::at_home(shape.imprint))
    };
    shipped::all().map(picture).collect()
}

/// A model with what is known of it as a whole.
#[derive(Debug)]
pub struct TrainedModel {
    /// The set.
    pub choice: ModelChoice,
    /// Its model.
    pub model: Model,
    /// How well it tells its shapes apart.
    pub evaluation: Evaluation,
    /// An imprint of each cell of its confusion matrix.
    pub examples: Examples,
    /// Where its grid is coarser than hundredths and whole degrees: the share of poses in these steps that leave an
    /// imprint which the model does not know.
    pub unknown_between: Option<f64>,
}

impl PartialEq for TrainedModel {
    /// Whether they are one: they are never changed.
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl TrainedModel {
    /// Evaluates a model.
    pub fn new(choice: ModelChoice, model: Model) -> Self {
        Self {
            evaluation: Evaluation::of(&model),
            examples: Examples::of(&model),
            unknown_between: unknown_between(&model),
            choice,
            model,
        }
    }

    /// The name of a shape, counted from 0; empty if there are not that many.
    pub fn name(&self, shape: usize) -> &str {
        let shape = self.model.shapes().get(shape);
        shape.map_or("", |shape| &shape.name)
    }

    /// The grid of poses of a shape; None if there are not that many shapes.
    pub fn grid(&self, shape: usize) -> Option<PoseGrid> {
        grid_of(&self.model, shape, *self.model.ranges())
    }
}

#[cfg(test)]
impl TrainedModel {
    /// A small model under the name of a set: a bar of 6 × 2 at every tenth of a cell and ten degrees.
    pub(in crate::tui) fn of_a_bar(choice: ModelChoice) -> Self {
        use crate::figure::Figure;
        use crate::pose::Anchor;
        use crate::sensor::Sensor;

        let sensor = Sensor::default();
        let bar = Figure::rectangle(6.0, 2.0).on(&sensor).expect("in range");
        let cell = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, cell("5:5.9:0.1"))
            .with(Axis::Y0, cell("5:5.9:0.1"))
            .with(Axis::Angle, cell("0:170:10"));
        let training = Training::new(
            [NamedShape::new("bar", bar)],
            sensor,
            Anchor::Centre,
            ranges,
        );
        let model = training.expect("a set").run().expect("not stopped");
        Self::new(choice, model)
    }
}

/// The poses of a shape on the sensor of its model, in these ranges: those of the model, or finer ones to try poses
/// between.
fn grid_of(model: &Model, shape: usize, ranges: Ranges) -> Option<PoseGrid> {
    let source = model.shapes().get(shape)?.source.clone();
    PoseGrid::new(source, *model.sensor(), model.anchor(), ranges).ok()
}

/// Poses per shape that are tried.
const TRIED: u32 = 100;

/// The share of random poses in hundredths and whole degrees whose imprint a model does not know. None if its own steps
/// are as fine.
fn unknown_between(model: &Model) -> Option<f64> {
    let ranges = model.ranges();
    let axes = [(Axis::X0, 0.01), (Axis::Y0, 0.01), (Axis::Angle, 1.0)];
    let mut fine = *ranges;
    for (axis, step) in axes {
        fine[axis] = finer(&ranges[axis], step).unwrap_or(ranges[axis]);
    }
    if fine == *ranges {
        return None;
    }
    let mut random = Pcg64::seed_from_u64(0);
    let (mut tried, mut unknown) = (0_u32, 0_u32);
    let mut plane = Plane::new(*model.sensor());
    for shape in 0..model.shapes().len() {
        let Some(grid) = grid_of(model, shape, fine) else {
            continue;
        };
        for _ in 0..TRIED {
            let pose = grid.pose(below(&mut random, grid.poses()));
            let imprint = plane.touch(&grid.placed(pose));
            tried += 1;
            unknown += u32::from(model.counts_of(&imprint).is_empty());
        }
    }
    (tried > 0).then(|| f64::from(unknown) / f64::from(tried))
}

/// The same range in smaller steps, up to before the value that would come next. None if its steps are as small.
fn finer(range: &DecimalRange, step: f64) -> Option<DecimalRange> {
    if range.count() < 2 || range.step() < 1.5 * step {
        return None;
    }
    let last = range.last() + range.step() - step;
    format!("{:.2}:{last:.2}:{step}", range.value(0))
        .parse()
        .ok()
}
