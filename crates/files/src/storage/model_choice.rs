//! The choice of a model for recognition: a set of shapes that comes with the program, a stored model, or a file.

use std::ffi::OsStr;
use std::fmt;
use std::path::PathBuf;
use std::sync::OnceLock;

use crate::formats::{Name, StoredShape};
use crate::picture::Picture;
use crate::quote::{did_you_mean, shortened};
use crate::recognition::{
    GridSteps, NamedShape, Training, TrainingError, default_figures, equal_figures,
};
use crate::storage::shipped;

/// A set of shapes that can be chosen for recognition.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
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
    /// The choices that need no file.
    pub const BUILT_IN: &'static [Self] = &[Self::Figures, Self::EqualFigures, Self::Shipped];

    /// Returns the choice of that name: a built-in one, otherwise a stored model.
    pub fn from_name(name: Name) -> Self {
        let own = Self::BUILT_IN.iter().find(|own| name.same(own.name()));
        own.cloned().unwrap_or(Self::Stored(name))
    }

    /// Reads the text after `:recognise`: the name of a set or model, otherwise the path of a file.
    pub fn from_text(text: &str) -> Self {
        Name::new(text).map_or_else(|_| Self::File(text.into()), Self::from_name)
    }

    /// Returns the name that is used after `:recognise`.
    pub fn name(&self) -> &str {
        match self {
            Self::Figures => "figures",
            Self::EqualFigures => "figures-30",
            Self::Shipped => "shapes",
            Self::Stored(name) => name.as_str(),
            Self::File(path) => path.file_name().and_then(OsStr::to_str).unwrap_or("file"),
        }
    }

    /// Returns the training of a built-in set; None for a stored model or a file. How far its shapes reach is
    /// computed once.
    ///
    /// # Errors
    /// Returns an error if the set cannot be trained.
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

    /// Returns true if the model is read from a file of the user's rather than trained.
    pub fn is_read(&self) -> bool {
        matches!(self, Self::Stored(_) | Self::File(_))
    }
}

/// Returns the message for an unknown set; it lists the built-in sets and the stored models.
pub fn unknown_set(name: &str, stored: &[Name]) -> String {
    let own = ModelChoice::BUILT_IN.iter().map(ModelChoice::name);
    let is_own = |stored: &&Name| {
        let mut own = ModelChoice::BUILT_IN.iter();
        own.any(|own| stored.same(own.name()))
    };
    let stored = stored.iter().filter(|stored| !is_own(stored));
    let all: Vec<&str> = own.chain(stored.map(Name::as_str)).collect();
    format!(
        "no model or file named {:?}; models: {}{}",
        shortened(name),
        all.join(", "),
        did_you_mean(name, all.iter().copied())
    )
}

impl fmt::Display for ModelChoice {
    /// Writes "model" and the name that is used after `:recognise`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "model {}", self.name())
    }
}

/// Returns the shapes that come with the program, as pictures.
fn shipped_shapes() -> Vec<NamedShape> {
    let picture = |shape: StoredShape| {
        NamedShape::new(shape.name.to_string(), Picture::at_home(shape.imprint))
    };
    shipped::all().map(picture).collect()
}
