//! The program without a terminal: keys in as text, the screen out as text, the same on every machine.
//!
//! Keys use the same table, the same update and the same view as in a terminal. The screen is drawn only when it is
//! read: a terminal, too, shows the effect of several keys only after all of them are handled.
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

use std::cell::{Ref, RefCell};

use ratatui::buffer::{Buffer, Cell};
use ratatui::layout::{Position, Rect};

use crate::tui::app::message::Message;
use crate::tui::app::state::{App, Notice, Options};
use crate::tui::app::view::draw;
use crate::tui::app::worker_event::WorkerEvent;
use crate::tui::keys::key::{Key, KeyError, parse};
use crate::tui::live::message::{LiveEvent, LiveMessage, SourceState};
use crate::tui::live::named_source::NamedSource;
use crate::tui::live::state::Live;
use crate::tui::live::watch::last_page;
use crate::tui::runtime::World;
use crate::tui::script::drawing;
use crate::tui::widget::theme::letter;
use crate::tui::widget::write;

#[derive(Debug)]
pub struct Session {
    app: App,
    world: World,
    screen: RefCell<DrawnScreen>,
}

#[derive(Debug)]
struct DrawnScreen {
    buffer: Buffer,
    /// The position of the cursor; None if it is hidden.
    cursor: Option<Position>,
    /// Whether the state has changed since it was drawn.
    is_stale: bool,
}

impl DrawnScreen {
    /// Draws the state onto the screen, unless the screen is up to date.
    fn draw(&mut self, app: &App) {
        if std::mem::take(&mut self.is_stale) {
            self.buffer.reset();
            self.cursor = draw(app, &mut self.buffer);
        }
    }
}

impl Session {
    pub fn new(options: &Options, world: World, width: u16, height: u16) -> Self {
        Self::of(App::new(options), world, width, height)
    }

    pub fn of(app: App, world: World, width: u16, height: u16) -> Self {
        let screen = DrawnScreen {
            buffer: Buffer::empty(Rect::new(0, 0, width, height)),
            cursor: None,
            is_stale: true,
        };
        let mut session = Self {
            app,
            world,
            screen: RefCell::new(screen),
        };
        session.world.remind(&mut session.app);
        let greeting = session.world.greeting();
        for message in std::iter::once(Message::Resized(width, height)).chain(greeting) {
            session.send(message);
        }
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
        let _ = self.world.handle(&mut self.app, message);
        self.screen.get_mut().is_stale = true;
    }

    /// Watches a source of frames; reads no frame yet.
    pub fn watch(&mut self, name: &str) -> Result<(), String> {
        let number = |app: &App| last_page(app).map(Live::number);
        let before = number(&self.app);
        self.send(Message::Live(LiveMessage::Source(NamedSource::new(name))));
        if number(&self.app) != before {
            return Ok(());
        }
        Err(match &self.app.notice {
            Some(Notice::Refusal(reason) | Notice::Failure(reason)) => reason.clone(),
            _ => format!("{name}: no source can be watched on this page"),
        })
    }

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

    pub(super) fn end_of_frames(&self) -> String {
        let page = last_page(&self.app).filter(|page| !page.stopped());
        match page.map(|page| &page.status().state) {
            None => "no source is watched".to_owned(),
            Some(SourceState::Failed(reason)) => reason.clone(),
            Some(_) => "the source has ended".to_owned(),
        }
    }

    /// Changes the size of the screen.
    pub fn resize(&mut self, width: u16, height: u16) {
        let area = Rect::new(0, 0, width, height);
        self.screen.get_mut().buffer.resize(area);
        self.send(Message::Resized(width, height));
    }

    fn drawn(&self) -> Ref<'_, DrawnScreen> {
        self.screen.borrow_mut().draw(&self.app);
        self.screen.borrow()
    }

    pub fn app(&self) -> &App {
        &self.app
    }

    pub fn size(&self) -> (u16, u16) {
        let area = self.screen.borrow().buffer.area;
        (area.width, area.height)
    }

    /// Returns the position of the cursor; None if it is hidden.
    pub fn cursor(&self) -> Option<Position> {
        self.drawn().cursor
    }

    pub fn screen(&self) -> String {
        self.rows(|_, symbol, row| row.push_str(symbol))
    }

    /// Returns the styles of the screen, one letter per character: `R` reversed, `B` bold, `D` dim, `.` plain.
    pub fn styles(&self) -> String {
        self.rows(|cell, _, row| row.push(letter(&cell.style())))
    }

    pub fn svg(&self, title: &str) -> String {
        drawing::svg(&self.drawn().buffer, *self.app.theme(), title)
    }

    fn rows(&self, add: impl Fn(&Cell, &str, &mut String)) -> String {
        let buffer = &self.drawn().buffer;
        let width = usize::from(buffer.area.width).max(1);
        let mut rows = String::with_capacity(buffer.content.len());
        for row in buffer.content.chunks(width) {
            let start = rows.len();
            let mut cells = row.iter();
            while let Some(cell) = cells.next() {
                let symbol = cell.symbol();
                add(cell, symbol, &mut rows);
                // A wide character covers the cells after it.
                for _ in 1..write::width(symbol) {
                    cells.next();
                }
            }
            rows.truncate(start + rows[start..].trim_end().len());
            rows.push('\n');
        }
        rows
    }
}
