//! The event loop: sleeps until there is a key, a signal or a message from a worker, then updates the state and
//! draws.
//!
//! ```text
//! poll(terminal, signals, mailbox) -> Ready
//!   signals   end, stop, continue, a new size
//!   mail      messages of workers           -> update
//!   input     bytes -> keys, pastes, mouse  -> update
//!   nothing   in time: half a sequence is what it is
//! frames      of a source, once the terminal has drawn those before
//! draw        what has changed, in one write
//! ```
//! It sleeps without a time limit while nothing is pending, so an idle program uses no processor time. A terminal
//! that takes no output does not delay signals: they interrupt writing, and the next frame repairs the screen.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant};

use ratatui::Terminal;
use ratatui::layout::Size;
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;
use signal_hook::consts::SIGHUP;

use crate::tui::app::message::Message;
use crate::tui::app::state::App;
use crate::tui::app::unsaved::offer;
use crate::tui::app::update::{on_worker, update};
use crate::tui::app::view::view;
use crate::tui::keys::action;
use crate::tui::live::update::last_page;
use crate::tui::runtime::effect::TerminalEffect;
use crate::tui::runtime::mailbox::{Mailbox, Sender};
use crate::tui::runtime::reminders::remind;
use crate::tui::runtime::{World, end, flush};
use crate::tui::terminal::device::{Device, WriteOutcome};
use crate::tui::terminal::input::{Input, InputReader};
use crate::tui::terminal::screen::Screen;
use crate::tui::terminal::session::{self, SignalEvent, SignalReceiver};
use crate::tui::terminal::settings::TerminalSettings;

const PICTURE: Duration = Duration::from_millis(34);

/// Runs the program until it ends. The terminal is restored, even after an error, a signal or a panic, and unsaved
/// work is in the journal at every point from which the program may not come back. `first` is the first message to the
/// program; later ones come through the mailbox. `watch` is called with each input.
pub fn run(
    mut app: App,
    first: Option<Message>,
    world: World,
    settings: &TerminalSettings,
    (sender, mailbox): (Sender, Mailbox),
    watch: &mut dyn FnMut(&Input),
) -> io::Result<Outcome> {
    app.jobs = world.with_threads(Arc::new(move || sender.send(Message::Answered)));
    // Before signals are handled: if the disk hangs here, they still end the program.
    remind(&mut app);
    let mut event_loop = EventLoop::open(watch, app, *settings, mailbox)?;
    leave_on_panic();
    event_loop.first = first;
    let ended = catch_unwind(AssertUnwindSafe(|| {
        event_loop.run().or_else(|error| match error {
            // Reading, writing or reopening the terminal may be the first call to fail.
            lost if is_lost(&lost) => Ok(Outcome::Hangup),
            error => Err(error),
        })
    }));
    if !matches!(ended, Ok(Ok(Outcome::Quit))) {
        // The end comes from outside: unsaved work stays in the journal.
        let _ = update(&mut event_loop.app, Message::Terminate);
    }
    // As in a pipeline: a script must see that the recording is incomplete.
    let failure = last_page(&event_loop.app).and_then(|page| page.recording().write_failure());
    let mut quit = Outcome::Quit;
    if let Some(reason) = failure {
        session::tell(&format!("error: {reason}\n"));
        quit = Outcome::RecordingFailed;
    }
    for line in end(&mut event_loop.app) {
        session::tell(&line);
    }
    let left = session::leave(event_loop.pacing.is_asked());
    match ended {
        Ok(Ok(Outcome::Quit)) => left.map(|()| quit),
        // Nothing can be restored on a terminal that is gone.
        Ok(outcome) => outcome,
        Err(panic) => resume_unwind(panic),
    }
}

/// Makes a panic of this thread restore the terminal before it is reported. A panic of a worker does not end the loop
/// and must not write over the screen: it is printed when the shell has the terminal again.
fn leave_on_panic() {
    let (hook, own) = (std::panic::take_hook(), std::thread::current().id());
    std::panic::set_hook(Box::new(move |info| {
        if std::thread::current().id() == own {
            // An error here cannot be handled; the panic is reported all the same.
            let _ = session::leave(true);
            hook(info);
        } else if !session::tell_later(&format!("{info}\n")) {
            hook(info);
        }
    }));
}

struct EventLoop<'a> {
    watch: &'a mut dyn FnMut(&Input),
    app: App,
    settings: TerminalSettings,
    device: Device,
    signals: SignalReceiver,
    mailbox: Mailbox,
    /// Turns bytes into keys.
    reader: InputReader,
    screen: Terminal<Screen>,
    mouse: bool,
    /// How the program ended; None while it runs.
    outcome: Option<Outcome>,
    first: Option<Message>,
    read_at: Instant,
    /// The time at which to take frames next; None if there are none.
    frames_due: Option<Instant>,
    frames_at: Option<Instant>,
    pacing: PicturePacing,
}

#[derive(Default)]
#[expect(
    clippy::struct_excessive_bools,
    reason = "any of them may be so at the same time"
)]
struct Ready {
    /// There are bytes to read.
    input: bool,
    late: bool,
    signals: bool,
    mail: bool,
    gone: bool,
}

impl<'a> EventLoop<'a> {
    fn open(
        watch: &'a mut dyn FnMut(&Input),
        app: App,
        settings: TerminalSettings,
        mailbox: Mailbox,
    ) -> io::Result<Self> {
        let device = Device::open()?;
        let signals = SignalReceiver::new()?;
        let size = size(&device, &settings);
        let screen = Screen::new(size, settings.abilities);
        // A buffer in memory cannot fail: its error type has no values.
        let Ok(screen) = Terminal::new(screen);
        Ok(Self {
            watch,
            app,
            settings,
            device,
            signals,
            mailbox,
            reader: InputReader::default(),
            screen,
            mouse: settings.mouse,
            outcome: None,
            first: None,
            read_at: Instant::now(),
            frames_due: None,
            frames_at: None,
            pacing: PicturePacing::new(settings.kind.tells_status()),
        })
    }

    fn run(&mut self) -> io::Result<Outcome> {
        session::enter(&self.device, &self.settings, self.mouse)?;
        self.tell_size();
        // Before the question about unsaved work, which then waits until the source is left.
        if let Some(first) = self.first.take() {
            self.update(first)?;
        }
        offer(&mut self.app);
        self.draw(false)?;
        while self.outcome.is_none() {
            let ready = self.wait(self.patience())?;
            self.pacing.on_time(Instant::now());
            // Signals come before keys: ending the program must not wait until it has handled everything typed.
            if ready.signals {
                self.on_signals()?;
            }
            if ready.gone {
                self.outcome.get_or_insert(Outcome::Hangup);
            }
            if self.outcome.is_none() {
                if ready.mail {
                    self.collect()?;
                }
                self.read(&ready)?;
                let has_frames = self.take_frames()?;
                self.draw(has_frames)?;
            }
        }
        Ok(self.outcome.unwrap_or(Outcome::Quit))
    }

    /// Returns the longest time to sleep: until an incomplete sequence times out, frames are taken, an answer is
    /// given up or a change of a file is due.
    fn patience(&self) -> Option<Duration> {
        let reader = self.reader.patience(self.pacing.is_waiting());
        let reader = reader.map(|patience| patience.saturating_sub(self.read_at.elapsed()));
        let due = [self.frames_due, self.pacing.deadline, self.app.jobs.due()];
        let due = due.into_iter().flatten().min();
        let due = due.map(|due| due.saturating_duration_since(Instant::now()));
        reader.into_iter().chain(due).min()
    }

    /// Takes the frames that have come, if the last picture is old enough and the terminal has drawn it; frames that
    /// come meanwhile are taken together. Returns true if there were any.
    fn take_frames(&mut self) -> io::Result<bool> {
        self.frames_due = None;
        if !self.app.jobs.workers.frames.has_new() || self.pacing.is_waiting() {
            return Ok(false);
        }
        let now = Instant::now();
        let due = self.frames_at.map_or(now, |last| last + PICTURE);
        if due > now {
            self.frames_due = Some(due);
            return Ok(false);
        }
        self.frames_at = Some(now);
        let Some(frames) = self.app.jobs.workers.frames.take() else {
            return Ok(false);
        };
        self.app.jobs.later(move |app| on_worker(app, frames));
        self.update(Message::Answered)?;
        Ok(true)
    }

    fn wait(&self, patience: Option<Duration>) -> io::Result<Ready> {
        let timeout = patience.and_then(|patience| Timespec::try_from(patience).ok());
        let watched = [self.device.input(), self.signals.fd(), self.mailbox.fd()];
        let mut fds = watched.map(|fd| PollFd::from_borrowed_fd(fd, PollFlags::IN));
        match poll(&mut fds, timeout.as_ref()) {
            Ok(0) => {
                return Ok(Ready {
                    late: true,
                    ..Ready::default()
                });
            }
            Ok(_) => {}
            // A signal is also reported through its own descriptor.
            Err(Errno::INTR) => return Ok(Ready::default()),
            Err(error) => return Err(error.into()),
        }
        let [input, signals, mail] = fds.map(|fd| fd.revents());
        let lost = PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL;
        Ok(Ready {
            gone: input.intersects(lost),
            input: input.contains(PollFlags::IN),
            late: false,
            signals: !signals.is_empty(),
            mail: !mail.is_empty(),
        })
    }

    fn on_signals(&mut self) -> io::Result<()> {
        for said in self.signals.received() {
            match said {
                SignalEvent::End(signal) => {
                    self.outcome.get_or_insert(Outcome::Signal(signal));
                    return Ok(());
                }
                SignalEvent::Stop => self.suspend()?,
                SignalEvent::Continue => self.resume()?,
                SignalEvent::Size => self.measure(),
            }
        }
        Ok(())
    }

    fn collect(&mut self) -> io::Result<()> {
        let mut messages = self.mailbox.collect().into_iter();
        messages.try_for_each(|message| self.update(message))
    }

    /// Reads the available bytes, or handles a timeout.
    fn read(&mut self, ready: &Ready) -> io::Result<()> {
        let inputs = if ready.input {
            let mut buffer = [0; 4096];
            let Some(count) = self.device.read(&mut buffer)? else {
                self.outcome = Some(Outcome::Hangup);
                return Ok(());
            };
            self.read_at = Instant::now();
            self.reader.read(&buffer[..count])
        } else if ready.late && self.has_timed_out() {
            self.reader.on_timeout(self.pacing.is_waiting())
        } else {
            return Ok(());
        };
        if self.reader.take_status() {
            self.pacing.on_answer();
        }
        for input in inputs {
            (self.watch)(&input);
            let message = match input {
                // Each key is looked up in the state to which the one before has led.
                Input::Key(key) => Some(self.app.meaning(key)),
                Input::Paste(text) => Some(Message::Paste(text)),
                Input::Mouse(mouse) => Some(Message::Mouse(mouse)),
                Input::Size(columns, rows) => Some(Message::Resized(columns, rows)),
            };
            if let Some(message) = message {
                self.update(message)?;
            }
            if self.outcome.is_some() {
                break;
            }
        }
        Ok(())
    }

    fn has_timed_out(&self) -> bool {
        let patience = self.reader.patience(self.pacing.is_waiting());
        patience.is_some_and(|patience| self.read_at.elapsed() >= patience)
    }

    fn update(&mut self, message: Message) -> io::Result<()> {
        match update(&mut self.app, message) {
            None => {}
            Some(TerminalEffect::Redraw) => self.redraw(),
            Some(TerminalEffect::Suspend) => self.suspend()?,
            Some(TerminalEffect::Copy(text)) if self.settings.kind.has_clipboard() => {
                self.send(session::copied(&text).as_bytes())?;
            }
            Some(TerminalEffect::Copy(_)) => {
                let save = self.app.key_of(&action::SAVE);
                self.refuse(&format!(
                    "this terminal has no clipboard; {save} saves, 'taxel export' writes a file"
                ));
            }
        }
        if self.app.ended() {
            self.outcome.get_or_insert(Outcome::Quit);
        }
        Ok(())
    }

    /// Writes the changes of the screen, in one piece. After new frames, the terminal is asked for its status, to
    /// learn when it has drawn them.
    fn draw(&mut self, has_frames: bool) -> io::Result<()> {
        let Ok(_) = self.screen.draw(|frame| {
            view(&self.app, frame);
        });
        let mut bytes = self.screen.backend_mut().take_frame();
        if has_frames && !bytes.is_empty() {
            bytes.extend(self.pacing.ask(Instant::now()));
        }
        self.send(&bytes)
    }

    /// Writes bytes. If a signal interrupts this while the terminal takes nothing, the next frame repairs the screen;
    /// its first character ends an incomplete sequence.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        if self.device.write(bytes, self.signals.fd())? == WriteOutcome::Interrupted {
            self.redraw();
            self.pacing.forget();
        }
        Ok(())
    }

    /// Shows a message that something cannot be done here.
    fn refuse(&mut self, reason: &str) {
        crate::tui::app::change::refuse(&mut self.app, reason);
    }

    /// Forgets what the terminal shows, so that all of it is drawn next time.
    fn redraw(&mut self) {
        self.screen.backend_mut().forget();
        let Ok(()) = self.screen.clear();
    }

    /// Asks the terminal for its size, and reports a change to the program.
    fn measure(&mut self) {
        let size = size(&self.device, &self.settings);
        let screen = self.screen.backend_mut();
        let Ok(before) = ratatui::backend::Backend::size(screen);
        if size != before {
            screen.resize(size);
            self.tell_size();
        }
    }

    fn tell_size(&mut self) {
        let Ok(size) = ratatui::backend::Backend::size(self.screen.backend());
        let input = Input::Size(size.width, size.height);
        (self.watch)(&input);
        let _ = update(&mut self.app, Message::Resized(size.width, size.height));
    }

    fn suspend(&mut self) -> io::Result<()> {
        if !session::has_shell() {
            self.refuse("there is no shell to go back to");
            return Ok(());
        }
        for line in flush(&mut self.app) {
            session::tell(&line);
        }
        session::leave(self.pacing.is_asked())?;
        // From here on, a "continue" is the answer to this stop.
        let before = self.signals.received();
        if let Some(&SignalEvent::End(signal)) = before.first() {
            self.outcome.get_or_insert(Outcome::Signal(signal));
            return Ok(());
        }
        session::stop()?;
        while self.outcome.is_none() {
            for said in self.signals.received() {
                match said {
                    SignalEvent::End(signal) => {
                        self.outcome.get_or_insert(Outcome::Signal(signal));
                        return Ok(());
                    }
                    SignalEvent::Continue => return self.resume(),
                    SignalEvent::Stop | SignalEvent::Size => {}
                }
            }
            // Another thread may have been stopped first.
            let mut fds = [
                PollFd::from_borrowed_fd(self.signals.fd(), PollFlags::IN),
                PollFd::from_borrowed_fd(self.device.input(), PollFlags::empty()),
            ];
            if poll(&mut fds, None).is_ok() && !fds[1].revents().is_empty() {
                self.outcome = Some(Outcome::Hangup);
            }
        }
        Ok(())
    }

    fn resume(&mut self) -> io::Result<()> {
        session::enter(&self.device, &self.settings, self.mouse)?;
        // The other program has read the rest of a sequence or an answer.
        self.reader = InputReader::default();
        self.pacing.forget();
        self.measure();
        self.redraw();
        Ok(())
    }
}

/// Returns the size of the terminal: the one that is set, or the one that the terminal reports.
fn size(device: &Device, settings: &TerminalSettings) -> Size {
    let (width, height) = settings
        .size
        .unwrap_or_else(|| device.size(settings.fallback));
    Size { width, height }
}

fn is_lost(error: &io::Error) -> bool {
    let lost = [
        Errno::IO,
        Errno::PIPE,
        Errno::NXIO,
        Errno::NODEV,
        Errno::BADF,
    ];
    error
        .raw_os_error()
        .is_some_and(|number| lost.iter().any(|errno| errno.raw_os_error() == number))
}

const QUESTION: &[u8] = b"\x1b[5n";

const TRIES: u32 = 3;

/// How long the next picture waits for a first answer; it doubles with each question that is not answered. A slow
/// line may take a few seconds for the first screens, and should not be taken for a terminal that does not answer.
const FIRST_ANSWER: Duration = Duration::from_secs(1);

/// How long the next picture waits for a later answer: a line may stand still for a while. Only if an answer was
/// lost, as on a noisy serial line, is there nothing to wait for.
const NEXT_ANSWER: Duration = Duration::from_secs(10);

/// Keeps a slow line free for keys: at most one picture of a source is under way.
///
/// On a line that is slower than the source, pictures would queue up in the buffers of the system and of SSH, and the
/// effect of a key would appear after all of them. So each picture that was drawn only because of new frames ends with a
/// question to the terminal, and the next one waits for the answer. The effect of a key is drawn at once and without a
/// question. Where nothing answers, pictures come as fast as the terminal takes their bytes.
#[derive(Debug)]
pub(in crate::tui) struct PicturePacing {
    answers: Answers,
    open: u32,
    /// The end of the wait for these answers; None if the next picture does not wait.
    pub(in crate::tui) deadline: Option<Instant>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answers {
    Unknown,
    Yes,
    /// It has not answered, and is not asked again unless a late answer comes.
    No,
}

impl PicturePacing {
    /// Creates a pacing with no picture under way. A terminal that cannot answer is never asked.
    pub(in crate::tui) fn new(can_answer: bool) -> Self {
        let answers = if can_answer {
            Answers::Unknown
        } else {
            Answers::No
        };
        Self {
            answers,
            open: 0,
            deadline: None,
        }
    }

    /// Returns the question to send after a picture; it is empty if the terminal would not answer.
    pub(in crate::tui) fn ask(&mut self, now: Instant) -> &'static [u8] {
        let patience = match self.answers {
            Answers::Unknown => FIRST_ANSWER * 2_u32.pow(self.open),
            Answers::Yes => NEXT_ANSWER,
            Answers::No => return b"",
        };
        self.open += 1;
        self.deadline = Some(now + patience);
        QUESTION
    }

    pub(in crate::tui) fn on_answer(&mut self) {
        self.answers = Answers::Yes;
        self.open = self.open.saturating_sub(1);
        if self.open == 0 {
            self.deadline = None;
        }
    }

    /// Stops waiting for answers: a question was not sent, or another program has read the answers.
    pub(in crate::tui) fn forget(&mut self) {
        (self.open, self.deadline) = (0, None);
    }

    pub(in crate::tui) fn is_waiting(&self) -> bool {
        self.deadline.is_some()
    }

    /// Returns true if an answer may still come.
    pub(in crate::tui) fn is_asked(&self) -> bool {
        self.open > 0
    }

    pub(in crate::tui) fn on_time(&mut self, now: Instant) {
        if self.deadline.is_none_or(|deadline| deadline > now) {
            return;
        }
        self.deadline = None;
        match self.answers {
            Answers::Unknown if self.open < TRIES => {}
            Answers::Unknown => (self.answers, self.open) = (Answers::No, 0),
            Answers::Yes | Answers::No => self.open = 0,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Quit,
    RecordingFailed,
    Signal(i32),
    Hangup,
}

impl Outcome {
    /// Returns the exit status: 0, 1 after a failure, or 128 and the signal's number as in a shell. A lost terminal
    /// counts as SIGHUP.
    pub fn status(self) -> u8 {
        match self {
            Self::Quit => 0,
            Self::RecordingFailed => 1,
            Self::Signal(number) => 128_u8.saturating_add(u8::try_from(number).unwrap_or(127)),
            Self::Hangup => Self::Signal(SIGHUP).status(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_that_answers_is_asked_after_each_picture() {
        let (mut pacing, start) = (PicturePacing::new(true), Instant::now());
        for _ in 0..9 {
            assert_eq!(pacing.ask(start), QUESTION);
            assert!(pacing.is_waiting());
            pacing.on_answer();
            assert!(!pacing.is_waiting());
        }
        // A line may stand still for longer than FIRST_ANSWER, but not for ever.
        pacing.ask(start);
        pacing.on_time(start + FIRST_ANSWER);
        assert!(pacing.is_waiting());
        pacing.on_time(start + NEXT_ANSWER);
        assert!(!pacing.is_waiting() && !pacing.is_asked());
        assert_eq!(pacing.ask(start), QUESTION);
    }
}
