//! Tables as various programs write them.

use taxel_core::frame::{Frame, Label};
use taxel_files::ReadErrorKind;
use taxel_files::formats::recording::ReadOptions;

use super::{Recorded, channel_shape, frame_size, recorded, recorded_with};

/// Returns the label, time and values of each frame of a table.
fn frames(text: &str, shape: Option<(u16, u16)>) -> Vec<(Option<Label>, Option<f64>, Vec<f64>)> {
    let found = recorded(text.as_bytes(), shape);
    assert!(found.error.is_none(), "{text}: {:?}", found.error);
    let parts = |frame: &Frame| (frame.label.clone(), frame.time, frame.values().to_vec());
    found.frames.iter().map(parts).collect()
}

fn values(text: &str, shape: Option<(u16, u16)>) -> Vec<Vec<f64>> {
    frames(text, shape)
        .into_iter()
        .map(|frame| frame.2)
        .collect()
}

fn error(found: &Recorded) -> String {
    found.error.as_ref().expect("an error").to_string()
}

/// Reads a table with the values of --time-column and --label-column.
fn with_columns(text: &str, shape: (u16, u16), time: &str, label: &str) -> Recorded {
    let options = ReadOptions {
        size: Some(frame_size(shape.0, shape.1)),
        time_column: time.parse().ok(),
        label_column: label.parse().ok(),
        ..ReadOptions::default()
    };
    recorded_with(text.as_bytes(), &options)
}

/// The names of the channels, their rows and columns, and the values of their first frames.
fn channels(text: &str, shape: Option<(u16, u16)>) -> Vec<(String, (u16, u16), Vec<f64>)> {
    let found = recorded(text.as_bytes(), shape);
    assert!(found.error.is_none(), "{text}: {:?}", found.error);
    let of = |(index, info)| {
        let first = found.frames.iter().find(|frame| frame.channel == index);
        let shape = channel_shape(info).expect("a size");
        let values = first.expect("a frame").values().to_vec();
        (info.shown_name().to_owned(), shape, values)
    };
    found.channels.iter().enumerate().map(of).collect()
}

#[test]
fn fields_are_told_by_the_first_line_with_numbers() {
    let expected = [[1.0, 2.5, 3.0, 4.0], [5.0, 6.0, 7.0, 8.0]];
    for text in [
        "1,2.5,3,4\n5,6,7,8\n",
        "1, 2.5, 3, 4,\r\n5, 6, 7, 8,\r\n",
        "\u{feff}1;2,5;3;4\n5;6;7;8",
        "1\t2,5\t3\t4\n5\t6\t7\t8\n",
        "1\t2.5\t3\t4\t\n5\t6\t7\t8\t\n",
        "  1   2.5 3  4 \n 5 6 7 8\n",
        "# a comment\n1 2.5 3 4\n# another, in 4\n5 6 7 8\n",
        "[1, 2.5, 3, 4]\n[5, 6, 7, 8]\n",
        "[1 2.5 3 4]\n[5 6 7 8]\n",
        "1.000000000000000000e+00 2.500000000000000000e+00 3e0 4.0\n5 6 7 8\n",
        "\"1\",\"2.5\",\"3\",\"4\"\n5,6,7,8\n",
    ] {
        assert_eq!(values(text, Some((2, 2))), expected, "{text}");
    }
    // Printed by numpy.
    let printed = "[[1. 2. 3.]\n [4. 5. 6.]]\n\n[[1. 2. 3.]\n [4. 5. 7.]]\n";
    let found = values(printed, None);
    assert_eq!(found[1], [1.0, 2.0, 3.0, 4.0, 5.0, 7.0]);
}

#[test]
fn a_serial_monitor_puts_times_before_the_fields() {
    let rows = "12:00:01.100 -> 0 9\n12:00:01.100 -> 9 9\n12:00:01.100 -> \n\
                12:00:01.200 -> 0 0\n12:00:01.200 -> 0 9\n12:00:01.200 -> \n";
    for (text, shape) in [
        (rows, None),
        (rows, Some((2, 2))),
        (
            "23:59:59.9 -> 0,9,9,9\n00:00:00.0 -> 0,0,0,9\n",
            Some((2, 2)),
        ),
    ] {
        let expected = [
            (None, Some(0.0), vec![0.0, 9.0, 9.0, 9.0]),
            (None, Some(0.1), vec![0.0, 0.0, 0.0, 9.0]),
        ];
        assert_eq!(frames(text, shape), expected, "{text}");
    }
}

#[test]
fn the_first_line_may_hold_names() {
    let frame = vec![5.0, 6.0, 7.0, 8.0];
    let label = |text: &str| Some(Label::from(text));
    for (text, label, time) in [
        (
            "time_ms,s0,s1,s2,s3\n10,5,6,7,8\n60,5,6,7,8\n",
            None,
            Some(0.05),
        ),
        (
            "s0,s1,s2,s3,t[us]\n5,6,7,8,10\n5,6,7,8,60\n",
            None,
            Some(5e-5),
        ),
        (
            "Time (ms);S0_0;S0_1;S1_0;S1_1\n10,5;5;6;7;8\n60,5;5;6;7;8\n",
            None,
            Some(0.05),
        ),
        (
            "timestamp,s0,s1,s2,s3\n2024-05-01T12:00:00Z,5,6,7,8\n2024-05-01T14:00:00.5+02:00,5,6,7,8\n",
            None,
            Some(0.5),
        ),
        (
            "date,s0,s1,s2,s3\n2024-05-01,5,6,7,8\n2024-05-02,5,6,7,8\n",
            None,
            Some(86_400.0),
        ),
        (
            "label,0,1,2,3\ncup,5,6,7,8\npen,5,6,7,8\n",
            label("pen"),
            None,
        ),
        (
            "Frame,Time,s0,s1,s2,s3\n6,0.5,5,6,7,8\n7,0.75,5,6,7,8\n",
            label("7"),
            Some(0.25),
        ),
        (
            "s0,s1,s2,s3,class\n5,6,7,8,\n5,6,7,8,\"a, b\"\n",
            label("a, b"),
            None,
        ),
        // The index of pandas, and the names of savetxt.
        (",s0,s1,s2,s3\n0,5,6,7,8\n1,5,6,7,8\n", None, None),
        (
            ",time,0,1,2,3\n7,0.5,5,6,7,8\n8,0.75,5,6,7,8\n",
            None,
            Some(0.25),
        ),
        (
            "# time s0 s1 s2 s3\n1 5 6 7 8\n3 5 6 7 8\n",
            None,
            Some(2.0),
        ),
        ("# s0, s1, s2, s3\n5 6 7 8\n5 6 7 8\n", None, None),
        ("0,1,2,3\n5,6,7,8\n5,6,7,8\n", None, None),
        // A date stands beside the time of day, and text is ignored.
        (
            "date,time,note,s0,s1,s2,s3\n2024-05-01,12:00:00,x 1,5,6,7,8\n2024-05-01,12:00:01,y,5,6,7,8\n",
            None,
            Some(1.0),
        ),
    ] {
        assert_eq!(
            frames(text, None)[1],
            (label, time, frame.clone()),
            "{text}"
        );
        assert_eq!(values(text, Some((2, 2))), [&frame[..]; 2], "{text}");
    }
}

#[test]
fn flags_name_the_time_and_the_label() {
    let bare = "7,0,1,2,3,4\n8,50,5,6,7,8\n";
    let named = "no,at,s0,s1,s2,s3\n7,0,1,2,3,4\n8,50,5,6,7,8\n";
    let dated = "7;2024-05-01 12:00:00;1;2;3;4\n8;2024-05-01 12:00:00,05;5;6;7;8\n";
    for (text, time, label) in [
        (bare, "2:ms", "1"),
        (named, "2:ms", "1"),
        (named, "AT:ms", "no"),
        (&dated.replace(",05", ".05"), "2", "1"),
    ] {
        let found = with_columns(text, (2, 2), time, label);
        assert!(found.error.is_none(), "{:?}", found.error);
        let frame = &found.frames[1];
        assert_eq!(
            (frame.time, frame.label.clone()),
            (Some(0.05), Some(8.into())),
            "{text}"
        );
        assert_eq!(frame.values(), [5.0, 6.0, 7.0, 8.0]);
    }
    let text = "cup,1,2,3,4\npen,5,6,7,8\n";
    let found = with_columns(text, (2, 2), "", "1");
    assert_eq!(found.frames[0].label, Some("cup".into()));
    for (time, label, expected) in [
        ("7", "", "line 1: --time-column 7: the table has 6 columns"),
        (
            "",
            "tim",
            "line 1: --label-column tim: no column has this name",
        ),
    ] {
        let found = with_columns(named, (2, 2), time, label);
        assert!(error(&found).starts_with(expected), "{}", error(&found));
    }
}

#[test]
fn cells_are_found_by_the_numbers_in_their_names() {
    let one = |text: &str| channels(text, None)[0].clone();
    let sized =
        |rows, columns, values: &[f64]| ("unnamed".to_owned(), (rows, columns), values.to_vec());
    for (text, expected) in [
        (
            "r0c0,r0c1,r1c0,r1c1\n1,2,3,4\n",
            sized(2, 2, &[1.0, 2.0, 3.0, 4.0]),
        ),
        ("r1c1,r1c2,r1c3\n1,2,3\n", sized(1, 3, &[1.0, 2.0, 3.0])),
        (
            "row_1_col_0,row_1_col_1,row_0_col_0,row_0_col_1\n3,4,1,2\n",
            sized(2, 2, &[1.0, 2.0, 3.0, 4.0]),
        ),
        (
            "\"(0, 0)\",\"(0, 1)\",\"(1, 0)\",\"(1, 1)\"\n1,2,3,4\n",
            sized(2, 2, &[1.0, 2.0, 3.0, 4.0]),
        ),
        (
            "p[0][0],p[0][1],p[0][2]\n1,2,3\n",
            sized(1, 3, &[1.0, 2.0, 3.0]),
        ),
        (
            "ch10,ch2,ch3,ch1\n4,2,3,1\n",
            sized(2, 2, &[1.0, 2.0, 3.0, 4.0]),
        ),
        ("t,S0_0\n0,5\n1,6\n", sized(1, 1, &[5.0])),
    ] {
        assert_eq!(one(text), expected, "{text}");
    }
    let feet = "time_ms,R_ch0,R_ch1,R_ch2,R_ch3,L_ch0,L_ch1,L_ch2,L_ch3\n0,9,0,0,1,0,0,2,8\n";
    let named = |name: &str, values: [f64; 4]| (name.to_owned(), (2, 2), values.to_vec());
    let both = [
        named("R", [9.0, 0.0, 0.0, 1.0]),
        named("L", [0.0, 0.0, 2.0, 8.0]),
    ];
    assert_eq!(channels(feet, None), both);
    assert_eq!(channels(feet, Some((2, 2))), both);
    let all = [sized(4, 2, &[9.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 8.0])];
    assert_eq!(channels(feet, Some((4, 2))), all);
    let axes = "r0c0 fz,r0c0 on,r0c1 fz,r0c1 on,r1c0 fz,r1c0 on,r1c1 fz,r1c1 on\n7,1,0,0,0,0,6,1\n";
    let both = [
        named("fz", [7.0, 0.0, 0.0, 6.0]),
        named("on", [1.0, 0.0, 0.0, 1.0]),
    ];
    assert_eq!(channels(axes, None), both);
    let letters = "A1,A2,A3,A4,B1,B2,B3,B4\n1,2,3,4,5,6,7,8\n";
    let all = [sized(2, 4, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0])];
    assert_eq!(channels(letters, Some((2, 4))), all);
    for (text, expected) in [
        (
            "s0,s1,s1,s2\n1,2,3,4\n",
            "line 1: two columns for one cell: \"s1\" and \"s1\"",
        ),
        (
            "r0c0,r0c1,r1c0\n1,2,3\n",
            "line 1: 3 columns named by row and column, expected one for each cell of 2 × 2",
        ),
        (
            "force,area\n1,2\n",
            "line 1: no three columns have the names of cells",
        ),
    ] {
        let found = recorded(text.as_bytes(), None);
        assert!(error(&found).starts_with(expected), "{}", error(&found));
    }
}

/// What a rule decides is said; it is no warning.
#[test]
fn the_columns_that_are_taken_and_left_out_are_said() {
    let text = "time_ms,x,note,imu1_x,s0,s1,s2,s3\n0,1,a,7,1,2,3,4\n";
    let mut said = Vec::new();
    let options = ReadOptions::default();
    let read = super::read(std::io::Cursor::new(text), &options, &mut |event| {
        if let super::RecordingEvent::Note(note) = event {
            said.push((note.is_plain(), note.to_string()));
        }
        std::ops::ControlFlow::Continue(())
    });
    assert!(read.is_ok(), "{read:?}");
    let expected = [
        (false, "4 numbers a frame, taken as 2 rows of 2 columns"),
        (true, "times: \"time_ms\", in milliseconds"),
        (
            true,
            "cells: in the order of the numbers in their names; a frame a line",
        ),
        (true, "left out: \"x\", \"imu1_x\""),
    ];
    assert_eq!(said, expected.map(|(plain, text)| (plain, text.to_owned())));
}

#[test]
fn without_flags_there_must_be_only_one_way_to_arrange_a_table() {
    let square = "1 2 3\n4 5 6\n7 8 9\n";
    let wide = "1 2 3 4 5 6 7 8 9\n";
    for (text, shape, count) in [
        // As many lines as fields are one frame, n² numbers a line a frame each.
        (square.to_owned(), (3, 3), 1),
        (format!(",0,1,2\n{}", "0,1,2,3\n".repeat(3)), (3, 3), 1),
        (wide.repeat(2), (3, 3), 2),
        (wide.repeat(600), (3, 3), 600),
        // Blocks.
        ("1 2 3\n4 5 6\n\n1 2 3\n4 5 6\n".to_owned(), (2, 3), 2),
        ("1 2 3\n4 5 6\n\n\n1 2 3\n4 5 6\n\n".to_owned(), (2, 3), 2),
        (
            "boot\nmatrix:\n1,2,\n3,4,\nmatrix:\n5,6,\n7,8,\n".to_owned(),
            (2, 2),
            2,
        ),
        (
            "frame 1\n1 2 3\n4 5 6\nframe 2\n1 2 3\n4 5 6\n".to_owned(),
            (2, 3),
            2,
        ),
        (
            "t,s0,s1,s2\n0,1,2,3\n0,4,5,6\n\n1,1,2,3\n1,4,5,6\n".to_owned(),
            (2, 3),
            2,
        ),
    ] {
        let found = recorded(text.as_bytes(), None);
        assert!(found.error.is_none(), "{text}: {:?}", found.error);
        assert_eq!(channel_shape(&found.channels[0]), Some(shape), "{text}");
        assert_eq!(found.frames.len(), count, "{text}");
    }
    for (text, ways) in [
        (
            "1 2 3\n4 5 6\n",
            "--rows 1 --columns 3 for a frame a line, --rows 2 --columns 3 for a row a line",
        ),
        ("1 2 3\n4 5 6\n\n", "--rows 2 --columns 3 for a row a line"),
        ("1,2\n\n3,4\n\n5,6\n\n", "--rows 1 --columns 2"),
        (
            "s0,s1,s2,s3,s4,s5\n1,2,3,4,5,6\n",
            "--rows 2 --columns 3 for a frame a line",
        ),
    ] {
        let found = recorded(text.as_bytes(), None);
        let kind = found.error.as_ref().map(|error| error.kind);
        assert_eq!(kind, Some(ReadErrorKind::Unsized), "{text}");
        assert!(error(&found).contains(ways), "{text}: {}", error(&found));
    }
}

#[test]
fn with_rows_and_columns_a_line_is_a_frame_or_a_row() {
    let both = [
        vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
        vec![7.0, 8.0, 9.0, 1.0, 2.0, 3.0],
    ];
    for text in [
        "1 2 3 4 5 6\n7 8 9 1 2 3\n",
        "1 2 3\n4 5 6\n7 8 9\n1 2 3\n",
        "1 2 3\n4 5 6\n\n7 8 9\n1 2 3\n\n",
        "a,s1,s2,s3\nx,1,2,3\nx,4,5,6\nx,7,8,9\nx,1,2,3\n",
    ] {
        assert_eq!(values(text, Some((2, 3))), both, "{text}");
    }
    for (text, expected) in [
        (
            "1,2,3,4,5,6,7\n",
            "line 1: 7 numbers a line, expected 6 (or 3 for a row): which is the time? --time-column N",
        ),
        (
            "1,2\n3,4\n",
            "line 1: 2 numbers a line, expected 6 (or 3 for a row)",
        ),
        ("2,3\n1,2,3,4,5,6\n", "line 1: 2 numbers a line, expected 6"),
        (
            "rows,2\ncols,3\ntime,s0\n1,2,3,4,5,6\n",
            "line 1: 2 numbers a line, expected 6",
        ),
        (
            "1,2,3,4,5,6\n1,2,3,4,5\n",
            "line 2: found 5 values, expected 6",
        ),
        (
            "1,2,3,4,5,6\n1,2,3,4,5,6,7\n",
            "line 2: found 7 values, expected 6",
        ),
        (
            "1,2,3,4,5,6\n1,2,x,4,5,6\n",
            "line 2, column 3: found \"x\", expected a number",
        ),
        (
            "1,2,3,1e301,5,6\n",
            "line 1, column 4: 1e301 is too large, expected at most 1e300",
        ),
        (
            "1,2,3,4mV,5,6\n",
            "line 1, column 4: found \"4mV\", expected a number",
        ),
        (
            "cup,2,3,4,5,6\n",
            "line 1, column 1: found \"cup\", expected a number; if it is the label: --label-column 1",
        ),
        (
            "12:00:00,2,3,4,5,6\n",
            "line 1, column 1: found \"12:00:00\", expected a number; if it is the time: --time-column 1",
        ),
        (
            "1 2 3\n4 5 6\n\n7 8 9\n\n1 2 3\n4 5 6\n",
            "line 5: the frame ends after 1 row, expected 2",
        ),
        (
            "1 2 3\n4 5 6\n\n1 2 3\n4 5 6\n7 8 9\n",
            "line 6: another row, expected an empty line after 2 of them",
        ),
        (
            "1 2 3\n4 5 6\n7 8 9\n",
            "line 4: the frame ends after 1 row, expected 2",
        ),
    ] {
        let found = recorded(text.as_bytes(), Some((2, 3)));
        assert!(
            error(&found).starts_with(expected),
            "{text}: {}",
            error(&found)
        );
    }
    for (text, found, fields) in [("5 7\n1 2 3\n4 5 6\n", 2, 3), ("t,s0,s1\n5,6\n7,8\n", 3, 2)] {
        let expected = format!(
            "line 1: found {found} fields, but line 2 has {fields}: delete the lines above the table, or begin them with #"
        );
        assert_eq!(error(&recorded(text.as_bytes(), None)), expected);
    }
}

/// Returns the times of the frames of a table, and its notes.
fn times(text: &str) -> (Vec<Option<f64>>, Vec<String>) {
    let found = recorded(text.as_bytes(), None);
    assert!(found.error.is_none(), "{text}: {:?}", found.error);
    let times = found.frames.iter().map(|frame| frame.time).collect();
    (times, found.notes.iter().map(ToString::to_string).collect())
}

#[test]
fn a_time_that_cannot_be_read_is_noted_once() {
    let (times, notes) = times("time;r0c0;r0c1\n0;1;2\n1.000,5;3;4\n2.000,5;3;4\n;3;4\n3;1;2\n");
    assert_eq!(times, [Some(0.0), None, None, None, Some(3.0)]);
    let expected = "frame 1: \"1.000,5\" cannot be read as a time; such frames have none";
    assert_eq!(notes, [expected]);
}

#[test]
fn times_since_1970_are_exact() {
    let start = 1_714_564_800_123_456_789_u64;
    for (name, unit, parts) in [
        ("time_ns", 1, 1),
        ("t_us", 1_000, 1),
        ("stamp[ms]", 1_000_000, 1),
        ("Time", 1_000_000_000, 1_000_000_000),
    ] {
        let row = |index: u64| {
            let time = start + 1_000_000 * index;
            if parts == 1 {
                format!("{},1,2\n", time / unit)
            } else {
                format!("{}.{:09},1,2\n", time / parts, time % parts)
            }
        };
        let text = format!("{name},r0c0,r0c1\n{}{}{}", row(0), row(1), row(2));
        assert_eq!(
            times(&text),
            ([0.0, 0.001, 0.002].map(Some).to_vec(), vec![]),
            "{text}"
        );
    }
    // Seconds may be counted from any moment.
    let text = "time_s,r0c0,r0c1\n1714564800.1234567890,1,2\n1714564800.1234567910,3,4\n";
    assert_eq!(times(text), (vec![Some(0.0), Some(2e-9)], vec![]));
    let text = "t,r0c0,r0c1\n12345,1,2\n12395,1,2\n";
    assert_eq!(times(text), (vec![Some(0.0), Some(50.0)], vec![]));
    let midnight = "t,r0c0,r0c1\n23:59:59.5,1,2\n00:00:00.5,3,4\n00:00:00.25,5,6\n23:59:00,7,8\n00:01:00,9,1\n";
    let expected = [0.0, 1.0, 0.75, 86_340.5, 86_460.5].map(Some).to_vec();
    assert_eq!(times(midnight).0, expected);
    let found = recorded(b"t,r0c0,r0c1\n12:00:00,1,2\n", None);
    assert_eq!(found.channels[0].start.as_deref(), Some("12:00:00"));
}

#[test]
fn a_line_with_too_many_fields_is_refused_early() {
    let line = |fields: usize| format!("{}\n", "0,".repeat(fields));
    assert_eq!(values(&line(512 * 512), Some((512, 512))).len(), 1);
    for fields in [512 * 512 + 17, 4 << 20] {
        let found = recorded(line(fields).as_bytes(), None);
        assert_eq!(
            error(&found),
            "line 1: more than 262,160 fields, expected at most 512 × 512 cells and 16 beside them"
        );
    }
}

#[test]
fn words_for_a_missing_value_are_cells_without_a_value() {
    for none in [
        "", "nan", "-nan", "NULL", "None", "NA", "N/A", "#N/A", "<NA>",
    ] {
        // Also at the beginning of a line, where `#` does not begin a comment.
        let text = format!("r0c0,r0c1\n{none},1\n2,{none}\n");
        let found = values(&text, None);
        assert!(found[0][0].is_nan() && found[1][1].is_nan(), "{text}");
        assert_eq!((found[0][1], found[1][0]), (1.0, 2.0), "{text}");
    }
    assert!(recorded(b"r0c0,r0c1\n1,-\n", None).error.is_some());
}

#[test]
fn letters_in_names_show_which_number_is_the_column() {
    let text = "c0r0,c1r0,c2r0,c0r1,c1r1,c2r1\n1,2,3,4,5,6\n";
    let found = recorded(text.as_bytes(), None);
    assert_eq!(channel_shape(&found.channels[0]), Some((2, 3)));
    assert_eq!(found.frames[0].values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn a_separator_in_quotes_is_part_of_a_field() {
    let text = "time,\"(0,0)\",\"(0,1)\",\"(1,0)\",\"(1,1)\"\n1,1,2,3,4\n";
    assert_eq!(values(text, None), [[1.0, 2.0, 3.0, 4.0]]);
    // A quote that is not closed is an ordinary character.
    let text = "time,width 5\",r0c0,r0c1\n1,0.5,1,2\n";
    assert_eq!(values(text, None), [[1.0, 2.0]]);
}

#[test]
fn a_line_that_names_the_separator_is_skipped() {
    for named in ["sep=;", "SEP=;", "\"sep=;\"", "sep=;;;"] {
        let text = format!("{named}\r\ntime;r0c0;r0c1\r\n0,5;1,5;2\r\n1;3;4\r\n");
        assert_eq!(values(&text, None), [[1.5, 2.0], [3.0, 4.0]], "{named}");
    }
    let text = "sep=\t\ntime\tr0c0\tr0c1\n0.5\t1.5\t2\n1\t3\t4\n";
    assert_eq!(values(text, None), [[1.5, 2.0], [3.0, 4.0]]);
}

#[test]
fn the_nan_of_python_is_a_cell_without_a_value_in_json() {
    let text = "{\"t\":NaN,\"frame\":[[1,NaN],[NaN,3]],\"note\":\"a \\\"NaN\"}\n{\"frame\":[[1,2],[3,4]]}\n";
    let found = frames(text, None);
    assert_eq!(found[0].1, None);
    let cells: Vec<bool> = found[0].2.iter().map(|value| value.is_nan()).collect();
    assert_eq!(cells, [false, true, true, false]);
    // A message names no column of a line that was changed.
    let wrong = "{\"frame\":[[NaN,NaN,x]]}\n";
    assert_eq!(
        error(&recorded(wrong.as_bytes(), None)),
        "line 1: expected value"
    );
}

#[test]
fn the_time_of_json_lines_is_t_or_time() {
    for (keys, expected) in [
        (["\"t\":1.5", "\"time\":2"], Some(0.5)),
        (["\"t\":null", "\"x\":1"], None),
        (["\"t\":1.5,\"t_ms\":7", "\"t\":2,\"t_ms\":8"], Some(0.5)),
    ] {
        let text = keys
            .map(|keys| format!("{{{keys},\"frame\":[[1,2]]}}\n"))
            .concat();
        assert_eq!(frames(&text, None)[1].1, expected, "{text}");
    }
}

#[test]
fn a_key_given_twice_in_a_line_of_json_is_refused() {
    for (keys, key) in [
        ("\"t\":1,\"t\":2", "t"),
        ("\"t\":1,\"time\":2", "t"),
        ("\"label\":1,\"label\":2", "label"),
        ("\"frame\":[[0]]", "frame"),
    ] {
        let found = recorded(format!("{{\"frame\":[[1]],{keys}}}\n").as_bytes(), None);
        let told = error(&found);
        let expected = format!("duplicate key `{key}`");
        assert!(
            told.starts_with("line 1, column ") && told.ends_with(&expected),
            "{told}"
        );
    }
    let found = recorded(b"{\"frame\":[[1]],\"x\":1,\"x\":2}\n", None);
    assert_eq!(found.frames.len(), 1);
}

#[test]
fn json_lines_have_at_most_256_channels() {
    let lines = |count: usize| -> String {
        let line = |number| format!("{{\"channel\":\"s{number}\",\"frame\":[[1,2]]}}\n");
        (0..count).map(line).collect()
    };
    let found = recorded(lines(256).as_bytes(), None);
    assert!(found.error.is_none(), "{:?}", found.error);
    assert_eq!(found.channels.len(), 256);
    let found = recorded(lines(257).as_bytes(), None);
    assert_eq!(error(&found), "more than 256 channels");
}

#[test]
fn a_label_of_json_lines_is_a_whole_number_or_a_text() {
    let labelled = |label: &str| {
        recorded(
            format!("{{\"label\":{label},\"frame\":[[1]]}}\n").as_bytes(),
            None,
        )
    };
    for (label, expected) in [
        ("7", Some(7.into())),
        ("-7", Some(Label::Number(-7))),
        ("null", None),
        ("\"cup\"", Some(Label::Text("cup".to_owned()))),
        ("\"7\"", Some(Label::Number(7))),
    ] {
        let found = labelled(label);
        assert!(found.error.is_none(), "{label}");
        assert_eq!(found.frames[0].label, expected, "{label}");
    }
    for label in ["1.5", "9223372036854775808", "[7]"] {
        let message = error(&labelled(label));
        assert!(message.contains("\"label\""), "{message}");
    }
}
