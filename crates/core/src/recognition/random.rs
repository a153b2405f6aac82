use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use crate::imprint::Imprint;
use crate::index::{lower_word, narrow};
use crate::recognition::model::float;
use crate::sensor::MatrixSize;

/// Creates a random generator for one of many tasks, so that no task waits for another.
pub(super) fn generator(seed: u64, task: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed ^ task.wrapping_mul(0x9e37_79b9_7f4a_7c15))
}

/// Draws a number from 0 to below `end`, each as likely as any other to within 2⁻⁶⁴.
pub fn below(random: &mut Pcg64, end: u64) -> u64 {
    let product = u128::from(random.next_u64()) * u128::from(end);
    lower_word(product >> 64)
}

pub(super) fn unit(random: &mut Pcg64) -> f64 {
    float(random.next_u64() >> 11) / float(1 << 53)
}

/// Draws `count` different taxels of a matrix; all taxels if it has no more.
pub(super) fn random_taxels(size: MatrixSize, count: u32, random: &mut Pcg64) -> Imprint {
    let mut taxels = Imprint::empty(size);
    let (columns, rows) = (size.columns(), size.rows());
    let mut missing = count.min(narrow(size.cells()));
    while missing > 0 {
        let [column, row] = [columns, rows].map(|side| below(random, side.into()));
        if let (Ok(column), Ok(row)) = (u8::try_from(column), u8::try_from(row))
            && !taxels.get(column, row)
        {
            taxels.set(column, row, true);
            missing -= 1;
        }
    }
    taxels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drawing_more_taxels_than_there_are_draws_all() {
        let mut random = generator(0, 0);
        let taxels = random_taxels(MatrixSize::LARGEST, 5000, &mut random);
        assert_eq!(taxels.count(), 64 * 64);
        assert_eq!(
            random_taxels(MatrixSize::of(16, 16), 7, &mut random).count(),
            7
        );
    }

    #[test]
    fn dead_taxels_are_drawn_from_random_numbers_of_their_own() {
        for seed in 0..4 {
            let mut random = generator(seed, 0);
            let side = || below(&mut random, 64);
            let numbers: Vec<u64> = std::iter::repeat_with(side).take(100).collect();
            let dead = random_taxels(MatrixSize::LARGEST, 50, &mut generator(seed, !0));
            let is_dead = |place: &&[u64]| {
                let place = [place[0], place[1]].map(|side| u8::try_from(side).expect("below 64"));
                dead.get(place[0], place[1])
            };
            assert!(numbers.chunks(2).filter(is_dead).count() < 10);
        }
    }
}
