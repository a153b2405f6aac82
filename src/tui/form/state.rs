//! The state of the forms of Figure, Picture and the sensor.
//!
//! A form keeps three documents: the one before it was opened, to which Cancel returns; the one that its fields make,
//! which the matrix shows while all fields are valid; and the last one before the present field was edited, which the
//! matrix shows while that field is invalid. The third one is needed because a text that becomes invalid may have
//! been valid on the way, such as the 1 on the way to 17.

use taxel_core::figure::{Figure, FigureKind};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::{Parameter, ParameterError};
use taxel_core::picture::{PICTURE_PARAMETERS, Picture};
use taxel_core::pose::{Anchor, Axis, DecimalRange};
use taxel_core::sensor::{MatrixSize, SENSOR_PARAMETERS, Sensor};
use taxel_core::source::Source;
use taxel_files::formats::value::counted;

use crate::tui::app::document::{Document, Reading};
use crate::tui::app::message::Message;
use crate::tui::widget::field_list::{FieldList, FormError, FormField};
use crate::tui::widget::text_field::TextField;

#[derive(Clone, Debug, PartialEq)]
pub enum FormSubject {
    Figure(FigureKind),
    Picture(String, Box<Imprint>),
    Sensor,
}

#[derive(Clone, Debug)]
pub struct FormDialog {
    subject: FormSubject,
    form: ParameterFields,
    hidden: Vec<ParameterField>,
    /// The values of the figures accepted so far.
    memory: FormMemory,
    begun: Option<Source>,
    before: Document,
    before_imprint: Imprint,
    /// The document that the fields make while all are valid, otherwise `settled`.
    shown: Document,
    /// The document that the fields made before the text of the field with the focus was changed. A text that becomes
    /// invalid may have been valid on the way, such as "1" on the way to "17", and the matrix must not keep that
    /// value.
    settled: Document,
}

impl FormDialog {
    pub fn figure(before: &Document, memory: &FormMemory) -> Self {
        let figure = if let Some(Source::Figure(figure)) = before.source {
            figure
        } else {
            let kind = memory.last_kind().unwrap_or(FigureKind::Ellipse);
            new_figure(kind, &before.sensor, memory)
        };
        let mut dialog = Self::new(
            FormSubject::Figure(figure.kind()),
            before,
            Document::touched(before.sensor, Source::Figure(figure)),
        );
        dialog.memory = memory.clone();
        dialog
    }

    pub fn made_figure(&self) -> Option<&Figure> {
        match (&self.subject, &self.shown.source) {
            (FormSubject::Figure(_), Some(Source::Figure(figure))) => Some(figure),
            _ => None,
        }
    }

    pub fn picture(before: &Document, picture: Picture, name: String) -> Self {
        let imprint = Box::new(*picture.imprint());
        let shown = Document::touched(before.sensor, Source::Picture(picture));
        let mut dialog = Self::new(FormSubject::Picture(name, imprint), before, shown);
        dialog.form.set_focus(Some(0));
        dialog
    }

    pub fn sensor(before: &Document) -> Self {
        let mut dialog = Self::new(FormSubject::Sensor, before, before.clone());
        dialog.form.set_focus(Some(0));
        dialog
    }

    fn new(subject: FormSubject, before: &Document, shown: Document) -> Self {
        let form = ParameterFields::new(Vec::new(), false, before.sensor);
        let mut dialog = Self {
            subject,
            form,
            hidden: Vec::new(),
            memory: FormMemory::default(),
            begun: shown.source.clone(),
            before: before.clone(),
            before_imprint: Reading::of(before).imprint,
            settled: shown.clone(),
            shown,
        };
        dialog.fill();
        dialog
    }

    pub fn title(&self) -> String {
        match &self.subject {
            FormSubject::Figure(_) => "Figure".to_owned(),
            FormSubject::Picture(name, _) => format!("Picture: {name}"),
            FormSubject::Sensor => "Sensor".to_owned(),
        }
    }

    pub fn kind(&self) -> Option<FigureKind> {
        match self.subject {
            FormSubject::Figure(kind) => Some(kind),
            _ => None,
        }
    }

    pub fn form(&self) -> &ParameterFields {
        &self.form
    }

    pub fn shown(&self) -> &Document {
        &self.shown
    }

    /// Returns a warning if active taxels would be lost.
    pub fn warning(&self) -> Option<String> {
        let all = self.before_imprint;
        let lost = all.count() - all.resized(self.shown.sensor.size()).count();
        let taxels = counted(lost, "active taxel");
        (lost > 0).then(|| format!("{taxels} will be cut"))
    }

    fn parameters(&self) -> Vec<Parameter> {
        match self.subject {
            FormSubject::Figure(kind) => kind.parameters().to_vec(),
            FormSubject::Picture(..) => PICTURE_PARAMETERS.to_vec(),
            FormSubject::Sensor => SENSOR_PARAMETERS.to_vec(),
        }
    }

    fn fill(&mut self) {
        let (sensor, focus) = (*self.form.sensor(), self.form.focus());
        let mut known = std::mem::take(&mut self.hidden);
        known.extend(self.form.take_fields());
        // A figure of another kind is another figure: it does not take over values of the one on the matrix.
        known.retain(ParameterField::changed);
        let parameters = self.parameters();
        let fields = parameters.into_iter().map(|parameter| {
            let at = known
                .iter()
                .position(|field| field.parameter() == parameter);
            at.map_or_else(
                || self.new_field(parameter, &sensor),
                |at| known.swap_remove(at),
            )
        });
        let fields = fields.collect();
        self.hidden = known;
        self.form = ParameterFields::new(fields, self.kind().is_some(), sensor);
        self.form.set_focus(focus);
    }

    /// For another kind of figure, it has the value accepted last for this kind, or the default.
    fn new_field(&self, parameter: Parameter, sensor: &Sensor) -> ParameterField {
        let own = match (&self.subject, &self.begun) {
            (FormSubject::Figure(kind), begun)
                if begun.as_ref().and_then(Source::kind) != Some(*kind) =>
            {
                new_figure(*kind, sensor, &self.memory).get(parameter)
            }
            (_, begun) => begun.as_ref().and_then(|source| source.get(parameter)),
        };
        let own = own.or_else(|| self.shown.sensor.get(parameter));
        let optional = parameter == Parameter::Thickness;
        let value = if optional {
            own
        } else {
            own.or_else(|| Some(sensor.default_value(parameter)))
        };
        ParameterField::new(parameter, value, optional)
    }

    pub fn set_defaults(&mut self) {
        let (sensor, focus) = (self.before.sensor, self.form.focus());
        match &self.subject {
            FormSubject::Figure(kind) => {
                self.begun = Some(Source::Figure(Figure::default_of(*kind, &sensor)));
            }
            FormSubject::Picture(name, imprint) => {
                let picture = Picture::at_home(**imprint).named(name);
                self.begun = Some(Source::Picture(picture));
            }
            FormSubject::Sensor => self.shown = self.before.on(Sensor::default()),
        }
        // Other kinds of figure, too, begin with their defaults from now on.
        self.memory = FormMemory::default();
        self.hidden.clear();
        self.form.take_fields();
        self.fill();
        self.edit(|form| form.set_focus(focus));
    }

    pub fn edit(&mut self, change: impl FnOnce(&mut ParameterFields)) {
        change(&mut self.form);
        if let Some(document) = self.made() {
            self.shown = document;
            let typed = self.form.focus().and_then(|at| self.form.fields().get(at));
            if typed.is_none_or(ParameterField::fresh) {
                self.settled = self.shown.clone();
            }
        } else {
            self.shown = self.settled.clone();
        }
    }

    fn made(&self) -> Option<Document> {
        if self.form.error().is_some() {
            return None;
        }
        let sensor = self.before.sensor;
        let value = |parameter: Parameter| self.form.value(parameter);
        match &self.subject {
            FormSubject::Figure(kind) => {
                let figure = Figure::new(*kind, &sensor, value).ok()?;
                Some(Document::touched(sensor, Source::Figure(figure)))
            }
            FormSubject::Picture(name, imprint) => {
                let picture = Picture::new(**imprint, &sensor, value).ok()?;
                let source = Source::Picture(picture.named(name));
                Some(Document::touched(sensor, source))
            }
            FormSubject::Sensor => {
                let mut sensor = sensor;
                for parameter in self.parameters() {
                    if let Some(value) = value(parameter) {
                        sensor = sensor.with(parameter, value).ok()?;
                    }
                }
                Some(self.before.on(sensor))
            }
        }
    }

    pub fn insert(&mut self, character: char) -> bool {
        if self.form.focus().is_none() && begins_number(character) {
            self.edit(|form| form.move_focus(1));
        }
        if self.form.focus().is_some() {
            self.edit(|form| form.take(&Message::Type(character)));
            return true;
        }
        let letter = character.to_ascii_lowercase();
        self.next_kind(1, |kind| kind.name().starts_with(letter))
    }

    pub fn paste(&mut self, text: &str) -> bool {
        let name = text.trim().to_lowercase();
        let on_kind = self.form.focus().is_none() && self.kind().is_some();
        if on_kind && name.starts_with(begins_number) {
            self.edit(|form| form.move_focus(1));
        } else if on_kind {
            let kind = name.parse().ok();
            return self.next_kind(1, |other| Some(other) == kind);
        }
        self.edit(|form| form.take(&Message::Paste(text.to_owned())));
        true
    }

    pub fn choose_next_kind(&mut self) {
        self.next_kind(1, |_| true);
    }

    pub fn choose_previous_kind(&mut self) {
        self.next_kind(FigureKind::ALL.len() - 1, |_| true);
    }

    fn next_kind(&mut self, step: usize, fits: impl Fn(FigureKind) -> bool) -> bool {
        let kinds = FigureKind::ALL;
        let own = |kind: FigureKind| kinds.iter().position(|&other| other == kind);
        let Some(now) = self.kind().and_then(own) else {
            return false;
        };
        let next = (1..=kinds.len())
            .map(|count| kinds[(now + count * step) % kinds.len()])
            .find(|&kind| fits(kind));
        if let Some(kind) = next {
            self.subject = FormSubject::Figure(kind);
            self.fill();
            self.edit(|_| {});
        }
        next.is_some()
    }
}

fn begins_number(character: char) -> bool {
    matches!(character, '0'..='9' | '-' | '+' | '.')
}

fn new_figure(kind: FigureKind, sensor: &Sensor, memory: &FormMemory) -> Figure {
    let known = memory.figure(kind, sensor);
    known.unwrap_or_else(|| Figure::default_of(kind, sensor))
}

const LONGEST: usize = 24;

#[derive(Clone, Debug)]
pub struct ParameterField {
    parameter: Parameter,
    pub(in crate::tui) optional: bool,
    input: TextField,
    /// The initial value, which is always accepted: a shape that was moved or loaded may have more decimals than the
    /// form shows.
    initial: Option<f64>,
    initial_text: String,
}

impl ParameterField {
    pub fn new(parameter: Parameter, value: Option<f64>, optional: bool) -> Self {
        let text = value.map_or(String::new(), |value| parameter.format(value));
        let mut input = TextField::new(text.clone(), LONGEST);
        input.enter();
        Self {
            parameter,
            optional,
            input,
            initial: value,
            initial_text: text,
        }
    }

    pub fn changed(&self) -> bool {
        self.text() != self.initial_text
    }

    pub fn fresh(&self) -> bool {
        self.input.fresh()
    }

    pub fn value(&self, sensor: &Sensor) -> Result<Option<f64>, ParameterError> {
        if self.text() == self.initial_text && (self.initial.is_some() || self.optional) {
            return Ok(self.initial);
        }
        match (self.text().trim(), self.optional) {
            ("", true) => Ok(None),
            ("", false) => {
                let range = sensor.range(self.parameter);
                Err(ParameterError::Missing {
                    parameter: self.parameter,
                    range,
                })
            }
            (text, _) => sensor.read(self.parameter, text).map(Some),
        }
    }

    /// An empty field gets the default; a text that is not a number is kept.
    fn step(&mut self, direction: i8, sensor: &Sensor) {
        let value = match self.value(sensor) {
            Ok(Some(value)) => sensor.step(self.parameter, value, i32::from(direction)),
            Ok(None) => sensor.default_value(self.parameter),
            Err(ParameterError::Range { value, .. }) => {
                sensor.step(self.parameter, value, i32::from(direction))
            }
            Err(_) => return,
        };
        self.input.set(self.parameter.format(value));
        self.input.enter();
    }
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

pub type ParameterFields = FieldList<ParameterField>;

impl ParameterFields {
    pub fn value(&self, parameter: Parameter) -> Option<f64> {
        let mut fields = self.fields().iter();
        let field = fields.find(|field| field.parameter == parameter)?;
        field.value(self.sensor()).ok().flatten()
    }

    pub fn step(&mut self, direction: i8) {
        let sensor = *self.sensor();
        if let Some(field) = self.focused() {
            field.step(direction, &sensor);
        }
    }
}

#[derive(Clone, Debug, Default)]
pub struct FormMemory {
    figures: Vec<(Figure, MatrixSize)>,
    pub ranges: Option<RememberedRanges>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RememberedRanges {
    pub of: String,
    pub size: MatrixSize,
    pub anchor: Anchor,
    pub ranges: Vec<(Axis, DecimalRange)>,
}

impl RememberedRanges {
    pub fn get(&self, of: &str, sensor: &Sensor, axis: Axis) -> Option<DecimalRange> {
        let place = matches!(axis, Axis::X0 | Axis::Y0);
        let suits = of == self.of && self.size == sensor.size();
        let mut known = self.ranges.iter().filter(|(own, _)| *own == axis);
        known
            .next()
            .filter(|_| !place || suits)
            .map(|(_, range)| *range)
    }
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
}
