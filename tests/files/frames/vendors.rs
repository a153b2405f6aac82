//! Made-up files of vendors' programs in certain versions or settings.

use std::fmt::Write;

use taxel_core::frame::{Frame, Label};

use super::{Recorded, channel_shape, recorded};

fn error(found: &Recorded) -> Option<String> {
    found.error.as_ref().map(ToString::to_string)
}

fn notes(found: &Recorded) -> Vec<String> {
    found.notes.iter().map(ToString::to_string).collect()
}

/// Returns the label, time and first value of each frame of a channel.
fn frames(found: &Recorded, channel: usize) -> Vec<(Option<i64>, Option<f64>, f64)> {
    let own = found.frames.iter().filter(|frame| frame.channel == channel);
    let parts = |frame: &Frame| {
        (
            frame.label.as_ref().and_then(Label::number),
            frame.time,
            frame.values()[0],
        )
    };
    own.map(parts).collect()
}

#[test]
fn the_last_unit_of_tekscan_is_used_and_metres_are_converted() {
    let text = "DATA_TYPE MOVIE\nROWS 1\nCOLS 2\nROW_SPACING 1.27e-003 meters\nCOL_SPACING 1.27 mm\n\
                COMMENTS the pad\nASCII_DATA was chosen\nUNITS kPa\nROWS 9\nUNITS raw\nASCII_DATA @@\nFrame 1\n1,2\n\n@@\n";
    let found = recorded(text.as_bytes(), None);
    assert_eq!((error(&found), found.frames.len()), (None, 1));
    let info = &found.channels[0];
    assert_eq!(info.unit.as_deref(), Some("raw"));
    assert_eq!(
        (info.pitch_mm, channel_shape(info)),
        (Some([1.27, 1.27]), Some((1, 2)))
    );
}

#[test]
fn a_unit_of_tekscan_is_not_empty_and_not_in_comments() {
    for (header, unit) in [
        ("UNITS\n", None),
        ("UNITS,,\n", None),
        ("UNITS kPa\nCOMMENTS:\nUNITS fake\n", Some("kPa")),
        (
            "COMMENTS the pad\nUNITS fake\nCOMMENTS\nUNITS kPa\n",
            Some("kPa"),
        ),
    ] {
        let text = format!("ROWS 1\nCOLS 2\n{header}ASCII_DATA @@\nFrame 1\n1,2\n\n@@\n");
        let found = recorded(text.as_bytes(), None);
        assert_eq!(error(&found), None, "{header}");
        assert_eq!(found.channels[0].unit.as_deref(), unit, "{header}");
    }
}

#[test]
fn the_times_of_tekscan_count_from_the_first_frame() {
    for (titles, times) in [
        (["7, 0.25,,", "8, 0.5,,", "9"], [0.0, 0.25, 1.0]),
        (["11", "12", "14"], [0.0, 0.5, 1.5]),
        (["11", "12, 5.5", "13, 6.25"], [0.0, 0.5, 1.25]),
    ] {
        let frames = titles.map(|title| format!("Frame {title}\n1,2\n\n"));
        let text = format!(
            "ROWS 1\nCOLS 2\nSECONDS_PER_FRAME 0.5\nASCII_DATA @@\n{}@@\n",
            frames.concat()
        );
        let found = recorded(text.as_bytes(), None);
        let found: Vec<_> = found.frames.iter().map(|frame| frame.time).collect();
        assert_eq!(found, times.map(Some), "{titles:?}");
    }
}

/// Returns an export of XSENSOR with two sensors, two frames and the clocks `times`.
fn xsensor(times: [&str; 2]) -> String {
    let mut text = "Units:,mmHg\nThreshold:,9.5\n".to_owned();
    for (label, time) in (100..).zip(times) {
        write!(text, "\nFRAME,{label}\nDate, 2022 Aug 16\nTime, {time}\n").expect("a text");
        for name in ["left", "right"] {
            write!(
                text,
                "\nSENSOR,{name}\nRows,1\nColumns,2\nSensel Width (cm),0.25\nSensel Height (cm),0.25\n\nSENSELS\n\
                 1.5,{label}\n"
            )
            .expect("a text");
        }
    }
    text
}

/// Puts quotes around all fields.
fn quoted(text: &str) -> String {
    let field = |field: &str| format!("\"{field}\"");
    let line = |line: &str| line.split(',').map(field).collect::<Vec<_>>().join(",");
    let lines = text.lines().map(|text| {
        if text.is_empty() {
            String::new()
        } else {
            line(text)
        }
    });
    lines.map(|line| line + "\n").collect()
}

#[test]
fn xsensor_exports_are_read_with_any_quotes_colons_and_units() {
    let plain = xsensor(["08:21:17.9", "08:21:18.4"]);
    let whole = recorded(plain.as_bytes(), None);
    assert_eq!((error(&whole), whole.channels.len()), (None, 2));
    assert_eq!(
        frames(&whole, 1),
        [(Some(100), Some(0.0), 1.5), (Some(101), Some(0.5), 1.5)]
    );
    assert_eq!(whole.channels[0].pitch_mm, Some([2.5, 2.5]));
    let comma = quoted(&plain).replace('.', ",");
    let comma = comma.replace("17,9", "17.9").replace("18,4", "18.4");
    let colons: String = plain
        .replace("FRAME,", "Frame:,")
        .replace("SENSOR,", "Sensor:,")
        .replace("SENSELS", "Sensels:")
        .replace("Rows,", "Rows:,")
        .replace("Columns,", "Columns:,")
        .replace("(cm),", "(cm):,");
    let millimetres = plain.replace("(cm),0.25", "(mm),2.5");
    let inches = plain.replace("(cm),0.25", "(in),0.098425197");
    for (text, pitch) in [
        (quoted(&plain), 2.5),
        (comma, 2.5),
        (colons.clone(), 2.5),
        (quoted(&colons), 2.5),
        (millimetres, 2.5),
        (inches, 2.500_000_004),
    ] {
        let found = recorded(text.as_bytes(), None);
        assert_eq!(
            (found.format, error(&found)),
            (Some("xsensor"), None),
            "{text}"
        );
        assert_eq!(found.channels[0].threshold, Some(9.5), "{text}");
        assert_eq!(found.channels[0].pitch_mm, Some([pitch, pitch]), "{text}");
        assert_eq!(found.channels[0].start, whole.channels[0].start, "{text}");
        for channel in [0, 1] {
            assert_eq!(frames(&found, channel), frames(&whole, channel), "{text}");
        }
    }
    // The time is in seconds; and a single sensor has no name.
    let found = recorded(xsensor(["0.25", "0.3755"]).as_bytes(), None);
    assert_eq!(found.frames[2].time, Some(0.1255));
    // A clock that is too large for a number of seconds is ignored, and differences of times are finite.
    let found = recorded(xsensor(["1e306:21:17.9", "1e306:21:18.4"]).as_bytes(), None);
    assert_eq!((error(&found), found.frames[2].time), (None, None));
    let found = recorded(xsensor(["-1e308", "1e308"]).as_bytes(), None);
    assert_eq!(found.frames[2].time, Some(f64::MAX));
    assert_eq!(found.channels[0].start.as_deref(), Some("2022 Aug 16"));
    let nameless = colons
        .replace("Sensor:,left\n", "")
        .replace("Sensor:,right\n", "");
    let found = recorded(nameless.as_bytes(), None);
    assert_eq!((error(&found), found.frames.len()), (None, 4));
    assert_eq!(found.channels[0].name, None);
}

#[test]
fn the_time_of_xsensor_continues_past_midnight() {
    let found = recorded(xsensor(["23:59:59.5", "00:00:00.5"]).as_bytes(), None);
    assert_eq!((error(&found), notes(&found).len()), (None, 0));
    assert_eq!(found.frames[2].time, Some(1.0));
}

#[test]
fn an_xsensor_export_that_ends_inside_a_frame_is_reported_as_damaged() {
    let text = xsensor(["08:21:17.9", "08:21:18.4"]);
    let last = text.rfind("FRAME").expect("a frame");
    let right = text.rfind("SENSOR").expect("a sensor");
    for (end, whole) in [
        (last + "FRAME,101\n".len(), 2),
        (last + "FRAME,101\nDate, 2022".len(), 2),
        (right + "SEN".len(), 3),
    ] {
        let found = recorded(&text.as_bytes()[..end], None);
        assert_eq!(found.frames.len(), whole);
        let message = error(&found).expect("an error");
        assert!(
            message.ends_with("ends inside a FRAME, expected SENSOR"),
            "{message}"
        );
    }
}

#[test]
fn a_row_more_than_rows_says_is_an_error_and_its_frame_is_not_reported() {
    let text = xsensor(["08:21:17.9", "08:21:18.4"]);
    let row = "1.5,101\n";
    let last = text.rfind(row).expect("the last frame");
    // Below the first sensor of the second frame, and below the last one, where nothing else follows.
    for (end, whole) in [(text.find(row).expect("a frame"), 2), (last, 3)] {
        let (above, below) = text.split_at(end + row.len());
        for padding in ["", ",,\n"] {
            let found = recorded(format!("{above}{padding}7,8,,\n{below}").as_bytes(), None);
            let line = above.lines().count() + padding.lines().count() + 1;
            let expected = format!("line {line}: more values, expected 1 row of them as Rows says");
            assert_eq!((error(&found), found.frames.len()), (Some(expected), whole));
        }
    }
}

#[test]
fn groups_of_xsensor_are_skipped() {
    let mut text = String::new();
    for label in [7, 8] {
        let sensor = "SENSOR,left\nRows,1\nColumns,2\nSENSELS\n1.5,2\n";
        let groups =
            "GROUP,1\nName,heel\nCells,3\nSENSELS\n1,2,,\n3,,\nGROUP,2\nCells,1\nSENSELS\n4\n";
        write!(text, "FRAME,{label}\n{sensor}{groups}").expect("a text");
    }
    let found = recorded(text.as_bytes(), None);
    assert_eq!((error(&found), found.frames.len()), (None, 2));
}
