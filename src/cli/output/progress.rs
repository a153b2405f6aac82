//! The progress of a sweep, on standard error: a bar on a terminal; otherwise, as in the log of a job, a line every ten
//! seconds; with `--quiet` nothing. This is the only place of the command line that writes escape codes.

use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use taxel_core::lock::try_locked;
use taxel_core::progress::Progress;
use taxel_files::formats::value::grouped;

use crate::cli::output::charset::Charset;

const PAUSE: Duration = Duration::from_secs(10);

pub(crate) struct ProgressDisplay {
    noun: &'static str,
    all: u64,
    done: AtomicU64,
    shown: Shown,
}

enum Shown {
    Nothing,
    Bar(ProgressBar),
    Lines(Instant, Mutex<Instant>),
}

impl ProgressDisplay {
    pub(crate) fn new(all: u64, quiet: bool, charset: Charset) -> Self {
        Self::counting("poses", all, quiet, charset)
    }

    pub(crate) fn counting(noun: &'static str, all: u64, quiet: bool, charset: Charset) -> Self {
        let shown = if quiet {
            Shown::Nothing
        } else if std::io::stderr().is_terminal() {
            let bar = ProgressBar::with_draw_target(Some(all), ProgressDrawTarget::stderr());
            let template = "{bar:40} {percent} %  {rate}  {eta} left";
            let characters = match charset {
                Charset::Ascii => "#>-",
                Charset::Unicode => "█▌░",
            };
            let style = ProgressStyle::with_template(template);
            // There are millions of poses per second, for which the library's own format would show decimals.
            let rate = move |state: &ProgressState, text: &mut dyn std::fmt::Write| {
                // Cannot fail: the text is kept in memory.
                let _ = write!(text, "{:.0} {noun}/s", state.per_sec());
            };
            bar.set_style(
                style
                    .unwrap_or_else(|_| ProgressStyle::default_bar())
                    .with_key("rate", rate)
                    .progress_chars(characters),
            );
            Shown::Bar(bar)
        } else {
            let now = Instant::now();
            Shown::Lines(now, Mutex::new(now))
        };
        Self {
            noun,
            all,
            done: AtomicU64::new(0),
            shown,
        }
    }

    /// Shows that `poses` more are done. Any thread may call it.
    fn show(&self, poses: u64) {
        let done = self.done.fetch_add(poses, Ordering::Relaxed) + poses;
        match &self.shown {
            Shown::Nothing => {}
            Shown::Bar(bar) => bar.set_position(done),
            Shown::Lines(start, last) => {
                // If another thread is writing a line, this one need not.
                let Some(mut last) = try_locked(last) else {
                    return;
                };
                if last.elapsed() >= PAUSE {
                    *last = Instant::now();
                    // The sweep goes on if standard error cannot be written to.
                    let _ = std::io::stderr()
                        .lock()
                        .write_all(self.line(done, start.elapsed()).as_bytes());
                }
            }
        }
    }

    #[expect(clippy::cast_precision_loss, reason = "for reading")]
    fn line(&self, done: u64, elapsed: Duration) -> String {
        let share = done as f64 / self.all as f64;
        let left = elapsed.as_secs_f64() * (1.0 / share - 1.0);
        format!(
            "{} of {} {}, {:.0} %, {left:.0} s left\n",
            grouped(done),
            grouped(self.all),
            self.noun,
            share * 100.0
        )
    }
}

impl Progress for ProgressDisplay {
    fn add(&self, done: u64) -> ControlFlow<()> {
        self.show(done);
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_what_is_left() {
        let progress = ProgressDisplay::new(1000, true, Charset::Ascii);
        let line = progress.line(250, Duration::from_secs(10));
        assert_eq!(line, "250 of 1,000 poses, 25 %, 30 s left\n");
    }
}
