//! The regions of an imprint: its pieces, and its holes.
//!
//! An **exterior** is an 8-connected component of the active taxels. A **hole** is a 4-connected component of the
//! inactive ones that does not reach the outside; an inactive taxel on the rim of the matrix belongs to the outside.
//! Exteriors come first, then holes, each in reading order of their first taxel. Each region is described as a shape
//! of its own: `filled` is the region with everything that its own exterior outline encloses.
//!
//! Floods work on whole rows: a run of taxels that is entered anywhere is filled at once by the carry of an addition.

use std::borrow::Cow;

use crate::imprint::{Bounds, Imprint};

/// What a region is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RegionKind {
    /// A piece of the object.
    Exterior,
    /// A hole in it.
    Hole,
}

impl RegionKind {
    /// Its name, in JSON and on the screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exterior => "exterior",
            Self::Hole => "hole",
        }
    }
}

/// A piece or a hole; never empty. Its taxels may be borrowed: an imprint is half a kilobyte.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region<'a> {
    kind: RegionKind,
    taxels: Cow<'a, Imprint>,
    filled: Cow<'a, Imprint>,
    bounds: Bounds,
}

impl<'a> Region<'a> {
    fn borrowed(
        kind: RegionKind,
        taxels: &'a Imprint,
        filled: &'a Imprint,
        bounds: Bounds,
    ) -> Self {
        Self {
            kind,
            taxels: Cow::Borrowed(taxels),
            filled: Cow::Borrowed(filled),
            bounds,
        }
    }

    /// The same with taxels of its own.
    pub fn into_owned(self) -> Region<'static> {
        Region {
            kind: self.kind,
            taxels: Cow::Owned(self.taxels.into_owned()),
            filled: Cow::Owned(self.filled.into_owned()),
            bounds: self.bounds,
        }
    }

    /// Whether it is a piece or a hole.
    pub fn kind(&self) -> RegionKind {
        self.kind
    }

    /// Its taxels, on a matrix of the imprint's size.
    pub fn taxels(&self) -> &Imprint {
        &self.taxels
    }

    /// Its taxels and everything that its exterior outline encloses.
    pub fn filled(&self) -> &Imprint {
        &self.filled
    }

    /// The smallest rectangle of whole taxels around it.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }
}

/// All regions of an imprint, exteriors first. Empty for an empty imprint.
///
/// ```
/// use taxel::prelude::*;
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

/// Shows all regions of an imprint one after another, in the order of [`regions`], and allocates nothing.
///
/// ```
/// use taxel::prelude::*;
/// let two: Imprint = "##.#".parse().unwrap();
/// let mut counts = Vec::new();
/// each_region(&two, |region| counts.push(Description::of(region).na));
/// assert_eq!(counts, [2, 1]);
/// ```
pub fn each_region(imprint: &Imprint, mut visit: impl FnMut(&Region)) {
    let Some(bounds) = imprint.bounds() else {
        return;
    };
    let mut holes = Imprint::empty(imprint.columns(), imprint.rows());
    let Some(holes_bounds) = enclosed(imprint, bounds, &mut holes) else {
        if is_stack(imprint, bounds, true) {
            visit(&Region::borrowed(
                RegionKind::Exterior,
                imprint,
                imprint,
                bounds,
            ));
        } else {
            pieces(imprint, bounds, RegionKind::Exterior, false, &mut visit);
        }
        return;
    };
    let mut filled = *imprint;
    unite(&mut filled, &holes, holes_bounds);
    if is_stack(&filled, bounds, true) && is_runs(&holes, holes_bounds) {
        visit(&Region::borrowed(
            RegionKind::Exterior,
            imprint,
            &filled,
            bounds,
        ));
    } else {
        pieces(imprint, bounds, RegionKind::Exterior, true, &mut visit);
    }
    if is_stack(&holes, holes_bounds, false) {
        visit(&Region::borrowed(
            RegionKind::Hole,
            &holes,
            &holes,
            holes_bounds,
        ));
    } else {
        pieces(&holes, holes_bounds, RegionKind::Hole, true, &mut visit);
    }
}

/// The index of the main region, which is selected at the start and described by sweeps: the exterior with the largest
/// filled area, the first of equals. None if there are no exteriors.
pub fn main_region(regions: &[Region]) -> Option<usize> {
    let exteriors = regions
        .iter()
        .enumerate()
        .filter(|(_, region)| region.kind == RegionKind::Exterior);
    let largest = |best: Option<(usize, u32)>, (index, region): (usize, &Region)| {
        let area = region.filled.count();
        if is_main(area, best.map(|(_, area)| area)) {
            Some((index, area))
        } else {
            best
        }
    };
    exteriors.fold(None, largest).map(|(index, _)| index)
}

/// The rule of the main region, for exteriors one after another: whether one with this filled area takes the place of
/// the best so far. The first of equals stays.
pub(crate) fn is_main(area: u32, best: Option<u32>) -> bool {
    best.is_none_or(|best| area > best)
}

/// Whether every row within the bounds is one run that meets the next row's: then it is one piece without holes.
///
/// Nearly every imprint of one figure is such a stack of runs once it is filled. If its holes have one run at most in
/// each row, the imprint itself is one piece too: what is left of the runs beside a hole meets what is left of them in
/// the next row, since otherwise the hole would be open there.
fn is_stack(matrix: &Imprint, bounds: Bounds, diagonal: bool) -> bool {
    let mut above = u64::MAX;
    rows(matrix, bounds).iter().all(|&word| {
        let near = if diagonal {
            above | above << 1 | above >> 1
        } else {
            above
        };
        above = word;
        near & word != 0 && is_run(word)
    })
}

/// Whether no row has more than one run.
fn is_runs(matrix: &Imprint, bounds: Bounds) -> bool {
    rows(matrix, bounds).iter().all(|&word| is_run(word))
}

/// Whether the set bits are next to each other: adding the lowest then carries out of all of them.
fn is_run(word: u64) -> bool {
    word & word.wrapping_add(word & word.wrapping_neg()) == 0
}

/// The rows within the bounds.
fn rows(matrix: &Imprint, bounds: Bounds) -> &[u64] {
    &matrix.words()[usize::from(bounds.top)..usize::from(bounds.bottom)]
}

/// Shows the connected components of a matrix in reading order: exteriors 8-connected, holes 4-connected. `enclose`
/// tells whether one of them may enclose anything: where a matrix has no hole none does, since what lies between a piece
/// and another one inside of it would be one.
fn pieces(
    matrix: &Imprint,
    bounds: Bounds,
    kind: RegionKind,
    enclose: bool,
    visit: &mut impl FnMut(&Region),
) {
    let (mut rest, mut piece) = (*matrix, Imprint::empty(matrix.columns(), matrix.rows()));
    let diagonal = kind == RegionKind::Exterior;
    let (mut top, bottom) = (usize::from(bounds.top), usize::from(bounds.bottom));
    while top < bottom {
        let open = &mut rest.words_mut()[top..bottom];
        let seeds = &mut piece.words_mut()[top..bottom];
        if open[0] == 0 {
            top += 1;
            continue;
        }
        seeds[0] = open[0] & open[0].wrapping_neg();
        let end = flood(seeds, open, 1, diagonal);
        for (open, seeds) in open.iter_mut().zip(&*seeds).take(end) {
            *open &= !seeds;
        }
        if let Some(bounds) = piece.bounds() {
            let mut holes = Imprint::empty(matrix.columns(), matrix.rows());
            let enclosed = enclose.then(|| enclosed(&piece, bounds, &mut holes));
            if let Some(holes_bounds) = enclosed.flatten() {
                let mut filled = piece;
                unite(&mut filled, &holes, holes_bounds);
                visit(&Region::borrowed(kind, &piece, &filled, bounds));
            } else {
                visit(&Region::borrowed(kind, &piece, &piece, bounds));
            }
        }
        piece.words_mut()[top..top + end].fill(0);
    }
}

/// Grows the seeds through the open taxels as far as they reach, given row by row. From row `end` on there are none at
/// first; the result is the row from which on there are none at last.
fn flood(seeds: &mut [u64], open: &[u64], mut end: usize, diagonal: bool) -> usize {
    let rows = seeds.len().min(open.len());
    let (seeds, open) = (&mut seeds[..rows], &open[..rows]);
    let grown = |old: u64, neighbour: u64, open: u64| {
        let near = if diagonal {
            neighbour | neighbour << 1 | neighbour >> 1
        } else {
            neighbour
        };
        let entered = (old | near) & open;
        if entered == old || entered == open {
            entered
        } else {
            spread(entered, open)
        }
    };
    let Some((first, &first_open)) = seeds.first_mut().zip(open.first()) else {
        return 0;
    };
    *first = spread(*first, first_open);
    loop {
        let mut above = seeds[0];
        for (row, (seeds, &open)) in seeds.iter_mut().zip(open).enumerate().skip(1) {
            *seeds = grown(*seeds, above, open);
            above = *seeds;
            if row >= end {
                if above == 0 {
                    break;
                }
                end = row + 1;
            }
        }
        let (mut below, mut changed) = (0, false);
        for (seeds, &open) in seeds[..end].iter_mut().zip(&open[..end]).rev() {
            let old = *seeds;
            *seeds = grown(old, below, open);
            below = *seeds;
            changed |= below != old;
        }
        if !changed {
            return end;
        }
    }
}

/// All runs of `open` that hold a bit of `seeds`, which lies inside of `open`.
fn spread(seeds: u64, open: u64) -> u64 {
    // Adding a seed to its run carries up to the run's end and turns every bit over on the way.
    let up = |seeds: u64, open: u64| (open ^ open.wrapping_add(seeds)) & open | seeds;
    up(seeds, open) | up(seeds.reverse_bits(), open.reverse_bits()).reverse_bits()
}

/// Puts the taxels that a matrix's active ones enclose, background that does not reach the rim, into `inner`, which is
/// empty and of the same size. Gives their bounds.
fn enclosed(matrix: &Imprint, bounds: Bounds, inner: &mut Imprint) -> Option<Bounds> {
    // What lies left of a row's first active taxel or right of its last one is outside. Of the rest, what is next to
    // the outside is outside as well, and so on.
    let (mut far_above, mut inner_above, mut open) = (u64::MAX, 0, 0);
    let (mut across, mut down) = (0, 0);
    for (row, &word) in (usize::from(bounds.top)..).zip(rows(matrix, bounds)) {
        let far = !span(word);
        let inside = !(far | word);
        if inside != 0 {
            inner.set_word(row, inside);
            down |= 1 << row;
        }
        across |= inside;
        open |= inside & far_above | inner_above & far;
        (far_above, inner_above) = (far, inside);
    }
    // Below the last row everything is outside.
    if open | inner_above != 0 {
        let mut outside = Imprint::empty(matrix.columns(), matrix.rows());
        for row in usize::from(bounds.top)..usize::from(bounds.bottom) {
            let far = |row: usize| !span(*matrix.words().get(row).unwrap_or(&0));
            let reached = inner.words()[row] & (far(row.wrapping_sub(1)) | far(row + 1));
            outside.set_word(row, spread(reached, inner.words()[row]));
        }
        let rows = usize::from(bounds.top)..usize::from(bounds.bottom);
        let seeds = &mut outside.words_mut()[rows.clone()];
        flood(seeds, &inner.words()[rows.clone()], rows.len(), false);
        for row in usize::from(bounds.top)..usize::from(bounds.bottom) {
            inner.set_word(row, inner.words()[row] & !outside.words()[row]);
        }
        return inner.bounds();
    }
    Bounds::around(across, down)
}

/// From the first set bit to the last, all set.
fn span(word: u64) -> u64 {
    if word == 0 {
        return 0;
    }
    u64::MAX << word.trailing_zeros() & u64::MAX >> word.leading_zeros()
}

/// Adds what lies within the bounds.
fn unite(matrix: &mut Imprint, other: &Imprint, bounds: Bounds) {
    for (row, &word) in (usize::from(bounds.top)..).zip(rows(other, bounds)) {
        matrix.set_word(row, matrix.words()[row] | word);
    }
}
