//! The view: reads the state and draws it.
//!
//! ```text
//! +--------------------------------------------------+
//! | menu: the paper's options, or those of a page    |
//! | title: sensor, name                              |
//! | column ruler                |                    |
//! | row   matrix                | descriptor panel,  |   or a page over the whole width
//! | ruler                       | or a form          |
//! |                             |                    |
//! | what made the imprint                            |
//! | the taxel under the cursor                       |
//! | notice, question or prompt                       |
//! | hints: other keys that mean something now        |
//! +--------------------------------------------------+
//! ```
//! A narrow screen shows one pane, matrix or panel. Where the panel beside the matrix may cut values, it can also
//! have the whole screen. On a low screen the lines below the matrix are left out first. A screen that is too small for
//! anything says so. Every pane accepts any rectangle, also an empty one.
//!
//! A page draws its own state, but that of recognition. What surrounds the pages reads the whole state: this file, the
//! menu, the title, the matrix, the lines at the foot.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::imprint::Imprint;

use crate::tui::app::status::{self, title};
use crate::tui::app::{App, Canvas, Page, Place, menu};
use crate::tui::grid::{CellSize, RULER, beside_rulers};
use crate::tui::matrix::{self, panel};
use crate::tui::widget::write::{self, below, right_of};
use crate::tui::widget::{Role, Theme};

/// Returns the position of the terminal's cursor; None if it is hidden.
pub fn draw(app: &App, buffer: &mut Buffer) -> Option<Position> {
    let (area, theme) = (buffer.area, &app.theme);
    let Some(panes) = Panes::of(area, &app.reading().imprint, app.halves()) else {
        too_small(theme, buffer, area);
        return None;
    };
    let items = menu::menu(app, panes.menu);
    menu::draw(theme, buffer, &items);
    let width = u16::MAX;
    let is_cut = items.len()
        < menu::menu(
            app,
            Rect {
                width,
                ..panes.menu
            },
        )
        .len();
    if let Some(last) = items.last().filter(|_| is_cut) {
        let rest = right_of(panes.menu, last.area.right() + 1);
        write::text(buffer, rest, theme, "…", Role::Quiet);
    }
    let (page, place) = (app.pane(), app.pane().map(Page::place));
    if !matches!(place, Some(Place::Screen | Place::Body)) {
        write::text(buffer, panes.title, theme, &title(app), Role::Text);
    }
    // A narrow screen shows one pane at a time.
    let has_both = panes.panel.is_some();
    let (sees_matrix, sees_panel) = match place {
        None | Some(Place::Panel) => (has_both || !app.shows_panel, has_both || app.shows_panel),
        place => (place == Some(Place::Form), true),
    };
    let mut cursor = None;
    if sees_matrix {
        cursor = matrix::view::draw(app, buffer, panes.matrix);
    }
    match page {
        None if sees_panel => panel::draw(app, buffer, panes.area(Place::Panel)),
        Some(page) if sees_panel => {
            if let Some(beside) = panes.form_panel.filter(|_| place == Some(Place::Form)) {
                panel::draw(app, buffer, beside);
            }
            let area = status::page_area(app, &panes, page);
            write::clear(buffer, area);
            let own = page.draw(Canvas::of(app, buffer), area);
            cursor = own.or(cursor.filter(|_| place == Some(Place::Panel)));
        }
        _ => {}
    }
    // A name and a command are typed in the line of notices.
    cursor = status::draw(app, buffer, &panes).or(cursor);
    // The terminal's own cursor shows the place where there are neither colours nor reversed characters.
    cursor.filter(|&position| area.contains(position))
}

fn too_small(theme: &Theme, buffer: &mut Buffer, area: Rect) {
    let (width, height) = SMALLEST;
    let text = theme.text("×");
    let text = format!("the screen is too small: {width} {text} {height} at least");
    write::wrapped(buffer, area, theme, &text, Role::Error);
}

/// The columns that the descriptors need, and those that they have where there is room.
const PANEL: u16 = 30;
const WIDE_PANEL: u16 = 44;

/// The columns of a matrix of usual size with the descriptors beside it.
const BOTH: u16 = RULER + 2 * 16 + 1 + PANEL;

/// The columns that a form needs, has beside the descriptors, and has where there is room.
const FORM: u16 = 22;
const NARROW_FORM: u16 = 32;
const WIDE_FORM: u16 = 40;

/// On a lower screen matrix and descriptors each have the screen to themselves. A line less than 24, so that the line
/// of a terminal multiplexer takes nothing but the title.
const FULL: u16 = 23;

pub const SMALLEST: (u16, u16) = (40, 12);

/// A line without room is empty.
#[derive(Clone, Copy, Debug)]
pub struct Panes {
    pub menu: Rect,
    pub body: Rect,
    /// Pages over the whole body cover it.
    pub title: Rect,
    pub content: Rect,
    pub matrix: Rect,
    pub panel: Option<Rect>,
    pub form: Rect,
    pub form_panel: Option<Rect>,
    pub source: Rect,
    pub taxel: Rect,
    pub notice: Rect,
    pub hints: Rect,
}

impl Panes {
    /// With `halves`, two taxels may share a character.
    pub fn of(area: Rect, imprint: &Imprint, halves: bool) -> Option<Self> {
        if area.width < SMALLEST.0 || area.height < SMALLEST.1 {
            return None;
        }
        let is_full = area.height >= FULL;
        let foot = if is_full { 4 } else { 2 };
        let part = |y, height| Rect { y, height, ..area };
        let line = |from_bottom| part(area.bottom() - from_bottom, 1);
        let body = part(area.y + 1, area.height - 1 - foot);
        let title = part(body.y, u16::from(area.height > FULL));
        let content = below(body, title.height);
        let width = matrix_width(content, imprint, halves);
        let matrix = Rect { width, ..content };
        let beside = right_of(content, (matrix.right() + 1).min(content.right()));
        let (form, form_panel) = form(content, beside);
        Some(Self {
            menu: part(area.y, 1),
            body,
            title,
            content,
            matrix,
            panel: (is_full && beside.width >= PANEL).then_some(beside),
            form,
            form_panel,
            source: if is_full { line(4) } else { part(area.y, 0) },
            taxel: line(if is_full { 3 } else { 2 }),
            notice: line(2),
            hints: line(1),
        })
    }

    pub fn area(&self, slot: Place) -> Rect {
        match slot {
            Place::Screen => Rect {
                height: self.notice.y.saturating_sub(self.body.y),
                ..self.body
            },
            Place::Body => self.body,
            Place::Form => self.form,
            Place::Panel => self.panel.unwrap_or(self.content),
            Place::Prompt | Place::Question => self.notice,
        }
    }
}

/// Square taxels come first, as large as there is room for, then smaller ones that show more of the matrix.
fn matrix_width(content: Rect, imprint: &Imprint, halves: bool) -> u16 {
    let cells = (imprint.columns(), imprint.rows());
    let beside = |panel: u16| Rect {
        width: content.width.saturating_sub(panel),
        ..content
    };
    let fitting = |room: Rect| CellSize::fitting(cells, beside_rulers(room), halves);
    let has_both = content.width >= BOTH;
    let room = beside(if has_both { 1 + PANEL } else { 0 });
    let size = match (fitting(room), fitting(beside(1 + WIDE_PANEL))) {
        (CellSize::Square(_), large @ CellSize::Square(_)) => large,
        (CellSize::Square(_), _) => CellSize::Square(1),
        (small, _) => small,
    };
    (RULER + size.columns() * u16::from(cells.0)).min(room.width)
}

/// Beside the matrix, and beside the descriptors if there is room; on a narrow screen in place of both.
fn form(content: Rect, beside: Rect) -> (Rect, Option<Rect>) {
    if beside.width < FORM {
        return (content, None);
    }
    if beside.width <= NARROW_FORM + PANEL {
        return (beside, None);
    }
    let panel = (beside.width - 1).saturating_sub(WIDE_FORM);
    let width = beside.width - 1 - panel.clamp(PANEL, WIDE_PANEL);
    let panel = right_of(beside, beside.x + width + 1);
    (Rect { width, ..beside }, Some(panel))
}
