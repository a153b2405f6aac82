//! The request of the page of sizes: a set, sizes, and the steps in which each shape touches.

use std::sync::Arc;

use crate::formats::separation::short;
use crate::pose::{Axis, DecimalRange, RangeError};
use crate::quote::shortened;
use crate::recognition::{CellPositions, Separation, SizeAxis, TrainingError};
use crate::tui::prompt::flags;
use crate::tui::recognise::trained::TrainedModel;

/// The default sizes: from half as large to three times as large.
const SIZES: &str = "0.5:3:0.1";

/// The default number of steps in a cell in each direction. More steps show more kinds of imprints, and take longer.
const POSITIONS: CellPositions = CellPositions::COARSE;
/// The default step between angles, in degrees.
const DEGREES: u32 = 2;

/// The default wanted error.
const WANTED: f64 = 0.01;

/// A request to evaluate sizes.
#[derive(Clone, Debug)]
pub struct SeparationRequest {
    /// The model of the set.
    pub trained: Arc<TrainedModel>,
    /// The quantity that the sizes give: a scale or a pitch.
    pub axis: SizeAxis,
    /// The sizes.
    pub sizes: DecimalRange,
    /// The threshold of the sensor.
    pub threshold: f64,
    /// The number of steps in a cell, in each direction.
    pub positions: CellPositions,
    /// The angles.
    pub angles: DecimalRange,
    /// The wanted error.
    pub wanted: f64,
}

impl PartialEq for SeparationRequest {
    /// Returns true if the same points answer both requests; the wanted error is only looked up in them.
    fn eq(&self, other: &Self) -> bool {
        let key = |own: &Self| (own.axis, own.sizes, own.positions, own.angles);
        self.trained == other.trained
            && key(self) == key(other)
            && self.threshold == other.threshold
    }
}

/// The flags that may follow `:separate`; None if a flag is not given.
#[derive(Clone, Debug, PartialEq)]
pub struct SeparationFlags {
    /// The quantity that the sizes give, and the sizes.
    sizes: Option<(SizeAxis, DecimalRange)>,
    /// The threshold.
    threshold: Option<f64>,
    /// The number of steps in a cell.
    positions: Option<CellPositions>,
    /// The angles.
    angles: Option<DecimalRange>,
    /// The wanted error.
    wanted: Option<f64>,
}

impl SeparationFlags {
    /// No flags.
    pub const NONE: Self = Self {
        sizes: None,
        threshold: None,
        positions: None,
        angles: None,
        wanted: None,
    };

    /// The names of the flags, for completion.
    pub const NAMES: [&'static str; 6] = [
        "--scale",
        "--pitch",
        "--threshold",
        "--positions",
        "--angle",
        "--want",
    ];

    /// Reads flags, each followed by its value.
    ///
    /// # Errors
    /// Returns what is wrong with them, as a sentence.
    pub fn read(words: &[&str]) -> Result<Self, String> {
        let known = |flag: &str| Self::NAMES.into_iter().find(|own| *own == flag);
        let mut flags = Self::NONE;
        let given = flags::read(words, &Self::NAMES, known)?;
        for (flag, _, text) in &given {
            flags.take(flag, text)?;
        }
        let is_given = |name: &str| given.iter().any(|(flag, ..)| *flag == name);
        if is_given("--scale") && is_given("--pitch") {
            return Err("--scale and --pitch do not go together".to_owned());
        }
        Ok(flags)
    }

    /// Takes over the value of one flag.
    fn take(&mut self, flag: &str, text: &str) -> Result<(), String> {
        let range = || {
            let range = text.parse();
            range.map_err(|error: RangeError| format!("{flag}: {error}"))
        };
        let number = |expected: &str, fits: fn(f64) -> bool| {
            let number: Option<f64> = text.parse().ok();
            let found = shortened(text);
            let number = number.filter(|number| fits(*number));
            number.ok_or_else(|| format!("{flag} takes {expected}, found {found}"))
        };
        match flag {
            "--scale" | "--pitch" => {
                let axis = match flag {
                    "--pitch" => SizeAxis::Pitch,
                    _ => SizeAxis::Scale,
                };
                let sizes: DecimalRange = range()?;
                if sizes.value(0) <= 0.0 {
                    return Err(format!("{flag} takes numbers above 0"));
                }
                self.sizes = Some((axis, sizes));
            }
            "--threshold" => {
                let fits = |number| number > 0.0 && number <= 1.0;
                self.threshold = Some(number("a number above 0, up to 1", fits)?);
            }
            "--want" => {
                self.wanted = Some(number("a number from 0 to 1", |number| {
                    (0.0..=1.0).contains(&number)
                })?);
            }
            "--angle" => self.angles = Some(range()?),
            _ => {
                let count = text.parse().ok();
                let positions = count.and_then(|count| CellPositions::new(count).ok());
                let found = shortened(text);
                let refused = || format!("{flag} takes a divisor of 100, found {found}");
                self.positions = Some(positions.ok_or_else(refused)?);
            }
        }
        Ok(())
    }

    /// Returns the request for a set; missing flags have their defaults.
    pub fn request(&self, trained: Arc<TrainedModel>) -> SeparationRequest {
        let scales = || Some((SizeAxis::Scale, SIZES.parse().ok()?));
        let (axis, sizes) = self
            .sizes
            .or_else(scales)
            .unwrap_or((SizeAxis::Scale, DecimalRange::whole(1)));
        let ranges = trained.model.ranges();
        let own = &ranges[Axis::Angle];
        // A model with coarser steps of its own is touched in these.
        let coarse = format!("0:{}:{DEGREES}", 360 - DEGREES).parse().ok();
        let usual = coarse.filter(|_| own.count() == 360);
        let threshold = trained.model.sensor().threshold();
        SeparationRequest {
            axis,
            sizes,
            threshold: self.threshold.unwrap_or(threshold),
            positions: self.positions.unwrap_or(POSITIONS),
            angles: self.angles.or(usual).unwrap_or(*own),
            wanted: self.wanted.unwrap_or(WANTED),
            trained,
        }
    }
}

impl SeparationRequest {
    /// Returns the set with these steps.
    ///
    /// # Errors
    /// Returns the errors of [`Separation::new`], which do not occur with a trained set.
    pub fn separation(&self) -> Result<Separation, TrainingError> {
        let separation = Separation::new(self.trained.model.shapes().to_vec())?;
        Ok(separation
            .with_positions(self.positions)
            .with_angles(self.angles))
    }

    /// Returns the sizes, the smallest first.
    pub fn values(&self) -> Vec<f64> {
        self.axis.smallest_first(&self.sizes)
    }

    /// Returns the steps in words.
    pub fn steps(&self) -> String {
        let positions = match self.positions.get() {
            1 => "one position".to_owned(),
            count => format!("{count} × {count} positions"),
        };
        format!(
            "{positions} per cell, angle {}; threshold {}",
            self.angles,
            short(self.threshold)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_read_and_errors_name_the_problem() {
        let read = |line: &str| {
            let words: Vec<&str> = line.split_whitespace().collect();
            SeparationFlags::read(&words)
        };
        let flags = read("--pitch 1:4:0.5 --want 0.05 --positions 20").expect("flags");
        assert_eq!(flags.sizes.map(|(axis, _)| axis), Some(SizeAxis::Pitch));
        assert_eq!(
            (flags.wanted, flags.positions),
            (Some(0.05), CellPositions::new(20).ok())
        );
        assert_eq!(read(""), Ok(SeparationFlags::NONE));
        for (line, part) in [
            ("--scale", "--scale needs a value"),
            ("--scale 0:1:0.1", "above 0"),
            ("--scale 1 --pitch 1", "do not go together"),
            ("--scale 1 --scale 2", "twice"),
            ("--want 2", "from 0 to 1, found 2"),
            ("--positions 7", "a divisor of 100, found 7"),
            ("--size 3", "--size is unknown, expected one of --scale"),
        ] {
            let error = read(line).expect_err(line);
            assert!(error.contains(part), "{line}: {error}");
        }
    }
}
