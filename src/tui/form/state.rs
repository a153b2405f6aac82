//! The state of the forms of Figure, Picture and the sensor.
//!
//! A form keeps three documents: the one before it was opened, which Cancel goes back to; the one that its fields make,
//! which the matrix shows while all fields are valid; and the last one before the present field was edited, which the
//! matrix shows while that field is invalid. The third one matters because a text that becomes invalid may have been
//! valid on the way, like the 1 on the way to 17.

use crate::figure::{Figure, FigureKind};
use crate::formats::value::counted;
use crate::imprint::Imprint;
use crate::parameter::{Parameter, ParameterError};
use crate::picture::{PICTURE_PARAMETERS, Picture};
use crate::sensor::{SENSOR_PARAMETERS, Sensor};
use crate::source::Source;
use crate::tui::app::document::{Document, Reading};
use crate::tui::app::message::Message;
use crate::tui::form::fields::{ParameterField, ParameterForm};
use crate::tui::form::memory::FormMemory;
use crate::tui::keys::key::Arrow;
use crate::tui::widget::number::around;

/// What a form is about.
#[derive(Clone, Debug, PartialEq)]
pub enum FormSubject {
    /// A figure of a kind, which can be changed in the form.
    Figure(FigureKind),
    /// A stored imprint, by its name.
    Picture(String, Box<Imprint>),
    /// The sensor.
    Sensor,
}

/// A form with what it would make of the matrix.
#[derive(Clone, Debug)]
pub struct FormDialog {
    /// What the form is about.
    subject: FormSubject,
    /// The fields of the subject.
    form: ParameterForm,
    /// Fields of other kinds of figure, kept as they were typed.
    hidden: Vec<ParameterField>,
    /// The values of figures that were accepted before.
    memory: FormMemory,
    /// What the fields had at first: the shape on the matrix, or a new one.
    begun: Option<Source>,
    /// What is on the matrix without the form.
    before: Document,
    /// Its imprint.
    before_imprint: Imprint,
    /// The document that the fields make, while all of them are valid.
    shown: Document,
    /// What they made of it before the field that has the focus was typed in. A field that becomes wrong may have been
    /// right on the way, "1" on the way to "17": the matrix does not stay there.
    settled: Document,
}

impl FormDialog {
    /// The form of a figure: of the one on the matrix, or a new one with the values that were accepted last; at first an
    /// ellipse.
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

    /// The figure that its fields make; None if they make another thing.
    pub fn made_figure(&self) -> Option<&Figure> {
        match (&self.subject, &self.shown.source) {
            (FormSubject::Figure(_), Some(Source::Figure(figure))) => Some(figure),
            _ => None,
        }
    }

    /// The form of a picture, which starts just where it is.
    pub fn picture(before: &Document, picture: Picture, name: String) -> Self {
        let imprint = Box::new(*picture.imprint());
        let shown = Document::touched(before.sensor, Source::Picture(picture));
        let mut dialog = Self::new(FormSubject::Picture(name, imprint), before, shown);
        dialog.form.set_focus(Some(0));
        dialog
    }

    /// The form of the sensor.
    pub fn sensor(before: &Document) -> Self {
        let mut dialog = Self::new(FormSubject::Sensor, before, before.clone());
        dialog.form.set_focus(Some(0));
        dialog
    }

    /// A form that shows a document; no field has the focus.
    fn new(subject: FormSubject, before: &Document, shown: Document) -> Self {
        let form = ParameterForm::new(Vec::new(), before.sensor);
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

    /// What it is about.
    pub fn subject(&self) -> &FormSubject {
        &self.subject
    }

    /// Its heading.
    pub fn title(&self) -> String {
        match &self.subject {
            FormSubject::Figure(_) => "Figure".to_owned(),
            FormSubject::Picture(name, _) => format!("Picture: {name}"),
            FormSubject::Sensor => "Sensor".to_owned(),
        }
    }

    /// The kind of figure that is chosen; none where there is nothing to choose.
    pub fn kind(&self) -> Option<FigureKind> {
        match self.subject {
            FormSubject::Figure(kind) => Some(kind),
            _ => None,
        }
    }

    /// The fields.
    pub fn form(&self) -> &ParameterForm {
        &self.form
    }

    /// What the matrix shows.
    pub fn shown(&self) -> &Document {
        &self.shown
    }

    /// What would be lost, in a sentence.
    pub fn warning(&self) -> Option<String> {
        let (columns, rows) = (self.shown.sensor.columns(), self.shown.sensor.rows());
        let all = self.before_imprint;
        let lost = all.count() - all.resized(columns, rows).count();
        let taxels = counted(lost, "active taxel");
        (lost > 0).then(|| format!("{taxels} will be cut"))
    }

    /// The parameters of the subject, in the order of their fields.
    fn parameters(&self) -> Vec<Parameter> {
        match self.subject {
            FormSubject::Figure(kind) => kind.parameters().to_vec(),
            FormSubject::Picture(..) => PICTURE_PARAMETERS.to_vec(),
            FormSubject::Sensor => SENSOR_PARAMETERS.to_vec(),
        }
    }

    /// The fields of the subject: those that were typed in before as they were, the others with its own values.
    fn fill(&mut self) {
        let (sensor, focus) = (*self.form.sensor(), self.form.focus());
        let mut known = std::mem::take(&mut self.hidden);
        known.extend(
            std::mem::replace(&mut self.form, ParameterForm::new(Vec::new(), sensor)).into_fields(),
        );
        // A figure of another kind is another figure: what the one on the matrix has does not stick to it.
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
        self.form = ParameterForm::new(fields, sensor);
        self.form.set_focus(focus);
    }

    /// A field with the value of the shape that the form began with, or the default; a figure of another kind has the values
    /// that one was accepted with last, or its defaults.
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

    /// Gives the fields the defaults of what the form is about; a picture's are those of the place where it was stored.
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
        // Nor do other kinds of figure begin with anything else from here on.
        self.memory = FormMemory::default();
        self.hidden.clear();
        self.form = ParameterForm::new(Vec::new(), sensor);
        self.fill();
        self.edit(|form| form.set_focus(focus));
    }

    /// Changes the fields by `change`, and the matrix follows.
    pub fn edit(&mut self, change: impl FnOnce(&mut ParameterForm)) {
        change(&mut self.form);
        if let Ok(document) = self.made() {
            self.shown = document;
            let typed = self.form.focus().and_then(|at| self.form.fields().get(at));
            if typed.is_none_or(ParameterField::fresh) {
                self.settled = self.shown.clone();
            }
        } else {
            self.shown = self.settled.clone();
        }
    }

    /// What the fields make of the matrix; while one of them is wrong, there is no answer.
    fn made(&self) -> Result<Document, ParameterError> {
        if let Some((_, error)) = self.form.error() {
            return Err(error);
        }
        let sensor = self.before.sensor;
        let value = |parameter: Parameter| self.form.value(parameter);
        match &self.subject {
            FormSubject::Figure(kind) => {
                let figure = Figure::new(*kind, &sensor, value)?;
                Ok(Document::touched(sensor, Source::Figure(figure)))
            }
            FormSubject::Picture(name, imprint) => {
                let picture = Picture::new(**imprint, &sensor, value)?.named(name);
                Ok(Document::touched(sensor, Source::Picture(picture)))
            }
            FormSubject::Sensor => {
                let own = self
                    .parameters()
                    .into_iter()
                    .filter_map(|parameter| Some((parameter, value(parameter)?)));
                let sensor = own
                    .into_iter()
                    .try_fold(sensor, |sensor: Sensor, (parameter, value)| {
                        sensor.with(parameter, value)
                    })?;
                Ok(self.before.on(sensor))
            }
        }
    }

    /// Goes `by` rows on; the kind is a row above the fields, and the last row is followed by the first.
    pub fn move_focus(&mut self, by: i8) {
        let head = usize::from(self.kind().is_some());
        let now = self.form.focus().map_or(0, |index| index + head);
        let next = around(now, by, self.form.fields().len() + head);
        self.edit(|form| form.set_focus(next.checked_sub(head)));
    }

    /// An arrow: chooses the kind, moves in a field or to another one.
    pub fn choose(&mut self, arrow: Arrow) {
        match (self.form.focus(), arrow) {
            (None, Arrow::Left) => self.next_kind(FigureKind::ALL.len() - 1, |_| true),
            (None, Arrow::Right) => self.next_kind(1, |_| true),
            (Some(_), Arrow::Left | Arrow::Right) => self.form.take(&Message::Choose(arrow)),
            (_, Arrow::Up) => self.move_focus(-1),
            (_, Arrow::Down) => self.move_focus(1),
        }
    }

    /// A character: into the field; on the kind, the next kind that begins with it. No kind begins with a digit, a sign
    /// or a point: these begin the number in the first field.
    pub fn insert(&mut self, character: char) {
        if self.form.focus().is_none() && begins_number(character) {
            self.move_focus(1);
        }
        if self.form.focus().is_some() {
            self.edit(|form| form.take(&Message::Type(character)));
        } else {
            self.next_kind(1, |kind| {
                kind.name().starts_with(character.to_ascii_lowercase())
            });
        }
    }

    /// Pasted text: into the field; on the kind, the kind of that name. Returns whether it had a use.
    pub fn paste(&mut self, text: &str) -> bool {
        let name = text.trim().to_lowercase();
        let on_kind = self.form.focus().is_none() && self.kind().is_some();
        if on_kind && name.starts_with(begins_number) {
            self.move_focus(1);
        } else if on_kind {
            let kind = FigureKind::from_name(&name);
            self.next_kind(1, |other| Some(other) == kind);
            return kind.is_some();
        }
        self.edit(|form| form.take(&Message::Paste(text.to_owned())));
        true
    }

    /// The first kind, `step` after `step` from the present one on, that fits; the present one where none does.
    fn next_kind(&mut self, step: usize, fits: impl Fn(FigureKind) -> bool) {
        let kinds = FigureKind::ALL;
        let own = |kind: FigureKind| kinds.iter().position(|&other| other == kind);
        let Some(now) = self.kind().and_then(own) else {
            return;
        };
        let next = (1..=kinds.len())
            .map(|count| kinds[(now + count * step) % kinds.len()])
            .find(|&kind| fits(kind));
        if let Some(kind) = next {
            self.subject = FormSubject::Figure(kind);
            self.fill();
            self.edit(|_| {});
        }
    }
}

/// Whether a number may begin with a character.
fn begins_number(character: char) -> bool {
    matches!(character, '0'..='9' | '-' | '+' | '.')
}

/// A figure of a kind: as it was accepted last, or with the defaults.
fn new_figure(kind: FigureKind, sensor: &Sensor, memory: &FormMemory) -> Figure {
    let known = memory.figure(kind, sensor);
    known.unwrap_or_else(|| Figure::default_of(kind, sensor))
}
