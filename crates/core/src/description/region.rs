//! The regions of an imprint: its pieces and its holes.
//!
//! Each region is found by a flood fill. Floods work on whole rows: if a flood enters a run of taxels anywhere, the
//! carry of an addition fills the whole run at once.

use std::borrow::Cow;
use std::cmp::Reverse;

use crate::imprint::{Bounds, Imprint};
use crate::parameter::named;

/// The kind of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RegionKind {
    /// A piece of the object: an 8-connected component of the active taxels.
    Exterior,
    /// A hole in the object: a 4-connected component of the inactive taxels that does not reach the outside. An
    /// inactive taxel on the rim of the matrix belongs to the outside.
    Hole,
}

named!(RegionKind, "region", [Exterior "exterior", Hole "hole"]);

/// A piece or a hole; never empty. The region may borrow its taxels, because an imprint takes half a kilobyte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region<'a> {
    kind: RegionKind,
    taxels: Cow<'a, Imprint>,
    filled: Option<Cow<'a, Imprint>>,
    bounds: Bounds,
}

impl<'a> Region<'a> {
    fn borrowed(
        kind: RegionKind,
        taxels: &'a Imprint,
        filled: Option<&'a Imprint>,
        bounds: Bounds,
    ) -> Self {
        Self {
            kind,
            taxels: Cow::Borrowed(taxels),
            filled: filled.map(Cow::Borrowed),
            bounds,
        }
    }

    /// Returns the same region with its own copy of the taxels.
    pub fn into_owned(self) -> Region<'static> {
        Region {
            kind: self.kind,
            taxels: Cow::Owned(self.taxels.into_owned()),
            filled: self.filled.map(|filled| Cow::Owned(filled.into_owned())),
            bounds: self.bounds,
        }
    }

    /// Returns whether the region is a piece or a hole.
    pub fn kind(&self) -> RegionKind {
        self.kind
    }

    /// Returns the taxels of the region, on a matrix of the imprint's size.
    pub fn taxels(&self) -> &Imprint {
        &self.taxels
    }

    /// Returns the taxels of the region and everything that its outer outline encloses: for an exterior, also its holes
    /// and the pieces in them.
    pub fn filled(&self) -> &Imprint {
        self.filled.as_deref().unwrap_or(&self.taxels)
    }

    pub(crate) fn area(&self) -> u32 {
        let words = self.bounds.words(self.filled()).iter();
        words.map(|word| word.count_ones()).sum()
    }

    /// Returns the smallest rectangle of whole taxels around the region.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }
}

/// Returns all regions of an imprint: first the exteriors, then the holes, each in reading order of their first taxel.
/// Empty for an empty imprint.
///
/// ```
/// use taxel_core::prelude::*;
/// let ring: Imprint = "\
/// .##.
/// #..#
/// .##.".parse().unwrap();
/// let regions = regions(&ring);
/// assert_eq!(regions.iter().map(|region| region.kind()).collect::<Vec<_>>(), [RegionKind::Exterior, RegionKind::Hole]);
/// assert_eq!(regions[1].taxels().to_string(), "....\n.##.\n....");
/// ```
pub fn regions(imprint: &Imprint) -> Vec<Region<'static>> {
    let mut found = Vec::new();
    each_region(imprint, |region| found.push(region.clone().into_owned()));
    found
}

/// Calls `visit` with each region of an imprint, in the order of [`regions`], without allocating.
pub fn each_region(imprint: &Imprint, mut visit: impl FnMut(&Region)) {
    let Some(bounds) = imprint.bounds() else {
        return;
    };
    // The taxels around a hole are 8-connected, so a single piece encloses it.
    let mut holes: Option<Imprint> = None;
    components(imprint, bounds, RegionKind::Exterior, |piece| {
        if let Some(filled) = &piece.filled {
            let bounds = piece.bounds;
            let holes = holes.get_or_insert_with(|| Imprint::empty(imprint.size()));
            let holes = rows_mut(holes, bounds).iter_mut();
            let inside = bounds.words(filled).iter().zip(bounds.words(imprint));
            for (hole, (filled, active)) in holes.zip(inside) {
                *hole |= filled & !active;
            }
        }
        visit(piece);
    });
    if let Some(holes) = &holes
        && let Some(bounds) = holes.bounds()
    {
        components(holes, bounds, RegionKind::Hole, visit);
    }
}

/// Returns the index of the main region, the one that is selected first and that sweeps describe: the exterior with the
/// largest filled area, or the first of several equal ones. None if there are no exteriors.
pub fn main_region(regions: &[Region]) -> Option<usize> {
    let regions = regions.iter().enumerate();
    let exteriors = regions.filter(|(_, region)| region.kind == RegionKind::Exterior);
    let main = exteriors.max_by_key(|&(index, region)| (region.area(), Reverse(index)));
    main.map(|(index, _)| index)
}

fn rows_mut(matrix: &mut Imprint, bounds: Bounds) -> &mut [u64] {
    &mut matrix.words_mut()[usize::from(bounds.top)..usize::from(bounds.bottom)]
}

/// Calls `visit` with the connected components of a matrix in reading order: exteriors 8-connected, holes 4-connected.
fn components(matrix: &Imprint, bounds: Bounds, kind: RegionKind, mut visit: impl FnMut(&Region)) {
    let none = || Imprint::empty(matrix.size());
    let [apart, gaps] = breaks(bounds.words(matrix), kind);
    if !apart {
        if gaps {
            show_filled(kind, matrix, bounds, &mut none(), visit);
        } else {
            visit(&Region::borrowed(kind, matrix, None, bounds));
        }
        return;
    }
    // All pieces use the same memory. Only the rows that were written are cleared.
    let (mut rest, mut piece, mut filled) = (*matrix, none(), none());
    let bottom = usize::from(bounds.bottom);
    for top in usize::from(bounds.top)..bottom {
        while rest.words()[top] != 0 {
            let open = &mut rest.words_mut()[top..bottom];
            let seeds = &mut piece.words_mut()[top..bottom];
            seeds[0] = spread(open[0] & open[0].wrapping_neg(), open[0]);
            let end = flood(seeds, open, 1, kind);
            // A single pass computes everything that is needed of the piece. A processor predicts the number of rows
            // badly, so several passes would cost more.
            let (mut across, mut runs) = (0, true);
            for (open, &taxels) in open.iter_mut().zip(&*seeds).take(end) {
                *open &= !taxels;
                across |= taxels;
                runs &= behind_gap(taxels) == 0;
            }
            if let Some(bounds) = Bounds::around(across, top, end) {
                if runs {
                    visit(&Region::borrowed(kind, &piece, None, bounds));
                } else {
                    show_filled(kind, &piece, bounds, &mut filled, &mut visit);
                    rows_mut(&mut filled, bounds).fill(0);
                }
            }
            piece.words_mut()[top..top + end].fill(0);
        }
    }
}

/// Calls `visit` with a component of which some rows are not single runs, and with its filled region. `filled` must be
/// empty.
fn show_filled(
    kind: RegionKind,
    piece: &Imprint,
    bounds: Bounds,
    filled: &mut Imprint,
    mut visit: impl FnMut(&Region),
) {
    let encloses = fill(piece, bounds, filled);
    visit(&Region::borrowed(
        kind,
        piece,
        encloses.then_some(&*filled),
        bounds,
    ));
}

/// Returns whether some rows may be apart, and whether a row has gaps. They hang together if the first row is one run,
/// and every run of another row meets the row above: this holds for nearly every imprint of one figure, and for most
/// holes. So all rows are examined in one pass without branches.
fn breaks(rows: &[u64], kind: RegionKind) -> [bool; 2] {
    let mut above = rows.first().map_or(0, |first| first & first.wrapping_neg());
    let (mut missed, mut gaps) = (0, 0);
    for &word in rows {
        missed |= missed_runs(near(above, kind) & word, word);
        gaps |= behind_gap(word);
        above = word;
    }
    [missed != 0, gaps != 0]
}

/// Returns the columns of the next row that are neighbours of a row's taxels: a piece is 8-connected, a hole
/// 4-connected.
fn near(word: u64, kind: RegionKind) -> u64 {
    match kind {
        RegionKind::Hole => word,
        RegionKind::Exterior => word | word << 1 | word >> 1,
    }
}

fn behind_gap(word: u64) -> u64 {
    word & word.wrapping_add(word & word.wrapping_neg())
}

/// Returns the last bit of each run of `open` that contains no bit of `seeds`; all seeds are in `open`.
fn missed_runs(seeds: u64, open: u64) -> u64 {
    // Adding a seed to its run carries up to the run's end and flips the bits on the way, including the last one unless
    // it is another seed.
    let last = open & !(open >> 1);
    let reached = open ^ open.wrapping_add(seeds) | seeds;
    last & !reached
}

/// Returns all runs of `open` that contain a bit of `seeds`; all seeds are in `open`.
fn spread(mut seeds: u64, open: u64) -> u64 {
    let mut all = 0;
    // Each pass adds one run, from the last gap below its lowest seed to the end of the carry of this seed.
    while seeds != 0 {
        let seed = seeds & seeds.wrapping_neg();
        let gaps = !open & (seed - 1);
        let below = (seed - 1) & u64::MAX.unbounded_shl(u64::BITS - gaps.leading_zeros());
        let above = (open ^ open.wrapping_add(seed)) & open;
        all |= below | above;
        seeds &= !all;
    }
    all
}

/// Grows the seeds through the open taxels as far as they reach, row by row. The seeds are whole runs, and none are in
/// row `end` or below. Returns the first row from which on there are none after growing.
fn flood(seeds: &mut [u64], open: &[u64], mut end: usize, kind: RegionKind) -> usize {
    // Passes down through the rows, then up, and so on, until no taxel is left to reach.
    loop {
        let mut wave = Wave::new(kind);
        for (row, (seeds, &open)) in seeds.iter_mut().zip(open).enumerate() {
            wave.enter(seeds, open);
            if row >= end {
                if *seeds == 0 {
                    break;
                }
                end = row + 1;
            }
        }
        if wave.left == 0 {
            return end;
        }
        let mut wave = Wave::new(kind);
        for (seeds, &open) in seeds[..end].iter_mut().zip(&open[..end]).rev() {
            wave.enter(seeds, open);
        }
        if wave.left == 0 {
            return end;
        }
    }
}

/// A flood that moves through the rows in one direction.
struct Wave {
    kind: RegionKind,
    /// The seeds of the previous row.
    seeds: u64,
    /// The open taxels of the previous row that are not seeds.
    dry: u64,
    /// The columns of open taxels in earlier rows that now have a seed next to them. Only a wave in the other direction
    /// reaches them.
    left: u64,
}

impl Wave {
    fn new(kind: RegionKind) -> Self {
        Self {
            kind,
            seeds: 0,
            dry: 0,
            left: 0,
        }
    }

    fn enter(&mut self, seeds: &mut u64, open: u64) {
        let entered = (*seeds | near(self.seeds, self.kind)) & open;
        if entered != *seeds {
            *seeds = if missed_runs(entered, open) == 0 {
                open
            } else {
                spread(entered, open)
            };
        }
        self.left |= near(*seeds, self.kind) & self.dry;
        (self.seeds, self.dry) = (*seeds, open & !*seeds);
    }
}

/// Writes a component and the background that it encloses (background that does not reach the rim) into `filled`, which
/// is empty and has the same size. Returns true if the component encloses anything.
fn fill(piece: &Imprint, bounds: Bounds, filled: &mut Imprint) -> bool {
    let words = bounds.words(piece);
    let filled = rows_mut(filled, bounds);
    // Everything left of a row's first taxel or right of its last one is outside. Other inactive taxels are outside if
    // they are next to the outside, and so on. Everything above the first row and below the last one is outside.
    let (mut met, mut span_above, mut inner_above) = (0, 0, 0);
    for (filled, &word) in filled.iter_mut().zip(words) {
        *filled = span(word);
        let inner = *filled & !word;
        met |= inner & !span_above | inner_above & !*filled;
        (span_above, inner_above) = (*filled, inner);
    }
    if met | inner_above == 0 {
        return true;
    }
    let mut inner = Imprint::empty(piece.size());
    let mut outside = Imprint::empty(piece.size());
    let (inner, outside) = (rows_mut(&mut inner, bounds), rows_mut(&mut outside, bounds));
    for (row, &word) in words.iter().enumerate() {
        let far = |row: usize| !filled.get(row).unwrap_or(&0);
        inner[row] = filled[row] & !word;
        let met = inner[row] & (far(row.wrapping_sub(1)) | far(row + 1));
        outside[row] = spread(met, inner[row]);
    }
    flood(outside, inner, words.len(), RegionKind::Hole);
    let mut enclosed = 0;
    for ((filled, outside), inner) in filled.iter_mut().zip(outside).zip(inner) {
        *filled &= !*outside;
        enclosed |= *filled & *inner;
    }
    enclosed != 0
}

/// Returns the bits from the first set bit to the last one, all set.
fn span(word: u64) -> u64 {
    if word == 0 {
        return 0;
    }
    u64::MAX << word.trailing_zeros() & u64::MAX >> word.leading_zeros()
}

#[cfg(test)]
mod tests {
    #[test]
    fn taxels_apart_are_regions_of_their_own() {
        use crate::prelude::*;
        let two: Imprint = "##.#".parse().expect("a row");
        let mut counts = Vec::new();
        each_region(&two, |region| counts.push(Description::of(region).na));
        assert_eq!(counts, [2, 1]);
    }
}
