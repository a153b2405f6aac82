//! Lines that `ros2 topic echo` prints between messages, and layouts with an offset.

use super::{channel_shape, recorded};

const NOTICE: &str = "A message was lost!!!\n\ttotal count change:1\n\ttotal count: 1---\n";

#[test]
fn notices_between_messages_are_skipped() {
    let messages = [
        "array('H', [1, 2, 3, 4])\n---\n",
        "array('H', [5, 6, 7, 8])\n---\n",
    ];
    for text in [
        format!("{NOTICE}{}", messages.concat()),
        format!("{}{NOTICE}{}", messages[0], messages[1]),
        format!(
            "\nWARNING: topic [/pad] does not appear to be published yet\n{}",
            messages.concat()
        ),
    ] {
        let found = recorded(text.as_bytes(), Some((2, 2)));
        assert_eq!(found.format, Some("ros2"), "{text}: {:?}", found.error);
        let firsts: Vec<f64> = found.frames.iter().map(|frame| frame.values()[0]).collect();
        assert_eq!(firsts, [1.0, 5.0], "{text}");
    }
}

#[test]
fn values_before_the_offset_of_a_layout_are_not_cells() {
    let text = "layout:\n  dim:\n  - label: rows\n    size: 2\n    stride: 4\n  - label: columns\n    size: 2\n    \
                stride: 2\n  data_offset: 1\ndata:\n- 99\n- 1\n- 2\n- 3\n- 4\n---\n";
    let found = recorded(text.as_bytes(), None);
    assert!(found.error.is_none(), "{:?}", found.error);
    assert_eq!(found.frames[0].values(), [1.0, 2.0, 3.0, 4.0]);
}

#[test]
fn an_array_may_continue_with_a_negative_number() {
    for text in [
        "data: [1, 2,\n-3, 4]\n---\n",
        "data: [1, 2\n, -3,\n  -4\n]\n---\n",
    ] {
        let found = recorded(text.as_bytes(), Some((2, 2)));
        assert!(found.error.is_none(), "{text}: {:?}", found.error);
        assert_eq!(found.frames[0].values()[2], -3.0, "{text}");
    }
}

#[test]
fn a_second_array_in_a_message_is_a_missing_end() {
    for (text, line) in [
        ("array('H', [1, 2])\narray('H', [3, 4])\n", 2),
        ("array('H', [1, 2,\narray('H', [3, 4])\n---\n", 2),
        ("data:\n- 1\n- 2\ndata:\n- 3\n- 4\n---\n", 4),
    ] {
        for shape in [(1, 2), (2, 2)] {
            let found = recorded(text.as_bytes(), Some(shape));
            let error = found.error.map(|error| error.to_string());
            let expected = format!("line {line}: found another array, expected '---' before it");
            assert_eq!((found.frames.len(), error), (0, Some(expected)), "{text}");
        }
    }
}

#[test]
fn given_rows_and_columns_replace_a_layout_with_the_same_number_of_cells() {
    let text = b"layout:\n  dim:\n  - label: a\n    size: 1\n  - label: b\n    size: 4\ndata: [1, 2, 3, 4]\n---\n";
    for (named, found) in [
        (None, (1, 4)),
        (Some((2, 2)), (2, 2)),
        (Some((2, 3)), (1, 4)),
    ] {
        let read = recorded(text, named);
        assert_eq!(
            channel_shape(&read.channels[0]),
            Some(found),
            "{:?}",
            read.error
        );
    }
}

#[test]
fn messages_that_change_their_size_are_reported_as_damage() {
    let text = b"layout:\n  dim:\n  - label: a\n    size: 2\n  - label: b\n    size: 2\ndata: [1, 2, 3, 4]\n---\n\
                 layout:\n  dim:\n  - label: a\n    size: 1\n  - label: b\n    size: 2\ndata: [5, 6]\n---\n";
    let found = recorded(text, None);
    let error = found.error.map(|error| error.to_string());
    let expected = "line 16: found 1 row of 2, expected 2 of 2 as before";
    assert_eq!((found.frames.len(), error.as_deref()), (1, Some(expected)));
}
