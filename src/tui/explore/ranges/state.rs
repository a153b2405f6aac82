//! The state of the form of ranges: a field for each axis of the shape, and the anchor.
//!
//! A range is `start:end:step` or a single number, as on the command line. The zooms of a picture are proposed, and the
//! ranges of x0 and y0: the cell that the shape lies in if the sensor cuts nothing off there at any of the angles,
//! otherwise a cell around the middle. The proposals follow the other fields until they are edited. Each valid grid is
//! sent to a worker once, which measures how long its sweep would take; an estimate for another grid is ignored.

use std::time::Duration;

use crate::formats::value::{counted, grouped};
use crate::parameter::{Parameter, Range};
use crate::pose::{
    Anchor, Axis, DecimalRange, GivenRanges, GridError, MAX_POSES, PoseGrid, Ranges, default_ranges,
};
use crate::sensor::Sensor;
use crate::source::Source;
use crate::tui::app::document::Document;
use crate::tui::app::message::Message;
use crate::tui::explore::message::name_of;
use crate::tui::form::memory::RememberedRanges;
use crate::tui::keys::key::Arrow;
use crate::tui::widget::number::around;
use crate::tui::widget::text_field::TextField;

/// The maximum number of characters of a field.
const LONGEST: usize = 40;

/// The maximum number of orientations for which ranges are proposed, and poses that are cut off are counted, while
/// the user types.
const MOST_ORIENTATIONS: u64 = 20_000;

/// The text field of one range.
#[derive(Clone, Debug)]
pub struct RangeField {
    /// The axis.
    axis: Axis,
    /// The text.
    input: TextField,
    /// The proposed text; None once another text was typed.
    proposed: Option<String>,
}

impl RangeField {
    /// Returns the parameter of the axis.
    pub fn parameter(&self) -> Parameter {
        self.axis.parameter()
    }

    /// Returns the text.
    pub fn text(&self) -> &str {
        self.input.text()
    }

    /// Returns the text with its cursor.
    pub fn input(&self) -> &TextField {
        &self.input
    }
}

/// An error in the ranges.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RangesError {
    /// The index of the wrong field; None if all fields together are wrong, such as too many poses.
    pub field: Option<usize>,
    /// The message beside the field; it may have several lines if it is about all fields.
    pub brief: String,
    /// The message with the field's name.
    pub full: String,
}

/// The form of ranges.
#[derive(Clone, Debug)]
pub struct RangesForm {
    /// The source to sweep.
    source: Source,
    /// The sensor, which bounds the values.
    sensor: Sensor,
    /// The anchor: the point of the shape that x0 and y0 place.
    anchor: Anchor,
    /// A field for each axis of the source.
    fields: Vec<RangeField>,
    /// The index of the field that has the focus; None for the anchor, below the fields.
    focus: Option<usize>,
    /// The number of taxels that were set by hand, which the sweep ignores.
    by_hand: u32,
    /// The grid of the fields, or their first error.
    grid: Result<PoseGrid, RangesError>,
    /// The last measured grid, the number of its poses that are cut off, and its time.
    measured: Option<Measured>,
}

/// The facts that are known about a grid before its sweep.
#[derive(Clone, Debug)]
struct Measured {
    /// The grid.
    grid: PoseGrid,
    /// The number of its poses that the sensor cuts off; None if it has too many orientations to count.
    cut_off: Option<u64>,
    /// The time that its sweep takes; None until a worker has measured it.
    time: Option<Duration>,
}

impl RangesForm {
    /// Creates the form for exploring a document. The ranges are those of an earlier sweep if there is one, otherwise
    /// the last accepted ones if they fit, otherwise the defaults.
    pub fn new(
        document: &Document,
        source: Source,
        earlier: Option<&PoseGrid>,
        last: Option<&RememberedRanges>,
    ) -> Self {
        let by_hand = match document.source {
            Some(_) => document.edits.count(),
            None => 0,
        };
        Self::begun((document.sensor, by_hand), source, earlier, last)
    }

    /// Creates the form for a sensor, and a number of taxels that were set by hand.
    fn begun(
        (sensor, by_hand): (Sensor, u32),
        source: Source,
        earlier: Option<&PoseGrid>,
        last: Option<&RememberedRanges>,
    ) -> Self {
        let ranges = earlier.map_or_else(Ranges::default, |grid| *grid.ranges());
        let last = last.filter(|_| earlier.is_none());
        let known = |axis| last.and_then(|last| last.get(source.kind_name(), &sensor, axis));
        let fields = Axis::of(&source).map(|axis| RangeField {
            axis,
            input: TextField::new(known(axis).unwrap_or(ranges[axis]).to_string(), LONGEST),
            proposed: None,
        });
        let fields: Vec<RangeField> = fields.collect();
        let typed: Vec<Axis> = Axis::of(&source)
            .filter(|&axis| known(axis).is_some())
            .collect();
        let anchor = match (earlier, last) {
            (Some(grid), _) => grid.anchor(),
            (None, Some(last)) => last.anchor,
            (None, None) => Anchor::default(),
        };
        let mut form = Self {
            grid: grid_of(&fields, &source, sensor, anchor),
            fields,
            source,
            sensor,
            anchor,
            focus: None,
            by_hand,
            measured: None,
        };
        if earlier.is_none() {
            for field in &mut form.fields {
                let proposed = field.axis != Axis::Angle;
                let proposed = proposed && typed.iter().all(|axis| *axis != field.axis);
                field.proposed = proposed.then(|| field.input.text().to_owned());
            }
            form.follow();
        }
        form.set_focus(Some(0));
        form
    }

    /// Brings the proposals and the grid up to date after a change of a field or of the anchor.
    fn follow(&mut self) {
        self.propose();
        self.grid = grid_of(&self.fields, &self.source, self.sensor, self.anchor);
    }

    /// Proposes ranges for x0 and y0 that fit the shape at the angles and zooms of the other fields, unless other
    /// ranges were typed. Does nothing while another field is wrong.
    fn propose(&mut self) {
        let mut given = GivenRanges::default();
        let mut orientations = 1;
        for field in &mut self.fields {
            field.proposed = field
                .proposed
                .take()
                .filter(|text| text == field.input.text());
            if field.proposed.is_some() {
                continue;
            }
            let Ok(range) = field.input.text().parse::<DecimalRange>() else {
                return;
            };
            if !matches!(field.axis, Axis::X0 | Axis::Y0) {
                orientations *= range.count();
            }
            given[field.axis] = Some(range);
        }
        if orientations > MOST_ORIENTATIONS {
            return;
        }
        let ranges = default_ranges(&self.source, &self.sensor, self.anchor, &given);
        let Ok(ranges) = ranges else { return };
        for field in &mut self.fields {
            let text = ranges[field.axis].to_string();
            if field.proposed.as_ref().is_some_and(|old| *old != text) {
                field.input = TextField::new(text.clone(), LONGEST);
                field.proposed = Some(text);
            }
        }
    }

    /// Resets all fields to the defaults.
    fn set_defaults(&mut self) {
        let of = (self.sensor, self.by_hand);
        let fresh = Self::begun(of, self.source.clone(), None, None);
        let (focus, measured) = (self.focus, self.measured.take());
        *self = Self { measured, ..fresh };
        self.set_focus(focus);
    }

    /// Returns the ranges to remember: typed ones and ones from an earlier form, not those that follow the other
    /// fields.
    pub fn remembered(&self) -> RememberedRanges {
        let own = self.fields.iter().filter(|field| field.proposed.is_none());
        let ranges = own.filter_map(|field| Some((field.axis, field.text().parse().ok()?)));
        RememberedRanges {
            of: self.source.kind_name().to_owned(),
            size: self.sensor.size(),
            anchor: self.anchor,
            ranges: ranges.collect(),
        }
    }

    /// Returns the title, with the name of the source.
    pub fn title(&self) -> String {
        format!("Explore: {}", name_of(&self.source))
    }

    /// Returns the fields, from the top.
    pub fn fields(&self) -> &[RangeField] {
        &self.fields
    }

    /// Returns the index of the field that has the focus; None for the anchor.
    pub fn focus(&self) -> Option<usize> {
        self.focus
    }

    /// Returns the anchor, the point of the shape that x0 and y0 place.
    pub fn anchor(&self) -> Anchor {
        self.anchor
    }

    /// Returns the allowed values of a field.
    pub fn allowed(&self, field: &RangeField) -> Range {
        self.sensor.range(field.parameter())
    }

    /// Returns the number of taxels that were set by hand, which the sweep ignores.
    pub fn by_hand(&self) -> u32 {
        self.by_hand
    }

    /// Returns the approximate time for the grid of the fields; None if it is not known.
    pub fn estimate(&self) -> Option<Duration> {
        self.known()?.time
    }

    /// Returns the number of poses of the fields' grid that the sensor cuts off; None if it is not known.
    pub fn cut_off(&self) -> Option<u64> {
        self.known()?.cut_off
    }

    /// Returns the known facts about the grid of the fields.
    fn known(&self) -> Option<&Measured> {
        let measured = self.measured.as_ref();
        measured.filter(|known| self.grid.as_ref() == Ok(&known.grid))
    }

    /// Returns the grid of the fields if it was not measured before. It counts as measured afterwards.
    pub fn unmeasured(&mut self) -> Option<PoseGrid> {
        let grid = self.grid.as_ref().ok()?;
        if self
            .measured
            .as_ref()
            .is_some_and(|known| known.grid == *grid)
        {
            return None;
        }
        let orientations = grid.rows() / grid.rows_per_orientation();
        let countable = orientations <= MOST_ORIENTATIONS;
        self.measured = Some(Measured {
            cut_off: countable.then(|| grid.poses_beyond_sensor()),
            time: None,
            grid: grid.clone(),
        });
        Some(grid.clone())
    }

    /// Takes the estimated time of a grid. An estimate for another grid is ignored.
    pub fn take_estimate(&mut self, grid: &PoseGrid, time: Duration) {
        let known = self.measured.as_mut().filter(|known| known.grid == *grid);
        if let Some(known) = known {
            known.time = Some(time);
        }
    }

    /// Returns the error in a field; None if there is none.
    pub fn trouble(&self, index: usize) -> Option<RangesError> {
        trouble(&self.fields, index, &self.sensor)
    }

    /// Returns the grid of the fields.
    ///
    /// # Errors
    /// Returns the first error in the fields.
    pub fn grid(&self) -> Result<&PoseGrid, &RangesError> {
        self.grid.as_ref()
    }

    /// Moves the focus to a field; None moves it to the anchor.
    pub fn set_focus(&mut self, focus: Option<usize>) {
        self.focus = focus.map(|index| index.min(self.fields.len().saturating_sub(1)));
        if let Some(field) = self.focused() {
            field.input.enter();
        }
    }

    /// Moves the focus to a row; the anchor follows the fields. If the anchor has the focus already, chooses the
    /// other anchor.
    fn point(&mut self, row: usize) {
        let to = (row < self.fields.len()).then_some(row);
        if to.is_none() && self.focus.is_none() {
            self.other_anchor();
        }
        self.set_focus(to);
    }

    /// Moves the focus by `by` rows; the first row follows the last.
    pub fn move_focus(&mut self, by: i8) {
        let count = self.fields.len();
        let next = around(self.focus.unwrap_or(count), by, count + 1);
        self.set_focus((next < count).then_some(next));
    }

    /// Returns the field that has the focus; None for the anchor.
    fn focused(&mut self) -> Option<&mut RangeField> {
        self.fields.get_mut(self.focus?)
    }

    /// Handles a message: moves to another row, or types, moves or deletes in the field. On the anchor, Space and the
    /// arrows to the sides choose the other anchor.
    pub fn take(&mut self, message: &Message) {
        match message {
            Message::Field(by) => self.move_focus(*by),
            Message::ToField(row) => self.point(row.unwrap_or(self.fields.len())),
            Message::Defaults => self.set_defaults(),
            Message::Choose(Arrow::Up) => self.move_focus(-1),
            Message::Choose(Arrow::Down) => self.move_focus(1),
            message => match self.focused() {
                Some(field) => {
                    let before = field.text().to_owned();
                    field.input.take(message);
                    if field.text() != before {
                        self.follow();
                    }
                }
                None if matches!(message, Message::Choose(_) | Message::Type(' ')) => {
                    self.other_anchor();
                }
                None => {}
            },
        }
    }

    /// Chooses the other anchor, and proposes ranges that fit it.
    fn other_anchor(&mut self) {
        self.anchor = match self.anchor {
            Anchor::Corner => Anchor::Centre,
            Anchor::Centre => Anchor::Corner,
        };
        self.follow();
    }
}

/// Returns the error in a field; None if there is none.
fn trouble(fields: &[RangeField], index: usize, sensor: &Sensor) -> Option<RangesError> {
    let field = fields.get(index)?;
    let wrong = |brief: String, full: String| RangesError {
        field: Some(index),
        brief,
        full,
    };
    let range: DecimalRange = match field.text().parse() {
        Ok(range) => range,
        Err(error) => {
            let full = format!("{}: {error}", field.parameter().row().label);
            return Some(wrong(error.expected(), full));
        }
    };
    let ends = [range.value(0), range.last()];
    let error = ends
        .into_iter()
        .find_map(|value| sensor.check(field.parameter(), value).err());
    error.map(|error| wrong(error.expected(), error.labelled()))
}

/// Returns the grid of the fields.
///
/// # Errors
/// Returns the first error in the fields.
fn grid_of(
    fields: &[RangeField],
    source: &Source,
    sensor: Sensor,
    anchor: Anchor,
) -> Result<PoseGrid, RangesError> {
    if let Some(trouble) = (0..fields.len()).find_map(|index| trouble(fields, index, &sensor)) {
        return Err(trouble);
    }
    let mut ranges = Ranges::default();
    for field in fields {
        if let Ok(range) = field.text().parse() {
            ranges[field.axis] = range;
        }
    }
    let grid = PoseGrid::new(source.clone(), sensor, anchor, ranges);
    grid.map_err(|error: GridError| RangesError {
        field: None,
        brief: match &error {
            GridError::Poses { poses } => {
                let poses = u64::try_from(*poses).unwrap_or(u64::MAX);
                let most = grouped(MAX_POSES);
                format!("{}\nexpected at most {most}", counted(poses, "pose"))
            }
            _ => error.to_string(),
        },
        full: error.to_string(),
    })
}
