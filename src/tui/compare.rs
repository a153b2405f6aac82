//! Two imprints side by side: where they differ, their descriptors, and the differences between these.
//!
//! ```text
//! 5 taxels differ   A: washer   B: the matrix        how many taxels differ | what is compared, the earlier one first
//!    0   2   4   6       A   B   B-A
//!  0 · · a █ b ·    NA   40  52  +12                 █ in both, a b in one only | descriptors of the main regions
//! ```
//! On a wide screen A and B stand beside the view of their differences; elsewhere Tab shows one after the other. If
//! there is no room for the descriptors beside a view, they are a view of their own. Parts that do not fit scroll;
//! arrows show where there is more.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::description::{
    DESCRIPTORS, Description, Descriptor, Dimension, Value, main_region, regions,
};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::number::differing;
use taxel_files::formats::value;

use crate::tui::app::change::refuse;
use crate::tui::app::message::{Endpoint, Message};
use crate::tui::app::page::{Flow, Page, Slot, Wheel};
use crate::tui::app::state::App;
use crate::tui::grid::{CellSize, Grid, Look, RULER, Window};
use crate::tui::keys::key::Arrow;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::widget::theme::{Role, Theme, spelling};
use crate::tui::widget::write;
use crate::tui::widget::write::{around, narrow};
use ComparedView::{Descriptors, Difference, First, Second};

const GAP: u16 = 2;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ComparedView {
    Difference,
    First,
    Second,
    Descriptors,
}

const VIEWS: [ComparedView; 4] = [Difference, First, Second, Descriptors];

const GRIDS: &[ComparedView] = VIEWS.split_at(3).0;

type TableRow = [String; 4];

#[derive(Clone, Debug)]
pub struct Comparison {
    imprints: Box<[Imprint; 2]>,
    names: [String; 2],
    table: Vec<TableRow>,
    view: usize,
    top: u16,
    left: u16,
}

struct ComparedPanes {
    views: Vec<(ComparedView, Rect)>,
    table: Option<Rect>,
}

impl Comparison {
    /// If one has fewer columns or rows, the missing taxels count as inactive.
    pub fn new(first: (String, &Imprint), second: (String, &Imprint)) -> Self {
        let size = first.1.size().union(second.1.size());
        let imprints = [first.1, second.1].map(|imprint| imprint.resized(size));
        let table = table(&imprints);
        Self {
            imprints: Box::new(imprints),
            names: [first.0, second.0],
            table,
            view: 0,
            top: 0,
            left: 0,
        }
    }

    pub fn next_view(&mut self, by: i8, columns: u16) {
        let views = self.views(columns);
        self.view = around(self.view.min(views.len() - 1), by, views.len());
    }

    /// Scrolls to the right and down, or back if negative.
    pub fn scroll(&mut self, (columns, rows): (i16, i16), area: Rect) -> bool {
        let (most_left, most_top) = self.hidden(area);
        let moved =
            |now: u16, by: i16, most: u16| now.min(most).saturating_add_signed(by).min(most);
        self.left = moved(self.left, columns, most_left);
        self.top = moved(self.top, rows, most_top);
        (most_left, most_top) != (0, 0)
    }

    fn hidden(&self, area: Rect) -> (u16, u16) {
        let panes = self.panes(area);
        let [first, _] = &*self.imprints;
        let views = panes.views.iter().map(|&(_, area)| {
            let grid = self.grid(area);
            let columns = first.columns() - grid.columns.count;
            (columns.into(), (first.rows() - grid.rows.count).into())
        });
        let table = panes.table.map(|area| (0, self.rows_beyond(area.height)));
        let all = views.chain(table);
        all.fold((0, 0), |most, one| (most.0.max(one.0), most.1.max(one.1)))
    }

    fn rows_beyond(&self, lines: u16) -> u16 {
        narrow(self.table.len()).saturating_sub(lines)
    }

    fn panes(&self, area: Rect) -> ComparedPanes {
        let body = write::below(area, HEADING);
        let table = self.widths().iter().sum::<u16>() + 3 * GAP;
        let views = self.views(body.width);
        let view = views[self.view.min(views.len() - 1)];
        if view == Descriptors {
            let table = Some(body);
            return ComparedPanes {
                views: Vec::new(),
                table,
            };
        }
        let all = 3 * self.width(2) + table <= body.width;
        let shown = if all { GRIDS } else { &[view] };
        // Taxels of two characters, or else of one, leave the room that the descriptors need.
        let beside = if views == GRIDS { table } else { 0 };
        let room = body.width.saturating_sub(beside).max(self.width(1));
        let room = room.min(body.width);
        let mut x = body.x;
        let views = shown.iter().map(|&view| {
            let width = self.width(2).min((body.x + room).saturating_sub(x));
            let place = Rect { x, width, ..body };
            x += width;
            (view, place)
        });
        let views = views.collect();
        ComparedPanes {
            views,
            table: (beside > 0).then(|| write::right_of(body, x)),
        }
    }

    fn grid(&self, area: Rect) -> Grid {
        let [first, _] = &*self.imprints;
        let room = area.width.saturating_sub(RULER);
        let size = if 2 * u16::from(first.columns()) <= room {
            CellSize::Square(1)
        } else {
            CellSize::Narrow
        };
        // A low view has a row before it has numbers of columns.
        let above = if area.height > 2 { 2 } else { 1 };
        let lines = area.height.saturating_sub(above);
        Grid {
            x: area.x + RULER,
            y: area.y + above,
            size,
            columns: Window::after(self.left, first.columns(), room / size.columns()),
            rows: Window::after(self.top, first.rows(), lines),
        }
    }

    fn width(&self, characters: u16) -> u16 {
        RULER + characters * u16::from(self.imprints[0].columns()) + 1
    }

    fn widths(&self) -> [u16; 4] {
        std::array::from_fn(|column| {
            let widths = self.table.iter().map(|row| ascii_width(&row[column]));
            narrow(widths.fold(0, usize::max))
        })
    }

    fn views(&self, columns: u16) -> &'static [ComparedView] {
        let [symbol, first, second, _] = self.widths();
        let least = symbol + first + second + 2 * GAP;
        if self.width(1) + least <= columns {
            GRIDS
        } else {
            &VIEWS
        }
    }

    fn differing(&self) -> u32 {
        self.imprints[0].differing(&self.imprints[1]).count()
    }

    /// Arrows in the heading show where there are more taxels.
    fn draw_view(&self, view: ComparedView, theme: &Theme, buffer: &mut Buffer, area: Rect) {
        let [first, second] = &*self.imprints;
        let grid = self.grid(area);
        let ((above, below), (left, right)) = (grid.rows.hidden(), grid.columns.hidden());
        let arrows = [above, below, left, right].into_iter().zip(theme.more());
        let arrows: String = arrows
            .filter(|(any, _)| *any)
            .map(|(_, sign)| sign)
            .collect();
        let meaning = match view {
            Difference => "a: only A, b: only B",
            First => "A",
            Second => "B",
            Descriptors => return,
        };
        let title = format!("{meaning}  {arrows}");
        write::text(buffer, area, theme, title.trim_end(), Role::Title);
        if grid.y > area.y + 1 {
            // A number that does not fit would touch the descriptors.
            grid.draw_columns(theme, buffer, grid.characters().0);
        }
        grid.draw_rows(theme, buffer);
        grid.draw(buffer, |column, row| {
            let active = (first.get(column, row), second.get(column, row));
            let (signs, role) = signs(theme, view, active);
            let style = theme.style(role);
            Look {
                signs,
                fill: ' ',
                style,
            }
        });
    }

    /// Draws the descriptors of both imprints and their differences. If they do not fit, the differences are left
    /// out, since they follow from the values. Arrows show where there are more rows.
    fn draw_table(&self, theme: &Theme, buffer: &mut Buffer, area: Rect) {
        let widths = self.widths();
        let whole = widths.iter().sum::<u16>() + 3 * GAP <= area.width;
        let columns = if whole { 4 } else { 3 };
        let top = usize::from(self.top.min(self.rows_beyond(area.height)));
        let visible = usize::from(area.height).saturating_sub(1);
        let [above, below, ..] = theme.more();
        let more = [
            (top > 0, above),
            (top + visible + 1 < self.table.len(), below),
        ];
        let more: String = more
            .iter()
            .filter(|(any, _)| *any)
            .map(|(_, sign)| sign)
            .collect();
        let rows = self
            .table
            .iter()
            .take(1)
            .chain(self.table.iter().skip(top + 1));
        for (index, row) in rows.take(visible + 1).enumerate() {
            let is_same = row[1] == row[2];
            let roles = match (index, is_same) {
                (0, _) => [Role::Title; 2],
                (_, true) => [Role::Key, Role::Quiet],
                (_, false) => [Role::Key, Role::Text],
            };
            let mut place = write::row(area, index);
            for (column, width) in widths.into_iter().enumerate().take(columns) {
                let text = match (index, column) {
                    (0, 0) => more.as_str().into(),
                    _ => theme.text(&row[column]),
                };
                let role = roles[usize::from(column > 0)];
                write::text(buffer, place, theme, &text, role);
                place = write::right_of(place, place.x.saturating_add(width + GAP));
            }
        }
    }
}

/// If nothing is active, counts and sums are 0.
fn table(imprints: &[Imprint; 2]) -> Vec<TableRow> {
    let described = imprints.each_ref().map(|imprint| {
        let regions = regions(imprint);
        let main = main_region(&regions).and_then(|main| regions.get(main));
        main.map(Description::of)
    });
    let heading = ["", "A", "B", "B-A"].map(str::to_owned);
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

/// Returns the width of a text in ASCII, which is at least its width in Unicode: the layout must not depend on the
/// terminal.
fn ascii_width(text: &str) -> usize {
    let widths = text.chars().map(|sign| spelling(sign).map_or(1, str::len));
    widths.sum()
}

/// Returns the characters of a taxel in a view, and their role. A letter instead of the shade shows which of the two
/// imprints has it active.
fn signs(theme: &Theme, view: ComparedView, active: (bool, bool)) -> ([char; 2], Role) {
    let role = |on: bool| if on { Role::Chosen } else { Role::Inactive };
    match (view, active) {
        (Difference, (true, false)) => (['a', 'a'], Role::Key),
        (Difference, (false, true)) => (['b', 'b'], Role::Key),
        (First | Difference | Descriptors, (on, _)) | (Second, (_, on)) => {
            (theme.taxel(role(on)), role(on))
        }
    }
}

fn text(descriptor: &Descriptor, measured: Value) -> String {
    let text = value::text(measured, descriptor.dimension);
    text.unwrap_or_else(|| "–".to_owned())
}

fn signed(descriptor: &Descriptor, by: Value) -> String {
    let sign = |number: f64| {
        let text = text(descriptor, Value::Number(number));
        let is_zero = text.bytes().all(|byte| !matches!(byte, b'1'..=b'9'));
        if number > 0.0 && !is_zero {
            format!("+{text}")
        } else {
            text
        }
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
            let by = second - first;
            Value::Number(match descriptor.dimension {
                Dimension::Direction => 180.0 - (180.0 - by).rem_euclid(360.0),
                _ => by,
            })
        }
        (Value::Point(first), Value::Point(second)) => Value::Point(second - first),
        _ => Value::None,
    }
}

impl Page for Comparison {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        let by = match *message {
            Message::Scroll(lines) => Some((0, lines)),
            Message::ScrollTo(Endpoint::First) => Some((0, i16::MIN)),
            Message::ScrollTo(Endpoint::Last) => Some((0, i16::MAX)),
            Message::Choose(Arrow::Left) => Some((-1, 0)),
            Message::Choose(Arrow::Right) => Some((1, 0)),
            _ => None,
        };
        if let Some(panes) = app.panes() {
            let area = panes.area(self.slot());
            if let Message::Field(by) = *message {
                self.next_view(by, area.width);
            } else if let Some(by) = by
                && !self.scroll(by, area)
            {
                refuse(app, "all of it is visible");
            }
        }
        Flow::Stay
    }

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
        // On a narrow screen the names are cut, not the number, and neither of them leaves no room for the other.
        let differ = differing(self.differing());
        let labels = ["   A: ", "   B: "];
        let fixed = write::width(&differ) + labels.concat().len();
        let room = usize::from(area.width).saturating_sub(fixed);
        let [first, second] = self.names.each_ref().map(|name| theme.text(name));
        let for_second = write::width(&second).min(room / 2);
        let first = write::fitted(&first, room - for_second, theme);
        let pieces = [
            (differ.as_str(), Role::Title),
            (labels[0], Role::Key),
            (&*first, Role::Text),
            (labels[1], Role::Key),
            (&*second, Role::Text),
        ];
        write::line(buffer, area, theme, pieces);
        let panes = self.panes(area);
        for (view, place) in panes.views {
            self.draw_view(view, theme, buffer, place);
        }
        if let Some(place) = panes.table {
            self.draw_table(theme, buffer, place);
        }
        None
    }

    fn click(&self, _area: Rect, _at: Position) -> Option<Message> {
        Some(Message::Field(1))
    }

    fn wheel(&self) -> Wheel {
        Wheel::Rows
    }

    fn has_use_for(&self, message: &Message, area: Rect) -> bool {
        let scrolls = matches!(
            message,
            Message::Scroll(_) | Message::ScrollTo(_) | Message::Choose(_)
        );
        !scrolls || self.hidden(area) != (0, 0)
    }
}

const HEADING: u16 = 1;

pub fn heading(what: &str) -> String {
    let mut name: String = what.chars().take(LONGEST).collect();
    if name.chars().count() < what.chars().count() {
        name.push('…');
    }
    name
}

const LONGEST: usize = 24;
