//! How far a sweep is, on standard error: a bar on a terminal, a line every ten seconds otherwise, or nothing.
//!
//! The only place of the command line that may write escape codes, through its library and to a terminal only.

use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::cli::output::charset::Charset;

/// A line comes this often where there is no terminal.
const PAUSE: Duration = Duration::from_secs(10);

/// Shows the progress of so many poses.
pub(crate) struct Progress {
    all: u64,
    done: AtomicU64,
    shown: Shown,
}

enum Shown {
    Nothing,
    Bar(ProgressBar),
    /// When it began, and when the last line came.
    Lines(Instant, Mutex<Instant>),
}

impl Progress {
    pub(crate) fn new(all: u64, quiet: bool, charset: Charset) -> Self {
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
            // Millions a second: without the decimals that its library would show.
            let rate = |state: &ProgressState, text: &mut dyn std::fmt::Write| {
                // A line too short is all that can happen.
                let _ = write!(text, "{:.0} poses/s", state.per_sec());
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
            all,
            done: AtomicU64::new(0),
            shown,
        }
    }

    /// So many poses more are done.
    pub(crate) fn add(&self, poses: u64) {
        let done = self.done.fetch_add(poses, Ordering::Relaxed) + poses;
        match &self.shown {
            Shown::Nothing => {}
            Shown::Bar(bar) => bar.set_position(done),
            Shown::Lines(start, last) => {
                // Another thread that is at it shows as much.
                let Ok(mut last) = last.try_lock() else {
                    return;
                };
                if last.elapsed() >= PAUSE {
                    *last = Instant::now();
                    // Where not even this can be written, the sweep goes on.
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
        let all = self.all;
        format!(
            "{done} of {all} poses, {:.0} %, {left:.0} s left\n",
            share * 100.0
        )
    }

    /// Takes the bar away.
    pub(crate) fn finish(&self) {
        if let Shown::Bar(bar) = &self.shown {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_what_is_left() {
        let progress = Progress::new(1000, true, Charset::Ascii);
        let line = progress.line(250, Duration::from_secs(10));
        assert_eq!(line, "250 of 1000 poses, 25 %, 30 s left\n");
    }
}
