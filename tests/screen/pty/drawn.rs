//! Screens as text for comparison: what the program intends to show, and what a terminal makes of its bytes.

use std::fmt::Write as _;
use std::num::NonZeroU16;

use taxel::tui::script::Session;
use taxel::tui::widget::theme;

pub(crate) fn emulator(columns: u16, rows: u16) -> vt100::Parser {
    vt100::Parser::new(side(rows), side(columns), 0)
}

pub(crate) fn side(number: u16) -> NonZeroU16 {
    NonZeroU16::new(number).expect("not empty")
}

/// Returns a screen as text: the rows, the styles of everything that is not blank, the cursor.
pub(crate) fn of_session(session: &Session) -> String {
    let mut text = String::new();
    for (row, styles) in session.screen().lines().zip(session.styles().lines()) {
        // Blanks at the end of a row are cut off, but they may be reversed.
        let row = row.chars().chain(std::iter::repeat(' '));
        let cells: Vec<(char, char)> = row.zip(styles.chars()).collect();
        write_row(&mut text, &cells);
    }
    let cursor = session.cursor().map(|cursor| (cursor.x, cursor.y));
    write!(text, "cursor {cursor:?}").expect("a string");
    text
}

pub(crate) fn of_emulator(screen: &vt100::Screen) -> String {
    let (rows, columns) = screen.size();
    let mut text = String::new();
    for row in 0..rows.get() {
        let cells: Vec<(char, char)> = (0..columns.get())
            .filter_map(|column| screen.cell(row, column))
            .filter(|cell| !cell.is_wide_continuation())
            .map(|cell| (cell.contents().chars().next().unwrap_or(' '), letter(cell)))
            .collect();
        write_row(&mut text, &cells);
    }
    let (row, column) = screen.cursor_position();
    let cursor = (!screen.hide_cursor()).then_some((column, row));
    write!(text, "cursor {cursor:?}").expect("a string");
    text
}

fn letter(cell: &vt100::Cell) -> char {
    use ratatui::style::{Modifier, Style};
    assert!(!cell.underline(), "nothing is underlined");
    let attributes = [
        (cell.inverse(), Modifier::REVERSED),
        (cell.bold(), Modifier::BOLD),
        (cell.dim(), Modifier::DIM),
    ];
    let set = attributes
        .into_iter()
        .filter(|(set, _)| *set)
        .map(|(_, attribute)| attribute);
    theme::letter(&Style::new().add_modifier(set.collect()))
}

/// The style of a blank only matters if it is reversed.
fn write_row(text: &mut String, cells: &[(char, char)]) {
    let row: String = cells.iter().map(|(character, _)| *character).collect();
    let styles: String = cells
        .iter()
        .map(|&(character, style)| {
            if character == ' ' && style != 'R' {
                '.'
            } else {
                style
            }
        })
        .collect();
    writeln!(text, "{}\n{}", row.trim_end(), styles.trim_end_matches('.')).expect("a string");
}
