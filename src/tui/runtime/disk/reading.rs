//! The requests of the screen to read from the disk. A late answer goes to the page that asked for it.
//!
//! ```text
//! ask -> answer within a moment: the next message
//!        later: as soon as no other page stands above the one that asked
//!        Esc there: no longer waited for; the hanging thread is left to itself, and another one continues
//! ```

use std::collections::VecDeque;
use std::time::{Duration, Instant};

use crate::tui::runtime::disk::queue::DiskQueue;
use crate::tui::runtime::disk::request::{DiskAnswer, DiskRequest};

/// Requests to read, and their answers.
#[derive(Debug)]
pub(in crate::tui::runtime) struct Reader {
    /// The queue of the requests.
    pub(in crate::tui::runtime) queue: DiskQueue,
    /// The number of pages that were open when each request was made; None if its answer is not wanted any more.
    asked: VecDeque<Option<usize>>,
    /// The answers that wait for their page, each with that number.
    answers: VecDeque<(usize, DiskAnswer)>,
}

impl Reader {
    /// Returns a reader with a queue of its own, so that a save that hangs does not hold up reading.
    pub(in crate::tui::runtime) fn new(queue: DiskQueue) -> Self {
        Self {
            queue,
            asked: VecDeque::new(),
            answers: VecDeque::new(),
        }
    }

    /// Makes a request while this many pages are open. Returns the answer if it comes within a moment.
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

    /// Takes the next answer whose page is on top when this many pages are open.
    pub(in crate::tui::runtime) fn take(&mut self, pages: usize) -> Option<DiskAnswer> {
        while let Some(answer) = self.queue.wait(Duration::ZERO) {
            let asked = self.asked.pop_front().flatten();
            self.answers.extend(asked.map(|asked| (asked, answer)));
        }
        let mut waiting = self.answers.iter();
        let next = waiting.position(|(asked, _)| *asked >= pages)?;
        self.answers.remove(next).map(|(_, answer)| answer)
    }

    /// Stops waiting for the first request, if its page is on top when this many pages are open. Returns its
    /// description. A page closes then, so its other answers are dropped too; on the matrix they are still waited
    /// for.
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
        // If no other thread could be started, the other requests are lost.
        self.asked.truncate(self.queue.len());
        given_up
    }

    /// Returns the description of the request that is waited for, if it takes long.
    pub(in crate::tui::runtime) fn status(&self) -> Option<String> {
        let status = self.queue.status()?;
        Some(status + "; Esc gives up")
    }

    /// Returns when to check again on that request; None if nothing is waited for.
    pub(in crate::tui::runtime) fn next_check(&self) -> Option<Instant> {
        self.queue.next_check()
    }
}
