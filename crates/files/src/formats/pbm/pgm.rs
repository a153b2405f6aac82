//! The shades of a portable greymap, plain (`P2`, numbers) or raw (`P5`, bytes). There are two shades; the brighter
//! one is active.
//!
//! Source: <https://netpbm.sourceforge.net/doc/pgm.html>. If the brightest shade is above 255, a raw shade takes two
//! bytes, the higher one first.

use crate::formats::pbm::cursor::Cursor;
use crate::formats::pbm::error::PbmError;
use crate::imprint::Imprint;

/// Reads everything after the height; returns the offset after the last shade.
pub(super) fn shades(
    cursor: &mut Cursor<'_>,
    raw: bool,
    imprint: &mut Imprint,
) -> Result<usize, PbmError> {
    let (brightest, offset) = cursor.number();
    let brightest = brightest.filter(|shade| (1..=65535).contains(shade));
    let brightest = brightest.ok_or_else(|| {
        let (line, column) = cursor.line_and_column(offset);
        PbmError::Maximum { line, column }
    })?;
    let expected = imprint.size().cells();
    let shades = if raw {
        raw_shades(cursor, brightest, expected)?
    } else {
        plain_shades(cursor, brightest, expected)?
    };
    let (Some(&low), Some(&high)) = (shades.iter().min(), shades.iter().max()) else {
        return Err(PbmError::Unclear);
    };
    if low == high && low != 0 && low != brightest {
        return Err(PbmError::Unclear);
    }
    let mut shades = shades.iter();
    for row in 0..imprint.rows() {
        for (column, &shade) in (0..imprint.columns()).zip(&mut shades) {
            if shade != low && shade != high {
                let (row, column) = (row + 1, column + 1);
                return Err(PbmError::Third { row, column });
            }
            imprint.set(column, row, shade == high && high > 0);
        }
    }
    Ok(cursor.at)
}

/// Reads decimal numbers that are separated by blanks and comments.
///
/// # Errors
/// Returns an error if there are too few shades, or if one is above the brightest.
fn plain_shades(
    cursor: &mut Cursor<'_>,
    brightest: u32,
    expected: usize,
) -> Result<Vec<u32>, PbmError> {
    let mut shades = Vec::with_capacity(expected);
    while shades.len() < expected {
        let (shade, offset) = cursor.number();
        match shade.filter(|&shade| shade <= brightest) {
            Some(shade) => shades.push(shade),
            None if cursor.at == cursor.bytes.len() && shade.is_none() => {
                return Err(PbmError::Short {
                    found: shades.len(),
                    expected,
                    unit: "taxels",
                });
            }
            None => {
                let (line, column) = cursor.line_and_column(offset);
                return Err(PbmError::Shade { line, column });
            }
        }
    }
    // Comments after the last number do not begin a second image.
    let _ = cursor.next();
    Ok(shades)
}

/// Reads shades of one or two bytes each.
///
/// # Errors
/// Returns an error if there are too few shades, if one is above the brightest, or if a comment stands in place of
/// the one space before them.
fn raw_shades(
    cursor: &mut Cursor<'_>,
    brightest: u32,
    taxels: usize,
) -> Result<Vec<u32>, PbmError> {
    // Exactly one space separates the brightest shade from the first one, which may look like a space.
    let (line, column) = cursor.line_and_column(cursor.at);
    if cursor.bytes.get(cursor.at) == Some(&b'#') {
        return Err(PbmError::Space { line, column });
    }
    let start = (cursor.at + 1).min(cursor.bytes.len());
    let size = if brightest > 255 { 2 } else { 1 };
    let bytes = &cursor.bytes[start..];
    let bytes = bytes.get(..taxels * size).ok_or(PbmError::Short {
        found: bytes.len(),
        expected: taxels * size,
        unit: "bytes of taxels",
    })?;
    cursor.at = start + bytes.len();
    let shades = bytes.chunks(size).map(|bytes| {
        let shade = bytes
            .iter()
            .fold(0, |shade, &byte| shade << 8 | u32::from(byte));
        (shade <= brightest).then_some(shade)
    });
    shades
        .collect::<Option<_>>()
        .ok_or(PbmError::Shade { line, column })
}

#[cfg(test)]
mod tests {
    use crate::formats::pbm::read;

    #[test]
    fn two_shades_are_an_imprint() {
        for bytes in [
            &b"P2\n# a cup\n3 2\n255\n255 0 255\n255 255 255\n"[..],
            b"P2 3 2 9 7 1 7 7 7 7 # the end",
            b"P5 3 2 255 \xff\0\xff\xff\xff\xff",
            b"P5\n3 2\n# two\n1\n\x01\0\x01\x01\x01\x01",
            b"P5 3 2 256 \x01\0\0\x01\x01\0\x01\0\x01\0\x01\0",
        ] {
            let cup = read(bytes).map(|cup| cup.to_string());
            assert_eq!(cup, Ok("#.#\n###".to_owned()), "{bytes:?}");
        }
        let single = |bytes: &[u8]| read(bytes).map(|imprint| imprint.count());
        assert_eq!(single(b"P2 2 1 9 0 0"), Ok(0));
        assert_eq!(single(b"P2 2 1 9 9 9"), Ok(2));
    }

    #[test]
    fn errors_name_their_place() {
        for (bytes, message) in [
            (
                &b"P2 1 1"[..],
                "line 1, column 7: expected the brightest shade, 1 to 65535",
            ),
            (
                b"P5 1 1 65536 \0",
                "line 1, column 8: expected the brightest shade, 1 to 65535",
            ),
            (b"P2 2 1 9 1", "taxels: found 1, expected 2"),
            (
                b"P2 2 1 9\n1 x",
                "line 2, column 3: expected a shade, 0 to the brightest",
            ),
            (
                b"P2 2 1 9\n1 10",
                "line 2, column 3: expected a shade, 0 to the brightest",
            ),
            (
                b"P2 3 1 9 0 1 2",
                "row 1, column 2: a third shade, expected an image with two",
            ),
            (
                b"P2 2 1 9 4 4",
                "one shade of grey everywhere, expected two",
            ),
            (b"P5 2 1 9 \0", "bytes of taxels: found 1, expected 2"),
            (
                b"P5 1 1 9 \x0a",
                "line 1, column 9: expected a shade, 0 to the brightest",
            ),
            (
                b"P5 1 1 9#\0",
                "line 1, column 9: expected one space or line end before the bits",
            ),
            (
                b"P5 1 1 9 \0P5",
                "found 2 bytes after the image, expected one image and no more",
            ),
        ] {
            let outcome = read(bytes).map_err(|error| error.to_string());
            assert_eq!(outcome, Err(message.to_owned()));
        }
    }
}
