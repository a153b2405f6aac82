//! The probabilities of the shapes of a set after several touches.
//!
//! Without noise, the odds of a shape are a product of whole numbers, w Π n. They are compared exactly, so the order of
//! the touches does not matter, and shapes are tied only if their products are equal. Under noise, the odds are known
//! only as logarithms.

use std::cmp::Ordering;

use crate::index::lower_word;
use crate::parameter::number::share;
use crate::recognition::model::float;

/// Two logarithms of odds under noise that differ by at most this much for each touch are equal: rounding changes the
/// last digits.
const SAME: f64 = 1e-12;

pub(super) struct Posterior {
    /// The shapes of positive probability, the likeliest first; equally likely ones in the order of the set.
    pub(super) ranking: Vec<(usize, f64)>,
    /// The number of shapes at the beginning of the ranking that are equally likely.
    pub(super) likeliest: usize,
    /// The number of possible shapes. The ranking may have fewer: some probabilities may be too small for an `f64`.
    pub(super) possible: usize,
}

impl Posterior {
    pub(super) fn of_odds(mut odds: Vec<(usize, Odds)>) -> Self {
        odds.sort_by(|(_, one), (_, other)| other.cmp(one));
        let equal = |(_, one): &(usize, Odds), (_, other): &(usize, Odds)| one.cmp(other).is_eq();
        let products: Option<Vec<u128>> = odds.iter().map(|(_, odds)| odds.product()).collect();
        let total = products.as_ref().and_then(|all| {
            all.iter()
                .try_fold(0_u128, |sum, own| sum.checked_add(*own))
        });
        let ranking = if let (Some(products), Some(total)) = (products, total) {
            let shares = products.into_iter().map(|own| share(own, total));
            odds.iter().map(|&(shape, _)| shape).zip(shares).collect()
        } else {
            let mut least = f64::INFINITY;
            let logarithms = odds.chunk_by(equal).flat_map(|group| {
                // Rounding errors must neither part equal products nor change the order of others.
                least = group[0].1.logarithm.min(least);
                let logarithm = least;
                group.iter().map(move |&(shape, _)| (shape, logarithm))
            });
            normalised(logarithms.collect())
        };
        Self {
            likeliest: odds.chunk_by(equal).next().map_or(0, <[_]>::len),
            possible: odds.len(),
            ranking,
        }
    }

    /// The only possible shape; None if there are others, or none.
    pub(super) fn only(&self) -> Option<usize> {
        let first = self.ranking.first().filter(|_| self.possible == 1);
        first.map(|&(shape, _)| shape)
    }

    /// Creates a posterior from the logarithms of the odds after some touches; −∞ for odds of 0.
    pub(super) fn of_logarithms(logarithms: &[f64], touches: usize) -> Self {
        let all = logarithms.iter().copied().enumerate();
        let mut possible: Vec<(usize, f64)> = all.filter(|(_, own)| own.is_finite()).collect();
        possible.sort_by(|(_, one), (_, other)| other.total_cmp(one));
        let tolerance = SAME * float(touches.max(1) as u64);
        let equal = |(_, one): &(usize, f64), (_, other): &(usize, f64)| one - other <= tolerance;
        let mut likeliest = 0;
        for tied in possible.chunk_by_mut(equal) {
            if likeliest == 0 {
                likeliest = tied.len();
            }
            let greatest = tied[0].1;
            for (_, logarithm) in tied.iter_mut() {
                *logarithm = greatest;
            }
            tied.sort_by_key(|&(shape, _)| shape);
        }
        Self {
            likeliest,
            possible: possible.len(),
            ranking: normalised(possible),
        }
    }
}

/// Returns the probabilities of shapes, given the logarithms of their odds, the greatest first. Leaves out those that
/// are too small for an `f64`.
fn normalised(logarithms: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
    let most = logarithms.first().map_or(0.0, |&(_, most)| most);
    let mut odds = logarithms;
    for (_, own) in &mut odds {
        *own = libm::exp(*own - most);
    }
    // Added up in the order of the set, whatever the ranking.
    let mut in_order = odds.clone();
    in_order.sort_by_key(|&(shape, _)| shape);
    let sum: f64 = in_order.iter().map(|(_, own)| own).sum();
    let shares = odds.into_iter().map(|(shape, own)| (shape, own / sum));
    shares.filter(|&(_, share)| share > 0.0).collect()
}

#[derive(Clone, Debug)]
pub(super) struct Odds {
    /// The factors, in ascending order. None is 0.
    factors: Vec<u64>,
    /// The logarithm of the product, the same for every order of the touches.
    logarithm: f64,
}

impl Odds {
    pub(super) fn of(mut factors: Vec<u64>) -> Option<Self> {
        factors.sort_unstable();
        let logarithm = factors.iter().map(|&own| libm::log(float(own))).sum();
        let positive = factors.first().is_none_or(|&least| least > 0);
        positive.then_some(Self { factors, logarithm })
    }

    fn product(&self) -> Option<u128> {
        let mut factors = self.factors.iter();
        factors.try_fold(1_u128, |product, &own| product.checked_mul(own.into()))
    }

    /// Compares the products, exactly.
    fn cmp(&self, other: &Self) -> Ordering {
        let difference = self.logarithm - other.logarithm;
        // Far above the rounding errors of both sums.
        if difference.abs() > 1e-9 * (1.0 + self.logarithm.abs()) {
            return difference.total_cmp(&0.0);
        }
        if self.factors == other.factors {
            return Ordering::Equal;
        }
        let [own, others] = [&self.factors, &other.factors].map(|factors| digits(factors));
        let by_length = own.len().cmp(&others.len());
        by_length.then_with(|| own.iter().rev().cmp(others.iter().rev()))
    }
}

/// Returns the product of some positive factors in base 2⁶⁴, the last digit first.
fn digits(factors: &[u64]) -> Vec<u64> {
    let mut digits = vec![1];
    for &factor in factors {
        let mut carry = 0;
        for digit in &mut digits {
            let product = u128::from(*digit) * u128::from(factor) + carry;
            *digit = lower_word(product);
            carry = product >> 64;
        }
        if carry > 0 {
            digits.push(lower_word(carry));
        }
    }
    digits
}

#[cfg(test)]
mod tests {
    use super::*;

    fn odds(factors: &[u64]) -> Odds {
        Odds::of(factors.to_vec()).expect("positive")
    }

    #[test]
    fn odds_are_compared_exactly() {
        let large = 1_799_999;
        let many = |first: [u64; 2], count: usize| first.repeat(count);
        for (one, other, expected) in [
            (vec![1, 2], vec![2, 1], Ordering::Equal),
            (vec![2, 6], vec![3, 4], Ordering::Equal),
            (
                vec![large - 1, large + 1],
                vec![large, large],
                Ordering::Less,
            ),
            (many([6, 11], 100), many([11, 6], 100), Ordering::Equal),
            (many([6, 11], 100), many([2, 33], 100), Ordering::Equal),
            // 13^400 is about 2^1480; the factors differ by one in one place.
            (
                many([13, 13], 200),
                [many([13, 13], 199), vec![12, 14]].concat(),
                Ordering::Greater,
            ),
            (
                many([u64::MAX, 3], 50),
                many([3, u64::MAX], 50),
                Ordering::Equal,
            ),
            (Vec::new(), vec![1], Ordering::Equal),
            (vec![7], vec![8], Ordering::Less),
        ] {
            let (one, other) = (odds(&one), odds(&other));
            assert_eq!(one.cmp(&other), expected, "{one:?} {other:?}");
            assert_eq!(other.cmp(&one), expected.reverse(), "{one:?} {other:?}");
        }
        assert!(Odds::of(vec![3, 0]).is_none());
    }

    #[test]
    fn equal_odds_have_equal_probabilities_and_their_sum_is_one() {
        // Too large for a u128, so the probabilities come from logarithms.
        let (one, other) = ([6, 35].repeat(60), [10, 21].repeat(60));
        let posterior =
            Posterior::of_odds(vec![(0, odds(&one)), (2, odds(&[1])), (4, odds(&other))]);
        assert_eq!(posterior.ranking[..2], [(0, 0.5), (4, 0.5)]);
        assert_eq!((posterior.possible, posterior.likeliest), (3, 2));
        // These have the correctly rounded probabilities.
        let posterior = Posterior::of_odds(vec![(0, odds(&[1, 1])), (1, odds(&[2, 3]))]);
        assert_eq!(posterior.ranking, [(1, 6.0 / 7.0), (0, 1.0 / 7.0)]);
    }

    #[test]
    fn odds_that_differ_are_ranked_by_their_products_also_if_their_probabilities_are_equal() {
        // (n − 1)(n + 1) is less than n².
        let large = 1_799_999;
        for more in [0, 40] {
            let [less, most] = [[large - 1, large + 1], [large, large]];
            let with = |own: [u64; 2]| odds(&[&own[..], &vec![3; more]].concat());
            let posterior = Posterior::of_odds(vec![(0, with(less)), (1, with(most))]);
            assert_eq!(posterior.likeliest, 1, "{more}");
            let [(1, first), (0, second)] = posterior.ranking[..] else {
                panic!("{more}: {:?}", posterior.ranking);
            };
            assert!(first >= second, "{more}: {first} {second}");
        }
    }

    #[test]
    fn logarithms_that_differ_by_a_rounding_error_are_tied_in_the_order_of_the_set() {
        for rounding in [-1e-14, 0.0, 1e-14] {
            let posterior = Posterior::of_logarithms(&[0.0, f64::NEG_INFINITY, rounding], 1);
            assert_eq!(posterior.ranking, [(0, 0.5), (2, 0.5)], "{rounding}");
        }
        let posterior = Posterior::of_logarithms(&[0.0, f64::NEG_INFINITY, 1e-9], 1);
        assert_eq!(posterior.ranking[0].0, 2);
        assert!(posterior.ranking[0].1 > posterior.ranking[1].1);
        assert!(
            Posterior::of_logarithms(&[f64::NEG_INFINITY], 1)
                .ranking
                .is_empty()
        );
    }
}
