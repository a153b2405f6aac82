//! The form of ranges to sweep.
//!
//! ```text
//! Explore: hexagon
//! x0      4:4.99:0.01      -16 to 16 cells             a field for each axis: a number or start:end:step
//! Anchor  < corner > top left, before turning          which point of the shape these are about
//! 3,600,000 poses                                      or why there is no grid of these ranges
//! ! the sensor cuts off 270 poses
//! without 1 taxel set by hand
//! ```

use std::time::Duration;

use ratatui::layout::{Position, Rect};
use taxel_core::pose::{
    Anchor, Axis, DecimalRange, GivenRanges, PoseGrid, RangeError, Ranges, default_ranges,
};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_files::formats::value::{counted, time_in_words};

use crate::tui::app::{App, Canvas, Flow, Message, Page, Place, Placed, Wheel, refuse};
use crate::tui::explore::name_of;
use crate::tui::explore::work::sweep;
use crate::tui::keys::{Arrow, Context};
use crate::tui::widget::write::{self, narrow};
use crate::tui::widget::{Field, FieldList, FieldRows, FormError, Role, TextField, draw_choice};

const LONGEST: usize = 40;
const LABEL: usize = 8;
const INPUT: usize = 16;

/// With more angles and zooms, nothing is computed for each of them while typing.
const MOST_ORIENTATIONS: u64 = 20_000;

pub(crate) struct RangesForm {
    source: Source,
    form: FieldList,
    anchor: Anchor,
    /// The number of taxels that no sweep of the shape has.
    by_hand: u32,
    pub(super) grid: Result<PoseGrid, String>,
    /// The poses that the sensor cuts off, unless there are too many orientations to count.
    cut_off: Option<u64>,
}

fn check(field: &Field, sensor: &Sensor) -> Result<(), FormError> {
    let range: DecimalRange = field
        .text()
        .parse()
        .map_err(|error: RangeError| FormError {
            brief: error.expected(),
            full: format!("{}: {error}", field.parameter.row().label),
        })?;
    for end in [range.value(0), range.last()] {
        sensor.check(field.parameter, end)?;
    }
    Ok(())
}

impl RangesForm {
    /// The ranges are those of an earlier sweep if there is one, otherwise the defaults.
    pub(super) fn new(
        (source, sensor, by_hand): (Source, Sensor, u32),
        earlier: Option<&PoseGrid>,
    ) -> Self {
        let ranges = earlier.map_or_else(Ranges::default, |grid| *grid.ranges());
        let fields = Axis::of(&source).map(|axis| {
            let text = ranges[axis].to_string();
            let is_own = earlier.is_some() || axis == Axis::Angle;
            Field {
                parameter: axis.parameter(),
                input: TextField::new(text.as_str(), LONGEST),
                proposed: (!is_own).then_some(text),
                initial: None,
            }
        });
        let mut form = Self {
            form: FieldList {
                fields: fields.collect(),
                has_choice: true,
                focus: None,
                sensor,
                check,
            },
            source,
            anchor: earlier.map(PoseGrid::anchor).unwrap_or_default(),
            by_hand,
            grid: Err(String::new()),
            cut_off: None,
        };
        form.follow();
        form.form.set_focus(Some(0));
        form
    }

    /// The ranges that the user has given; None if one of them is wrong.
    fn given(&self) -> Option<GivenRanges> {
        let mut given = GivenRanges::default();
        for (axis, field) in Axis::of(&self.source).zip(&self.form.fields) {
            if !field.is_proposed() {
                given[axis] = Some(field.text().parse().ok()?);
            }
        }
        Some(given)
    }

    /// Proposes ranges that fit the shape at the angles and zooms of the other fields, unless these are wrong.
    fn propose(&mut self) -> Option<()> {
        let given = self.given()?;
        let turns = [Axis::Angle, Axis::ZoomX, Axis::ZoomY].map(|axis| given[axis]);
        let orientations: u64 = turns.iter().flatten().map(DecimalRange::count).product();
        if orientations > MOST_ORIENTATIONS {
            return None;
        }
        let ranges = default_ranges(&self.source, &self.form.sensor, self.anchor, &given).ok()?;
        for (axis, field) in Axis::of(&self.source).zip(&mut self.form.fields) {
            let text = ranges[axis].to_string();
            if field.is_proposed() && field.text() != text {
                field.input = TextField::new(text.as_str(), LONGEST);
                field.proposed = Some(text);
            }
        }
        Some(())
    }

    /// Makes the grid of the fields.
    fn follow(&mut self) {
        self.propose();
        let grid = self.made();
        if grid != self.grid {
            let known = grid
                .as_ref()
                .ok()
                .filter(|grid| grid.rows() / grid.rows_per_orientation() <= MOST_ORIENTATIONS);
            self.cut_off = known.map(PoseGrid::poses_beyond_sensor);
            self.grid = grid;
        }
    }

    fn made(&self) -> Result<PoseGrid, String> {
        if let Some((_, error)) = self.form.error() {
            return Err(error.full);
        }
        let mut ranges = Ranges::default();
        for (axis, field) in Axis::of(&self.source).zip(&self.form.fields) {
            ranges[axis] = field.text().parse().unwrap_or(ranges[axis]);
        }
        let grid = PoseGrid::new(self.source.clone(), self.form.sensor, self.anchor, ranges);
        grid.map_err(|error| error.to_string())
    }

    /// The title is above them; below them are three lines, or as many as the rows leave, but at least one.
    fn rows(&self, area: Rect) -> FieldRows {
        let (below, rows) = (write::below(area, 1), self.form.fields.len() + 1);
        let foot = below.height.saturating_sub(narrow(rows)).clamp(1, 3);
        let height = below.height.saturating_sub(foot);
        let focus = self.form.focus.unwrap_or(rows - 1);
        FieldRows::of(Rect { height, ..below }, 0, rows, Some(focus))
    }

    /// Says how many poses there are, or what is wrong with all fields together.
    fn summary(&self) -> Vec<(String, Role)> {
        let mut lines = Vec::new();
        match &self.grid {
            Ok(grid) => {
                lines.push((counted(grid.poses(), "pose"), Role::Text));
                if let Some(cut_off) = self.cut_off.filter(|&poses| poses > 0) {
                    let what = if cut_off == grid.poses() {
                        "every pose".to_owned()
                    } else {
                        counted(cut_off, "pose")
                    };
                    lines.push((format!("! the sensor cuts off {what}"), Role::Error));
                }
            }
            // A wrong field shows its own error.
            Err(_) if self.form.error().is_some() => lines.push((String::new(), Role::Text)),
            Err(error) => lines.push((format!("! {error}"), Role::Error)),
        }
        if self.by_hand > 0 {
            let taxels = counted(self.by_hand, "taxel");
            lines.push((format!("without {taxels} set by hand"), Role::Quiet));
        }
        lines
    }
}

impl Page for RangesForm {
    /// On the anchor, Space, a click and the arrows to the sides choose the other one.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let on_anchor = self.form.focus.is_none();
        match message {
            Message::Accept => match self.grid.clone() {
                Ok(grid) => {
                    sweep(app, grid);
                    return Flow::Close;
                }
                Err(error) => {
                    if let Some((index, _)) = self.form.error() {
                        self.form.set_focus(Some(index));
                    }
                    refuse(app, error);
                }
            },
            Message::Defaults => {
                let of = (self.source.clone(), self.form.sensor, self.by_hand);
                let focus = self.form.focus;
                *self = Self::new(of, None);
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
            }
            Message::Type(_) if on_anchor => {
                refuse(app, "an arrow or Space chooses the other anchor");
            }
            message => self.form.take(message),
        }
        self.follow();
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Ranges, Place::Form, Wheel::Idle)
    }

    fn draw(&self, Canvas { theme, buffer, .. }: Canvas<'_>, area: Rect) -> Option<Position> {
        let title = format!("Explore: {}", name_of(&self.source));
        write::text(buffer, area, theme, &title, Role::Title);
        let (rows, fields) = (self.rows(area), &self.form);
        let mut cursor = rows.draw(theme, fields, (LABEL, INPUT), |_| None, buffer);
        let mut visible = rows.visible();
        if let Some((_, row)) = visible.find(|(index, _)| *index == fields.fields.len()) {
            let meaning = match self.anchor {
                Anchor::Corner => "top left, before turning",
                Anchor::Centre => "point it turns about",
            };
            let (chosen, on_anchor) = (("Anchor  ", self.anchor.name()), fields.focus.is_none());
            let remark = (meaning, Role::Quiet);
            draw_choice(theme, chosen, on_anchor, remark, buffer, row);
            let at = Position::new(row.x.saturating_add(narrow(LABEL)), row.y);
            cursor = cursor.or(on_anchor.then_some(at));
        }
        let mut rest = rows.rest(area);
        for (text, role) in self.summary() {
            let lines = write::wrapped(buffer, rest, theme, &text, role);
            rest = write::below(rest, narrow(lines.max(1)));
        }
        cursor
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let row = self.rows(area).at(at.y)?;
        let field = (row < self.form.fields.len()).then_some(row);
        Some(Message::ToField(field))
    }
}

pub(crate) fn about(time: Duration) -> String {
    if time < Duration::from_secs(1) {
        return "under a second".to_owned();
    }
    format!("about {}", time_in_words(time.as_secs_f64()))
}
