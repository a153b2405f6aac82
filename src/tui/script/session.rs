//! The program without a terminal: keys in as text, the screen out as text, the same on every machine.
//!
//! Keys use the same table, the same update and the same view as in a terminal. The screen is drawn only when it is
//! read: a terminal, too, shows the effect of several keys only after all of them are handled.
//!
//! ```
//! use taxel::tui::app::state::Options;
//! use taxel::tui::jobs::Jobs;
//! use taxel::tui::script::Session;
//! let mut session = Session::new(&Options::plain(true), Jobs::scratch()?, 80, 24);
//! session.keys("f<Enter>")?;
//! assert!(session.screen().contains("ellipse rx 4.00 ry 4.00 at 4.00, 4.00, 0 deg"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::fmt::Write as _;
use std::sync::Arc;

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::{Position, Rect};
use ratatui::style::{Color, Modifier};
use taxel_files::formats::value::escaped;

use crate::tui::app::unsaved::offer;
use crate::tui::app::update::update;
use crate::tui::app::view::draw;
use crate::tui::app::{App, Message, Options};
use crate::tui::jobs::Jobs;
use crate::tui::keys::{Key, KeyError, parse};
use crate::tui::live::update::{arrived, last_page};
use crate::tui::live::{LiveMessage, NamedSource, SourceState};
use crate::tui::widget::write::narrow;
use crate::tui::widget::{Palette, Theme, letter, write};

#[derive(Debug)]
pub struct Session {
    app: App,
    /// Columns and rows.
    size: (u16, u16),
}

impl Session {
    pub fn new(options: &Options, world: Jobs, width: u16, height: u16) -> Self {
        Self::of(App::new(options), world, width, height)
    }

    pub fn of(mut app: App, world: Jobs, width: u16, height: u16) -> Self {
        app.jobs = world;
        let size = (width, height);
        let mut session = Self { app, size };
        session.send(Message::Resized(width, height));
        offer(&mut session.app);
        session
    }

    pub fn keys(&mut self, text: &str) -> Result<(), KeyError> {
        for key in parse(text)? {
            self.press(key);
        }
        Ok(())
    }

    pub fn press(&mut self, key: Key) {
        self.send(self.app.meaning(key));
    }

    pub fn send(&mut self, message: Message) {
        // Effects on a real terminal are ignored.
        let _ = update(&mut self.app, message);
    }

    /// Applies an act like the answer of a job.
    pub fn answer(&mut self, act: impl FnOnce(&mut App) + Send + 'static) {
        self.app.jobs.later(act);
        self.send(Message::Answered);
    }

    /// Watches a source of frames; reads no frame yet.
    pub fn watch(&mut self, name: &str) -> Result<(), String> {
        let number = |app: &App| last_page(app).map(|page| page.number);
        let before = number(&self.app);
        let source = Box::new(NamedSource::new(name));
        self.send(Message::Live(LiveMessage::Source(source)));
        if number(&self.app) != before {
            return Ok(());
        }
        Err(match &self.app.notice {
            Some(said) if said.is_refusal => said.text.clone(),
            _ => format!("{name}: no source can be watched on this page"),
        })
    }

    pub fn frames(&mut self, count: usize) -> usize {
        let mut frames = 0;
        let access = Arc::clone(&self.app.jobs.access);
        let (number, batches) = self.app.jobs.sources.next(count, &access);
        for batch in batches {
            frames += batch.frames.len();
            self.answer(move |app| arrived(app, number, &batch));
        }
        frames
    }

    pub(super) fn end_of_frames(&self) -> String {
        let page = last_page(&self.app).filter(|page| !page.stopped);
        match page.map(|page| &page.status.state) {
            None => "no source is watched".to_owned(),
            Some(SourceState::Failed(reason)) => reason.clone(),
            Some(_) => "the source has ended".to_owned(),
        }
    }

    /// Changes the size of the screen.
    pub fn resize(&mut self, width: u16, height: u16) {
        self.size = (width, height);
        self.send(Message::Resized(width, height));
    }

    /// Draws the screen; also returns the position of the cursor, None if it is hidden.
    fn drawn(&self) -> (Buffer, Option<Position>) {
        let mut buffer = Buffer::empty(Rect::new(0, 0, self.size.0, self.size.1));
        let cursor = draw(&self.app, &mut buffer);
        (buffer, cursor)
    }

    pub fn app(&self) -> &App {
        &self.app
    }

    pub fn size(&self) -> (u16, u16) {
        self.size
    }

    /// Returns the position of the cursor; None if it is hidden.
    pub fn cursor(&self) -> Option<Position> {
        self.drawn().1
    }

    pub fn screen(&self) -> String {
        self.rows(|cell, row| row.push_str(cell.symbol()))
    }

    /// Returns the styles of the screen, one letter per character: `R` reversed, `B` bold, `D` dim, `.` plain.
    pub fn styles(&self) -> String {
        self.rows(|cell, row| row.push(letter(&cell.style())))
    }

    pub fn svg(&self, title: &str) -> String {
        svg(&self.drawn().0, self.app.theme, title)
    }

    fn rows(&self, add: impl Fn(&Cell, &mut String)) -> String {
        let (buffer, _) = self.drawn();
        let mut rows = String::with_capacity(buffer.content.len());
        for row in lines(&buffer) {
            let start = rows.len();
            characters(row).for_each(|(_, cell)| add(cell, &mut rows));
            rows.truncate(start + rows[start..].trim_end().len());
            rows.push('\n');
        }
        rows
    }
}

fn lines(buffer: &Buffer) -> impl Iterator<Item = &[Cell]> {
    let width = usize::from(buffer.area.width).max(1);
    buffer.content.chunks(width)
}

/// Returns the cells of a row with their columns, without those that a wide character before them covers.
fn characters(row: &[Cell]) -> impl Iterator<Item = (usize, &Cell)> {
    let mut free = 0;
    row.iter().enumerate().filter(move |(column, cell)| {
        let begins = *column >= free;
        if begins {
            free = column + write::width(cell.symbol());
        }
        begins
    })
}

const WIDTH: u32 = 9;
const HEIGHT: u32 = 18;
const FONT: u32 = 15;
const BASE: u32 = 14;
const MARGIN: u32 = 12;

#[derive(Clone, Copy, PartialEq, Eq)]
struct TextStyle {
    ink: [u8; 3],
    paper: [u8; 3],
    bold: bool,
    dim: bool,
}

fn colors(palette: Palette) -> ([u8; 3], [u8; 3]) {
    match palette {
        Palette::Dark => ([212, 212, 212], [28, 28, 28]),
        Palette::Light | Palette::Mono => ([32, 32, 32], [255, 255, 255]),
    }
}

/// Draws a screen as SVG; its title is for people who cannot see it.
///
/// The same bytes on every machine. Block characters are drawn as rectangles, so that taxels join in any font. A run of
/// one style is one element that is stretched to its columns, so that columns stay aligned in any font, too.
pub(in crate::tui) fn svg(buffer: &Buffer, theme: Theme, title: &str) -> String {
    let (ink, paper) = colors(theme.palette);
    let area = buffer.area;
    let width = u32::from(area.width) * WIDTH + 2 * MARGIN;
    let height = u32::from(area.height) * HEIGHT + 2 * MARGIN;
    let (fore, back, title) = (hex(ink), hex(paper), escaped(title));
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\" shape-rendering=\"crispEdges\">\n<title>{title}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" rx=\"6\" fill=\"{back}\"/>\n\
         <g transform=\"translate({MARGIN} {MARGIN})\" font-size=\"{FONT}\" fill=\"{fore}\" \
         font-family=\"'DejaVu Sans Mono', 'Noto Sans Mono', Menlo, Consolas, monospace\">\n"
    );
    for (row, cells) in (0..).zip(lines(buffer)) {
        let mut runs: Vec<(u16, TextStyle, Vec<&str>)> = Vec::new();
        for (column, cell) in characters(cells) {
            let look = TextStyle::of(cell, ink, paper);
            if runs.last().is_none_or(|(_, last, _)| *last != look) {
                runs.push((narrow(column), look, Vec::new()));
            }
            if let Some((.., symbols)) = runs.last_mut() {
                let covered = write::width(cell.symbol()).saturating_sub(1);
                symbols.push(cell.symbol());
                symbols.extend(std::iter::repeat_n("", covered));
            }
        }
        for (column, look, symbols) in runs {
            draw_run(&mut svg, (column, row), look, paper, &symbols);
        }
    }
    svg + "</g>\n</svg>\n"
}

impl TextStyle {
    /// Returns the style of a cell; in reversed cells, ink and paper are exchanged.
    fn of(cell: &Cell, ink: [u8; 3], paper: [u8; 3]) -> Self {
        let color = |color: Color, other: [u8; 3]| match color {
            Color::Rgb(red, green, blue) => [red, green, blue],
            _ => other,
        };
        let (mut ink, mut paper) = (color(cell.fg, ink), color(cell.bg, paper));
        let has = |modifier| cell.modifier.contains(modifier);
        if has(Modifier::REVERSED) {
            (ink, paper) = (paper, ink);
        }
        Self {
            ink,
            paper,
            bold: has(Modifier::BOLD),
            dim: has(Modifier::DIM),
        }
    }
}

fn units(columns: usize) -> u32 {
    u32::from(narrow(columns)) * WIDTH
}

/// Draws a run of characters: the paper if it differs from the screen's, the blocks, then the text.
fn draw_run(
    svg: &mut String,
    (column, row): (u16, u16),
    look: TextStyle,
    paper: [u8; 3],
    symbols: &[&str],
) {
    let (x, y) = (u32::from(column) * WIDTH, u32::from(row) * HEIGHT);
    if look.paper != paper {
        rectangle(svg, (x, y), (units(symbols.len()), HEIGHT), look.paper, 4);
    }
    let mut at = 0;
    while let Some(symbol) = symbols.get(at) {
        let alike = symbols[at..].iter().take_while(|other| *other == symbol);
        let alike = alike.count();
        if let Some((down, high, quarters)) = block(symbol) {
            let (left, wide) = (x + units(at), units(alike));
            let quarters = if look.dim { quarters.min(2) } else { quarters };
            rectangle(svg, (left, y + down), (wide, high), look.ink, quarters);
        }
        at += alike;
    }
    let bold = if look.bold {
        " font-weight=\"bold\""
    } else {
        ""
    };
    let dim = if look.dim { " opacity=\"0.6\"" } else { "" };
    let style = format!(" fill=\"{}\"{bold}{dim}", hex(look.ink));
    for (from, text) in pieces(symbols) {
        let length = write::width(&text);
        let (x, y, length) = (x + units(from), y + BASE, units(length));
        // Writing to a String cannot fail.
        let _ = writeln!(
            svg,
            "<text x=\"{x}\" y=\"{y}\" textLength=\"{length}\" lengthAdjust=\"spacingAndGlyphs\" \
             xml:space=\"preserve\"{style}>{}</text>",
            escaped(&text)
        );
    }
}

/// Returns the texts of a run with their first columns. Two blanks separate texts: columns stay aligned even if a
/// viewer has no font of fixed width and does not stretch.
fn pieces(symbols: &[&str]) -> Vec<(usize, String)> {
    let mut pieces: Vec<(usize, String)> = Vec::new();
    let mut blanks = usize::MAX;
    for (column, &symbol) in symbols.iter().enumerate() {
        if symbol.is_empty() {
            continue;
        }
        if symbol.trim().is_empty() || block(symbol).is_some() {
            blanks = blanks.saturating_add(1);
            continue;
        }
        match pieces.last_mut() {
            Some((_, text)) if blanks < 2 => {
                text.extend((0..blanks).map(|_| ' '));
                text.push_str(symbol);
            }
            _ => pieces.push((column, symbol.to_owned())),
        }
        blanks = 0;
    }
    pieces
}

/// Returns the rectangle of a block character: its distance from the top, its height, and its ink in quarters.
fn block(symbol: &str) -> Option<(u32, u32, u8)> {
    let half = HEIGHT / 2;
    match symbol {
        "█" => Some((0, HEIGHT, 4)),
        "▓" => Some((0, HEIGHT, 3)),
        "▒" => Some((0, HEIGHT, 2)),
        "░" => Some((0, HEIGHT, 1)),
        "▀" => Some((0, half, 4)),
        "▄" => Some((half, half, 4)),
        _ => None,
    }
}

fn rectangle(
    svg: &mut String,
    (x, y): (u32, u32),
    (width, height): (u32, u32),
    color: [u8; 3],
    quarters: u8,
) {
    let fill = hex(color);
    let share = match quarters {
        4 => String::new(),
        quarters => format!(" opacity=\"{}\"", f64::from(quarters) / 4.0),
    };
    // Writing to a String cannot fail.
    let _ = writeln!(
        svg,
        "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\"{share}/>"
    );
}

fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use ratatui::style::Style;

    use super::*;

    #[test]
    fn a_run_is_one_text_and_blocks_are_rectangles() {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 8, 2));
        buffer.set_string(0, 0, " a<b", Style::new());
        buffer.set_string(0, 1, "1   2 3", Style::new());
        buffer.set_string(4, 0, "██▀", Style::new().fg(Color::Rgb(1, 2, 3)));
        buffer.set_string(7, 0, "x", Style::new().add_modifier(Modifier::REVERSED));
        let svg = svg(&buffer, Theme::plain(false), "a & b");
        for part in [
            "<title>a &amp; b</title>",
            "<text x=\"9\" y=\"14\" textLength=\"27\" lengthAdjust=\"spacingAndGlyphs\" xml:space=\"preserve\" \
             fill=\"#202020\">a&lt;b</text>",
            "<rect x=\"36\" y=\"0\" width=\"18\" height=\"18\" fill=\"#010203\"/>",
            "<rect x=\"54\" y=\"0\" width=\"9\" height=\"9\" fill=\"#010203\"/>",
            "<rect x=\"63\" y=\"0\" width=\"9\" height=\"18\" fill=\"#202020\"/>",
            "fill=\"#ffffff\">x</text>",
            "<text x=\"0\" y=\"32\" textLength=\"9\" ",
            "<text x=\"36\" y=\"32\" textLength=\"27\" ",
            ">2 3</text>",
        ] {
            assert!(svg.contains(part), "no {part}\n{svg}");
        }
        assert_eq!(svg.matches("<text").count(), 4);
        // The text under a wide character is not drawn.
        let mut buffer = Buffer::empty(Rect::new(0, 0, 6, 1));
        buffer.set_string(0, 0, "foobar", Style::new());
        buffer[(0, 0)].set_symbol("字");
        buffer[(2, 0)].set_symbol("字");
        let svg = super::svg(&buffer, Theme::plain(false), "");
        assert!(
            svg.contains("textLength=\"54\"") && svg.contains(">字字ar</text>"),
            "{svg}"
        );
    }
}
