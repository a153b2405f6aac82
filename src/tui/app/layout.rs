//! What is where on the screen: for drawing, and for finding what the mouse points at.

use ratatui::layout::Rect;

use crate::imprint::Imprint;
use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::form::state::FormDialog;
use crate::tui::keys::binding::{Binding, Context};
use crate::tui::keys::default_keys::{DEFAULT_KEYS, MENU};
use crate::tui::keys::keymap::Keymap;
use crate::tui::widget::columns::narrow;

/// Columns of the row ruler.
pub const RULER: u16 = 3;

/// The panel is not made narrower than this; below, it is a page of its own.
const PANEL: u16 = 30;

/// The room that the panel gets before taxels are made larger.
const WIDE_PANEL: u16 = 44;

/// A form can stand beside the matrix from this width on.
const FORM: u16 = 22;

/// Nothing useful can be shown on less.
pub const SMALLEST: (u16, u16) = (20, 6);

/// The panes of a screen. Lines that there is no room for are empty.
#[derive(Clone, Copy, Debug)]
pub struct Panes {
    /// The options.
    pub menu: Rect,
    /// Everything between the menu and the lines at the foot.
    pub body: Rect,
    /// The matrix with its rulers.
    pub matrix: Rect,
    /// The descriptors, where there is room beside the matrix.
    pub panel: Option<Rect>,
    /// A form: in place of the panel, or over the foot of the matrix.
    pub form: Rect,
    /// What made the imprint.
    pub source: Rect,
    /// The taxel under the cursor.
    pub taxel: Rect,
    /// Notices and questions; the same line as the taxel where there is no room for both.
    pub notice: Rect,
    /// Keys.
    pub hints: Rect,
}

impl Panes {
    /// The panes of the screen as it is.
    pub fn shown(app: &App) -> Option<Self> {
        let (columns, rows) = app.screen;
        Self::of(Rect::new(0, 0, columns, rows), &app.reading().imprint)
    }

    /// The panes of a screen for a matrix; none on a screen that is too small for any.
    pub fn of(area: Rect, imprint: &Imprint) -> Option<Self> {
        if area.width < SMALLEST.0 || area.height < SMALLEST.1 {
            return None;
        }
        let foot = match area.height {
            22.. => 4,
            21 => 3,
            _ => 2,
        };
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
        // Square taxels first; narrow ones only for a matrix that would not fit with square ones at all.
        let beside_panel = |cell: u16| {
            Some(matrix_width(imprint, cell)).filter(|width| width + 1 + PANEL <= area.width)
        };
        let whole = matrix_width(imprint, 2);
        let large = scale(
            imprint,
            body.width.saturating_sub(1 + WIDE_PANEL),
            body.height,
        );
        let large = (large > 1).then(|| matrix_width(imprint, 2 * large));
        let width = large
            .or_else(|| beside_panel(2))
            .or_else(|| beside_panel(1).filter(|_| whole > area.width));
        let left = width.unwrap_or(whole.min(area.width));
        let matrix = Rect {
            width: left,
            ..body
        };
        let beside = Rect {
            x: (matrix.right() + 1).min(body.right()),
            ..body
        };
        let beside = Rect {
            width: body.right() - beside.x,
            ..beside
        };
        let below = body.height.min(8);
        let form = if beside.width >= FORM {
            beside
        } else {
            Rect {
                y: body.bottom() - below,
                height: below,
                ..body
            }
        };
        Some(Self {
            menu: Rect { height: 1, ..area },
            body,
            matrix,
            panel: width.map(|_| beside),
            form,
            source: if foot > 2 { line(foot) } else { absent },
            taxel: line(if foot == 4 { 3 } else { 2 }),
            notice: line(2),
            hints: line(1),
        })
    }
}

/// How many times as large as usual taxels can be so that all of them fit: 1 where they do not fit even so.
fn scale(imprint: &Imprint, width: u16, height: u16) -> u16 {
    let across = width.saturating_sub(RULER) / (2 * u16::from(imprint.columns()));
    let down = height.saturating_sub(1) / u16::from(imprint.rows());
    across.min(down).max(1)
}

/// The width of the whole matrix with its ruler.
fn matrix_width(imprint: &Imprint, cell: u16) -> u16 {
    RULER + cell * u16::from(imprint.columns())
}

/// An option of the menu, and where it stands.
#[derive(Clone, Copy, Debug)]
pub struct MenuItem<'a> {
    /// Its place.
    pub area: Rect,
    /// Its key now, if it has one.
    pub binding: &'a Binding,
    /// What it does.
    pub message: &'static Message,
    /// Its name, which begins with its key but for Help.
    pub name: &'static str,
    /// Whether there is room for the key beside the name.
    pub with_key: bool,
}

/// The options of the menu; those that do not fit are left out.
pub fn menu(area: Rect, keymap: &Keymap) -> Vec<MenuItem<'_>> {
    let with_key = area.width >= 70;
    let rows = || DEFAULT_KEYS.iter().zip(keymap.rows());
    let help = rows().filter(|(row, _)| row.context == Context::Matrix && row.does(&Message::Help));
    let mut x = area.x;
    let mut items = Vec::new();
    for (row, binding) in rows().take(MENU).chain(help) {
        let Some(message) = row.keys.first().and_then(|(_, action)| action.message()) else {
            continue;
        };
        let name = binding.help.split([':', ',']).next().unwrap_or_default();
        let label = binding.short_labels();
        // An option without a key can still be clicked on.
        let key = if label.is_empty() || !with_key && name.to_lowercase().starts_with(&label) {
            0
        } else {
            label.chars().count() + 1
        };
        let width = narrow(key + name.len());
        if x + width > area.right() {
            break;
        }
        items.push(MenuItem {
            area: Rect { x, width, ..area },
            binding,
            message,
            name,
            with_key: key > 0,
        });
        x += width + if with_key { 3 } else { 2 };
    }
    items
}

/// Which part of one axis of the matrix is visible.
#[derive(Clone, Copy, Debug)]
pub struct AxisWindow {
    /// The first cell.
    pub first: u8,
    /// How many.
    pub count: u8,
}

impl AxisWindow {
    /// `cells` of which `room` can be seen, the cursor as near to the middle as the ends allow.
    fn new(cells: u8, room: u16, cursor: u8) -> Self {
        let count = u8::try_from(room).unwrap_or(u8::MAX).min(cells);
        Self {
            first: cursor.saturating_sub(count / 2).min(cells - count),
            count,
        }
    }

    /// The visible cells, each with its place from the first one.
    pub fn visible(&self) -> impl Iterator<Item = (u16, u8)> {
        (0..self.count).map(|index| (u16::from(index), self.first + index))
    }

    fn at(self, place: u16) -> Option<u8> {
        (place < u16::from(self.count)).then(|| self.first + u8::try_from(place).unwrap_or(0))
    }
}

/// Where the taxels are.
#[derive(Clone, Copy, Debug)]
pub struct TaxelGrid {
    /// The column of the screen where the first visible taxel begins.
    pub x: u16,
    /// The row of the screen where it begins.
    pub y: u16,
    /// Columns of the screen that a taxel has: 2 or a multiple, or 1 where the matrix fits only so.
    pub cell: u16,
    /// Rows of the screen that a taxel has.
    pub lines: u16,
    /// Visible columns.
    pub columns: AxisWindow,
    /// Visible rows.
    pub rows: AxisWindow,
    /// Whether all taxels are visible.
    pub whole: bool,
}

impl TaxelGrid {
    /// The taxels of a matrix in its pane, with the cursor at a taxel.
    pub fn of(area: Rect, imprint: &Imprint, cursor: (u8, u8)) -> Self {
        let (columns, rows) = (imprint.columns(), imprint.rows());
        let room = area.width.saturating_sub(RULER);
        let fits_narrow_only = u16::from(columns) > room / 2 && u16::from(columns) <= room;
        let lines = scale(imprint, area.width, area.height);
        let cell = if fits_narrow_only { 1 } else { 2 * lines };
        let columns_seen = AxisWindow::new(columns, room / cell, cursor.0);
        let rows_seen = AxisWindow::new(rows, area.height.saturating_sub(1) / lines, cursor.1);
        let whole = columns_seen.count == columns && rows_seen.count == rows;
        Self {
            x: area.x + RULER.min(area.width),
            y: area.y + 1,
            cell,
            lines,
            columns: columns_seen,
            rows: rows_seen,
            whole,
        }
    }

    /// The taxel at a place of the screen.
    pub fn taxel(&self, x: u16, y: u16) -> Option<(u8, u8)> {
        let (x, y) = (x.checked_sub(self.x)?, y.checked_sub(self.y)?);
        Some((
            self.columns.at(x / self.cell)?,
            self.rows.at(y / self.lines)?,
        ))
    }
}

/// Where the lines of a form are.
#[derive(Clone, Copy, Debug)]
pub struct FormRows {
    /// The line of the kind, where there is one.
    pub kind: Option<u16>,
    head: u16,
    /// Lines a field has: two where there is room for an error under it.
    pub spacing: u16,
    first: usize,
    visible: usize,
}

impl FormRows {
    /// The lines of a form in its pane; the field that has the focus is visible.
    pub fn of(area: Rect, dialog: &FormDialog) -> Self {
        let fields = dialog.form().fields().len();
        let head = 1 + u16::from(dialog.kind().is_some());
        let spacing = if area.height >= head + 2 * narrow(fields) {
            2
        } else {
            1
        };
        let visible = usize::from(area.height.saturating_sub(head) / spacing);
        let first = dialog
            .form()
            .focus()
            .map_or(0, |focus| (focus + 1).saturating_sub(visible));
        Self {
            kind: dialog.kind().map(|_| 1),
            head,
            spacing,
            first,
            visible,
        }
    }

    /// The visible fields, by number, each with its line from the top of the pane.
    pub fn fields(&self, count: usize) -> impl Iterator<Item = (usize, u16)> {
        let rows = *self;
        (rows.first..count.min(rows.first + rows.visible))
            .map(move |index| (index, rows.head + narrow(index - rows.first) * rows.spacing))
    }
}

/// How many lines of a list there are above its first row.
pub const LIST_HEAD: u16 = 2;

/// The list's pane and, where there is room, that of the preview.
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

/// The first row of a list that is visible.
pub fn list_first(area: Rect, rows: usize, selected: usize) -> usize {
    first_of(area.height.saturating_sub(LIST_HEAD), rows, selected)
}

/// The first of so many rows, of which some are visible, the selected one as near to the middle as the ends allow.
pub(in crate::tui) fn first_of(visible: u16, rows: usize, selected: usize) -> usize {
    let visible = usize::from(visible);
    selected
        .saturating_sub(visible / 2)
        .min(rows.saturating_sub(visible))
}

/// The part of an area that begins so many lines below its top.
pub fn below(area: Rect, lines: u16) -> Rect {
    let lines = lines.min(area.height);
    Rect {
        y: area.y + lines,
        height: area.height - lines,
        ..area
    }
}
