//! Layers over the taxels: the true outline of the source, that of the shape that was fitted to the imprint, and the
//! circumscribed rectangle with CG and CD.
//!
//! Lines are drawn in dots finer than characters. Over an active taxel they are reversed, so that the taxel differs
//! from an inactive one even without colour. A number of two digits is never covered in part: lines leave it out, and
//! a letter replaces it.

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::Position;
use ratatui::style::Modifier;
use taxel_core::description::Description;
use taxel_core::geometry::{Ellipse, Pen, Point, Side, Solid};

use crate::tui::app::App;
use crate::tui::grid::Grid;
use crate::tui::widget::write::narrow;
use crate::tui::widget::{DOTS, DotCanvas, DotPosition, Role, glyph};

/// The number of straight pieces that an ellipse is drawn in: even on the largest matrix, none is off by a dot.
const PIECES: u16 = 256;

/// How far inside of the material its edge is drawn, in dots: an edge between two taxels belongs to its own side.
const INSIDE: f64 = 0.25;

/// None shows a layer only where taxels are large.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Layers {
    pub outline: Option<bool>,
    pub rectangle: Option<bool>,
    pub fit: Option<bool>,
}

impl Layers {
    pub fn shown(layer: Option<bool>, grid: &Grid) -> bool {
        layer.unwrap_or(grid.size.is_large())
    }
}

pub fn draw(app: &App, grid: &Grid, buffer: &mut Buffer) {
    let (theme, reading) = (&app.theme, app.reading());
    let shown = |layer| Layers::shown(layer, grid);
    let region = reading.description(app.chosen());
    let region = region.filter(|_| shown(app.layers.rectangle));
    let (columns, lines) = grid.characters();
    let mut dots = Dots {
        grid,
        canvas: DotCanvas::new(columns, lines),
    };
    if let Some(region) = &region {
        dots.rectangle(region);
    }
    if let Some(source) = &app.shown().source
        && shown(app.layers.outline)
    {
        source.draw(&mut dots);
    }
    let fitted = app.recognising().and_then(|own| own.fitted.as_ref());
    if let Some(source) = fitted.filter(|_| shown(app.layers.fit)) {
        source.draw(&mut dots);
    }
    let is_number = |cell: &Cell| grid.size.is_large() && is_digit(cell);
    for (column, row, shape) in dots.canvas.characters() {
        let place = Position::new(grid.x + column, grid.y + row);
        let Some(cell) = buffer.cell_mut(place).filter(|cell| !is_number(cell)) else {
            continue;
        };
        let mut taxels = grid.at(place.x, place.y);
        let style = if taxels.any(|(column, row)| reading.imprint.get(column, row)) {
            theme.style(Role::Chosen).add_modifier(Modifier::REVERSED)
        } else {
            theme.style(Role::Text)
        };
        cell.reset();
        cell.set_char(glyph(theme, shape)).set_style(style);
    }
    let [cg, cd] = region.map_or([None; 2], |region| {
        [region.cg(), region.cd()].map(|at| dots.character(at.x, at.y))
    });
    let aside = u16::from(cg == cd);
    let cd = cd.map(|place| Position::new(place.x + aside, place.y));
    for (place, letter) in [(cd, 'D'), (cg, 'G')] {
        let Some(place) = place.filter(|place| buffer.area().contains(*place)) else {
            continue;
        };
        if is_number(&buffer[place]) {
            // The other digit stands beside it, and blanks beside both.
            for x in [place.x.saturating_sub(1), place.x + 1] {
                if let Some(cell) = buffer.cell_mut((x, place.y))
                    && is_digit(cell)
                {
                    cell.set_char(' ');
                }
            }
        }
        let cell = &mut buffer[place];
        cell.reset();
        cell.set_char(letter).set_style(theme.style(Role::Focus));
    }
}

fn is_digit(cell: &Cell) -> bool {
    cell.symbol()
        .starts_with(|first: char| first.is_ascii_digit())
}

struct Dots<'a> {
    grid: &'a Grid,
    canvas: DotCanvas,
}

impl Dots<'_> {
    /// The dots of a taxel, across and down.
    fn scale(&self) -> DotPosition {
        let size = self.grid.size;
        let (across, down) = (size.columns() * DOTS.0, size.half_lines() * DOTS.1 / 2);
        (across.into(), down.into())
    }

    fn position(&self, x: f64, y: f64) -> DotPosition {
        let (across, down) = self.scale();
        let (left, top) = (self.grid.columns.first, self.grid.rows.first);
        ((x - f64::from(left)) * across, (y - f64::from(top)) * down)
    }

    /// Returns the character at a point of the visible taxels.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "within the screen"
    )]
    fn character(&self, x: f64, y: f64) -> Option<Position> {
        let ((x, y), (width, height)) = (self.position(x, y), self.canvas.size());
        let visible = x >= 0.0 && y >= 0.0 && x < width && y < height;
        let (x, y) = (narrow(x as u32) / DOTS.0, narrow(y as u32) / DOTS.1);
        visible.then(|| Position::new(self.grid.x + x, self.grid.y + y))
    }

    fn rectangle(&mut self, region: &Description) {
        let rect = region.rect;
        let (left, top) = self.position(rect.left.into(), rect.top.into());
        let (right, bottom) = self.position(rect.right.into(), rect.bottom.into());
        let (right, bottom) = (right - INSIDE, bottom - INSIDE);
        let shown = |step: u32| step % 4 < 2;
        for y in [top, bottom] {
            self.canvas.dashed((left, y), (right, y), shown);
        }
        for x in [left, right] {
            self.canvas.dashed((x, top), (x, bottom), shown);
        }
    }
}

impl Pen<f64> for Dots<'_> {
    fn edge(&mut self, from: Point<f64>, to: Point<f64>) {
        let (from, to) = (self.position(from.x, from.y), self.position(to.x, to.y));
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = libm::hypot(dx, dy);
        if length > 0.0 {
            let (x, y) = (dx / length * INSIDE, dy / length * INSIDE);
            // Also from the corners, which would leave a dot beside the material.
            let from = (from.0 - y + x, from.1 + x + y);
            let to = (to.0 - y - x, to.1 + x - y);
            self.canvas.line(from, to);
        }
    }

    fn ellipse(&mut self, ellipse: &Ellipse<f64>, material: Side) {
        let reach = ellipse.reach();
        let inside = INSIDE / (reach.x.max(reach.y) * self.scale().0).max(1.0);
        let scale = match material {
            Side::Inside => 1.0 - inside,
            Side::Outside => 1.0 + inside,
        };
        let at = |piece: u16| {
            let turn = std::f64::consts::TAU * f64::from(piece) / f64::from(PIECES);
            let (sin, cos) = libm::sincos(turn);
            let along = |centre: f64, a: f64, b: f64| centre + scale * (a * cos + b * sin);
            self.position(
                along(ellipse.centre.x, ellipse.across.x, ellipse.along.x),
                along(ellipse.centre.y, ellipse.across.y, ellipse.along.y),
            )
        };
        let places: Vec<DotPosition> = (0..=PIECES).map(at).collect();
        for pair in places.windows(2) {
            self.canvas.line(pair[0], pair[1]);
        }
    }
}
