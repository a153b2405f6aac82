//! The scan that compares a touch with every key at every place (`cargo bench --bench scan`): the time per pair of a
//! key and a place if nothing can be skipped, and per query if most pairs can.
//!
//! The templates are random blobs of about 30 taxels in boxes of 6 × 6, all different. A million of them are more keys
//! than any set of shapes tried so far has.

use std::hint::black_box;

use taxel_core::prelude::*;
use taxel_core::recognition::{
    ImprintKey, KeyTable, Model, ModelHead, NamedShape, Noise, ShapeCount,
};

use timing::{Least, Work, in_turn};

mod timing;

/// A simple random generator that gives the same templates on every machine.
fn next(state: &mut u64) -> u64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    *state >> 16
}

/// Returns a model of one shape with the given number of keys.
fn model(keys: usize) -> Model {
    let sensor = Sensor::default();
    let shape = NamedShape::new(
        "blobs",
        Figure::rectangle(6.0, 5.0).on(&sensor).expect("in range"),
    );
    let (anchor, ranges) = (Anchor::Centre, Ranges::default());
    let head = ModelHead::new(vec![shape], sensor, anchor, ranges, keys as u64);
    let mut table = KeyTable::default();
    let mut state = 1;
    while table.len() < keys {
        let mut imprint = Imprint::empty(MatrixSize::new(6, 6).expect("1 to 64"));
        for row in 0..6 {
            // Three in four taxels are active.
            imprint.set_word(row, next(&mut state) | next(&mut state));
        }
        if imprint.bounds().is_some_and(|bounds| bounds.area() == 36) {
            table.add(&ImprintKey::of(&imprint));
        }
    }
    Model::of_table(head, &table, |_| [ShapeCount::new(0, 1)]).expect("a model")
}

/// Returns a touch like one of the templates, with some taxels flipped.
fn touch() -> Imprint {
    let mut touch = Imprint::empty(Sensor::default().size());
    for (row, word) in [
        0b11_1110, 0b11_1111, 0b10_1111, 0b11_1111, 0b11_1101, 0b01_1111,
    ]
    .into_iter()
    .enumerate()
    {
        touch.set_word(row + 5, word << 4);
    }
    touch.toggle(1, 1);
    touch
}

fn main() {
    // One thread: the processor time of several would count their waiting for work.
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let single = single.expect("a thread");
    let touch = touch();
    let size = Sensor::default().size();

    // Nothing can be skipped: at e = 0.45 every distance matters.
    let every = Noise::new(0.45).expect("in range");
    let small = model(10_000);
    // Every key in every place where its 6 × 6 taxels fit.
    let pairs = 10_000.0 * (f64::from(size.columns()) - 5.0) * (f64::from(size.rows()) - 5.0);
    let scan = Work::new(|| {
        single.install(|| black_box(small.distances(&touch, &every)));
    });
    let [scan] = in_turn(20, [scan]);
    println!(
        "every pair, 10,000 keys: {:.2} ns a pair",
        scan.nanoseconds() / pairs
    );

    let large = model(1_000_000);
    let mut prepared = Least::default();
    prepared.measure(1, || black_box(large.nearest(&touch, None)));
    println!("a million keys prepared in {:.1} s", prepared.wall);
    let usual = Noise::new(0.01).expect("in range");
    let query = Work::new(|| {
        single.install(|| black_box(large.distances(&touch, &usual)));
    });
    let [query] = in_turn(20, [query]);
    println!("a query on a million keys: {:.1} ms", query.wall * 1e3);
}
