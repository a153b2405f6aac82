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
//! A page borrows its own state, `&Theme` and `&Keymap`. What surrounds the pages reads the whole state: this file, the
//! menu, the title, the matrix, the lines at the foot.

use ratatui::buffer::Buffer;
use ratatui::layout::{Position, Rect};
use taxel_core::imprint::Imprint;

use crate::tui::app::menu;
use crate::tui::app::page::{Page, Slot};
use crate::tui::app::state::{App, NarrowPane};
use crate::tui::app::status::{self, title};
use crate::tui::grid::{CellSize, RULER, beside_rulers};
use crate::tui::matrix::{self, panel};
use crate::tui::widget::theme::{Role, Theme};
use crate::tui::widget::write::{self, below, right_of};

/// Returns the position of the terminal's cursor; None if it is hidden.
pub fn draw(app: &App, buffer: &mut Buffer) -> Option<Position> {
    let area = buffer.area;
    let theme = app.theme();
    let Some(panes) = Panes::of(area, &app.reading().imprint, app.halves()) else {
        too_small(theme, buffer, area);
        return None;
    };
    menu::draw(theme, buffer, &menu::menu(app, panes.menu));
    let covers = |slot| matches!(slot, Slot::Screen | Slot::Body);
    if !app.pane().map(Page::slot).is_some_and(covers) {
        let title = title(app);
        write::text(buffer, panes.title, theme, &title, Role::Text);
    }
    let panel = |buffer: &mut Buffer, area: Rect| panel::draw(app, buffer, area);
    let mut cursor = None;
    match (app.pane(), panes.panel) {
        (Some(page), beside) if page.slot() == Slot::Panel => {
            if beside.is_some() || app.narrow_pane == NarrowPane::Matrix {
                cursor = matrix::view::draw(app, buffer, panes.matrix);
            }
            if beside.is_some() || app.narrow_pane == NarrowPane::Panel {
                let area = panes.area(Slot::Panel);
                write::clear(buffer, area);
                cursor = page.draw(theme, app.keymap(), buffer, area).or(cursor);
            }
        }
        (Some(page), _) => {
            if page.slot() == Slot::Form {
                matrix::view::draw(app, buffer, panes.matrix);
                if let Some(area) = panes.form_panel {
                    panel(buffer, area);
                }
            }
            let area = status::page_area(app, &panes, page);
            write::clear(buffer, area);
            cursor = page.draw(theme, app.keymap(), buffer, area);
        }
        (None, Some(beside)) => {
            cursor = matrix::view::draw(app, buffer, panes.matrix);
            panel(buffer, beside);
        }
        (None, None) if app.narrow_pane == NarrowPane::Panel => panel(buffer, panes.content),
        (None, None) => cursor = matrix::view::draw(app, buffer, panes.matrix),
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

const PANEL: u16 = 30;

const BOTH: u16 = RULER + 2 * 16 + 1 + PANEL;

const WIDE_PANEL: u16 = 44;

const FORM: u16 = 22;

const WIDE_FORM: u16 = 40;
const NARROW_FORM: u16 = 32;

const LOW_FORM: u16 = 8;

const LONGEST_FORM: u16 = 18;
const LOW_PANEL: u16 = 10;

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
        let line = |from_bottom: u16| Rect {
            y: area.bottom() - from_bottom,
            height: 1,
            ..area
        };
        let absent = Rect { height: 0, ..area };
        let body = Rect {
            y: area.y + 1,
            height: area.height - 1 - foot,
            ..area
        };
        let title = Rect {
            height: u16::from(area.height > FULL),
            ..body
        };
        let content = below(body, title.height);
        let width = matrix_width(content, imprint, halves);
        let matrix = Rect { width, ..content };
        let left = (matrix.right() + 1).min(content.right());
        let beside = right_of(content, left);
        let (form, form_panel) = form(content, beside);
        Some(Self {
            menu: Rect { height: 1, ..area },
            body,
            title,
            content,
            matrix,
            panel: (is_full && beside.width >= PANEL).then_some(beside),
            form,
            form_panel,
            source: if is_full { line(foot) } else { absent },
            taxel: line(if is_full { 3 } else { 2 }),
            notice: line(2),
            hints: line(1),
        })
    }

    pub fn area(&self, slot: Slot) -> Rect {
        match slot {
            Slot::Screen => Rect {
                height: self.notice.y.saturating_sub(self.body.y),
                ..self.body
            },
            Slot::Body => self.body,
            Slot::Form => self.form,
            Slot::Panel => self.panel.unwrap_or(self.content),
            Slot::Prompt | Slot::Question => self.notice,
        }
    }
}

/// Square taxels come first, as large as there is room for, then smaller ones that show more of the matrix.
fn matrix_width(content: Rect, imprint: &Imprint, halves: bool) -> u16 {
    let beside = |panel: u16| Rect {
        width: content.width.saturating_sub(1 + panel),
        ..content
    };
    let room = if content.width >= BOTH {
        beside(PANEL)
    } else {
        content
    };
    let cells = (imprint.columns(), imprint.rows());
    let fitting = |room: Rect| CellSize::fitting(cells, beside_rulers(room), halves);
    let size = match (fitting(room), fitting(beside(WIDE_PANEL))) {
        (CellSize::Square(_), large @ CellSize::Square(_)) => large,
        (CellSize::Square(_), _) => CellSize::Square(1),
        (small, _) => small,
    };
    (RULER + size.columns() * u16::from(cells.0)).min(room.width)
}

fn form(body: Rect, beside: Rect) -> (Rect, Option<Rect>) {
    if beside.width < FORM {
        let height = LOW_FORM.min(body.height);
        let y = body.bottom() - height;
        return (Rect { y, height, ..body }, None);
    }
    if beside.width > NARROW_FORM + PANEL {
        let panel = (beside.width - 1).saturating_sub(WIDE_FORM);
        let width = beside.width - 1 - panel.clamp(PANEL, WIDE_PANEL);
        let panel = right_of(beside, beside.x + width + 1);
        return (Rect { width, ..beside }, Some(panel));
    }
    if beside.height > LONGEST_FORM + LOW_PANEL && beside.width >= PANEL {
        let height = LONGEST_FORM;
        let panel = below(beside, height + 1);
        return (Rect { height, ..beside }, Some(panel));
    }
    (beside, None)
}
