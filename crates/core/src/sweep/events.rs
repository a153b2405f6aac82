//! The events along one row of the grid: which taxels are active at its first x0, and which switch at which step.
//!
//! Events are stored in an unordered list for each step, and a bit per step says whether there are any. Playing them
//! back gives one imprint per run of steps without events.

use crate::atlas::Layout;
use crate::index::{index, narrow, wide};

#[derive(Clone, Debug)]
pub(crate) struct Events<'a> {
    pub(crate) layout: &'a Layout,
    count: u64,
    key: Vec<u64>,
    /// The hash of that imprint.
    hash: u64,
    /// A bit for each step: whether it has events. `last` is the last event of each step, or `NONE`.
    marked: Vec<u64>,
    last: Vec<u32>,
    /// All events; the events of a step are chained.
    list: Vec<Event>,
}

#[derive(Clone, Copy, Debug)]
struct Event {
    mask: u64,
    /// The hash of this taxel alone. The hash of an imprint joins the hashes of its taxels by exclusive or.
    number: u64,
    word: u32,
    /// The event before it at the same step, or `NONE`.
    before: u32,
}

const NONE: u32 = u32::MAX;

impl<'a> Events<'a> {
    /// Creates a row without events.
    pub(crate) fn new(layout: &'a Layout, count: u64) -> Self {
        let steps = index(count);
        Self {
            layout,
            count,
            key: vec![0; layout.words()],
            hash: 0,
            marked: vec![0; steps.div_ceil(64)],
            last: vec![NONE; steps],
            list: Vec::new(),
        }
    }

    /// Begins another row. Playing back the previous one has cleared the marks.
    pub(crate) fn clear(&mut self) {
        self.key.fill(0);
        self.hash = 0;
        self.list.clear();
    }

    pub(crate) fn row(&mut self, row: usize) -> RowEvents<'_, 'a> {
        let (word, shift) = self.layout.slot(row);
        RowEvents {
            row,
            word: narrow(word),
            shift,
            numbers: self.layout.numbers(row),
            events: self,
        }
    }

    /// Calls `run` with the key, the hash, the first step and the step after the last of each run in turn, and clears
    /// the marks.
    pub(crate) fn play(&mut self, mut run: impl FnMut(&[u64], u64, u64, u64)) {
        let mut from = 0;
        for (place, marked) in self.marked.iter_mut().enumerate() {
            while *marked != 0 {
                let bit = marked.trailing_zeros();
                *marked &= *marked - 1;
                let step = place * 64 + wide(bit);
                run(&self.key, self.hash, from, step as u64);
                from = step as u64;
                let mut event = std::mem::replace(&mut self.last[step], NONE);
                while let Some(turned) = self.list.get(wide(event)) {
                    self.key[wide(turned.word)] ^= turned.mask;
                    self.hash ^= turned.number;
                    event = turned.before;
                }
            }
        }
        run(&self.key, self.hash, from, self.count);
    }
}

pub(crate) struct RowEvents<'e, 'a> {
    row: usize,
    word: u32,
    shift: usize,
    numbers: &'a [u64],
    events: &'e mut Events<'a>,
}

impl RowEvents<'_, '_> {
    pub(crate) fn columns(&self) -> usize {
        self.numbers.len()
    }

    /// Marks taxels that are active at the first step; a bit for each.
    pub(crate) fn start(&mut self, taxels: u64) {
        self.events.key[wide(self.word)] ^= taxels << self.shift;
        self.events.hash ^= self.events.layout.hash(self.row, taxels);
    }

    /// Marks that a taxel switches at a step, from 1 to the last.
    #[inline]
    pub(crate) fn flip(&mut self, column: usize, step: u32) {
        let events = &mut *self.events;
        let step = wide(step);
        let event = narrow(events.list.len());
        events.marked[step / 64] |= 1 << (step % 64);
        let before = std::mem::replace(&mut events.last[step], event);
        events.list.push(Event {
            mask: 1 << (self.shift + column),
            number: self.numbers[column],
            word: self.word,
            before,
        });
    }
}
