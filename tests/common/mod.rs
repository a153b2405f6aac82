//! Helpers for several test files: random numbers from a fixed seed, and short notations for shapes.
#![allow(dead_code, reason = "every test file uses its own part of this one")]

use taxel_core::figure::{Figure, FigureKind};
use taxel_core::geometry::{Pen, Point, Real, Side, Solid};
use taxel_core::imprint::Imprint;
use taxel_core::parameter::Parameter;
use taxel_core::picture::Picture;
use taxel_core::sensor::{MatrixSize, Sensor};
use taxel_core::source::Source;

/// Returns the size of a matrix. Panics if it is not allowed.
pub(crate) fn size(columns: u8, rows: u8) -> MatrixSize {
    MatrixSize::new(columns, rows).expect("1 to 64")
}

/// Random numbers by xorshift (G. Marsaglia, *Xorshift RNGs*, 2003): the same on every machine and in every run.
pub(crate) struct Random(u64);

impl Random {
    /// Starts from any seed. The seed is written in the test, so that every run is the same.
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub(crate) fn word(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        // The low bits of a plain xorshift are its weak ones.
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D).rotate_left(32)
    }

    /// Returns a whole number from `low` to `high`, both included.
    pub(crate) fn whole(&mut self, low: i32, high: i32) -> i32 {
        let count = u64::from(high.abs_diff(low)) + 1;
        low + i32::try_from(self.word() % count).expect("below the span")
    }

    /// Like [`Self::whole`], for a side of a sensor, a column or a row.
    pub(crate) fn side(&mut self, low: u8, high: u8) -> u8 {
        u8::try_from(self.whole(i32::from(low), i32::from(high))).expect("between two u8")
    }

    /// Returns true with a probability of `permille` / 1000.
    pub(crate) fn chance(&mut self, permille: u64) -> bool {
        self.word() % 1000 < permille
    }

    /// Returns a decimal from `low` to `high` with 0, 1 or 2 digits after the point. So few digits cause many ties.
    pub(crate) fn decimal(&mut self, low: i32, high: i32) -> f64 {
        let scale = [1, 10, 100][usize::from(self.side(0, 2))];
        f64::from(self.whole(low * scale, high * scale)) / f64::from(scale)
    }

    /// Like [`Self::decimal`] from 0 to `high`, but always above 0.
    pub(crate) fn size(&mut self, high: i32) -> f64 {
        loop {
            let size = self.decimal(0, high);
            if size > 0.0 {
                return size;
            }
        }
    }

    /// Returns an angle in whole degrees. Every other one is a multiple of 15°, where edges become upright or ties
    /// occur.
    pub(crate) fn angle(&mut self) -> f64 {
        if self.chance(500) {
            f64::from(self.whole(0, 23) * 15)
        } else {
            f64::from(self.whole(0, 359))
        }
    }
}

/// Returns the value of a key in a text such as "key=value key=value".
fn value(text: &str, parameter: Parameter) -> Option<f64> {
    let (_, number) = text
        .split_whitespace()
        .filter_map(|word| word.split_once('='))
        .find(|&(key, _)| key == parameter.row().key)?;
    Some(number.parse().expect("a number after the ="))
}

/// Returns the sensor of `side` × `side` taxels.
pub(crate) fn square(side: u8) -> Sensor {
    Sensor::new(side, side).expect("1 to 64")
}

/// Reads a figure such as `hexagon side=3 x0=2.1 y0=1.35 angle=17 thickness=1`. The angle is 0 if it is not given.
pub(crate) fn figure(text: &str, side: u8) -> Figure {
    let name = text.split_whitespace().next().expect("a name first");
    let kind = name.parse::<FigureKind>().expect("one of the seven names");
    let given =
        |parameter| value(text, parameter).or((parameter == Parameter::Angle).then_some(0.0));
    Figure::new(kind, &square(side), given).expect("values in range")
}

/// Reads a picture such as `##/#. x0=1 y0=1 angle=10 zoom_x=2 zoom_y=2`. The angle is 0 and the zoom 1 if not given.
pub(crate) fn picture(text: &str, side: u8) -> Source {
    let rows = text.split_whitespace().next().expect("rows first");
    let given = |parameter| {
        value(text, parameter).or(match parameter {
            Parameter::Angle => Some(0.0),
            Parameter::ZoomX | Parameter::ZoomY => Some(1.0),
            _ => None,
        })
    };
    let home = Source::from(Picture::at_home(grid(rows)));
    home.placed(&square(side), given).expect("values in range")
}

/// A polygon through vertices in either sense.
pub(crate) struct Polygon(Vec<(f64, f64)>);

impl Polygon {
    pub(crate) fn new(vertices: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut vertices: Vec<_> = vertices.into_iter().collect();
        let next = vertices.iter().cycle().skip(1);
        let products = vertices
            .iter()
            .zip(next)
            .map(|(a, b)| a.0 * b.1 - b.0 * a.1);
        if products.sum::<f64>() < 0.0 {
            vertices.reverse();
        }
        Self(vertices)
    }
}

impl Solid for Polygon {
    fn draw<T: Real>(&self, pen: &mut impl Pen<T>) {
        let point = |&(x, y): &(f64, f64)| Point::new(T::decimal(x), T::decimal(y));
        let points: Vec<Point<T>> = self.0.iter().map(point).collect();
        pen.ring(&points, Side::Inside);
    }
}

/// Reads an imprint from rows with `/` or line ends between them. Spaces around the rows are ignored.
pub(crate) fn grid(text: &str) -> Imprint {
    let rows = text
        .split(['/', '\n'])
        .map(str::trim)
        .filter(|row| !row.is_empty());
    Imprint::from_rows(rows).expect("rows of # and .")
}

/// Returns a sensor with these columns, rows and threshold.
pub(crate) fn sensor(columns: u8, rows: u8, threshold: f64) -> Sensor {
    Sensor::new(columns, rows)
        .and_then(|sensor| sensor.with(Parameter::Threshold, threshold))
        .expect("a sensor in range")
}
