//! The program without a terminal: keys in as text, the screen out as text, the same on every machine.
//!
//! Keys go through the same table, the same update and the same view as in a terminal.
//!
//! ```
//! use taxel::tui::app::state::Options;
//! use taxel::tui::runtime::World;
//! use taxel::tui::script::Session;
//! let mut session = Session::new(&Options::plain(true), World::scratch()?, 80, 24);
//! session.keys("f<Enter>")?;
//! assert!(session.screen().contains("ellipse rx 4.00 ry 4.00 at 4.00, 4.00, 0 deg"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::layout::Position;

use crate::tui::app::message::Message;
use crate::tui::app::state::{App, Notice, Options};
use crate::tui::app::view::view;
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::keys::key::{Key, KeyError, parse};
use crate::tui::live::message::{LiveEvent, LiveMessage, SourceState};
use crate::tui::live::state::Live;
use crate::tui::live::update::last_page;
use crate::tui::runtime::World;
use crate::tui::script::drawing;
use crate::tui::widget::theme::letter;
use crate::tui::widget::write;

/// A running program on a screen of its own.
#[derive(Debug)]
pub struct Session {
    /// The state of the program.
    app: App,
    /// Library, journal and workers.
    world: World,
    /// A screen in memory.
    terminal: Terminal<TestBackend>,
}

impl Session {
    /// Starts the program in a world, on a screen of `width × height` characters.
    pub fn new(options: &Options, world: World, width: u16, height: u16) -> Self {
        Self::of(App::new(options), world, width, height)
    }

    /// The same of a program that is made ready already.
    pub fn of(app: App, world: World, width: u16, height: u16) -> Self {
        // A buffer in memory cannot fail: its error type has no values.
        let Ok(terminal) = Terminal::new(TestBackend::new(width, height));
        let mut session = Self {
            app,
            world,
            terminal,
        };
        session.world.remind(&mut session.app);
        let greeting = session.world.greeting();
        for message in [Some(Message::Resized(width, height)), greeting]
            .into_iter()
            .flatten()
        {
            session.send(message);
        }
        session
    }

    /// Presses keys, given in notation.
    ///
    /// # Errors
    /// A key that is unknown; none is pressed then.
    pub fn keys(&mut self, text: &str) -> Result<(), KeyError> {
        for key in parse(text)? {
            self.press(key);
        }
        Ok(())
    }

    /// Presses a key and draws the screen.
    pub fn press(&mut self, key: Key) {
        self.send(self.app.meaning(key));
    }

    /// Sends a message and draws the screen.
    pub fn send(&mut self, message: Message) {
        // What is left to do is for a real terminal.
        let _ = self.world.handle(&mut self.app, message);
        self.draw();
    }

    /// Watches a source of frames; none is read yet.
    ///
    /// # Errors
    /// Why it cannot be watched, in a sentence.
    pub fn watch(&mut self, name: &str) -> Result<(), String> {
        let number = |app: &App| last_page(app).map(Live::number);
        let before = number(&self.app);
        self.send(Message::Live(LiveMessage::Source(name.to_owned())));
        if number(&self.app) != before {
            return Ok(());
        }
        Err(match &self.app.notice {
            Some(Notice::Refusal(reason)) => reason.clone(),
            _ => format!("{name}: no source can be watched on this page"),
        })
    }

    /// Reads the next frames of the source that is watched, at most `count`, and draws each. Returns how many there were.
    pub fn frames(&mut self, count: usize) -> usize {
        let mut frames = 0;
        for message in self.world.next_frames(count) {
            if let Message::Worker(WorkerEvent::Live(_, LiveEvent::Arrived(batch))) = &message {
                frames += batch.frames.len();
            }
            self.send(message);
        }
        frames
    }

    /// Why no more frames come of the source that is watched, in a few words.
    pub(super) fn end_of_frames(&self) -> String {
        let page = last_page(&self.app).filter(|page| !page.stopped());
        match page.map(|page| &page.status().state) {
            None => "no source is watched".to_owned(),
            Some(SourceState::Failed(reason)) => reason.clone(),
            Some(_) => "the source has ended".to_owned(),
        }
    }

    /// Gives the screen another size.
    pub fn resize(&mut self, width: u16, height: u16) {
        self.terminal.backend_mut().resize(width, height);
        self.send(Message::Resized(width, height));
    }

    /// Draws the state onto the screen.
    fn draw(&mut self) {
        let Ok(_) = self.terminal.draw(|frame| view(&self.app, frame));
    }

    /// The state of the program.
    pub fn app(&self) -> &App {
        &self.app
    }

    /// Columns and rows of the screen.
    pub fn size(&self) -> (u16, u16) {
        let area = self.terminal.backend().buffer().area;
        (area.width, area.height)
    }

    /// Where the terminal's cursor is.
    pub fn cursor(&self) -> Position {
        self.terminal.backend().cursor_position()
    }

    /// The screen, a line a row, blanks at the end cut off.
    pub fn screen(&self) -> String {
        self.rows(|cell| cell.symbol().to_owned())
    }

    /// The styles of the screen, a letter a character: `R` reversed, `B` bold, `D` dim, `.` plain.
    pub fn styles(&self) -> String {
        self.rows(|cell| letter(&cell.style()).to_string())
    }

    /// The screen as SVG, with a title. Its colours are those of a theme that has all of them, as it is where
    /// [`crate::tui::widget::theme::ColorDepth::True`].
    pub fn svg(&self, title: &str) -> String {
        drawing::svg(self.terminal.backend().buffer(), *self.app.theme(), title)
    }

    /// The rows of the screen, each cell shown by a function.
    fn rows(&self, show: impl Fn(&ratatui::buffer::Cell) -> String) -> String {
        let buffer = self.terminal.backend().buffer();
        let width = usize::from(buffer.area.width).max(1);
        let rows = buffer.content.chunks(width).map(|row| {
            let mut text = String::new();
            let mut cells = row.iter();
            while let Some(cell) = cells.next() {
                text += &show(cell);
                // What stands behind a wide character is covered by it.
                for _ in 1..write::width(cell.symbol()) {
                    cells.next();
                }
            }
            text
        });
        rows.map(|row| row.trim_end().to_owned() + "\n").collect()
    }
}
