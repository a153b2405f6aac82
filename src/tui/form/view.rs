//! The forms of a figure, a picture and the sensor.
//!
//! ```text
//! Figure                                              title
//! Kind      < ellipse   > e r t p h o                 kind, and the letters that choose one (figures only)
//!
//! Radius x  4.00      above 0, up to 16 cells         fields, drawn by widget::field_rows
//! Thickness           above 0, up to 16 cells
//!   empty: solid                                      a remark on a field that may be empty
//! ! 3 active taxels will be cut                       what would be lost (sensor only)
//! ```
//! The matrix beside the form shows the shape or sensor that the fields make.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::figure::{FigureKind, NO_ROOM};
use taxel_core::parameter::Parameter;
use taxel_core::quote::quoted_character;
use taxel_core::source::Source;

use crate::tui::app::change::{refuse, replace};
use crate::tui::app::message::Message;
use crate::tui::app::page::{Flow, Page, Slot};
use crate::tui::app::state::App;
use crate::tui::form::state::{FormDialog, ParameterField};
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::widget::field_list::{FieldRows, FormField};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

const LABEL: usize = 10;
const NAME: usize = 9;
const LETTERS: usize = LABEL + 2 + NAME + 3;
const INPUT: usize = 9;

impl Page for FormDialog {
    /// The form stays open unless it is accepted.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let on_kind = self.form().focus().is_none();
        match message.clone() {
            Message::Accept => match self.form().error() {
                None => {
                    if let Some(figure) = self.made_figure() {
                        app.forms.note_figure(figure, &self.shown().sensor);
                    }
                    replace(app, self.shown().clone());
                    return Flow::Close;
                }
                Some((index, error)) => {
                    self.edit(|form| form.set_focus(Some(index)));
                    refuse(app, error.full);
                }
            },
            // A click on the kind, if it already has the focus, chooses the next kind.
            Message::ToField(None) | Message::Choose(Arrow::Right) if on_kind => {
                self.choose_next_kind();
            }
            Message::Choose(Arrow::Left) if on_kind => self.choose_previous_kind(),
            Message::Type(character) => {
                if !self.insert(character) {
                    let kind = quoted_character(character);
                    refuse(
                        app,
                        format!("no kind begins with {kind}; kinds: {}", kinds()),
                    );
                }
            }
            Message::Paste(text) => {
                if !self.paste(&text) {
                    refuse(app, format!("no kind named {text:?}; kinds: {}", kinds()));
                }
            }
            Message::Defaults => self.set_defaults(),
            Message::Step(_) | Message::Erase(_) | Message::ToEdge(_) if on_kind => {
                refuse(app, "an arrow or a letter chooses the kind");
            }
            Message::Step(direction) => self.edit(|form| form.step(direction)),
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

    fn draw(
        &self,
        theme: &Theme,
        _keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let title = self.title();
        write::text(buffer, area, theme, &title, Role::Title);
        let (form, rows) = (self.form(), rows(self, area));
        let mut cursor = None;
        if let Some(kind) = self.kind() {
            let (row, focused) = (write::row(area, 1), form.focus().is_none());
            draw_kind(theme, kind, focused, buffer, row);
            cursor = focused.then(|| row.as_position());
        }
        let remark = |field: &ParameterField| remark(field, self);
        cursor = cursor.or(rows.draw(theme, form, (LABEL, INPUT), remark, buffer));
        if let Some(warning) = self.warning() {
            let warning = format!("! {warning}");
            write::wrapped(buffer, rows.rest(area), theme, &warning, Role::Error);
        }
        cursor
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        let edits = matches!(
            message,
            Message::Step(_) | Message::Erase(_) | Message::ToEdge(_)
        );
        self.form().focus().is_some() || !edits
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        if self.kind().is_some() && at.y == area.y + 1 {
            let is_focused = self.form().focus().is_none();
            return Some(if is_focused {
                click_on_kind(usize::from(at.x - area.x))
            } else {
                Message::ToField(None)
            });
        }
        let field = rows(self, area).at(at.y)?;
        Some(Message::ToField(Some(field)))
    }
}

fn rows(dialog: &FormDialog, area: Rect) -> FieldRows {
    let (fixed, fields) = (dialog.kind().is_some().into(), dialog.form().fields());
    let focus = dialog.form().focus();
    FieldRows::of(write::below(area, 1), fixed, fields.len(), focus)
}

fn kind_letters() -> Vec<&'static str> {
    let mut letters: Vec<&str> = FigureKind::ALL
        .iter()
        .map(|kind| &kind.name()[..1])
        .collect();
    letters.dedup();
    letters
}

fn click_on_kind(column: usize) -> Message {
    let letter = column
        .checked_sub(LETTERS)
        .filter(|place| place.is_multiple_of(2));
    let letter = letter.and_then(|place| kind_letters().get(place / 2).copied());
    match letter.and_then(|letter| letter.chars().next()) {
        Some(letter) => Message::Type(letter),
        None if column == LABEL => Message::Choose(Arrow::Left),
        None => Message::ToField(None),
    }
}

fn draw_kind(theme: &Theme, kind: FigureKind, focused: bool, buffer: &mut Buffer, row: Rect) {
    let label = format!("{:LABEL$}", "Kind");
    let name = format!("{:NAME$}", kind.name());
    let role = if focused { Role::Focus } else { Role::Text };
    let letters = if focused {
        kind_letters().join(" ")
    } else {
        String::new()
    };
    let pieces = [
        (label.as_str(), Role::Text),
        ("< ", Role::Quiet),
        (name.as_str(), role),
        (" >", Role::Quiet),
        (" ", Role::Text),
        (letters.as_str(), Role::Key),
    ];
    write::line(buffer, row, theme, pieces);
}

fn remark(field: &ParameterField, dialog: &FormDialog) -> Option<&'static str> {
    if field.parameter() == Parameter::Pitch {
        return Some("1: not set");
    }
    if !field.optional {
        return None;
    }
    match &dialog.shown().source {
        Some(Source::Figure(figure))
            if figure.get(field.parameter()).is_some() && !figure.has_hole() =>
        {
            Some(NO_ROOM)
        }
        _ => Some("empty: solid"),
    }
}

fn kinds() -> String {
    FigureKind::names().join(", ")
}
