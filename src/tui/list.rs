//! The list of stored shapes, for Load, Delete and Picture, with a filter and a preview.
//!
//! ```text
//! Load  filter: le   4 of 28                   clover               what for, filter, how many match | name
//!   0 above, 1 below                           NA 97, pieces 1, …   rows out of sight                | facts
//!   letter A                 16 × 16 shipped   an imprint, no f…    sign, name, size, origin         | source
//! > letter B                 16 × 16 shipped
//!   my letter                16 × 16           ··██··               the selected row is reversed     | imprint
//! ```
//! Below 66 columns there is no preview. Matches come in this order: the name itself, names that begin with the filter,
//! names that contain it. Shapes are read as they come into sight, so a large library opens at once; one that cannot be
//! read is `broken`, and the preview says why.

use std::collections::{HashMap, HashSet};

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::description::{Region, RegionKind, regions};
use taxel_files::formats::name::{LONGEST, folded};
use taxel_files::storage::{LibraryEntry, LoadedShape, ShapeOrigin};

use crate::tui::app::change::refuse;
use crate::tui::app::message::{Message, Purpose};
use crate::tui::app::page::{Canvas, Flow, Page, Place, Placed, Wheel, find_mut};
use crate::tui::app::state::App;
use crate::tui::grid::draw_thumbnail;
use crate::tui::jobs::{Jobs, answer};
use crate::tui::keys::action;
use crate::tui::keys::keymap::{Context, Keymap};
use crate::tui::library::{named, sentence};
use crate::tui::widget::rows::{ListRows, moved};
use crate::tui::widget::text_field::TextField;
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, narrow};

/// The rows around the selected one whose shapes are read.
const AHEAD: usize = 64;
/// The columns beside a name, and those of a name.
const BESIDE: usize = 18;
const SHORTEST: usize = 8;
const USUAL: usize = 24;
const HEAD: u16 = 2;

pub(crate) struct ListDialog {
    purpose: Purpose,
    /// None until the library has answered.
    entries: Option<Vec<LibraryEntry>>,
    filter: TextField,
    matching: Vec<usize>,
    selected: usize,
    read: HashMap<String, Result<LoadedShape, String>>,
    asked: HashSet<String>,
}

type Row<'a> = (&'a LibraryEntry, Option<&'a Result<LoadedShape, String>>);

/// Opens the list, empty until the library answers.
pub(crate) fn open_list(app: &mut App, purpose: Purpose) {
    app.open(ListDialog {
        purpose,
        entries: None,
        filter: TextField::new("", LONGEST),
        matching: Vec::new(),
        selected: 0,
        read: HashMap::new(),
        asked: HashSet::new(),
    });
    app.jobs.read("Listing the shapes", |library| {
        let listed = library.list().map_err(|error| sentence(library, &error));
        answer(
            |app| match (listed, find_mut::<ListDialog>(&mut app.pages)) {
                (Ok(entries), Some(own)) => own.fill(entries, &mut app.jobs),
                (Err(reason), _) => {
                    app.pages.pop();
                    refuse(app, reason);
                }
                _ => {}
            },
        )
    });
}

impl ListDialog {
    /// Only the user's own shapes can be deleted.
    fn fill(&mut self, mut entries: Vec<LibraryEntry>, jobs: &mut Jobs) {
        if self.purpose == Purpose::Delete {
            entries.retain(|entry| entry.origin == ShapeOrigin::Own);
        }
        self.entries = Some(entries);
        self.apply_filter();
        self.read_visible(jobs);
    }

    fn entries(&self) -> &[LibraryEntry] {
        self.entries.as_deref().unwrap_or_default()
    }

    fn rows(&self) -> impl ExactSizeIterator<Item = Row<'_>> {
        let entries = self.matching.iter().map(|&index| &self.entries()[index]);
        entries.map(|entry| (entry, self.read.get(&entry.name)))
    }

    fn choice(&self) -> Option<Row<'_>> {
        self.rows().nth(self.selected)
    }

    fn apply_filter(&mut self) {
        let wanted = folded(self.filter.text());
        let rank = |(index, entry): (usize, &LibraryEntry)| {
            let name = folded(&entry.name);
            let at = name.find(&wanted)?;
            Some((name != wanted, at > 0, index))
        };
        let entries = self.entries().iter().enumerate();
        let mut ranked: Vec<_> = entries.filter_map(rank).collect();
        ranked.sort_unstable();
        self.matching = ranked.into_iter().map(|(_, _, index)| index).collect();
        self.selected = 0;
    }

    /// A library may be large, and only rows in sight need their size and preview.
    fn read_visible(&mut self, jobs: &mut Jobs) {
        let first = self.selected.saturating_sub(AHEAD);
        let near = self.rows().skip(first).take(2 * AHEAD);
        let near = near.map(|(entry, _)| entry.name.clone());
        let unread: Vec<String> = near.filter(|name| !self.asked.contains(name)).collect();
        if unread.is_empty() {
            return;
        }
        self.asked.extend(unread.iter().cloned());
        jobs.read("Reading the shapes", |library| {
            let read = unread.into_iter().map(|name| {
                let loaded = library.load(&name);
                let loaded = loaded.map_err(|error| sentence(library, &error));
                (name, loaded)
            });
            let read: Vec<_> = read.collect();
            answer(|app| {
                if let Some(list) = app.top_mut::<Self>() {
                    list.read.extend(read);
                }
            })
        });
    }

    fn why_empty(&self, keymap: &Keymap) -> Option<String> {
        if self.rows().len() > 0 {
            return None;
        }
        Some(match &self.entries {
            None => "the library is being read".to_owned(),
            Some(entries) if entries.is_empty() => match self.purpose {
                Purpose::Delete => "there are no shapes of your own".to_owned(),
                _ => "the library is empty".to_owned(),
            },
            _ => {
                let key = keymap.label(Context::List, &action::ERASE_BEFORE);
                format!("no name contains this; {key} shortens it")
            }
        })
    }

    fn list_rows(&self, pane: Rect) -> ListRows {
        ListRows::around(write::below(pane, HEAD), self.rows().len(), self.selected)
    }
}

impl Page for ListDialog {
    /// The list closes when a shape is taken, and opens again if that is refused.
    fn on(&mut self, app: &mut App, message: &Message) -> Flow {
        if *message == Message::Accept {
            if let Some((entry, _)) = self.choice() {
                let (purpose, name) = (self.purpose, entry.name.clone());
                return Flow::ask(move |app| named(app, purpose, name));
            }
            refuse(app, "there is no shape to choose");
        } else if let Some(row) = moved(self.selected, message) {
            self.selected = row.min(self.matching.len().saturating_sub(1));
        } else if self.filter.take(message) {
            self.apply_filter();
        }
        self.read_visible(&mut app.jobs);
        Flow::Stay
    }

    fn placed(&self) -> Placed {
        (Context::List, Place::Body, Wheel::Rows)
    }

    fn draw(&self, canvas: Canvas<'_>, area: Rect) -> Option<Position> {
        let (theme, keymap, buffer) = (canvas.theme, canvas.keymap, canvas.buffer);
        let (area, preview) = panes(area);
        let title = match self.purpose {
            Purpose::Load | Purpose::Compare => "Load",
            Purpose::Delete => "Delete",
            Purpose::Picture => "Picture",
        };
        let label = "  filter: ";
        let beside = write::width(title) + write::width(label);
        let (typed, room) = (
            self.filter.text(),
            usize::from(area.width).saturating_sub(beside),
        );
        let (filter, _) = write::field_text(typed, write::width(typed), room, theme);
        let head = [
            (title, Role::Title),
            (label, Role::Text),
            (&*filter, Role::Text),
        ];
        let end = write::line(buffer, area, theme, head);
        let (shown, all) = (self.rows().len(), self.entries().len());
        let is_whole = typed.is_empty() && all > 0;
        let hint = if is_whole { "; type to search" } else { "" };
        let count = format!("  {shown} of {all}{hint}");
        write::text(
            buffer,
            write::right_of(area, end),
            theme,
            &count,
            Role::Quiet,
        );
        if let Some(reason) = self.why_empty(keymap) {
            let place = write::below(area, HEAD);
            write::wrapped(buffer, place, theme, &reason, Role::Quiet);
        }
        let rows = self.list_rows(area);
        if let Some(hidden) = rows.hidden() {
            let row = write::row(area, usize::from(HEAD) - 1);
            write::text(buffer, row, theme, &hidden, Role::Quiet);
        }
        for (index, row, entry) in rows.visible(self.rows()) {
            draw_row(theme, entry, index == self.selected, buffer, row);
        }
        if let (Some(preview), Some((entry, Some(read)))) = (preview, self.choice()) {
            draw_preview(theme, entry, read, buffer, preview);
        }
        let end = end.min(area.right().saturating_sub(1));
        Some(Position::new(end, area.y))
    }

    fn click(&self, area: Rect, at: Position) -> Option<Message> {
        self.list_rows(panes(area).0).click(at, self.selected)
    }

    fn has_use_for(&self, message: &Message, _area: Rect) -> bool {
        let of_rows = matches!(
            message,
            Message::Accept | Message::Scroll(_) | Message::ScrollTo(_)
        );
        !of_rows || self.entries.is_none() || self.choice().is_some()
    }
}

fn draw_row(theme: &Theme, (entry, read): Row<'_>, selected: bool, buffer: &mut Buffer, row: Rect) {
    // A sign beside the reversed line, for terminals that cannot reverse.
    let sign = if selected { "> " } else { "  " };
    let columns = usize::from(row.width).saturating_sub(BESIDE);
    let columns = columns.clamp(SHORTEST, USUAL);
    let name = theme.text(&entry.name);
    let name = write::fitted(&name, columns, theme);
    let gap = " ".repeat(columns + 1 - write::width(&name).min(columns));
    let size = match read {
        Some(Ok(loaded)) => {
            let imprint = &loaded.shape.imprint;
            format!("{:>2} × {:<2} ", imprint.columns(), imprint.rows())
        }
        Some(Err(_)) => "broken  ".to_owned(),
        None => "        ".to_owned(),
    };
    let origin = match entry.origin {
        ShapeOrigin::Shipped => "shipped",
        ShapeOrigin::Own => "",
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
    let shape = match read {
        Ok(loaded) => &loaded.shape,
        Err(reason) => {
            say("broken:", Role::Error);
            say(reason, Role::Text);
            return;
        }
    };
    let regions = regions(&shape.imprint);
    let is_hole = |region: &&Region<'_>| region.kind() == RegionKind::Hole;
    let holes = regions.iter().filter(is_hole).count();
    let (na, pieces) = (shape.imprint.count(), regions.len() - holes);
    let facts = format!("NA {na}, pieces {pieces}, holes {holes}");
    say(&facts, Role::Text);
    let source = shape.source.as_ref();
    let source = source.map_or("an imprint, not a figure".to_owned(), ToString::to_string);
    // The imprint has the same height for most shapes.
    let end = say(&source, Role::Quiet).max(4);
    draw_thumbnail(theme, &shape.imprint, buffer, write::below(area, end));
}

fn panes(body: Rect) -> (Rect, Option<Rect>) {
    if body.width < 66 {
        return (body, None);
    }
    let width = (body.width - 36).min(60);
    let preview = write::right_of(body, body.x + width + 1);
    (Rect { width, ..body }, Some(preview))
}
