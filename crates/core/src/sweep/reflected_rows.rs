//! The runs of rows that are images of rows swept before ([`crate::sweep::point_symmetry`]), read backwards.
//!
//! The image of a row has the same runs in reverse order, cut in two where the range of x0 wraps around. The imprint of
//! each run is turned by 180° and shifted by whole cells. The counts and their order are the same as if the row had
//! been swept itself.

use crate::atlas::{ImprintCounter, Layout};
use crate::index::{narrow, wide};
use crate::sweep::point_symmetry::PointSymmetry;

/// The runs of several rows. A run is the index of its imprint in a counter, and its length.
#[derive(Clone, Debug, Default)]
pub(crate) struct Runs {
    list: Vec<(u32, u32)>,
    /// The index of each row's first run.
    starts: Vec<usize>,
}

impl Runs {
    pub(crate) fn begin(&mut self) {
        self.starts.push(self.list.len());
    }

    pub(crate) fn push(&mut self, index: usize, length: u64) {
        self.list.push((narrow(index), narrow(length)));
    }

    /// Returns the runs of a row, counted from 0; empty for a row that does not exist.
    pub(crate) fn row(&self, row: usize) -> &[(u32, u32)] {
        let start = self.starts.get(row).copied().unwrap_or(self.list.len());
        let end = self.starts.get(row + 1).copied();
        &self.list[start..end.unwrap_or(self.list.len())]
    }
}

/// The images of the imprints of a task.
#[derive(Debug)]
pub(crate) struct ReflectedRows<'a> {
    layout: &'a Layout,
    half_turn: PointSymmetry,
    /// For each index in the counter, the indices of its images, by whether x0 and y0 wrap around.
    known: Vec<[Option<u32>; 4]>,
    key: Vec<u64>,
    /// The runs of the row being made. They are added when it is complete, because it is made from the rows before.
    row: Vec<(usize, u64)>,
}

impl<'a> ReflectedRows<'a> {
    pub(crate) fn new(layout: &'a Layout, half_turn: PointSymmetry) -> Self {
        Self {
            layout,
            half_turn,
            known: Vec::new(),
            key: vec![0; layout.words()],
            row: Vec::new(),
        }
    }

    /// Returns the row whose image this one is, and whether y0 wraps around on the way.
    pub(crate) fn source(&self, y: u64) -> (u64, bool) {
        self.half_turn.y.image(y)
    }

    /// Counts the image of a row; `first` is the number of its first pose.
    pub(crate) fn add(
        &mut self,
        counter: &mut ImprintCounter,
        runs: &mut Runs,
        (source, round): (usize, bool),
        first: u64,
    ) {
        let x = self.half_turn.x;
        self.row.clear();
        let mut pose = first;
        // Backwards from `last` to 0, then from the end to the value after `last`.
        for (part, after) in [(0..x.last + 1, false), (x.last + 1..x.count, true)] {
            let mut end = x.count;
            for &(index, length) in runs.row(source).iter().rev() {
                let start = end - u64::from(length);
                let length = end.min(part.end).saturating_sub(start.max(part.start));
                end = start;
                if length == 0 {
                    continue;
                }
                let image = self.image(counter, wide(index), [after, round], pose);
                counter.count(image, length);
                self.row.push((image, length));
                pose += length;
            }
        }
        for &(index, length) in &self.row {
            runs.push(index, length);
        }
    }

    /// Returns the index of an imprint's image. If the image is new, pose `first` is its first one.
    fn image(
        &mut self,
        counter: &mut ImprintCounter,
        index: usize,
        after: [bool; 2],
        first: u64,
    ) -> usize {
        if self.known.len() <= index {
            self.known.resize(index + 1, [None; 4]);
        }
        let slot = &mut self.known[index][usize::from(after[0]) + 2 * usize::from(after[1])];
        let image = slot.get_or_insert_with(|| {
            let cells = [
                self.half_turn.x.cells(after[0]),
                self.half_turn.y.cells(after[1]),
            ];
            let hash = self
                .layout
                .half_turned(counter.key(index), cells, &mut self.key);
            let image = counter.add(&self.key, hash, 0, first);
            narrow(image)
        });
        wide(*image)
    }
}
