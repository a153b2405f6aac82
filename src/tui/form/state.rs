//! The state of the forms of Figure, Picture and the sensor.
//!
//! A form keeps three documents: the one before it was opened, to which Cancel returns; the one that its fields make,
//! which the matrix shows while all fields are valid; and the last one before the present field was edited, which the
//! matrix shows while that field is invalid. The third one is needed because a text that becomes invalid may have
//! been valid on the way, such as the 1 on the way to 17.

use crate::figure::{Figure, FigureKind};
use crate::formats::value::counted;
use crate::imprint::Imprint;
use crate::parameter::Parameter;
use crate::picture::{PICTURE_PARAMETERS, Picture};
use crate::sensor::{SENSOR_PARAMETERS, Sensor};
use crate::source::Source;
use crate::tui::app::document::{Document, Reading};
use crate::tui::app::message::Message;
use crate::tui::form::fields::{ParameterField, ParameterFields};
use crate::tui::form::memory::FormMemory;
use crate::tui::widget::field_list::FormField;

/// The subject of a form.
#[derive(Clone, Debug, PartialEq)]
pub enum FormSubject {
    /// A figure of a kind; the form can change the kind.
    Figure(FigureKind),
    /// A stored imprint, with its name.
    Picture(String, Box<Imprint>),
    /// The sensor.
    Sensor,
}

/// A form, with the document that it makes.
#[derive(Clone, Debug)]
pub struct FormDialog {
    /// The subject of the form.
    subject: FormSubject,
    /// The fields of the subject.
    form: ParameterFields,
    /// Fields of other kinds of figure, kept as they were typed.
    hidden: Vec<ParameterField>,
    /// The values of the figures accepted so far.
    memory: FormMemory,
    /// The source of the first values: the shape on the matrix, or a new one.
    begun: Option<Source>,
    /// The document on the matrix without the form.
    before: Document,
    /// The imprint of that document.
    before_imprint: Imprint,
    /// The document that the fields make while all are valid, otherwise `settled`.
    shown: Document,
    /// The document that the fields made before the text of the field with the focus was changed. A text that becomes
    /// invalid may have been valid on the way, such as "1" on the way to "17", and the matrix must not keep that
    /// value.
    settled: Document,
}

impl FormDialog {
    /// Creates the form of a figure: of the one on the matrix, or of a new one with the values accepted last; the
    /// first kind is the ellipse.
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

    /// Returns the figure that the fields make; None if the form is not about a figure.
    pub fn made_figure(&self) -> Option<&Figure> {
        match (&self.subject, &self.shown.source) {
            (FormSubject::Figure(_), Some(Source::Figure(figure))) => Some(figure),
            _ => None,
        }
    }

    /// Creates the form of a picture, which starts at its present position.
    pub fn picture(before: &Document, picture: Picture, name: String) -> Self {
        let imprint = Box::new(*picture.imprint());
        let shown = Document::touched(before.sensor, Source::Picture(picture));
        let mut dialog = Self::new(FormSubject::Picture(name, imprint), before, shown);
        dialog.form.set_focus(Some(0));
        dialog
    }

    /// Creates the form of the sensor.
    pub fn sensor(before: &Document) -> Self {
        let mut dialog = Self::new(FormSubject::Sensor, before, before.clone());
        dialog.form.set_focus(Some(0));
        dialog
    }

    /// Creates a form that shows a document; no field has the focus.
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

    /// Returns the subject of the form.
    pub fn subject(&self) -> &FormSubject {
        &self.subject
    }

    /// Returns the heading of the form.
    pub fn title(&self) -> String {
        match &self.subject {
            FormSubject::Figure(_) => "Figure".to_owned(),
            FormSubject::Picture(name, _) => format!("Picture: {name}"),
            FormSubject::Sensor => "Sensor".to_owned(),
        }
    }

    /// Returns the chosen kind of figure; None if the form is not about a figure.
    pub fn kind(&self) -> Option<FigureKind> {
        match self.subject {
            FormSubject::Figure(kind) => Some(kind),
            _ => None,
        }
    }

    /// Returns the fields.
    pub fn form(&self) -> &ParameterFields {
        &self.form
    }

    /// Returns the document that the matrix shows.
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

    /// Returns the parameters of the subject, in the order of their fields.
    fn parameters(&self) -> Vec<Parameter> {
        match self.subject {
            FormSubject::Figure(kind) => kind.parameters().to_vec(),
            FormSubject::Picture(..) => PICTURE_PARAMETERS.to_vec(),
            FormSubject::Sensor => SENSOR_PARAMETERS.to_vec(),
        }
    }

    /// Makes the fields of the subject: edited ones keep their text, the others get the subject's values.
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

    /// Creates a field with the value of the shape with which the form began, or the default. For another kind of
    /// figure, it has the value accepted last for this kind, or the default.
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

    /// Sets the fields to the defaults of the subject; those of a picture are the position at which it was stored.
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

    /// Changes the fields by `change`, and updates the document that the matrix shows.
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

    /// Returns the document that the fields make; None if a field is invalid.
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

    /// Handles a character: types it into the field; on the kind, chooses the next kind that begins with it. No kind
    /// begins with a digit, a sign or a point: such a character begins the number in the first field. Returns false if
    /// no kind begins with the character.
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

    /// Handles pasted text: types it into the field; on the kind, chooses the kind with that name. Returns false if
    /// there is no such kind.
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

    /// Chooses the next kind.
    pub fn choose_next_kind(&mut self) {
        self.next_kind(1, |_| true);
    }

    /// Chooses the previous kind.
    pub fn choose_previous_kind(&mut self) {
        self.next_kind(FigureKind::ALL.len() - 1, |_| true);
    }

    /// Chooses the first kind that fits, in steps of `step` from the present one; returns false if none fits.
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

/// Returns true if a number may begin with this character.
fn begins_number(character: char) -> bool {
    matches!(character, '0'..='9' | '-' | '+' | '.')
}

/// Creates a figure of a kind, with the values accepted last or the defaults.
fn new_figure(kind: FigureKind, sensor: &Sensor, memory: &FormMemory) -> Figure {
    let known = memory.figure(kind, sensor);
    known.unwrap_or_else(|| Figure::default_of(kind, sensor))
}
