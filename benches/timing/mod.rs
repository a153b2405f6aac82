//! How the benchmarks measure. What is compared runs in turn, round after round in one process, and the least time of
//! each counts. Other work on the machine only makes a run slower, and when it lasts, it slows all of them: so the
//! ratio of two least times says more than two averages that were measured one after the other.
#![allow(dead_code, reason = "every benchmark uses its own part of this one")]

use std::time::Instant;

use rustix::time::{ClockId, clock_gettime};

/// How long work is repeated for each measurement, in seconds; the clocks count nanoseconds.
const LONG_ENOUGH: f64 = 0.001;

/// The least times that some work has taken so far, in seconds; infinite before the first measurement.
#[derive(Clone, Copy)]
pub(crate) struct Least {
    /// The processor time of all threads of this process together, which other work disturbs least.
    pub(crate) processor: f64,
    /// The time on the clock.
    pub(crate) wall: f64,
}

impl Default for Least {
    fn default() -> Self {
        Self {
            processor: f64::INFINITY,
            wall: f64::INFINITY,
        }
    }
}

impl Least {
    /// Measures some work, which is done `times` times.
    pub(crate) fn measure<T>(&mut self, times: u32, work: impl FnOnce() -> T) -> T {
        let (processor, wall) = (processor_seconds(), Instant::now());
        let result = work();
        let wall = wall.elapsed().as_secs_f64();
        let processor = processor_seconds() - processor;
        let times = f64::from(times);
        self.processor = self.processor.min(processor / times);
        self.wall = self.wall.min(wall / times);
        result
    }

    /// Returns the processor time in nanoseconds.
    pub(crate) fn nanoseconds(&self) -> f64 {
        self.processor * 1e9
    }
}

fn processor_seconds() -> f64 {
    let now = clock_gettime(ClockId::ProcessCPUTime);
    #[expect(clippy::cast_precision_loss, reason = "times of a few minutes")]
    let seconds = now.tv_sec as f64 + now.tv_nsec as f64 / 1e9;
    seconds
}

/// Work that is measured in turn with other work.
pub(crate) struct Work<'a> {
    /// How many times the work is done for each measurement.
    times: u32,
    repeat: Box<dyn FnMut(u32) + 'a>,
}

impl<'a> Work<'a> {
    /// Does the work for the first time, and finds out how many times it has to be done to be measured.
    pub(crate) fn new(mut work: impl FnMut() + 'a) -> Self {
        // The loop is compiled together with the work; a call through a pointer each time would add to it.
        let mut repeat: Box<dyn FnMut(u32) + 'a> = Box::new(move |times| {
            for _ in 0..times {
                work();
            }
        });
        let mut times = 1;
        loop {
            let mut least = Least::default();
            least.measure(1, || repeat(times));
            if least.wall >= LONG_ENOUGH {
                return Self { times, repeat };
            }
            times *= 2;
        }
    }
}

/// Does each work in turn, for the given number of rounds.
pub(crate) fn in_turn<const N: usize>(rounds: usize, mut works: [Work<'_>; N]) -> [Least; N] {
    let mut least = [Least::default(); N];
    for _ in 0..rounds {
        for (work, least) in works.iter_mut().zip(&mut least) {
            least.measure(work.times, || (work.repeat)(work.times));
        }
    }
    least
}

/// Returns the argument after `--`, which selects rows by a part of their names; empty without one.
pub(crate) fn selected() -> String {
    let mut arguments = std::env::args().skip(1);
    // Cargo adds `--bench`.
    let selected = arguments.find(|argument| !argument.starts_with('-'));
    selected.unwrap_or_default()
}
