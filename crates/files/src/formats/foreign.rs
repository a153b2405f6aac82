//! Files of other kinds, recognised by their first bytes and refused by name.

/// The first bytes of a kind of file, their offset, and the name of the kind.
type Magic = (&'static [u8], usize, &'static str);

/// The known kinds; the first match counts.
const MAGIC: [Magic; 19] = [
    (b"\x89PNG\r\n\x1a\n", 0, "a PNG image"),
    (b"GIF8", 0, "a GIF image"),
    (b"II*\0", 0, "a TIFF image"),
    (b"MM\0*", 0, "a TIFF image"),
    (b"II+\0", 0, "a TIFF image"),
    (b"MM\0+", 0, "a TIFF image"),
    (b"\xff\xd8\xff", 0, "a JPEG image"),
    (b"WEBP", 8, "a WebP image"),
    (b"ftyp", 4, "an HEIF or AVIF image, or a film"),
    (b"#define ", 0, "an XBM image"),
    (b"<svg", 0, "an SVG drawing"),
    (b"<?xml", 0, "XML, perhaps an SVG drawing"),
    (b"%PDF", 0, "a PDF document"),
    (b"PK\x03\x04", 0, "an archive, perhaps NPZ or a spreadsheet"),
    (b"\x1f\x8b", 0, "a gzip archive"),
    (b"\x89HDF\r\n\x1a\n", 0, "an HDF5 file"),
    (b"MATLAB 5.0 MAT-file", 0, "a MATLAB file"),
    (b"\xff\xfe", 0, "text in UTF-16 (save it as UTF-8)"),
    (b"\xfe\xff", 0, "text in UTF-16 (save it as UTF-8)"),
];

/// Returns the kind of a file that cannot be read, with its article; None if the file may be an imprint.
pub(crate) fn kind(bytes: &[u8]) -> Option<&'static str> {
    let is = |magic: &[u8], at: usize| bytes.get(at..).is_some_and(|rest| rest.starts_with(magic));
    let known = MAGIC.iter().find(|&&(magic, at, _)| is(magic, at));
    // A table may begin with "BM"; the four reserved bytes of a bitmap are 0.
    let bmp = is(b"BM", 0) && is(&[0; 4], 6);
    let netpbm =
        |digit: u8| is(&[b'P', digit], 0) && bytes.get(2).is_some_and(u8::is_ascii_whitespace);
    match known {
        Some(&(_, _, kind)) => Some(kind),
        None if bmp => Some("a BMP image"),
        None if netpbm(b'3') || netpbm(b'6') => Some("a PPM image"),
        None if netpbm(b'7') => Some("a PAM image"),
        None => None,
    }
}
