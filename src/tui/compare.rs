//! Two imprints over each other: where they differ, their descriptors, and the differences between these.
//!
//! ```text
//! 5 taxels differ   a: washer   b: the matrix        how many taxels differ | what is compared, the earlier one first
//!    0   2   4   6       a   b   b-a
//!  0 · · a █ b ·    NA   40  52  +12                 █ in both, a b in one only | descriptors of the main regions
//! ```
//! If there is no room for the descriptors beside the imprints, Tab shows one or the other. Parts that do not fit
//! scroll.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::description::{
    DESCRIPTORS, Description, Descriptor, Dimension, Value, main_region, regions,
};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::differing;
use taxel_files::formats::value;

use crate::tui::app::{App, Canvas, Endpoint, Flow, Message, Page, Place, Placed, Wheel, refuse};
use crate::tui::grid::{CellSize, Grid, Look, RULER, Window, beside_rulers};
use crate::tui::keys::{Arrow, Context};
use crate::tui::widget::write::{self, narrow};
use crate::tui::widget::{Role, Theme, spelling};

const GAP: u16 = 2;
const LONGEST: usize = 24;

pub(crate) struct Comparison {
    imprints: Box<[Imprint; 2]>,
    names: [String; 2],
    table: Vec<[String; 4]>,
    /// Whether the descriptors are shown, not the imprints, where there is no room for both.
    shows_table: bool,
    /// The columns and rows that are scrolled over.
    scrolled: (u16, u16),
}

impl Comparison {
    /// If one has fewer columns or rows, the missing taxels count as inactive.
    pub(crate) fn new(first: (String, &Imprint), second: (String, &Imprint)) -> Self {
        let size = first.1.size().union(second.1.size());
        let imprints = [first.1, second.1].map(|imprint| imprint.resized(size));
        Self {
            table: table(&imprints),
            imprints: Box::new(imprints),
            names: [first.0, second.0],
            shows_table: false,
            scrolled: (0, 0),
        }
    }

    /// The width of the imprints with this many characters a taxel.
    fn width(&self, characters: u16) -> u16 {
        RULER + characters * u16::from(self.imprints[0].columns()) + 1
    }

    /// The widths of the columns of descriptors: those in ASCII, as the layout must not depend on the terminal.
    fn widths(&self) -> [u16; 4] {
        let width = |text: &str| {
            let widths = text.chars().map(|sign| spelling(sign).map_or(1, str::len));
            narrow(widths.sum::<usize>()) + GAP
        };
        let widest = |column: usize| self.table.iter().map(|row| width(&row[column])).max();
        std::array::from_fn(|column| widest(column).unwrap_or(0))
    }

    /// Whether the values of the descriptors have room beside the imprints.
    fn has_both(&self, width: u16) -> bool {
        let values: u16 = self.widths()[..3].iter().sum();
        self.width(1) + values <= width + GAP
    }

    fn panes(&self, area: Rect) -> (Option<Rect>, Option<Rect>) {
        let body = write::below(area, 1);
        if !self.has_both(body.width) {
            let imprints = Some(body).filter(|_| !self.shows_table);
            return (imprints, Some(body).filter(|_| self.shows_table));
        }
        let table = self.widths().iter().sum::<u16>() - GAP;
        let room = body.width.saturating_sub(table);
        let end = body.x + self.width(2).min(room.max(self.width(1)));
        let (imprints, table) = (write::left_of(body, end), write::right_of(body, end));
        (Some(imprints), Some(table))
    }

    fn grid(&self, area: Rect) -> Grid {
        let inner = beside_rulers(area);
        let (left, top) = self.scrolled;
        let (columns, rows) = (self.imprints[0].columns(), self.imprints[0].rows());
        let size = if 2 * u16::from(columns) <= inner.width {
            CellSize::Square(1)
        } else {
            CellSize::Narrow
        };
        Grid {
            x: inner.x,
            y: inner.y,
            size,
            columns: Window::after(left, columns, inner.width / size.columns()),
            rows: Window::after(top, rows, inner.height),
        }
    }

    /// The columns and rows that can be scrolled over.
    fn hidden(&self, area: Rect) -> (u16, u16) {
        let [first, _] = &*self.imprints;
        let (imprints, table) = self.panes(area);
        let (columns, rows) = imprints.map_or((0, 0), |place| {
            let grid = self.grid(place);
            (
                first.columns() - grid.columns.count,
                first.rows() - grid.rows.count,
            )
        });
        let lines = table.map_or(0, |area| {
            narrow(self.table.len()).saturating_sub(area.height)
        });
        (columns.into(), lines.max(rows.into()))
    }

    fn draw_imprints(&self, theme: &Theme, buffer: &mut Buffer, area: Rect) {
        let [first, second] = &*self.imprints;
        let grid = self.grid(area);
        grid.draw_rulers(theme, buffer);
        grid.draw(buffer, |column, row| {
            // A letter instead of the shade shows which of the two has it active.
            let (signs, role) = match (first.get(column, row), second.get(column, row)) {
                (true, false) => (['a', 'a'], Role::Key),
                (false, true) => (['b', 'b'], Role::Key),
                (true, true) => (theme.taxel(Role::Chosen), Role::Chosen),
                (false, false) => (theme.taxel(Role::Inactive), Role::Inactive),
            };
            let (fill, style) = (' ', theme.style(role));
            Look { signs, fill, style }
        });
    }

    fn draw_table(&self, theme: &Theme, buffer: &mut Buffer, area: Rect) {
        let most = self.table.len().saturating_sub(area.height.into());
        let top = usize::from(self.scrolled.1).min(most);
        let heading = self.table.iter().take(1);
        let rows = heading.chain(self.table.iter().skip(top + 1));
        for (index, (row, mut place)) in rows.zip(area.rows()).enumerate() {
            for (column, width) in self.widths().into_iter().enumerate() {
                let role = match (index, column, row[1] == row[2]) {
                    (0, ..) => Role::Title,
                    (_, 0, _) => Role::Key,
                    (_, _, true) => Role::Quiet,
                    _ => Role::Text,
                };
                write::text(buffer, place, theme, &row[column], role);
                place = write::right_of(place, place.x + width);
            }
        }
    }
}

/// If nothing is active, counts and sums are 0.
fn table(imprints: &[Imprint; 2]) -> Vec<[String; 4]> {
    let described = imprints.each_ref().map(|imprint| {
        let regions = regions(imprint);
        let main = main_region(&regions).and_then(|main| regions.get(main));
        main.map(Description::of)
    });
    let heading = ["", "a", "b", "b-a"].map(str::to_owned);
    let rows = DESCRIPTORS.iter().map(|descriptor| {
        let values = described.each_ref().map(|described| {
            let described = described.as_ref();
            described.map_or(descriptor.of_nothing, descriptor.measure)
        });
        let [first, second] = values.map(|value| text(descriptor, value));
        let by = if first == second {
            "=".to_owned()
        } else {
            signed(descriptor, difference(descriptor, values[0], values[1]))
        };
        [descriptor.symbol.to_owned(), first, second, by]
    });
    std::iter::once(heading).chain(rows).collect()
}

fn text(descriptor: &Descriptor, measured: Value) -> String {
    let text = value::text(measured, descriptor.dimension);
    text.unwrap_or_else(|| "–".to_owned())
}

fn signed(descriptor: &Descriptor, by: Value) -> String {
    let sign = |number: f64| {
        let text = text(descriptor, Value::Number(number));
        let is_zero = !text.contains(|digit| matches!(digit, '1'..='9'));
        let plus = if number > 0.0 && !is_zero { "+" } else { "" };
        format!("{plus}{text}")
    };
    match by {
        Value::Number(number) => sign(number),
        Value::Point(point) => format!("{}, {}", sign(point.x), sign(point.y)),
        by => text(descriptor, by),
    }
}

/// Values such as rectangles have no difference.
fn difference(descriptor: &Descriptor, first: Value, second: Value) -> Value {
    match (first, second) {
        (Value::Count(first), Value::Count(second)) => {
            Value::Number(f64::from(second) - f64::from(first))
        }
        (Value::Number(first), Value::Number(second)) => {
            Value::Number(match descriptor.dimension {
                Dimension::Direction => 180.0 - (180.0 - (second - first)).rem_euclid(360.0),
                _ => second - first,
            })
        }
        (Value::Point(first), Value::Point(second)) => Value::Point(second - first),
        _ => Value::None,
    }
}

impl Page for Comparison {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let Some(area) = app.panes().map(|panes| panes.area(Place::Screen)) else {
            return Flow::Stay;
        };
        let by = match *message {
            Message::Field(_) => {
                self.shows_table ^= true;
                return Flow::Stay;
            }
            Message::Scroll(lines) => (0, lines),
            Message::ScrollTo(Endpoint::First) => (0, i16::MIN),
            Message::ScrollTo(Endpoint::Last) => (0, i16::MAX),
            Message::Choose(Arrow::Left) => (-1, 0),
            Message::Choose(Arrow::Right) => (1, 0),
            _ => return Flow::Stay,
        };
        let most = self.hidden(area);
        if most == (0, 0) {
            refuse(app, "all of it is visible");
        }
        let moved =
            |now: u16, by: i16, most: u16| now.min(most).saturating_add_signed(by).min(most);
        let (left, top) = self.scrolled;
        self.scrolled = (moved(left, by.0, most.0), moved(top, by.1, most.1));
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::Compare, Place::Screen, Wheel::Rows)
    }

    fn draw(&self, Canvas { theme, buffer, .. }: Canvas<'_>, area: Rect) -> Option<Position> {
        let differ = differing(self.imprints[0].differing(&self.imprints[1]).count());
        let pieces = [
            (&*differ, Role::Title),
            ("   a: ", Role::Key),
            (&self.names[0], Role::Text),
            ("   b: ", Role::Key),
            (&self.names[1], Role::Text),
        ];
        write::line(buffer, area, theme, pieces);
        let (imprints, table) = self.panes(area);
        if let Some(place) = imprints {
            self.draw_imprints(theme, buffer, place);
        }
        if let Some(place) = table {
            self.draw_table(theme, buffer, place);
        }
        None
    }

    fn click(&self, _area: Rect, _at: Position) -> Option<Message> {
        Some(Message::Field(1))
    }

    fn has_use_for(&self, message: &Message, area: Rect) -> bool {
        match message {
            Message::Field(_) => !self.has_both(area.width),
            Message::Scroll(_) | Message::ScrollTo(_) | Message::Choose(_) => {
                self.hidden(area) != (0, 0)
            }
            _ => true,
        }
    }
}

/// Cuts the name of what is compared.
pub(crate) fn heading(what: &str) -> String {
    match what.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &what[..end]),
        None => what.to_owned(),
    }
}
