//! Layers over the taxels: the true outline of the source, and the circumscribed rectangle with CG and CD.
//!
//! Lines are drawn in dots finer than characters. Over an active taxel they are reversed, so that the taxel differs
//! from an inactive one even without colour. A number of two digits is never covered in part: lines leave it out, and
//! a letter replaces it.

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::{Position, Rect};
use ratatui::style::Modifier;
use taxel_core::description::Description;
use taxel_core::geometry::{Ellipse, Pen, Point, Side, Solid};
use taxel_core::recognition::PlacedSource;
use taxel_core::source::Source;

use crate::tui::matrix::layout::TaxelGrid;
use crate::tui::widget::plot::{DOTS, DotCanvas, DotPosition, glyph};
use crate::tui::widget::theme::{Role, Theme};

/// The number of straight pieces that an ellipse is drawn in: even on the largest matrix, none is off by a dot.
const PIECES: u16 = 256;

const INSIDE: f64 = 0.25;

/// None shows a layer only where taxels are large.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers {
    pub outline: Option<bool>,
    pub rectangle: Option<bool>,
}

impl Layers {
    pub fn shown(layer: Option<bool>, grid: &TaxelGrid) -> bool {
        layer.unwrap_or(grid.size.is_large())
    }
}

fn is_digit(cell: &Cell) -> bool {
    cell.symbol()
        .starts_with(|first: char| first.is_ascii_digit())
}

/// A large taxel has spaces around its number.
fn erase_number(buffer: &mut Buffer, place: Position) {
    for x in place.x.saturating_sub(1)..=place.x.saturating_add(1) {
        if let Some(cell) = buffer.cell_mut(Position::new(x, place.y))
            && is_digit(cell)
        {
            cell.set_char(' ');
        }
    }
}

struct DotGrid<'a> {
    grid: &'a TaxelGrid,
    /// The dots set so far.
    canvas: DotCanvas,
    by: [f64; 2],
    faint: bool,
}

impl<'a> DotGrid<'a> {
    fn new(grid: &'a TaxelGrid) -> Self {
        let (columns, lines) = grid.characters();
        Self {
            grid,
            canvas: DotCanvas::new(columns, lines),
            by: [0.0; 2],
            faint: false,
        }
    }

    fn stroke(&mut self, from: DotPosition, to: DotPosition) {
        let faint = self.faint;
        // Which dots are set depends on their place, so that short pieces of a curve are as faint as a long line.
        let start = from.0 + from.1;
        self.canvas.dashed(from, to, |step| {
            !faint || (start + f64::from(step)).rem_euclid(3.0) < 1.0
        });
    }

    fn dots(&self) -> (u16, u16) {
        let size = self.grid.size;
        (size.columns() * DOTS.0, size.half_lines() * DOTS.1 / 2)
    }

    fn position(&self, x: f64, y: f64) -> DotPosition {
        let (across, down) = self.dots();
        let (left, top) = (self.grid.columns.first, self.grid.rows.first);
        (
            (x + self.by[0] - f64::from(left)) * f64::from(across),
            (y + self.by[1] - f64::from(top)) * f64::from(down),
        )
    }
}

impl Pen<f64> for DotGrid<'_> {
    fn edge(&mut self, from: Point<f64>, to: Point<f64>) {
        let (from, to) = (self.position(from.x, from.y), self.position(to.x, to.y));
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = libm::hypot(dx, dy);
        if length > 0.0 {
            let aside = (-dy / length * INSIDE, dx / length * INSIDE);
            let moved = |place: DotPosition| (place.0 + aside.0, place.1 + aside.1);
            self.stroke(moved(from), moved(to));
        }
    }

    fn ellipse(&mut self, ellipse: &Ellipse<f64>, material: Side) {
        let reach = ellipse.reach();
        let dots = reach.x.max(reach.y) * f64::from(self.dots().0);
        let scale = match material {
            Side::Inside => 1.0 - INSIDE / dots.max(1.0),
            Side::Outside => 1.0 + INSIDE / dots.max(1.0),
        };
        let at = |piece: u16| {
            let (sin, cos) =
                libm::sincos(std::f64::consts::TAU * f64::from(piece) / f64::from(PIECES));
            let along = |centre: f64, a: f64, b: f64| centre + scale * (a * cos + b * sin);
            self.position(
                along(ellipse.centre.x, ellipse.across.x, ellipse.along.x),
                along(ellipse.centre.y, ellipse.across.y, ellipse.along.y),
            )
        };
        let places: Vec<DotPosition> = (0..=PIECES).map(at).collect();
        for pair in places.windows(2) {
            self.stroke(pair[0], pair[1]);
        }
    }
}

pub(in crate::tui) struct Overlay<'a> {
    pub outline: Option<&'a Source>,
    pub region: Option<Description>,
    pub poses: &'a [PlacedSource],
}

impl Overlay<'_> {
    pub(in crate::tui) fn draw(
        &self,
        grid: &TaxelGrid,
        theme: &Theme,
        buffer: &mut Buffer,
        active: impl Fn(u8, u8) -> bool,
    ) {
        let mut dots = DotGrid::new(grid);
        if let Some(region) = &self.region {
            draw_rectangle(&mut dots, region);
        }
        if let Some(source) = self.outline {
            source.draw(&mut dots);
        }
        for (index, placed) in self.poses.iter().enumerate() {
            (dots.by, dots.faint) = (placed.by, index > 0);
            placed.source.draw(&mut dots);
        }
        (dots.by, dots.faint) = ([0.0; 2], false);
        for (column, row, shape) in dots.canvas.characters() {
            let place = Position::new(grid.x + column, grid.y + row);
            let Some(cell) = buffer.cell_mut(place) else {
                continue;
            };
            if grid.size.is_large() && is_digit(cell) {
                continue;
            }
            let on = grid.taxels(place.x, place.y).any(|(x, y)| active(x, y));
            let style = if on {
                theme.style(Role::Chosen).add_modifier(Modifier::REVERSED)
            } else {
                theme.style(Role::Text)
            };
            cell.reset();
            cell.set_char(glyph(theme, shape)).set_style(style);
        }
        for (place, letter) in self.centres(&dots, *buffer.area()) {
            if grid.size.is_large() && buffer.cell(place).is_some_and(is_digit) {
                erase_number(buffer, place);
            }
            if let Some(cell) = buffer.cell_mut(place) {
                cell.reset();
                cell.set_char(letter).set_style(theme.style(Role::Focus));
            }
        }
    }

    fn centres(&self, dots: &DotGrid<'_>, screen: Rect) -> impl Iterator<Item = (Position, char)> {
        let at = |x: f64, y: f64| character_at(dots, (x, y), screen);
        let cg = self.region.map(|region| region.cg());
        let cd = self.region.map(|region| region.cd());
        let cg = cg.and_then(|cg| at(cg.x, cg.y));
        let cd = cd.and_then(|cd| at(cd.x, cd.y));
        let aside = u16::from(cg == cd);
        let cd = cd.map(|place| (Position::new(place.x + aside, place.y), 'D'));
        cd.into_iter().chain(cg.map(|place| (place, 'G')))
    }
}

fn draw_rectangle(dots: &mut DotGrid<'_>, region: &Description) {
    let rect = region.rect;
    let (left, top) = dots.position(rect.left.into(), rect.top.into());
    let (right, bottom) = dots.position(rect.right.into(), rect.bottom.into());
    let (right, bottom) = (right - INSIDE, bottom - INSIDE);
    let shown = |step: u32| step % 4 < 2;
    for y in [top, bottom] {
        dots.canvas.dashed((left, y), (right, y), shown);
    }
    for x in [left, right] {
        dots.canvas.dashed((x, top), (x, bottom), shown);
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "within the screen"
)]
fn character_at(dots: &DotGrid<'_>, (x, y): DotPosition, screen: Rect) -> Option<Position> {
    let ((x, y), (width, height)) = (dots.position(x, y), dots.canvas.size());
    let visible = x >= 0.0 && y >= 0.0 && x < width && y < height;
    let place = visible.then(|| {
        let (x, y) = (x as u16 / DOTS.0, y as u16 / DOTS.1);
        Position::new(dots.grid.x + x, dots.grid.y + y)
    });
    place.filter(|&place| screen.contains(place))
}
