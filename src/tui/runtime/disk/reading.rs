//! What the screen reads from the disk. A late answer goes to the page that asked for it.
//!
//! ```text
//! ask -> answer within a moment: the next message
//!        later: as soon as no other page stands above the one that asked
//!        Esc there: no longer waited for; the hanging thread is left to itself, and another one continues
//! ```

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::tui::runtime::disk::queue::{DiskAnswer, DiskQueue, DiskRequest};

/// Requests to read, and their answers.
#[derive(Debug)]
pub(in crate::tui::runtime) struct Reader {
    /// The requests.
    pub(in crate::tui::runtime) queue: DiskQueue,
    /// How many pages were open when each of them was made; None if its answer is not wanted any more.
    asked: VecDeque<Option<usize>>,
    /// Answers that wait for their page, with the same number.
    answers: VecDeque<(usize, DiskAnswer)>,
}

impl Reader {
    /// A reader with a queue of its own, so that a save that hangs holds up no reading.
    pub(in crate::tui::runtime) fn new(queue: DiskQueue) -> Self {
        Self {
            queue,
            asked: VecDeque::new(),
            answers: VecDeque::new(),
        }
    }

    /// Asks while that many pages are open. Returns the answer if there is one within a moment.
    pub(in crate::tui::runtime) fn ask(
        &mut self,
        request: DiskRequest,
        pages: usize,
    ) -> Option<DiskAnswer> {
        let before = self.queue.len();
        let answer = self.queue.ask(request);
        if self.queue.len() > before {
            self.asked.push_back(Some(pages));
        }
        answer
    }

    /// Takes the next answer whose page is on top when that many are open.
    pub(in crate::tui::runtime) fn take(&mut self, pages: usize) -> Option<DiskAnswer> {
        while let Some(answer) = self.queue.wait(Duration::ZERO) {
            let asked = self.asked.pop_front().flatten();
            self.answers.extend(asked.map(|asked| (asked, answer)));
        }
        let mut waiting = self.answers.iter();
        let next = waiting.position(|(asked, _)| *asked >= pages)?;
        self.answers.remove(next).map(|(_, answer)| answer)
    }

    /// Waits no longer for what was asked for first, if the page that did so is on top when that many are open. Returns what
    /// was waited for. Other answers go on being waited for, but for those to a page, which closes now.
    pub(in crate::tui::runtime) fn give_up(&mut self, pages: usize) -> Option<String> {
        let is_of_page = |asked: &Option<usize>| asked.is_none_or(|asked| asked >= pages);
        self.asked.front().filter(|asked| is_of_page(asked))?;
        self.asked.pop_front();
        if pages > 0 {
            let others = self.asked.iter_mut();
            others
                .filter(|asked| is_of_page(asked))
                .for_each(|asked| *asked = None);
        }
        let given_up = self.queue.abandon_first();
        // Without another thread the others are lost.
        self.asked.truncate(self.queue.len());
        given_up
    }

    /// What is waited for, if it takes long.
    pub(in crate::tui::runtime) fn status(&self) -> Option<String> {
        let status = self.queue.status()?;
        Some(status + "; Esc gives up")
    }

    /// When to look at that again; None if nothing is waited for.
    pub(in crate::tui::runtime) fn next_check(&self) -> Option<Instant> {
        self.queue.next_check()
    }
}
