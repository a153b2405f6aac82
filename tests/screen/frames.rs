//! Compares the bytes of a frame from this program's writer with those from ratatui's own backend, on the most common
//! screens. The numbers are printed: `cargo test --test screen frames -- --nocapture`.

use std::cell::Cell;
use std::io::{self, Write};
use std::rc::Rc;

use ratatui::layout::Size;
use ratatui::{Terminal, TerminalOptions, Viewport};
use ratatui_crossterm::CrosstermBackend;
use taxel::tui::app::view::view;
use taxel::tui::script::Session;
use taxel::tui::terminal::screen::Screen;
use taxel::tui::terminal::settings::Abilities;

use crate::session::session;

/// Keys that lead to the results of the paper's grid.
const SWEPT: &str = "f<CR>:explore --x0 5:5.99:0.01 --y0 5:5.99:0.01<CR>";

/// A name, the keys before the frame, the keys of the frame (empty for the first frame), and the highest number of
/// bytes.
const SCENES: [(&str, &str, &str, usize); 9] = [
    ("first frame", "", "", 2200),
    ("cursor move", "", "<Right>", 60),
    ("cursor move on a figure", "f<CR>", "<Right>", 60),
    ("first toggle", "", "<Space>", 290),
    (
        "toggle that makes a hole",
        "f<CR><8x:Left><8x:Down><3x:Right><3x:Up>",
        "<Space>",
        57,
    ),
    ("a form opens", "f<CR>", "f", 705),
    ("a field is edited", "f<CR>f<Tab>", "3", 151),
    ("a page of Explore", SWEPT, "2", 1575),
    ("a row of Explore", SWEPT, "<Down>", 360),
];

/// Returns the bytes of the frame from the program's own writer.
fn own(before: &Session, after: Option<&Session>) -> usize {
    let abilities = Abilities {
        styles: true,
        synchronized: true,
        erases: true,
    };
    let Ok(mut terminal) = Terminal::new(Screen::new(Size::new(80, 24), abilities));
    let mut bytes = 0;
    for session in [Some(before), after].into_iter().flatten() {
        let Ok(_) = terminal.draw(|frame| {
            view(session.app(), frame);
        });
        bytes = terminal.backend_mut().take_frame().len();
    }
    bytes
}

/// Returns the bytes of the same frame from ratatui's backend, written into a buffer.
fn stock(before: &Session, after: Option<&Session>) -> usize {
    let area = ratatui::layout::Rect::new(0, 0, 80, 24);
    let options = TerminalOptions {
        viewport: Viewport::Fixed(area),
    };
    let written = Rc::new(Cell::new(0));
    let backend = CrosstermBackend::new(Counter(Rc::clone(&written)));
    let mut terminal = Terminal::with_options(backend, options).expect("a counter takes it all");
    for session in [Some(before), after].into_iter().flatten() {
        written.set(0);
        terminal
            .draw(|frame| {
                view(session.app(), frame);
            })
            .expect("a counter takes it all");
    }
    written.get()
}

/// Counts the bytes that are written.
struct Counter(Rc<Cell<usize>>);

impl Write for Counter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.set(self.0.get() + bytes.len());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn every_frame_fits_its_budget_and_is_shorter_than_the_stock_backends() {
    println!("{:26} {:>6} {:>6}", "", "own", "stock");
    let mut over = Vec::new();
    for (name, before, keys, most) in SCENES {
        let (first, then) = (session(before), session(&format!("{before}{keys}")));
        let then = (!keys.is_empty()).then_some(&then);
        let (own, stock) = (own(&first, then), stock(&first, then));
        println!("{name:26} {own:6} {stock:6}");
        if own > most || 5 * own > 4 * stock {
            over.push(format!("{name}: {own} of at most {most}, {stock}"));
        }
    }
    assert!(over.is_empty(), "{over:#?}");
}
