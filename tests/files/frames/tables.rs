//! Tables as various programs write them.

use taxel_core::frame::{Frame, Label};

use super::{Recorded, channel_shape, recorded};

/// Returns the label, time and values of each frame of a table.
fn frames(text: &str, shape: Option<(u16, u16)>) -> Vec<(Option<i64>, Option<f64>, Vec<f64>)> {
    let found = recorded(text.as_bytes(), shape);
    assert!(found.error.is_none(), "{text}: {:?}", found.error);
    let parts = |frame: &Frame| {
        (
            frame.label.as_ref().and_then(Label::number),
            frame.time,
            frame.values().to_vec(),
        )
    };
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

#[test]
fn a_first_line_with_a_text_is_a_frame_if_the_next_one_has_a_text_there() {
    let both = [vec![1.0, 2.0, 3.0, 4.0], vec![5.0, 6.0, 7.0, 8.0]];
    for [first, second] in [
        [
            "2021-01-02T10:11:12.345,1,2,3,4",
            "2021-01-02T10:11:12.445,5,6,7,8",
        ],
        [
            "01/02/21 10:11:12:345;1;2;3;4",
            "01/02/21 10:11:12:445;5;6;7;8",
        ],
        ["10:11:12.3 1 2 3 4", "10:11:12.4 5 6 7 8"],
        ["1,2,3,4,cup", "5,6,7,8,cup"],
        ["cup,1,2,3,4,s1", "ring,5,6,7,8,s2"],
    ] {
        let text = format!("{first}\n{second}\n");
        assert_eq!(values(&text, Some((2, 2))), both, "{text}");
    }
    // These first lines are names.
    for text in [
        "label,0,1,2,3\ncup,5,6,7,8\n",
        "label,1,2,3,4\ncup,5,6,7,8\n",
    ] {
        assert_eq!(values(text, Some((2, 2))), both[1..], "{text}");
    }
    // A misspelt number does not make a line of names.
    for (line, column, word) in [
        ("1,inf,3,4", 2, "inf"),
        ("12,13,1O,14", 3, "1O"),
        ("1,2,3,4mV", 4, "4mV"),
        ("1,>255,3,4", 2, ">255"),
    ] {
        let found = recorded(format!("{line}\n5,6,7,8\n").as_bytes(), Some((2, 2)));
        let expected = format!("line 1, column {column}: found {word:?}, expected a number");
        assert_eq!(error(&found), expected);
    }
    // A text between the cells is not a cell.
    let found = recorded(b"1,2,x,3,4\n5,6,x,7,8\n", Some((2, 2)));
    assert_eq!(
        error(&found),
        "line 1, column 3: found \"x\", expected a number"
    );
}

#[test]
fn a_sensor_of_one_cell_needs_no_rows_and_columns() {
    for (text, expected) in [
        ("t,S0_0\n0,5\n1,6\n", [Some(0.0), Some(1.0)]),
        ("S0_0\n5\n6\n", [None, None]),
    ] {
        let found = frames(text, None);
        let expected = expected.into_iter().zip([5.0, 6.0]);
        let expected = expected.map(|(time, value)| (None, time, vec![value]));
        assert_eq!(found, expected.collect::<Vec<_>>(), "{text}");
    }
    for text in ["x1\n5\n6\n", "v1.1\n5\n6\n", "S0_0\ntext\n"] {
        assert!(recorded(text.as_bytes(), None).error.is_some(), "{text}");
    }
}

#[test]
fn an_index_of_pandas_is_not_a_cell() {
    let text = ",0,1,2,3\n0,1,2,3,4\n1,5,6,7,8\n";
    let expected = [
        (Some(0), None, vec![1.0, 2.0, 3.0, 4.0]),
        (Some(1), None, vec![5.0, 6.0, 7.0, 8.0]),
    ];
    assert_eq!(frames(text, None), expected);
    assert_eq!(frames(text, Some((2, 2))), expected);
    let text = ",time,0,1,2,3\n7,0.5,1,2,3,4\n8,0.75,5,6,7,8\n";
    let found = frames(text, Some((1, 4)));
    assert_eq!(
        (found[1].0, found[1].1, &found[1].2),
        (Some(8), Some(0.25), &expected[1].2)
    );
}

#[test]
fn two_numbers_beside_the_cells_have_two_layouts_and_anything_else_is_refused() {
    let with = |label, time: f64| (Some(label), Some(time));
    for (text, expected, first_cells) in [
        (
            "7,0.00,1,2,9,4\n8,0.05,1,2,8,6\n9,0.10,1,2,9,7\n",
            [with(7, 0.0), with(8, 0.05), with(9, 0.1)],
            [1.0, 1.0, 1.0],
        ),
        (
            "0,1714564800000,0,0,0,0\n1,1714564800050,3,9,8,2\n2,1714564800092,4,18,16,4\n",
            [with(0, 0.0), with(1, 0.05), with(2, 0.092)],
            [0.0, 3.0, 4.0],
        ),
        // Milliseconds behind the cells; the last line is torn.
        (
            "5,6,2,1,0,0\n7,6,2,1,1,40\n9,6,2,2,2,8\n",
            [with(0, 0.0), with(1, 0.04), with(2, 0.008)],
            [5.0, 7.0, 9.0],
        ),
        // A number before a timestamp.
        (
            "0,12:00:00.00,1,2,3,4\n1,12:00:00.05,2,3,4,5\n2,12:00:00.10,3,4,5,6\n",
            [with(0, 0.0), with(1, 0.05), with(2, 0.1)],
            [1.0, 2.0, 3.0],
        ),
    ] {
        let found = frames(text, Some((2, 2)));
        let beside: Vec<_> = found.iter().map(|own| (own.0, own.1)).collect();
        let cells: Vec<f64> = found.iter().map(|own| own.2[0]).collect();
        assert_eq!(
            (&beside[..], &cells[..]),
            (&expected[..], &first_cells[..]),
            "{text}"
        );
    }
    let one = "found 1 number besides the 4 cells, and cannot tell which";
    let two = "found 2 numbers besides the 4 cells, and cannot tell which";
    for (text, line, expected) in [
        ("0,1,2,3,4\n1,5,6,7,8\n2,5,6,7,9\n", 1, one),
        ("5,1,2,9,0.00\n7,1,2,9,0.05\n", 1, one),
        ("# a\n\n0,0.0,1,2,3,4\n1,0.1,1,2,4,8\n", 3, two),
        ("17,0.25,1,2,3,4\n", 1, two),
        ("0.5,1,1,2,3,4\n0.6,2,1,2,3,4\n", 1, two),
        ("0,1,2,9,4,0.00\n1,1,2,8,4,0.05\n", 1, two),
        ("# a\n1,2,3,4,5,6,7\n", 2, "found 7 values, expected 4"),
        ("1,2,3\n", 1, "found 3 values, expected 4"),
    ] {
        let found = recorded(text.as_bytes(), Some((2, 2)));
        let expected = format!("line {line}: {expected}");
        assert!(
            error(&found).starts_with(&expected),
            "{text}: {}",
            error(&found)
        );
    }
}

#[test]
fn a_comma_after_the_seconds_separates_fields() {
    let text = "12:00:00,100,2,3,4\n12:00:01,110,2,3,4\n";
    assert_eq!(values(text, Some((2, 2)))[1], [110.0, 2.0, 3.0, 4.0]);
    // As a decimal sign, it makes one field too many.
    let found = recorded(
        b"12:00:00,100,1,2,3,4\n12:00:00,110,1,2,3,4\n",
        Some((2, 2)),
    );
    let expected = "line 1: found 1 number besides the 4 cells, and cannot tell which";
    assert!(error(&found).starts_with(expected), "{}", error(&found));
}

#[test]
fn a_first_line_that_counts_from_0_is_a_header() {
    for text in [
        "0,1,2,3\n5,6,7,8\n1,2,3,4\n\n",
        "0,1,2,3\n5,6,7,8\n\n1,2,3,4\n",
    ] {
        assert_eq!(
            values(text, None),
            [[5.0, 6.0, 7.0, 8.0], [1.0, 2.0, 3.0, 4.0]]
        );
    }
    // With other rows and columns than it has fields, it is a row.
    let block = "0 1 2 3\n4 5 6 7\n\n";
    assert_eq!(values(&block.repeat(3), Some((2, 4))).len(), 3);
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
fn a_time_in_two_columns_is_their_sum() {
    for [seconds, rest] in [
        ["header.stamp.secs", "header.stamp.nsecs"],
        ["sec", "nanosec"],
        ["secs", "nsecs"],
    ] {
        let rows = "1714564800,999999999,1,2\n1714564801,1,3,4\n1714564801,50000000,3,4\n";
        let text = format!("{seconds},{rest},r0c0,r0c1\n{rows}");
        let expected = [0.0, 2e-9, 0.050_000_001].map(Some).to_vec();
        assert_eq!(times(&text), (expected.clone(), vec![]), "{text}");
        // After the cells, and in the opposite order.
        let rows = "1,2,999999999,1714564800\n3,4,1,1714564801\n3,4,50000000,1714564801\n";
        let text = format!("r0c0,r0c1,{rest},{seconds}\n{rows}");
        assert_eq!(times(&text), (expected, vec![]), "{text}");
    }
}

#[test]
fn times_since_1970_are_exact_and_their_size_shows_their_unit() {
    let start = 1_714_564_800_123_456_789_u64;
    for (name, unit, parts, noted) in [
        ("time_ns", 1, 1, ""),
        ("timestamp", 1, 1, "nanoseconds"),
        ("%time", 1, 1, "nanoseconds"),
        ("ts", 1_000, 1, "microseconds"),
        ("unix_time", 1_000_000, 1, "milliseconds"),
        ("epoch", 1_000_000_000, 1_000_000_000, ""),
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
        let (found, notes) = times(&text);
        assert_eq!(found, [0.0, 0.001, 0.002].map(Some), "{text}");
        let expected = match noted {
            "" => vec![],
            unit => vec![format!(
                "the times have no unit and are taken as {unit} since 1970"
            )],
        };
        assert_eq!(notes, expected, "{text}");
    }
    // With 20 digits they are as exact.
    let text = "time_s,r0c0,r0c1\n1714564800.1234567890,1,2\n1714564800.1234567910,3,4\n";
    assert_eq!(times(text), (vec![Some(0.0), Some(2e-9)], vec![]));
    let line = |step| format!("{{\"timestamp\":{},\"frame\":[[1,2]]}}\n", start + step);
    let noted = "the times have no unit and are taken as nanoseconds since 1970".to_owned();
    let found = times(&(line(0) + &line(1_000_001)));
    assert_eq!(found, (vec![Some(0.0), Some(0.001_000_001)], vec![noted]));
    // A unit in the name takes precedence, and seconds may be counted from any moment.
    let text = "time_s,r0c0,r0c1\n1714564800123,1,2\n1714564800125,1,2\n";
    assert_eq!(times(text), (vec![Some(0.0), Some(2.0)], vec![]));
    let text = "t,r0c0,r0c1\n12345,1,2\n12395,1,2\n";
    assert_eq!(times(text), (vec![Some(0.0), Some(50.0)], vec![]));
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
fn comments_and_units_are_not_frames() {
    for comment in ["# a, b", "% a, b", "%% 1, 2", "%", "// 1, 2"] {
        let text = format!("{comment}\n1 2\n3 4\n{comment}\n\n5 6\n7 8\n");
        assert_eq!(values(&text, None).len(), 2, "{text}");
    }
    let text = "frame,time,r0c0,r0c1\n-,ms,[kPa],[kPa]\n7,10,1,2\n8,60,3,4\n";
    let found = recorded(text.as_bytes(), None);
    assert_eq!(found.channels[0].unit.as_deref(), Some("kPa"));
    assert_eq!(frames(text, None)[1], (Some(8), Some(0.05), vec![3.0, 4.0]));
    // The cells have different units; the name of the time contains one.
    let text = "time_s,r0c0,r0c1\nms,kPa,N\n\n1,1,2\n3,3,4\n";
    let found = recorded(text.as_bytes(), None);
    assert_eq!(found.channels[0].unit, None);
    assert_eq!(frames(text, None)[1].1, Some(2.0));
    // A dash is not a unit.
    let text = "time_s,r0c0,r0c1\ns,-,-\n1,1,2\n3,3,4\n";
    assert_eq!(recorded(text.as_bytes(), None).channels[0].unit, None);
    // A duration before the time is not the time.
    let text = "latency_ms,timestamp,r0c0,r0c1\n3,0.5,1,2\n4,0.75,3,4\n";
    assert_eq!(frames(text, None)[1].1, Some(0.25));
    // A first frame without values is a frame.
    for text in [
        "time,r0c0,r0c1\n2024-05-01T12:00:00Z,,\n2024-05-01T12:00:01Z,1,2\n",
        "label,r0c0,r0c1\ncup,NaN,NaN\npen,1,2\n",
    ] {
        let found = recorded(text.as_bytes(), None);
        assert_eq!(found.frames.len(), 2, "{text}");
        assert_eq!(found.channels[0].unit, None);
    }
    // An index of pandas may contain the times.
    let text = ",r0c0,r0c1\n2024-05-01 12:00:00.000,1,2\n2024-05-01 12:00:00.050,5,6\n";
    assert_eq!(frames(text, None)[1], (None, Some(0.05), vec![5.0, 6.0]));
    // Two lines of words are not the header of a table.
    assert!(recorded(b"a,b\nc,d\n1,2\n", None).error.is_some());
}

#[test]
fn a_block_of_rows_may_begin_with_a_date_and_time() {
    let blocks = "12:00:00.00 1 2\n3 4\n\n12:00:00.05 5 6\n7 8\n\n";
    let both = "2024-05-01 23:59:59.95,1,2\n2024-05-02 00:00:00,3,4\n\n2024-05-02 00:00:00,5,6\n2024-05-02 00:00:01,7,8\n";
    for (text, start) in [(blocks, "12:00:00.00"), (both, "2024-05-01 23:59:59.95")] {
        for shape in [None, Some((2, 2))] {
            let found = recorded(text.as_bytes(), shape);
            assert!(found.error.is_none(), "{text}: {:?}", found.error);
            assert_eq!(found.channels[0].start.as_deref(), Some(start));
            let frames: Vec<_> = found
                .frames
                .iter()
                .map(|own| (own.time, own.values().to_vec()))
                .collect();
            let expected = [
                (Some(0.0), vec![1.0, 2.0, 3.0, 4.0]),
                (Some(0.05), vec![5.0, 6.0, 7.0, 8.0]),
            ];
            assert_eq!(frames, expected, "{text}");
        }
    }
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
fn names_without_clear_rows_and_columns_are_only_counted() {
    let found = recorded(b"t,S00,S01,S10,S11\n0.5,1,2,3,4\n", None);
    assert!(
        error(&found).starts_with("4 values a frame"),
        "{}",
        error(&found)
    );
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
fn a_date_and_time_beside_the_cells_is_the_time() {
    let times = |text: &str, shape| {
        let found = recorded(text.as_bytes(), shape);
        assert!(found.error.is_none(), "{text}: {:?}", found.error);
        let times: Vec<Option<f64>> = found.frames.iter().map(|frame| frame.time).collect();
        (found.channels[0].start.clone(), times)
    };
    for (text, shape, start, second) in [
        // The time under any name, past midnight.
        (
            "when,note,r0c0,r0c1\n2024-05-01T23:59:59.5Z,a,1,2\n2024-05-02T00:00:00.25Z,b,3,4\n",
            None,
            "2024-05-01T23:59:59.5Z",
            0.75,
        ),
        // A date alone is ignored, and so is a unit, which a moment does not need.
        (
            "date;time (ms);r0c0;r0c1\n2024-05-01;12:00:00.1;1;2\n2024-05-01;12:00:00.3;3;4\n",
            None,
            "12:00:00.1",
            0.2,
        ),
        // Without names, beside a number that counts.
        (
            "0,2024-05-01 12:00:00+02:00,1,2\n1,2024-05-01 12:00:01+02:00,3,4\n",
            Some((1, 2)),
            "2024-05-01 12:00:00+02:00",
            1.0,
        ),
    ] {
        let expected = (Some(start.to_owned()), vec![Some(0.0), Some(second)]);
        assert_eq!(times(text, shape), expected, "{text}");
    }
    // A column of numbers takes precedence over it; an unreadable text is not a time.
    let numbers = "date,t,r0c0,r0c1\n2024-05-01 12:00:00,3,1,2\n2024-05-01 12:00:09,4.5,3,4\n";
    assert_eq!(times(numbers, None), (None, vec![Some(0.0), Some(1.5)]));
    let midnight = "t,r0c0,r0c1\n23:59:59.5,1,2\n00:00:00.5,3,4\n00:00:00.25,5,6\n23:59:00,7,8\n00:01:00,9,1\n";
    let expected = [0.0, 1.0, 0.75, 86_340.5, 86_460.5].map(Some).to_vec();
    assert_eq!(times(midnight, None).1, expected);
    let gap = "t,r0c0,r0c1\n12:00:00,1,2\nlater,3,4\n12:00:02,5,6\n";
    let expected = vec![Some(0.0), None, Some(2.0)];
    assert_eq!(times(gap, None), (Some("12:00:00".to_owned()), expected));
    let german = "time,r0c0,r0c1\n01.05.2024 12:00:00,1,2\n01.05.2024 12:00:01,3,4\n";
    assert_eq!(times(german, None), (None, vec![None, None]));
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
fn the_nan_of_python_is_a_cell_without_a_value_in_json() {
    let text = "{\"t\":NaN,\"frame\":[[1,NaN],[NaN,3]],\"note\":\"a \\\"NaN\"}\n{\"frame\":[[1,2],[3,4]]}\n";
    let found = frames(text, None);
    assert_eq!(found[0].1, None);
    let cells: Vec<bool> = found[0].2.iter().map(|value| value.is_nan()).collect();
    assert_eq!(cells, [false, true, true, false]);
    // Columns in messages are those of the original line.
    for (text, expected) in [
        (
            "{\"frame\":[[NaN,NaN,x]]}\n",
            "line 1, column 20: expected value",
        ),
        (
            "{\"frame\":[[NaN,Infinity]]}\n",
            "line 1, column 16: found Infinity, expected a number, or null where there is no cell",
        ),
    ] {
        assert_eq!(error(&recorded(text.as_bytes(), None)), expected);
    }
}

#[test]
fn other_names_for_the_time_are_used_if_there_is_no_t() {
    for (keys, expected) in [
        (["\"timestamp\":1.5", "\"timestamp\":1.75"], Some(0.25)),
        (["\"t_ms\":10", "\"t_ms\":60"], Some(0.05)),
        (
            ["\"timestamp\":1714564800123", "\"timestamp\":1714564800173"],
            Some(0.05),
        ),
        (
            [
                "\"timestamp\":\"2024-05-01T12:00:00Z\"",
                "\"timestamp\":\"2024-05-01T12:00:01Z\"",
            ],
            Some(1.0),
        ),
        (["\"t_ms\":10,\"t\":1", "\"t_ms\":60,\"t\":2"], Some(1.0)),
        (
            [
                "\"latency_ms\":5,\"timestamp\":1",
                "\"latency_ms\":9,\"timestamp\":2",
            ],
            Some(1.0),
        ),
        (
            [
                "\"sec\":1714564800,\"nanosec\":950000000",
                "\"sec\":1714564801,\"nanosec\":50000001",
            ],
            Some(0.100_000_001),
        ),
        // A clock without a date passes midnight.
        (
            ["\"timestamp\":\"23:59:59.5\"", "\"timestamp\":\"00:00:00\""],
            Some(0.5),
        ),
        (
            ["\"time_s\":[1],\"force\":1", "\"time_s\":{},\"force\":2"],
            None,
        ),
    ] {
        let text = keys
            .map(|keys| format!("{{{keys},\"frame\":[[1,2]]}}\n"))
            .concat();
        assert_eq!(frames(&text, None)[1].1, expected, "{text}");
    }
}

#[test]
fn a_key_given_twice_in_a_line_of_json_is_refused() {
    for (keys, message) in [
        ("\"t\":1,\"t\":2", "\"t\" is given twice"),
        ("\"time\":1,\"time\":1", "\"time\" is given twice"),
        (
            "\"t\":1,\"time\":2",
            "\"t\" and \"time\" are given, expected one of them",
        ),
        ("\"label\":1,\"label\":2", "\"label\" is given twice"),
        ("\"frame\":[[0]]", "\"frame\" is given twice"),
    ] {
        let found = recorded(format!("{{\"frame\":[[1]],{keys}}}\n").as_bytes(), None);
        let told = error(&found);
        assert!(
            told.starts_with("line 1, column ") && told.ends_with(message),
            "{told}"
        );
    }
    let found = recorded(b"{\"frame\":[[1]],\"x\":1,\"x\":2}\n", None);
    assert_eq!(found.frames.len(), 1);
}

#[test]
fn the_time_of_a_line_of_json_may_come_after_many_other_keys() {
    let others: String = (0..20).map(|key| format!("\"force_{key}\":1,")).collect();
    let line = |time: &str| format!("{{{others}\"timestamp\":{time},\"frame\":[[1,2]]}}\n");
    let text = line("1.5") + &line("1.75");
    assert_eq!(frames(&text, None)[1].1, Some(0.25));
}

#[test]
fn single_rows_between_empty_lines_need_given_rows_and_columns() {
    let found = recorded(b"1,2\n\n3,4\n\n5,6\n\n", None);
    assert!(
        error(&found).contains("rows and columns of a frame are not stated"),
        "{}",
        error(&found)
    );
    assert_eq!(values("1,2\n\n3,4\n\n5,6\n\n", Some((1, 2))).len(), 3);
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
    assert_eq!(error(&found), "line 257: more than 256 channels");
}

#[test]
fn a_label_of_json_lines_is_a_whole_number_and_the_name_of_a_class_is_not_one() {
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
    for (label, found) in [
        ("1.5", "floating point `1.5`"),
        ("9223372036854775808", "integer `9223372036854775808`"),
        ("[7]", "sequence"),
    ] {
        let message = error(&labelled(label));
        assert!(
            message.ends_with(&format!(": {found}, expected i64")),
            "{message}"
        );
    }
}
