//! The form of ranges to sweep.
//!
//! ```text
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

use crate::tui::app::document::Document;
use crate::tui::app::message::Message;
use crate::tui::app::page::{Flow, Page, Slot};
use crate::tui::app::state::App;
use crate::tui::explore::message::name_of;
use crate::tui::explore::work::in_ranges;
use crate::tui::form::RememberedRanges;
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::widget::field_list::{FieldList, FieldRows, FormError, FormField};
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;
use crate::tui::widget::write::narrow;

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
    pub(super) form: FieldList<RangeField>,
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

const LABEL: usize = 8;
const INPUT: usize = 16;

impl Page for RangesForm {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        in_ranges(self, app, message)
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
        let rows = rows(self, area);
        let fields = &self.form;
        let mut cursor = rows.draw(theme, fields, (LABEL, INPUT), |_| None, buffer);
        let mut others = rows
            .visible()
            .skip_while(|(index, _)| *index < fields.fields().len());
        if let Some((_, row)) = others.next() {
            let at = draw_anchor(theme, self, buffer, row);
            cursor = cursor.or(fields.focus().is_none().then_some(at));
        }
        draw_summary(theme, self, buffer, rows.rest(area));
        cursor
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let row = rows(self, area).at(at.y)?;
        Some(Message::ToField(
            (row < self.form.fields().len()).then_some(row),
        ))
    }
}

/// The title is above them; below them are three lines, or as many as the rows leave, but at least one.
fn rows(form: &RangesForm, area: Rect) -> FieldRows {
    let (below, rows) = (write::below(area, 1), form.form.fields().len() + 1);
    let foot = below.height.saturating_sub(narrow(rows)).clamp(1, 3);
    let height = below.height.saturating_sub(foot);
    let focus = form.form.focus().unwrap_or(rows - 1);
    FieldRows::of(Rect { height, ..below }, 0, rows, Some(focus))
}

fn draw_anchor(theme: &Theme, form: &RangesForm, buffer: &mut Buffer, row: Rect) -> Position {
    let label = format!("{:LABEL$}", "Anchor");
    let (name, meaning) = match form.anchor {
        Anchor::Corner => ("corner", "top left, before turning"),
        Anchor::Centre => ("centre", "point it turns about"),
    };
    let role = if form.form.focus().is_none() {
        Role::Focus
    } else {
        Role::Text
    };
    let pieces = [
        (label.as_str(), Role::Text),
        ("< ", Role::Quiet),
        (name, role),
        (" > ", Role::Quiet),
        (meaning, Role::Quiet),
    ];
    write::line(buffer, row, theme, pieces);
    Position::new(row.x.saturating_add(narrow(LABEL)), row.y)
}

fn draw_summary(theme: &Theme, form: &RangesForm, buffer: &mut Buffer, area: Rect) {
    let (text, role) = match &form.grid {
        Ok(grid) => {
            let poses = counted(grid.poses(), "pose");
            let time = form
                .known()
                .and_then(|known| known.time)
                .map(|time| format!(", {}", about(time)));
            (poses + time.as_deref().unwrap_or(""), Role::Text)
        }
        // A wrong field shows its own error.
        Err(_) if form.form.error().is_some() => (String::new(), Role::Text),
        Err(error) => {
            for (index, line) in error.brief.lines().enumerate() {
                let pieces = [("! ", Role::Error), (line, Role::Error)];
                write::line(buffer, write::row(area, index), theme, pieces);
            }
            return;
        }
    };
    write::text(buffer, write::row(area, 0), theme, &text, role);
    let mut line = 1;
    if let Some(cut_off) = form
        .known()
        .and_then(|known| known.cut_off)
        .filter(|&poses| poses > 0)
    {
        let all = form.grid.as_ref().is_ok_and(|grid| grid.poses() == cut_off);
        let text = match cut_off {
            _ if all => "! the sensor cuts off every pose".to_owned(),
            1 => "! the sensor cuts off 1 pose".to_owned(),
            _ => format!("! the sensor cuts off {}", counted(cut_off, "pose")),
        };
        let row = write::row(area, line);
        write::text(buffer, row, theme, &text, Role::Error);
        line += 1;
    }
    if form.by_hand > 0 {
        let taxels = counted(form.by_hand, "taxel");
        let text = format!("without {taxels} set by hand");
        let row = write::row(area, line);
        write::text(buffer, row, theme, &text, Role::Quiet);
    }
}

pub fn about(time: Duration) -> String {
    if time < Duration::from_secs(1) {
        return "under a second".to_owned();
    }
    format!("about {}", time_in_words(time.as_secs_f64()))
}
