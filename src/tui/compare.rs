//! Two imprints side by side: where they differ, their descriptors, and the differences of these.
//!
//! ```text
//! on the matrix / washer   differ in 5 taxels        what is compared | how many taxels differ
//!    0   2   4   6            A        B        B-A
//!  0 · · a █ b ·      NA      52       40       -12     █ in both, a b in one only | descriptors of the main regions
//! ```
//! On a wide screen A and B stand beside the view of their differences; elsewhere Tab shows one after the other.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::description::{DESCRIPTORS, Description, Descriptor, Value, main_region, regions};
use crate::formats::value;
use crate::formats::value::counted;
use crate::imprint::Imprint;
use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot};
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::number::{around, narrow};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write;

/// Columns of the symbol of a descriptor.
const SYMBOL: usize = 6;
/// Columns of a value.
const VALUE: usize = 14;
/// Columns of the row ruler.
const RULER: u16 = 3;

/// Columns of the descriptors of both and their differences. The difference of two points is cut where there are no more.
const TABLE: u16 = 7 + 2 * 15 + 7;

/// What the grid shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ComparedView {
    /// Which taxels are active in both, in one, in none.
    Difference,
    /// The first imprint.
    First,
    /// The second one.
    Second,
}

use ComparedView::{Difference, First, Second};

/// The views in the order of Tab.
const VIEWS: [ComparedView; 3] = [Difference, First, Second];

/// Two imprints of one size, and what they are.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Both, brought to one size.
    imprints: Box<[Imprint; 2]>,
    /// What each is, for the headings.
    names: [String; 2],
    /// The main region of each; None where nothing is active.
    described: Box<[Option<Description>; 2]>,
    /// The index of the view that is shown.
    view: usize,
}

impl Comparison {
    /// Compares two imprints, given with what they are. Where one has fewer columns or rows, taxels that it does not have
    /// count as inactive.
    pub fn new(first: (String, &Imprint), second: (String, &Imprint)) -> Self {
        let columns = first.1.columns().max(second.1.columns());
        let rows = first.1.rows().max(second.1.rows());
        let imprints = [first.1, second.1].map(|imprint| imprint.resized(columns, rows));
        let described = imprints.each_ref().map(|imprint| {
            let regions = regions(imprint);
            let main = main_region(&regions).and_then(|main| regions.get(main));
            main.map(Description::of)
        });
        Self {
            imprints: Box::new(imprints),
            names: [first.0, second.0],
            described: Box::new(described),
            view: 0,
        }
    }

    /// Shows the view that comes `by` further on, the first after the last.
    pub fn next_view(&mut self, by: i8) {
        self.view = around(self.view, by, VIEWS.len());
    }

    /// The taxels in which they differ.
    fn differing(&self) -> u32 {
        self.imprints[0].differing(&self.imprints[1]).count()
    }

    /// Draws a view: a heading, the rulers, two characters a taxel, or one where there is no room for two. What does not
    /// fit at all is cut, and the heading says so.
    fn draw_view(&self, view: ComparedView, theme: &Theme, buffer: &mut Buffer, area: Rect) {
        let [first, second] = &*self.imprints;
        let (columns, rows) = (first.columns(), first.rows());
        let room = area.width.saturating_sub(RULER);
        let cell = if u16::from(columns) * 2 <= room { 2 } else { 1 };
        let (wide, high) = (
            (room / cell).min(columns.into()),
            area.height.saturating_sub(2).min(rows.into()),
        );
        let title = match view {
            Difference => "a: only A, b: only B",
            First => "A",
            Second => "B",
        };
        let cut = wide < columns.into() || high < rows.into();
        let title = format!("{title}{}", if cut { " (cut)" } else { "" });
        write::line(buffer, area, theme, [(title.as_str(), Role::Title)]);
        let every = if cell == 1 { 5 } else { 2 };
        let numbers = (0..wide)
            .step_by(every)
            .map(|column| (column, column.to_string()));
        // One that does not fit would touch the descriptors.
        for (column, number) in
            numbers.filter(|(column, number)| column * cell + narrow(number.len()) <= wide * cell)
        {
            let place = write::right_of(write::row(area, 1), area.x + RULER + column * cell);
            write::line(buffer, place, theme, [(number.as_str(), Role::Quiet)]);
        }
        for row in 0..high {
            let line = write::row(area, usize::from(row) + 2);
            let ruler = format!("{row:>2}");
            write::line(buffer, line, theme, [(ruler.as_str(), Role::Quiet)]);
            for column in 0..wide {
                let at = |imprint: &Imprint| {
                    let (column, row) = (u8::try_from(column), u8::try_from(row));
                    matches!((column, row), (Ok(column), Ok(row)) if imprint.get(column, row))
                };
                let (signs, role) = signs(theme, view, (at(first), at(second)));
                let x = line.x + RULER + column * cell;
                for (offset, sign) in (0..cell).zip(signs) {
                    if let Some(target) = buffer.cell_mut(Position::new(x + offset, line.y)) {
                        target.set_char(sign).set_style(theme.style(role));
                    }
                }
            }
        }
    }

    /// Draws the descriptors of both and their differences.
    fn draw_table(&self, theme: &Theme, buffer: &mut Buffer, area: Rect) {
        let head = format!("{:SYMBOL$} {:VALUE$} {:VALUE$} B-A", "", "A", "B");
        write::line(buffer, area, theme, [(head.as_str(), Role::Title)]);
        for (index, descriptor) in DESCRIPTORS.iter().enumerate() {
            let values = self.described.each_ref().map(|described| {
                described
                    .as_ref()
                    .map_or(Value::None, |description| (descriptor.measure)(description))
            });
            let [first, second] = values.map(|value| text(theme, descriptor, value));
            let by = difference(values[0], values[1]);
            let sign = if matches!(by, Some(Value::Number(by)) if by > 0.0) {
                "+"
            } else {
                ""
            };
            let by = by.map_or(theme.none().to_owned(), |by| {
                format!("{sign}{}", text(theme, descriptor, by))
            });
            let symbol = format!("{:SYMBOL$} ", descriptor.symbol);
            // A long first value moves the second one, but not the difference.
            let both = format!("{first:VALUE$} {second}");
            let both = format!("{both:0$} ", 2 * VALUE + 1);
            let role = if first == second {
                Role::Quiet
            } else {
                Role::Text
            };
            let by = if first == second { "=" } else { by.as_str() };
            let pieces = [
                (symbol.as_str(), Role::Key),
                (both.as_str(), role),
                (by, role),
            ];
            write::line(buffer, write::row(area, index + 1), theme, pieces);
        }
    }
}

/// The characters of a taxel in a view, and their role. A letter beside the shade says which of the two is active.
fn signs(theme: &Theme, view: ComparedView, active: (bool, bool)) -> ([char; 2], Role) {
    let role = |on: bool| if on { Role::Chosen } else { Role::Inactive };
    match (view, active) {
        (Difference, (true, false)) => (['a', 'a'], Role::Key),
        (Difference, (false, true)) => (['b', 'b'], Role::Key),
        (First | Difference, (on, _)) | (Second, (_, on)) => (theme.taxel(role(on)), role(on)),
    }
}

/// A value in the characters that the terminal has.
fn text(theme: &Theme, descriptor: &Descriptor, measured: Value) -> String {
    let text = value::text(measured, descriptor.dimension);
    text.map_or(theme.none().to_owned(), |text| {
        theme.text(&text).into_owned()
    })
}

/// The second value less the first, None for values that have no difference.
fn difference(first: Value, second: Value) -> Option<Value> {
    match (first, second) {
        (Value::Count(first), Value::Count(second)) => {
            Some(Value::Number(f64::from(second) - f64::from(first)))
        }
        (Value::Number(first), Value::Number(second)) => Some(Value::Number(second - first)),
        (Value::Point(first), Value::Point(second)) => Some(Value::Point(second - first)),
        _ => None,
    }
}

impl Page for Comparison {
    fn context(&self) -> Context {
        Context::Compare
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
        write::clear(buffer, area);
        let [first, second] = &self.names;
        let differ = match self.differing() {
            0 => "   they are alike".to_owned(),
            count => format!("   they differ in {}", counted(count, "taxel")),
        };
        let pieces = [
            ("A: ", Role::Key),
            (first.as_str(), Role::Text),
            ("   B: ", Role::Key),
            (second.as_str(), Role::Text),
            (differ.as_str(), Role::Title),
        ];
        write::line(buffer, area, theme, pieces);
        let body = write::below(area, 1);
        let columns = u16::from(self.imprints[0].columns());
        let grid = RULER + 2 * columns + 1;
        let all = 3 * grid + TABLE <= body.width;
        let views: &[ComparedView] = if all {
            &VIEWS
        } else {
            VIEWS.get(self.view..=self.view)?
        };
        // The descriptors keep their room where taxels of one character leave it.
        let table = TABLE.min(body.width.saturating_sub(RULER + columns + 1));
        let table = if table >= TABLE / 2 { table } else { 0 };
        let room = body.width - table;
        let mut x = body.x;
        for &view in views {
            let width = grid.min((body.x + room).saturating_sub(x));
            self.draw_view(view, theme, buffer, Rect { x, width, ..body });
            x += width;
        }
        self.draw_table(theme, buffer, write::right_of(body, x));
        None
    }

    /// A click shows the next view.
    fn click(&self, _area: Rect, _at: Position) -> Option<Message> {
        Some(Message::Field(1))
    }
}

/// What is compared with the matrix, cut to what a heading can hold.
pub fn heading(what: &str) -> String {
    let mut name: String = what.chars().take(LONGEST).collect();
    if name.chars().count() < what.chars().count() {
        name.push('…');
    }
    name
}

/// Most characters of a name in the heading.
const LONGEST: usize = 24;
