//! Filters the imprints of an atlas by an expression that the user types: `na>=40 holes=0 f<12`.

use std::borrow::Cow;
use std::cmp::Ordering;

use rayon::prelude::*;

use crate::atlas::distinct::Atlas;
use crate::atlas::feature::{Feature, ImprintSummary, features};
use crate::description::Dimension;
use crate::index::narrow;
use crate::parameter::number;
use crate::quote::{did_you_mean, shortened};

/// A filter of imprints, read from an expression such as `na>=40 holes=0 f<12`: conditions that must all hold.
///
/// ```text
/// na>=40 holes=0      blanks separate conditions; around the sign they do not matter
///  |  |  40           a number, in the unit of the feature; for a share also in percent, such as 50%
///  |  sign            = != < <= > >=
///  a feature as in JSON and CSV, or id, count (also: poses), pieces, holes; or the symbol of a descriptor that has one
///  number, such as Fill for filling; upper and lower case are the same
/// ```
/// `=` and `!=` compare as many decimals as were typed: `f=12.3`, or `f=1.23e1`, holds for 12.26 and for 12.34. If an
/// imprint has no value for a feature, it fulfils no condition on that feature.
///
/// ```
/// # use taxel_core::prelude::*;
/// use taxel_core::atlas::AtlasFilter;
/// let square = Source::Figure(Figure::default_of(FigureKind::Rectangle, &Sensor::default()));
/// let ranges = Ranges::default().with(Axis::Angle, "0".parse()?);
/// let grid = PoseGrid::new(square, Sensor::default(), Anchor::Corner, ranges)?;
/// let result = Sweep::new(&grid).run();
/// let atlas = &result.atlas;
/// // At angle 0 a rectangle 6 × 3 leaves 18 taxels, or 21 and more where it lies between them.
/// let filter: AtlasFilter = "na>18 holes=0".parse()?;
/// let kept = filter.keeps(&atlas).into_iter().filter(|&kept| kept).count();
/// assert!(0 < kept && kept < atlas.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Default)]
pub struct AtlasFilter {
    conditions: Vec<Condition>,
}

/// The error for text that is not an expression: what was found, and what was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FilterError(String);

/// Returns the end of a message: the text in place of a number, if there is one, and how to write a decimal comma.
fn advice(found: &str) -> String {
    let point = number::with_point(found);
    let advice = point.map_or_else(String::new, |number| format!("; write {number}"));
    match found {
        "" => String::new(),
        found => format!(", found {found:?}{advice}"),
    }
}

/// Returns the end of a message about an unknown name: the nearest name, if one is similar, and all names.
fn expected(found: &str) -> String {
    let symbols = features().iter().filter_map(Feature::symbol);
    let near = did_you_mean(found, names().into_iter().chain(symbols));
    let names = names().join(", ");
    match near.as_str() {
        "" => format!(", expected one of {names}"),
        near => format!("{near} All names: {names}"),
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Id,
    Count,
    Pieces,
    Holes,
    Feature(usize),
}

/// Returns true if a value and a number fulfil a relation; the last argument tells whether they count as equal.
type Relation = fn(f64, f64, bool) -> bool;

/// The signs. Where one sign begins with another, the longer one comes first.
const SIGNS: [(&str, Relation); 7] = [
    ("!=", |_, _, equal| !equal),
    ("<=", |value, number, _| value <= number),
    (">=", |value, number, _| value >= number),
    ("==", |_, _, equal| equal),
    ("=", |_, _, equal| equal),
    ("<", |value, number, _| value < number),
    (">", |value, number, _| value > number),
];

/// The names besides those of the features. The last one is a synonym of `count`.
const OWN_NAMES: [(&str, Quantity); 5] = [
    ("id", Quantity::Id),
    ("count", Quantity::Count),
    ("pieces", Quantity::Pieces),
    ("holes", Quantity::Holes),
    ("poses", Quantity::Count),
];

#[derive(Clone, Copy, Debug, PartialEq)]
struct Condition {
    quantity: Quantity,
    /// The index of the sign in [`SIGNS`].
    sign: usize,
    number: f64,
    /// Half of the last decimal that was typed: a value that differs from the number by at most this counts as equal.
    half: f64,
}

fn names() -> Vec<&'static str> {
    let features = features().iter().map(|feature| feature.key.as_str());
    features.chain(OWN_NAMES.map(|(name, _)| name)).collect()
}

impl Condition {
    fn holds(&self, value: f64) -> bool {
        let (_, relation) = SIGNS[self.sign];
        let equal = (value - self.number).abs() <= self.half;
        relation(value, self.number, equal)
    }
}

impl std::str::FromStr for AtlasFilter {
    type Err = FilterError;

    fn from_str(text: &str) -> Result<Self, FilterError> {
        let mut conditions = Vec::new();
        let mut rest = text.trim();
        while !rest.is_empty() {
            let (condition, after) = condition(rest)?;
            conditions.push(condition);
            rest = after.trim_start();
        }
        Ok(Self { conditions })
    }
}

impl AtlasFilter {
    /// Returns for each imprint of an atlas, in their order, whether it fulfils all conditions.
    pub fn keeps(&self, atlas: &Atlas) -> Vec<bool> {
        let counts: Vec<u64> = atlas.counts().collect();
        let rows = atlas.summaries().par_iter().zip(counts).enumerate();
        rows.with_min_len(1024)
            .map(|(id, (summary, count))| self.fits(id, count, summary))
            .collect()
    }

    #[expect(clippy::cast_precision_loss, reason = "compared with a typed number")]
    fn fits(&self, id: usize, count: u64, summary: &ImprintSummary) -> bool {
        self.conditions.iter().all(|condition| {
            let value = match condition.quantity {
                Quantity::Id => Some(id as f64),
                Quantity::Count => Some(count as f64),
                Quantity::Pieces => Some(summary.pieces.into()),
                Quantity::Holes => Some(summary.holes.into()),
                Quantity::Feature(index) => {
                    let description = summary.description.as_ref();
                    description.and_then(|description| features()[index].value(description))
                }
            };
            value.is_some_and(|value| condition.holds(value))
        })
    }
}

/// Words and signs that other languages write between conditions; upper and lower case are the same.
const JOINING: [&str; 5] = ["and", "or", "&", "&&", ","];

fn condition(text: &str) -> Result<(Condition, &str), FilterError> {
    let in_name = |c: char| c.is_alphanumeric() || "_-".contains(c);
    let (name, rest) = split_at(text, |c| !in_name(c));
    let Some(quantity) = quantity(name) else {
        let (word, _) = split_at(text, char::is_whitespace);
        let found = shortened(if name.is_empty() { word } else { name });
        let joins = |word: &&str| word.eq_ignore_ascii_case(&found);
        return Err(if JOINING.iter().any(joins) {
            joined(&found)
        } else {
            let expected = expected(&found);
            FilterError(format!("{found:?} is unknown here{expected}"))
        });
    };
    let rest = rest.trim_start();
    let Some(sign) = SIGNS.iter().position(|(sign, _)| rest.starts_with(sign)) else {
        let expected = "expected = != < <= > or >= after it";
        return Err(FilterError(format!("{name}: {expected}")));
    };
    let (text, _) = SIGNS[sign];
    let (typed, rest) = split_at(rest[text.len()..].trim_start(), char::is_whitespace);
    if typed.ends_with(',') {
        return Err(joined(","));
    }
    // The hundredth of a decimal, not of its rounded value: 70% is 0.7, but 70 * 0.01 is not.
    let is_share = matches!(quantity, Quantity::Feature(index)
        if features()[index].descriptor.dimension == Dimension::Share);
    let in_hundredths = typed.strip_suffix('%').filter(|_| is_share);
    let number = match in_hundredths {
        Some(number) => Cow::from(format!("{number}e-2")),
        None => Cow::from(typed),
    };
    let value = number.parse().ok().filter(|value: &f64| value.is_finite());
    let Some(value) = value else {
        let advice = advice(&shortened(typed));
        let message = format!("{name}{text}: expected a number after it{advice}");
        return Err(FilterError(message));
    };
    let condition = Condition {
        quantity,
        sign,
        number: value,
        half: half_a_unit(&number),
    };
    Ok((condition, rest))
}

fn joined(found: &str) -> FilterError {
    let advice = "write conditions side by side; all must hold, as in na>40 holes=0";
    FilterError(format!("{found:?}: {advice}"))
}

/// Splits a text at its first character that fulfils a condition.
fn split_at(text: &str, at: impl Fn(char) -> bool) -> (&str, &str) {
    text.split_at(text.find(at).unwrap_or(text.len()))
}

fn quantity(name: &str) -> Option<Quantity> {
    let feature = |named: fn(&Feature) -> Option<&str>| {
        let is_named = |own: &Feature| named(own).is_some_and(|own| own.eq_ignore_ascii_case(name));
        features().iter().position(is_named).map(Quantity::Feature)
    };
    let own = OWN_NAMES
        .iter()
        .find(|(own, _)| own.eq_ignore_ascii_case(name));
    feature(|feature| Some(feature.key.as_str()))
        .or(own.map(|&(_, quantity)| quantity))
        .or_else(|| feature(Feature::symbol))
}

/// Returns half of the last decimal of a number as it was typed. A number with an exponent has the decimals that it has
/// when written out: two in `1.166e1`, none in `4e1`.
fn half_a_unit(number: &str) -> f64 {
    let (mantissa, exponent) = number.split_once(['e', 'E']).unwrap_or((number, "0"));
    // An exponent that does not fit into 32 bits makes the number 0, which then has no last decimal.
    let Ok(exponent) = exponent.parse::<i32>() else {
        return 0.0;
    };
    let decimals = mantissa
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    let decimals = i32::try_from(decimals).unwrap_or(i32::MAX);
    let decimals = decimals.saturating_sub(exponent).max(0);
    // Slightly more than half, since the ends are decimals that `f64` cannot represent.
    0.5 * 10_f64.powi(-decimals) * (1.0 + 1e-9)
}

/// A key by which the imprints of an atlas can be sorted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SortKey<'a> {
    /// The number of the first pose, which is the order of the imprints' numbers too.
    FirstPose,
    /// The number of poses that leave an imprint.
    Poses,
    /// The number of pieces.
    Pieces,
    /// The number of holes.
    Holes,
    /// One value per imprint, such as those of a feature ([`Atlas::values`]); imprints beyond the end have no value.
    Value(&'a [Option<f64>]),
}

/// The direction in which imprints are sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SortDirection {
    /// The smallest comes first.
    Ascending,
    /// The largest comes first.
    Descending,
}

impl SortDirection {
    /// Returns the other direction.
    #[must_use]
    pub fn reversed(self) -> Self {
        match self {
            Self::Ascending => Self::Descending,
            Self::Descending => Self::Ascending,
        }
    }
}

/// Returns the numbers of all imprints, sorted by a key. In both directions, imprints with equal keys stay in the order
/// of their first poses, and those without a value come last.
pub fn sorted(atlas: &Atlas, by: SortKey<'_>, direction: SortDirection) -> Vec<u32> {
    let count = narrow(atlas.len());
    let summaries = |of: fn(&ImprintSummary) -> u16| -> Vec<Option<f64>> {
        let all = atlas.summaries().iter();
        all.map(|summary| Some(of(summary).into())).collect()
    };
    #[expect(clippy::cast_precision_loss, reason = "poses are below 2⁵³")]
    let keys = match by {
        SortKey::FirstPose => (0..count).map(|id| Some(f64::from(id))).collect(),
        SortKey::Poses => atlas.counts().map(|count| Some(count as f64)).collect(),
        SortKey::Pieces => summaries(|summary| summary.pieces),
        SortKey::Holes => summaries(|summary| summary.holes),
        SortKey::Value(values) => values.to_vec(),
    };
    let keys = keys.into_iter().chain(std::iter::repeat(None));
    let mut ids: Vec<(Option<f64>, u32)> = keys.zip(0..count).collect();
    // The sort is stable, and the numbers are in order already. Many keys are equal, which makes a stable sort faster.
    ids.sort_by(|(one, _), (other, _)| match (one, other) {
        (Some(one), Some(other)) if direction == SortDirection::Ascending => one.total_cmp(other),
        (Some(one), Some(other)) => other.total_cmp(one),
        (Some(_), None) => Ordering::Less,
        (None, Some(_)) => Ordering::Greater,
        (None, None) => Ordering::Equal,
    });
    ids.into_iter().map(|(_, id)| id).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Figure, FigureKind};
    use crate::pose::{Anchor, Axis, PoseGrid, Ranges};
    use crate::sensor::Sensor;
    use crate::source::Source;
    use crate::sweep::Sweep;

    /// A function that returns true if a value and a number fulfil a relation.
    type Rule = fn(f64, f64) -> bool;

    fn filter(text: &str) -> AtlasFilter {
        text.parse()
            .unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    /// Returns the atlas of a rectangle that leaves the sensor: some imprints are empty.
    fn atlas() -> Atlas {
        let figure = Figure::default_of(FigureKind::Rectangle, &Sensor::default());
        let range = |text: &str| text.parse().expect("a range");
        let ranges = Ranges::default()
            .with(Axis::X0, range("-8:15:0.5"))
            .with(Axis::Y0, range("7:8:0.25"))
            .with(Axis::Angle, range("0:30:30"));
        let source = Source::Figure(figure);
        let grid = PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges);
        Sweep::new(&grid.expect("in range")).run().atlas
    }

    #[test]
    fn every_sign_keeps_the_imprints_that_fulfil_it() {
        let atlas = atlas();
        for (index, feature) in features().iter().enumerate() {
            let values = atlas.values(index);
            let middle = values.iter().copied().flatten().nth(7).expect("a value");
            let middle = format!("{middle:.1}");
            let number: f64 = middle.parse().expect("a number");
            let rules: [(&str, Rule); 6] = [
                ("=", |value, number| (value - number).abs() <= 0.05),
                ("!=", |value, number| (value - number).abs() > 0.05),
                ("<", |value, number| value < number),
                ("<=", |value, number| value <= number),
                (">", |value, number| value > number),
                (">=", |value, number| value >= number),
            ];
            for (sign, rule) in rules {
                let text = format!("{}{sign}{middle}", feature.key);
                let kept = filter(&text).keeps(&atlas);
                for (value, kept) in values.iter().zip(kept) {
                    // At the ends of an interval, rounding decides.
                    let at_end =
                        value.is_some_and(|value| ((value - number).abs() - 0.05).abs() < 1e-6);
                    let expected = value.is_some_and(|value| rule(value, number));
                    assert!(at_end || kept == expected, "{text}: {value:?}");
                }
            }
        }
    }

    #[test]
    fn all_conditions_must_hold_and_an_empty_filter_keeps_everything() {
        let atlas = atlas();
        let count = |text: &str| {
            filter(text)
                .keeps(&atlas)
                .iter()
                .filter(|kept| **kept)
                .count()
        };
        assert_eq!(count(""), atlas.len());
        assert_eq!(count(" \t "), atlas.len());
        assert_eq!(count("id=3"), 1);
        assert_eq!(count("ID < 3  id>=1"), 2);
        assert_eq!(count("pieces=0"), 1, "the empty imprint");
        assert_eq!(count("pieces=0 na!=7"), 0, "it has no NA at all");
        assert_eq!(count("holes=0"), atlas.len());
        assert_eq!(count("count>1"), count("poses > 1"));
        let [low, high] = [count("na<15"), count("na >= 15")];
        assert_eq!(low + high + 1, atlas.len());
    }

    #[test]
    fn the_symbols_and_the_percent_of_the_screen_can_be_typed() {
        for (shown, key) in [
            ("Fill>0.5", "filling>0.5"),
            ("round>1", "roundness>1"),
            ("NumX>=3", "num_x>=3"),
            ("CG-CD<1", "cg_cd<1"),
            ("dir=90", "cg_cd_direction=90"),
            ("fill>50%", "filling>0.50"),
        ] {
            assert_eq!(filter(shown), filter(key), "{shown}");
        }
        // 64.3 % are as many decimals as 0.643.
        let atlas = atlas();
        assert_eq!(
            filter("fill=64.3%").keeps(&atlas),
            filter("fill=0.643").keeps(&atlas)
        );
        // Each percent is the decimal that it stands for.
        for percent in 0..=100 {
            let decimal = format!("fill>={}.{:02}", percent / 100, percent % 100);
            assert_eq!(filter(&format!("fill>={percent}%")), filter(&decimal));
        }
        // Only shares are shown in percent, and a part of a point has no symbol of its own.
        for wrong in ["na>50%", "fill>%", "cg>1"] {
            assert!(wrong.parse::<AtlasFilter>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn an_error_names_the_word_and_what_is_possible() {
        let error = |text: &str| text.parse::<AtlasFilter>().expect_err(text).to_string();
        assert_eq!(
            error("na>3 and holes=0"),
            "\"and\": write conditions side by side; all must hold, as in na>40 holes=0"
        );
        for text in ["na>3, holes=0", "na>3 , holes=0", "na>3 Or holes=0"] {
            assert!(error(text).contains("conditions side by side"), "{text}");
        }
        assert_eq!(error("na>="), "na>=: expected a number after it");
        assert_eq!(
            error("na>=4holes=0"),
            "na>=: expected a number after it, found \"4holes=0\""
        );
        assert!(error("f>2,5").ends_with("found \"2,5\"; write 2.5"));
        for text in ["na=inf", "na=nan", "na=1e999"] {
            assert!(error(text).contains("expected a number"), "{text}");
        }
    }

    #[test]
    fn equal_means_equal_in_the_decimals_that_were_typed() {
        let holds = |text: &str, value: f64| filter(text).conditions[0].holds(value);
        assert!(holds("f=12.3", 12.26) && holds("f=12.3", 12.34) && !holds("f=12.3", 12.36));
        assert!(holds("f!=12.3", 12.36) && holds("f=12", 12.36) && !holds("f=12.300", 12.26));
        // The same numbers with an exponent.
        assert!(holds("f=1.166e1", 11.6593) && !holds("f=1.166e1", 11.6651));
        assert!(holds("f=1166E-2", 11.6593) && !holds("f=1166E-2", 11.6651));
        assert!(holds("na=4e+1", 40.4) && !holds("na=4e1", 40.6));
        assert!(holds("cg_cd=0e99999999999", 0.0) && !holds("cg_cd=0e99999999999", 0.1));
    }

    #[test]
    fn every_imprint_comes_once_in_the_order_of_the_key() {
        let atlas = atlas();
        let count = u32::try_from(atlas.len()).expect("few");
        let values = atlas.values(0);
        assert_eq!(values.len(), atlas.len());
        assert!(values.contains(&None) && features()[0].key == "na");
        for by in [
            SortKey::FirstPose,
            SortKey::Poses,
            SortKey::Pieces,
            SortKey::Holes,
            SortKey::Value(&values),
        ] {
            for direction in [SortDirection::Ascending, SortDirection::Descending] {
                let ids = sorted(&atlas, by, direction);
                let mut all = ids.clone();
                all.sort_unstable();
                assert!(all.into_iter().eq(0..count), "{by:?}");
                let key = |id: u32| {
                    let entry = atlas.entry(id).expect("one of them");
                    #[expect(clippy::cast_precision_loss, reason = "small numbers")]
                    match by {
                        SortKey::FirstPose => Some(entry.first_pose as f64),
                        SortKey::Poses => Some(entry.count as f64),
                        SortKey::Pieces => Some(entry.summary.pieces.into()),
                        SortKey::Holes => Some(entry.summary.holes.into()),
                        SortKey::Value(_) => entry.summary.description.map(|one| one.na.into()),
                    }
                };
                for pair in ids.windows(2) {
                    let fits = match (key(pair[0]), key(pair[1])) {
                        (Some(one), Some(other)) if one == other => pair[0] < pair[1],
                        (Some(one), Some(other)) => {
                            (one < other) == (direction == SortDirection::Ascending)
                        }
                        (None, None) => pair[0] < pair[1],
                        (one, _) => one.is_some(),
                    };
                    assert!(fits, "{by:?}, {direction:?}: {pair:?}");
                }
            }
        }
    }

    #[test]
    fn imprints_without_a_value_come_last() {
        let atlas = atlas();
        let by = SortKey::Value(&[None, Some(2.0), Some(1.0)]);
        let ids = sorted(&atlas, by, SortDirection::Descending);
        assert_eq!(ids[..4], [1, 2, 0, 3]);
    }
}
