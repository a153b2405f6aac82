//! Imprints to other programs and back: every form, every size, and bytes that are none of them.

use proptest::collection::vec;
use proptest::prelude::*;
use taxel::formats::imprint_file::MAX_BYTES;
use taxel::formats::{ImprintFormat, ImprintFormatError, read_imprint};
use taxel::imprint::Imprint;

/// An imprint of any size; rows of few bits, of many, or of all.
fn imprints() -> impl Strategy<Value = Imprint> {
    let word = prop_oneof![
        any::<u64>(),
        Just(0),
        Just(u64::MAX),
        any::<u8>().prop_map(u64::from)
    ];
    (1..=64_u8, vec(word, 1..=64)).prop_map(|(columns, words)| {
        let rows = u8::try_from(words.len()).expect("at most 64");
        let mut imprint = Imprint::empty(columns, rows);
        for (row, word) in words.into_iter().enumerate() {
            imprint.set_word(row, word);
        }
        imprint
    })
}

fn form() -> impl Strategy<Value = ImprintFormat> {
    proptest::sample::select(ImprintFormat::ALL)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn what_is_written_reads_back(imprint in imprints(), form in form()) {
        prop_assert_eq!(read_imprint(&form.write(&imprint)), Ok(imprint));
    }

    #[test]
    fn what_is_cut_off_or_changed_is_an_imprint_or_an_error_that_is_short(
        imprint in imprints(), form in form(), cut in any::<usize>(), changes in vec((any::<usize>(), any::<u8>()), 0..4)
    ) {
        let mut bytes = form.write(&imprint);
        for (at, byte) in changes {
            let at = at % bytes.len();
            bytes[at] = byte;
        }
        bytes.truncate(cut % (bytes.len() + 1));
        match read_imprint(&bytes) {
            Ok(imprint) => prop_assert_eq!(read_imprint(&form.write(&imprint)), Ok(imprint)),
            Err(error) => prop_assert!(error.to_string().len() < 300, "{}", error),
        }
    }

    #[test]
    fn any_bytes_are_an_imprint_or_an_error(
        start in proptest::sample::select(&["", "P1", "P4 ", "\u{93}NUMPY", "0,", "\"", "#", "\u{feff}1"][..]),
        rest in vec(any::<u8>(), 0..200)
    ) {
        let bytes = [start.as_bytes(), &rest].concat();
        if let Err(error) = read_imprint(&bytes) {
            prop_assert!(error.to_string().len() < 300, "{}", error);
        }
    }
}

#[test]
fn each_form_is_told_by_its_first_bytes() {
    let cup: Imprint = "#.#\n###".parse().expect("rows");
    for bytes in [
        &b"#.#\n###"[..],
        b"P1 3 2 101111",
        b"P4 3 2 \xa0\xe0",
        b"1,0,1\n1,1,1",
        b"\"1\",\"0\",\"1\"\n\"1\",\"1\",\"1\"",
        b"\xef\xbb\xbf1;0;1\r\n1;1;1\r\n",
        b"+1\t-0\t1\n1\t1\t1",
        b"True,False,True\nTrue,True,True",
    ] {
        assert_eq!(read_imprint(bytes), Ok(cup), "{bytes:?}");
    }
    assert_eq!(
        read_imprint(&vec![b'1'; MAX_BYTES + 1]),
        Err(ImprintFormatError::Large)
    );
}

#[test]
fn errors_name_the_form_and_the_place() {
    let told = |bytes: &[u8]| read_imprint(bytes).map_err(|error| error.to_string());
    for (bytes, message) in [
        (&b""[..], "found 0 lines, expected 1 to 64"),
        (b"#x", "line 1, column 2: found 'x', expected '#' or '.'"),
        (b"P3\n", "PBM: expected P1 or P4 at the start"),
        (
            b"1,7",
            "CSV: line 1, column 2: found \"7\", expected 0 or 1",
        ),
        (
            b"\x93NUMPY\x01",
            "NPY: no header of a numpy array, version 1 to 3",
        ),
    ] {
        assert_eq!(told(bytes), Err(message.to_owned()));
    }
}

#[test]
fn endings_tell_the_form() {
    assert_eq!(ImprintFormat::of_ending("PBM"), Some(ImprintFormat::Pbm));
    assert_eq!(ImprintFormat::of_ending("npy"), Some(ImprintFormat::Npy));
    assert_eq!(ImprintFormat::of_ending("pbm-plain"), None);
    assert_eq!(ImprintFormat::of_ending("svg"), None);
}
