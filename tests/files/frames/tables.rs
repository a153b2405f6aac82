//! Tables as various programs write them.

use taxel::frame::Frame;

use super::{Recorded, recorded};

/// Label, time and values of each frame of a table.
fn frames(text: &str, shape: Option<(u16, u16)>) -> Vec<(Option<i64>, Option<f64>, Vec<f64>)> {
    let found = recorded(text.as_bytes(), shape);
    assert!(found.error.is_none(), "{text}: {:?}", found.error);
    let parts = |frame: &Frame| (frame.label, frame.time, frame.values().to_vec());
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
fn of_one_line_with_two_numbers_more_nothing_says_where_they_are() {
    let unclear =
        "line 1: 2 numbers more than the 4 cells, before or behind them: name the columns";
    for text in ["17,0.25,1,2,3,4\n", "1,2,3,4,17,40\n"] {
        let found = recorded(text.as_bytes(), Some((2, 2)));
        assert!(error(&found).starts_with(unclear), "{text}");
    }
    // A number that counts frames has no fraction.
    let text = "1.5,2.5,3,4,17,40\n";
    assert_eq!(values(text, Some((2, 2))), [[1.5, 2.5, 3.0, 4.0]]);
}

#[test]
fn the_letters_of_names_say_which_number_is_the_column() {
    let text = "c0r0,c1r0,c2r0,c0r1,c1r1,c2r1\n1,2,3,4,5,6\n";
    let found = recorded(text.as_bytes(), None);
    assert_eq!(found.channels[0].shape, Some((2, 3)));
    assert_eq!(found.frames[0].values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
}

#[test]
fn a_separator_in_quotes_is_part_of_a_field() {
    let text = "time,\"(0,0)\",\"(0,1)\",\"(1,0)\",\"(1,1)\"\n1,1,2,3,4\n";
    assert_eq!(values(text, None), [[1.0, 2.0, 3.0, 4.0]]);
    // A quote that is not closed is a letter.
    let text = "time,width 5\",r0c0,r0c1\n1,0.5,1,2\n";
    assert_eq!(values(text, None), [[1.0, 2.0]]);
}
