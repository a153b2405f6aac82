//! The scan of all keys at all places (`cargo bench --bench scan`): time per pair of a key and a place where nothing can be
//! skipped, and per query where most can.
//!
//! The templates are random blobs of about 30 taxels in boxes of 6 × 6, so no two are equal; a million of them are more
//! keys than any set of shapes that was tried has.

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use taxel::prelude::*;
use taxel::recognition::{Model, ModelParts, NamedShape, Noise, ShapeCount};
use taxel::sweep::Shard;

/// A simple generator: the same templates on every machine.
fn next(state: &mut u64) -> u64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    *state >> 16
}

/// A model of one shape with that many keys.
fn model(keys: usize) -> Model {
    let sensor = Sensor::default();
    let shape = NamedShape::new(
        "blobs",
        Figure::rectangle(6.0, 5.0).on(&sensor).expect("in range"),
    );
    let poses = (Anchor::Centre, Ranges::default());
    let mut parts = ModelParts::new(vec![shape], sensor, poses, (Shard::WHOLE, keys as u64));
    let mut state = 1;
    let mut seen = std::collections::HashSet::new();
    while parts.keys.len() < keys {
        let mut imprint = Imprint::empty(6, 6);
        for row in 0..6 {
            // Three of four taxels are active.
            imprint.set_word(row, next(&mut state) | next(&mut state));
        }
        // In a box of its own size, and not there yet.
        let bounds = imprint.bounds();
        let whole =
            bounds.is_some_and(|bounds| bounds.columns() == (0..6) && bounds.rows() == (0..6));
        if whole && seen.insert(imprint) {
            parts
                .keys
                .push((Some(imprint), vec![ShapeCount::new(0, 1)]));
        }
    }
    Model::from_parts(parts).expect("a model")
}

/// A touch like one of the templates, with some taxels flipped.
fn touch() -> Imprint {
    let mut touch = Imprint::empty(16, 16);
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

fn scan(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("scan");
    group.sample_size(10);
    let single = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    let touch = touch();

    // Nothing is skipped: at e = 0.45 every distance matters.
    let model_of_10_000 = model(10_000);
    let every = Noise::new(0.45).expect("in range");
    group.throughput(Throughput::Elements(model_of_10_000.pairs((16, 16))));
    group.bench_function("every pair, 10,000 keys, 1 thread", |bencher| {
        bencher.iter(|| single.install(|| black_box(model_of_10_000.distances(&touch, &every))));
    });

    let start = Instant::now();
    let million = model(1_000_000);
    black_box(million.pairs((16, 16)));
    println!(
        "a million keys prepared in {:.1} s",
        start.elapsed().as_secs_f64()
    );
    let usual = Noise::new(0.01).expect("in range");
    group.throughput(Throughput::Elements(million.pairs((16, 16))));
    group.bench_function("a query on 1,000,000 keys, 1 thread", |bencher| {
        bencher.iter(|| single.install(|| black_box(million.distances(&touch, &usual))));
    });
    group.finish();
}

criterion_group!(benches, scan);
criterion_main!(benches);
