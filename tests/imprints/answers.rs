//! Answers to touches between the poses of a model: how often they are right, and that fits are what they say.

use taxel_core::prelude::*;
use taxel_core::recognition::{
    Answer, AnswerState, CellPositions, Evidence, GridSteps, Model, NamedShape, Training,
};
use taxel_files::storage::shipped;

use crate::common::Random;

/// The shipped shapes, as the program trains them.
fn shapes() -> Vec<NamedShape> {
    let shapes = shipped::all();
    let named = shapes.map(|own| NamedShape::new(own.name.as_str(), Picture::at_home(own.imprint)));
    named.collect()
}

fn train(shapes: Vec<NamedShape>) -> Model {
    let steps = GridSteps {
        positions: CellPositions::new(5).expect("a divisor of 100"),
        angles: "0:357:3".parse().expect("a range"),
    };
    let training = Training::fitting(shapes, steps).expect("they fit");
    training.run().expect("no pose is cut off")
}

/// A number from 0 to below 1.
fn part(random: &mut Random) -> f64 {
    f64::from(random.whole(0, 999_999)) / 1e6
}

/// Touches with a shape in a random pose within the ranges of the model.
fn touch(model: &Model, shape: &NamedShape, random: &mut Random) -> Imprint {
    let ranges = *model.ranges();
    let grid = PoseGrid::new(
        shape.source.clone(),
        *model.sensor(),
        model.anchor(),
        ranges,
    );
    let grid = grid.expect("in range");
    let mut pose = grid.pose(0);
    for axis in [Axis::X0, Axis::Y0] {
        pose[axis] += part(random);
    }
    pose[Axis::Angle] = 360.0 * part(random);
    Plane::new(*grid.sensor()).touch(&grid.placed_in(pose))
}

/// Checks that the fitted shape leaves the imprint that the fit states, which differs in as many living taxels.
fn check_fit(model: &Model, touch: &Imprint, dead: Option<&Imprint>, answer: &Answer) {
    let fit = answer.fit.as_ref().expect("the touch is not empty");
    let sensor = Sensor::new(touch.columns(), touch.rows()).expect("a sensor");
    let sensor = sensor.with_threshold(model.sensor().threshold());
    let again = Plane::new(sensor.expect("in range")).touch(&fit.source);
    assert_eq!(again, fit.imprint, "{:?}", fit.source);
    let differing = touch.differing(&again);
    let living = dead.map_or(differing, |dead| differing.without(dead));
    assert_eq!(living.count(), fit.differs, "{:?}", fit.source);
}

#[derive(Debug, Default)]
struct Answers {
    all: u32,
    right: u32,
    unknown: u32,
    exact: u32,
}

impl Answers {
    fn add(&mut self, answer: &Answer, shape: usize) {
        self.all += 1;
        self.right += u32::from(answer.shape == Some(shape));
        self.unknown += u32::from(answer.state == AnswerState::Unknown);
        self.exact += u32::from(answer.fit.as_ref().is_some_and(|fit| fit.differs == 0));
    }

    /// Checks that at least 99 % were named rightly and at most 1 % not at all, and the least part of exact fits in
    /// percent.
    fn check(&self, exact: u32) {
        println!("{self:?}");
        assert!(100 * self.right >= 99 * self.all, "{self:?}");
        assert!(100 * self.unknown <= self.all, "{self:?}");
        assert!(100 * self.exact >= exact * self.all, "{self:?}");
    }
}

#[test]
fn touches_between_the_poses_of_a_model_are_named_rightly_and_fitted() {
    let model = train(shapes());
    let mut random = Random::new(53);
    let mut answers = Answers::default();
    for (index, shape) in model.shapes().iter().enumerate() {
        for _ in 0..14 {
            let touch = touch(&model, shape, &mut random);
            let answer = model.recognise(Evidence::of(&[touch]));
            check_fit(&model, &touch, None, &answer);
            answers.add(&answer, index);
        }
    }
    answers.check(85);
}

#[test]
fn dead_taxels_are_left_out_of_fits() {
    let model = train(shapes());
    let mut random = Random::new(54);
    let mut answers = Answers::default();
    for (index, shape) in model.shapes().iter().enumerate() {
        for _ in 0..7 {
            let mut touch = touch(&model, shape, &mut random);
            let mut dead = Imprint::empty(touch.size());
            for _ in 0..8 {
                let column = random.side(0, touch.columns() - 1);
                let row = random.side(0, touch.rows() - 1);
                dead.set(column, row, true);
                touch.set(column, row, random.chance(500));
            }
            let answer = model.recognise(Evidence::of(&[touch]).without(&dead));
            check_fit(&model, &touch, Some(&dead), &answer);
            assert_ne!(answer.state, AnswerState::Certain);
            answers.add(&answer, index);
        }
    }
    answers.check(85);
}

/// A disc has one angle, a square a quarter of them: their fits start from as many different poses all the same.
#[test]
fn shapes_that_look_alike_at_several_angles_are_fitted_as_well() {
    let sensor = Sensor::default();
    let square = Figure::rectangle(7.3, 7.3).on(&sensor).expect("in range");
    let disc = Figure::ellipse(3.1, 3.1).on(&sensor).expect("in range");
    let cross = ".##.\n####\n####\n.##.".parse().expect("an imprint");
    let model = train(vec![
        NamedShape::new("square", square),
        NamedShape::new("disc", disc),
        NamedShape::new("cross", Picture::at_home(cross)),
    ]);
    let mut random = Random::new(55);
    for (index, shape) in model.shapes().iter().enumerate() {
        let mut answers = Answers::default();
        for _ in 0..100 {
            let touch = touch(&model, shape, &mut random);
            let answer = model.recognise(Evidence::of(&[touch]));
            check_fit(&model, &touch, None, &answer);
            answers.add(&answer, index);
        }
        answers.check(85);
    }
}
