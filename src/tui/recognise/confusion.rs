//! The confusion matrix of a model: how often the best classifier takes a touch of one shape for another, and an
//! example imprint for the cell under the cursor.

use std::collections::BTreeMap;
use std::sync::Arc;

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::share;
use taxel_core::recognition::{Evaluation, Model, ShapeCount};
use taxel_core::sensor::Sensor;
use taxel_files::formats::value::{counted, grouped, percent};

use crate::tui::app::message::{Endpoint, Message};
use crate::tui::app::page::{Flow, Page, Slot, Wheel};
use crate::tui::app::state::App;
use crate::tui::grid::draw_thumbnail;
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::recognise::state::RecogniseMessage;
use crate::tui::recognise::trained::{TrainedModel, onto};
use crate::tui::recognise::update::in_confusion;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};

#[derive(Clone, Debug)]
pub struct Confusion {
    trained: Arc<TrainedModel>,
    /// The cell under the cursor: the touching shape, the named shape.
    cell: (usize, usize),
    /// An example imprint of that cell; None if there is none.
    example: Option<Example>,
}

const CELL: u16 = 7;

const NAME: usize = 12;

impl Confusion {
    pub fn new(trained: Arc<TrainedModel>) -> Self {
        let worst = worst_cell(&trained.evaluation);
        let mut page = Self {
            trained,
            cell: (0, 0),
            example: None,
        };
        page.go_to(worst.unwrap_or((0, 0)));
        page
    }

    fn count(&self) -> usize {
        self.trained.model.shapes().len()
    }

    /// Returns the imprint of the cell, on the user's sensor if it fits there, otherwise on the model's sensor; and
    /// that sensor. None if the cell has no imprint.
    pub fn imprint_on(&self, sensor: Sensor) -> Option<(Sensor, Imprint)> {
        let imprint = self.example.as_ref()?.imprint?;
        Some(onto(&imprint, sensor, *self.trained.model.sensor()))
    }

    /// Says what the imprint of the cell is: "imprint of cross, named saltire".
    pub fn of_cell(&self) -> String {
        let [touched, named] = [self.cell.0, self.cell.1].map(|shape| self.trained.name(shape));
        format!("imprint of {touched}, named {named}")
    }

    fn go_to(&mut self, (row, column): (usize, usize)) {
        let last = self.count() - 1;
        self.cell = (row.min(last), column.min(last));
        self.example = (self.trained.examples).get(&self.trained.model, self.cell);
    }

    pub fn take(&mut self, message: &Message) {
        let (row, column) = self.cell;
        let cell = match *message {
            Message::Cursor(Arrow::Left) => (row, column.saturating_sub(1)),
            Message::Cursor(Arrow::Right) => (row, column + 1),
            Message::Cursor(Arrow::Up) => (row.saturating_sub(1), column),
            Message::Cursor(Arrow::Down) => (row + 1, column),
            Message::Scroll(lines) => (row.saturating_add_signed(isize::from(lines)), column),
            Message::ScrollTo(Endpoint::First) => (0, 0),
            Message::ScrollTo(Endpoint::Last) => (usize::MAX, usize::MAX),
            Message::Recognise(RecogniseMessage::SelectCell(row, column)) => (row, column),
            _ => return,
        };
        self.go_to(cell);
    }
}

struct ConfusionPanes {
    head: Rect,
    rows: Rect,
    label: u16,
    first: (usize, usize),
    columns: usize,
    detail: Rect,
    /// The example imprint of that cell; None if there is no room beside the matrix.
    picture: Option<Rect>,
}

const DETAIL: u16 = 2;

impl ConfusionPanes {
    /// Divides the page; the cell under the cursor is always among the visible ones.
    fn of(area: Rect, page: &Confusion) -> Self {
        let count = page.count();
        let names = (0..count).map(|shape| write::width(page.trained.name(shape)));
        let name = names.fold(0, usize::max).min(NAME);
        let label = narrow(count.to_string().len() + 1 + name + 1);
        let beside = area.width.saturating_sub(label);
        let all = narrow(count).saturating_mul(CELL);
        // An imprint stands beside the matrix, unless that would leave too few columns.
        let picture = 18;
        let with_picture = all.saturating_add(picture) <= beside || beside >= picture + 6 * CELL;
        let room = if with_picture {
            beside - picture
        } else {
            beside
        };
        let columns = usize::from(room / CELL).clamp(1, count.max(1));
        let rows = write::below(area, 3);
        let rows = Rect {
            height: rows.height.saturating_sub(DETAIL),
            ..rows
        };
        let (row, column) = page.cell;
        let x = area.x + label + narrow(columns).saturating_mul(CELL) + 2;
        Self {
            head: write::row(area, 2),
            rows,
            label,
            first: (
                write::first_of(rows.height, count, row),
                write::first_of(narrow(columns), count, column),
            ),
            columns,
            detail: write::below(area, area.height.saturating_sub(DETAIL)),
            picture: with_picture.then(|| write::right_of(rows, x)),
        }
    }

    fn cell(&self, row: Rect, index: usize) -> Rect {
        let x = row.x + self.label + narrow(index).saturating_mul(CELL);
        let cell = write::right_of(row, x);
        Rect {
            width: cell.width.min(CELL),
            ..cell
        }
    }
}

impl Page for Confusion {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        in_confusion(self, app, message)
    }

    fn context(&self) -> Context {
        Context::Confusion
    }

    fn slot(&self) -> Slot {
        Slot::Screen
    }

    fn draw(
        &self,
        theme: &Theme,
        _keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let panes = ConfusionPanes::of(area, self);
        let evaluation = &self.trained.evaluation;
        let title = format!("Confusion: {}", self.trained.choice);
        let error = percent(evaluation.error());
        let limit = format!("  limit: error {error}");
        let shorter = format!("  error {error}");
        let room = usize::from(area.width).saturating_sub(write::width(&title));
        let limit = write::first_fitting(&[&limit, &shorter], room);
        let pieces = [(title.as_str(), Role::Title), (limit, Role::Text)];
        write::line(buffer, area, theme, pieces);
        let hidden = self.hidden(&panes);
        let (meaning, in_words) = meaning(hidden, area.width.into());
        write::text(buffer, write::row(area, 1), theme, &meaning, Role::Quiet);
        let corner = Rect {
            width: panes.label.saturating_sub(1).min(panes.head.width),
            ..panes.head
        };
        if !in_words {
            write::text(
                buffer,
                corner,
                theme,
                &in_arrows(theme, hidden),
                Role::Quiet,
            );
        }
        self.draw_head(theme, &panes, buffer);
        let rows = (panes.first.0..self.count()).take(panes.rows.height.into());
        let mut cursor = None;
        for (index, row) in rows.enumerate() {
            let line = write::row(panes.rows, index);
            cursor = self.draw_row(theme, &panes, row, buffer, line).or(cursor);
        }
        self.draw_detail(theme, &panes, buffer);
        cursor
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let panes = ConfusionPanes::of(area, self);
        if !panes.rows.contains(at) {
            return None;
        }
        let row = panes.first.0 + usize::from(at.y - panes.rows.y);
        let across = at.x.checked_sub(panes.rows.x + panes.label)? / CELL;
        let column = panes.first.1 + usize::from(across);
        let inside =
            row < self.count() && column < self.count() && usize::from(across) < panes.columns;
        inside.then_some(Message::Recognise(RecogniseMessage::SelectCell(
            row, column,
        )))
    }

    fn wheel(&self) -> Wheel {
        Wheel::Rows
    }
}

impl Confusion {
    fn hidden(&self, panes: &ConfusionPanes) -> [usize; 4] {
        let (row, column) = panes.first;
        let after = |end: usize| self.count().saturating_sub(end);
        let below = after(row + usize::from(panes.rows.height));
        [row, below, column, after(column + panes.columns)]
    }

    fn draw_head(&self, theme: &Theme, panes: &ConfusionPanes, buffer: &mut Buffer) {
        let column = panes.first.1;
        let last = column + panes.columns;
        for (index, column) in (column..last.min(self.count())).enumerate() {
            let number = format!("{:>5} ", column + 1);
            let place = panes.cell(panes.head, index);
            write::text(buffer, place, theme, &number, Role::Title);
        }
    }

    /// Draws a row: its number and name, and its cells. Returns the position of the cursor if it is in this row.
    fn draw_row(
        &self,
        theme: &Theme,
        panes: &ConfusionPanes,
        row: usize,
        buffer: &mut Buffer,
        line: Rect,
    ) -> Option<Position> {
        let digits = self.count().to_string().len();
        let number = format!("{:>digits$} ", row + 1);
        let name = Rect {
            width: panes.label.saturating_sub(1).min(line.width),
            ..line
        };
        let pieces = [
            (number.as_str(), Role::Title),
            (self.trained.name(row), Role::Text),
        ];
        write::line(buffer, name, theme, pieces);
        let touches = self.trained.evaluation.confusion.touches_of(row);
        let mut cursor = None;
        let last = panes.first.1 + panes.columns;
        for (index, column) in (panes.first.1..last.min(self.count())).enumerate() {
            let place = panes.cell(line, index);
            let count = self.trained.evaluation.confusion.get(row, column);
            let text = cell_text(theme, count, touches, row == column);
            let here = (row, column) == self.cell;
            let role = match (here, row == column, count) {
                (true, ..) => Role::Focus,
                (_, true, _) => Role::Key,
                (_, _, 0) => Role::Quiet,
                _ => Role::Text,
            };
            write::text(buffer, place, theme, &text, role);
            if here {
                cursor = Some(Position::new(place.x, place.y));
            }
        }
        cursor
    }

    fn draw_detail(&self, theme: &Theme, panes: &ConfusionPanes, buffer: &mut Buffer) {
        let (row, column) = self.cell;
        let confusion = &self.trained.evaluation.confusion;
        let text = format!(
            "{} named {}: {} of {}",
            self.trained.name(row),
            self.trained.name(column),
            grouped(confusion.get(row, column)),
            counted(confusion.touches_of(row), "touch"),
        );
        write::text(buffer, panes.detail, theme, &text, Role::Text);
        let Some(example) = &self.example else { return };
        let text = example.in_words(self.cell, |shape| self.trained.name(shape));
        write::text(
            buffer,
            write::row(panes.detail, 1),
            theme,
            &text,
            Role::Text,
        );
        if let (Some(area), Some(imprint)) = (panes.picture, &example.imprint) {
            draw_thumbnail(theme, imprint, buffer, area);
        }
    }
}

/// Returns the line that says what rows and columns are and how many are hidden, in at most `room` columns; and false
/// if there is no room for the second part.
fn meaning(hidden: [usize; 4], room: usize) -> (String, bool) {
    let meanings = [
        "rows: the shape that touches; columns: its name; percent of the row",
        "rows: what touches; columns: its name; % of the row",
        "rows: true shape; columns: name given; %",
        "rows: true; columns: named; %",
    ];
    let hidden = in_words(hidden);
    let whole = meanings.map(|meaning| match hidden.as_str() {
        "" => meaning.to_owned(),
        hidden => format!("{meaning}  {hidden}"),
    });
    match whole.into_iter().find(|text| write::width(text) <= room) {
        Some(whole) => (whole, true),
        None => (write::first_fitting(&meanings, room).to_owned(), false),
    }
}

/// Says how many rows and columns are hidden on each side: `3 rows above, 12 below; 4 columns right`. Empty if none are.
fn in_words([above, below, left, right]: [usize; 4]) -> String {
    let along = |noun: &str, sides: [(usize, &str); 2]| {
        let sides = sides.into_iter().filter(|&(count, _)| count > 0);
        let sides = sides.enumerate().map(|(index, (count, side))| {
            let count = match index {
                0 => counted(count as u64, noun),
                _ => count.to_string(),
            };
            format!("{count} {side}")
        });
        let sides: Vec<String> = sides.collect();
        (!sides.is_empty()).then(|| sides.join(", "))
    };
    let rows = along("row", [(above, "above"), (below, "below")]);
    let columns = along("column", [(left, "left"), (right, "right")]);
    let both: Vec<String> = [rows, columns].into_iter().flatten().collect();
    both.join("; ")
}

/// Says the same with arrows: `↑3 ↓12 →4`.
fn in_arrows(theme: &Theme, hidden: [usize; 4]) -> String {
    let hidden = theme.more().into_iter().zip(hidden);
    let hidden = hidden.filter(|&(_, count)| count > 0);
    let hidden: Vec<String> = hidden
        .map(|(sign, count)| format!("{sign}{count}"))
        .collect();
    hidden.join(" ")
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

#[derive(Clone, Debug, PartialEq)]
pub struct Example {
    /// The imprint, cut to its box; None for a touch that leaves nothing.
    pub imprint: Option<Imprint>,
    counts: Vec<ShapeCount>,
}

/// An example imprint for each cell of the confusion matrix. All are found in advance: a model may have millions of
/// imprints, and no key must wait for them.
#[derive(Clone, Debug)]
pub struct Examples {
    /// For each cell, given by the touching shape and the named shape: the number of poses in which the first leaves
    /// the example, and the index of that imprint in the model.
    cells: BTreeMap<(usize, usize), (u64, usize)>,
}

impl Examples {
    /// Finds the examples of a model: of the imprints that one shape leaves and that are named as another, the one
    /// that the first shape leaves in the most poses; the first of several.
    pub fn of(model: &Model) -> Self {
        let mut cells = BTreeMap::new();
        for key in 0..model.keys().len() {
            let counts = model.counts(key);
            let (named, _) = model.most_frequent(key);
            for own in counts {
                let cell = cells.entry((own.shape.into(), named)).or_insert((0, 0));
                if own.poses > cell.0 {
                    *cell = (own.poses, key);
                }
            }
        }
        Self { cells }
    }

    /// Returns the example of a cell of the same model; None if there is none.
    pub fn get(&self, model: &Model, cell: (usize, usize)) -> Option<Example> {
        let &(_, key) = self.cells.get(&cell)?;
        Some(Example {
            imprint: model.keys().imprint(key),
            counts: model.counts(key).to_vec(),
        })
    }
}

impl Example {
    /// Describes which shapes leave the imprint, and in how many poses. The two shapes of its cell come first: there may
    /// be no room for all.
    pub fn in_words<'a>(&self, cell: (usize, usize), name: impl Fn(usize) -> &'a str) -> String {
        let mut counts = self.counts.clone();
        counts.sort_by_key(|own| match usize::from(own.shape) {
            shape if shape == cell.0 => 0,
            shape if shape == cell.1 => 1,
            _ => 2,
        });
        let leaves = counts.iter().map(|own| {
            let name = name(own.shape.into());
            format!("{name} in {}", counted(own.poses, "pose"))
        });
        let leaves: Vec<String> = leaves.collect();
        format!("an imprint left by {}", leaves.join(", "))
    }
}

/// Returns the cell beside the diagonal with the most touches, the first of several: the touching shape and the named
/// shape. None for a single shape.
pub fn worst_cell(evaluation: &Evaluation) -> Option<(usize, usize)> {
    let cells = evaluation.confusion.cells();
    let wrong = cells.filter(|(row, column, _)| row != column);
    let most = wrong.rev().max_by_key(|&(_, _, touches)| touches);
    let first = (evaluation.confusion.shapes() > 1).then_some((0, 1));
    most.map(|(row, column, _)| (row, column)).or(first)
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
        let examples = Examples::of(&model);
        let evaluation = Evaluation::of(&model);
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
            let example = examples.get(&model, cell);
            let found = example.as_ref().and_then(|own| poses(&own.counts));
            assert_eq!(found, most.max(), "{cell:?}");
            let touches = evaluation.confusion.get(touched, named);
            assert_eq!(example.is_some(), touches > 0, "{cell:?}");
            if let Some(example) = example {
                let text = example.in_words(cell, |shape| ["a", "b", "c"][shape]);
                let shapes = text.trim_start_matches("an imprint left by ").split(", ");
                let shapes: Vec<&str> = shapes.filter_map(|own| own.get(..1)).collect();
                let (touching, naming) = (["a", "b", "c"][touched], ["a", "b", "c"][named]);
                let mut pair = vec![touching, naming];
                pair.dedup();
                assert!(shapes.starts_with(&pair), "{text}");
            }
        }
        assert_eq!(examples.get(&model, (3, 0)), None);
    }
}
