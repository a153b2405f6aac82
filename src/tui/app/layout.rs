//! The panes of the screen, for drawing and for finding what the mouse points at.
//!
//! The panel stands beside the matrix where both fit, and on a screen that is wide enough for the default sensor also
//! beside a larger one, of which a part is seen; otherwise each is a page of its own. Taxels are enlarged only where
//! the panel keeps all its room. See [`crate::tui::app::view`] for a picture.

use ratatui::layout::Rect;

use crate::description::DESCRIPTORS;
use crate::imprint::Imprint;
use crate::tui::app::page::Slot;
use crate::tui::matrix::layout::{RULER, TaxelSize};
use crate::tui::widget::write::{below, right_of};

/// The panel is not made narrower than this; below, it is a page of its own.
const PANEL: u16 = 30;

/// A column of descriptors with the longest values is as wide as this, where they stand in several columns.
const LONGEST_VALUES: usize = 23;

/// From this width on the panel stands beside every matrix: the default sensor fits there.
const BOTH: u16 = RULER + 2 * 16 + 1 + PANEL;

/// The room that the panel gets before taxels are made larger.
const WIDE_PANEL: u16 = 44;

/// A form can stand beside the matrix from this width on.
const FORM: u16 = 22;

/// A form gets this width beside the descriptors where there is room for it.
const WIDE_FORM: u16 = 40;
/// It gets this width at least: then ranges stand under the fields.
const NARROW_FORM: u16 = 32;

/// Lines of a form over the foot of the matrix.
const LOW_FORM: u16 = 8;

/// Lines of a form above the descriptors.
const LONGEST_FORM: u16 = 18;
/// Lines that the descriptors below it need at least.
const LOW_PANEL: u16 = 10;

/// From this many lines on there is one for the title: neither descriptors nor the default sensor lose any.
const TITLED: u16 = 24;

/// Nothing useful can be shown on less.
pub const SMALLEST: (u16, u16) = (20, 6);

/// The panes of a screen. Lines that there is no room for are empty.
#[derive(Clone, Copy, Debug)]
pub struct Panes {
    /// The options.
    pub menu: Rect,
    /// Everything between the menu and the lines at the foot.
    pub body: Rect,
    /// The sensor and the name, above the matrix; empty on a low screen. Pages over the whole body cover it.
    pub title: Rect,
    /// The body below the title.
    pub content: Rect,
    /// The matrix with its rulers.
    pub matrix: Rect,
    /// The descriptors, where there is room beside the matrix.
    pub panel: Option<Rect>,
    /// Whether they have room for all their values there.
    pub is_panel_roomy: bool,
    /// A form: in place of the panel, or over the foot of the matrix.
    pub form: Rect,
    /// The descriptors while a form is open, where there is room for both.
    pub form_panel: Option<Rect>,
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
    /// The panes of a screen for a matrix, of which two taxels may share a character where `halves` says so; none on a
    /// screen that is too small for any.
    pub fn of(area: Rect, imprint: &Imprint, halves: bool) -> Option<Self> {
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
        let title = Rect {
            height: u16::from(area.height >= TITLED),
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
            panel: (beside.width >= PANEL).then_some(beside),
            is_panel_roomy: is_roomy(beside),
            form,
            form_panel,
            source: if foot > 2 { line(foot) } else { absent },
            taxel: line(if foot == 4 { 3 } else { 2 }),
            notice: line(2),
            hints: line(1),
        })
    }

    /// The area of a slot.
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

/// The width of the matrix in the content of a screen: what is left of it is for the panel, or too little for that.
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
    let fitting = |room: Rect| TaxelSize::fitting(imprint, room, halves);
    let size = match (fitting(room), fitting(beside(WIDE_PANEL))) {
        (TaxelSize::Square(_), large @ TaxelSize::Square(_)) => large,
        (TaxelSize::Square(_), _) => TaxelSize::Square(1),
        (small, _) => small,
    };
    size.matrix_width(imprint).min(room.width)
}

/// Whether the descriptors have room for the longest values below their heading. On a low screen they need several columns.
fn is_roomy(panel: Rect) -> bool {
    let lines = usize::from(panel.height.saturating_sub(1)).max(1);
    match DESCRIPTORS.len().div_ceil(lines) {
        1 => true,
        columns => usize::from(panel.width) >= columns * LONGEST_VALUES,
    }
}

/// The area of a form: beside the matrix, over its foot where there is too little room, or over all of it; and that of the
/// descriptors, where they fit beside the form or below it.
fn form(body: Rect, beside: Rect) -> (Rect, Option<Rect>) {
    if beside.width < FORM {
        // Where less than the ruler and two lines of the matrix would be left, it is hidden.
        let height = if body.height < LOW_FORM + 3 {
            body.height
        } else {
            LOW_FORM
        };
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
