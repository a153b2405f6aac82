//! What is asked of the page of sizes: a set, sizes, and the steps in which each shape touches.

use std::sync::Arc;

use crate::formats::separation::short;
use crate::pose::{Axis, DecimalRange, RangeError};
use crate::quote::shortened;
use crate::recognition::{CellPositions, Separation, SizeAxis, TrainingError};
use crate::tui::prompt::flags;
use crate::tui::recognise::trained::TrainedModel;

/// The sizes that are looked at unless others are asked for: half as large to three times as large.
const SIZES: &str = "0.5:3:0.1";

/// Steps of a cell in each direction, unless others are asked for. Finer ones show more kinds of imprints, and take
/// longer.
const POSITIONS: CellPositions = CellPositions::COARSE;
/// Degrees between angles, unless others are asked for.
const DEGREES: u32 = 2;

/// The error that is looked for unless another one is asked for.
const WANTED: f64 = 0.01;

/// What is looked at.
#[derive(Clone, Debug)]
pub struct SeparationRequest {
    /// The set.
    pub trained: Arc<TrainedModel>,
    /// What sizes are measured against.
    pub axis: SizeAxis,
    /// The sizes.
    pub sizes: DecimalRange,
    /// The threshold of the sensor.
    pub threshold: f64,
    /// Steps of a cell in each direction.
    pub positions: CellPositions,
    /// The angles.
    pub angles: DecimalRange,
    /// The error to reach.
    pub wanted: f64,
}

impl PartialEq for SeparationRequest {
    /// Whether the same points answer both; the wanted error is only looked up in them.
    fn eq(&self, other: &Self) -> bool {
        let key = |own: &Self| (own.axis, own.sizes, own.positions, own.angles);
        self.trained == other.trained
            && key(self) == key(other)
            && self.threshold == other.threshold
    }
}

/// What may follow `:separate`. None for what is not given.
#[derive(Clone, Debug, PartialEq)]
pub struct SeparationFlags {
    /// What sizes are measured against, and the sizes.
    sizes: Option<(SizeAxis, DecimalRange)>,
    /// The threshold.
    threshold: Option<f64>,
    /// Steps of a cell.
    positions: Option<CellPositions>,
    /// The angles.
    angles: Option<DecimalRange>,
    /// The error to reach.
    wanted: Option<f64>,
}

impl SeparationFlags {
    /// Nothing in particular.
    pub const NONE: Self = Self {
        sizes: None,
        threshold: None,
        positions: None,
        angles: None,
        wanted: None,
    };

    /// The flags, for completion.
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
    /// What is wrong with them, in a sentence.
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

    /// Takes the value of one flag.
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

    /// What they ask of a set; what is not given is as usual.
    pub fn request(&self, trained: Arc<TrainedModel>) -> SeparationRequest {
        let scales = || Some((SizeAxis::Scale, SIZES.parse().ok()?));
        let (axis, sizes) = self
            .sizes
            .or_else(scales)
            .unwrap_or((SizeAxis::Scale, DecimalRange::whole(1)));
        let ranges = trained.model.ranges();
        let own = &ranges[Axis::Angle];
        // A model in coarser steps of its own is touched in these.
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
    /// The set in these steps.
    ///
    /// # Errors
    /// Those of [`Separation::new`], which a trained set has none of.
    pub fn separation(&self) -> Result<Separation, TrainingError> {
        let separation = Separation::new(self.trained.model.shapes().to_vec())?;
        Ok(separation.positions(self.positions).angles(self.angles))
    }

    /// The sizes, the smallest first.
    pub fn values(&self) -> Vec<f64> {
        self.axis.smallest_first(&self.sizes)
    }

    /// The steps in words.
    pub fn steps(&self) -> String {
        let positions = match self.positions.get() {
            1 => "one position".to_owned(),
            count => format!("{count} × {count} positions"),
        };
        format!(
            "{positions} of a cell, angle {}; threshold {}",
            self.angles,
            short(self.threshold)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_read_or_say_what_is_wrong() {
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
