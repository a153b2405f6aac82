//! Made-up files of vendors' programs in certain versions or settings.

use std::fmt::Write;

use taxel::frame::{FirstCell, Frame};

use super::samples::sample;
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
    let parts = |frame: &Frame| (frame.label, frame.time, frame.values()[0]);
    own.map(parts).collect()
}

/// Returns a zebris file with a section for each name; the first value of a section is its number.
fn zebris(sections: &[&str]) -> String {
    let mut text = "[General]\nDate=1/2/2021\nTime=10.11.12\nUnitDistance=mm\nUnitPressure=N/cm2\nUnitTime=ms\n\
                    [Technical]\nSensCountX=2\nSensCountY=3\nLDistX=8\nLDistY=8\nTimeDiff=20\nMinIdx=4\nMaxIdx=6\n"
        .to_owned();
    for (section, value) in sections.iter().zip(1..) {
        write!(text, "\n[{section}]\n{value}\t-1\t3\n4\t5\t6\n").expect("a text");
    }
    text
}

#[test]
fn the_numbered_pictures_of_zebris_are_frames_but_their_maximum_is_not() {
    let text = zebris(&["Data", "Data4", "Data5", "Data6"]);
    let found = recorded(text.as_bytes(), None);
    assert_eq!(error(&found), None);
    let expected = [(4, 0.0, 2.0), (5, 0.02, 3.0), (6, 0.04, 4.0)];
    assert_eq!(
        frames(&found, 0),
        expected.map(|(label, time, first)| (Some(label), Some(time), first))
    );
    assert_eq!(found.channels[0].seconds_per_frame, Some(0.02));
    let maximum = "the picture [Data] is the maximum of the numbered ones and is left out";
    assert_eq!(notes(&found), [maximum]);
    // Alone, this section is the picture.
    let found = recorded(zebris(&["Data"]).as_bytes(), None);
    assert_eq!(frames(&found, 0), [(Some(1), None, 1.0)]);
    assert_eq!((error(&found), notes(&found).len()), (None, 0));
    // The file is cut off between two pictures, and inside of one.
    let found = recorded(zebris(&["Data4", "Data5"]).as_bytes(), None);
    let cut = "the file was cut off: it has 2 of the 3 frames that its header counts";
    assert_eq!(
        (found.frames.len(), notes(&found)),
        (2, vec![cut.to_owned()])
    );
    let found = recorded(&text.as_bytes()[..text.len() - 6], None);
    assert_eq!(found.frames.len(), 2);
    assert!(error(&found).is_some_and(|error| error.ends_with("expected 2 lines of values")));
    // Which of two sections [Data] is a frame, nobody knows; the numbered ones above are frames.
    let second = "a second section [Data], expected a numbered one such as [Data12]";
    for (sections, whole, notes_before) in [
        (&["Data", "Data", "Data4"][..], 1, 0),
        (&["Data", "Data4", "Data", "Data5"], 1, 1),
    ] {
        let found = recorded(zebris(sections).as_bytes(), None);
        assert_eq!(
            (found.frames.len(), notes(&found).len()),
            (whole, notes_before)
        );
        assert!(error(&found).is_some_and(|error| error.ends_with(second)));
    }
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

#[test]
fn a_pitch_is_rounded_and_one_that_no_sensor_has_is_unknown() {
    let tekscan = |pitch: &str, unit: &str| {
        format!(
            "DATA_TYPE MOVIE\nROWS 1\nCOLS 2\nROW_SPACING {pitch} {unit}\nCOL_SPACING {pitch} {unit}\n\
             ASCII_DATA @@\nFrame 1\n1,2\n\n@@\n"
        )
    };
    let zebris = |pitch: &str, unit: &str| {
        let text = zebris(&["Data"]).replace("=8\n", &format!("={pitch}\n"));
        text.replace("Distance=mm", &format!("Distance={unit}"))
    };
    let emed = |pitch: &str, unit: &str| {
        let size = format!("{pitch}x{pitch} {unit}");
        emed_header(1).replace("1.000x1.000 cm", &size) + LEFT
    };
    let xsensor = |pitch: &str, unit: &str| {
        let text = xsensor(["08:21:17.9", "08:21:18.4"]).replace("(cm)", &format!("({unit})"));
        text.replace(",0.25\n", &format!(",{pitch}\n"))
    };
    for (pitch, unit, expected) in [
        ("0.57", "cm", Some([5.7, 5.7])),
        ("0.05", "in", Some([1.27, 1.27])),
        ("1000.1", "mm", None),
        ("0.00", "cm", None),
        ("0.0000000000001", "cm", None),
    ] {
        for text in [
            tekscan(pitch, unit),
            zebris(pitch, unit),
            emed(pitch, unit),
            xsensor(pitch, unit),
        ] {
            let found = recorded(text.as_bytes(), None);
            assert_eq!(error(&found), None, "{text}");
            assert_eq!(found.channels[0].pitch_mm, expected, "{text}");
        }
    }
}

#[test]
fn a_time_step_that_no_recording_has_is_unknown() {
    let tekscan = |step: &str| {
        format!(
            "DATA_TYPE MOVIE\nROWS 1\nCOLS 2\nSECONDS_PER_FRAME {step}\nASCII_DATA @@\n\
             Frame 1\n1,2\n\nFrame 2\n1,2\n\n@@\n"
        )
    };
    let zebris = |step: &str| {
        let text = zebris(&["Data4", "Data5"]).replace("UnitTime=ms", "UnitTime=s");
        text.replace("TimeDiff=20", &format!("TimeDiff={step}"))
    };
    let emed = |step: &str| {
        let page = |label| emed_header(label).replace("20.0 ms", &format!("{step} s")) + LEFT;
        page(1) + &page(2)
    };
    for (step, expected) in [
        ("0.02", Some(0.02)),
        ("0.0200000000004", Some(0.02)),
        ("0.0000000001", None),
        ("10000000000", None),
    ] {
        for text in [tekscan(step), zebris(step), emed(step)] {
            let found = recorded(text.as_bytes(), None);
            assert_eq!(error(&found), None, "{text}");
            assert_eq!(found.channels[0].seconds_per_frame, expected, "{text}");
            assert_eq!(found.frames[1].time, expected, "{text}");
        }
    }
}

#[test]
fn frames_that_are_left_out_are_gaps_in_time() {
    let tekscan = "DATA_TYPE MOVIE\nROWS 1\nCOLS 2\nSECONDS_PER_FRAME 0.02\nASCII_DATA @@\n\
                   Frame 1\n1,2\n\nFrame 3\n1,2\n\nFrame 5\n1,2\n\n@@\n";
    let emed: String = [1, 3, 5].map(|label| emed_header(label) + LEFT).concat();
    let zebris = zebris(&["Data1", "Data3", "Data5"]);
    for text in [tekscan, &emed, &zebris] {
        let found = recorded(text.as_bytes(), None);
        let times = found.frames.iter().map(|frame| (frame.label, frame.time));
        let expected = [(1, 0.0), (3, 0.04), (5, 0.08)];
        let expected = expected.map(|(label, time)| (Some(label), Some(time)));
        assert_eq!(times.collect::<Vec<_>>(), expected, "{text}");
    }
}

/// Returns the header of a page of emed.
fn emed_header(label: i64) -> String {
    format!(
        "\t\t\t\tPage 1\n\n\tFile: made up \tMatrix: 20x30\n\tSensor area: 1.00 cm2\tTime/picture:20.0 ms\n\
         \tSensor size: 1.000x1.000 cm\n\tPict-No.: {label}  Force[N]=sum*sensor_area in row/column\n\n"
    )
}

/// Returns two pages of a picture with three columns, and two pages of the next picture.
fn emed_pages(left: &str, right: &str) -> String {
    let pages = [(1, left), (1, right), (2, left), (2, right)];
    let page = |(label, window): (i64, &str)| format!("{}{window}\u{c}\n", emed_header(label));
    pages.map(page).concat()
}

const LEFT: &str = "\t7\t8\n4\t0.00\t20.00\n5\t30.00\t0.00\nForce\t3.00\t2.00\n";
const RIGHT: &str = "\t9\tForce\n4\t10.00\t3.00\n5\t0.00\t3.00\nForce\t1.00\t6.00\n";

#[test]
fn the_pages_of_a_picture_of_emed_are_one_frame() {
    let fixed = |text: &str| {
        let field = |field: &str| {
            if field == "0.00" {
                String::new()
            } else {
                field.to_owned()
            }
        };
        let line = |line: &str| -> String {
            line.split('\t')
                .map(|text| format!("{:>8}", field(text)))
                .collect()
        };
        text.lines()
            .map(|text| line(text) + "\n")
            .collect::<String>()
    };
    for text in [
        emed_pages(LEFT, RIGHT),
        emed_pages(&fixed(LEFT), &fixed(RIGHT)),
    ] {
        let found = recorded(text.as_bytes(), None);
        assert_eq!((error(&found), notes(&found).len()), (None, 0), "{text}");
        assert_eq!(channel_shape(&found.channels[0]), Some((2, 3)));
        let [first, second] = &found.frames[..] else {
            panic!("{} frames: {text}", found.frames.len());
        };
        assert_eq!(first.values(), [0.0, 20.0, 10.0, 30.0, 0.0, 0.0]);
        assert_eq!(
            (first.first, first.label),
            (Some(FirstCell { row: 4, column: 7 }), Some(1))
        );
        assert_eq!((second.label, second.time), (Some(2), Some(0.02)));
        // A picture is incomplete if its second page is damaged.
        let torn = text.rfind("Page").expect("a page") + 150;
        let cut = recorded(&text.as_bytes()[..torn], None);
        assert_eq!(cut.frames.len(), 1);
        assert!(cut.error.is_some());
        // A picture is also incomplete if its second page is missing.
        let between = text.rfind("\t\t\t\tPage").expect("a page");
        let cut = recorded(&text.as_bytes()[..between], None);
        assert_eq!(cut.frames.len(), 1);
        let message = error(&cut).expect("an error");
        assert!(
            message.ends_with("ends before the last page of a picture"),
            "{message}"
        );
    }
}

#[test]
fn the_header_of_emed_gives_the_pitch_and_the_time_of_a_picture() {
    let of = |from: &str, to: &str| {
        let first = emed_header(1).replace(from, to);
        let second = emed_header(2).replace(from, to);
        let found = recorded(
            format!("{first}{LEFT}\u{c}\n{second}{LEFT}").as_bytes(),
            None,
        );
        assert_eq!((error(&found), found.frames.len()), (None, 2), "{to}");
        (found.channels[0].pitch_mm, found.frames[1].time)
    };
    assert_eq!(of("", ""), (Some([10.0, 10.0]), Some(0.02)));
    let millimetres = of("1.000x1.000 cm", "5.0x7.5 mm");
    assert_eq!(millimetres, (Some([5.0, 7.5]), Some(0.02)));
    let seconds = of("20.0 ms", "0.5 s");
    assert_eq!(seconds, (Some([10.0, 10.0]), Some(0.5)));
    // 0 means that there is no time.
    assert_eq!(of("20.0 ms", "0.0 ms"), (Some([10.0, 10.0]), None));
    // Only the word after a number is its unit.
    let comments = of("20.0 ms", "2 s\tProgrammer: Simms");
    assert_eq!(comments, (Some([10.0, 10.0]), Some(2.0)));
    let comments = of("1.000 cm\n", "1.000 cm\tHammer, 3 mm\n");
    assert_eq!(comments, (Some([10.0, 10.0]), Some(0.02)));
}

#[test]
fn a_window_of_emed_beyond_the_sensor_is_noted() {
    for (matrix, expected) in [
        ("8x5", None),
        (
            "8x4",
            Some("ends in row 5 and column 8, but the sensor has 4 rows and 8 columns"),
        ),
        (
            "7x5",
            Some("ends in row 5 and column 8, but the sensor has 5 rows and 7 columns"),
        ),
    ] {
        let text = emed_header(1).replace("20x30", matrix) + LEFT;
        let found = recorded(text.as_bytes(), None);
        assert_eq!((error(&found), found.frames.len()), (None, 1), "{matrix}");
        let expected = expected.map(|text| format!("frame 0 (label 1): its window {text}"));
        assert_eq!(notes(&found), Vec::from_iter(expected), "{matrix}");
    }
}

#[test]
fn a_picture_of_emed_without_rows_is_damaged() {
    let header = emed_header(1).replace("  Force[N]=sum*sensor_area in row/column", "");
    let found = recorded(format!("{header}\t7\t8\n\n").as_bytes(), None);
    assert_eq!(found.frames.len(), 0);
    let expected = "line 9: the picture ends here, expected more rows, then their Force";
    assert_eq!(error(&found).as_deref(), Some(expected));
}

#[test]
fn every_force_of_emed_is_checked() {
    let window =
        "\t7\t8\tForce\n4\t0.00\t20.00\t2.00\n5\t30.00\t0.00\t3.00\nForce\t3.00\t2.00\t5.00\n";
    let read = |window: &str| recorded((emed_header(1) + window).as_bytes(), None);
    assert_eq!(notes(&read(window)), [""; 0]);
    for (from, to, what) in [
        (
            "20.00\t2.00",
            "20.00\t2.50",
            "the force of a row should be 2.5, but the values give 2",
        ),
        (
            "3.00\t2.00\t5",
            "4.00\t2.00\t5",
            "the force of a column should be 4, but the values give 3",
        ),
        (
            "2.00\t5.00",
            "2.00\t7.00",
            "the force of all cells should be 7, but the values give 5",
        ),
        // Each sum is rounded, and the sum of the sums as well, so a small difference is allowed.
        (
            "2.00\t5.00",
            "2.00\t5.02",
            "the force of all cells should be 5.02, but the values give 5",
        ),
    ] {
        let found = read(&window.replace(from, to));
        assert_eq!(error(&found), None);
        assert_eq!(notes(&found), [format!("frame 0 (label 1): {what}")]);
    }
    // The force of this row is not exact in binary.
    let note = &notes(&read(&window.replace("20.00\t2.00", "2.80\t9.00")))[0];
    let expected = "the force of a row should be 9, but the values give 0.28";
    assert!(note.ends_with(expected), "{note}");
    let rounded = read(&window.replace("2.00\t5.00", "2.00\t5.01"));
    assert_eq!(notes(&rounded), [""; 0]);
    // All values are there, but not all forces.
    let found = read(window.trim_end().trim_end_matches("\t5.00"));
    assert_eq!(found.frames.len(), 1);
    let expected = "line 11: found 3 values, expected 4";
    assert_eq!(error(&found).as_deref(), Some(expected));
    // The next page has no number, or no values.
    for end in [emed_header(2).find("File"), emed_header(2).find("Force")] {
        let header = &emed_header(2)[..end.expect("it is there")];
        let found = read(&format!("{window}\u{c}\n{header}"));
        assert_eq!(found.frames.len(), 1);
        let message = error(&found).expect("an error");
        assert!(
            message.ends_with("ends before the values of a picture"),
            "{message}"
        );
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
    let half_days = recorded(xsensor(["11:59:59.9 AM", "12:00:00.4 PM"]).as_bytes(), None);
    assert_eq!(frames(&half_days, 1), frames(&whole, 1));
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
    let of = |dates: [&str; 2], clocks: [&str; 2]| {
        let mut text = xsensor(clocks);
        for date in dates {
            text = text.replacen("Date, 2022 Aug 16", date, 1);
        }
        let found = recorded(text.as_bytes(), None);
        assert_eq!((error(&found), notes(&found).len()), (None, 0), "{dates:?}");
        found.frames[2].time
    };
    let midnight = ["23:59:59.5", "00:00:00.5"];
    let halves = ["11:59:59.500 PM", "01:00:00.500 AM"];
    for dates in [
        ["Date, 2022 Aug 31", "Date, 2022 Sep 1"],
        ["Date, 8/31/2022", "Date, 9/1/2022"],
        ["Date, 31.08.2022", "Date, 01.09.2022"],
        // Dates that cannot be read, and none.
        ["Date, the last", "Date, the first"],
        ["", ""],
    ] {
        assert_eq!(of(dates, midnight), Some(1.0), "{dates:?}");
        assert_eq!(of(dates, halves), Some(3601.0), "{dates:?}");
    }
    let later = of(
        ["Date, 8/31/2022", "Date, 9/1/2022"],
        ["10:00:00", "11:00:00"],
    );
    assert_eq!(later, Some(90_000.0));
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

/// Returns an export of XSENSOR with one sensor and two groups in each of two frames.
fn xsensor_with_groups() -> String {
    let mut text = String::new();
    for label in [7, 8] {
        let sensor = "SENSOR,left\nRows,1\nColumns,2\nSENSELS\n1.5,2\n";
        let groups =
            "GROUP,1\nName,heel\nCells,3\nSENSELS\n1,2,,\n3,,\nGROUP,2\nCells,1\nSENSELS\n4\n";
        write!(text, "FRAME,{label}\n{sensor}{groups}").expect("a text");
    }
    text
}

#[test]
fn an_xsensor_export_that_ends_inside_a_group_is_reported_as_damaged() {
    let text = xsensor_with_groups();
    let whole = recorded(text.as_bytes(), None);
    assert_eq!((error(&whole), whole.frames.len()), (None, 2));
    let last = |part: &str| text.rfind(part).expect("it occurs");
    for (end, expected) in [
        (
            last("3,,"),
            "ends inside a GROUP block, found 2 values, expected 3 as Cells says",
        ),
        (
            last("4\n"),
            "ends inside a GROUP block, found 0 values, expected 1 as Cells says",
        ),
        (
            last("SENSELS"),
            "ends inside a GROUP block, expected Cells and SENSELS",
        ),
        (last("GROUP,2"), "ends inside a FRAME, expected GROUP"),
        (last("GROUP,1"), "ends inside a FRAME, expected GROUP"),
    ] {
        let found = recorded(&text.as_bytes()[..end], None);
        assert_eq!(found.frames.len(), 2, "{expected}");
        let message = error(&found).expect("an error");
        assert!(message.ends_with(expected), "{message}");
    }
    // Groups without lists may be those of another version.
    let shorter = text
        .replace("SENSELS\n1,2,,\n3,,\n", "")
        .replace("SENSELS\n4\n", "");
    let found = recorded(shorter.as_bytes(), None);
    assert_eq!((error(&found), found.frames.len()), (None, 2));
}

#[test]
fn both_sheets_of_popu_are_channels() {
    let text = "{\"id\":\"4\",\"tactilus_columns\":2,\"tactilus_rows\":1,\"sensomatt_columns\":1,\"sensomatt_rows\":3,\
                \"snapshots\":{\"0\":{\"tactilus_readings\":[1,2],\"sensomatt_readings\":[3,4,5]},\
                \"7\":{\"sensomatt_readings\":[6,7,8],\"tactilus_readings\":[9,0]},\"8\":{\"tactilus_readings\":[8,8]}}}";
    let found = recorded(text.as_bytes(), None);
    assert_eq!(error(&found), None);
    let channels = found.channels.iter();
    let channels: Vec<_> = channels
        .map(|info| (info.name.as_deref(), channel_shape(info)))
        .collect();
    assert_eq!(
        channels,
        [
            (Some("tactilus"), Some((1, 2))),
            (Some("sensomatt"), Some((3, 1)))
        ]
    );
    assert_eq!(
        frames(&found, 0),
        [
            (Some(0), None, 1.0),
            (Some(7), None, 9.0),
            (Some(8), None, 8.0)
        ]
    );
    assert_eq!(
        frames(&found, 1),
        [(Some(0), None, 3.0), (Some(7), None, 6.0)]
    );
    let found = recorded(
        text.replace("\"8\":{\"tactilus", "\"8\":{\"other")
            .as_bytes(),
        None,
    );
    assert_eq!(found.frames.len(), 4);
    let message = error(&found).expect("an error");
    assert!(
        message.contains("a snapshot without tactilus_readings or sensomatt_readings"),
        "{message}"
    );
}

#[test]
fn the_sums_in_the_sample_are_right() {
    assert_eq!(notes(&recorded(&sample("emed.lst"), None)), [""; 0]);
}
