//! Keeps a slow line free for keys: at most one picture of a source is under way.
//!
//! On a line that is slower than the source, pictures would queue up in the buffers of the system and of SSH, and the
//! effect of a key would appear after all of them. How full these buffers are cannot be seen here, so each picture that
//! only frames have caused ends in a question to the terminal, and the next one waits for the answer:
//! ```text
//! picture, ESC [ 5 n  ->  terminal     device status report (DSR) of ECMA-48
//!          ESC [ 0 n  <-               the terminal has come this far; the newest frame is drawn next
//! ```
//! The effect of a key is drawn at once and without a question. Where nothing answers, pictures come as fast as the
//! terminal takes their bytes.

use std::time::{Duration, Instant};

/// Asks for the status.
const QUESTION: &[u8] = b"\x1b[5n";

/// After this many questions without any answer, the terminal is taken to give none.
const TRIES: u32 = 3;

/// The next picture waits this long at most for a first answer, and after each question without one twice as long: a slow
/// line may take a few seconds for the first screens, and should not be taken for a terminal that gives no answers.
const FIRST_ANSWER: Duration = Duration::from_secs(1);

/// And this long for a later one: a line may stand still for a while. Only where an answer was lost on the way, as on a
/// noisy serial line, there is none to wait for.
const NEXT_ANSWER: Duration = Duration::from_secs(10);

/// When the next picture of a source may be drawn.
#[derive(Debug)]
pub(in crate::tui) struct PicturePacing {
    /// Whether the terminal answers.
    answers: Answers,
    /// Questions whose answers are still to come.
    open: u32,
    /// Until when the next picture waits for these; None if it does not wait.
    deadline: Option<Instant>,
}

/// Whether a terminal answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answers {
    /// It was not asked, or not often.
    Unknown,
    /// It has answered.
    Yes,
    /// It has not, and is asked no more. One that answers late is asked again.
    No,
}

impl PicturePacing {
    /// Nothing is under way. A terminal that cannot answer is never asked.
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

    /// The question to send after a picture; empty where nothing would answer.
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

    /// Takes an answer.
    pub(in crate::tui) fn on_answer(&mut self) {
        self.answers = Answers::Yes;
        self.open = self.open.saturating_sub(1);
        if self.open == 0 {
            self.deadline = None;
        }
    }

    /// No answer will come here: a question was not sent, or another program has read the answers.
    pub(in crate::tui) fn forget(&mut self) {
        (self.open, self.deadline) = (0, None);
    }

    /// Whether the next picture waits for an answer.
    pub(in crate::tui) fn is_waiting(&self) -> bool {
        self.deadline.is_some()
    }

    /// Whether an answer may still come.
    pub(in crate::tui) fn is_asked(&self) -> bool {
        self.open > 0
    }

    /// Until when the next picture waits; None if it does not.
    pub(in crate::tui) fn deadline(&self) -> Option<Instant> {
        self.deadline
    }

    /// Notes what time it is: nothing is waited for beyond the deadline.
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

    /// The question after a picture that is drawn as soon as it may be.
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
        // A line may stand still for longer than the first answer is waited for, but not for ever.
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
