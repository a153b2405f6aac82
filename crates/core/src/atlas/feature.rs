//! The features: the numbers for which statistics are computed. Each descriptor of [`DESCRIPTORS`] is one feature, or
//! several if it has parts.
//!
//! A point `cg` gives `cg_x` and `cg_y`; a rectangle `rect` gives `rect_left`, `rect_top`, `rect_right` and
//! `rect_bottom`; the two diagonals give `diagonals_1`, in (0, 90), and `diagonals_2`, in (90, 180). Neither comes near
//! the end of its range, so both count as plain numbers. Only the direction `cg_cd_direction` goes all around: it is
//! [`Feature::circular`].

use std::sync::LazyLock;

use crate::description::{DESCRIPTORS, Description, Descriptor, Dimension};
use crate::description::{RegionKind, each_region};
use crate::imprint::Imprint;

/// A number that describes an imprint's main region.
#[derive(Clone, Debug)]
pub struct Feature {
    /// The name in JSON and CSV.
    pub key: String,
    /// The descriptor of which it is a part.
    pub descriptor: &'static Descriptor,
    /// Whether it is a direction that goes all around, in degrees: then its mean and its deviation are circular.
    pub circular: bool,
    part: usize,
}

impl Feature {
    /// Returns the value of the feature; None if it does not exist. Only the feature's own descriptor is computed.
    pub fn value(&self, description: &Description) -> Option<f64> {
        let (mut index, mut found) = (0, None);
        (self.descriptor.measure)(description).each(|value| {
            if index == self.part {
                found = Some(value);
            }
            index += 1;
        });
        found
    }
}

/// Returns all features, in the order of [`DESCRIPTORS`].
pub fn features() -> &'static [Feature] {
    static ALL: LazyLock<Vec<Feature>> = LazyLock::new(all);
    &ALL
}

fn all() -> Vec<Feature> {
    let features = DESCRIPTORS.iter().flat_map(|descriptor| {
        let parts = descriptor.parts.iter().enumerate();
        parts.map(move |(part, suffix)| Feature {
            key: format!("{}{suffix}", descriptor.key),
            descriptor,
            circular: is_circular(descriptor),
            part,
        })
    });
    features.collect()
}

pub(crate) const FEATURE_COUNT: usize = {
    let (mut count, mut index) = (0, 0);
    while index < DESCRIPTORS.len() {
        count += DESCRIPTORS[index].parts.len();
        index += 1;
    }
    count
};

const fn is_circular(descriptor: &Descriptor) -> bool {
    matches!(descriptor.dimension, Dimension::Direction) && descriptor.parts.len() == 1
}

/// For each feature, the position of its first value in a row of values, and whether it is circular: then it has two.
pub(crate) const COLUMNS: [(usize, bool); FEATURE_COUNT] = {
    let mut columns = [(0, false); FEATURE_COUNT];
    let (mut row, mut part, mut column, mut index) = (0, 0, 0, 0);
    while index < FEATURE_COUNT {
        if part == DESCRIPTORS[row].parts.len() {
            (row, part) = (row + 1, 0);
        }
        let circular = is_circular(&DESCRIPTORS[row]);
        columns[index] = (column, circular);
        column += if circular { 2 } else { 1 };
        (part, index) = (part + 1, index + 1);
    }
    columns
};

/// The number of values of all features.
pub(crate) const ROW_WIDTH: usize = {
    let (column, circular) = COLUMNS[FEATURE_COUNT - 1];
    column + if circular { 2 } else { 1 }
};

/// Calls `take` with the index in [`features`] and the value of each feature that has a value.
pub fn feature_values(description: &Description, mut take: impl FnMut(usize, f64)) {
    let mut first = 0;
    for descriptor in DESCRIPTORS {
        let mut indices = first..first + descriptor.parts.len();
        first = indices.end;
        (descriptor.measure)(description).each(|value| {
            if let Some(index) = indices.next() {
                take(index, value);
            }
        });
    }
}

/// The number of regions of an imprint, and the description of its main region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImprintSummary {
    /// The number of 8-connected pieces.
    pub pieces: u16,
    /// The number of holes.
    pub holes: u16,
    /// The description of the main region; None for an empty imprint.
    pub description: Option<Description>,
}

impl ImprintSummary {
    /// Counts the regions of an imprint and describes its main region.
    pub fn of(imprint: &Imprint) -> Self {
        let mut summary = Self {
            pieces: 0,
            holes: 0,
            description: None,
        };
        each_region(imprint, |region| {
            if region.kind() == RegionKind::Hole {
                summary.holes = summary.holes.saturating_add(1);
                return;
            }
            summary.pieces = summary.pieces.saturating_add(1);
            let best = summary.description.as_ref().map(|best| best.nae);
            // For most pieces, the bounds alone show that they are too small.
            let is_larger = |area: u32| best.is_none_or(|best| area > best);
            if is_larger(region.bounds().area()) && is_larger(region.area()) {
                summary.description = Some(Description::of(region));
            }
        });
        summary
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::Value;

    /// Otherwise the numbers of a value would not belong to the features of its descriptor.
    #[test]
    fn every_value_has_the_parts_that_its_descriptor_states() {
        let mut measured = vec![0; DESCRIPTORS.len()];
        for rows in ["#", "##\n#.", "###\n#.#\n###"] {
            let imprint: Imprint = rows.parse().expect("rows");
            each_region(&imprint, |region| {
                let description = Description::of(region);
                for (descriptor, measured) in DESCRIPTORS.iter().zip(&mut measured) {
                    let mut numbers = 0;
                    (descriptor.measure)(&description).each(|_| numbers += 1);
                    let is_none = (descriptor.measure)(&description) == Value::None;
                    let stated = if is_none { 0 } else { descriptor.parts.len() };
                    assert_eq!(numbers, stated, "{} of {rows}", descriptor.key);
                    *measured += numbers;
                }
            });
        }
        assert!(measured.iter().all(|&numbers| numbers > 0), "{measured:?}");
    }

    #[test]
    fn a_feature_has_the_same_value_by_itself_and_among_all() {
        // A square: the direction from its centre of gravity to that of its rectangle does not exist.
        for rows in ["##\n##", "##\n#."] {
            let imprint = rows.parse().expect("rows");
            let description = ImprintSummary::of(&imprint).description;
            let description = description.expect("not empty");
            let mut all = vec![None; FEATURE_COUNT];
            feature_values(&description, |index, value| all[index] = Some(value));
            let single = features().iter().map(|own| own.value(&description));
            assert_eq!(all, single.collect::<Vec<_>>(), "{rows}");
        }
    }
}
