//! Archives of numpy arrays that end early, as after a download that broke off.

use std::io::{Cursor, Write};

use taxel::frame::Frame;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::samples::sample;
use super::{Recorded, recorded};

/// The error for an archive without a directory.
const CUT: &str = "an archive that is cut short or damaged";

/// Returns an archive of these arrays, without compression.
fn archive(arrays: &[(&str, &[u8])]) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, array) in arrays {
        archive.start_file(*name, options).expect("begun");
        archive.write_all(array).expect("written");
    }
    archive.finish().expect("finished").into_inner()
}

/// Returns an array of that type, shape and content.
fn array(kind: &str, shape: &str, numbers: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({shape}), }}\n");
    let length = u16::try_from(header.len()).expect("short").to_le_bytes();
    [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), numbers].concat()
}

fn values(found: &Recorded) -> Vec<&[f64]> {
    found.frames.iter().map(Frame::values).collect()
}

fn times(found: &Recorded) -> Vec<Option<f64>> {
    found.frames.iter().map(|frame| frame.time).collect()
}

fn error(found: &Recorded) -> Option<String> {
    found.error.as_ref().map(ToString::to_string)
}

#[test]
fn whole_frames_before_a_cut_are_reported_then_the_error() {
    let pad = array("|u1", "9, 1, 2", &(0..18).collect::<Vec<u8>>());
    let bytes = archive(&[("pad.npy", &pad)]);
    let whole = recorded(&bytes, None);
    assert_eq!((whole.frames.len(), error(&whole)), (9, None));
    let start = bytes.windows(pad.len()).position(|window| window == pad);
    let numbers = start.expect("it is there") + pad.len() - 18;
    for length in 30..bytes.len() {
        let cut = recorded(&bytes[..length], None);
        let frames = (length.saturating_sub(numbers) / 2).min(9);
        assert_eq!(values(&cut), values(&whole)[..frames], "{length} bytes");
        assert_eq!(error(&cut).as_deref(), Some(CUT), "{length} bytes");
    }
}

#[test]
fn a_compressed_array_is_read_up_to_the_cut() {
    let bytes = sample("touch.npz");
    let whole = recorded(&bytes, None);
    let times_start = bytes.windows(8).position(|window| window == b"t_ns.npy");
    let times_start = times_start.expect("it is there");
    let mut most = 0;
    for length in 30..times_start {
        let cut = recorded(&bytes[..length], None);
        let frames = cut.frames.len();
        assert!(frames >= most, "{length} bytes");
        most = frames;
        assert_eq!(values(&cut), values(&whole)[..frames], "{length} bytes");
        assert_eq!(error(&cut).as_deref(), Some(CUT), "{length} bytes");
    }
    assert_eq!(most, whole.frames.len());
}

#[test]
fn frames_are_reported_even_if_their_times_are_cut_off_or_damaged() {
    let pad = array("|u1", "2, 1, 2", &[1, 2, 3, 4]);
    let seconds = [0.0_f64, 0.25].map(f64::to_le_bytes).concat();
    let bytes = archive(&[("pad.npy", &pad), ("t.npy", &array("<f8", "2", &seconds))]);
    let whole = recorded(&bytes, None);
    assert_eq!(times(&whole), [Some(0.0), Some(0.25)]);
    let position = bytes.windows(16).position(|window| window == seconds);
    let last = position.expect("it is there") + 15;
    // Times that are all there stay, without a directory, too.
    let cut = recorded(&bytes[..=last], None);
    assert_eq!(
        (times(&cut), error(&cut)),
        (times(&whole), Some(CUT.into()))
    );
    let cut = recorded(&bytes[..last], None);
    assert_eq!(
        (times(&cut), error(&cut)),
        (vec![None; 2], Some(CUT.into()))
    );
    assert_eq!(values(&cut), values(&whole));
    let mut damaged = bytes.clone();
    damaged[last] ^= 1;
    let damaged = recorded(&damaged, None);
    assert_eq!(
        (times(&damaged), values(&damaged)),
        (vec![None; 2], values(&whole))
    );
    let expected = "t: the array is damaged, so some of its values may be wrong";
    assert_eq!(error(&damaged).as_deref(), Some(expected));
}

#[test]
fn arrays_before_a_damaged_one_are_reported() {
    let pad = array("|u1", "2, 1, 2", &[1, 2, 3, 4]);
    let bytes = archive(&[("left.npy", &pad), ("right.npy", b"\x93NUMPY\x01")]);
    let found = recorded(&bytes, None);
    assert_eq!(values(&found), [[1.0, 2.0], [3.0, 4.0]]);
    let expected = "right: not a numpy array: expected a header of version 1 to 3";
    assert_eq!(error(&found).as_deref(), Some(expected));
}

#[test]
fn an_archive_that_is_cut_before_its_frames_is_not_called_one_without_frames() {
    let times = array("<f8", "3,", &[0; 24]);
    let pad = array("|u1", "3, 1, 2", &[1; 6]);
    let bytes = archive(&[("time.npy", &times), ("pad.npy", &pad)]);
    let whole = archive(&[("time.npy", &times)]);
    let second = bytes
        .windows(4)
        .skip(1)
        .position(|window| window == b"PK\x03\x04");
    let second = second.expect("a second header") + 1;
    for length in [second - 1, second, second + 10] {
        let cut = recorded(&bytes[..length], None);
        assert_eq!(error(&cut).as_deref(), Some(CUT), "{length} bytes");
    }
    let message = error(&recorded(&whole, None)).expect("no frames");
    assert!(
        message.starts_with("no array of two or three axes"),
        "{message}"
    );
}
