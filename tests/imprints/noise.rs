//! Recognition with failing taxels, compared with the sum over all flips, with independent numbers, and with its own
//! claims.

use std::path::PathBuf;

use serde_json::Value;
use taxel_core::prelude::*;
use taxel_core::progress::ToTheEnd;
use taxel_core::recognition::{AnswerState, Evidence, Model, NamedShape, Noise};

use crate::common::size;
use crate::recognition::{float, published, ranges, s1, s4, sensor, train};

/// Returns a model of shapes that fit a matrix of 5 × 5, with few keys.
fn tiny() -> Model {
    let sensor = sensor(16);
    let bar = Figure::rectangle(2.0, 1.0).on(&sensor).expect("in range");
    let square = Figure::rectangle(1.6, 1.6).on(&sensor).expect("in range");
    let shapes = vec![
        NamedShape::new("bar", bar),
        NamedShape::new("square", square).weighted(2),
    ];
    train(shapes, 16, ranges("5:5.8:0.2", "5:5.8:0.2", "0:330:30"))
}

/// Computes the probability of an imprint for each shape from the definition: over all keys and their places.
fn by_definition(model: &Model, imprint: &Imprint, flip: f64, dead: &Imprint) -> Vec<f64> {
    let shapes = model.shapes().len();
    let (mut sums, mut totals) = (vec![0.0; shapes], vec![0.0; shapes]);
    for key in 0..model.keys().len() {
        // The key of an empty imprint is one of 0 × 0 taxels.
        let own = model.keys().imprint(key);
        let (columns, rows) = own.map_or((0, 0), |own| (own.columns(), own.rows()));
        if columns > imprint.columns() || rows > imprint.rows() {
            continue;
        }
        for down in 0..=usize::from(imprint.rows() - rows) {
            for across in 0..=imprint.columns() - columns {
                let mut moved = Imprint::empty(imprint.size());
                for (row, &word) in own.iter().flat_map(Imprint::words).enumerate() {
                    moved.set_word(row + down, word << across);
                }
                let cells = (0..imprint.rows())
                    .flat_map(|row| (0..imprint.columns()).map(move |column| (column, row)));
                let living = cells.filter(|&(column, row)| !dead.get(column, row));
                let probability: f64 = living
                    .map(|(column, row)| {
                        let same = moved.get(column, row) == imprint.get(column, row);
                        if same { 1.0 - flip } else { flip }
                    })
                    .product();
                for count in model.counts(key) {
                    sums[usize::from(count.shape)] += float(count.poses) * probability;
                    totals[usize::from(count.shape)] += float(count.poses);
                }
            }
        }
    }
    let weights = model.shapes().iter().map(|shape| f64::from(shape.weight));
    let likelihoods: Vec<f64> = sums
        .iter()
        .zip(&totals)
        .zip(weights)
        .map(|((sum, total), weight)| weight * sum / total)
        .collect();
    let all: f64 = likelihoods.iter().sum();
    likelihoods.into_iter().map(|own| own / all).collect()
}

/// Does the same for several touches: their probabilities are multiplied, because touches are independent once the
/// shape is known.
fn of_several(model: &Model, touches: &[Imprint], flip: f64) -> Vec<f64> {
    let weights = model.shapes().iter().map(|shape| f64::from(shape.weight));
    let mut odds: Vec<f64> = weights.clone().collect();
    for touch in touches {
        let none = Imprint::empty(touch.size());
        let own = by_definition(model, touch, flip, &none);
        for ((odds, own), weight) in odds.iter_mut().zip(own).zip(weights.clone()) {
            *odds *= own / weight;
        }
    }
    let all: f64 = odds.iter().sum();
    odds.into_iter().map(|odds| odds / all).collect()
}

/// Returns two hundred imprints of 5 × 5, with few and many taxels.
fn imprints() -> impl Iterator<Item = Imprint> {
    (0_u64..200).map(|seed| {
        let mut imprint = Imprint::empty(size(5, 5));
        let bits = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 20;
        let thinned = if seed % 2 == 0 {
            bits & bits >> 7
        } else {
            bits
        };
        for row in 0..5 {
            imprint.set_word(row, thinned >> (5 * row));
        }
        imprint
    })
}

#[test]
fn posteriors_equal_those_from_the_definition() {
    let model = tiny();
    let mut dead = Imprint::empty(size(5, 5));
    dead.set(2, 2, true);
    dead.set(0, 4, true);
    for flip in [1e-11, 1e-6, 0.001, 0.01, 0.2, 0.45] {
        let noise = Noise::new(flip).expect("in range");
        for imprint in imprints() {
            for (noise, dead) in [
                (noise, Imprint::empty(size(5, 5))),
                (noise.with_dead(dead), dead),
            ] {
                let expected = by_definition(&model, &imprint, flip, &dead);
                let found = model.posterior_under(&imprint, &noise).expect("keys fit");
                for (found, expected) in found.iter().zip(&expected) {
                    assert!(
                        (found - expected).abs() < 2e-9,
                        "{flip}: {found} {expected}\n{imprint}"
                    );
                }
            }
        }
    }
}

/// Without noise, a touch that is likely for one shape may be impossible for the shape that left all other touches.
#[test]
fn touches_that_contradict_each_other_are_weighed_not_ruled_out() {
    let model = tiny();
    let read = |text: &str| text.parse::<Imprint>().expect("an imprint");
    let bar = read(".....\n.##..\n.....\n.....\n.....");
    let square = read(".....\n.##..\n.##..\n.....\n.....");
    let odd = read("#...#\n.....\n..#..\n.....\n#...#");
    for flip in [1e-12, 1e-6, 0.001, 0.01, 0.2, 0.45] {
        let noise = Noise::new(flip).expect("in range");
        for touches in [
            vec![bar, square],
            vec![bar, square, square, square],
            vec![square, bar, bar, odd],
            vec![odd; 20],
        ] {
            let answer = model.recognise(Evidence::of(&touches).under(Some(&noise)));
            let mut found = [0.0; 2];
            for (shape, probability) in answer.ranking {
                found[shape] = probability;
            }
            let expected = of_several(&model, &touches, flip);
            for (found, expected) in found.iter().zip(&expected) {
                assert!(
                    (found - expected).abs() < 2e-9,
                    "{flip}: {found} {expected}\n{touches:?}"
                );
            }
        }
    }
}

#[test]
fn shapes_with_a_large_weight_count_at_large_distances() {
    let sensor = sensor(16);
    let shape = |name: &str, width: f64| {
        let figure = Figure::rectangle(5.0, width).on(&sensor);
        NamedShape::new(name, figure.expect("in range"))
    };
    let shapes = vec![
        shape("bar", 1.0),
        shape("block", 3.0).weighted(4_000_000_000),
    ];
    let model = train(shapes, 16, ranges("5:5.5:0.5", "5:5.5:0.5", "0"));
    let touch: Imprint = ".......\n.#####.\n.......\n.......\n......."
        .parse()
        .expect("an imprint");
    for flip in [0.01, 0.05, 0.08] {
        let noise = Noise::new(flip).expect("in range");
        let expected = by_definition(&model, &touch, flip, &Imprint::empty(size(7, 5)));
        let found = model.posterior_under(&touch, &noise).expect("keys fit");
        assert!(
            (found[1] - expected[1]).abs() < 1e-9,
            "{flip}: {found:?} {expected:?}"
        );
    }
}

#[test]
fn without_noise_dead_taxels_do_not_make_an_impossible_touch_certain() {
    let model = tiny();
    let torn: Imprint = "##...\n.....\n.....\n....#\n....."
        .parse()
        .expect("an imprint");
    let mut dead = Imprint::empty(size(5, 5));
    dead.set(0, 4, true);
    let noise = Noise::new(0.0).expect("in range").with_dead(dead);
    assert_eq!(model.posterior_under(&torn, &noise), None);
    let answer = model.recognise(Evidence::of(&[torn]).under(Some(&noise)));
    assert_eq!(answer.state, AnswerState::Unknown);
    // If the stray taxel is known to be dead, the touch is possible.
    let mut dead = Imprint::empty(size(5, 5));
    dead.set(4, 3, true);
    let noise = Noise::new(0.0).expect("in range").with_dead(dead);
    let touches = [torn];
    let evidence = Evidence::of(&touches).under(Some(&noise));
    assert_ne!(model.recognise(evidence).state, AnswerState::Unknown);
    assert_eq!(
        model.recognise(evidence).nearest.map(|near| near.distance),
        Some(0)
    );
    // Of several touches, the impossible one counts, although a dead taxel is a hole in the other.
    let square: Imprint = ".....\n.##..\n.##..\n.....\n....."
        .parse()
        .expect("an imprint");
    let mut hole = Imprint::empty(size(5, 5));
    hole.set(1, 1, true);
    let noise = Noise::new(0.0).expect("in range").with_dead(hole);
    let touches = [square, torn];
    let nearest = model
        .recognise(Evidence::of(&touches).under(Some(&noise)))
        .nearest;
    assert_eq!(nearest.map(|near| near.distance), Some(1));
    let distance = model.nearest(&torn, None).map(|near| near.distance);
    assert_eq!(distance, Some(1), "where it is not known");
}

#[test]
fn a_noise_of_0_leaves_a_certain_answer_certain() {
    let model = tiny();
    let touch: Imprint = ".....\n.##..\n.##..\n.....\n....."
        .parse()
        .expect("an imprint");
    let state = |flip: f64| {
        let noise = Noise::new(flip).expect("in range");
        let touches = [touch];
        let evidence = Evidence::of(&touches).under(Some(&noise));
        model.recognise(evidence).state
    };
    let without = model.recognise(Evidence::of(&[touch])).state;
    assert_eq!(without, AnswerState::Certain);
    assert_eq!((state(0.0), state(1e-6)), (without, AnswerState::Likely));
}

#[test]
fn a_dead_taxel_at_the_rim_is_not_taken_for_contact_there() {
    let model = tiny();
    let mut touch: Imprint = ".....\n.##..\n.....\n.....\n....."
        .parse()
        .expect("an imprint");
    let mut dead = Imprint::empty(size(5, 5));
    dead.set(4, 4, true);
    touch.set(4, 4, true);
    let noise = Noise::new(0.01).expect("in range");
    let at_rim = |noise: &Noise| {
        let touches = [touch];
        model
            .recognise(Evidence::of(&touches).under(Some(noise)))
            .at_rim
    };
    assert!(at_rim(&noise) && !at_rim(&noise.with_dead(dead)));
}

#[test]
fn probabilities_of_all_imprints_sum_up_to_one() {
    // On 3 × 3, Σ over all 512 imprints of P(imprint | s) is 1 if the likelihoods are correct.
    let model = tiny();
    let flip: f64 = 0.2;
    let noise = Noise::new(flip).expect("in range");
    let mut sums = [0.0; 2];
    for bits in 0_u64..512 {
        let mut imprint = Imprint::empty(size(3, 3));
        for row in 0..3 {
            imprint.set_word(row, bits >> (3 * row));
        }
        let posterior = model.posterior_under(&imprint, &noise).expect("keys fit");
        let expected = by_definition(&model, &imprint, 0.2, &Imprint::empty(size(3, 3)));
        let distances = model.distances(&imprint, &noise).expect("keys fit");
        for shape in 0..2 {
            assert!((posterior[shape] - expected[shape]).abs() < 2e-9);
            // With this much noise all distances matter, so these are all touches.
            let touches = &distances.touches[shape];
            let total: u64 = touches.iter().sum();
            let at = |distance: u32| {
                flip.powf(distance.into()) * (1.0 - flip).powf(f64::from(9 - distance))
            };
            for (distance, &touches) in (distances.nearest.distance..=9).zip(touches) {
                sums[shape] += float(touches) / float(total) * at(distance);
            }
        }
    }
    assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 1e-9), "{sums:?}");
}

#[test]
fn an_imprint_that_no_shape_leaves_is_possible_only_under_noise() {
    let model = tiny();
    let noise = |flip| Noise::new(flip).expect("in range");
    let nothing: Imprint = "#...#\n.....\n.....\n.....\n#...#"
        .parse()
        .expect("an imprint");
    assert_eq!(model.posterior_under(&nothing, &noise(0.0)), None);
    assert!(model.posterior_under(&nothing, &noise(0.01)).is_some());
    for wrong in [-0.1, 0.5, 1.0, f64::NAN, f64::INFINITY] {
        assert!(Noise::new(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn the_empty_imprint_is_counted_in_every_place() {
    let sensor = sensor(16);
    let shape = |name: &str, (length, width): (f64, f64)| {
        let figure = Figure::rectangle(length, width).on(&sensor);
        NamedShape::new(name, figure.expect("in range"))
    };
    // The dot leaves one taxel or none.
    let shapes = vec![shape("bar", (2.0, 1.0)), shape("dot", (0.8, 0.9))];
    let model = train(shapes, 16, ranges("5:5.9:0.1", "5:5.9:0.1", "0"));
    let nothing = Imprint::empty(size(5, 5));
    for flip in [0.0, 1e-8, 0.01] {
        let noise = Noise::new(flip).expect("in range");
        let posterior = model.posterior_under(&nothing, &noise).expect("keys fit");
        let expected = by_definition(&model, &nothing, flip, &nothing);
        for (found, expected) in posterior.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 2e-9,
                "{flip}: {found} {expected}"
            );
        }
    }
}

#[test]
fn posteriors_agree_with_independent_ones() {
    let given = std::env::var_os("TAXEL_REFERENCE_NOISE");
    let is_given = given.is_some();
    let path = given.map_or_else(
        || {
            PathBuf::from(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../shared/reference/noise.jsonl"
            ))
        },
        PathBuf::from,
    );
    let Ok(text) = std::fs::read_to_string(&path) else {
        assert!(!is_given, "there is nothing at {}", path.display());
        let missing = format!("no reference posteriors at {}", path.display());
        crate::skip::skipped(&missing);
        return;
    };
    let model = train(s4(), 32, published());
    assert!(text.lines().count() >= 7, "the file is cut short");
    for line in text.lines() {
        let case: Value = serde_json::from_str(line).expect("a line of JSON");
        let rows = case["imprint"].as_array().expect("rows");
        let rows = rows.iter().map(|row| row.as_str().expect("a row"));
        let imprint = Imprint::from_rows(rows).expect("an imprint");
        let noise = Noise::new(case["noise"].as_f64().expect("a number")).expect("in range");
        let posterior = model.posterior_under(&imprint, &noise).expect("keys fit");
        let answer = model.recognise(Evidence::of(&[imprint]).under(&noise));
        for (shape, probability) in answer.ranking {
            assert!((posterior[shape] - probability).abs() < 1e-9, "{shape}");
        }
        for (shape, found) in model.shapes().iter().zip(posterior) {
            let expected = case["posterior"][&shape.name].as_f64().expect("a number");
            assert!(
                (found - expected).abs() < 1e-6,
                "{}: {found} {expected}",
                shape.name
            );
        }
    }
}

#[test]
fn the_recognition_rate_is_as_published_and_as_claimed() {
    // S1 with one flipped taxel in a hundred on 16 × 16: 0.654, from 7,000 touches.
    let model = train(s1(), 32, published());
    let noise = Noise::new(0.01).expect("in range");
    let rate = model.recognition_rate(size(16, 16), &noise, 1000, 7, &ToTheEnd);
    let rate = rate.expect("not stopped");
    let apart = |found: f64, expected: f64, error: f64| (found - expected).abs() / error;
    println!("{rate:?}");
    let error = rate
        .standard_error
        .hypot((0.654_f64 * 0.346 / 7000.0).sqrt());
    assert!(
        apart(rate.accuracy, 0.654, error) < 3.0,
        "{}",
        rate.accuracy
    );
    // The accuracy equals the average claimed probability.
    assert!(apart(rate.mean_confidence, rate.accuracy, rate.standard_error) < 3.0);
}

#[test]
fn the_claimed_accuracy_is_reached_at_every_noise() {
    for (name, set) in [("S1", s1()), ("S4", s4())] {
        let model = train(set, 32, published());
        for flip in [0.001, 0.01, 0.05] {
            let noise = Noise::new(flip).expect("in range");
            let rate = model.recognition_rate(size(16, 16), &noise, 150, 11, &ToTheEnd);
            let rate = rate.expect("not stopped");
            let apart = (rate.mean_confidence - rate.accuracy).abs() / rate.standard_error;
            assert!(apart < 3.0, "{name} at {flip}: {rate:?}");
        }
    }
}

#[test]
fn the_number_of_touches_until_certainty_is_as_published() {
    // The expected number of touches until one shape has a posterior of 0.99: 6.68 for S1, 4.96 for S4.
    for (set, expected) in [(s1(), 6.68), (s4(), 4.96)] {
        let model = train(set, 32, published());
        let touches = model
            .touches_until(0.99, 4000, 3, &ToTheEnd)
            .expect("not stopped");
        let mean = touches
            .iter()
            .map(|own| own.mean)
            .sum::<Option<f64>>()
            .expect("reached")
            / float(touches.len() as u64);
        println!("{mean} {expected}");
        assert!(
            (mean / expected - 1.0).abs() < 0.02,
            "{mean}, expected {expected}"
        );
        assert!(touches.iter().all(|own| own.reached == 4000));
    }
}
