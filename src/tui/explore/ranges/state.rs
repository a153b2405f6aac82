//! The state of the form of ranges: a field for each axis of the shape, and the anchor.
//!
//! A range is `start:end:step` or a single number, as on the command line. The zooms of a picture are proposed, and the
//! ranges of x0 and y0: the cell that the shape lies in if the sensor cuts nothing off there at any of the angles,
//! otherwise a cell around the middle. The proposals follow the other fields until they are edited. Each valid grid is
//! sent to a worker once, which measures how long its sweep would take; an estimate for another grid is ignored.

use std::time::Duration;

use crate::formats::value::{counted, grouped};
use crate::parameter::Parameter;
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
use crate::tui::widget::field_list::{FieldList, FormError, FormField};
use crate::tui::widget::text_field::TextField;

const LONGEST: usize = 40;

const MOST_ORIENTATIONS: u64 = 20_000;

#[derive(Clone, Debug)]
pub struct RangeField {
    axis: Axis,
    input: TextField,
    proposed: Option<String>,
}

impl FormField for RangeField {
    fn parameter(&self) -> Parameter {
        self.axis.parameter()
    }

    fn input(&self) -> &TextField {
        &self.input
    }

    fn input_mut(&mut self) -> &mut TextField {
        &mut self.input
    }

    fn error(&self, sensor: &Sensor) -> Option<FormError> {
        let range: DecimalRange = match self.text().parse() {
            Ok(range) => range,
            Err(error) => {
                return Some(FormError {
                    brief: error.expected(),
                    full: format!("{}: {error}", self.parameter().row().label),
                });
            }
        };
        let mut ends = [range.value(0), range.last()].into_iter();
        let error = ends.find_map(|value| sensor.check(self.parameter(), value).err());
        error.map(FormError::from)
    }
}

#[derive(Clone, Debug)]
pub struct RangesForm {
    source: Source,
    form: FieldList<RangeField>,
    anchor: Anchor,
    by_hand: u32,
    grid: Result<PoseGrid, FormError>,
    measured: Option<Measured>,
}

#[derive(Clone, Debug)]
struct Measured {
    grid: PoseGrid,
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
        let form = FieldList::new(fields.collect(), true, sensor);
        let typed: Vec<Axis> = Axis::of(&source)
            .filter(|&axis| known(axis).is_some())
            .collect();
        let anchor = match (earlier, last) {
            (Some(grid), _) => grid.anchor(),
            (None, Some(last)) => last.anchor,
            (None, None) => Anchor::default(),
        };
        let mut form = Self {
            grid: grid_of(&form, &source, anchor),
            form,
            source,
            anchor,
            by_hand,
            measured: None,
        };
        if earlier.is_none() {
            for field in form.form.fields_mut() {
                let proposed = field.axis != Axis::Angle;
                let proposed = proposed && typed.iter().all(|axis| *axis != field.axis);
                field.proposed = proposed.then(|| field.text().to_owned());
            }
            form.follow();
        }
        form.form.set_focus(Some(0));
        form
    }

    fn follow(&mut self) {
        self.propose();
        self.grid = grid_of(&self.form, &self.source, self.anchor);
    }

    /// Proposes ranges for x0 and y0 that fit the shape at the angles and zooms of the other fields, unless other
    /// ranges were typed. Does nothing while another field is wrong.
    fn propose(&mut self) {
        let mut given = GivenRanges::default();
        let mut orientations = 1;
        for field in self.form.fields_mut() {
            field.proposed = field
                .proposed
                .take()
                .filter(|text| text == field.input.text());
            if field.proposed.is_some() {
                continue;
            }
            let Ok(range) = field.text().parse::<DecimalRange>() else {
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
        let ranges = default_ranges(&self.source, self.form.sensor(), self.anchor, &given);
        let Ok(ranges) = ranges else { return };
        for field in self.form.fields_mut() {
            let text = ranges[field.axis].to_string();
            if field.proposed.as_ref().is_some_and(|old| *old != text) {
                field.input = TextField::new(text.clone(), LONGEST);
                field.proposed = Some(text);
            }
        }
    }

    fn set_defaults(&mut self) {
        let of = (*self.form.sensor(), self.by_hand);
        let fresh = Self::begun(of, self.source.clone(), None, None);
        let (focus, measured) = (self.form.focus(), self.measured.take());
        *self = Self { measured, ..fresh };
        self.form.set_focus(focus);
    }

    pub fn remembered(&self) -> RememberedRanges {
        let fields = self.form.fields().iter();
        let own = fields.filter(|field| field.proposed.is_none());
        let ranges = own.filter_map(|field| Some((field.axis, field.text().parse().ok()?)));
        RememberedRanges {
            of: self.source.kind_name().to_owned(),
            size: self.form.sensor().size(),
            anchor: self.anchor,
            ranges: ranges.collect(),
        }
    }

    pub fn title(&self) -> String {
        format!("Explore: {}", name_of(&self.source))
    }

    pub fn form(&self) -> &FieldList<RangeField> {
        &self.form
    }

    pub fn anchor(&self) -> Anchor {
        self.anchor
    }

    pub fn by_hand(&self) -> u32 {
        self.by_hand
    }

    pub fn estimate(&self) -> Option<Duration> {
        self.known()?.time
    }

    pub fn cut_off(&self) -> Option<u64> {
        self.known()?.cut_off
    }

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

    /// An estimate for another grid is ignored.
    pub fn take_estimate(&mut self, grid: &PoseGrid, time: Duration) {
        let known = self.measured.as_mut().filter(|known| known.grid == *grid);
        if let Some(known) = known {
            known.time = Some(time);
        }
    }

    pub fn accepted(&mut self) -> Result<PoseGrid, FormError> {
        if let Some((index, _)) = self.form.error() {
            self.form.set_focus(Some(index));
        }
        self.grid.clone()
    }

    pub fn grid(&self) -> Result<&PoseGrid, &FormError> {
        self.grid.as_ref()
    }

    /// On the anchor, Space, a click and the arrows to the sides choose the other anchor.
    pub fn take(&mut self, message: &Message) {
        let on_anchor = self.form.focus().is_none();
        match message {
            Message::Defaults => self.set_defaults(),
            Message::ToField(None)
            | Message::Type(' ')
            | Message::Choose(Arrow::Left | Arrow::Right)
                if on_anchor =>
            {
                self.other_anchor();
            }
            message => {
                self.form.take(message);
                self.follow();
            }
        }
    }

    fn other_anchor(&mut self) {
        self.anchor = match self.anchor {
            Anchor::Corner => Anchor::Centre,
            Anchor::Centre => Anchor::Corner,
        };
        self.follow();
    }
}

fn grid_of(
    form: &FieldList<RangeField>,
    source: &Source,
    anchor: Anchor,
) -> Result<PoseGrid, FormError> {
    if let Some((_, error)) = form.error() {
        return Err(error);
    }
    let mut ranges = Ranges::default();
    for field in form.fields() {
        if let Ok(range) = field.text().parse() {
            ranges[field.axis] = range;
        }
    }
    let grid = PoseGrid::new(source.clone(), *form.sensor(), anchor, ranges);
    grid.map_err(|error: GridError| FormError {
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
