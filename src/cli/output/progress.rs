//! The progress of long work, on standard error: a bar on a terminal; otherwise, as in the log of a job, a line every ten
//! seconds. This is the only place of the command line that writes escape codes.

use std::io::{self, IsTerminal, Write};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use taxel_core::lock::try_locked;
use taxel_core::progress::Progress;
use taxel_files::formats::value::grouped;

use crate::cli::output::charset::Charset;

const BAR: usize = 40;

const CLEAR: &str = "\r\x1b[K";

pub(crate) struct ProgressDisplay {
    noun: &'static str,
    all: u64,
    done: AtomicU64,
    start: Instant,
    /// When it is shown next; None if it never is.
    due: Option<Mutex<Instant>>,
    pause: Duration,
    /// The signs of the bar for what is done and what is left; None if there is no terminal.
    bar: Option<[&'static str; 2]>,
}

impl ProgressDisplay {
    pub(crate) fn new(noun: &'static str, all: u64, quiet: bool) -> Self {
        let bar = io::stderr()
            .is_terminal()
            .then_some(match Charset::current() {
                Charset::Ascii => ["#", "-"],
                Charset::Unicode => ["█", "░"],
            });
        let pause = Duration::from_millis(if bar.is_some() { 100 } else { 10_000 });
        let start = Instant::now();
        Self {
            noun,
            all,
            done: AtomicU64::new(0),
            start,
            due: (!quiet).then(|| Mutex::new(start + pause)),
            pause,
            bar,
        }
    }

    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "for reading, and the bar is short"
    )]
    fn line(&self, done: u64, elapsed: Duration) -> String {
        let (seconds, share) = (elapsed.as_secs_f64(), done as f64 / self.all as f64);
        let (percent, left) = (share * 100.0, seconds * (1.0 / share - 1.0));
        let noun = self.noun;
        let Some([full, empty]) = self.bar else {
            let (done, all) = (grouped(done), grouped(self.all));
            return format!("{done} of {all} {noun}, {percent:.0} %, {left:.0} s left\n");
        };
        let length = (BAR as f64 * share.min(1.0)) as usize;
        let bar = full.repeat(length) + &empty.repeat(BAR - length);
        let rate = done as f64 / seconds;
        format!("{CLEAR}{bar} {percent:.0} %  {rate:.0} {noun}/s  {left:.0} s left")
    }
}

/// What cannot be written is left out: the work goes on.
fn write(text: &str) {
    let _ = io::stderr().lock().write_all(text.as_bytes());
}

impl Progress for ProgressDisplay {
    fn add(&self, more: u64) -> ControlFlow<()> {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        // If another thread is writing, this one need not.
        if let Some(mut due) = self.due.as_ref().and_then(try_locked)
            && *due <= Instant::now()
        {
            *due = Instant::now() + self.pause;
            write(&self.line(done, self.start.elapsed()));
        }
        ControlFlow::Continue(())
    }
}

impl Drop for ProgressDisplay {
    fn drop(&mut self) {
        if self.bar.is_some() && self.due.is_some() {
            write(CLEAR);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_what_is_left() {
        let mut progress = ProgressDisplay::new("poses", 1000, true);
        let elapsed = Duration::from_secs(10);
        progress.bar = None;
        let line = progress.line(250, elapsed);
        assert_eq!(line, "250 of 1,000 poses, 25 %, 30 s left\n");
        progress.bar = Some(["#", "-"]);
        let bar = format!("{}{}", "#".repeat(10), "-".repeat(30));
        let expected = format!("{CLEAR}{bar} 25 %  25 poses/s  30 s left");
        assert_eq!(progress.line(250, elapsed), expected);
    }
}
