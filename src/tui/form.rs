//! The forms of Figure, Picture (also for outlines) and the sensor.
//!
//! ```text
//! Figure                                              title
//! Kind      < ellipse   > e r t p h o                 kind, and the letters that choose one (figures only)
//!
//! Radius x  4.00      above 0, up to 16 cells         fields: widget::field_list
//! Thickness           above 0, up to 16 cells
//!   empty: solid                                      a remark on a field that may be empty
//! ! 3 active taxels will be cut                       what would be lost (sensor only)
//! ```
//! The matrix beside the form shows what the fields make while all are valid. While one is not, it shows what they made
//! before that field was edited: a text that becomes invalid may have been valid on the way, such as the 1 on the way
//! to 17.

use std::collections::BTreeMap;

use ratatui::layout::{Position, Rect};
use taxel_core::figure::{Figure, FigureKind, NO_ROOM};
use taxel_core::parameter::{Parameter, ParameterError};
use taxel_core::picture::PICTURE_PARAMETERS;
use taxel_core::quote::quoted_character;
use taxel_core::sensor::{SENSOR_PARAMETERS, Sensor};
use taxel_core::source::Source;
use taxel_files::formats::value::counted;

use crate::tui::app::change::{refuse, replace};
use crate::tui::app::document::{Document, Reading};
use crate::tui::app::message::Message;
use crate::tui::app::page::{Canvas, Flow, Page, Place, Placed, Wheel};
use crate::tui::app::state::App;
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::Context;
use crate::tui::widget::field_list::{Field, FieldList, FieldRows, draw_choice};
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::Role;
use crate::tui::widget::write::{self, around};

const LABEL: usize = 10;
const INPUT: usize = 9;
const LONGEST: usize = 24;

enum Subject {
    Figure(FigureKind),
    Picture(String),
    Sensor,
}

pub(crate) struct FormDialog {
    subject: Subject,
    form: FieldList,
    /// The texts that were typed, also for other kinds of figures.
    typed: BTreeMap<Parameter, String>,
    /// What the fields had at first.
    begun: Document,
    before: Document,
    /// What the matrix shows.
    pub(crate) shown: Document,
    /// What it showed before the field with the focus was edited.
    settled: Document,
}

impl FormDialog {
    pub(crate) fn figure(before: &Document) -> Self {
        let figure = match before.source {
            Some(Source::Figure(figure)) => figure,
            _ => Figure::default_of(FigureKind::Ellipse, &before.sensor),
        };
        let begun = Document::touched(before.sensor, Source::Figure(figure));
        Self::new(Subject::Figure(figure.kind()), before, begun)
    }

    pub(crate) fn picture(before: &Document, placed: Document, name: String) -> Self {
        Self::new(Subject::Picture(name), before, placed)
    }

    pub(crate) fn sensor(before: &Document) -> Self {
        Self::new(Subject::Sensor, before, before.clone())
    }

    fn new(subject: Subject, before: &Document, begun: Document) -> Self {
        let has_choice = matches!(subject, Subject::Figure(_));
        let mut dialog = Self {
            form: FieldList {
                fields: Vec::new(),
                has_choice,
                focus: None,
                sensor: before.sensor,
                check: |field, sensor| Ok(value(field, sensor).map(|_| ())?),
            },
            subject,
            typed: BTreeMap::new(),
            before: before.clone(),
            shown: begun.clone(),
            settled: begun.clone(),
            begun,
        };
        dialog.fill();
        dialog.form.set_focus((!has_choice).then_some(0));
        dialog
    }

    fn kind(&self) -> Option<FigureKind> {
        match self.subject {
            Subject::Figure(kind) => Some(kind),
            _ => None,
        }
    }

    /// Makes the fields of the subject. A figure of another kind is another figure: it has what was typed, or the
    /// defaults, not what the one on the matrix has.
    fn fill(&mut self) {
        for field in self.form.fields.iter().filter(|field| !field.is_proposed()) {
            self.typed.insert(field.parameter, field.text().to_owned());
        }
        let source = self.begun.source.clone();
        let (parameters, source): (&[Parameter], _) = match &self.subject {
            Subject::Figure(kind) => {
                let own = source.filter(|source| source.kind() == Some(*kind));
                let new = || Source::Figure(Figure::default_of(*kind, &self.before.sensor));
                (kind.parameters(), Some(own.unwrap_or_else(new)))
            }
            Subject::Picture(_) => (PICTURE_PARAMETERS, source),
            Subject::Sensor => (SENSOR_PARAMETERS, source),
        };
        let field = |&parameter: &Parameter| {
            let initial = source.as_ref().and_then(|source| source.get(parameter));
            let initial = initial.or_else(|| self.begun.sensor.get(parameter));
            let proposed = initial.map_or(String::new(), |value| parameter.format(value));
            let text = self.typed.get(&parameter).unwrap_or(&proposed);
            Field {
                parameter,
                input: TextField::new(text.as_str(), LONGEST),
                proposed: Some(proposed),
                initial,
            }
        };
        self.form.fields = parameters.iter().map(field).collect();
        self.form.set_focus(self.form.focus);
    }

    /// Other kinds of figure, too, begin with their defaults from now on.
    fn set_defaults(&mut self) {
        let sensor = self.before.sensor;
        self.begun = match &self.subject {
            Subject::Figure(kind) => {
                Document::touched(sensor, Source::Figure(Figure::default_of(*kind, &sensor)))
            }
            Subject::Picture(_) => Document {
                source: self.begun.source.clone().map(Source::at_home),
                ..self.begun.clone()
            },
            Subject::Sensor => self.before.on(Sensor::default()),
        };
        self.form.fields.clear();
        self.typed.clear();
        self.fill();
    }

    fn show(&mut self) {
        let made = self.made();
        let is_edited = self.form.focused().is_some_and(|field| !field.input.fresh);
        if let Some(made) = made.clone().filter(|_| !is_edited) {
            self.settled = made;
        }
        self.shown = made.unwrap_or_else(|| self.settled.clone());
    }

    /// None while a field is wrong.
    fn made(&self) -> Option<Document> {
        if self.form.error().is_some() {
            return None;
        }
        let sensor = self.begun.sensor;
        let value = |parameter: Parameter| {
            let mut fields = self.form.fields.iter();
            let field = fields.find(|own| own.parameter == parameter)?;
            value(field, &sensor).ok().flatten()
        };
        let source = match &self.subject {
            Subject::Figure(kind) => Source::Figure(Figure::new(*kind, &sensor, value).ok()?),
            Subject::Picture(name) => {
                let placed = self.begun.source.clone()?.placed(&sensor, value);
                placed.ok()?.named(name)
            }
            Subject::Sensor => {
                let mut values = SENSOR_PARAMETERS
                    .iter()
                    .filter_map(|&own| Some((own, value(own)?)));
                let sensor =
                    values.try_fold(sensor, |sensor, (own, value)| sensor.with(own, value));
                return Some(self.before.on(sensor.ok()?));
            }
        };
        Some(Document::touched(sensor, source))
    }

    fn rows(&self, area: Rect) -> FieldRows {
        let (below, form) = (write::below(area, 1), &self.form);
        FieldRows::of(below, form.has_choice.into(), form.fields.len(), form.focus)
    }

    fn remark(&self, field: &Field) -> Option<&'static str> {
        match (field.parameter, &self.shown.source) {
            (Parameter::Pitch, _) => Some("1: not set"),
            (Parameter::Thickness, Some(Source::Figure(figure)))
                if figure.get(field.parameter).is_some() && !figure.has_hole() =>
            {
                Some(NO_ROOM)
            }
            (Parameter::Thickness, _) => Some("empty: solid"),
            _ => None,
        }
    }
}

impl Page for FormDialog {
    /// The form stays open unless it is accepted.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let kind = self.kind().filter(|_| self.form.focus.is_none());
        match message {
            Message::Accept => match self.form.error() {
                None => {
                    replace(app, self.shown.clone());
                    return Flow::Close;
                }
                Some((index, error)) => {
                    self.form.set_focus(Some(index));
                    refuse(app, error.full);
                }
            },
            Message::Defaults => self.set_defaults(),
            message => match kind.and_then(|kind| kind_after(kind, message)) {
                Some(Ok(kind)) => {
                    self.subject = Subject::Figure(kind);
                    self.fill();
                }
                Some(Err(reason)) => refuse(app, reason),
                None => {
                    if kind.is_some() && matches!(message, Message::Type(_) | Message::Paste(_)) {
                        self.form.move_focus(1);
                    }
                    let sensor = self.form.sensor;
                    match (message, self.form.focused()) {
                        (Message::Step(by), Some(field)) => step(field, *by, &sensor),
                        _ => self.form.take(message),
                    }
                }
            },
        }
        self.show();
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Form, Place::Form, Wheel::Idle)
    }

    fn draw(&self, Canvas { theme, buffer, .. }: Canvas<'_>, area: Rect) -> Option<Position> {
        let title = match &self.subject {
            Subject::Figure(_) => "Figure".to_owned(),
            Subject::Picture(name) => format!("Picture: {name}"),
            Subject::Sensor => "Sensor".to_owned(),
        };
        write::text(buffer, area, theme, &title, Role::Title);
        let (rows, on_kind) = (self.rows(area), self.form.focus.is_none());
        if let Some(kind) = self.kind() {
            let letters = FigureKind::ALL.iter().map(|kind| &kind.name()[..1]);
            let mut letters: Vec<&str> = letters.collect();
            letters.dedup();
            let letters = if on_kind {
                letters.join(" ")
            } else {
                String::new()
            };
            let chosen = ("Kind      ", &*format!("{:9}", kind.name()));
            let remark = (&*letters, Role::Key);
            draw_choice(theme, chosen, on_kind, remark, buffer, write::row(area, 1));
        }
        let remark = |field: &Field| self.remark(field);
        let cursor = rows.draw(theme, &self.form, (LABEL, INPUT), remark, buffer);
        let before = Reading::of(&self.before).imprint;
        let cut = before.count() - before.resized(self.shown.sensor.size()).count();
        if cut > 0 {
            let warning = format!("! {} will be cut", counted(cut, "active taxel"));
            write::wrapped(buffer, rows.rest(area), theme, &warning, Role::Error);
        }
        cursor.or(on_kind.then(|| write::row(area, 1).as_position()))
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        self.form.focus.is_some() || !is_edit(message)
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        if self.form.has_choice && at.y == area.y + 1 {
            return Some(Message::ToField(None));
        }
        Some(Message::ToField(Some(self.rows(area).at(at.y)?)))
    }
}

/// The kind that a message chooses, or why it chooses none; None if the kind has no use for it.
fn kind_after(now: FigureKind, message: &Message) -> Option<Result<FigureKind, String>> {
    let all = FigureKind::ALL;
    let at = all.iter().position(|&own| own == now)?;
    let begins_number = |first: char| "+-.0123456789".contains(first);
    Some(match message {
        // A click on the kind, if it already has the focus, chooses the next kind.
        Message::ToField(None) | Message::Choose(Arrow::Right) => Ok(all[around(at, 1, all.len())]),
        Message::Choose(Arrow::Left) => Ok(all[around(at, -1, all.len())]),
        Message::Type(letter) if !begins_number(*letter) => {
            let mut following = all.iter().cycle().skip(at + 1).take(all.len());
            let own = letter.to_ascii_lowercase();
            let kind = following.find(|kind| kind.name().starts_with(own));
            let letter = quoted_character(*letter);
            let names = || FigureKind::names().join(", ");
            let none = || format!("no kind begins with {letter}; kinds: {}", names());
            kind.copied().ok_or_else(none)
        }
        message if is_edit(message) => Err("an arrow or a letter chooses the kind".to_owned()),
        _ => return None,
    })
}

fn is_edit(message: &Message) -> bool {
    matches!(
        message,
        Message::Step(_) | Message::Erase(_) | Message::ToEdge(_)
    )
}

/// None for a thickness that is left empty.
fn value(field: &Field, sensor: &Sensor) -> Result<Option<f64>, ParameterError> {
    let parameter = field.parameter;
    match (field.text().trim(), parameter) {
        _ if field.initial.is_some() && field.is_proposed() => Ok(field.initial),
        ("", Parameter::Thickness) => Ok(None),
        ("", _) => Err(ParameterError::Missing {
            parameter,
            range: sensor.range(parameter),
        }),
        (text, _) => sensor.read(parameter, text).map(Some),
    }
}

/// An empty field gets the default; a text that is not a number is kept.
fn step(field: &mut Field, direction: i8, sensor: &Sensor) {
    let value = match value(field, sensor) {
        Ok(None) => sensor.default_value(field.parameter),
        Ok(Some(value)) | Err(ParameterError::Range { value, .. }) => {
            sensor.step(field.parameter, value, direction.into())
        }
        Err(_) => return,
    };
    field.input.set(field.parameter.format(value));
    field.input.enter();
}
