//! Errors that the fuzz targets found, or that were found while the targets were written.

use std::io::Cursor;

use taxel_core::atlas::features;
use taxel_core::pose::DecimalRange;
use taxel_files::formats::atlas::read as read_atlas;
use taxel_files::formats::read_model;

use super::bodies::{body, session_of, with_spread};
use super::malice;
use super::malice::frames::{mcap, topic};

/// With a form that shows a smaller sensor, the cursor was beside the sensor, and the coverage of another taxel was
/// shown.
#[test]
fn the_cursor_is_on_the_sensor_that_a_form_shows() {
    body("session")(&[0, 0, 0x07, b'S', b'1']);
    let session = session_of("f<Enter>S8<Tab>8");
    assert_eq!(session.app().cursor(), (7, 7));
    let accepted = session_of("f<Enter>S8<Tab>8<Enter>");
    assert!(accepted.screen().contains("column 7, row 7"));
}

/// A form shows a figure that covers no taxel by half. Without the form, the region that was chosen before is there
/// again.
#[test]
fn a_chosen_region_is_kept_while_a_form_shows_no_region() {
    let form = "<Space><Right><Right><Space><Tab>f<Tab><C-u>0.1<Tab><C-u>0.1";
    let session = session_of(form);
    let app = session.app();
    assert!(app.reading().regions.is_empty() && app.chosen().is_some());
    let session = session_of(&format!("{form}<Esc>"));
    let app = session.app();
    assert!(app.chosen().is_some() && app.reading().region(app.chosen()).is_some());
    body("session")(b"\0\0 \x01\x01 \x0cf\x0c\x930.1\x0c\x930.1");
}

/// Two decimals of 16 digits can be the same `f64`: such ranges were accepted, and written as another range.
#[test]
fn ranges_read_back_unchanged() {
    for text in ["9007.199254740991", "1:1.5:7", "1.0:2.55:1", "-0:0.10:0.05"] {
        body("range")(text.as_bytes());
    }
    let read = |text: &str| text.parse::<DecimalRange>();
    assert!(read("9007.199254740991").is_err());
    assert_eq!(read("1:1.5:7"), read("1"));
    assert_eq!(read("1.0:2.55:1"), read("1:2:1"));
}

/// A turn in the sums of an archive has a count of equal turns; these were added one by one.
#[test]
fn a_turn_that_counts_for_many_is_added_at_once() {
    let archive = with_spread(1, |words| {
        let turn = words.split_off(3 * features().len());
        assert_eq!(turn.len(), 3 + 5 * features().len(), "one is open");
        for number in 0..5000 {
            words.extend([number, turn[1], 1_000_000]);
            words.extend(&turn[3..]);
        }
    });
    body("archive")(&archive);
}

/// Sums in which directions cancel at each angle, but not all together, gave an infinite deviation.
#[test]
fn directions_that_contradict_each_other_have_a_finite_deviation() {
    let archive = with_spread(2, |words| {
        words.truncate(3 * features().len());
        words.fill(0);
    });
    body("archive")(&archive);
}

/// A mebibyte of compressed arrays could unpack to a gibibyte in memory.
#[test]
fn compressed_arrays_of_an_archive_are_refused() {
    let message =
        "array \"rows\" is compressed, expected one as taxel writes it, without compression";
    let what = "rows that unpack to much";
    let atlas = read_atlas(Cursor::new(malice::of("archive", what)));
    assert_eq!(atlas.expect_err("it is compressed").to_string(), message);
    let model = read_model(Cursor::new(malice::of("model", what)));
    assert_eq!(model.expect_err("it is compressed").to_string(), message);
}

/// Found by the fuzzer: a quoted word grows if each of its characters is escaped.
#[test]
fn unknown_words_are_quoted_briefly() {
    body("command")(&[&b"x"[..], &[0x1e; 200]].concat());
    body("play")(&[&b"Set "[..], &[0x05; 200]].concat());
    body("play")(&[&b"Set ascii "[..], &[0x05; 200]].concat());
}

/// The format of a stream was determined from all bytes so far, so it depended on how the stream was split.
#[test]
fn the_format_of_a_stream_does_not_depend_on_its_pieces() {
    // Rows and columns are known, and the first piece has 304 bytes.
    let begin = [38];
    let frame: Vec<u8> = [0xaa, 0x55].into_iter().chain([0; 20]).collect();
    body("stream")(&[&begin[..], &[0; 304], &frame.repeat(4)].concat());
    let objects = "{\"frame\":[[1]]}\n".repeat(9);
    body("stream")(
        &[
            &begin[..],
            "1 2\n".repeat(76).as_bytes(),
            objects.as_bytes(),
        ]
        .concat(),
    );
    // A line ends in another piece than it begins in.
    body("stream")(include_bytes!("found/format_between_line_ends"));
    body("stream")(include_bytes!("found/format_among_line_ends"));
}

/// The size of a number was computed before its code was found to be unknown.
#[test]
fn a_type_code_whose_size_is_no_digit_is_refused() {
    body("exchange")(include_bytes!("found/npy_size_below_0"));
}

/// A compressed name of sixteen megabytes takes a few kilobytes: 65,536 topics used up all memory.
#[test]
fn a_long_topic_name_is_refused() {
    let file = [mcap(), topic(1, &"a".repeat(1025))].concat();
    let found = crate::frames::recorded(&file, None);
    let message = found.error.expect("the name is long").to_string();
    assert_eq!(message, "a name of 1025 bytes, expected 1024 at most");
}
