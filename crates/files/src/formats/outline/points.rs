//! Points as a table: `x,y` in each line, and an empty line between rings.

use taxel_core::outline::{MOST_POINTS, Ring};
use taxel_core::quote::shortened;

use super::{OutlineOptions, OutlineUnit, ReadOutline};
use crate::error::ReadError;
use crate::formats::table::fields;

/// Reads rings. Separators are commas, semicolons, tabs or blanks, comments begin with `#`, and the first line may be
/// names. A ring may repeat its first point at its end.
pub(super) fn read(text: &str, options: &OutlineOptions) -> Result<ReadOutline, ReadError> {
    let mut rings = vec![Vec::new()];
    let mut count = 0;
    let mut may_be_names = true;
    for (number, line) in (1..).zip(text.lines().map(str::trim)) {
        if line.starts_with('#') {
            continue;
        }
        if line.is_empty() {
            rings.push(Vec::new());
            continue;
        }
        let is_names = may_be_names && fields(line).all(|field| field.parse::<f64>().is_err());
        may_be_names = false;
        if is_names {
            continue;
        }
        count += 1;
        if count > MOST_POINTS {
            let message = format!("more than {MOST_POINTS} points");
            return Err(ReadError::new(message).in_line(number));
        }
        let point = point(line, options).map_err(|error| error.in_line(number))?;
        if let Some(ring) = rings.last_mut() {
            ring.push(point);
        }
    }
    rings.retain(|ring| !ring.is_empty());
    if rings.is_empty() {
        return Err(ReadError::new("no points, expected x,y in each line"));
    }
    for ring in &mut rings {
        if ring.len() > 3 && ring.first() == ring.last() {
            ring.pop();
        }
    }
    let unit = match options.mm_per_unit {
        Some(_) => OutlineUnit::Mm,
        None => OutlineUnit::Cells,
    };
    Ok(ReadOutline {
        rings: rings.into_iter().map(Ring::Polygon).collect(),
        unit,
        left_out: Vec::new(),
    })
}

fn point(line: &str, options: &OutlineOptions) -> Result<[f64; 2], ReadError> {
    let number = |(field, column): (&str, u64)| {
        let found = field.parse::<f64>().ok().filter(|own| own.is_finite());
        found.ok_or_else(|| {
            let found = shortened(field);
            ReadError::new(format!("found {found:?}, expected a number")).in_column(column)
        })
    };
    let numbers: Vec<f64> = fields(line)
        .zip(1..)
        .map(number)
        .collect::<Result<_, _>>()?;
    let [x, y] = numbers[..] else {
        let count = numbers.len();
        let values = if count == 1 { "value" } else { "values" };
        let message = format!("found {count} {values}, expected x and y");
        return Err(ReadError::new(message));
    };
    let scale = options.mm_per_unit.unwrap_or(1.0);
    // Not −y, which may be −0.
    let y = if options.y_up { 0.0 - y } else { y };
    Ok([x * scale, y * scale])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_read_with_any_separator() {
        let rings = |text: &str| read(text, &OutlineOptions::default()).map(|read| read.rings);
        let triangle = || Ring::Polygon(vec![[0.0, 0.0], [4.5, 0.0], [0.0, 3.0]]);
        let square = Ring::Polygon(vec![[5.0, 5.0], [6.0, 5.0], [6.0, 6.0], [5.0, 6.0]]);
        for text in [
            "0,0\n4.5,0\n0,3\n",
            "x,y\r\n0,0\r\n4.5,0\r\n0,3\r\n0,0\r\n",
            "# by hand\n\n0 0\n4.5\t0\n# then\n0;3;\n\n\n",
            "X; Y\n 0 ; 0\n4.50 ; 0\n0e0 ; 3",
        ] {
            assert_eq!(rings(text), Ok(vec![triangle()]), "{text:?}");
        }
        let two = "0,0\n4.5,0\n0,3\n\n5,5\n6,5\n6,6\n5,6\n";
        assert_eq!(rings(two), Ok(vec![triangle(), square]));
    }

    #[test]
    fn points_of_other_programs_have_a_unit_and_y_up() {
        let options = OutlineOptions {
            mm_per_unit: Some(10.0),
            y_up: true,
            ..OutlineOptions::default()
        };
        let read = read("0,0\n1,0\n0,2", &options).expect("points");
        let points = vec![[0.0, 0.0], [10.0, 0.0], [0.0, -20.0]];
        assert_eq!(read.rings, [Ring::Polygon(points)]);
        assert_eq!(read.unit, OutlineUnit::Mm);
    }

    #[test]
    fn errors_name_their_place() {
        let many = "0,0\n".repeat(MOST_POINTS + 1);
        for (text, message) in [
            ("# nothing\n", "no points, expected x,y in each line"),
            (
                "0,0\n1,one\n",
                "line 2, column 2: found \"one\", expected a number",
            ),
            (
                "x,y\nleft,right\n",
                "line 2, column 1: found \"left\", expected a number",
            ),
            (
                "1,inf\n",
                "line 1, column 2: found \"inf\", expected a number",
            ),
            ("0,0,0\n", "line 1: found 3 values, expected x and y"),
            ("0\n", "line 1: found 1 value, expected x and y"),
            (&many, "line 20001: more than 20000 points"),
        ] {
            let error = read(text, &OutlineOptions::default()).expect_err(message);
            assert_eq!(error.to_string(), message);
        }
    }
}
