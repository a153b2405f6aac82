//! The event loop: sleeps until there is a key, a signal or a message from a worker, then updates the state and
//! draws.

use std::fs::File;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender};
use std::time::{Duration, Instant};

use crossterm::Command;
use crossterm::clipboard::CopyToClipboard;
use crossterm::terminal::window_size;
use signal_hook::consts::{SIGCONT, SIGHUP, SIGTSTP};

use crate::tui::app::unsaved::offer;
use crate::tui::app::unsaved::{end, flush};
use crate::tui::app::update::update;
use crate::tui::app::view::draw;
use crate::tui::app::{App, Message, TerminalEffect, refuse};
use crate::tui::jobs::Jobs;
use crate::tui::keys::action;
use crate::tui::live::source;
use crate::tui::live::update::last_page;
use crate::tui::terminal::input::{self, Input};
use crate::tui::terminal::screen::Screen;
use crate::tui::terminal::settings::{TerminalKind, TerminalSettings};
use crate::tui::terminal::{session, unix};

/// The shortest time between two pictures of a source.
const PICTURE: Duration = Duration::from_millis(34);

/// The largest size, in columns and rows; a larger one is a mistake and would cost gigabytes.
const LARGEST: (u16, u16) = (1000, 500);

/// What wakes the loop.
#[derive(Debug)]
pub(super) enum Event {
    Input(Input),
    Signal(i32),
    /// A job has an answer.
    Answered,
    /// The terminal has taken the last frame.
    Written,
}

/// Runs the program until it ends, and returns its exit status: 0, 1 if a recording failed, or 128 and the number of a
/// signal as in a shell. The terminal is restored, even after an error, a signal or a panic, and unsaved work is in
/// the journal at every point from which the program may not come back. `first` is the first message to the program;
/// `watch` is called with each input.
pub fn run(
    mut app: App,
    first: Option<Message>,
    world: Jobs,
    settings: &TerminalSettings,
    watch: &mut dyn FnMut(&Input),
) -> io::Result<u8> {
    let (sender, events) = mpsc::channel();
    let wake = sender.clone();
    app.jobs = world.with_threads(Arc::new(move || {
        let _ = wake.send(Event::Answered);
    }));
    let terminal = session::terminal()?;
    unix::watch(terminal.try_clone()?, sender.clone())?;
    session::enter(&terminal, settings, &sender)?;
    input::read(sender.clone());
    leave_on_panic();
    let mut event_loop = EventLoop {
        watch,
        app,
        settings,
        terminal,
        sender,
        events,
        screen: Screen::new(size(settings), settings.abilities),
        is_writing: true,
        status: None,
        frames_due: Instant::now(),
    };
    let ended = catch_unwind(AssertUnwindSafe(|| event_loop.run(first)));
    let mut app = event_loop.app;
    if !matches!(ended, Ok(0)) {
        // The end comes from outside: unsaved work stays in the journal.
        let _ = update(&mut app, Message::Terminate);
    }
    // As in a pipeline: a script must see that the recording is incomplete.
    let failure = last_page(&app).and_then(|page| page.recording.write_failure.as_deref());
    let lost = failure.map(|reason| session::tell(&format!("error: {reason}\n")));
    for line in end(&mut app) {
        session::tell(&line);
    }
    session::leave();
    match ended {
        Ok(0) => Ok(u8::from(lost.is_some())),
        Ok(status) => Ok(status),
        Err(panic) => resume_unwind(panic),
    }
}

/// Makes a panic of this thread restore the terminal before it is reported. A panic of a worker does not end the loop
/// and must not write over the screen: it is printed when the shell has the terminal again.
fn leave_on_panic() {
    let (hook, own) = (std::panic::take_hook(), std::thread::current().id());
    std::panic::set_hook(Box::new(move |info| {
        if std::thread::current().id() == own {
            session::leave();
            hook(info);
        } else if !session::tell_later(&format!("{info}\n")) {
            hook(info);
        }
    }));
}

struct EventLoop<'a> {
    watch: &'a mut dyn FnMut(&Input),
    app: App,
    settings: &'a TerminalSettings,
    terminal: File,
    sender: Sender<Event>,
    events: Receiver<Event>,
    screen: Screen,
    /// Whether the terminal has not taken the last frame yet. Until then nothing is drawn, so that the next frame
    /// shows the newest state.
    is_writing: bool,
    /// How the program ended; None while it runs.
    status: Option<u8>,
    /// The time before which no frames are taken.
    frames_due: Instant,
}

impl EventLoop<'_> {
    fn run(&mut self, first: Option<Message>) -> u8 {
        self.measure();
        // Before the question about unsaved work, which then waits until the source is left.
        if let Some(first) = first {
            self.update(first);
        }
        offer(&mut self.app);
        loop {
            let woken = self.wait();
            let events: Vec<Event> = woken.into_iter().chain(self.events.try_iter()).collect();
            // Ending the program must not wait until everything typed is handled.
            let ends = events.iter().find_map(|event| match event {
                Event::Signal(SIGTSTP | SIGCONT) => None,
                Event::Signal(signal) => Some(ended_by(*signal)),
                _ => None,
            });
            self.status = self.status.or(ends);
            for event in events {
                if self.status.is_none() {
                    self.on(event);
                }
            }
            if let Some(status) = self.status {
                return status;
            }
            self.take_frames();
            if !self.is_writing {
                self.draw();
            }
        }
    }

    /// Sleeps until something happens; None if frames are to be taken or a change of a file is due.
    fn wait(&self) -> Option<Event> {
        let frames = self.has_frames().then_some(self.frames_due);
        let due = [frames, self.app.jobs.due()];
        match due.into_iter().flatten().min() {
            Some(due) => {
                let patience = due.saturating_duration_since(Instant::now());
                self.events.recv_timeout(patience).ok()
            }
            None => self.events.recv().ok(),
        }
    }

    fn on(&mut self, event: Event) {
        match event {
            Event::Input(Input::Size(..)) => self.measure(),
            Event::Input(input) => {
                (self.watch)(&input);
                match input {
                    // Each key is looked up in the state to which the one before has led.
                    Input::Key(key) => self.update(self.app.meaning(key)),
                    Input::Paste(text) => self.update(Message::Paste(text)),
                    Input::Mouse(mouse) => self.update(Message::Mouse(mouse)),
                    Input::Size(..) => {}
                }
            }
            Event::Answered => self.update(Message::Answered),
            Event::Signal(SIGTSTP) => self.suspend(),
            Event::Signal(_) => self.resume(),
            Event::Written => self.is_writing = false,
        }
    }

    /// Whether there are frames to draw, and the terminal has taken the last picture.
    fn has_frames(&self) -> bool {
        self.app.jobs.sources.has_new() && !self.is_writing
    }

    /// Takes the frames that have come, if the last picture is old enough; frames that come meanwhile are taken together.
    fn take_frames(&mut self) {
        let now = Instant::now();
        if self.has_frames() && self.frames_due <= now {
            self.frames_due = now + PICTURE;
            self.app.jobs.later(source::take);
            self.update(Message::Answered);
        }
    }

    fn update(&mut self, message: Message) {
        match update(&mut self.app, message) {
            None => {}
            Some(TerminalEffect::Redraw) => self.measure(),
            Some(TerminalEffect::Suspend) => self.suspend(),
            Some(TerminalEffect::Copy(text)) if self.settings.kind == TerminalKind::Window => {
                let mut sequence = String::new();
                // Writing to a String cannot fail.
                let _ = CopyToClipboard::to_clipboard_from(text).write_ansi(&mut sequence);
                self.screen.send(&sequence);
            }
            Some(TerminalEffect::Copy(_)) => {
                let save = self.app.key_of(&action::SAVE);
                let text = format!(
                    "this terminal has no clipboard; {save} saves, 'taxel export' writes a file"
                );
                refuse(&mut self.app, text);
            }
        }
        if self.app.ended() {
            self.status.get_or_insert(0);
        }
    }

    /// Sends the changes of the screen, in one piece.
    fn draw(&mut self) {
        let bytes = self.screen.frame(|buffer| draw(&self.app, buffer));
        self.is_writing = !bytes.is_empty() && session::send(bytes);
    }

    /// Asks the terminal for its size, tells it to the program, and draws everything next time.
    fn measure(&mut self) {
        let (columns, rows) = size(self.settings);
        self.screen = Screen::new((columns, rows), self.settings.abilities);
        (self.watch)(&Input::Size(columns, rows));
        let _ = update(&mut self.app, Message::Resized(columns, rows));
    }

    fn suspend(&mut self) {
        if !unix::has_shell() {
            return refuse(&mut self.app, "there is no shell to go back to");
        }
        for line in flush(&mut self.app) {
            session::tell(&line);
        }
        session::leave();
        // Nothing is drawn until the program is continued.
        self.is_writing = true;
        if !unix::stop() {
            self.resume();
        }
    }

    /// Takes the terminal again, which another program has used.
    fn resume(&mut self) {
        session::leave();
        let entered = session::enter(&self.terminal, self.settings, &self.sender);
        if entered.is_err() {
            self.status.get_or_insert(ended_by(SIGHUP));
        }
        self.is_writing = true;
        self.measure();
    }
}

fn ended_by(signal: i32) -> u8 {
    128_u8.saturating_add(u8::try_from(signal).unwrap_or(127))
}

/// Returns the size that is set, or the one that the terminal reports. A side that it does not know, as on a serial
/// line, comes from the environment.
fn size(settings: &TerminalSettings) -> (u16, u16) {
    let reported = || window_size().map_or((0, 0), |size| (size.columns, size.rows));
    let (columns, rows) = settings.size.unwrap_or_else(reported);
    let (width, height) = settings.fallback;
    let side = |known: u16, fallback: u16| if known == 0 { fallback } else { known };
    let (columns, rows) = (side(columns, width), side(rows, height));
    (columns.min(LARGEST.0), rows.min(LARGEST.1))
}
