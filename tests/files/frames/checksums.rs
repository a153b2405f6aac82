//! Archives and MCAP files in which a byte has another value than was written, but which are whole otherwise.

use taxel::frame::Frame;

use super::samples::sample;
use super::{Recorded, recorded};

/// What is read of `bytes` after the byte at `index` was changed.
fn with_another_byte(bytes: &[u8], index: usize) -> Recorded {
    let mut bytes = bytes.to_vec();
    bytes[index] ^= 0x40;
    recorded(&bytes, Some((4, 5)))
}

/// The values of the first two frames.
fn first_two(found: &Recorded) -> Vec<&[f64]> {
    found.frames[..2].iter().map(Frame::values).collect()
}

/// Where `part` is.
fn position(bytes: &[u8], part: &[u8]) -> usize {
    let mut windows = bytes.windows(part.len());
    windows
        .position(|window| window == part)
        .expect("it is there")
}

fn error(found: &Recorded) -> Option<String> {
    found.error.as_ref().map(ToString::to_string)
}

/// An archive with one entry that is not compressed, and its CRC-32.
fn archive(name: &str, content: &[u8]) -> Vec<u8> {
    let length = u32::try_from(content.len()).expect("short").to_le_bytes();
    let sizes = [&crc32(content).to_le_bytes()[..], &length, &length].concat();
    let name_length = [u8::try_from(name.len()).expect("short"), 0];
    // Version, flags, method, time and date.
    let common = [
        &[20, 0, 0, 0, 0, 0, 0, 0, 0x21, 0][..],
        &sizes,
        &name_length,
        &[0, 0],
    ]
    .concat();
    let entry = [&b"PK\x03\x04"[..], &common[..], name.as_bytes(), content].concat();
    let directory = [
        &b"PK\x01\x02\x14\x00"[..],
        &common[..],
        &[0; 14],
        name.as_bytes(),
    ]
    .concat();
    let number = |length: usize| u32::try_from(length).expect("short").to_le_bytes();
    let end = [
        &b"PK\x05\x06\0\0\0\0\x01\0\x01\0"[..],
        &number(directory.len()),
        &number(entry.len()),
        &[0, 0],
    ];
    [entry, directory, end.concat()].concat()
}

fn crc32(bytes: &[u8]) -> u32 {
    let step = |sum: u32, _| (sum >> 1) ^ if sum & 1 == 1 { 0xedb8_8320 } else { 0 };
    let sum = bytes.iter().fold(u32::MAX, |sum, byte| {
        (0..8).fold(sum ^ u32::from(*byte), step)
    });
    !sum
}

#[test]
fn an_array_whose_checksum_does_not_hold_is_a_damage() {
    let array = sample("u2.npy");
    let bytes = archive("pad.npy", &array);
    let whole = recorded(&bytes, None);
    assert_eq!((whole.frames.len(), error(&whole)), (3, None));
    let last = position(&bytes, &array) + array.len() - 1;
    let damaged = with_another_byte(&bytes, last);
    assert_eq!(first_two(&damaged), first_two(&whole));
    let expected = "pad: the array is damaged, so some of its values may be wrong";
    assert_eq!(error(&damaged).as_deref(), Some(expected));
    // Behind the last frame.
    let longer = recorded(&archive("pad.npy", &[&array[..], &[7]].concat()), None);
    let expected = "pad: more bytes than 3 frames of the header take";
    assert_eq!(
        (longer.frames.len(), error(&longer).as_deref()),
        (3, Some(expected))
    );
}
