//! Streams in pieces of any size, intact and damaged: every whole frame is found, and no false one.

use std::io::BufReader;
use std::ops::ControlFlow;

use taxel_core::frame::Frame;
use taxel_files::ReadErrorKind;
use taxel_files::formats::recording::{
    ChannelInfo, Format, ReadOptions, RecordingEvent, StreamCounts, StreamReader,
};

use super::samples::sample;
use super::{frame_size, recorded};
use crate::common::Random;

/// Returns the values of all frames, read in pieces of a random size.
fn decoded(
    options: &ReadOptions,
    bytes: &[u8],
    random: &mut Random,
) -> (Vec<Vec<f64>>, StreamCounts) {
    let (mut frames, mut counts) = (Vec::new(), StreamCounts::default());
    let longest = [1, 40, 2000][usize::from(random.side(0, 2))];
    let length = usize::try_from(random.whole(1, longest)).expect("above 0");
    let mut pieces = BufReader::with_capacity(length, bytes);
    let read = StreamReader::new(options).read(&mut pieces, &mut |event| {
        counts.note(&event);
        if let RecordingEvent::Frame(frame) = event {
            assert_eq!(frame.number, frames.len() as u64);
            frames.push(frame.values().to_vec());
        }
        ControlFlow::Continue(())
    });
    read.expect("a stream");
    (frames, counts)
}

fn options(shape: Option<(u16, u16)>) -> ReadOptions {
    let size = shape.map(|(rows, columns)| frame_size(rows, columns));
    ReadOptions {
        size,
        ..ReadOptions::default()
    }
}

/// Options for a stream of this format.
fn of_format(name: &str, shape: (u16, u16)) -> ReadOptions {
    ReadOptions {
        format: Some(Format::of_stream(name).expect("a format")),
        ..options(Some(shape))
    }
}

/// The events of a stream whose bytes come one by one, in short.
fn said(reader: &mut StreamReader, bytes: &[u8]) -> String {
    let mut said = String::new();
    let mut pieces = BufReader::with_capacity(1, bytes);
    let read = reader.read(&mut pieces, &mut |event| {
        match event {
            RecordingEvent::Frame(frame) => said += &format!("f{} ", frame.values()[0]),
            RecordingEvent::Damage { .. } => said += "d ",
            _ => {}
        }
        ControlFlow::Continue(())
    });
    read.expect("a stream");
    said
}

fn text(frame: &[f64], columns: usize, separator: &str) -> String {
    let rows = frame.chunks(columns).map(|row| {
        let values: Vec<String> = row.iter().map(ToString::to_string).collect();
        values.join(separator)
    });
    rows.collect::<Vec<_>>().join("\r\n")
}

/// Returns frames of bytes; some contain a marker.
fn made_up(count: usize, cells: usize, random: &mut Random) -> Vec<Vec<f64>> {
    let mut frames = Vec::new();
    for _ in 0..count {
        let mut frame: Vec<f64> = (0..cells).map(|_| f64::from(random.side(0, 254))).collect();
        let at = usize::try_from(random.whole(0, 200)).expect("above 0");
        (frame[at], frame[at + 1]) = (170.0, 85.0);
        frames.push(frame);
    }
    frames
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "bytes"
)]
fn bytes(frame: &[f64]) -> Vec<u8> {
    frame.iter().map(|&value| value as u8).collect()
}

#[test]
fn every_kind_of_stream_is_recognised_and_decoded_completely() {
    let mut random = Random::new(61);
    let frames = made_up(9, 256, &mut random);
    let shape = Some((16, 16));
    let joined =
        |of: &dyn Fn(&Vec<f64>) -> Vec<u8>| frames.iter().flat_map(of).collect::<Vec<u8>>();
    let list = |frame: &[f64]| text(frame, 256, ", ");
    let json = |frame: &[f64]| {
        let rows = frame
            .chunks(16)
            .map(|row| format!("[{}]", text(row, 16, ",")));
        format!("{{\"frame\":[{}]}}\n", rows.collect::<Vec<_>>().join(","))
    };
    let escaped = |frame: &Vec<f64>| {
        let mut stream = vec![0x5b];
        for byte in bytes(frame) {
            match byte {
                0x5c => stream.extend([0x5c, 0]),
                0x5b => stream.extend([0x5c, 1]),
                0x5d => stream.extend([0x5c, 2]),
                byte => stream.push(byte),
            }
        }
        stream.push(0x5d);
        stream
    };
    for (what, shape, stream) in [
        (
            "rows",
            None,
            joined(&|frame| (text(frame, 16, " ") + " \r\n\r\n").into_bytes()),
        ),
        (
            "rows",
            None,
            joined(&|frame| (text(frame, 16, "\t") + "\n\n").into_bytes()),
        ),
        (
            "lines",
            shape,
            joined(&|frame| (text(frame, 256, ",") + "\n").into_bytes()),
        ),
        ("jsonl", None, joined(&|frame| json(frame).into_bytes())),
        (
            "ros2",
            shape,
            joined(&|frame| format!("array('B', [{}])\n---\n", list(frame)).into_bytes()),
        ),
        (
            "flexitac",
            shape,
            joined(&|frame| [vec![0xaa, 0x55], bytes(frame)].concat()),
        ),
        (
            "matsense",
            shape,
            joined(&|frame| [bytes(frame), vec![0xff]].concat()),
        ),
        ("brackets", shape, joined(&escaped)),
    ] {
        let (found, counts) = decoded(&options(shape), &stream, &mut random);
        assert_eq!(counts.dropped, 0, "{what}: {:?}", counts.sample);
        assert!(found == frames, "{what}: {} frames", found.len());
        // Bytes before the first boundary are dropped, and not counted as a frame.
        let torn = ReadOptions {
            is_joined: true,
            ..options(shape)
        };
        let (found, counts) = decoded(&torn, &stream[5..], &mut random);
        assert!(
            found.len() >= 8 && found == frames[9 - found.len()..],
            "{what}: {}",
            found.len()
        );
        assert!(counts.dropped <= 1, "{what}: {counts:?}");
    }
}

/// Three of forty frames lose, gain or have wrong bytes; markers occur inside of frames.
#[test]
fn in_a_damaged_stream_all_whole_frames_and_no_false_ones_are_found() {
    for seed in 0..40 {
        let mut random = Random::new(700 + seed);
        let frames = made_up(40, 256, &mut random);
        let (mut stream, mut whole) = (Vec::new(), Vec::new());
        for (index, frame) in frames.iter().enumerate() {
            let mut own = [vec![0xaa, 0x55], bytes(frame)].concat();
            let at = 3 + usize::from(random.side(0, 200));
            match index {
                5 => drop(own.drain(at..at + 1 + usize::from(random.side(0, 30)))),
                17 => drop(own.splice(at..at, vec![7; 1 + usize::from(random.side(0, 90))])),
                29 => own.truncate(at),
                _ => whole.push(frame.clone()),
            }
            stream.extend(own);
        }
        let given = of_format("flexitac", (16, 16));
        let (found, counts) = decoded(&given, &stream, &mut random);
        assert_eq!((whole.len(), found.len()), (37, 37), "seed {seed}");
        assert!(found == whole, "seed {seed}: a false frame");
        assert_eq!(counts.dropped, 3, "seed {seed}");
        // There are so many markers in the stream that choosing the first confirmed one would read frames from their
        // middle.
        assert!(
            stream
                .windows(2)
                .filter(|pair| *pair == [0xaa, 0x55])
                .count()
                > 70
        );
    }
}

/// Two cells that look like a marker in all frames are distinguished from the marker by the start of the stream, even
/// if its first frame has lost a byte.
#[test]
fn cells_that_look_like_a_marker_do_not_confuse_a_stream_read_from_its_start() {
    for false_marker in 0..14 {
        let frame = |number: u8| {
            let mut cells = vec![number; 16];
            cells[false_marker..false_marker + 2].copy_from_slice(&[0xaa, 0x55]);
            [vec![0xaa, 0x55], cells].concat()
        };
        for lost in [None].into_iter().chain((2..18).map(Some)) {
            let mut stream: Vec<u8> = (1..=20).flat_map(frame).collect();
            lost.map(|lost| stream.remove(lost));
            let given = of_format("flexitac", (4, 4));
            let (found, counts) = decoded(&given, &stream, &mut Random::new(7));
            let first = if lost.is_some() { 2 } else { 1 };
            let wanted: Vec<Vec<f64>> = (first..=20)
                .map(|number| frame(number)[2..].iter().copied().map(f64::from).collect())
                .collect();
            assert!(found == wanted, "{false_marker} {lost:?}: {found:?}");
            assert_eq!(counts.dropped, u64::from(first) - 1);
        }
    }
}

/// A frame is complete when the marker after it has come.
#[test]
fn a_frame_without_a_marker_after_it_is_none() {
    let mut reader = StreamReader::new(&of_format("flexitac", (1, 3)));
    let bytes = [
        0xaa, 0x55, 1, 2, 3, 0xaa, 0x55, 4, 5, 6, 0xaa, 0x55, 7, 8, 9, 9, 0xaa, 0x55,
    ];
    assert_eq!(said(&mut reader, &bytes), "f1 f4 d ");
}

#[test]
fn a_line_that_is_too_long_is_dropped_and_the_next_one_is_read() {
    // Spaces are no values.
    let text = [b"1 2\n", &vec![b' '; 9 << 20][..], b"3 4\n5 6\n"].concat();
    let (found, counts) = decoded(&of_format("lines", (1, 2)), &text, &mut Random::new(1));
    assert_eq!(counts.dropped, 1);
    assert_eq!(found, [[1.0, 2.0], [5.0, 6.0]]);
}

#[test]
fn torn_short_long_and_garbled_frames_are_counted_and_never_joined() {
    let lines = "9 9\n9 9\n\n1 2\n3 4\n\n1 2\n3\n\n1 2\n3 x\n\n1 2\n3 4\n5 6\n\n5 6\n7 8\n\n1 2\n3";
    let (found, counts) = decoded(&options(None), lines.as_bytes(), &mut Random::new(1));
    assert_eq!(
        found,
        [[9.0; 4], [1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]]
    );
    assert_eq!((counts.dropped, counts.sample.as_deref()), (4, Some("3")));
    let wide = "1,2,3,4\n1,2,3\n1,2,3,4,5\n1,2,?,4\n5,6,7,8\n5,6,7,";
    let (found, counts) = decoded(&options(Some((2, 2))), wide.as_bytes(), &mut Random::new(2));
    assert_eq!(found, [[1.0, 2.0, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]]);
    assert_eq!(counts.dropped, 4, "{counts:?}");
    let json = b"{\"frame\":[[1]]}\n{\"frame\":[[1],[2,3]]}\nnonsense\n{\"frame\":[[2]]}";
    let (found, counts) = decoded(&options(None), json, &mut Random::new(3));
    assert_eq!((found, counts.dropped), (vec![vec![1.0], vec![2.0]], 2));
    // The end of a message is missing, so two arrays are in one.
    let ros = [1, 2, 3, 4].map(|value| format!("array('H', [{value}, 0])\n---\n"));
    let ros = ros.concat().replace("[2, 0])\n---\n", "[2, 0])\n");
    for shape in [(1, 2), (1, 4)] {
        let given = of_format("ros2", shape);
        let (found, counts) = decoded(&given, ros.as_bytes(), &mut Random::new(3));
        let expected = if shape == (1, 2) { 2 } else { 0 };
        assert_eq!(
            (found.len(), counts.dropped),
            (expected, 3 - expected as u64)
        );
    }
    let ended = [
        &[1, 2, 3, 4, 255][..],
        &[1, 2, 3, 255],
        &[1, 2, 3, 4, 5, 255],
        &[5, 6, 7, 8, 255],
    ]
    .concat();
    let (found, counts) = decoded(
        &of_format("matsense", (2, 2)),
        &[&ended[..], &ended, &[9, 9, 9, 9, 255]].concat(),
        &mut Random::new(4),
    );
    assert_eq!((found.len(), counts.dropped), (5, 4));
}

/// 3D-ViTac sends 16 lines of 16 numbers, and an empty line; another board a frame of 256 numbers a line, and a third
/// one a word before each frame.
#[test]
fn lines_are_frames_or_rows_without_flags() {
    let row = |value: usize| format!("{}\r\n", format!("{value} ").repeat(16).trim_end());
    let block = |value| row(value).repeat(16) + "\r\n";
    let wide = |value: usize| format!("{}\n", format!("{value}\t").repeat(256));
    let word = |value| format!("frame\r\n{}", row(value).repeat(16));
    let rest = row(7).repeat(5);
    let blocks: [String; 3] = [1, 2, 3].map(block);
    let words: [String; 4] = [1, 2, 3, 4].map(word);
    for (text, is_joined, expected, dropped) in [
        (blocks.concat(), false, &[1.0, 2.0, 3.0][..], 0),
        // What precedes the first end of a frame is not counted if the stream was joined there.
        (
            format!("{rest}\r\n{}", blocks.concat()),
            true,
            &[1.0, 2.0, 3.0],
            0,
        ),
        (
            format!("{rest}\r\n{}", blocks.concat()),
            false,
            &[1.0, 2.0, 3.0],
            1,
        ),
        ([1, 2, 3].map(wide).concat(), false, &[1.0, 2.0, 3.0], 0),
        ([1, 2, 3].map(wide).concat(), true, &[2.0, 3.0], 0),
        (words.concat(), false, &[1.0, 2.0, 3.0, 4.0], 0),
        (
            format!("boot v1\r\n{}", words.concat()),
            false,
            &[1.0, 2.0, 3.0, 4.0],
            0,
        ),
    ] {
        let given = ReadOptions {
            is_joined,
            ..options(None)
        };
        let (found, counts) = decoded(&given, text.as_bytes(), &mut Random::new(9));
        let firsts: Vec<f64> = found.iter().map(|frame| frame[0]).collect();
        assert_eq!(
            (&firsts[..], counts.dropped),
            (expected, dropped),
            "{text:.60}"
        );
        assert!(found.iter().all(|frame| frame.len() == 256));
    }
}

#[test]
fn after_an_interruption_the_torn_frame_is_dropped_and_the_rest_goes_on() {
    let times = |before: &str, after: &str| {
        let mut reader = StreamReader::new(&ReadOptions::default());
        let mut found = Vec::new();
        for text in [before, after] {
            let read = reader.read(&mut text.as_bytes(), &mut |event| {
                if let RecordingEvent::Frame(frame) = event {
                    found.push((frame.number, frame.time.expect("a time"), frame.values()[0]));
                }
                ControlFlow::Continue(())
            });
            read.expect("a stream");
        }
        found
    };
    let table = "t_ms,s0,s1,s2,s3\n1000,1,2,3,4\n1500,2,3,4,5\n";
    let expected = [(0, 0.0, 1.0), (1, 0.5, 2.0), (2, 8.0, 4.0)];
    // The header does not come again.
    assert_eq!(times(table, "0,3,4\n9000,4,5,6,7\n"), expected);
    let other = "torn\ns0,s1,s2,s3,time_us\n4,5,6,7,9000000\n";
    assert_eq!(times(table, other), expected);
    let clock = times(
        "23:59:59.5 -> 1 2 3 4 5 6 7 8 9\n",
        "9\n00:00:01 -> 2 2 3 4 5 6 7 8 9\n",
    );
    assert_eq!(clock, [(0, 0.0, 1.0), (1, 1.5, 2.0)]);
}

/// Frames of two sensors of different sizes in turn. For each frame the channel, number, time and sum are checked, and
/// the names of the channels.
#[test]
fn channels_of_json_lines_are_distinguished_in_files_and_streams() {
    let line = |time: u32, channel: &str, frame: &str| {
        format!("{{\"t\":{time},\"channel\":{channel},\"frame\":{frame}}}\n")
    };
    let (left, right) = ("[[1,2],[3,4]]", "[[5,6,7]]");
    let lines: String = (10..13)
        .map(|time| line(time, "\"l\"", left) + &line(time, "7", right))
        .collect();
    let of = |time: f64, number| [(0, number, Some(time), 10.0), (1, number, Some(time), 18.0)];
    let expected = [of(0.0, 0), of(1.0, 1), of(2.0, 2)].concat();
    let of = |frame: &Frame| {
        let sum = frame.values().iter().sum::<f64>();
        (frame.channel, frame.number, frame.time, sum)
    };
    let read = recorded(lines.as_bytes(), None);
    assert!(read.error.is_none());
    let names: Vec<_> = read.channels.iter().map(ChannelInfo::shown_name).collect();
    assert_eq!(names, ["l", "7"]);
    assert_eq!(read.frames.iter().map(of).collect::<Vec<_>>(), expected);

    let (mut names, mut frames) = (Vec::new(), Vec::new());
    let mut sink = |event: RecordingEvent<'_>| {
        match event {
            RecordingEvent::Channel(info) => names.push(info.shown_name().to_owned()),
            RecordingEvent::Frame(frame) => frames.push(of(frame)),
            _ => {}
        }
        ControlFlow::Continue(())
    };
    let mut reader = StreamReader::new(&options(None));
    // Numbers and channels continue after a gap.
    let after = "torn\n".to_owned() + &line(15, "\"l\"", left);
    for text in [&lines, &after] {
        reader
            .read(&mut text.as_bytes(), &mut sink)
            .expect("a stream");
    }
    assert_eq!(names, ["l", "7"]);
    assert_eq!(
        (&frames[..6], frames[6]),
        (&expected[..], (0, 3, Some(5.0), 10.0))
    );
    assert_eq!(frames.len(), 7);
    for wrong in ["[]", "\"\"", "1.5"] {
        let read = recorded(line(0, wrong, left).as_bytes(), None);
        let error = read.error.map(|error| error.to_string());
        assert!(
            error.is_some_and(|error| error.contains("\"channel\"")),
            "{wrong}"
        );
    }
}

#[test]
fn a_stream_without_rows_and_columns_is_refused() {
    let refused = |bytes: &[u8]| {
        let mut reader = StreamReader::new(&options(None));
        let read = reader.read(&mut &bytes[..], &mut |_| ControlFlow::Continue(()));
        let error = read.expect_err("refused");
        (error.kind, error.message)
    };
    for bytes in [
        "1 2 3\n4 5 6\n".as_bytes(),
        b"array('B', [1, 2])\n---\n",
        // In a stream without empty lines, this is known as soon as there are more rows than a sensor has.
        "1 2 3\n".repeat(513).as_bytes(),
    ] {
        assert_eq!(refused(bytes).0, ReadErrorKind::Unsized);
    }
    let (kind, message) = refused(b"array('B', [1, 2, '...'])\n---\n");
    assert_eq!(kind, ReadErrorKind::Invalid);
    assert!(message.contains("--full-length"), "{message}");
    assert_eq!(refused(&[0xff; 200]).0, ReadErrorKind::Unsized);
    assert_eq!(refused(b"hello\nworld\n").0, ReadErrorKind::UnknownFormat);
    let (_, message) = refused(b"\x93NUMPY\x01\x00");
    assert!(
        message.starts_with("a recording (npy), not a stream"),
        "{message}"
    );
}

#[test]
fn samples_of_boards_are_decoded() {
    for (name, shape) in [("flexitac.bin", Some((4, 5))), ("rows.txt", None)] {
        let (found, counts) = decoded(&options(shape), &sample(name), &mut Random::new(7));
        assert_eq!((found.len(), counts.dropped), (3, 0), "{name}");
    }
}
