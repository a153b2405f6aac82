//! Recognition of seven figures of about 30 cells each (`cargo bench --bench recognition`): training compared with the
//! sweeps that it consists of, the evaluation of the model, and answers to single touches.
//!
//! Training and its sweeps are compared in one run, because their ratio shows what training adds: the keys of all
//! imprints, and one table of them.

use std::hint::black_box;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use taxel::prelude::*;
use taxel::recognition::{Evaluation, Evidence, GridSteps, Model, Training, equal_figures};
use taxel::sweep::Sweep;

fn training() -> Training<'static> {
    Training::fitting(equal_figures(), GridSteps::FINE).expect("they fit")
}

fn train() -> Model {
    training().run().expect("nothing is cut off")
}

/// Measures training, the sweeps of its shapes, and the evaluation.
fn whole(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("train");
    group.sample_size(10);
    let grids = training().grids().to_vec();
    group.throughput(Throughput::Elements(
        grids.iter().map(PoseGrid::poses).sum(),
    ));
    group.bench_function("seven figures", |bencher| {
        let run = |training: Training<'_>| training.run().expect("nothing is cut off");
        bencher.iter_batched(training, run, BatchSize::PerIteration);
    });
    group.bench_function("their sweeps", |bencher| {
        bencher.iter(|| {
            for grid in &grids {
                black_box(Sweep::new(grid).run());
            }
        });
    });
    group.finish();

    let model = train();
    let mut group = criterion.benchmark_group("evaluate");
    group.throughput(Throughput::Elements(model.keys().len() as u64));
    group.bench_function("confusion", |bencher| {
        bencher.iter(|| Evaluation::of(&model));
    });
    group.bench_function("pairs", |bencher| bencher.iter(|| model.pair_errors()));
    group.finish();
}

/// Measures a touch that some shapes leave, a touch that no shape leaves, and finding the pose of a shape.
fn answers(criterion: &mut Criterion) {
    let model = train();
    let known: Imprint = "..........\n...####...\n..######..\n..######..\n..######..\n..######..\n...####...\n.........."
        .parse()
        .expect("rows");
    let mut unknown = known;
    unknown.toggle(5, 3);
    assert!(!model.counts_of(&known).is_empty() && model.counts_of(&unknown).is_empty());
    let mut group = criterion.benchmark_group("answer");
    group.bench_function("posterior", |bencher| {
        bencher.iter(|| model.posterior(black_box(&known)));
    });
    group.bench_function("answer", |bencher| {
        let touches = [known];
        bencher.iter(|| model.recognise(Evidence::of(black_box(&touches))));
    });
    group.bench_function("nearest of an unknown one", |bencher| {
        bencher.iter(|| model.nearest(black_box(&unknown)));
    });
    group.sample_size(10);
    group.bench_function("pose", |bencher| {
        bencher.iter(|| model.pose_of(0, black_box(&known), &|_| true));
    });
    group.finish();
}

criterion_group!(benches, whole, answers);
criterion_main!(benches);
