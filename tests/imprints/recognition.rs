//! Recognition from one touch: the published numbers for two sets, and the definitions by brute force on small grids.

use std::collections::HashMap;
use std::sync::LazyLock;

use taxel_core::prelude::*;
use taxel_core::progress::ToTheEnd;
use taxel_core::recognition::{
    AnswerState, Classifier, ClassifierSettings, Evaluation, Evidence, GivenDescriptors,
    ImprintKey, KeyTable, Model, ModelHead, ModelMerge, NamedShape, Noise, Rounding, ShapeCount,
    ShapeDescriptor, Training, TrainingError,
};
use taxel_core::sweep::{MergeError, Shard};

use crate::common::size;

/// Converts a count to a number to compute with.
#[expect(clippy::cast_precision_loss, reason = "all counts are small")]
pub(crate) fn float(count: u64) -> f64 {
    count as f64
}

pub(crate) fn sensor(side: u8) -> Sensor {
    let sensor = Sensor::default();
    [Parameter::Columns, Parameter::Rows]
        .into_iter()
        .try_fold(sensor, |sensor, parameter| {
            sensor.with(parameter, side.into())
        })
        .expect("in range")
}

pub(crate) fn ranges(x0: &str, y0: &str, angle: &str) -> Ranges {
    Ranges::default()
        .with(Axis::X0, x0.parse().expect("a range"))
        .with(Axis::Y0, y0.parse().expect("a range"))
        .with(Axis::Angle, angle.parse().expect("a range"))
}

/// Touches of which only the poses of the model count.
fn exactly(touches: &[Imprint]) -> Evidence<'_> {
    static NOTHING_FAILS: LazyLock<Noise> = LazyLock::new(|| Noise::new(0.0).expect("in range"));
    Evidence::of(touches).under(&*NOTHING_FAILS)
}

/// The grid of the published numbers.
pub(crate) fn published() -> Ranges {
    ranges("10:10.99:0.01", "10:10.99:0.01", "0:359:1")
}

/// S1: seven figures of about 30 cells.
pub(crate) fn s1() -> Vec<NamedShape> {
    let sensor = sensor(32);
    let shape = |name: &str, figure: taxel_core::figure::FigureBuilder| {
        NamedShape::new(name, figure.on(&sensor).expect("in range"))
    };
    vec![
        shape("disc", Figure::ellipse(3.09, 3.09)),
        shape("rectangle", Figure::rectangle(6.0, 5.0)),
        shape("triangle", Figure::triangle(8.32)),
        shape("pentagon", Figure::pentagon(4.18)),
        shape("hexagon", Figure::hexagon(3.4)),
        shape("heptagon", Figure::heptagon(2.87)),
        shape("octagon", Figure::octagon(2.49)),
    ]
}

/// S4: four rectangles that are hard to tell apart.
pub(crate) fn s4() -> Vec<NamedShape> {
    let sensor = sensor(32);
    let sides = [(6.0, 3.0), (6.0, 3.2), (6.2, 3.0), (4.2, 4.2)];
    let shape = |(width, height): (f64, f64)| {
        let figure = Figure::rectangle(width, height).on(&sensor);
        NamedShape::new(format!("{width}x{height}"), figure.expect("in range"))
    };
    sides.map(shape).to_vec()
}

pub(crate) fn train(shapes: Vec<NamedShape>, side: u8, ranges: Ranges) -> Model {
    let training = Training::new(shapes, sensor(side), Anchor::Corner, ranges).expect("a set");
    training.run().expect("no pose is cut off")
}

#[test]
fn seven_figures_are_told_apart_as_often_as_published() {
    let model = train(s1(), 32, published());
    let limit = Evaluation::of(&model);
    assert_eq!((limit.touches, limit.right), (25_200_000, 16_880_246));
    let certain = limit.certainty.map(|certainty| certainty.touches);
    assert_eq!(
        (certain, limit.tied, limit.keys),
        (Some(9_653_396), 0, 9_875)
    );
    let given = |text: &str| {
        text.parse::<GivenDescriptors>()
            .expect("descriptors")
            .evaluate(&model)
    };
    assert_eq!(given("na,p").right, 13_074_891);
    assert_eq!(format!("{:.2}", given("cg_cd").error()), "0.41");
    let rounding: Rounding = "cg_cd=0.01".parse().expect("a rounding");
    let mut rounded: GivenDescriptors = "cg_cd".parse().expect("one");
    rounded.roundings = vec![rounding];
    assert_eq!(format!("{:.2}", rounded.evaluate(&model).error()), "0.54");

    // No choice of descriptors passes the limit, and each chosen descriptor improves the result.
    let chosen = model.choose_descriptors(&[]);
    assert_eq!(chosen[0].descriptor.key(), "cg_cd");
    assert!(
        chosen
            .windows(2)
            .all(|pair| pair[0].evaluation.right < pair[1].evaluation.right)
    );
    assert!(
        chosen
            .iter()
            .all(|step| step.evaluation.right <= limit.right)
    );

    // No classifier on descriptors passes it, either.
    let settings = ClassifierSettings::default();
    for &classifier in Classifier::ALL {
        let reached = classifier.evaluate(&model, &settings, &ToTheEnd);
        let reached = reached.expect("not stopped").evaluation;
        assert_eq!(reached.certainty, None, "{}", classifier.name());
        let sum: u128 = reached.confusion.cells().map(|cell| cell.2).sum();
        println!("{} {:.4}", classifier.name(), reached.error());
        assert_eq!(sum, limit.touches);
        assert!(reached.right <= limit.right, "{}", classifier.name());
        assert!(
            reached.error() < 0.65,
            "{} guesses: {}",
            classifier.name(),
            reached.error()
        );
    }
}

#[test]
fn four_rectangles_are_confused_as_often_as_published() {
    let model = train(s4(), 32, published());
    let limit = Evaluation::of(&model);
    assert_eq!((limit.touches, limit.right), (14_400_000, 10_498_796));
    let certainty = limit.certainty.expect("the model knows it");
    assert_eq!((certainty.touches, limit.tied), (4_821_044, 524));
    assert_eq!(
        limit.confusion.rows().collect::<Vec<_>>(),
        [
            [1_642_740, 650_164, 1_307_096, 0],
            [261_984, 2_673_920, 664_096, 0],
            [572_156, 445_708, 2_582_136, 0],
            [0, 0, 0, 3_600_000]
        ]
    );
    assert_eq!(format!("{:.4}", limit.information_bits), "1.2066");
    assert_eq!(limit.prior_bits, 2.0);
    assert_eq!(
        (limit.recall(3), limit.precision(3)),
        (Some(1.0), Some(1.0))
    );
    assert_eq!(limit.worst_pairs()[0], ((0, 2), 1_307_096 + 572_156));
    assert_eq!(
        certainty.keys,
        (0..model.keys().len())
            .filter(|&key| model.counts(key).len() == 1)
            .count()
    );
}

/// A training so small that every touch can be made one by one.
fn small() -> (Vec<NamedShape>, Ranges) {
    let sensor = sensor(16);
    let picture: Imprint = "###\n#..\n#..".parse().expect("an imprint");
    let picture = Picture::at_home(picture);
    let bar = Figure::rectangle(3.0, 2.0).on(&sensor).expect("in range");
    let ring = Figure::ellipse(2.0, 2.0)
        .thickness(0.8)
        .on(&sensor)
        .expect("in range");
    let shapes = vec![
        NamedShape::new("angle", picture),
        NamedShape::new("bar", bar).weighted(3),
        NamedShape::new("ring", ring),
    ];
    (shapes, ranges("5:5.9:0.1", "5:5.75:0.25", "0:350:10"))
}

#[test]
fn counts_equal_those_of_touching_pose_by_pose() {
    let (shapes, ranges) = small();
    let sensor = sensor(16);
    let mut counts: HashMap<(ImprintKey, usize), u64> = HashMap::new();
    for (index, shape) in shapes.iter().enumerate() {
        let grid = PoseGrid::new(shape.source.clone(), sensor, Anchor::Corner, ranges);
        let grid = grid.expect("in range");
        for number in 0..grid.poses() {
            let imprint = Plane::new(sensor).touch(&grid.placed(number));
            *counts.entry((ImprintKey::of(&imprint), index)).or_default() += 1;
        }
    }
    let model = train(shapes, 16, ranges);
    let mut found = 0;
    for key in 0..model.keys().len() {
        let imprint = model.keys().imprint(key).expect("none is empty");
        for count in model.counts(key) {
            assert_eq!(
                counts[&(ImprintKey::of(&imprint), count.shape.into())],
                count.poses
            );
            found += 1;
        }
    }
    assert_eq!(found, counts.len());

    // The weighted limit, from its definition.
    let keys: std::collections::HashSet<&ImprintKey> = counts.keys().map(|(key, _)| key).collect();
    let weighted = |key: &ImprintKey, shape: usize| {
        let weight = u64::from(model.shapes()[shape].weight);
        counts
            .get(&(key.clone(), shape))
            .copied()
            .unwrap_or_default()
            * weight
    };
    let right: u64 = keys
        .iter()
        .map(|key| {
            (0..3)
                .map(|shape| weighted(key, shape))
                .max()
                .expect("three")
        })
        .sum();
    let limit = Evaluation::of(&model);
    assert_eq!(
        (limit.right, limit.touches),
        (right.into(), u128::from(model.poses()) * 5)
    );
}

/// Merges shards in the given order.
fn merge_all(shards: &[Model]) -> Result<Model, MergeError> {
    let mut merge = ModelMerge::default();
    for shard in shards {
        merge.add(shard)?;
    }
    merge.finish()
}

#[test]
fn merged_shards_equal_the_whole_model() {
    let (shapes, ranges) = small();
    let whole = train(shapes.clone(), 16, ranges);
    let part = |number| {
        let training = Training::new(shapes.clone(), sensor(16), Anchor::Corner, ranges);
        let shard = Shard::new(number, 3).expect("a shard");
        training
            .expect("a set")
            .with_shard(shard)
            .run()
            .expect("no pose is cut off")
    };
    let merged = merge_all(&[1, 2, 3].map(part)).expect("all three");
    assert!(merged == whole && merged != part(1));
    assert_eq!(merged.shard(), Shard::WHOLE);
    let error = |parts: Vec<Model>| merge_all(&parts).expect_err("no whole").to_string();
    assert_eq!(error(Vec::new()), "no shards to merge");
    assert_eq!(error(vec![part(1), part(3)]), "shard 2/3 is missing");
    assert_eq!(error(vec![part(1), part(2)]), "shard 3/3 is missing");
    assert_eq!(
        error(vec![part(1), part(1), part(2)]),
        "shard 1/3 is given twice"
    );
    assert_eq!(
        error(vec![part(1), whole.clone()]),
        "shard 1/1 belongs to another training"
    );
    // A shard that is refused changes nothing, even if it comes first.
    let mut merge = ModelMerge::default();
    let mut add = |number| merge.add(&part(number)).map_err(|error| error.to_string());
    let error = |text: &str| Err(text.to_owned());
    assert_eq!(add(2), error("shard 1/3 is missing"));
    assert_eq!(add(1), Ok(()));
    assert_eq!(add(3), error("shard 2/3 is missing"));
    assert_eq!(add(2), Ok(()));
    assert_eq!(add(2), error("shard 2/3 is given twice"));
    assert_eq!(add(3), Ok(()));
    let merged = merge.finish().expect("all three");
    assert_eq!((merged.poses(), merged.cut()), (whole.poses(), whole.cut()));
    assert_eq!(Evaluation::of(&merged), Evaluation::of(&whole));
}

#[test]
fn cut_poses_are_refused_unless_allowed() {
    let large = Figure::triangle(11.77).on(&sensor(16)).expect("in range");
    let set = || {
        let shapes = [NamedShape::new("triangle", large)];
        let poses = ranges("5:5.99:0.01", "5:5.99:0.01", "0:350:10");
        Training::new(shapes, sensor(16), Anchor::Corner, poses).expect("a set")
    };
    let Err(TrainingError::Cut { cut, poses, .. }) = set().run() else {
        panic!("poses that are cut off are trained");
    };
    assert_eq!((cut, poses), (360_000, 360_000));
    let model = set().allow_cut(true).run().expect("allowed");
    assert_eq!(model.cut(), [360_000]);
    // The numbers of cut poses in the shards add up.
    let part = |number| {
        let shard = Shard::new(number, 3).expect("a shard");
        let part = set().allow_cut(true).with_shard(shard).run();
        part.expect("allowed")
    };
    let merged = merge_all(&[1, 2, 3].map(part)).expect("all three");
    assert_eq!(merged.cut(), [360_000]);
}

#[test]
fn of_equally_good_descriptors_the_first_in_the_table_is_chosen() {
    let sensor = sensor(16);
    let shape = |name: &str, length: f64| {
        let figure = Figure::rectangle(length, 2.0).on(&sensor);
        NamedShape::new(name, figure.expect("in range"))
    };
    let shapes = vec![shape("short", 3.0), shape("long", 5.0)];
    let model = train(shapes, 16, ranges("5", "5", "0"));
    let chosen: Vec<&str> = model
        .choose_descriptors(&[])
        .iter()
        .map(|step| step.descriptor.key())
        .collect();
    let tells = |one: &ShapeDescriptor| {
        let given: GivenDescriptors = one.key().parse().expect("a descriptor");
        given.evaluate(&model).error() == 0.0
    };
    let telling: Vec<&str> = ShapeDescriptor::all()
        .filter(tells)
        .map(ShapeDescriptor::key)
        .collect();
    assert!(telling.len() > 1, "{telling:?}");
    assert_eq!(chosen, telling[..1]);
}

#[test]
fn answers_say_how_far_they_can_be_trusted() {
    let model = train(s4(), 32, published());
    let read = |text: &str| text.parse::<Imprint>().expect("an imprint");
    let recognise = |touch: &Imprint| model.recognise(exactly(std::slice::from_ref(touch)));

    let square = read("......\n.####.\n.####.\n.####.\n.####.\n......");
    let answer = recognise(&square);
    assert_eq!(
        (answer.state, answer.shape),
        (AnswerState::Certain, Some(3))
    );
    assert_eq!(answer.ranking, [(3, 1.0)]);

    // The same touch at the rim may be a part of a larger imprint.
    let cut = read("####.\n####.\n####.\n####.\n.....");
    let answer = recognise(&cut);
    assert_eq!((answer.state, answer.at_rim), (AnswerState::Likely, true));

    let bar = read("........\n.######.\n.######.\n.######.\n........");
    let answer = recognise(&bar);
    let probabilities: f64 = answer
        .ranking
        .iter()
        .map(|(_, probability)| probability)
        .sum();
    assert!((probabilities - 1.0).abs() < 1e-12 && answer.ranking.len() == 3);
    assert!(answer.ranking.windows(2).all(|pair| pair[0].1 >= pair[1].1));
    let best = answer.ranking[0].1;
    let touches = [bar];
    let mut strict = exactly(&touches);
    strict.reject_below = Some(best + 0.01);
    let strict = model.recognise(strict);
    assert_eq!((strict.state, strict.shape), (AnswerState::Rejected, None));

    // Two equal touches count twice.
    let twice = [bar, bar];
    let answer = model.recognise(exactly(&twice));
    let counts = model.counts_of(&bar);
    let squares: f64 = counts.iter().map(|count| float(count.poses).powi(2)).sum();
    for &(shape, probability) in &answer.ranking {
        let own = counts
            .iter()
            .find(|count| usize::from(count.shape) == shape);
        let expected = float(own.expect("it has one").poses).powi(2) / squares;
        assert!((probability - expected).abs() < 1e-12);
    }
    // However often this touch is repeated, the other shapes can leave it, too; but their probability is smaller than
    // any `f64`.
    let often = vec![bar; 20_000];
    let answer = model.recognise(exactly(&often));
    assert_eq!(answer.ranking.len(), 1);
    assert_eq!(answer.state, AnswerState::Likely);
    // No shape can leave touches that contradict each other.
    let answer = model.recognise(exactly(&[bar, square]));
    assert_eq!(
        (answer.state, answer.shape, answer.ranking.len()),
        (AnswerState::Unknown, None, 0)
    );
}

#[test]
fn the_nearest_imprint_of_an_unknown_one_is_found() {
    let model = train(s4(), 32, published());
    let mut touch: Imprint = ".########.".to_string().parse().expect("an imprint");
    touch = touch.resized(size(12, 9));
    let mut shifted = Imprint::empty(size(12, 9));
    for row in 2..5 {
        shifted.set_word(row, 0b0111_1110 << 1);
    }
    shifted.toggle(10, 7);
    let answer = model.recognise(exactly(std::slice::from_ref(&shifted)));
    assert_eq!(answer.state, AnswerState::Unknown);
    let nearest = model.nearest(&shifted, None).expect("keys fit");
    assert_eq!(nearest.distance, 1);
    assert_eq!(
        nearest
            .imprint
            .differing(&shifted)
            .active()
            .collect::<Vec<_>>(),
        [(10, 7)]
    );

    // A comparison with every key at every shift, one by one.
    for touch in [touch, shifted] {
        let nearest = model.nearest(&touch, None).expect("keys fit");
        let mut least = u32::MAX;
        for key in 0..model.keys().len() {
            let imprint = model.keys().imprint(key).expect("none is empty");
            if imprint.columns() > touch.columns() || imprint.rows() > touch.rows() {
                continue;
            }
            for row in 0..=usize::from(touch.rows() - imprint.rows()) {
                for column in 0..=touch.columns() - imprint.columns() {
                    let mut moved = Imprint::empty(touch.size());
                    for (index, &word) in imprint.words().iter().enumerate() {
                        moved.set_word(row + index, word << column);
                    }
                    least = least.min(moved.differing(&touch).count());
                }
            }
        }
        assert_eq!(nearest.distance, least);
        assert_eq!(nearest.imprint.differing(&touch).count(), least);
    }
    assert!(model.nearest(&Imprint::empty(size(2, 2)), None).is_none());
}

#[test]
fn two_names_for_one_shape_can_never_be_told_apart() {
    let sensor = sensor(16);
    let bar = Figure::rectangle(3.0, 2.0).on(&sensor).expect("in range");
    let disc = Figure::ellipse(2.0, 2.0).on(&sensor).expect("in range");
    let shapes = vec![
        NamedShape::new("bar", bar),
        NamedShape::new("copy", bar),
        NamedShape::new("disc", disc),
    ];
    let model = train(shapes, 16, ranges("5:5.9:0.1", "5:5.9:0.1", "0:350:10"));
    assert_eq!(model.never_certain(), [0, 1]);
    let limit = Evaluation::of(&model);
    assert_eq!((limit.recall(1), limit.precision(1)), (Some(0.0), None));
    let bar: Imprint = ".....\n.###.\n.###.\n.....".parse().expect("an imprint");
    let answer = model.recognise(exactly(&[bar]));
    assert_eq!(
        (answer.state, answer.shape, answer.tied.as_slice()),
        (AnswerState::Tied, Some(0), [0, 1].as_slice())
    );
    // If one of several touches is at the rim, it may be cut off.
    let rim: Imprint = "###\n###\n...".parse().expect("an imprint");
    let at_rim = |touches: &[Imprint]| model.recognise(exactly(touches)).at_rim;
    assert!(at_rim(&[bar, rim]) && at_rim(&[rim, bar]) && !at_rim(&[bar, bar]));
    // A probability that just reaches the limit is not rejected.
    let rejecting = |least| {
        let touches = [bar];
        let mut evidence = exactly(&touches);
        evidence.reject_below = Some(least);
        model.recognise(evidence)
    };
    assert_eq!(rejecting(0.5), answer);
    let rejected = rejecting(0.500_001);
    assert_eq!(
        (rejected.state, rejected.shape),
        (AnswerState::Rejected, None)
    );
}

#[test]
fn a_shape_that_may_leave_an_empty_imprint_is_named_by_its_template() {
    let sensor = sensor(16);
    let shape = |name: &str, (length, width): (f64, f64)| {
        let figure = Figure::rectangle(length, width).on(&sensor);
        NamedShape::new(name, figure.expect("in range"))
    };
    let shapes = vec![shape("bar", (3.0, 1.0)), shape("dot", (0.5, 0.5))];
    let model = train(shapes, 16, ranges("5:5.9:0.1", "5:5.9:0.1", "0"));
    let nothing = Imprint::empty(size(16, 16));
    assert_eq!(model.recognise(exactly(&[nothing])).shape, Some(1));
    let settings = ClassifierSettings::default();
    let reached = Classifier::Template.evaluate(&model, &settings, &ToTheEnd);
    let reached = reached.expect("not stopped");
    assert_eq!(reached.evaluation.error(), 0.0);
}

/// CG and CD are the same distance apart wherever an imprint lies, but only up to a rounding error.
#[test]
fn nearest_neighbours_with_equal_features_vote_together() {
    let model = train(s4(), 32, ranges("10:10.9:0.1", "10:10.9:0.1", "0:350:10"));
    for descriptors in ["cg_cd", "cg_cd,cg_cd_direction"] {
        let given: GivenDescriptors = descriptors.parse().expect("descriptors");
        let settings = ClassifierSettings {
            descriptors: Some(given.descriptors.clone()),
            sample: usize::MAX,
            ..ClassifierSettings::default()
        };
        let reached = Classifier::Knn.evaluate(&model, &settings, &ToTheEnd);
        let reached = reached.expect("not stopped").evaluation;
        let (reached, limit) = (reached.right, given.evaluate(&model).right);
        assert!(reached <= limit, "{descriptors}: {reached} of {limit}");
    }
}

#[test]
fn in_large_steps_no_taxel_equals_one() {
    let sensor = sensor(16);
    let shape = |name: &str, radius: f64| {
        let figure = Figure::ellipse(radius, radius).on(&sensor);
        NamedShape::new(name, figure.expect("in range"))
    };
    let shapes = vec![shape("small", 0.4), shape("larger", 0.55)];
    let model = train(shapes, 16, ranges("5:5.9:0.1", "5:5.9:0.1", "0"));
    let mut given: GivenDescriptors = "na".parse().expect("a descriptor");
    assert_eq!(given.evaluate(&model).keys, 2);
    given.roundings = vec!["na=10".parse().expect("a rounding")];
    let evaluation = given.evaluate(&model);
    assert_eq!((evaluation.keys, evaluation.error()), (1, 0.5));
}

/// With more shards than rows, some shards have no pose.
#[test]
fn the_evaluation_of_a_shard_without_poses_has_numbers() {
    let disc = Figure::ellipse(2.0, 2.0).on(&sensor(16)).expect("in range");
    let shapes = vec![NamedShape::new("disc", disc)];
    let training = Training::new(shapes, sensor(16), Anchor::Corner, ranges("5", "5", "0"));
    let shard = "1/2".parse().expect("a shard");
    let model = training
        .expect("a set")
        .with_shard(shard)
        .run()
        .expect("trained");
    assert_eq!(model.poses(), 0);
    let limit = Evaluation::of(&model);
    assert_eq!(
        (limit.accuracy(), limit.error(), limit.recall(0)),
        (0.0, 0.0, None)
    );
    assert!(model.never_certain().is_empty());
}

#[test]
fn a_model_with_another_number_of_poses_than_its_ranges_is_refused() {
    let disc = Figure::ellipse(2.0, 2.0).on(&sensor(16)).expect("in range");
    let model = |poses| {
        let ranges = ranges("5:5.1:0.1", "5", "0");
        let shapes = vec![NamedShape::new("disc", disc)];
        let head = ModelHead::new(shapes, sensor(16), Anchor::Corner, ranges, poses);
        let mut keys = KeyTable::default();
        keys.add(&ImprintKey::of(&"#".parse().expect("an imprint")));
        Model::of_table(head, &keys, |_| [ShapeCount::new(0, poses)])
    };
    assert!(model(2).is_ok());
    for poses in [1, 3, u64::MAX] {
        assert!(model(poses).is_err(), "{poses}");
    }
}

#[test]
fn sets_and_descriptors_that_make_no_sense_are_refused() {
    let error = |shapes: Vec<NamedShape>| {
        let training = Training::new(shapes, sensor(16), Anchor::Corner, Ranges::default());
        training.expect_err("no set").to_string()
    };
    let disc = Figure::ellipse(2.0, 2.0).on(&sensor(16)).expect("in range");
    assert_eq!(error(vec![]), "0 shapes, expected 1 to 32768");
    for nothing in ["", "  "] {
        let nameless = vec![NamedShape::new(nothing, disc)];
        assert_eq!(error(nameless), "shape 1 has no name");
    }
    assert_eq!(
        error(vec![NamedShape::new("disc\nright 100 %", disc)]),
        "name \"disc\\nright 100 %\" of shape 1 has a line break or another control character"
    );
    let longest = NamedShape::new("é".repeat(64), disc);
    let too_long = NamedShape::new("n".repeat(70_000), disc);
    assert_eq!(
        error(vec![longest, too_long]),
        format!(
            "name \"{}…\" of shape 2 has 70000 characters (allowed: up to 64)",
            "n".repeat(40)
        )
    );
    let twice = vec![NamedShape::new("disc", disc), NamedShape::new("disc", disc)];
    assert_eq!(
        error(twice),
        "two shapes are named \"disc\"; give each its own name"
    );
    let weightless = vec![NamedShape::new("disc", disc).weighted(0)];
    assert_eq!(
        error(weightless),
        "weight of \"disc\": 0, expected at least 1"
    );

    let given = |text: &str| {
        text.parse::<GivenDescriptors>()
            .expect_err("no descriptors")
            .to_string()
    };
    assert!(
        given("na,colour")
            .starts_with("descriptor \"colour\" is unknown, expected one of na, nae, ce, p, f,")
    );
    assert!(given("cg").starts_with("cg depends on the position of the imprint"));
    for text in ["cg_cd", "cg_cd=0", "cg_cd=-1", "cg_cd=x", "cg_cd=nan"] {
        assert!(text.parse::<Rounding>().is_err(), "{text}");
    }
}
