//! The confusion matrix of a model: how often the best classifier takes a touch of one shape for another, and an
//! example imprint for the cell under the cursor.
//!
//! ```text
//! Confusion: model figures-30  limit: error 33.0 %
//! rows: the shape that touches; columns: its name; percent of the row
//! ↑3 →4             1      2      3            how many rows and columns are hidden
//! 4 pentagon     14.2      ·  [75.5]  ▄██▄     the diagonal in brackets, the example
//! octagon named ellipse: 2,184,280 of 3,600,000 touches
//! an imprint left by octagon in 185,576 poses, ellipse in 298,440 poses
//! ```

use std::collections::BTreeMap;
use std::sync::Arc;

use ratatui::layout::{Position, Rect};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::share;
use taxel_core::recognition::{Evaluation, Model, ShapeCount};
use taxel_files::formats::value::{counted, grouped, percent};

use crate::tui::app::{
    App, Canvas, Endpoint, Flow, Message, Page, Place, Placed, Wheel, begin_drawn, refuse,
};
use crate::tui::grid::draw_thumbnail;
use crate::tui::keys::Context;
use crate::tui::recognise::RecogniseMessage;
use crate::tui::recognise::trained::{TrainedModel, onto};
use crate::tui::widget::write::{self, narrow};
use crate::tui::widget::{Role, Theme};

const CELL: u16 = 7;
const NAME: usize = 12;
const PICTURE: u16 = 18;
/// The lines above and below the matrix.
const HEAD: u16 = 3;
const FOOT: u16 = 2;

pub(crate) struct Confusion {
    trained: Arc<TrainedModel>,
    /// The cell under the cursor: the touching shape, the named shape.
    cell: (usize, usize),
}

impl Confusion {
    pub(super) fn new(trained: Arc<TrainedModel>) -> Self {
        let cell = worst_cell(&trained.evaluation);
        Self { trained, cell }
    }

    fn count(&self) -> usize {
        self.trained.model.shapes().len()
    }

    /// Returns the imprint, cut to its box unless nothing is active, and the shapes that leave it.
    fn example(&self) -> Option<(Option<Imprint>, &[ShapeCount])> {
        let &(_, key) = self.trained.examples.get(&self.cell)?;
        let model = &self.trained.model;
        Some((model.keys().imprint(key), model.counts(key)))
    }

    fn take(&mut self, message: &Message) {
        let (row, column) = self.cell;
        let (row, column) = match *message {
            Message::Cursor(arrow) => {
                let (right, down) = arrow.step();
                let step = |at: usize, by: i8| at.saturating_add_signed(by.into());
                (step(row, down), step(column, right))
            }
            Message::Scroll(lines) => (row.saturating_add_signed(lines.into()), column),
            Message::ScrollTo(Endpoint::First) => (0, 0),
            Message::ScrollTo(Endpoint::Last) => (usize::MAX, usize::MAX),
            Message::Recognise(RecogniseMessage::SelectCell(row, column)) => (row, column),
            _ => return,
        };
        let last = self.count() - 1;
        self.cell = (row.min(last), column.min(last));
    }
}

/// The places of the matrix; the cell under the cursor is always among the visible ones.
struct Panes {
    rows: Rect,
    label: u16,
    first: (usize, usize),
    columns: usize,
    /// Beside the matrix, unless that would leave too few columns.
    picture: Option<Rect>,
}

impl Panes {
    fn of(area: Rect, page: &Confusion) -> Self {
        let count = page.count();
        let names = (0..count).map(|shape| write::width(page.trained.name(shape)));
        let name = names.fold(0, usize::max).min(NAME);
        let label = narrow(count.to_string().len() + 1 + name + 1);
        let beside = area.width.saturating_sub(label);
        let all = narrow(count).saturating_mul(CELL).saturating_add(PICTURE);
        let has_picture = all <= beside || beside >= PICTURE + 6 * CELL;
        let room = beside - if has_picture { PICTURE } else { 0 };
        let columns = usize::from(room / CELL).clamp(1, count);
        let mut rows = write::below(area, HEAD);
        rows.height = rows.height.saturating_sub(FOOT);
        let x = area.x + label + narrow(columns) * CELL + 2;
        Self {
            rows,
            label,
            first: (
                write::first_of(rows.height, count, page.cell.0),
                write::first_of(narrow(columns), count, page.cell.1),
            ),
            columns,
            picture: has_picture.then(|| write::right_of(rows, x)),
        }
    }

    /// The visible columns with their places in a row.
    fn cells(&self, row: Rect, count: usize) -> impl Iterator<Item = (usize, Rect)> {
        let (first, start) = (self.first.1, row.x + self.label);
        let columns = first..(first + self.columns).min(count);
        columns.map(move |column| {
            let x = start + narrow(column - first) * CELL;
            (column, write::left_of(write::right_of(row, x), x + CELL))
        })
    }
}

impl Page for Confusion {
    /// Enter puts the imprint of the cell onto the matrix and closes the page.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        if *message == Message::Accept {
            if let Some((Some(imprint), _)) = self.example() {
                let (user, own) = (app.history.present().sensor, *self.trained.model.sensor());
                let (sensor, imprint) = onto(&imprint, user, own);
                let [touched, named] =
                    [self.cell.0, self.cell.1].map(|shape| self.trained.name(shape));
                let what = format!("imprint of {touched}, named {named}");
                begin_drawn(app, sensor, &imprint, &what);
                return Flow::Close;
            }
            refuse(app, "there is no imprint in this cell");
        }
        self.take(message);
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Confusion, Place::Screen, Wheel::Rows)
    }

    /// Returns the position of the cursor.
    fn draw(&self, mut canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let (panes, count) = (Panes::of(area, self), self.count());
        let (trained, confusion) = (&self.trained, &self.trained.evaluation.confusion);
        let title = format!("Confusion: {}", trained.choice);
        let limit = format!("  limit: error {}", percent(trained.evaluation.error()));
        canvas.line(area, [(&*title, Role::Title), (&*limit, Role::Text)]);
        let meaning = "rows: the shape that touches; columns: its name; percent of the row";
        canvas.text(write::row(area, 1), meaning, Role::Quiet);
        let head = write::row(area, 2);
        let corner = write::left_of(head, area.x + panes.label - 1);
        let hidden = hidden(canvas.theme, &panes, count);
        canvas.text(corner, &hidden, Role::Quiet);
        for (column, place) in panes.cells(head, count) {
            let number = format!("{:>5} ", column + 1);
            canvas.text(place, &number, Role::Title);
        }
        let (digits, mut cursor) = (count.to_string().len(), None);
        for (row, line) in (panes.first.0..count).zip(panes.rows.rows()) {
            let number = format!("{:>digits$} ", row + 1);
            let pieces = [(&*number, Role::Title), (trained.name(row), Role::Text)];
            let label = write::left_of(line, line.x + panes.label - 1);
            canvas.line(label, pieces);
            let touches = confusion.touches_of(row);
            for (column, place) in panes.cells(line, count) {
                let named = confusion.get(row, column);
                let text = cell_text(canvas.theme, named, touches, row == column);
                let is_here = (row, column) == self.cell;
                let role = match (is_here, row == column, named) {
                    (true, ..) => Role::Focus,
                    (_, true, _) => Role::Key,
                    (_, _, 0) => Role::Quiet,
                    _ => Role::Text,
                };
                canvas.text(place, &text, role);
                cursor = cursor.or(is_here.then_some(place.as_position()));
            }
        }
        self.draw_detail(&mut canvas, &panes, area);
        cursor
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let panes = Panes::of(area, self);
        let (row, line) = (panes.first.0..self.count())
            .zip(panes.rows.rows())
            .find(|(_, line)| line.contains(at))?;
        let mut cells = panes.cells(line, self.count());
        let (column, _) = cells.find(|(_, place)| place.contains(at))?;
        let cell = RecogniseMessage::SelectCell(row, column);
        Some(Message::Recognise(cell))
    }
}

impl Confusion {
    fn draw_detail(&self, canvas: &mut Canvas<'_>, panes: &Panes, area: Rect) {
        let (row, column) = self.cell;
        let (trained, confusion) = (&self.trained, &self.trained.evaluation.confusion);
        let text = format!(
            "{} named {}: {} of {}",
            trained.name(row),
            trained.name(column),
            grouped(confusion.get(row, column)),
            counted(confusion.touches_of(row), "touch"),
        );
        let foot = write::below(area, area.height.saturating_sub(FOOT));
        canvas.text(foot, &text, Role::Text);
        let Some((imprint, counts)) = self.example() else {
            return;
        };
        let text = in_words(counts, self.cell, |shape| trained.name(shape));
        canvas.text(write::row(foot, 1), &text, Role::Text);
        if let (Some(area), Some(imprint)) = (panes.picture, &imprint) {
            draw_thumbnail(canvas.theme, imprint, canvas.buffer, area);
        }
    }
}

/// Says how many rows and columns are hidden on each side: `↑3 ↓12 →4`.
fn hidden(theme: &Theme, panes: &Panes, count: usize) -> String {
    let (row, column) = panes.first;
    let after = |end: usize| count.saturating_sub(end);
    let below = after(row + usize::from(panes.rows.height));
    let hidden = [row, below, column, after(column + panes.columns)];
    let hidden = theme.more().into_iter().zip(hidden);
    let hidden = hidden.filter(|&(_, count)| count > 0);
    let hidden = hidden.map(|(sign, count)| format!("{sign}{count}"));
    hidden.collect::<Vec<_>>().join(" ")
}

/// Returns the text of a cell: percent of its row, in brackets on the diagonal; a dot for none.
fn cell_text(theme: &Theme, count: u128, touches: u128, diagonal: bool) -> String {
    let percent = percent(share(count, touches));
    let number = match count {
        0 if theme.ascii => ".",
        0 => "·",
        _ => percent.trim_end_matches(" %"),
    };
    if diagonal {
        format!("{:>7}", format!("[{number}]"))
    } else {
        format!("{number:>6} ")
    }
}

/// For each cell of the confusion matrix the number of poses of an example, and the index of its imprint in the model.
pub(super) type Examples = BTreeMap<(usize, usize), (u64, usize)>;

/// Of the imprints that one shape leaves and that are named as another, an example is the one that the first shape
/// leaves in the most poses. All are found in advance: a model may have millions of imprints, and no key must wait for
/// them.
pub(super) fn examples(model: &Model) -> Examples {
    let mut cells = Examples::new();
    for key in 0..model.keys().len() {
        let (named, _) = model.most_frequent(key);
        for own in model.counts(key) {
            let cell = cells.entry((own.shape.into(), named)).or_insert((0, 0));
            if own.poses > cell.0 {
                *cell = (own.poses, key);
            }
        }
    }
    cells
}

/// Says which shapes leave an imprint, and in how many poses. The two shapes of its cell come first: there may be no
/// room for all.
fn in_words<'a>(
    counts: &[ShapeCount],
    cell: (usize, usize),
    name: impl Fn(usize) -> &'a str,
) -> String {
    let counts = counts.iter().map(|own| (usize::from(own.shape), own.poses));
    let mut counts: Vec<(usize, u64)> = counts.collect();
    counts.sort_by_key(|&(shape, _)| (shape != cell.0, shape != cell.1));
    let leaves = counts.into_iter();
    let leaves =
        leaves.map(|(shape, poses)| format!("{} in {}", name(shape), counted(poses, "pose")));
    let leaves = leaves.collect::<Vec<_>>().join(", ");
    format!("an imprint left by {leaves}")
}

/// Returns the cell beside the diagonal with the most touches, the first of several.
fn worst_cell(evaluation: &Evaluation) -> (usize, usize) {
    let cells = evaluation.confusion.cells();
    let wrong = cells.filter(|(row, column, _)| row != column);
    let worst = wrong.rev().max_by_key(|&(_, _, touches)| touches);
    worst.map_or((0, 0), |(row, column, _)| (row, column))
}

#[cfg(test)]
mod tests {
    use taxel_core::figure::Figure;
    use taxel_core::pose::{Anchor, Axis, Ranges};
    use taxel_core::recognition::{NamedShape, Training};
    use taxel_core::sensor::Sensor;

    use super::*;

    #[test]
    fn the_example_of_a_cell_is_the_most_frequent_imprint_that_is_named_so() {
        let sensor = Sensor::default();
        let shape = |name: &str, length: f64| {
            let bar = Figure::rectangle(length, 2.0).on(&sensor);
            NamedShape::new(name, bar.expect("in range"))
        };
        let shapes = [shape("a", 4.0), shape("b", 4.2), shape("c", 4.4)];
        let ranges = Ranges::default().with(Axis::Angle, "0:80:10".parse().expect("a range"));
        let training = Training::new(shapes, sensor, Anchor::Centre, ranges).expect("a set");
        let model = training.run().expect("not stopped");
        let (examples, evaluation) = (examples(&model), Evaluation::of(&model));
        for cell in (0..9).map(|cell| (cell / 3, cell % 3)) {
            let (touched, named) = cell;
            let poses = |counts: &[ShapeCount]| {
                let mut own = counts.iter();
                let own = own.find(|count| usize::from(count.shape) == touched);
                own.map(|own| own.poses)
            };
            let keys = 0..model.keys().len();
            let keys = keys.filter(|&key| model.most_frequent(key).0 == named);
            let most = keys.filter_map(|key| poses(model.counts(key)));
            let example = examples.get(&cell).map(|&(_, key)| model.counts(key));
            let found = example.and_then(poses);
            assert_eq!(found, most.max(), "{cell:?}");
            let touches = evaluation.confusion.get(touched, named);
            assert_eq!(example.is_some(), touches > 0, "{cell:?}");
            let names = ["a", "b", "c"];
            let text = example.map(|counts| in_words(counts, cell, |shape| names[shape]));
            let first = format!("an imprint left by {} in ", names[touched]);
            assert!(text.is_none_or(|text| text.starts_with(&first)), "{cell:?}");
        }
    }
}
