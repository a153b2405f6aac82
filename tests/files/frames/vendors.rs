//! What programs of vendors write in some versions or settings, made up here.

use std::fmt::Write;

use taxel::frame::Frame;

use super::{Recorded, recorded};

fn error(found: &Recorded) -> Option<String> {
    found.error.as_ref().map(ToString::to_string)
}

fn notes(found: &Recorded) -> Vec<String> {
    found.notes.iter().map(ToString::to_string).collect()
}

/// Label, time and first value of each frame of a channel.
fn frames(found: &Recorded, channel: usize) -> Vec<(Option<i64>, Option<f64>, f64)> {
    let own = found.frames.iter().filter(|frame| frame.channel == channel);
    let parts = |frame: &Frame| (frame.label, frame.time, frame.values()[0]);
    own.map(parts).collect()
}

/// A zebris file with a section for each name; its number is its first value.
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
fn numbered_pictures_of_zebris_are_frames_and_their_maximum_is_none() {
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
    // Alone, it is the picture.
    let found = recorded(zebris(&["Data"]).as_bytes(), None);
    assert_eq!(frames(&found, 0), [(Some(1), None, 1.0)]);
    assert_eq!((error(&found), notes(&found).len()), (None, 0));
    // Cut off between two pictures, and inside of one.
    let found = recorded(zebris(&["Data4", "Data5"]).as_bytes(), None);
    let cut = "the file was cut off: it has 2 of the 3 frames that its header counts";
    assert_eq!(
        (found.frames.len(), notes(&found)),
        (2, vec![cut.to_owned()])
    );
    let found = recorded(&text.as_bytes()[..text.len() - 6], None);
    assert_eq!(found.frames.len(), 2);
    assert!(error(&found).is_some_and(|error| error.ends_with("expected 2 lines of values")));
}

#[test]
fn the_last_unit_of_tekscan_counts_and_metres_are_a_length() {
    let text = "DATA_TYPE MOVIE\nROWS 1\nCOLS 2\nROW_SPACING 1.27e-003 meters\nCOL_SPACING 1.27 mm\n\
                COMMENTS the pad\nUNITS kPa\nROWS 9\nUNITS raw\nASCII_DATA @@\nFrame 1\n1,2\n\n@@\n";
    let found = recorded(text.as_bytes(), None);
    assert_eq!((error(&found), found.frames.len()), (None, 1));
    let info = &found.channels[0];
    assert_eq!(info.unit.as_deref(), Some("raw"));
    assert_eq!(
        (info.pitch_mm, info.shape),
        (Some([1.27, 1.27]), Some((1, 2)))
    );
}
