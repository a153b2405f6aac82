//! The forms of a figure, a picture and the sensor.
//!
//! ```text
//! Figure                                              title
//! Kind      < ellipse   > e r t p h o                 kind, and the letters that choose one (figures only)
//!
//! Radius x  4.00      above 0, up to 16 cells         label, text, what the field takes
//!   ! expected a number                               what is wrong with it
//! Thickness           above 0, up to 16 cells
//!   empty: solid                                      a remark on a field that may be empty
//! ! 3 active taxels will be cut                       what would be lost (sensor only)
//! ```
//! In a narrow pane, the range of a field stands under it, and an error replaces the range there. In a low pane every
//! field has one line, and an error replaces the range. The matrix beside the form shows the shape or sensor that the
//! fields make.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::figure::{FigureKind, NO_ROOM};
use crate::parameter::Parameter;
use crate::sensor::Sensor;
use crate::source::Source;
use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot};
use crate::tui::form::fields::ParameterField;
use crate::tui::form::layout::FormRows;
use crate::tui::form::state::FormDialog;
use crate::tui::keys::binding::Context;
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::number::narrow;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// The width of a label, in columns.
const LABEL: usize = 10;
/// The number of characters of the name of a kind.
const NAME: usize = 9;
/// The column of the letters that choose a kind, behind the name in its brackets.
const LETTERS: usize = LABEL + 2 + NAME + 3;
/// The width of a field's text, in columns.
const INPUT: usize = 9;

/// The least width of a pane in which the range stands beside the field, in columns.
const WIDE: u16 = 40;

impl Page for FormDialog {
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
        draw(theme, self, buffer, area)
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let (rows, line) = (FormRows::of(area, self), at.y - area.y);
        if rows.kind == Some(line) {
            let is_focused = self.form().focus().is_none();
            return Some(if is_focused {
                click_on_kind(usize::from(at.x - area.x))
            } else {
                Message::ToField(None)
            });
        }
        let mut fields = rows.fields(self.form().fields().len());
        let field = fields.find(|(_, first)| (*first..first + rows.spacing).contains(&line));
        field.map(|(index, _)| Message::ToField(Some(index)))
    }
}

/// Draws the form. Returns the position of the text cursor.
fn draw(theme: &Theme, dialog: &FormDialog, buffer: &mut Buffer, area: Rect) -> Option<Position> {
    write::clear(buffer, area);
    write::line(
        buffer,
        area,
        theme,
        [(dialog.title().as_str(), Role::Title)],
    );
    let (focus, rows) = (dialog.form().focus(), FormRows::of(area, dialog));
    let mut cursor = None;
    if let (Some(kind), Some(line)) = (dialog.kind(), rows.kind) {
        let row = write::row(area, usize::from(line));
        draw_kind(theme, kind, focus.is_none(), buffer, row);
        cursor = focus.is_none().then(|| Position::new(row.x, row.y));
    }
    let fields = dialog.form().fields();
    let mut end = 0;
    for (index, row) in rows.fields(fields.len()) {
        let (field, row) = (&fields[index], usize::from(row));
        end = row + usize::from(rows.spacing);
        let error = field
            .value(dialog.form().sensor())
            .err()
            .map(|error| error.expected());
        let marked = focus == Some(index);
        let at = draw_field(theme, field, marked, buffer, write::row(area, row));
        let remark = remark(field, dialog).filter(|_| error.is_none());
        let beside = write::right_of(write::row(area, row), area.x + narrow(LABEL + INPUT + 1));
        let under = write::right_of(write::row(area, row + 1), area.x + 2);
        let (error_at, range_at) = match (rows.spacing, area.width >= WIDE) {
            (2, true) => (under, Some(beside)),
            (2, false) => (under, error.is_none().then_some(under)),
            _ => (beside, error.is_none().then_some(beside)),
        };
        if let Some(range_at) = range_at {
            let under = (rows.spacing == 2 && range_at == beside).then_some(under);
            let taken = (field, dialog.form().sensor());
            draw_range(theme, taken, remark, buffer, range_at, under);
        }
        if let Some(error) = error {
            write::line(
                buffer,
                error_at,
                theme,
                [("! ", Role::Error), (error.as_str(), Role::Error)],
            );
        }
        cursor = cursor.or(marked.then_some(at));
    }
    if let Some(warning) = dialog.warning() {
        write::wrapped(
            buffer,
            write::below(area, narrow(end)),
            theme,
            &format!("! {warning}"),
            Role::Error,
        );
    }
    cursor
}

/// Returns the letters that choose a kind.
fn kind_letters() -> Vec<&'static str> {
    let mut letters: Vec<&str> = FigureKind::ALL
        .iter()
        .map(|kind| &kind.name()[..1])
        .collect();
    letters.dedup();
    letters
}

/// Returns the message of a click in a column of the line of the kind, which has the focus: on the left bracket the
/// previous kind, on a letter the kind that begins with it, elsewhere the next kind.
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

/// Draws the kind between angle brackets, and the letters that choose one.
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

/// Draws label and text of a field. Returns the position that the text cursor has in this field.
fn draw_field(
    theme: &Theme,
    field: &ParameterField,
    focused: bool,
    buffer: &mut Buffer,
    row: Rect,
) -> Position {
    let label = format!("{:LABEL$}", field.parameter().row().label);
    // Without the focus a field is shown from its start; with the focus, its cursor must be visible.
    let at = if focused { field.cursor() } else { 0 };
    let (shown, cursor) = write::field_columns(field.text(), at, INPUT, theme);
    let role = if focused { Role::Focus } else { Role::Text };
    write::line(
        buffer,
        row,
        theme,
        [(label.as_str(), Role::Text), (shown.as_str(), role)],
    );
    Position::new(row.x + narrow(LABEL + cursor), row.y)
}

/// Returns a remark about a field, and whether it is about the present value: what an empty field means, or which
/// pitch means that none is set.
fn remark(field: &ParameterField, dialog: &FormDialog) -> Option<(&'static str, bool)> {
    if field.parameter() == Parameter::Pitch {
        let default = dialog.form().sensor().default_value(Parameter::Pitch);
        let pitch = dialog.form().value(Parameter::Pitch);
        return Some(("1: not set", pitch == Some(default)));
    }
    if !field.optional() {
        return None;
    }
    match &dialog.shown().source {
        Some(Source::Figure(figure))
            if figure.get(field.parameter()).is_some() && !figure.has_hole() =>
        {
            Some((NO_ROOM, true))
        }
        _ => Some(("empty: solid", field.text().is_empty())),
    }
}

/// Draws the range of a field, and the remark under or behind it. If there is no room for everything, the unit is
/// left out first, then the remark, or the range if the remark is about the present value.
fn draw_range(
    theme: &Theme,
    (field, sensor): (&ParameterField, &Sensor),
    remark: Option<(&str, bool)>,
    buffer: &mut Buffer,
    area: Rect,
    under: Option<Rect>,
) {
    let bare = sensor.range(field.parameter()).to_string();
    let range = field.parameter().row().unit.after(&bare);
    let mut write = |area: Rect, texts: &[&str]| {
        let text = write::first_fitting(texts, usize::from(area.width));
        write::line(buffer, area, theme, [(text, Role::Quiet)]);
    };
    match (remark, under) {
        (None, _) => write(area, &[&range, &bare]),
        (Some((remark, _)), Some(under)) => {
            write(area, &[&range, &bare]);
            write(under, &[remark]);
        }
        (Some((remark, of_value)), None) => {
            let (both, barely) = (format!("{range}; {remark}"), format!("{bare}; {remark}"));
            let (first, second) = if of_value {
                (remark, remark)
            } else {
                (&*range, &*bare)
            };
            write(area, &[&both, &barely, first, second]);
        }
    }
}
