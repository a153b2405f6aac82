//! Recognition of seven figures of about 30 cells each (`cargo bench --bench recognition`): training compared with the
//! sweeps that it consists of, the evaluation of the model, and answers to single touches.
//!
//! The ratio of training and its sweeps shows what training adds: the keys of all imprints, and one table of them. Both
//! are measured in wall-clock time on all cores, the rest in processor time.

use std::hint::black_box;

use taxel_core::prelude::*;
use taxel_core::progress::ToTheEnd;
use taxel_core::recognition::{Evaluation, Evidence, GridSteps, Model, Training, equal_figures};
use taxel_core::sweep::Sweep;

use timing::{Work, in_turn};

mod timing;

fn training() -> Training<'static> {
    Training::fitting(equal_figures(), GridSteps::FINE).expect("they fit")
}

fn train() -> Model {
    training().run().expect("nothing is cut off")
}

/// Measures training, and the sweeps of its shapes.
fn whole() {
    let grids = training().grids;
    let trained = Work::new(|| {
        black_box(train());
    });
    let swept = Work::new(|| {
        for grid in &grids {
            black_box(Sweep::new(grid).run());
        }
    });
    let [trained, swept] = in_turn(10, [trained, swept]).map(|least| least.wall);
    let poses: u64 = grids.iter().map(PoseGrid::poses).sum();
    println!("training of {poses} poses: {trained:.3} s");
    println!("their sweeps alone: {swept:.3} s");
    println!("training / sweeps: {:.2}", trained / swept);
}

/// Measures the evaluation of a model.
fn evaluation(model: &Model) {
    let confusion = Work::new(|| {
        black_box(Evaluation::of(black_box(model)));
    });
    let [confusion] = in_turn(100, [confusion]).map(|least| least.processor * 1e3);
    println!(
        "confusion of {} keys: {confusion:.2} ms",
        model.keys().len()
    );
}

/// Measures a touch that some shapes leave, a touch that no shape leaves, and finding the pose of a shape.
fn answers(model: &Model) {
    let known: Imprint = "..........\n...####...\n..######..\n..######..\n..######..\n..######..\n...####...\n.........."
        .parse()
        .expect("rows");
    let mut unknown = known;
    unknown.toggle(5, 3);
    assert!(!model.counts_of(&known).is_empty() && model.counts_of(&unknown).is_empty());
    let touches = [known];
    let answer = Work::new(|| {
        black_box(model.recognise(Evidence::of(black_box(&touches))));
    });
    let nearest = Work::new(|| {
        black_box(model.nearest(black_box(&unknown), None));
    });
    let pose = Work::new(|| {
        black_box(model.pose_of(0, black_box(&known), &ToTheEnd));
    });
    let answers = in_turn(100, [answer, nearest, pose]);
    let [answer, nearest, pose] = answers.map(|least| least.processor * 1e6);
    println!("whole answer: {answer:.1} µs");
    println!("nearest imprints of an unknown one: {nearest:.0} µs");
    println!("pose: {pose:.0} µs");
}

fn main() {
    whole();
    let model = train();
    evaluation(&model);
    answers(&model);
}
