//! The forms of Figure, Picture and the sensor.
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

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::figure::{Figure, FigureKind, NO_ROOM};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::{Parameter, ParameterError};
use taxel_core::picture::{PICTURE_PARAMETERS, Picture};
use taxel_core::pose::{Anchor, Axis, DecimalRange};
use taxel_core::quote::quoted_character;
use taxel_core::sensor::{MatrixSize, SENSOR_PARAMETERS, Sensor};
use taxel_core::source::Source;
use taxel_files::formats::value::counted;

use crate::tui::app::change::{refuse, replace};
use crate::tui::app::document::{Document, Reading};
use crate::tui::app::message::Message;
use crate::tui::app::page::{Canvas, Flow, Page, Slot};
use crate::tui::app::state::App;
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::Context;
use crate::tui::widget::field_list::{FieldList, FieldRows, FormError, FormField};
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

const LABEL: usize = 10;
const INPUT: usize = 9;

#[derive(Clone, Debug, PartialEq)]
enum Subject {
    Figure(FigureKind),
    Picture(String, Box<Imprint>),
    Sensor,
}

#[derive(Clone, Debug)]
pub struct FormDialog {
    subject: Subject,
    form: FieldList<ParameterField>,
    /// The texts that were typed for other kinds of figures.
    typed: Vec<(Parameter, String)>,
    /// The figures accepted so far.
    memory: FormMemory,
    /// What the fields had at first.
    begun: Document,
    /// To what Cancel returns.
    before: Document,
    /// What the matrix shows.
    shown: Document,
    /// What it showed before the field with the focus was edited.
    settled: Document,
}

impl FormDialog {
    pub fn figure(before: &Document, memory: &FormMemory) -> Self {
        let figure = match before.source {
            Some(Source::Figure(figure)) => figure,
            _ => memory.new_figure(memory.last_kind(), &before.sensor),
        };
        let begun = Document::touched(before.sensor, Source::Figure(figure));
        Self::new(Subject::Figure(figure.kind()), before, begun, memory)
    }

    pub fn picture(before: &Document, picture: Picture, name: String) -> Self {
        let subject = Subject::Picture(name, Box::new(*picture.imprint()));
        let begun = Document::touched(before.sensor, Source::Picture(picture));
        Self::new(subject, before, begun, &FormMemory::default())
    }

    pub fn sensor(before: &Document) -> Self {
        Self::new(
            Subject::Sensor,
            before,
            before.clone(),
            &FormMemory::default(),
        )
    }

    fn new(subject: Subject, before: &Document, begun: Document, memory: &FormMemory) -> Self {
        let mut dialog = Self {
            form: FieldList::new(Vec::new(), false, before.sensor),
            subject,
            typed: Vec::new(),
            memory: memory.clone(),
            before: before.clone(),
            shown: begun.clone(),
            settled: begun.clone(),
            begun,
        };
        dialog.fill();
        if dialog.kind().is_none() {
            dialog.form.set_focus(Some(0));
        }
        dialog
    }

    fn kind(&self) -> Option<FigureKind> {
        match self.subject {
            Subject::Figure(kind) => Some(kind),
            _ => None,
        }
    }

    pub fn shown(&self) -> &Document {
        &self.shown
    }

    fn on_kind(&self) -> bool {
        self.form.focus.is_none()
    }

    /// Makes the fields of the subject. A figure of another kind is another figure: it has what was typed, accepted last
    /// for this kind, or by default, not what the one on the matrix has.
    fn fill(&mut self) {
        for field in self.form.fields.iter().filter(|field| field.changed()) {
            self.typed
                .retain(|(parameter, _)| *parameter != field.parameter);
            self.typed.push((field.parameter, field.text().to_owned()));
        }
        let sensor = self.before.sensor;
        let source = match (&self.subject, &self.begun.source) {
            (Subject::Figure(kind), source)
                if source.as_ref().and_then(Source::kind) != Some(*kind) =>
            {
                Some(Source::Figure(self.memory.new_figure(Some(*kind), &sensor)))
            }
            (_, source) => source.clone(),
        };
        let parameters = match self.subject {
            Subject::Figure(kind) => kind.parameters(),
            Subject::Picture(..) => PICTURE_PARAMETERS,
            Subject::Sensor => SENSOR_PARAMETERS,
        };
        let fields = parameters.iter().map(|&parameter| {
            let value = source.as_ref().and_then(|source| source.get(parameter));
            let value = value.or_else(|| self.begun.sensor.get(parameter));
            let mut field = ParameterField::new(parameter, value);
            if let Some((_, text)) = self.typed.iter().find(|(own, _)| *own == parameter) {
                field.input = TextField::new(text.clone(), LONGEST);
            }
            field
        });
        let (fields, focus) = (fields.collect(), self.form.focus);
        self.form = FieldList::new(fields, self.kind().is_some(), sensor);
        self.form.set_focus(focus);
    }

    fn set_defaults(&mut self) {
        let sensor = self.before.sensor;
        let source = match &self.subject {
            Subject::Figure(kind) => Source::Figure(Figure::default_of(*kind, &sensor)),
            Subject::Picture(name, imprint) => {
                Source::Picture(Picture::at_home(**imprint).named(name))
            }
            Subject::Sensor => {
                self.begun = self.before.on(Sensor::default());
                return self.begin_anew();
            }
        };
        self.begun = Document::touched(sensor, source);
        self.begin_anew();
    }

    /// Other kinds of figure, too, begin with their defaults from now on.
    fn begin_anew(&mut self) {
        self.memory = FormMemory::default();
        let focus = self.form.focus;
        self.form = FieldList::new(Vec::new(), false, self.before.sensor);
        self.typed.clear();
        self.fill();
        self.edit(|form| form.set_focus(focus));
    }

    fn edit(&mut self, change: impl FnOnce(&mut FieldList<ParameterField>)) {
        change(&mut self.form);
        let made = self.made();
        let focused = self.form.focus.and_then(|at| self.form.fields.get(at));
        if let Some(made) = made
            .clone()
            .filter(|_| focused.is_none_or(|field| field.input.fresh))
        {
            self.settled = made;
        }
        self.shown = made.unwrap_or_else(|| self.settled.clone());
    }

    /// None while a field is wrong.
    fn made(&self) -> Option<Document> {
        if self.form.error().is_some() {
            return None;
        }
        let sensor = self.before.sensor;
        let value = |parameter: Parameter| {
            let field = self
                .form
                .fields
                .iter()
                .find(|own| own.parameter == parameter)?;
            field.value(&sensor).ok().flatten()
        };
        let source = match &self.subject {
            Subject::Figure(kind) => Source::Figure(Figure::new(*kind, &sensor, value).ok()?),
            Subject::Picture(name, imprint) => {
                Source::Picture(Picture::new(**imprint, &sensor, value).ok()?.named(name))
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

    /// Chooses the next kind that fits, in steps through the list of kinds.
    fn next_kind(&mut self, step: usize, fits: impl Fn(FigureKind) -> bool) -> bool {
        let kinds = FigureKind::ALL;
        let now = kinds.iter().position(|&own| Some(own) == self.kind());
        let mut next = now.into_iter().flat_map(|now| {
            (1..=kinds.len()).map(move |count| kinds[(now + count * step) % kinds.len()])
        });
        let Some(kind) = next.find(|&kind| fits(kind)) else {
            return false;
        };
        self.subject = Subject::Figure(kind);
        self.fill();
        self.edit(|_| {});
        true
    }

    fn rows(&self, area: Rect) -> FieldRows {
        let (fixed, fields) = (self.kind().is_some().into(), &self.form.fields);
        FieldRows::of(write::below(area, 1), fixed, fields.len(), self.form.focus)
    }

    fn remark(&self, field: &ParameterField) -> Option<&'static str> {
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
        let on_kind = self.on_kind();
        let kinds = FigureKind::names().join(", ");
        let begins_number =
            |text: &str| text.starts_with(|first: char| "+-.0123456789".contains(first));
        let last = FigureKind::ALL.len() - 1;
        match message.clone() {
            Message::Accept => match self.form.error() {
                None => {
                    if let Some(Source::Figure(figure)) = &self.shown.source {
                        app.forms.note_figure(figure, &self.shown.sensor);
                    }
                    replace(app, self.shown.clone());
                    return Flow::Close;
                }
                Some((index, error)) => {
                    self.edit(|form| form.set_focus(Some(index)));
                    refuse(app, error.full);
                }
            },
            Message::Defaults => self.set_defaults(),
            // A click on the kind, if it already has the focus, chooses the next kind.
            Message::ToField(None) | Message::Choose(Arrow::Right) if on_kind => {
                self.next_kind(1, |_| true);
            }
            Message::Choose(Arrow::Left) if on_kind => {
                self.next_kind(last, |_| true);
            }
            Message::Type(letter) if on_kind && !begins_number(&letter.to_string()) => {
                let own = letter.to_ascii_lowercase();
                if !self.next_kind(1, |kind| kind.name().starts_with(own)) {
                    let letter = quoted_character(letter);
                    refuse(app, format!("no kind begins with {letter}; kinds: {kinds}"));
                }
            }
            Message::Paste(text) if on_kind && !begins_number(text.trim()) => {
                let name = text.trim().to_lowercase();
                if !self.next_kind(1, |kind| kind.name() == name) {
                    refuse(app, format!("no kind named {text:?}; kinds: {kinds}"));
                }
            }
            Message::Type(_) | Message::Paste(_) => self.edit(|form| {
                if on_kind {
                    form.move_focus(1);
                }
                form.take(message);
            }),
            message if on_kind && is_edit(&message) => {
                refuse(app, "an arrow or a letter chooses the kind");
            }
            Message::Step(direction) => self.edit(|form| {
                let sensor = form.sensor;
                if let Some(field) = form.focused() {
                    field.step(direction, &sensor);
                }
            }),
            other => self.edit(|form| form.take(&other)),
        }
        Flow::Stay
    }

    fn context(&self) -> Context {
        Context::Form
    }

    fn slot(&self) -> Slot {
        Slot::Form
    }

    fn draw(&self, Canvas { theme, buffer, .. }: Canvas<'_>, area: Rect) -> Option<Position> {
        let title = match &self.subject {
            Subject::Figure(_) => "Figure".to_owned(),
            Subject::Picture(name, _) => format!("Picture: {name}"),
            Subject::Sensor => "Sensor".to_owned(),
        };
        write::text(buffer, area, theme, &title, Role::Title);
        let rows = self.rows(area);
        let mut cursor = None;
        if let Some(kind) = self.kind() {
            let (row, focused) = (write::row(area, 1), self.on_kind());
            draw_kind(theme, kind, focused, buffer, row);
            cursor = focused.then(|| row.as_position());
        }
        let remark = |field: &ParameterField| self.remark(field);
        cursor = cursor.or(rows.draw(theme, &self.form, (LABEL, INPUT), remark, buffer));
        let before = Reading::of(&self.before).imprint;
        let cut = before.count() - before.resized(self.shown.sensor.size()).count();
        if cut > 0 {
            let warning = format!("! {} will be cut", counted(cut, "active taxel"));
            write::wrapped(buffer, rows.rest(area), theme, &warning, Role::Error);
        }
        cursor
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        !self.on_kind() || !is_edit(message)
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        if self.kind().is_some() && at.y == area.y + 1 {
            return Some(Message::ToField(None));
        }
        Some(Message::ToField(Some(self.rows(area).at(at.y)?)))
    }
}

fn is_edit(message: &Message) -> bool {
    matches!(
        message,
        Message::Step(_) | Message::Erase(_) | Message::ToEdge(_)
    )
}

fn draw_kind(theme: &Theme, kind: FigureKind, focused: bool, buffer: &mut Buffer, row: Rect) {
    let mut letters: Vec<&str> = FigureKind::ALL
        .iter()
        .map(|kind| &kind.name()[..1])
        .collect();
    letters.dedup();
    let letters = if focused {
        letters.join(" ")
    } else {
        String::new()
    };
    let name = format!("{:9}", kind.name());
    let role = if focused { Role::Focus } else { Role::Text };
    let pieces = [
        ("Kind      ", Role::Text),
        ("< ", Role::Quiet),
        (name.as_str(), role),
        (" > ", Role::Quiet),
        (letters.as_str(), Role::Key),
    ];
    write::line(buffer, row, theme, pieces);
}

const LONGEST: usize = 24;

#[derive(Clone, Debug)]
struct ParameterField {
    parameter: Parameter,
    input: TextField,
    /// The initial value, which is always accepted: a shape that was moved or loaded may have more decimals than the
    /// form shows.
    initial: Option<f64>,
}

impl ParameterField {
    fn new(parameter: Parameter, initial: Option<f64>) -> Self {
        let input = TextField::new(text_of(parameter, initial), LONGEST);
        Self {
            parameter,
            input,
            initial,
        }
    }

    fn changed(&self) -> bool {
        self.text() != text_of(self.parameter, self.initial)
    }

    /// None for a thickness that is left empty.
    fn value(&self, sensor: &Sensor) -> Result<Option<f64>, ParameterError> {
        let parameter = self.parameter;
        match (self.text().trim(), parameter) {
            _ if self.initial.is_some() && !self.changed() => Ok(self.initial),
            ("", Parameter::Thickness) => Ok(None),
            ("", _) => Err(ParameterError::Missing {
                parameter,
                range: sensor.range(parameter),
            }),
            (text, _) => sensor.read(parameter, text).map(Some),
        }
    }

    /// An empty field gets the default; a text that is not a number is kept.
    fn step(&mut self, direction: i8, sensor: &Sensor) {
        let value = match self.value(sensor) {
            Ok(None) => sensor.default_value(self.parameter),
            Ok(Some(value)) | Err(ParameterError::Range { value, .. }) => {
                sensor.step(self.parameter, value, direction.into())
            }
            Err(_) => return,
        };
        self.input.set(self.parameter.format(value));
        self.input.enter();
    }
}

fn text_of(parameter: Parameter, value: Option<f64>) -> String {
    value.map_or(String::new(), |value| parameter.format(value))
}

impl FormField for ParameterField {
    fn parameter(&self) -> Parameter {
        self.parameter
    }

    fn input(&self) -> &TextField {
        &self.input
    }

    fn input_mut(&mut self) -> &mut TextField {
        &mut self.input
    }

    fn error(&self, sensor: &Sensor) -> Option<FormError> {
        self.value(sensor).err().map(FormError::from)
    }
}

/// What forms begin with: the values accepted last.
#[derive(Clone, Debug, Default)]
pub struct FormMemory {
    figures: Vec<(Figure, MatrixSize)>,
    pub ranges: Option<RememberedRanges>,
}

impl FormMemory {
    pub fn note_figure(&mut self, figure: &Figure, sensor: &Sensor) {
        self.figures
            .retain(|(other, _)| other.kind() != figure.kind());
        self.figures.push((*figure, sensor.size()));
    }

    pub fn last_kind(&self) -> Option<FigureKind> {
        self.figures.last().map(|(figure, _)| figure.kind())
    }

    pub fn figure(&self, kind: FigureKind, sensor: &Sensor) -> Option<Figure> {
        let mut own = self.figures.iter().filter(|(own, _)| own.kind() == kind);
        own.find(|(_, size)| *size == sensor.size())
            .map(|(figure, _)| *figure)
    }

    fn new_figure(&self, kind: Option<FigureKind>, sensor: &Sensor) -> Figure {
        let kind = kind.unwrap_or(FigureKind::Ellipse);
        let known = self.figure(kind, sensor);
        known.unwrap_or_else(|| Figure::default_of(kind, sensor))
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct RememberedRanges {
    pub of: String,
    pub size: MatrixSize,
    pub anchor: Anchor,
    pub ranges: Vec<(Axis, DecimalRange)>,
}

impl RememberedRanges {
    /// The range of an axis. Places belong to the shape and the sensor.
    pub fn get(&self, of: &str, sensor: &Sensor, axis: Axis) -> Option<DecimalRange> {
        let place = matches!(axis, Axis::X0 | Axis::Y0);
        let suits = of == self.of && self.size == sensor.size();
        let known = self.ranges.iter().find(|(own, _)| *own == axis);
        known.filter(|_| !place || suits).map(|(_, range)| *range)
    }
}
