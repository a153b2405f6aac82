//! Checks the numbers of geometry against constants of 32 digits and against identities.
//!
//! The constants were computed with 60 digits by series in whole-number arithmetic, independently of the code here.

use taxel_core::geometry::{Double, Real, cell_area};
use taxel_core::parameter::Parameter;
use taxel_core::sensor::Sensor;
use taxel_core::touch::Plane;

use crate::common::figure;

const PI: &str = "3.1415926535897932384626433832795";

/// Reads a number of up to 32 digits, digit by digit: a second method beside [`Real::decimal`], which reads an `f64`.
fn number(text: &str) -> Double {
    let (sign, text) = text.strip_prefix('-').map_or((1, text), |rest| (-1, rest));
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let ten = Double::whole(10);
    let digits = whole
        .bytes()
        .chain(fraction.bytes())
        .map(|digit| Double::whole(i32::from(digit - b'0')));
    let power = fraction.bytes().fold(Double::ONE, |power, _| power * ten);
    Double::whole(sign) * digits.fold(Double::ZERO, |number, digit| number * ten + digit) / power
}

fn distance(a: Double, b: Double) -> f64 {
    (a - b).abs().to_f64()
}

fn assert_near(name: &str, found: Double, expected: Double, within: f64) {
    let off = distance(found, expected);
    assert!(
        off <= within,
        "{name}: {found:?} is {off:e} off {expected:?}"
    );
}

#[test]
fn decimals_have_the_value_that_is_written() {
    let one = Double::ONE;
    for (value, scale) in [
        (0.1, 10),
        (0.2, 5),
        (0.01, 100),
        (0.001, 1000),
        (2.5e-3, 400),
        (1e-9, 1_000_000_000),
    ] {
        assert_near(
            &format!("{value}"),
            Double::decimal(value) * Double::whole(scale),
            one,
            1e-30,
        );
    }
    for text in [
        "0.3",
        "-0.7",
        "15.99",
        "0.123456789012345",
        "63.00000000001",
        "360",
        "-64",
        "0",
        "9007199254740993",
    ] {
        let value: f64 = text.parse().expect("a number");
        let read = number(&format!("{value}"));
        assert_near(text, Double::decimal(value), read, 1e-30 * value.abs());
    }
    // In binary, 0.1 is a different number; only its shortest decimal is one tenth.
    assert!(distance(Double::from(0.1), Double::decimal(0.1)) > 1e-18);
    assert_eq!(Double::decimal(-0.0), Double::ZERO);
    assert_eq!(f64::decimal(0.1), 0.1);
}

#[test]
fn sums_products_and_quotients_hold_thirty_digits() {
    let (two, three, seven) = (Double::whole(2), Double::whole(3), Double::whole(7));
    assert_near(
        "1/7",
        Double::ONE / seven,
        number("0.1428571428571428571428571428571"),
        1e-31,
    );
    assert_near("2/3 · 3", two / three * three, two, 1e-31);
    assert_near(
        "1/3 + 1/7",
        Double::ONE / three + Double::ONE / seven,
        Double::whole(10) / Double::whole(21),
        1e-31,
    );
    assert_near(
        "(π + 1)²",
        (number(PI) + Double::ONE) * (number(PI) + Double::ONE),
        number(PI) * number(PI) + two * number(PI) + Double::ONE,
        1e-29,
    );
    // After cancellation, the small rest is complete.
    let hair = Double::decimal(1e-25);
    assert_near(
        "1 + 1e-25 − 1",
        Double::ONE + hair - Double::ONE,
        hair,
        1e-31,
    );
    assert!(Double::ONE - hair < Double::ONE && Double::ONE + hair > Double::ONE);
    assert_eq!((-hair).abs(), hair);
    assert_eq!(Real::min(hair, Double::ONE), hair);
    assert_eq!(Real::max(hair, Double::ONE), Double::ONE);
}

#[test]
fn floor_uses_both_halves_of_a_double() {
    let hair = Double::decimal(1e-25);
    for whole in [-64, -3, -1, 0, 1, 2, 63, 64] {
        let exact = Double::whole(whole);
        assert_eq!(
            (
                exact.floor(),
                (exact + hair).floor(),
                (exact - hair).floor()
            ),
            (whole, whole, whole - 1)
        );
        let value = f64::from(whole);
        assert_eq!(
            (
                Real::floor(value),
                Real::floor(value + 0.25),
                Real::floor(value - 0.25)
            ),
            (whole, whole, whole - 1)
        );
    }
    assert_eq!(Real::floor(1e300), i32::MAX);
    for below in [-1e300, f64::NEG_INFINITY, f64::from(i32::MIN) - 0.5] {
        assert_eq!(Real::floor(below), i32::MIN);
        assert_eq!(Double::from(below).floor(), i32::MIN);
    }
    assert_eq!(Real::floor(f64::NAN), 0);
}

#[test]
fn square_roots_hold_thirty_digits() {
    for (square, root) in [
        ("2", "1.4142135623730950488016887242097"),
        ("3", "1.7320508075688772935274463415059"),
        ("5", "2.2360679774997896964091736687313"),
    ] {
        assert_near(square, number(square).sqrt(), number(root), 1e-30);
    }
    for whole in 1..=4096 {
        let square = Double::whole(whole);
        let root = square.sqrt();
        assert_near("√n · √n", root * root, square, 1e-31 * f64::from(whole));
        let tiny = square * Double::decimal(1e-30);
        assert_near(
            "a small root",
            tiny.sqrt() * tiny.sqrt(),
            tiny,
            1e-61 * f64::from(whole),
        );
    }
    // The square of a vanishing root may come out slightly below 0.
    for nought in [Double::ZERO, -Double::decimal(1e-32)] {
        assert_eq!(nought.sqrt(), Double::ZERO);
    }
    assert_eq!(Real::sqrt(-1e-17_f64), 0.0);
}

#[test]
fn sines_and_cosines_of_whole_degrees_hold_thirty_digits() {
    let of = |degrees: i32| Double::whole(degrees).sin_cos_degrees();
    for (degrees, sin, cos) in [
        (
            "1",
            "0.0174524064372835128194189785163",
            "0.9998476951563912391570115588139",
        ),
        (
            "7",
            "0.1218693434051474811128939192315",
            "0.9925461516413220349800615893306",
        ),
        (
            "17",
            "0.2923717047227367280974686953771",
            "0.9563047559630354813386508166184",
        ),
        (
            "44.99",
            "0.7069833570023731128960038343691",
            "0.7072301838310176707106761264228",
        ),
        (
            "123.45",
            "0.8343671603687316385542709164164",
            "-0.5512090725833703653179069364044",
        ),
    ] {
        let (found_sin, found_cos) = number(degrees).sin_cos_degrees();
        assert_near(degrees, found_sin, number(sin), 1e-30);
        assert_near(degrees, found_cos, number(cos), 1e-30);
    }
    let root = |whole: i32| Double::whole(whole).sqrt();
    let two = Double::whole(2);
    assert_near("sin 30", of(30).0, Double::HALF, 1e-31);
    assert_near("cos 60", of(60).1, Double::HALF, 1e-31);
    assert_near("sin² 45", of(45).0 * of(45).0, Double::HALF, 1e-31);
    assert_near("sin 60", of(60).0, root(3) / two, 1e-31);
    assert_near(
        "sin 18",
        of(18).0,
        (root(5) - Double::ONE) / Double::whole(4),
        1e-31,
    );
    assert_near(
        "cos 15",
        of(15).1,
        (root(6) + root(2)) / Double::whole(4),
        1e-31,
    );
    for (degrees, sin, cos) in [
        (0, 0, 1),
        (90, 1, 0),
        (180, 0, -1),
        (270, -1, 0),
        (360, 0, 1),
        (-90, -1, 0),
    ] {
        assert_eq!(
            of(degrees),
            (Double::whole(sin), Double::whole(cos)),
            "exactly, at {degrees}"
        );
        let plain = f64::from(degrees).sin_cos_degrees();
        assert_eq!(
            plain,
            (f64::from(sin), f64::from(cos)),
            "exactly, at {degrees}"
        );
    }
    for degrees in -360..=720 {
        let (sin, cos) = of(degrees);
        assert_near("sin² + cos²", sin * sin + cos * cos, Double::ONE, 1e-30);
        assert_near("sin(−a)", of(-degrees).0, -sin, 1e-31);
        assert_near("cos(−a)", of(-degrees).1, cos, 1e-31);
        assert_near("cos(90 − a)", of(90 - degrees).1, sin, 1e-31);
        // The addition theorem, for every angle with the angles 37 and 101 degrees further.
        for further in [37, 101] {
            let (sin_b, cos_b) = of(further);
            assert_near(
                "sin(a + b)",
                of(degrees + further).0,
                sin * cos_b + cos * sin_b,
                1e-30,
            );
            assert_near(
                "cos(a + b)",
                of(degrees + further).1,
                cos * cos_b - sin * sin_b,
                1e-30,
            );
        }
        let (plain_sin, plain_cos) = f64::from(degrees).sin_cos_degrees();
        assert!(
            (plain_sin - sin.to_f64()).abs() < 1e-15 && (plain_cos - cos.to_f64()).abs() < 1e-15
        );
    }
}

#[test]
fn plain_sines_and_cosines_are_those_of_thirty_digits_rounded() {
    for step in -4000..=8000 {
        let degrees = f64::from(step) * 0.0973;
        let (sin, cos) = Double::from(degrees).sin_cos_degrees();
        let (plain_sin, plain_cos) = degrees.sin_cos_degrees();
        assert_near(&format!("sin {degrees}°"), plain_sin.into(), sin, 4e-16);
        assert_near(&format!("cos {degrees}°"), plain_cos.into(), cos, 4e-16);
    }
    // Small angles keep all of their digits, and many turns cost none.
    assert_eq!(
        (-1e-300_f64).sin_cos_degrees(),
        ((-1e-300_f64).to_radians(), 1.0)
    );
    assert_eq!(360e9_f64.sin_cos_degrees(), (0.0, 1.0));
    assert_eq!((-36_090_f64).sin_cos_degrees(), (-1.0, 0.0));
    for degrees in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let (sin, cos) = degrees.sin_cos_degrees();
        assert!(sin.is_nan() && cos.is_nan(), "{degrees}");
    }
}

#[test]
fn angles_are_recovered_from_sine_and_cosine() {
    for tenths in -900..=900 {
        let degrees = Double::whole(tenths) / Double::whole(10);
        let (sin, cos) = degrees.sin_cos_degrees();
        let expected = number(PI) * degrees / Double::whole(180);
        let text = format!("{}°", f64::from(tenths) / 10.0);
        assert_near(&text, Double::angle(sin, cos), expected, 1e-31);
        let plain = f64::angle(sin.to_f64(), cos.to_f64());
        assert!((plain - expected.to_f64()).abs() < 5e-16, "{text}: {plain}");
    }
    // Near the ends, where the sine alone says nothing, and in the middle, with tiny numbers down to zero.
    for power in 0..300 {
        let small = 0.1_f64.powi(power) * 0.5;
        let large = ((1.0 - small) * (1.0 + small)).sqrt();
        for (sin, cos) in [
            (small, large),
            (-small, large),
            (large, small),
            (-large, small),
        ] {
            let off = (f64::angle(sin, cos) - sin.atan2(cos)).abs();
            assert!(off < 5e-16, "{sin}, {cos}: {off:e}");
        }
    }
    assert_eq!(
        Double::angle(Double::ONE, Double::ZERO),
        Double::QUARTER_TURN
    );
}

#[test]
fn areas_in_f64_hold_eleven_digits() {
    let mut plane = Plane::new(Sensor::new(64, 64).expect("a sensor"));
    for text in [
        "ellipse radius_x=31.9 radius_y=31.7 x0=0.13 y0=0.21",
        "ellipse radius_x=63.9 radius_y=63.7 x0=-40.3 y0=-31.2 angle=33",
        "ellipse radius_x=63.9 radius_y=1.7 x0=-31.3 y0=29.2 angle=41 thickness=0.3",
        "ellipse radius_x=5.1 radius_y=60.3 x0=28.3 y0=-27.9 angle=88 thickness=5",
        // The largest moments that a figure can have: off by 1.4e-12.
        "ellipse radius_x=63.25 radius_y=63.25 x0=49.2 y0=-19.69",
        "ellipse radius_x=0.3 radius_y=0.2 x0=63.1 y0=62.7 angle=7",
        "rectangle length=63 width=2.5 x0=0.3 y0=30.1 angle=29 thickness=1",
        "octagon side=25 x0=1.3 y0=0.7 angle=17 thickness=20",
    ] {
        let figure = figure(text, 64);
        plane.touch(&figure);
        let coverages = plane.coverages();
        // Every seventh cell, starting at another column in each row.
        for row in 0..64_u8 {
            for column in (row % 7..64).step_by(7) {
                let exact = cell_area::<Double>(&figure, column, row).to_f64();
                let off = (coverages.get(column, row).expect("a taxel") - exact).abs();
                assert!(off < 2e-12, "{text} at {column}, {row}: {off:e}");
            }
        }
    }
}

#[test]
fn areas_of_cells_hold_twenty_eight_digits() {
    let (pi, half) = (number(PI), Double::HALF);
    let (root_2, root_3) = (Double::whole(2).sqrt(), Double::whole(3).sqrt());
    let quarter = pi * half * half;
    let third = pi / Double::whole(3);
    // tests/imprints/coverage.rs explains the closed forms of these areas.
    for (text, (column, row), expected) in [
        (
            "ellipse radius_x=0.5 radius_y=0.5 x0=3 y0=5",
            (3, 5),
            quarter,
        ),
        (
            "ellipse radius_x=1 radius_y=1 x0=4 y0=6 angle=33",
            (4, 6),
            quarter,
        ),
        (
            "ellipse radius_x=0.3 radius_y=0.4 x0=0.2 y0=0.1",
            (0, 0),
            Double::decimal(0.12) * pi,
        ),
        (
            "ellipse radius_x=2 radius_y=2 x0=0 y0=0",
            (0, 1),
            root_3 * half + third - Double::ONE,
        ),
        (
            "ellipse radius_x=2 radius_y=1 x0=3 y0=3",
            (5, 3),
            (root_3 * half + third) * half,
        ),
        (
            "rectangle length=2 width=2 x0=1.5 y0=1.5 angle=45",
            (3, 2),
            root_2 - Double::decimal(0.75),
        ),
        (
            "rectangle length=2 width=2 x0=1.5 y0=1.5 angle=45",
            (3, 3),
            Double::decimal(1.5) - root_2,
        ),
        (
            "triangle side=2 x0=1 y0=1 angle=120",
            (1, 2),
            Double::ONE / root_3,
        ),
        ("octagon side=1 x0=1.25 y0=1 angle=45", (1, 1), half),
        ("rectangle length=0.5 width=1 x0=2.3 y0=1", (2, 1), half),
    ] {
        assert_near(
            text,
            cell_area::<Double>(&figure(text, 16), column, row),
            expected,
            1e-28,
        );
    }
}

/// An edge that is horizontal up to a rounding of `f64` still has a height, and each taxel in doubt along it is
/// decided by its own area.
#[test]
fn edges_that_f64_takes_for_horizontal_are_decided_with_more_digits() {
    let rows = |text: &str, side| {
        let figure = figure(text, side);
        let mut plane = Plane::new(Sensor::new(side, side).expect("in range"));
        plane.touch(&figure).words().to_vec()
    };
    let upright = "rectangle length=0.5 width=4 x0=28.25 angle=89.99999999999999";
    let (above, below) = (
        rows(&format!("{upright} y0=3.25"), 64),
        rows(&format!("{upright} y0=18.25"), 64),
    );
    assert!(above.iter().any(|&row| row != 0));
    assert_eq!(above[..40], below[15..55]);
    let flat = "rectangle length=6 width=0.5 y0=4 angle=5.551115123125783e-17";
    let (on, cut) = (
        rows(&format!("{flat} x0=3.5"), 16),
        rows(&format!("{flat} x0=-3.5"), 16),
    );
    for (on, cut) in on.iter().zip(cut) {
        assert_eq!(on >> 7, cut);
    }
    // A threshold and a height that vanish beside the figure's position: of the six cells at that height, half a cell
    // counts at each end.
    let thin = figure("rectangle length=6 width=1e-18 x0=4 y0=4.5", 16);
    let sensor = Sensor::default().with(Parameter::Threshold, 1e-18);
    let imprint = Plane::new(sensor.expect("in range")).touch(&thin);
    assert_eq!((imprint.words()[4], imprint.count()), (0b11_1111 << 4, 6));
}
