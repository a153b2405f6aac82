//! What stands beside the cells in lines that no header names: the frame's number, its time or both.
//! ```text
//! 0,0.00,1,2,3,4      number and time before the cells
//! 0.00,1,2,3,4        one of them before the cells
//! 1,2,3,4,0.00        one of them behind the cells
//! 0,1,2,3,4,0.00      the number before, the time behind
//! 1,2,3,4,0,50        number and milliseconds behind the cells
//! ```
//! Numbers count up by 1 from line to line and times do not fall, while cells do both. Where cells happen to grow, too, the
//! better evidence decides (see [`FieldEvidence`]); where that is equal, the lines are refused, since a wrong guess would
//! shift all cells by one.

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::frame_time::{TimeFields, TimeUnit};
use crate::formats::recording::text_row;
use crate::parameter::number::counted;

/// Steps of a clock differ from their mean by no more than this part of it.
const UNEVEN: f64 = 0.1;

/// How a field grows from line to line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FieldGrowth {
    /// It stays the same.
    Constant,
    /// It stays the same or rises; or it is 0, as the offset of a message of ROS.
    NotFalling,
    /// It rises with each line.
    Rising,
    /// It rises by about the same with each line, and there are at least three.
    Steady,
    /// It rises by 1 with each line.
    Counting,
}

impl FieldGrowth {
    /// How much it says: cells may happen to rise for a few lines, but seldom evenly.
    fn strength(self) -> u8 {
        match self {
            Self::Constant => 0,
            Self::NotFalling | Self::Rising => 1,
            Self::Steady | Self::Counting => 2,
        }
    }

    /// That of a field; None if it falls or is no number somewhere. A single line has constant fields only.
    fn of(lines: &[Vec<f64>], field: usize) -> Option<Self> {
        let value = |line: &Vec<f64>| line.get(field).copied().unwrap_or(f64::NAN);
        let pairs = lines.windows(2);
        let steps: Vec<f64> = pairs
            .map(|pair| value(&pair[1]) - value(&pair[0]))
            .collect();
        // NaN is neither.
        if !steps.iter().all(|step| *step >= 0.0) {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "a mean of a few steps")]
        let mean = steps.iter().sum::<f64>() / steps.len().max(1) as f64;
        Some(if mean == 0.0 {
            Self::Constant
        } else if steps.contains(&0.0) {
            Self::NotFalling
        } else if steps.iter().all(|step| *step == 1.0) {
            Self::Counting
        } else if steps.len() > 1
            && steps
                .iter()
                .all(|step| (step - mean).abs() <= UNEVEN * mean)
        {
            Self::Steady
        } else {
            Self::Rising
        })
    }
}

/// Cells do not reach this number; a clock that counts from 1970 does.
const CLOCK: f64 = 1e9;

/// What speaks for such fields; the greater evidence decides.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct FieldEvidence {
    /// Whether none of the cells is as large as a clock.
    has_small_cells: bool,
    /// Whether the time has decimals and no cell has.
    is_only_decimal: bool,
    /// How much the growth of the time says, or that of the number where there is no time.
    strength: u8,
}

/// Where cells, number and time of a frame are, or may be.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnnamedFields {
    /// The first cell.
    pub(super) start: usize,
    /// The field of the number.
    pub(super) label: Option<usize>,
    /// The field of the time, with its unit where its place tells it.
    pub(super) time: Option<TimeFields>,
}

impl UnnamedFields {
    /// All that have one or two fields beside the cells; none of any other number of fields.
    fn all(cells: usize, beside: usize) -> Vec<Self> {
        let with = |start, label, time| Self { start, label, time };
        let time = |field| Some(TimeFields::new(field, None));
        let milliseconds = |field| Some(TimeFields::new(field, Some(TimeUnit::Milliseconds)));
        match beside {
            1 => vec![
                with(1, Some(0), None),
                with(1, None, time(0)),
                // The offset of a message of ROS.
                with(1, None, None),
                with(0, Some(cells), None),
                with(0, None, time(cells)),
            ],
            2 => vec![
                with(2, Some(0), time(1)),
                with(2, Some(1), time(0)),
                with(1, Some(0), time(cells + 1)),
                with(0, Some(cells), milliseconds(cells + 1)),
            ],
            _ => Vec::new(),
        }
    }

    /// What lines of so many cells say for it; None if they rule it out.
    fn evidence(self, lines: &[Vec<f64>], cells: usize) -> Option<FieldEvidence> {
        let growth_of = |field| FieldGrowth::of(lines, field);
        if let Some(label) = self.label {
            let counts = growth_of(label)? == FieldGrowth::Counting || lines.len() == 1;
            whole(lines[0][label]).filter(|_| counts)?;
        }
        let has_decimals = |field: usize| {
            let mut values = lines.iter().filter_map(|line| line.get(field));
            values.any(|value| value.fract() != 0.0)
        };
        let growth = match (self.label, self.time) {
            (Some(_), None) => FieldGrowth::Counting,
            (Some(_), Some(time)) => growth_of(time.field)?,
            // A time that does not change is none, unless there is a number beside it. What counts up by 1 is a number.
            (None, Some(time)) => growth_of(time.field).filter(|growth| {
                !matches!(growth, FieldGrowth::Constant | FieldGrowth::Counting)
            })?,
            (None, None) if lines.iter().all(|line| line.first() == Some(&0.0)) => {
                FieldGrowth::NotFalling
            }
            (None, None) => return None,
        };
        let is_decimal = lines.len() > 1 && self.time.is_some_and(|time| has_decimals(time.field));
        let cells = self.start..self.start + cells;
        let is_large = |value: &f64| value.abs() >= CLOCK;
        let has_large = |line: &Vec<f64>| {
            let own = line.get(cells.clone());
            own.is_some_and(|own| own.iter().any(is_large))
        };
        Some(FieldEvidence {
            has_small_cells: !lines.iter().any(has_large),
            is_only_decimal: is_decimal && !cells.clone().any(has_decimals),
            strength: growth.strength(),
        })
    }
}

/// Where the cells, the number and the time are in lines of so many cells without names, of which the first `before` numbers
/// are no cells. The first line is line `number` of the file.
///
/// # Errors
/// If the line has fewer fields than a frame has cells, or if other fields are not cells or may be.
pub(super) fn unnamed_fields(
    (cells, before): (usize, usize),
    number: u64,
    lines: &[Vec<f64>],
) -> Result<UnnamedFields, RecordingError> {
    let count = lines[0].len();
    let found = match count.checked_sub(cells) {
        Some(0) => Some(UnnamedFields {
            start: 0,
            label: None,
            time: None,
        }),
        Some(beside @ (1 | 2)) => {
            let mut all = UnnamedFields::all(cells, beside);
            all.retain(|own| own.start >= before.min(beside));
            most_evident(&all, lines, cells).map_err(|()| unclear(number, cells, beside))?
        }
        _ => None,
    };
    found.ok_or_else(|| text_row::count(number, count, cells))
}

/// The fields with the greatest evidence; None if all are ruled out. The last line may be torn: where all lines rule
/// out everything, those before it decide. With two numbers beside the cells, two lines are enough.
///
/// # Errors
/// If other fields may be the cells by the same evidence.
fn most_evident(
    all: &[UnnamedFields],
    lines: &[Vec<f64>],
    cells: usize,
) -> Result<Option<UnnamedFields>, ()> {
    let beside = lines[0].len() - cells;
    if lines.len() == 1 && beside == 1 && all.iter().any(|own| own.start == 0) {
        return Err(());
    }
    let fewest = match beside {
        1 => lines.len() - 1,
        _ => 2,
    };
    let fewest = fewest.clamp(lines.len().min(2), lines.len());
    for count in (fewest..=lines.len()).rev() {
        let evident = all.iter().filter_map(|own| {
            let evidence = own.evidence(&lines[..count], cells)?;
            Some((*own, evidence))
        });
        let evident: Vec<(UnnamedFields, FieldEvidence)> = evident.collect();
        let mut best: Option<(UnnamedFields, FieldEvidence)> = None;
        for own in &evident {
            if best.is_none_or(|best| own.1 > best.1) {
                best = Some(*own);
            }
        }
        let Some((found, evidence)) = best else {
            continue;
        };
        let is_rival =
            |own: &(UnnamedFields, FieldEvidence)| own.0.start != found.start && own.1 == evidence;
        return if evident.iter().any(is_rival) {
            Err(())
        } else {
            Ok(Some(found))
        };
    }
    Ok(None)
}

/// The error of lines that do not tell which fields are cells.
fn unclear(number: u64, cells: usize, beside: usize) -> RecordingError {
    let beside = counted(beside as u64, "number");
    let message = format!(
        "found {beside} besides the {cells} cells, and cannot tell which: add a header line, such as frame,time,r0c0"
    );
    RecordingError::in_line(number, message)
}

/// A number without a fraction, as labels are; None of any other, and beyond what a float counts exactly.
#[expect(clippy::cast_possible_truncation, reason = "checked")]
pub(super) fn whole(value: f64) -> Option<i64> {
    (value.fract() == 0.0 && value.abs() < 9e15).then_some(value as i64)
}
