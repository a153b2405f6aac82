//! Models, which `taxel recognise` reads, and the shapes of a set: any bytes, and valid models with changed arrays.

use std::cell::LazyCell;
use std::io::Cursor;

use taxel_core::figure::Figure;
use taxel_core::imprint::Imprint;
use taxel_core::picture::Picture;
use taxel_core::pose::{Anchor, Axis, Ranges};
use taxel_core::recognition::{Evaluation, Evidence, Model, ModelMerge, NamedShape, Training};
use taxel_core::sensor::Sensor;
use taxel_core::sweep::Shard;
use taxel_files::formats::{named_shape, read_model, write_model};

use super::archive::{Arrays, changed, unpacked};
use super::{is_short, refused};

/// Reads any bytes.
pub(crate) fn model(bytes: &[u8]) -> bool {
    match read_model(Cursor::new(bytes)) {
        Ok(model) => {
            is_sound(&model);
            true
        }
        Err(error) => refused(&error.to_string()),
    }
}

/// Replaces some bytes in the arrays of a valid model, as in [`arrays`](super::archive::arrays).
pub(crate) fn model_arrays(bytes: &[u8]) -> bool {
    thread_local! {
        static SOUND: LazyCell<Vec<Arrays>> = const { LazyCell::new(sound) };
    }
    let changed = SOUND.with(|sound| changed(sound, bytes));
    changed.is_some_and(|changed| model(&changed))
}

/// Reads a shape of a set.
pub(crate) fn named(bytes: &[u8]) -> bool {
    let lookup = |name: &str| match name {
        "corner" => Ok(Picture::at_home("##\n#.".parse().expect("rows")).into()),
        _ => Err("no such shape".to_owned()),
    };
    match named_shape(bytes, Some(2.5), &lookup) {
        Ok(shape) => {
            let sensor = Sensor::LARGEST;
            let trained = Training::new([shape], sensor, Anchor::Centre, one_pose());
            if let Err(error) = trained {
                is_short(&error.to_string());
            }
            true
        }
        Err(error) => refused(&error.to_string()),
    }
}

/// Returns ranges with a single pose: the centre of the largest sensor.
fn one_pose() -> Ranges {
    let at = |text: &str| text.parse().expect("a range");
    Ranges::default()
        .with(Axis::X0, at("32"))
        .with(Axis::Y0, at("32"))
        .with(Axis::Angle, at("0"))
}

/// Checks a model that was read: its counts add up, it answers, and it is the same when it is written and read again.
fn is_sound(model: &Model) {
    let written = bytes_of(model);
    let again = read_model(Cursor::new(&written)).expect("what was read can be read again");
    assert_eq!(bytes_of(&again), written);
    let limit = Evaluation::of(model);
    assert_eq!(
        limit.confusion.cells().map(|cell| cell.2).sum::<u128>(),
        limit.touches
    );
    let certainty = limit.certainty.expect("the model knows it");
    assert!(certainty.touches <= limit.right && limit.right <= limit.touches);
    assert!(limit.error().is_finite() && limit.information_bits <= limit.prior_bits);
    let touch: Imprint = "....\n.##.\n.##.\n....".parse().expect("rows");
    let answer = model.recognise(Evidence::of(&[touch]));
    let sum: f64 = answer.ranking.iter().map(|(_, share)| share).sum();
    assert!(
        answer.ranking.is_empty() || (sum - 1.0).abs() < 1e-9,
        "{sum}"
    );
    let mut merge = ModelMerge::default();
    if let Err(error) = merge.add(&again).and_then(|()| merge.finish()) {
        is_short(&error.to_string());
    }
}

fn bytes_of(model: &Model) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write_model(model, &mut bytes).expect("it goes into memory");
    bytes.into_inner()
}

/// The arrays of a model; the header comes first.
const READ: [&str; 7] = [
    "header.npy",
    "height.npy",
    "width.npy",
    "rows.npy",
    "key.npy",
    "shape.npy",
    "count.npy",
];

/// A whole model, and a shard of one.
fn sound() -> Vec<Arrays> {
    [Shard::WHOLE, Shard::new(1, 2).expect("a shard")]
        .map(|shard| unpacked(&bytes_of(&small(shard)), &READ))
        .to_vec()
}

/// Returns a model of a bar with weight 2, and a corner.
fn small(shard: Shard) -> Model {
    let sensor = Sensor::new(8, 8).expect("in range");
    let corner: Imprint = "##\n#.".parse().expect("rows");
    let bar = Figure::rectangle(3.0, 2.0).on(&sensor).expect("in range");
    let shapes = [
        NamedShape::new("bar", bar).weighted(2),
        NamedShape::new("corner", Picture::at_home(corner)),
    ];
    let range = |text: &str| text.parse().expect("a range");
    let ranges = Ranges::default()
        .with(Axis::X0, range("4:4.5:0.5"))
        .with(Axis::Y0, range("4:4.75:0.25"))
        .with(Axis::Angle, range("0:90:45"));
    let training = Training::new(shapes, sensor, Anchor::Centre, ranges).expect("a set");
    training
        .with_shard(shard)
        .run()
        .expect("nothing is cut off")
}
