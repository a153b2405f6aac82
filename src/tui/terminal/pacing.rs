//! Keeps a slow line free for keys: at most one picture of a source is under way.
//!
//! On a line that is slower than the source, pictures would queue up in the buffers of the system and of SSH, and the
//! effect of a key would appear after all of them. The program cannot see how full these buffers are. So each picture
//! that was drawn only because of new frames ends with a question to the terminal, and the next one waits for the
//! answer:
//! ```text
//! picture, ESC [ 5 n  ->  terminal     device status report (DSR) of ECMA-48
//!          ESC [ 0 n  <-               the terminal has come this far; the newest frame is drawn next
//! ```
//! The effect of a key is drawn at once and without a question. Where nothing answers, pictures come as fast as the
//! terminal takes their bytes.

use std::time::{Duration, Instant};

const QUESTION: &[u8] = b"\x1b[5n";

const TRIES: u32 = 3;

/// How long the next picture waits for a first answer; it doubles with each question that is not answered. A slow
/// line may take a few seconds for the first screens, and should not be taken for a terminal that does not answer.
const FIRST_ANSWER: Duration = Duration::from_secs(1);

/// How long the next picture waits for a later answer: a line may stand still for a while. Only if an answer was
/// lost, as on a noisy serial line, is there nothing to wait for.
const NEXT_ANSWER: Duration = Duration::from_secs(10);

#[derive(Debug)]
pub(in crate::tui) struct PicturePacing {
    answers: Answers,
    open: u32,
    /// The end of the wait for these answers; None if the next picture does not wait.
    deadline: Option<Instant>,
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

    /// Returns the time until which the next picture waits; None if it does not wait.
    pub(in crate::tui) fn deadline(&self) -> Option<Instant> {
        self.deadline
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

#[cfg(test)]
mod tests {
    use super::*;

    fn next(pacing: &mut PicturePacing, now: Instant) -> &'static [u8] {
        pacing.on_time(pacing.deadline().unwrap_or(now));
        assert!(!pacing.is_waiting());
        pacing.ask(now)
    }

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

    #[test]
    fn a_terminal_that_does_not_answer_is_asked_a_few_times() {
        let (mut pacing, start) = (PicturePacing::new(true), Instant::now());
        for _ in 0..TRIES {
            assert_eq!(next(&mut pacing, start), QUESTION);
            assert!(pacing.is_waiting());
        }
        assert_eq!(next(&mut pacing, start), b"");
        assert!(!pacing.is_waiting() && !pacing.is_asked());
        // It was only slow.
        pacing.on_answer();
        assert_eq!(pacing.ask(start), QUESTION);
        assert_eq!(PicturePacing::new(false).ask(start), b"");
    }

    #[test]
    fn a_slow_first_answer_leaves_one_picture_under_way() {
        let (mut pacing, start) = (PicturePacing::new(true), Instant::now());
        for _ in 0..2 {
            assert_eq!(next(&mut pacing, start), QUESTION);
        }
        pacing.on_answer();
        assert!(pacing.is_waiting(), "the second one");
        pacing.on_answer();
        assert!(!pacing.is_waiting());
    }
}
