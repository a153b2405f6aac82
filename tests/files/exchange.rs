//! Imprints to other programs and back: every format, every size, and bytes in none of the formats.

use proptest::collection::vec;
use proptest::prelude::*;
use taxel_core::imprint::Imprint;
use taxel_files::ReadErrorKind;
use taxel_files::formats::imprint_file::MAX_BYTES;
use taxel_files::formats::{Drawing, ExportFormat, read_imprint};

use crate::common::size;
use crate::property::config;

/// An imprint of any size, with rows of few, many or all bits.
fn imprints() -> impl Strategy<Value = Imprint> {
    let word = prop_oneof![
        any::<u64>(),
        Just(0),
        Just(u64::MAX),
        any::<u8>().prop_map(u64::from)
    ];
    (1..=64_u8, vec(word, 1..=64)).prop_map(|(columns, words)| {
        let rows = u8::try_from(words.len()).expect("at most 64");
        let mut imprint = Imprint::empty(size(columns, rows));
        for (row, word) in words.into_iter().enumerate() {
            imprint.set_word(row, word);
        }
        imprint
    })
}

/// A format that can be read again.
fn form() -> impl Strategy<Value = &'static ExportFormat> {
    let forms = ExportFormat::ALL
        .iter()
        .filter(|form| form.name != ExportFormat::SVG);
    proptest::sample::select(forms.collect::<Vec<_>>())
}

proptest! {
    #![proptest_config(config(1000))]

    #[test]
    fn every_format_reads_back(imprint in imprints(), form in form()) {
        prop_assert_eq!(read_imprint(&(form.write)(&Drawing::new(&imprint))), Ok(imprint));
    }
}

#[test]
fn each_format_is_recognised_by_its_first_bytes() {
    let cup: Imprint = "#.#\n###".parse().expect("rows");
    for bytes in [
        &b"#.#\n###"[..],
        b"1,0,1\n1,1,1",
        b"\xef\xbb\xbf1;0;1\r\n1;1;1\r\n",
        b"True False True\nTrue True True",
        b"# cup\n1.0e+00 0.0e+00 1.0e+00\n1.0e+00 1.0e+00 1.0e+00\n",
        b"#.#  \n###\t\n",
        b"\xef\xbb\xbf#.#\r\n###\r\n",
    ] {
        assert_eq!(read_imprint(bytes), Ok(cup), "{bytes:?}");
    }
    assert!(read_imprint(&vec![b'1'; MAX_BYTES + 1]).is_err());
}

#[test]
fn errors_name_the_format_and_the_place() {
    let told = |bytes: &[u8]| read_imprint(bytes).map_err(|error| error.to_string());
    for (bytes, message) in [
        (&b""[..], "expected 1 to 64 rows of '#' and '.'"),
        (b"#x", "line 1, column 2: found 'x', expected '#' or '.'"),
        (
            b"1,7",
            "line 1, column 2: found \"7\", expected 0, 1 or 255",
        ),
        (
            b"\x93NUMPY\x01",
            "NPY: not a numpy array: expected a header of version 1 to 3",
        ),
    ] {
        assert_eq!(told(bytes), Err(message.to_owned()));
    }
}

#[test]
fn files_of_other_kinds_are_refused() {
    for bytes in [
        &b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"[..],
        b"BM\x46\0\0\0\0\0\0\0\x36\0\0\0",
        b"GIF89a\x03\0\x02\0",
        b"P2 3 2 255 255 0 255 255 255 255",
        b"PK\x03\x04\x14\0",
        b"\xff\xfe1\0,\x000\0",
        b"#.\n#\xff",
        b"a,b\n1,0\n",
    ] {
        let error = read_imprint(bytes).expect_err("no imprint");
        assert_eq!(error.kind, ReadErrorKind::UnknownFormat, "{error}");
    }
}

#[test]
fn file_extensions_give_the_format() {
    let name = |path| ExportFormat::of_path(path).map(|format| format.name);
    assert_eq!(
        ["a.CSV", "a.npy", "a.bmp", "a.svg"].map(name),
        [Some("csv"), Some("npy"), None, Some("svg")]
    );
}
