//! The features: the numbers for which statistics are computed. Each descriptor of [`DESCRIPTORS`] is one feature, or
//! several if it has parts.
//!
//! A point `cg` gives `cg_x` and `cg_y`; a rectangle `rect` gives `rect_left`, `rect_top`, `rect_right` and
//! `rect_bottom`; the two diagonals give `diagonals_1`, in (0, 90), and `diagonals_2`, in (90, 180). Neither comes near
//! the end of its range, so both count as plain numbers. Only the direction `cg_cd_direction` goes all around: it is
//! [`Feature::circular`].

use std::sync::LazyLock;

use crate::description::{DESCRIPTORS, Description, Descriptor, Dimension, Value};
use crate::description::{RegionKind, each_region, is_main};
use crate::imprint::Imprint;

/// A number that describes an imprint's main region.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Feature {
    /// The name in JSON and CSV.
    pub key: String,
    /// The descriptor of which it is a part.
    pub descriptor: &'static Descriptor,
    /// Whether it is a direction that goes all around, in degrees: then its mean and its deviation are circular.
    pub circular: bool,
    /// The index of the descriptor's part.
    part: usize,
}

impl Feature {
    /// Returns key and name for display, such as "na: active taxels".
    pub fn label(&self) -> String {
        format!("{}: {}", self.key, self.descriptor.name)
    }

    /// Returns the value of the feature; None if it does not exist. Only the feature's own descriptor is computed.
    pub fn value(&self, description: &Description) -> Option<f64> {
        let (mut index, mut found) = (0, None);
        each_part((self.descriptor.measure)(description), |value| {
            if index == self.part {
                found = Some(value);
            }
            index += 1;
        });
        found
    }
}

/// Returns all features, in the order of [`DESCRIPTORS`].
///
/// ```
/// use taxel::atlas::features;
/// let keys: Vec<&str> = features().iter().map(|feature| feature.key.as_str()).collect();
/// assert_eq!(keys[..8], ["na", "nae", "ce", "num_x", "num_y", "cg_x", "cg_y", "p"]);
/// assert_eq!(keys.len(), 23);
/// ```
pub fn features() -> &'static [Feature] {
    static ALL: LazyLock<Vec<Feature>> = LazyLock::new(all);
    &ALL
}

fn all() -> Vec<Feature> {
    // All descriptors of this imprint exist, so they show which parts each one has.
    let corner: Option<Imprint> = "##\n#.".parse().ok();
    let Some(sample) = corner.and_then(|corner| ImprintSummary::of(&corner).description) else {
        return Vec::new();
    };
    let mut all = Vec::new();
    for descriptor in DESCRIPTORS {
        let parts: &[&str] = match (descriptor.measure)(&sample) {
            Value::Point(_) => &["_x", "_y"],
            Value::Pair(_) => &["_1", "_2"],
            Value::Rect(_) => &["_left", "_top", "_right", "_bottom"],
            _ => &[""],
        };
        all.extend(parts.iter().enumerate().map(|(index, part)| Feature {
            key: format!("{}{part}", descriptor.key),
            descriptor,
            circular: descriptor.dimension == Dimension::Direction && part.is_empty(),
            part: index,
        }));
    }
    all
}

/// Calls `take` with the index in [`features`] and the value of each feature that has a value.
pub fn feature_values(description: &Description, mut take: impl FnMut(usize, f64)) {
    let mut index = 0;
    for descriptor in DESCRIPTORS {
        match (descriptor.measure)(description) {
            Value::None => index += 1,
            value => each_part(value, |part| {
                take(index, part);
                index += 1;
            }),
        }
    }
}

/// Calls `take` with each number of a value.
fn each_part(value: Value, mut take: impl FnMut(f64)) {
    match value {
        Value::None => {}
        Value::Count(count) => take(f64::from(count)),
        Value::Number(number) => take(number),
        Value::Point(point) => [point.x, point.y].into_iter().for_each(take),
        Value::Pair(pair) => pair.into_iter().for_each(take),
        Value::Rect(rect) => {
            let sides = [rect.left, rect.top, rect.right, rect.bottom];
            sides.into_iter().map(f64::from).for_each(take);
        }
    }
}

/// The number of regions of an imprint, and the description of its main region.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
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
            if is_main(region.bounds().area(), best) && is_main(region.area(), best) {
                summary.description = Some(Description::of(region));
            }
        });
        summary
    }
}
