//! Ranges and grids of poses are exact, or are refused with the reason.

use taxel_core::figure::FigureKind;
use taxel_core::pose::{Anchor, Axis, DecimalRange, PoseGrid, Ranges};
use taxel_core::sensor::Sensor;

use super::cases::{figure, picture};

#[test]
fn ranges_are_exact_or_refused() {
    let range = |text: &str| text.parse::<DecimalRange>();
    let values = |text: &str| range(text).expect("a range").values().collect::<Vec<_>>();
    assert_eq!(values("0:0.3:0.1"), [0.0, 0.1, 0.2, 0.3]);
    assert_eq!(values("-0.02:0.02:0.01"), [-0.02, -0.01, 0.0, 0.01, 0.02]);
    assert_eq!(values("1:2:0.3"), [1.0, 1.3, 1.6, 1.9]);
    assert_eq!(values(" 7.50 "), [7.5]);
    assert_eq!(values("3:3:1"), [3.0]);
    let hundredths = range("5:5.99:0.01").expect("a range");
    for (index, value) in (500..600).zip(hundredths.values()) {
        assert_eq!(
            value,
            format!("{}.{:02}", index / 100, index % 100)
                .parse::<f64>()
                .expect("a number")
        );
    }
    let refused = |text: &str| range(text).expect_err("no range").to_string();
    assert_eq!(refused("1:2:0.00"), "step 0.00 is not above 0");
    assert_eq!(refused("2:1:0.1"), "the end 1 is below the start 2");
    assert_eq!(refused("1:2:-0.1"), "step -0.1 is not above 0");
    assert_eq!(refused("2:1:-1"), refused("1:2:-1"));
    assert_eq!(
        refused("9999999999999999"),
        "\"9999999999999999\" has too many digits: at most 12 after the point, and 15 in all once each number has as many \
         decimals as the longest"
    );
    assert_eq!(
        refused("0:1e9:1e-9"),
        "\"0:1e9:1e-9\" has too many digits: at most 12 after the point, and 15 in all once each number has as many \
         decimals as the longest"
    );
    assert_eq!(
        refused("1:2"),
        "\"1:2\" is not a range, expected a number or start:end:step"
    );
    assert_eq!(
        refused("1:2:x"),
        "\"x\" is not a decimal number, such as 0.25"
    );
    assert_eq!(refused("1:2,5:1"), "\"2,5\" is not a number; write 2.5");
    assert_eq!(refused(""), "missing, expected a number such as 0.25");
    for (exponent, plain) in [
        ("1e-3", "0.001"),
        ("-2.5E-1:5e-1:2.5e-2", "-0.25:0.5:0.025"),
        ("1.25e1", "12.5"),
        ("1.5e+2:.16e3:1e0", "150:160:1"),
        ("0e99", "0"),
    ] {
        assert_eq!(range(exponent), range(plain), "{exponent}");
    }
    for text in ["1e99", "1e-99"] {
        let message = refused(text);
        assert!(message.contains("has too many digits"), "{text}: {message}");
    }
    assert_eq!(
        refused("1e"),
        "\"1e\" is not a decimal number, such as 0.25"
    );
    for odd in [
        "",
        ":",
        "::",
        ".",
        "-",
        "1:2:3:4",
        "0.0000000000001",
        "99999999999999999999",
        "NaN",
        "+-1",
    ] {
        assert!(range(odd).is_err(), "{odd}");
    }
    assert_eq!(
        refused("0:10:0.000001"),
        "a range of 10,000,001 values; at most 1,000,000 are allowed"
    );
}

#[test]
fn parts_beyond_the_end_of_a_range_are_none() {
    let far = i64::MAX.unsigned_abs();
    for text in ["5:5.99:0.01", "1", "999999999999998:999999999999999:1"] {
        let range: DecimalRange = text.parse().expect("a range");
        let count = range.count();
        assert_eq!(range.part(0..count), Some(range));
        for indices in [
            far..far + 1,
            far - 1..far,
            0..far,
            u64::MAX - 1..u64::MAX,
            count..count,
            count..count + 1,
        ] {
            assert_eq!(range.part(indices.clone()), None, "{text}: {indices:?}");
        }
    }
}

#[test]
fn a_part_equals_the_range_that_is_written_like_it() {
    let read = |text: &str| text.parse::<DecimalRange>().expect("a range");
    for (text, indices, expected) in [
        ("5:5.99:0.01", 10..11, "5.1"),
        ("5:5.99:0.01", 10..12, "5.1:5.11:0.01"),
        ("0.05:2:0.5", 1..2, "0.55"),
        ("0.5:2:0.25", 2..3, "1"),
        ("0:350:10", 35..36, "350"),
    ] {
        assert_eq!(read(text).part(indices), Some(read(expected)), "{text}");
    }
}

#[test]
fn grids_are_in_range_or_refused() {
    let grid = |source, ranges| {
        PoseGrid::new(source, Sensor::default(), Anchor::Corner, ranges).map(|grid| grid.poses())
    };
    let read = |text: &str| text.parse().expect("a range");
    let paper = Ranges::default();
    let ring = || figure(FigureKind::Ellipse, 4.0, 4.0, 2.0);
    assert_eq!(grid(ring(), paper), Ok(3_600_000));
    let far = paper.with(Axis::X0, read("10:17:1"));
    assert_eq!(
        grid(ring(), far).expect_err("no grid").to_string(),
        "x0: 17 is above 16 (allowed: -16 to 16)"
    );
    let round = paper.with(Axis::Angle, read("0:360:1"));
    assert!(
        grid(ring(), round)
            .expect_err("no grid")
            .to_string()
            .starts_with("angle: 360 is not below 360")
    );
    let zoomed = paper.with(Axis::ZoomX, read("1:2:0.5"));
    assert_eq!(
        grid(ring(), zoomed).expect_err("no grid").to_string(),
        "a figure has no zoom, only a picture has one"
    );
    assert_eq!(grid(picture("##"), zoomed), Ok(3 * 3_600_000));
    let fine = read("0:0.999999:0.000001");
    let many = paper.with(Axis::X0, fine).with(Axis::Y0, fine);
    assert_eq!(
        grid(ring(), many).expect_err("no grid").to_string(),
        "360,000,000,000,000 poses, expected at most 1,000,000,000,000"
    );
    let most = many.with(Axis::Angle, read("0"));
    assert_eq!(grid(ring(), most), Ok(1_000_000_000_000));
}
