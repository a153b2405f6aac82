//! Estimates from a recording how often taxels flip, and which taxels are dead or stuck.

use crate::imprint::Imprint;

/// The number of frames needed to call a taxel stuck.
const ENOUGH: u64 = 10;

#[derive(Clone, Copy, Debug, Default)]
struct TaxelCounts {
    /// The number of frames in which no neighbour was active, and in how many of them the taxel was active.
    alone: (u64, u64),
    /// The number of frames in which three quarters of the neighbours were active, and in how many of them the taxel
    /// was active.
    amid: (u64, u64),
}

/// A counter of flips in the frames of a recording: how often taxels flip, and which taxels are dead or stuck.
///
/// If a taxel has the same state in the first and the last of three consecutive frames, it is assumed to have had that
/// state all the time: if it differs in the middle frame, it has *flipped*. If every taxel flips with probability e, a
/// share e(1−e) / (1 − 2e(1−e)) of these taxels differs, and this share determines e. A moving contact also changes
/// taxels, but rarely for only one frame. Frames of a contact at rest or of an empty sensor give the best estimate.
///
/// A taxel is *stuck on* if it is active whenever none of its neighbours is. It is *stuck off*, or dead, if it is never
/// active when three quarters of its neighbours are. There must be at least ten such frames, and one in a hundred may
/// be an exception. A hole of one taxel that never moves looks like a dead taxel.
///
/// A taxel with fewer than three neighbours is never called dead, because the straight edge of a contact at rest may
/// cover all of them. On a sensor of one row or one column two neighbours suffice, one on either side.
#[derive(Clone, Debug)]
pub struct FlipCounter {
    cells: Imprint,
    frames: u64,
    before: [Option<Imprint>; 2],
    repeated: u64,
    flips: u64,
    /// One for each of `cells`, row by row.
    taxels: Vec<TaxelCounts>,
}

/// The estimates from a recording, by the rules of [`FlipCounter`].
#[derive(Clone, Debug, PartialEq)]
pub struct FlipReport {
    /// The number of frames.
    pub frames: u64,
    /// The number of taxels.
    pub cells: u32,
    /// The number of cases in which a taxel had the same state in the previous and in the next frame.
    pub repeated: u64,
    /// The number of these cases in which it had another state in between.
    pub flips: u64,
    /// The probability that a taxel flips. None if it cannot be estimated: [`Self::repeated`] is 0, as with fewer than
    /// three frames, or the probability seems to be ½ or more.
    pub noise: Option<f64>,
    /// The standard error of [`Self::noise`], if flips are independent of each other.
    pub standard_error: Option<f64>,
    /// The taxels that are stuck on.
    pub stuck_on: Imprint,
    /// The taxels that are stuck off, or dead.
    pub stuck_off: Imprint,
}

impl FlipReport {
    /// Returns the taxels that carry no information: those that are stuck on or off.
    pub fn mask(&self) -> Imprint {
        self.stuck_on.union(&self.stuck_off)
    }
}

impl FlipCounter {
    /// Creates a counter for imprints in which these taxels exist.
    pub fn new(cells: Imprint) -> Self {
        Self {
            frames: 0,
            before: [None; 2],
            repeated: 0,
            flips: 0,
            taxels: cells.active().map(|_| TaxelCounts::default()).collect(),
            cells,
        }
    }

    /// Adds an imprint; an imprint of another size is ignored.
    pub fn add(&mut self, imprint: &Imprint) {
        if imprint.size() != self.cells.size() {
            return;
        }
        self.frames += 1;
        if let [Some(middle), Some(first)] = &self.before {
            let words = self.cells.words().iter().zip(first.words());
            let words = words.zip(middle.words()).zip(imprint.words());
            for (((cells, first), middle), last) in words {
                let same = !(first ^ last) & cells;
                self.repeated += u64::from(same.count_ones());
                self.flips += u64::from((same & (first ^ middle)).count_ones());
            }
        }
        self.before = [Some(*imprint), self.before[0]];
        self.count_neighbours(imprint);
    }

    fn count_neighbours(&mut self, imprint: &Imprint) {
        let (columns, rows) = (imprint.columns(), imprint.rows());
        let least = if columns == 1 || rows == 1 { 2 } else { 3 };
        for ((column, row), counts) in self.cells.active().zip(&mut self.taxels) {
            let (mut there, mut active) = (0, 0);
            for y in row.saturating_sub(1)..=(row + 1).min(rows - 1) {
                for x in column.saturating_sub(1)..=(column + 1).min(columns - 1) {
                    if (x, y) != (column, row) && self.cells.get(x, y) {
                        there += 1;
                        active += u32::from(imprint.get(x, y));
                    }
                }
            }
            let counts = if active == 0 {
                &mut counts.alone
            } else if 4 * active >= 3 * there && there >= least {
                &mut counts.amid
            } else {
                continue;
            };
            counts.0 += 1;
            counts.1 += u64::from(imprint.get(column, row));
        }
    }

    /// Returns the estimates from the frames so far.
    pub fn finish(&self) -> FlipReport {
        let mut stuck_on = Imprint::empty(self.cells.size());
        let mut stuck_off = stuck_on;
        // One frame in a hundred may show a flip.
        let is_stuck = |frames, flips| frames >= ENOUGH && flips <= frames / 100;
        for ((column, row), counts) in self.cells.active().zip(&self.taxels) {
            let TaxelCounts { alone, amid } = *counts;
            stuck_on.set(column, row, is_stuck(alone.0, alone.0 - alone.1));
            stuck_off.set(column, row, is_stuck(amid.0, amid.1));
        }
        let (noise, standard_error) = noise(self.flips, self.repeated).unzip();
        FlipReport {
            frames: self.frames,
            cells: self.cells.count(),
            repeated: self.repeated,
            flips: self.flips,
            noise,
            standard_error,
            stuck_on,
            stuck_off,
        }
    }
}

/// Returns the flip probability e at which the given share of repeated states differs, and its standard error: the
/// standard error of the share, times the slope of e as a function of the share.
///
/// A share p of `repeated` independent states would have the variance p (1 − p) / repeated. But each frame is the
/// first, the middle and the last of three, so states that are one or two frames apart are correlated. Let z be 1 − p
/// where a state is repeated and differs, −p where it is repeated and does not differ, and 0 elsewhere. The first case
/// has the probability a = e (1 − e) = p / (1 + 2p). Then z has the variance a (1 − p), and its covariances with the
/// next z and the one after that are a² (3 − 4p) and a p² (1 − 4a); these count twice. `related` is the sum divided by
/// a; the variance of the share is p / repeated times `related`.
#[expect(clippy::cast_precision_loss, reason = "an estimate")]
fn noise(flips: u64, repeated: u64) -> Option<(f64, f64)> {
    // Without repeated states, this and all that follows is NaN.
    let share = flips as f64 / repeated as f64;
    let growth = 1.0 + 2.0 * share;
    let a = share / growth;
    let related =
        1.0 - share + 2.0 * a * (3.0 - 4.0 * share) + 2.0 * share * share * (1.0 - 4.0 * a);
    let of_share = (flips.max(1) as f64 * related).sqrt() / repeated as f64;
    // (1 - 2e)²
    let square = 1.0 - 4.0 * a;
    let root = square.sqrt();
    (square > 0.0).then(|| ((1.0 - root) / 2.0, of_share / (growth * growth * root)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::MatrixSize;

    fn next(state: &mut u64) -> u64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        *state
    }

    #[test]
    fn the_standard_error_matches_the_spread_between_recordings() {
        let mut state = 3;
        let cells = Imprint::from_rows(["########"; 8].iter().copied()).expect("rows");
        for percent in [2, 10, 20, 30] {
            let mut recording = || {
                let mut counter = FlipCounter::new(cells);
                for _ in 0..40 {
                    let mut imprint = Imprint::empty(MatrixSize::of(8, 8));
                    for row in 0..8 {
                        for column in 0..8 {
                            imprint.set(column, row, next(&mut state) % 100 < percent);
                        }
                    }
                    counter.add(&imprint);
                }
                let report = counter.finish();
                let found = (report.noise, report.standard_error);
                (found.0.expect("below a half"), found.1.expect("as well"))
            };
            let found: Vec<(f64, f64)> = (0..400).map(|_| recording()).collect();
            let mean = found.iter().map(|own| own.0).sum::<f64>() / 400.0;
            let apart = found.iter().map(|own| (own.0 - mean).powi(2));
            let apart = (apart.sum::<f64>() / 399.0).sqrt();
            let error = found.iter().map(|own| own.1).sum::<f64>() / 400.0;
            // The deviation of 400 recordings is known to 3.5 %.
            assert!(
                (apart / error - 1.0).abs() < 0.11,
                "{percent} %: {apart}, {error}"
            );
        }
    }

    #[test]
    fn noise_and_stuck_taxels_are_found() {
        let rows = [
            "........", "..####..", "..####..", "..####..", "..####..", "........", "........",
            "........",
        ];
        let idle = Imprint::empty(MatrixSize::of(8, 8));
        let square = Imprint::from_rows(rows.iter().copied()).expect("rows");
        let cells = Imprint::from_rows(["########"; 8].iter().copied()).expect("rows");
        let mut counter = FlipCounter::new(cells);
        let mut state = 7;
        for frame in 0..4000 {
            let mut imprint = if frame % 400 < 200 { idle } else { square };
            for row in 0..8 {
                for column in 0..8 {
                    if next(&mut state) % 100 < 2 {
                        imprint.set(column, row, !imprint.get(column, row));
                    }
                }
            }
            imprint.set(7, 7, true);
            imprint.set(3, 3, false);
            counter.add(&imprint);
        }
        let report = counter.finish();
        let noise = report.noise.expect("an estimate");
        // Two of the 64 never flip.
        assert!((noise - 0.02 * 62.0 / 64.0).abs() < 0.001, "{noise}");
        assert!(report.standard_error.is_some_and(|error| error < 0.0005));
        assert_eq!((report.frames, report.cells), (4000, 64));
        let found = |imprint: &Imprint| (imprint.count(), imprint.get(7, 7), imprint.get(3, 3));
        assert_eq!(found(&report.stuck_on), (1, true, false));
        assert_eq!(found(&report.stuck_off), (1, false, true));
        assert_eq!(report.mask().count(), 2);
    }

    #[test]
    fn fewer_than_three_frames_give_no_estimate() {
        let cells = Imprint::from_rows(["##", "##"].iter().copied()).expect("rows");
        let mut counter = FlipCounter::new(cells);
        counter.add(&cells);
        counter.add(&cells);
        assert_eq!(counter.finish().noise, None);
        counter.add(&cells);
        let report = counter.finish();
        assert_eq!((report.noise, report.repeated), (Some(0.0), 4));
        assert_eq!(report.mask().count(), 0);
    }

    fn shown<const N: usize>(frames: [([&str; 3], usize); N]) -> FlipReport {
        let cells = Imprint::from_rows(["###"; 3].iter().copied()).expect("rows");
        let mut counter = FlipCounter::new(cells);
        for (rows, times) in frames {
            let imprint = Imprint::from_rows(rows.iter().copied()).expect("rows");
            (0..times).for_each(|_| counter.add(&imprint));
        }
        counter.finish()
    }

    #[test]
    fn a_taxel_is_dead_after_ten_frames_amid_three_quarters_of_its_neighbours() {
        // Six of the eight neighbours of the one in the middle.
        let amid = ["###", "#.#", "#.."];
        assert_eq!(shown([(amid, 9)]).stuck_off.count(), 0);
        let report = shown([(amid, 10)]);
        assert!(report.stuck_off.get(1, 1), "{}", report.stuck_off);
        let fewer = shown([(["###", "#.#", "..."], 10)]);
        assert!(!fewer.stuck_off.get(1, 1), "{}", fewer.stuck_off);
    }

    #[test]
    fn a_taxel_in_a_corner_may_be_dead_too() {
        // It has three neighbours.
        let report = shown([([".##", "###", "###"], 10)]);
        assert_eq!(report.stuck_off.to_string(), "#..\n...\n...");
    }

    #[test]
    fn a_taxel_between_two_others_of_a_single_row_may_be_dead_but_not_one_at_its_end() {
        let imprint = |row: &str| Imprint::from_rows([row].iter().copied()).expect("a row");
        let mut counter = FlipCounter::new(imprint("#####"));
        (0..10).for_each(|_| counter.add(&imprint(".#.#.")));
        assert_eq!(counter.finish().stuck_off.to_string(), "..#..");
    }

    #[test]
    fn a_taxel_that_is_stuck_on_may_flip_in_one_frame_of_a_hundred() {
        let (on, off) = (["...", ".#.", "..."], ["..."; 3]);
        let stuck_on = |times, gone| shown([(on, times), (off, gone)]).stuck_on.count();
        assert_eq!((stuck_on(9, 0), stuck_on(10, 0)), (0, 1));
        assert_eq!((stuck_on(98, 1), stuck_on(99, 1)), (0, 1));
    }

    #[test]
    fn the_standard_error_without_flips_is_that_with_one_flip() {
        let report = shown([(["###"; 3], 12)]);
        assert_eq!((report.noise, report.repeated), (Some(0.0), 90));
        assert_eq!(report.standard_error, Some(1.0 / 90.0));
    }
}
