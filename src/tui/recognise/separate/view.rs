//! The page of sizes.
//!
//! ```text
//! Separate: model figures-30                 the model
//! 10 × 10 positions per cell, angle 0:358:2  its steps; while it works, a gauge
//!  70 % |⠉⠢⢄                                  the error against the size; dots at the wanted one
//!   0 % |....⠈⠉⠒⠤
//!        0.5   1   1.5   2
//! scale    error  certain imprints  sensor    what was found of each size
//! 0.5     62.1 %    5.2 %      310  16 × 16
//! error at most 1 %: scale 2.3 or larger       what was looked for
//! scale 1: octagon named ellipse in 52.4 %    the pair that is confused most, with an imprint
//! ```

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};

use crate::formats::separation::{SizeWords, short, size_label};
use crate::formats::value::{decimal, grouped, percent};
use crate::recognition::{SizeAxis, SmallestSize};
use crate::tui::app::message::Message;
use crate::tui::app::page::{Page, Slot, Wheel};
use crate::tui::explore::running::gauge;
use crate::tui::keys::action;
use crate::tui::keys::binding::Context;
use crate::tui::keys::keymap::Keymap;
use crate::tui::recognise::message::SizeFound;
use crate::tui::recognise::separate::state::{Separate, SizeWork};
use crate::tui::widget::curve::Curve;
use crate::tui::widget::rows::ListRows;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::{thumbnail, write};

/// The width of the table, in columns.
const TABLE: u16 = 48;

/// The number of lines below the table: the wanted error, the worst pair, its imprint.
const DETAIL: u16 = 3;

/// The areas of the parts of the page.
struct SeparatePanes {
    /// The curve; empty if there is no room.
    curve: Rect,
    /// The heading of the table.
    head: Rect,
    /// The rows of the table.
    rows: ListRows,
    /// The example imprint, beside the table.
    picture: Rect,
    /// The lines below the table.
    detail: Rect,
}

impl SeparatePanes {
    /// Divides the page. If there are fewer than ten lines, the curve is left out, because the table says the same in
    /// numbers.
    fn of(area: Rect, page: &Separate) -> Self {
        let body = write::below(area, 2);
        let body = Rect {
            height: body.height.saturating_sub(DETAIL),
            ..body
        };
        // The curve gets more than half; the table at least four rows, and no more than it needs.
        let wanted = u16::try_from(page.found().len().max(4)).unwrap_or(u16::MAX);
        let least = body.height.saturating_sub(wanted.saturating_add(1));
        let curve = (body.height * 3 / 5).max(least);
        let curve = if body.height < 10 { 0 } else { curve };
        let table = write::below(body, curve);
        let rows = write::below(table, 1);
        Self {
            curve: Rect {
                height: curve,
                ..body
            },
            head: write::row(table, 0),
            rows: ListRows::around(rows, page.found().len(), page.cursor()),
            picture: write::right_of(table, table.x.saturating_add(TABLE)),
            detail: write::below(area, area.height.saturating_sub(DETAIL)),
        }
    }
}

impl Page for Separate {
    fn context(&self) -> Context {
        Context::Separate
    }

    fn awaits_work(&self) -> bool {
        self.work().is_some()
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        *message != Message::Accept || self.work().is_none()
    }

    fn slot(&self) -> Slot {
        Slot::Screen
    }

    fn draw(
        &self,
        theme: &Theme,
        keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let panes = SeparatePanes::of(area, self);
        let request = self.request();
        let title = format!("Separate: {}", request.trained.choice);
        let what = match request.axis {
            SizeAxis::Pitch => "  error against pitch",
            _ => "  error against size",
        };
        let room = usize::from(area.width).saturating_sub(write::width(&title));
        let what = write::first_fitting(&[what, ""], room);
        let pieces = [(title.as_str(), Role::Title), (what, Role::Text)];
        write::line(buffer, area, theme, pieces);
        let second = write::row(area, 1);
        if let Some(work) = self.work() {
            self.draw_work(theme, keymap, work, buffer, second);
        } else {
            let steps = request.steps();
            write::text(buffer, second, theme, &steps, Role::Quiet);
        }
        self.draw_curve(theme, buffer, panes.curve);
        let cursor = self.draw_table(theme, &panes, buffer);
        self.draw_detail(theme, keymap, &panes, buffer);
        cursor
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let panes = SeparatePanes::of(area, self);
        let row = panes.rows.at(at).filter(|_| at.x < panes.picture.x)?;
        Some(Message::Select(row))
    }

    fn wheel(&self) -> Wheel {
        Wheel::Rows
    }

    fn cancels_itself(&self) -> bool {
        true
    }
}

impl Separate {
    /// Draws the progress of the work.
    fn draw_work(
        &self,
        theme: &Theme,
        keymap: &Keymap,
        work: &SizeWork,
        buffer: &mut Buffer,
        row: Rect,
    ) {
        let stop = keymap.label(Context::Separate, &action::CANCEL);
        let (found, all) = (self.found().len(), self.request().values().len());
        let text = match (work.stopping, found < all) {
            (true, _) => "stopping ".to_owned(),
            (false, true) => format!("{found} of {all} sizes; {stop} stops "),
            (false, false) => format!("searching between sizes; {stop} stops "),
        };
        let end = write::text(buffer, row, theme, &text, Role::Text);
        // The number of steps of this search is not known in advance.
        if found == all {
            return;
        }
        let place = write::right_of(row, end);
        gauge(theme, work.done.min(work.all), work.all, buffer, place);
    }

    /// Draws the error against the size.
    fn draw_curve(&self, theme: &Theme, buffer: &mut Buffer, area: Rect) {
        let points = self.found().iter().map(|size| &size.point);
        let points: Vec<_> = points.map(|point| (point.value, point.error())).collect();
        let values: Vec<f64> = self.request().sizes.values().collect();
        let curve = Curve {
            labels: ["error in %", self.size_name()],
            points: &points,
            values: &values,
            level: self.request().wanted,
            at: self.selected().map(|size| size.point.value),
        };
        curve.draw(theme, buffer, area);
    }

    /// Returns the name of the quantity that the sizes give.
    fn size_name(&self) -> &'static str {
        match self.request().axis {
            SizeAxis::Pitch => "pitch/mm",
            _ => "scale",
        }
    }

    /// Draws the results for each size. Returns the position of the cursor.
    fn draw_table(
        &self,
        theme: &Theme,
        panes: &SeparatePanes,
        buffer: &mut Buffer,
    ) -> Option<Position> {
        let name = self.size_name();
        let head = [
            format!("{name:<8}"),
            "    error".to_owned(),
            "   certain".to_owned(),
            "   imprints".to_owned(),
            "  sensor".to_owned(),
        ];
        let head = whole_columns(&head, panes.head.width);
        write::text(buffer, panes.head, theme, &head, Role::Title);
        for (row, place, size) in panes.rows.visible(self.found().iter()) {
            let role = match (
                row == self.cursor(),
                size.point.error() <= self.request().wanted,
            ) {
                (true, _) => Role::Focus,
                (_, true) => Role::Key,
                _ => Role::Text,
            };
            let text = whole_columns(&row_cells(size), place.width);
            write::text(buffer, place, theme, &text, role);
        }
        panes.rows.position(self.cursor())
    }

    /// Draws the result for the wanted error, and the pair that is confused most at the cursor.
    fn draw_detail(
        &self,
        theme: &Theme,
        keymap: &Keymap,
        panes: &SeparatePanes,
        buffer: &mut Buffer,
    ) {
        let wanted = self.wanted_text(keymap);
        let line = |index| write::row(panes.detail, index);
        write::text(buffer, line(0), theme, &wanted, Role::Title);
        let Some(size) = self.selected() else { return };
        let place = size_label(self.request().axis, size.point.value);
        let Some(worst) = &size.worst else {
            let text = format!("{place}: no shape is taken for another one");
            write::text(buffer, line(1), theme, &text, Role::Text);
            return;
        };
        let name = |shape| self.request().trained.name(shape);
        let (touched, named) = (name(worst.touched), name(worst.named));
        let share = percent(worst.share);
        let text = format!("{place}: {touched} named {named} in {share} of its touches");
        write::text(buffer, line(1), theme, &text, Role::Text);
        if let Some(example) = &worst.example {
            let text = example.in_words((worst.touched, worst.named), name);
            write::text(buffer, line(2), theme, &text, Role::Quiet);
            if let Some(imprint) = &example.imprint {
                thumbnail::draw(theme, imprint, buffer, panes.picture);
            }
        }
    }

    /// Returns the result for the wanted error, in words.
    fn wanted_text(&self, keymap: &Keymap) -> String {
        let wanted = format!("{} %", decimal(100.0 * self.request().wanted, 3));
        let axis = self.request().axis;
        let words = SizeWords::of(axis);
        match self.smallest() {
            None if self.work().is_some() => {
                let (smallest, noun) = (words.smallest, words.noun);
                format!("looking for the {smallest} {noun} with an error of at most {wanted}")
            }
            None => {
                let resume = keymap.label(Context::Separate, &action::SEPARATE);
                format!("stopped; {resume} resumes")
            }
            Some(None) => {
                let noun = words.noun;
                format!("no {noun} that was tried has an error of at most {wanted}")
            }
            Some(Some(smallest)) => {
                let place = size_label(axis, smallest.point.value);
                let how = tried(words, smallest);
                match smallest.missed_again {
                    0 => format!(
                        "error at most {wanted}: {place} or {} ({how})",
                        words.larger
                    ),
                    count => format!(
                        "error at most {wanted}: {place} ({how}); {} it",
                        words.larger_miss(count, "")
                    ),
                }
            }
        }
    }
}

/// Returns how a size was searched for.
fn tried(words: SizeWords, smallest: &SmallestSize) -> String {
    if smallest.step > 0.0 {
        format!("steps of {}{}", short(smallest.step), words.unit)
    } else {
        format!("no {} one was tried", words.smaller)
    }
}

/// Returns the cells of a row of the table, each with the gap before it.
fn row_cells(size: &SizeFound) -> [String; 5] {
    let point = &size.point;
    [
        format!("{:<8}", short(point.value)),
        format!("{:>9}", percent(point.error())),
        format!("{:>9}", percent(point.certain_share())),
        format!("{:>11}", grouped(point.keys as u128)),
        format!("  {side} × {side}", side = point.side),
    ]
}

/// Returns the first cells of a row, as far as they fit: a number that is cut would look like another one.
fn whole_columns(cells: &[String; 5], room: u16) -> String {
    let mut text = String::new();
    for cell in cells {
        if write::width(&text) + write::width(cell) > usize::from(room) {
            break;
        }
        text += cell;
    }
    text
}
