//! The form of ranges to sweep.
//!
//! ```text
//! Explore: hexagon
//! x0      4:4.99:0.01      -16 to 16 cells             a field for each axis: a number or start:end:step
//! Anchor  < corner > top left, before turning          which point of the shape these are about
//! 3,600,000 poses, about 2 s                           or why there is no grid of these ranges
//! ! the sensor cuts off 270 poses
//! without 1 taxel set by hand
//! ```

use std::time::Duration;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::parameter::Parameter;
use taxel_core::pose::{
    Anchor, Axis, DecimalRange, GivenRanges, GridError, MAX_POSES, PoseGrid, Ranges, default_ranges,
};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_files::formats::value::{counted, grouped, time_in_words};

use crate::tui::app::change::refuse;
use crate::tui::app::message::Message;
use crate::tui::app::page::{Flow, Page, Slot};
use crate::tui::app::state::App;
use crate::tui::explore::name_of;
use crate::tui::explore::work::{measure, sweep};
use crate::tui::form::RememberedRanges;
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::widget::field_list::{FieldList, FieldRows, FormError, FormField};
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};

const LONGEST: usize = 40;
const LABEL: usize = 8;
const INPUT: usize = 16;

/// With more angles and zooms, nothing is computed for each of them while typing.
const MOST_ORIENTATIONS: u64 = 20_000;

pub(crate) struct RangeField {
    axis: Axis,
    input: TextField,
    /// The text that the form proposed. While the field has it, it follows the other fields.
    proposed: Option<String>,
}

impl RangeField {
    fn is_proposed(&self) -> bool {
        self.proposed.as_deref() == Some(self.text())
    }
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

pub(crate) struct RangesForm {
    source: Source,
    form: FieldList<RangeField>,
    anchor: Anchor,
    by_hand: u32,
    grid: Result<PoseGrid, FormError>,
    measured: Option<Measured>,
}

struct Measured {
    grid: PoseGrid,
    /// None if there are too many orientations to count.
    cut_off: Option<u64>,
    /// The time that its sweep takes, once a worker has measured it.
    time: Option<Duration>,
}

impl RangesForm {
    /// The ranges are those of an earlier sweep if there is one, otherwise the last accepted ones if they fit, otherwise
    /// the defaults. `by_hand` is the number of taxels that no sweep of the shape has.
    pub(super) fn new(
        (source, sensor, by_hand): (Source, Sensor, u32),
        earlier: Option<&PoseGrid>,
        last: Option<&RememberedRanges>,
    ) -> Self {
        let last = last.filter(|_| earlier.is_none());
        let known = |axis| last.and_then(|last| last.get(source.kind_name(), &sensor, axis));
        let ranges = earlier.map_or_else(Ranges::default, |grid| *grid.ranges());
        let fields = Axis::of(&source).map(|axis| {
            let text = known(axis).unwrap_or(ranges[axis]).to_string();
            let is_own = earlier.is_some() || known(axis).is_some() || axis == Axis::Angle;
            RangeField {
                axis,
                proposed: (!is_own).then(|| text.clone()),
                input: TextField::new(text, LONGEST),
            }
        });
        let form = FieldList::new(fields.collect(), true, sensor);
        let anchor = match (earlier, last) {
            (Some(grid), _) => grid.anchor(),
            (None, Some(last)) => last.anchor,
            (None, None) => Anchor::default(),
        };
        let mut form = Self {
            grid: grid_of(&form, &source, anchor),
            source,
            form,
            anchor,
            by_hand,
            measured: None,
        };
        form.follow();
        form.form.set_focus(Some(0));
        form
    }

    /// Proposes ranges that fit the shape at the angles and zooms of the other fields, unless these are wrong.
    fn propose(&mut self) -> Option<()> {
        let mut given = GivenRanges::default();
        let mut orientations = 1;
        for field in self
            .form
            .fields()
            .iter()
            .filter(|field| !field.is_proposed())
        {
            let range: DecimalRange = field.text().parse().ok()?;
            if !matches!(field.axis, Axis::X0 | Axis::Y0) {
                orientations *= range.count();
            }
            given[field.axis] = Some(range);
        }
        let is_few = orientations <= MOST_ORIENTATIONS;
        let (source, sensor) = (&self.source, self.form.sensor());
        let ranges = is_few.then(|| default_ranges(source, sensor, self.anchor, &given));
        let ranges = ranges?.ok()?;
        for field in self.form.fields_mut() {
            let text = ranges[field.axis].to_string();
            if field.is_proposed() && field.text() != text {
                field.input = TextField::new(text.as_str(), LONGEST);
                field.proposed = Some(text);
            }
        }
        Some(())
    }

    fn follow(&mut self) {
        self.propose();
        self.grid = grid_of(&self.form, &self.source, self.anchor);
    }

    pub(super) fn remembered(&self) -> RememberedRanges {
        let own = self
            .form
            .fields()
            .iter()
            .filter(|field| !field.is_proposed());
        RememberedRanges {
            of: self.source.kind_name().to_owned(),
            size: self.form.sensor().size(),
            anchor: self.anchor,
            ranges: own
                .filter_map(|field| Some((field.axis, field.text().parse().ok()?)))
                .collect(),
        }
    }

    /// Returns the grid of the fields if it was not measured before. It counts as measured afterwards.
    pub(super) fn unmeasured(&mut self) -> Option<PoseGrid> {
        let grid = self.grid.as_ref().ok()?;
        if self.known().is_some() {
            return None;
        }
        let is_few = grid.rows() / grid.rows_per_orientation() <= MOST_ORIENTATIONS;
        self.measured = Some(Measured {
            cut_off: is_few.then(|| grid.poses_beyond_sensor()),
            time: None,
            grid: grid.clone(),
        });
        Some(grid.clone())
    }

    fn known(&self) -> Option<&Measured> {
        let measured = self.measured.as_ref();
        measured.filter(|known| self.grid.as_ref() == Ok(&known.grid))
    }

    pub(super) fn take_estimate(&mut self, grid: &PoseGrid, time: Duration) {
        let known = self.measured.as_mut().filter(|known| known.grid == *grid);
        if let Some(known) = known {
            known.time = Some(time);
        }
    }

    pub(super) fn accepted(&mut self) -> Result<PoseGrid, String> {
        if let Some((index, _)) = self.form.error() {
            self.form.set_focus(Some(index));
        }
        self.grid.clone().map_err(|error| error.full)
    }

    /// On the anchor, Space, a click and the arrows to the sides choose the other one.
    pub(super) fn take(&mut self, message: &Message) -> Result<(), String> {
        let on_anchor = self.form.focus().is_none();
        match message {
            Message::Defaults => {
                let of = (self.source.clone(), *self.form.sensor(), self.by_hand);
                let (focus, measured) = (self.form.focus(), self.measured.take());
                *self = Self::new(of, None, None);
                self.measured = measured;
                self.form.set_focus(focus);
            }
            Message::ToField(None)
            | Message::Type(' ')
            | Message::Choose(Arrow::Left | Arrow::Right)
                if on_anchor =>
            {
                self.anchor = match self.anchor {
                    Anchor::Corner => Anchor::Centre,
                    Anchor::Centre => Anchor::Corner,
                };
                self.follow();
            }
            Message::Type(_) if on_anchor => {
                return Err("an arrow or Space chooses the other anchor".to_owned());
            }
            message => {
                self.form.take(message);
                self.follow();
            }
        }
        Ok(())
    }

    /// The title is above them; below them are three lines, or as many as the rows leave, but at least one.
    fn rows(&self, area: Rect) -> FieldRows {
        let (below, rows) = (write::below(area, 1), self.form.fields().len() + 1);
        let foot = below.height.saturating_sub(narrow(rows)).clamp(1, 3);
        let height = below.height.saturating_sub(foot);
        let focus = self.form.focus().unwrap_or(rows - 1);
        FieldRows::of(Rect { height, ..below }, 0, rows, Some(focus))
    }

    fn draw_anchor(&self, theme: &Theme, buffer: &mut Buffer, row: Rect) -> Position {
        let (name, meaning) = match self.anchor {
            Anchor::Corner => ("corner", "top left, before turning"),
            Anchor::Centre => ("centre", "point it turns about"),
        };
        let has_focus = self.form.focus().is_none();
        let role = if has_focus { Role::Focus } else { Role::Text };
        let pieces = [
            (&*format!("{:LABEL$}", "Anchor"), Role::Text),
            ("< ", Role::Quiet),
            (name, role),
            (" > ", Role::Quiet),
            (meaning, Role::Quiet),
        ];
        write::line(buffer, row, theme, pieces);
        Position::new(row.x.saturating_add(narrow(LABEL)), row.y)
    }

    /// Says how many poses there are, or what is wrong with all fields together.
    fn summary(&self) -> Vec<(String, Role)> {
        let grid = match &self.grid {
            Ok(grid) => grid,
            // A wrong field shows its own error.
            Err(_) if self.form.error().is_some() => return vec![(String::new(), Role::Text)],
            Err(error) => {
                let lines = error.brief.lines();
                return lines
                    .map(|line| (format!("! {line}"), Role::Error))
                    .collect();
            }
        };
        let mut poses = counted(grid.poses(), "pose");
        let known = self.known();
        if let Some(time) = known.and_then(|known| known.time) {
            poses += &format!(", {}", about(time));
        }
        let mut lines = vec![(poses, Role::Text)];
        match known.and_then(|known| known.cut_off) {
            None | Some(0) => {}
            Some(poses) => {
                let all = poses == grid.poses();
                let what = if all {
                    "every pose".to_owned()
                } else {
                    counted(poses, "pose")
                };
                lines.push((format!("! the sensor cuts off {what}"), Role::Error));
            }
        }
        lines
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
        ranges[field.axis] = field.text().parse().unwrap_or(ranges[field.axis]);
    }
    let grid = PoseGrid::new(source.clone(), *form.sensor(), anchor, ranges);
    grid.map_err(|error| FormError {
        brief: match &error {
            GridError::Poses(poses) => {
                let poses = u64::try_from(*poses).unwrap_or(u64::MAX);
                let most = grouped(MAX_POSES);
                format!("{}\nexpected at most {most}", counted(poses, "pose"))
            }
            _ => error.to_string(),
        },
        full: error.to_string(),
    })
}

impl Page for RangesForm {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let done = if *message == Message::Accept {
            self.accepted().map(Some)
        } else {
            self.take(message).map(|()| None)
        };
        match done {
            Ok(Some(grid)) => {
                app.forms.ranges = Some(self.remembered());
                sweep(app, grid);
                return Flow::Close;
            }
            Ok(None) => {}
            Err(reason) => refuse(app, reason),
        }
        measure(app, self);
        Flow::Stay
    }

    fn context(&self) -> Context {
        Context::Ranges
    }

    fn slot(&self) -> Slot {
        Slot::Form
    }

    fn draw(
        &self,
        theme: &Theme,
        _keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let title = format!("Explore: {}", name_of(&self.source));
        write::text(buffer, area, theme, &title, Role::Title);
        let (rows, fields) = (self.rows(area), &self.form);
        let mut cursor = rows.draw(theme, fields, (LABEL, INPUT), |_| None, buffer);
        if let Some((_, row)) = rows
            .visible()
            .find(|(index, _)| *index == fields.fields().len())
        {
            let at = self.draw_anchor(theme, buffer, row);
            cursor = cursor.or(fields.focus().is_none().then_some(at));
        }
        let mut lines = self.summary();
        if self.by_hand > 0 {
            let taxels = counted(self.by_hand, "taxel");
            lines.push((format!("without {taxels} set by hand"), Role::Quiet));
        }
        for (index, (text, role)) in lines.iter().enumerate() {
            write::text(
                buffer,
                write::row(rows.rest(area), index),
                theme,
                text,
                *role,
            );
        }
        cursor
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let row = self.rows(area).at(at.y)?;
        let field = (row < self.form.fields().len()).then_some(row);
        Some(Message::ToField(field))
    }
}

pub(crate) fn about(time: Duration) -> String {
    if time < Duration::from_secs(1) {
        return "under a second".to_owned();
    }
    format!("about {}", time_in_words(time.as_secs_f64()))
}
