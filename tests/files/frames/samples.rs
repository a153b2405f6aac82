//! The same three made-up frames in every format of recordings.

use std::path::Path;

use taxel_core::frame::{Processing, Rule};
use taxel_files::formats::recording::ReadOptions;

use super::{Recorded, channel_shape, frame_size, recorded, recorded_with};
use crate::array::array;

/// The imprints at a threshold of 9.
const IMPRINTS: [&str; 3] = [
    ".....\n..#..\n..#..\n.....",
    ".....\n..#..\n.###.\n.....",
    ".....\n..#..\n.##..\n.....",
];

pub(crate) fn sample(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files/frames/samples");
    std::fs::read(folder.join(name)).expect(name)
}

/// Returns the imprints of a channel.
fn imprints(found: &Recorded, channel: usize, threshold: f64) -> Vec<String> {
    let mut processing = Processing::default();
    processing.rule = Some(Rule::at_least(threshold).expect("a number"));
    let frames = found.frames.iter().filter(|frame| frame.channel == channel);
    let imprint = |frame| processing.run(frame).expect("it fits").imprint;
    frames
        .map(imprint)
        .map(|imprint| imprint.expect("a rule").to_string())
        .collect()
}

/// The name, the format, whether rows and columns must be given, and the time of the second frame.
const SAMPLES: [(&str, &str, bool, Option<f64>); 14] = [
    ("tekscan.asf", "tekscan", false, Some(0.05)),
    ("tekscan_spreadsheet.csv", "tekscan", false, Some(0.05)),
    ("frames.jsonl", "jsonl", false, Some(0.25)),
    ("named.csv", "csv", false, Some(0.25)),
    ("semicolons.csv", "csv", false, Some(0.25)),
    ("plain.csv", "csv", true, Some(0.25)),
    ("rows.txt", "csv", false, None),
    ("echo.txt", "ros2", true, None),
    ("echo.yaml", "ros2", false, None),
    ("u2.npy", "npy", false, None),
    ("f8_big_fortran.npy", "npy", false, None),
    ("records.npy", "npy", false, Some(0.25)),
    ("touch.npz", "npz", false, Some(0.25)),
    ("xsensor.csv", "xsensor", false, Some(0.4)),
];

/// Reads a sample, or a part of one, with the flags that it needs.
fn read_sample(name: &str, bytes: &[u8], named: bool) -> Recorded {
    let mut options = ReadOptions {
        size: named.then(|| frame_size(4, 5)),
        ..ReadOptions::default()
    };
    // Behind the cells are a number and milliseconds.
    if name == "plain.csv" {
        options.label_column = "21".parse().ok();
        options.time_column = "22:ms".parse().ok();
    }
    recorded_with(bytes, &options)
}

#[test]
fn every_format_gives_the_same_imprints() {
    for (name, form, named, time) in SAMPLES {
        let bytes = sample(name);
        let found = read_sample(name, &bytes, named);
        assert!(found.error.is_none(), "{name}: {:?}", found.error);
        assert_eq!(
            (found.format, &found.notes[..]),
            (Some(form), &[][..]),
            "{name}"
        );
        assert_eq!(imprints(&found, 0, 9.0), IMPRINTS, "{name}");
        let second = found.frames.iter().find(|frame| frame.number == 1);
        assert_eq!(second.expect(name).time, time, "{name}");
        if named {
            let error = recorded(&bytes, None).error.expect(name).to_string();
            assert!(error.contains("rows and columns"), "{name}: {error}");
        }
    }
}

#[test]
fn sensors_of_xsensor_are_channels_but_groups_are_not() {
    let found = recorded(&sample("xsensor.csv"), None);
    assert_eq!(found.channels.len(), 2);
    assert_eq!(imprints(&found, 1, 18.0), IMPRINTS);
    let info = &found.channels[1];
    assert_eq!(info.name.as_deref(), Some("right"));
    assert_eq!(
        (info.threshold, info.pitch_mm),
        (Some(10.0), Some([2.5, 3.0]))
    );
    // From 29 February, 23:59:59.4, to the next day.
    assert_eq!(found.frames[4].time, Some(1.2));
    assert_eq!(found.frames[4].label, Some(102.into()));
}

#[test]
fn the_first_rows_are_used_and_comments_are_not_frames() {
    let found = recorded(&sample("tekscan.asf"), None);
    assert_eq!(channel_shape(&found.channels[0]), Some((4, 5)));
    assert_eq!(found.channels[0].pitch_mm, Some([2.5, 2.5]));
    assert_eq!(found.frames.len(), 3);
    assert_eq!(
        found.frames[0]
            .values()
            .iter()
            .filter(|value| !value.is_nan())
            .count(),
        18
    );
}

/// Checks that the frames before the damage are read, and that the damage is reported with its place.
fn damaged(name: &str, from: &str, to: &str, frames: usize, message: &str) {
    let text = String::from_utf8(sample(name)).expect("a text");
    assert!(text.contains(from), "{name} has {from:?}");
    let found = recorded(text.replacen(from, to, 1).as_bytes(), None);
    assert_eq!(found.frames.len(), frames, "{name}: {:?}", found.error);
    let error = found.error.map(|error| error.to_string());
    assert_eq!(error.as_deref(), Some(message), "{name}");
}

#[test]
fn damage_is_reported_with_its_place_after_the_frames_before_it() {
    damaged(
        "tekscan.asf",
        "0,5,14,2,0",
        "0,5,x,2,0",
        1,
        "line 26, column 3: found \"x\", expected a number",
    );
    damaged(
        "tekscan.asf",
        "0,5,14,2,0",
        "0,5,14,2",
        1,
        "line 26: found 4 values, expected 5",
    );
    damaged(
        "tekscan.asf",
        "0,5,14,2,0",
        "0,5,14,2,0,1",
        1,
        "line 26: found 6 values, expected 5",
    );
    damaged(
        "tekscan.asf",
        "0,5,14,2,0\r\n",
        "\r\n",
        1,
        "line 26: the frame ends here, expected 4 rows",
    );
    damaged(
        "tekscan.asf",
        "ASCII_DATA @@",
        "ASCII @@",
        0,
        "the header has no end, expected a line 'ASCII_DATA @@'",
    );
    damaged(
        "xsensor.csv",
        "0,11,20,9,0",
        "0,11,20",
        2,
        "line 103: found 3 values, expected 5",
    );
    damaged(
        "frames.jsonl",
        "[0, 5, 14, 2, 0]",
        "[0, 5, 14, 2]",
        1,
        "line 2: row 2 has 4 values, expected 5",
    );
    damaged(
        "named.csv",
        "8,250,",
        "8,250,0,",
        1,
        "line 3: found 23 values, expected 22",
    );
    damaged(
        "rows.txt",
        "0 11 20 9 0 \r\n",
        "",
        1,
        "line 9: the frame ends after 3 rows, expected 4",
    );
}

#[test]
fn the_whole_frames_of_a_truncated_recording_are_read() {
    for (name, _, named, _) in SAMPLES {
        // An archive has its list of contents at the end; a recording of taxel may end anywhere.
        if ["touch.npz", "records.npy", "f8_big_fortran.npy"].contains(&name) {
            continue;
        }
        let whole = sample(name);
        let cut = read_sample(name, &whole[..whole.len() - 9], named);
        assert!(cut.frames.len() >= 2, "{name}: {:?}", cut.error);
        // In these files only lines after the last frame were cut off.
        let harmless = ["xsensor.csv", "tekscan_spreadsheet.csv"].contains(&name);
        assert_eq!(cut.error.is_none(), harmless, "{name}");
    }
}

#[test]
fn a_sensor_block_without_cells_is_reported_as_damage() {
    let text = String::from_utf8(sample("xsensor.csv")).expect("a text");
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let begins = |line: &&str| line.starts_with("SENSOR,right");
    let cells = |line: &&str| line.starts_with("SENSELS");
    let sensor = lines.iter().position(begins).expect("two sensors");
    let last = sensor + lines[sensor..].iter().position(cells).expect("cells");
    // The line before a block is not part of it.
    assert!(
        recorded(lines[..sensor].concat().as_bytes(), None)
            .error
            .is_none()
    );
    for end in sensor + 1..=last {
        let cut = recorded(lines[..end].concat().as_bytes(), None);
        assert_eq!(cut.frames.len(), 1);
        let error = cut.error.map(|error| error.to_string());
        let expected = format!(
            "line {}: ends inside a SENSOR block, expected SENSELS",
            end + 1
        );
        assert_eq!(error, Some(expected));
    }
}

#[test]
fn more_records_than_the_header_counts_are_read_except_a_torn_one() {
    let mut records = sample("records.npy");
    assert_eq!(recorded(&records, None).frames.len(), 3);
    records.pop();
    let torn = recorded(&records, None);
    assert_eq!((torn.frames.len(), torn.error.is_none()), (2, true));
}

#[test]
fn a_table_of_words_is_not_a_recording() {
    for text in [
        "YEAR: 2023\nHOLDER: somebody",
        "a, b\nc, d\n",
        "",
        "{}",
        "[1",
    ] {
        assert!(recorded(text.as_bytes(), None).error.is_some(), "{text}");
    }
}

#[test]
fn topics_and_their_sensors_are_channels() {
    let bytes = sample("topics.mcap");
    let found = recorded(&bytes, Some((4, 5)));
    assert!(found.error.is_none(), "{:?}", found.error);
    // The same topics in compressed chunks, as the usual writers make them.
    for packed in ["topics_lz4.mcap", "topics_zstd.mcap"] {
        let packed = recorded(&sample(packed), Some((4, 5)));
        assert!(packed.error.is_none(), "{:?}", packed.error);
        assert_eq!(packed.channels, found.channels);
        let values = |found: &Recorded| {
            let frames = found.frames.iter();
            let bits = frames.map(|frame| {
                frame
                    .values()
                    .iter()
                    .map(|value| value.to_bits())
                    .collect::<Vec<_>>()
            });
            bits.collect::<Vec<_>>()
        };
        assert_eq!(values(&packed), values(&found));
    }
    let names: Vec<_> = found
        .channels
        .iter()
        .filter_map(|info| info.name.as_deref())
        .collect();
    assert_eq!(names, ["/pad", "/state#pad", "/state#tip", "/image"]);
    for channel in [0, 1, 3] {
        assert_eq!(
            imprints(&found, channel, 9.0),
            IMPRINTS,
            "{}",
            names[channel]
        );
    }
    // Three values do not show how they are arranged.
    assert_eq!(
        (channel_shape(&found.channels[2]), found.channels[2].values),
        (None, Some(3))
    );
    let last = found.frames.last().expect("frames");
    assert_eq!((last.number, last.time), (2, Some(0.5)));
    // The times of the log count from 1970.
    let starts = found.channels.iter().map(|info| info.start.as_deref());
    assert!(starts.eq([Some("2001-09-09T01:46:40Z"); 4]));
    // A file that was not closed: whole messages, then the error.
    let open = recorded(&bytes[..bytes.len() - 80], Some((4, 5)));
    assert!(open.error.is_some() && open.frames.len() >= 11);
    // A file that ends inside its footer or the magic after it was not closed, either.
    for missing in 1..=8 + 20 + 9 {
        let open = recorded(&bytes[..bytes.len() - missing], Some((4, 5)));
        assert_eq!(open.frames.len(), found.frames.len(), "{missing}");
        let message = open.error.map(|error| error.to_string());
        let expected = "the file ends without a footer: it was not closed";
        assert_eq!(message.as_deref(), Some(expected), "{missing}");
    }
    for name in ["topics_lz4.mcap", "topics_zstd.mcap"] {
        let packed = sample(name);
        let open = recorded(&packed[..packed.len() * 2 / 3], Some((4, 5)));
        assert!(open.error.is_some(), "{name}");
        let mut broken = packed.clone();
        for byte in &mut broken[400..440] {
            *byte ^= 0x55;
        }
        assert!(recorded(&broken, Some((4, 5))).error.is_some(), "{name}");
    }
    // A schema of 99 bytes in a chunk of 19, with more bytes after it; and in a file that ends there.
    let record = |kind: u8, length: u64, content: &[u8]| {
        [&[kind][..], &length.to_le_bytes(), content].concat()
    };
    let schema = record(3, 99, &[0; 10]);
    let head = [&[0; 32][..], &(schema.len() as u64).to_le_bytes()].concat();
    let chunk = [head, schema].concat();
    let chunk = record(6, chunk.len() as u64, &chunk);
    for (behind, expected) in [
        (500, "a record reaches beyond its chunk"),
        (0, "the file ends without a footer: it was not closed"),
    ] {
        let whole = chunk.len() - usize::from(behind == 0);
        let file = [&bytes[..8], &chunk[..whole], &vec![0; behind]].concat();
        let error = recorded(&file, None).error.map(|error| error.to_string());
        assert_eq!(error.as_deref(), Some(expected));
    }
}

#[test]
fn an_axis_for_a_single_channel_is_not_the_axis_of_frames() {
    let cells: Vec<f64> = (0..12).map(f64::from).collect();
    for shape in ["(2, 2, 3)", "(2, 2, 3, 1)", "(2, 1, 2, 3)"] {
        let found = recorded(&array(shape, false, &cells), None);
        assert_eq!(channel_shape(&found.channels[0]), Some((2, 3)), "{shape}");
        assert_eq!(found.frames[1].values(), &cells[6..], "{shape}");
    }
    let fortran = recorded(&array("(2, 1, 2, 3)", true, &cells), None);
    assert_eq!(fortran.frames[1].values(), [1.0, 5.0, 9.0, 3.0, 7.0, 11.0]);
    assert!(
        recorded(&array("(2, 2, 1, 3)", false, &cells), None)
            .error
            .is_some()
    );
}
