//! Finds the fields beside the cells in lines without a header: the frame's number, its time or both.
//! ```text
//! 0,0.00,1,2,3,4      number and time before the cells
//! 0.00,1,2,3,4        one of them before the cells
//! 1,2,3,4,0.00        one of them behind the cells
//! 0,1,2,3,4,0.00      the number before, the time behind
//! 1,2,3,4,0,50        number and milliseconds behind the cells
//! ```
//! Numbers count up by 1 from line to line and times never fall; cells rise and fall. If cells happen to rise, too,
//! the better evidence decides (see [`FieldEvidence`]); if it is equal, the lines are refused, since a wrong guess
//! would shift all cells by one.

use crate::formats::recording::error::RecordingError;
use crate::formats::recording::table::clock::TimeFields;
use crate::formats::recording::text::number::whole;
use crate::formats::recording::text::row;
use crate::formats::recording::time::unit::TimeUnit;
use crate::parameter::number::counted;

/// The largest deviation of a clock's steps from their mean, as a share of the mean.
const UNEVEN: f64 = 0.1;

/// The growth of a field from line to line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FieldGrowth {
    /// The field stays the same.
    Constant,
    /// The field stays the same or rises; or it is 0, like the offset of a ROS message.
    NotFalling,
    /// The field rises with each line.
    Rising,
    /// The field rises by about the same amount with each line, in at least three lines.
    Steady,
    /// The field is whole and rises by 1 with each line.
    Counting,
}

impl FieldGrowth {
    /// Returns the strength as evidence: cells may happen to rise for a few lines, but rarely evenly.
    fn strength(self) -> u8 {
        match self {
            Self::Constant => 0,
            Self::NotFalling | Self::Rising => 1,
            Self::Steady | Self::Counting => 2,
        }
    }

    /// Returns the growth of a field; None if it falls or is not a number somewhere. In a single line, all fields are
    /// constant.
    fn of(lines: &[Vec<f64>], field: usize) -> Option<Self> {
        let value = |line: &Vec<f64>| line.get(field).copied().unwrap_or(f64::NAN);
        let pairs = lines.windows(2);
        let steps: Vec<f64> = pairs
            .map(|pair| value(&pair[1]) - value(&pair[0]))
            .collect();
        // A step of NaN fails this test, too.
        if !steps.iter().all(|step| *step >= 0.0) {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "a mean of a few steps")]
        let mean = steps.iter().sum::<f64>() / steps.len().max(1) as f64;
        Some(if mean == 0.0 {
            Self::Constant
        } else if steps.contains(&0.0) {
            Self::NotFalling
        } else if value(&lines[0]).fract() == 0.0 && steps.iter().all(|step| *step == 1.0) {
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

/// The least number that only clocks reach: one that counts seconds since 1970 does, cells do not.
const CLOCK: f64 = 1e9;

/// The evidence for an assumed arrangement; the greatest decides.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
struct FieldEvidence {
    /// Whether all cells are below [`CLOCK`].
    has_small_cells: bool,
    /// Whether the time has decimals and no cell does.
    is_only_decimal: bool,
    /// The strength of the growth of the time, or of the number if there is no time.
    strength: u8,
}

/// The fields of a frame's cells, number and time, as found or assumed.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnnamedFields {
    /// The first cell.
    pub(super) start: usize,
    /// The field of the frame's number.
    pub(super) label: Option<usize>,
    /// The field of the time, with its unit if its place determines it.
    pub(super) time: Option<TimeFields>,
}

impl UnnamedFields {
    /// Returns all arrangements with one or two fields beside the cells; none for any other number of fields.
    fn all(cells: usize, beside: usize) -> Vec<Self> {
        let with = |start, label, time| Self { start, label, time };
        let time = |field| Some(TimeFields::new(field, None));
        let milliseconds = |field| Some(TimeFields::new(field, Some(TimeUnit::Milliseconds)));
        match beside {
            1 => vec![
                with(1, Some(0), None),
                with(1, None, time(0)),
                // The first field is the offset of a ROS message.
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

    /// Returns the evidence of the lines for this arrangement; None if they rule it out.
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
            // A constant field is not a time, unless there is a number beside it. A whole field that counts up by 1 is
            // a number.
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

/// Finds the cells, the number and the time in lines without names. The first `before` numbers of a line are not
/// cells. The first line is line `number` of the file.
///
/// # Errors
/// Returns an error if a line has fewer fields than a frame has cells, or if it is not clear which other fields there
/// are.
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
    found.ok_or_else(|| row::count(number, count, cells))
}

/// Returns the arrangement with the greatest evidence; None if all are ruled out. The last line may be torn: if all
/// lines together rule out everything, those before it decide. With two numbers beside the cells, two lines are
/// enough.
///
/// # Errors
/// Returns an error if there is equal evidence for different cells.
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

/// Returns the error for lines that do not show which fields are cells.
pub(super) fn unclear(number: u64, cells: usize, beside: usize) -> RecordingError {
    let beside = counted(beside as u64, "number");
    let message = format!(
        "found {beside} besides the {cells} cells, and cannot tell which: add a header line, such as frame,time,r0c0"
    );
    RecordingError::in_line(number, message)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the first cell and the fields of the label and the time, or the error, of lines with four cells.
    type Found = Result<(usize, Option<usize>, Option<usize>), String>;

    fn found(lines: &[&[f64]]) -> Found {
        let lines: Vec<Vec<f64>> = lines.iter().map(|line| line.to_vec()).collect();
        let found = unnamed_fields((4, 0), 1, &lines).map_err(|error| error.to_string())?;
        Ok((found.start, found.label, found.time.map(|time| time.field)))
    }

    #[test]
    fn growth_tells_numbers_and_times_from_cells() {
        let cells = [
            [5.0, 0.0, 7.0, 1.0],
            [4.0, 2.0, 7.0, 0.0],
            [6.0, 1.0, 5.0, 0.0],
        ];
        let lines = |before: [&[f64]; 3], behind: [&[f64]; 3]| {
            let lines = [0, 1, 2].map(|line| [before[line], &cells[line], behind[line]].concat());
            found(&lines.each_ref().map(Vec::as_slice))
        };
        let none: [&[f64]; 3] = [&[]; 3];
        let (counting, steady): ([&[f64]; 3], [&[f64]; 3]) =
            ([&[0.0], &[1.0], &[2.0]], [&[0.0], &[0.05], &[0.1]]);
        let both: [&[f64]; 3] = [&[0.0, 0.0], &[1.0, 0.05], &[2.0, 0.1]];
        assert_eq!(lines(none, none), Ok((0, None, None)));
        assert_eq!(lines(both, none), Ok((2, Some(0), Some(1))));
        assert_eq!(lines(counting, none), Ok((1, Some(0), None)));
        assert_eq!(lines(none, steady), Ok((0, None, Some(4))));
        // The times of one frame a second rise by 1, too, but are not whole.
        let seconds: [&[f64]; 3] = [&[0.5], &[1.5], &[2.5]];
        assert_eq!(lines(seconds, none), Ok((1, None, Some(0))));
        assert_eq!(lines(none, seconds), Ok((0, None, Some(4))));
        assert_eq!(lines(counting, steady), Ok((1, Some(0), Some(5))));
    }

    #[test]
    fn equal_evidence_is_refused() {
        let message = "line 1: found 1 number besides the 4 cells, and cannot tell which: add a header line, such as \
                       frame,time,r0c0";
        assert_eq!(
            found(&[&[0.0, 1.0, 2.0, 3.0, 4.0]]),
            Err(message.to_owned())
        );
        let count = "line 1: found 3 values, expected 4";
        assert_eq!(found(&[&[0.0, 1.0, 2.0]]), Err(count.to_owned()));
    }
}
