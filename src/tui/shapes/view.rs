//! The list of stored shapes, with a filter and a preview.
//!
//! ```text
//! Load  filter: le   4 of 28                   clover               what for, filter, how many match | name
//!   0 above, 1 below                           NA 97, pieces 1, …   rows out of sight                | facts
//!   letter A                 16 × 16 shipped   an imprint, no f…    sign, name, size, origin         | source
//! > letter B                 16 × 16 shipped
//!   my letter                16 × 16           ··██··               the selected row is reversed     | imprint
//! ```
//! Below 66 columns there is no preview. A row shows the size once its shape has been read; one that cannot be read is
//! `broken`, and the preview says why.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::description::{Region, RegionKind, regions};
use taxel_files::storage::{LibraryEntry, LoadedShape, ShapeOrigin};

use crate::tui::app::message::Message;
use crate::tui::app::page::{Flow, Page, Slot, Wheel};
use crate::tui::app::state::App;
use crate::tui::grid::draw_thumbnail;
use crate::tui::keys::action;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::shapes::state::{ListDialog, ListPurpose};
use crate::tui::shapes::update::in_list;
use crate::tui::widget::rows::ListRows;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};

const BESIDE: usize = 18;

const SHORTEST: usize = 8;

/// The largest number of columns for a name, so that the rest of the row stays near.
const USUAL: usize = 24;

impl Page for ListDialog {
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        in_list(self, app, message)
    }

    fn context(&self) -> Context {
        Context::List
    }

    fn slot(&self) -> Slot {
        Slot::Body
    }

    fn draw(
        &self,
        theme: &Theme,
        keymap: &Keymap,
        buffer: &mut Buffer,
        area: Rect,
    ) -> Option<Position> {
        let (area, preview) = list(area);
        let title = match self.purpose {
            ListPurpose::Load => "Load",
            ListPurpose::Delete => "Delete",
            ListPurpose::Picture => "Picture",
        };
        let label = "  filter: ";
        let room =
            usize::from(area.width).saturating_sub(write::width(title) + write::width(label));
        let typed = write::width(self.filter());
        let (filter, _) = write::field_text(self.filter(), typed, room, theme);
        let head = [
            (title, Role::Title),
            (label, Role::Text),
            (&*filter, Role::Text),
        ];
        let end = write::line(buffer, area, theme, head);
        draw_count(theme, self, buffer, write::right_of(area, end));
        if let Some(reason) = why_empty(keymap, self) {
            let place = write::below(area, LIST_HEAD);
            write::wrapped(buffer, place, theme, &reason, Role::Quiet);
        }
        let rows = list_rows(area, self);
        if let Some(hidden) = rows.hidden() {
            let row = write::row(area, usize::from(LIST_HEAD) - 1);
            write::text(buffer, row, theme, &hidden, Role::Quiet);
        }
        for (index, row, (entry, read)) in rows.visible(self.rows()) {
            draw_row(theme, entry, read, index == self.selected(), buffer, row);
        }
        if let (Some(preview), Some((entry, Some(read)))) = (preview, self.choice()) {
            draw_preview(theme, entry, read, buffer, preview);
        }
        let end = end.min(area.right().saturating_sub(1));
        Some(Position::new(end, area.y))
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        let (pane, _) = list(area);
        list_rows(pane, self).click(at, self.selected())
    }

    /// A list that is still being read may get rows.
    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        let of_rows = matches!(
            message,
            Message::Accept | Message::Scroll(_) | Message::ScrollTo(_)
        );
        !of_rows || !self.listed || self.choice().is_some()
    }

    fn wheel(&self) -> Wheel {
        Wheel::Rows
    }
}

fn why_empty(keymap: &Keymap, dialog: &ListDialog) -> Option<String> {
    if dialog.rows().len() > 0 {
        return None;
    }
    Some(
        match (dialog.undeletable(), dialog.total(), dialog.purpose) {
            _ if !dialog.listed => "the library is being read".to_owned(),
            (Some(name), ..) => format!("{name} comes with taxel and cannot be deleted"),
            (_, 0, ListPurpose::Delete) => "there are no shapes of your own".to_owned(),
            (_, 0, _) => "the library is empty".to_owned(),
            _ => {
                let key = keymap.label(Context::List, &action::ERASE_BEFORE);
                format!("no name contains this; {key} shortens it")
            }
        },
    )
}

fn draw_count(theme: &Theme, dialog: &ListDialog, buffer: &mut Buffer, area: Rect) {
    let count = format!("  {} of {}", dialog.rows().len(), dialog.total());
    let hint = if dialog.filter().is_empty() && dialog.total() > 0 {
        "; type to search"
    } else {
        ""
    };
    write::text(buffer, area, theme, &(count + hint), Role::Quiet);
}

fn draw_row(
    theme: &Theme,
    entry: &LibraryEntry,
    read: Option<&Result<LoadedShape, String>>,
    selected: bool,
    buffer: &mut Buffer,
    row: Rect,
) {
    // A sign beside the reversed line, for terminals that cannot reverse.
    let sign = if selected { "> " } else { "  " };
    let columns = usize::from(row.width).saturating_sub(BESIDE);
    let columns = columns.clamp(SHORTEST, USUAL);
    let name = theme.text(&entry.name);
    let name = write::fitted(&name, columns, theme);
    let gap = " ".repeat(columns + 1 - write::width(&name).min(columns));
    let size = match read {
        Some(Ok(loaded)) => format!(
            "{:>2} × {:<2} ",
            loaded.shape.imprint.columns(),
            loaded.shape.imprint.rows()
        ),
        Some(Err(_)) => "broken  ".to_owned(),
        None => "        ".to_owned(),
    };
    let origin = if entry.origin == ShapeOrigin::Shipped {
        "shipped"
    } else {
        ""
    };
    let role = if selected { Role::Focus } else { Role::Text };
    let pieces = [
        (sign, Role::Key),
        (&name, role),
        (&gap, role),
        (size.as_str(), Role::Quiet),
        (origin, Role::Quiet),
    ];
    write::line(buffer, row, theme, pieces);
}

fn draw_preview(
    theme: &Theme,
    entry: &LibraryEntry,
    read: &Result<LoadedShape, String>,
    buffer: &mut Buffer,
    area: Rect,
) {
    // The name may need two lines, the source more.
    let mut used = write::wrapped(buffer, area, theme, &entry.name, Role::Title);
    let mut say = |text: &str, role: Role| {
        used += write::wrapped(buffer, write::below(area, narrow(used)), theme, text, role);
        narrow(used)
    };
    match read {
        Ok(loaded) => {
            let imprint = &loaded.shape.imprint;
            let regions = regions(imprint);
            let count = |wanted: RegionKind| {
                let kinds = regions.iter().map(Region::kind);
                kinds.filter(|&kind| kind == wanted).count()
            };
            let facts = format!(
                "NA {}, pieces {}, holes {}",
                imprint.count(),
                count(RegionKind::Exterior),
                count(RegionKind::Hole)
            );
            let source = loaded
                .shape
                .source
                .as_ref()
                .map_or("an imprint, not a figure".to_owned(), ToString::to_string);
            say(&facts, Role::Text);
            // The imprint has the same height for most shapes.
            let end = say(&source, Role::Quiet).max(4);
            draw_thumbnail(theme, imprint, buffer, write::below(area, end));
        }
        Err(reason) => {
            say("broken:", Role::Error);
            say(reason, Role::Text);
        }
    }
}

pub const LIST_HEAD: u16 = 2;

pub fn list(body: Rect) -> (Rect, Option<Rect>) {
    let width = body.width.saturating_sub(36);
    if body.width < 66 {
        return (body, None);
    }
    let left = Rect {
        width: width.min(60),
        ..body
    };
    let right = Rect {
        x: left.right() + 1,
        width: body.right() - left.right() - 1,
        ..body
    };
    (left, Some(right))
}

pub fn list_rows(pane: Rect, dialog: &ListDialog) -> ListRows {
    let area = write::below(pane, LIST_HEAD);
    ListRows::around(area, dialog.rows().len(), dialog.selected())
}
