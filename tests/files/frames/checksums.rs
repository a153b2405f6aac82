//! Archives and MCAP files that are complete, except that one byte was changed.

use taxel_core::frame::Frame;

use super::samples::sample;
use super::{Recorded, channel_shape, recorded};
use crate::hostile::malice::packed::{Packing, Zip};

/// Reads `bytes` after the byte at `index` was changed.
fn with_another_byte(bytes: &[u8], index: usize) -> Recorded {
    let mut bytes = bytes.to_vec();
    bytes[index] ^= 0x40;
    recorded(&bytes, Some((4, 5)))
}

/// Returns the values of the first two frames.
fn first_two(found: &Recorded) -> Vec<&[f64]> {
    found.frames[..2].iter().map(Frame::values).collect()
}

/// Returns the position of `part`.
fn position(bytes: &[u8], part: &[u8]) -> usize {
    let mut windows = bytes.windows(part.len());
    windows
        .position(|window| window == part)
        .expect("it is there")
}

fn error(found: &Recorded) -> Option<String> {
    found.error.as_ref().map(ToString::to_string)
}

/// Returns an archive with one uncompressed entry and its checksum.
fn archive(name: &str, content: &[u8]) -> Vec<u8> {
    let zip = Zip::default().with(name, Packing::Stored, content, content.len() as u64);
    zip.finish()
}

#[test]
fn a_wrong_checksum_of_an_array_is_reported_as_damage() {
    let array = sample("u2.npy");
    let bytes = archive("pad.npy", &array);
    let whole = recorded(&bytes, None);
    assert_eq!((whole.frames.len(), error(&whole)), (3, None));
    let last = position(&bytes, &array) + array.len() - 1;
    let damaged = with_another_byte(&bytes, last);
    assert_eq!(first_two(&damaged), first_two(&whole));
    let expected = "array \"pad\" is damaged";
    assert_eq!(error(&damaged).as_deref(), Some(expected));
    // A part of the archive is missing, as after a download that broke off: its list of contents is gone.
    for length in [30, 100, bytes.len() - 1] {
        let cut = recorded(&bytes[..length], None);
        let expected = "an archive that is cut short or damaged, or a file of another kind";
        assert_eq!(
            (cut.frames.len(), error(&cut).as_deref()),
            (0, Some(expected))
        );
    }
    // A byte after the last frame.
    let longer = recorded(&archive("pad.npy", &[&array[..], &[7]].concat()), None);
    let expected = "array \"pad\": more bytes than the header states for 3 frames";
    assert_eq!(
        (longer.frames.len(), error(&longer).as_deref()),
        (3, Some(expected))
    );
}

/// A record of an MCAP file.
fn record(kind: u8, content: &[u8]) -> Vec<u8> {
    [&[kind][..], &(content.len() as u64).to_le_bytes(), content].concat()
}

/// Returns a text preceded by its length.
fn text(text: &str) -> Vec<u8> {
    let length = u32::try_from(text.len()).expect("short");
    [&length.to_le_bytes()[..], text.as_bytes()].concat()
}

/// Returns a file with three frames of 1 × 2 bytes. A checksum is computed if its argument is 1.
fn mcap(of_chunk: u32, of_data: u32) -> Vec<u8> {
    let array = |value: u8| [&[0; 8][..], &[2, 0, 0, 0, value, value]].concat();
    mcap_of(&[1, 2, 3].map(array), of_chunk, of_data)
}

/// Returns a file with these arrays, each with its layout.
fn mcap_of(arrays: &[Vec<u8>], of_chunk: u32, of_data: u32) -> Vec<u8> {
    let schema = [
        &[1, 0][..],
        &text("std_msgs/msg/UInt8MultiArray"),
        &text("ros2msg"),
    ]
    .concat();
    let channel = [&[1, 0, 1, 0][..], &text("/pad"), &text("cdr"), &[0; 4]].concat();
    let mut records = [record(3, &schema), record(4, &channel)].concat();
    for array in arrays {
        let cdr = [&[0, 1, 0, 0][..], array].concat();
        records.extend(record(5, &[&[1, 0][..], &[0; 20], &cdr].concat()));
    }
    let length = (records.len() as u64).to_le_bytes();
    let sum = (of_chunk * crc32fast::hash(&records)).to_le_bytes();
    let head = [&[0; 16][..], &length, &sum, &[0; 4], &length].concat();
    let magic = b"\x89MCAP0\r\n";
    let chunk = record(6, &[head, records].concat());
    let data = [
        &magic[..],
        &record(1, &[&text("ros2")[..], &text("")].concat()),
        &chunk,
    ]
    .concat();
    let sum = (of_data * crc32fast::hash(&data)).to_le_bytes();
    [data, record(15, &sum), record(2, &[0; 20]), magic.to_vec()].concat()
}

/// Returns an array of ones, with a layout of dimensions of these sizes.
fn laid_out(sizes: &[u8]) -> Vec<u8> {
    let dimension = |&size: &u8| [1, 0, 0, 0, 0, 0, 0, 0, size, 0, 0, 0, 0, 0, 0, 0];
    let dimensions: Vec<u8> = sizes.iter().flat_map(dimension).collect();
    let count = u8::try_from(sizes.len()).expect("few");
    let (offset, cells) = ([0; 4], sizes.iter().product::<u8>());
    let values = [vec![cells, 0, 0, 0], vec![1; cells.into()]].concat();
    [&[count, 0, 0, 0][..], &dimensions, &offset, &values].concat()
}

#[test]
fn given_rows_and_columns_replace_a_layout_with_the_same_number_of_cells() {
    let bytes = mcap_of(&[laid_out(&[1, 20]), laid_out(&[1, 20])], 0, 0);
    for (named, found) in [
        (None, (1, 20)),
        (Some((4, 5)), (4, 5)),
        (Some((3, 5)), (1, 20)),
    ] {
        let read = recorded(&bytes, named);
        assert_eq!((read.frames.len(), error(&read)), (2, None));
        assert_eq!(channel_shape(&read.channels[0]), Some(found));
        let sizes = (read.frames[1].rows(), read.frames[1].columns());
        assert_eq!(sizes, found);
    }
}

#[test]
fn dimensions_of_size_1_after_rows_and_columns_do_not_count() {
    for sizes in [&[2, 2][..], &[2, 2, 1], &[2, 2, 1, 1]] {
        let mcap = recorded(&mcap_of(&[laid_out(sizes)], 0, 0), None);
        let dimensions = sizes
            .iter()
            .map(|size| format!("  - label: ''\n    size: {size}\n"));
        let dimensions: String = dimensions.collect();
        let echo = format!("layout:\n  dim:\n{dimensions}data: [1, 1, 1, 1]\n---\n");
        let echo = recorded(echo.as_bytes(), None);
        for found in [mcap, echo] {
            assert_eq!((error(&found), found.frames.len()), (None, 1), "{sizes:?}");
            assert_eq!(channel_shape(&found.channels[0]), Some((2, 2)), "{sizes:?}");
        }
    }
}

#[test]
fn a_channel_whose_frames_change_their_size_is_reported_as_damaged() {
    let bytes = mcap_of(
        &[[4, 5], [3, 5], [4, 5]].map(|sizes| laid_out(&sizes)),
        0,
        0,
    );
    let read = recorded(&bytes, None);
    let expected = "/pad: found 3 rows of 5, expected 4 of 5 as before";
    assert_eq!(
        (read.frames.len(), error(&read).as_deref()),
        (1, Some(expected))
    );
}

#[test]
fn a_wrong_checksum_of_a_chunk_or_a_file_is_reported_as_damage() {
    let of_chunk = "the checksum of a chunk does not hold, so a message in it is damaged";
    let of_data = "the checksum of the file does not hold, so a message in it is damaged";
    for (sums, expected) in [
        ((1, 1), Some(of_chunk)),
        ((1, 0), Some(of_chunk)),
        ((0, 1), Some(of_data)),
        // With 0, no checksum was computed.
        ((0, 0), None),
    ] {
        let bytes = mcap(sums.0, sums.1);
        let whole = recorded(&bytes, Some((1, 2)));
        assert_eq!((whole.frames.len(), error(&whole)), (3, None));
        let mut damaged = bytes.clone();
        let last = position(&bytes, &[2, 0, 0, 0, 3, 3]) + 5;
        damaged[last] ^= 0x40;
        let damaged = recorded(&damaged, Some((1, 2)));
        assert_eq!(first_two(&damaged), first_two(&whole));
        assert_eq!(error(&damaged).as_deref(), expected, "{sums:?}");
    }
}
