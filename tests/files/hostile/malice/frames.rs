//! Malicious recordings and streams: endless lines and markers, false sizes, countless channels.

use super::packed::{Packing, Zip, zeros_after};
use super::{Malice, SIZE, filled, numbered, repeated};

/// Returns a numpy array with this header, followed by `content`.
fn array(header: &str, content: &[u8]) -> Vec<u8> {
    let length = u16::try_from(header.len()).expect("short");
    let start = [&b"\x93NUMPY\x01\0"[..], &length.to_le_bytes()].concat();
    [&start, header.as_bytes(), content].concat()
}

/// Returns the array filled up with zeros.
fn long_array(header: &str) -> Vec<u8> {
    let mut array = array(header, &[]);
    array.resize(SIZE, 0);
    array
}

/// Returns a header with this kind of numbers, order and shape.
fn shaped(kind: &str, fortran: &str, shape: &str) -> String {
    format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
}

/// Returns an archive of as many arrays as are read.
fn terabytes() -> Vec<u8> {
    let one = array(
        &shaped("<f8", "False", "(1000000000000, 1, 1)"),
        &[0; SIZE / 300],
    );
    let zip = (0..256).fold(Zip::default(), |zip, number| {
        zip.with(&format!("{number}.npy"), Packing::Stored, &one, 8 << 40)
    });
    zip.finish()
}

/// Endless texts of a few formats; the fuzz targets find the rest.
const TEXTS: [Malice; 9] = [
    ("deep JSON", || filled("{\"frame\":", "[", "")),
    ("a long row of JSON", || {
        filled("{\"frame\":[[", "1,", "1]]}\n")
    }),
    ("many rows of JSON", || {
        filled("{\"frame\":[", "[1],", "[1]]}\n")
    }),
    ("a large frame of Tekscan", || {
        filled(
            "DATA_TYPE MOVIE\nROWS 65535\nCOLS 65535\nASCII_DATA @@\nFrame 1\n",
            "1,",
            "",
        )
    }),
    ("sensors of XSENSOR", || {
        numbered("FRAME,1\nSENSOR,a\n", &|n| {
            format!("SENSOR,{n}\nRows,1\nColumns,1\nSENSELS\n1\n")
        })
    }),
    ("an element a line", || filled("data:\n", "- 1\n", "---\n")),
    ("columns far away", || {
        filled("t", ",r4294967295c4294967295", "\n1")
    }),
    ("many channels", || {
        numbered("t", &|n| format!(",a{n}_r0c0"))
    }),
    ("numbers in a line", || filled("1 1\n", "1 ", "\n")),
];

/// Bytes in the formats of recordings only.
const FILES: [Malice; 10] = [
    ("an array of more than all memory", || {
        long_array(&shaped("<f8", "False", "(18446744073709551615, 64, 64)"))
    }),
    ("an array in the other order", || {
        long_array(&shaped("<f8", "True", "(4000000, 4, 2)"))
    }),
    ("an array of many axes", || {
        let mut array = filled(
            "0123456789ab{'descr': '<f8', 'fortran_order': False, 'shape': (",
            "1, ",
            ")}\n",
        );
        array[..12].copy_from_slice(b"\x93NUMPY\x02\x00\xf4\xff\x0f\x00");
        array
    }),
    ("arrays that claim terabytes", terabytes),
    ("an array that unpacks to much", || {
        let frames = array(&shaped("<f8", "False", "(1000000000000, 64, 64)"), &[]);
        packed("a.npy", &frames)
    }),
    ("times that unpack to much", || {
        let start = |kind, shape| array(&shaped(kind, "False", shape), &[]);
        let times = zeros_after(&start("<f8", "(4194304,)"), SIZE - 2000);
        let frames = zeros_after(&start("|u1", "(4194304, 1, 1)"), 1000);
        Zip::default()
            .with("t.npy", Packing::Deflated, &times, 1 << 25)
            .with("a.npy", Packing::Deflated, &frames, 1 << 22)
            .finish()
    }),
    (super::UNPACKED, || {
        packed(
            "a.npy",
            &array(&shaped("<f8", "True", "(1000000, 8, 4)"), &[]),
        )
    }),
    ("a header that unpacks to much", || {
        packed(
            "a.npy",
            b"\x93NUMPY\x02\0\xff\xff\xff\xff{'descr': '<f8', 'shape': (",
        )
    }),
    ("many long headers", || {
        // Each entry unpacks to a mebibyte of spaces.
        let one = zeros_after(b"\x93NUMPY\x02\0\xf0\xff\x0f\0{'descr': [('a', '<f8", 3900);
        let zip = (0..250).fold(Zip::default(), |zip, number| {
            zip.with(&format!("{number}.npy"), Packing::Deflated, &one, 1 << 20)
        });
        zip.finish()
    }),
    ("entries that share their bytes", || {
        let one = zeros_after(b"\x93NUMPY", 1000);
        Zip::default()
            .with("a.npy", Packing::Deflated, &one, 1 << 20)
            .with_shared(10_000, &one)
            .finish()
    }),
];

/// Returns an archive with one entry: some bytes, followed by 158 zeros for each byte of the archive.
fn packed(name: &str, start: &[u8]) -> Vec<u8> {
    let content = zeros_after(start, SIZE - 1000);
    Zip::default()
        .with(name, Packing::Deflated, &content, 1 << 40)
        .finish()
}

/// A record of an MCAP file.
fn record(kind: u8, content: &[u8]) -> Vec<u8> {
    [&[kind][..], &(content.len() as u64).to_le_bytes(), content].concat()
}

/// A text of an MCAP file.
fn text(text: &str) -> Vec<u8> {
    let length = u32::try_from(text.len()).expect("short");
    [&length.to_le_bytes()[..], text.as_bytes()].concat()
}

/// Returns a topic with a number, for arrays of bytes.
pub(crate) fn topic(number: u16, name: &str) -> Vec<u8> {
    let id = number.to_le_bytes();
    record(
        4,
        &[&id[..], &[1, 0], &text(name), &text("cdr"), &text("")].concat(),
    )
}

/// Returns the beginning of an MCAP file whose first schema is an array of bytes.
pub(crate) fn mcap() -> Vec<u8> {
    let schema = [
        text("std_msgs/msg/UInt8MultiArray"),
        text("ros2msg"),
        text(""),
    ]
    .concat();
    [
        &b"\x89MCAP0\r\n"[..],
        &record(3, &[&[1, 0][..], &schema].concat()),
    ]
    .concat()
}

/// Returns a message of topic 1 with an array that claims this number of bytes.
fn message(claimed: u32) -> Vec<u8> {
    let data = [
        &[0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0][..],
        &claimed.to_le_bytes(),
        &[1],
    ]
    .concat();
    record(5, &[&[1, 0][..], &[0; 20], &data].concat())
}

/// Returns the head of a chunk: times, unpacked size, no checksum, compression, size.
fn chunk(unpacked: u64, packing: &str, content: &[u8]) -> Vec<u8> {
    let size = (content.len() as u64).to_le_bytes();
    let parts = [
        &[0; 16][..],
        &unpacked.to_le_bytes(),
        &[0; 4],
        &text(packing),
        &size,
        content,
    ];
    record(6, &parts.concat())
}

/// MCAP files.
const TOPICS: [Malice; 7] = [
    ("a record of exabytes", || {
        repeated(
            &[mcap(), vec![5], u64::MAX.to_le_bytes().to_vec()].concat(),
            &[1],
            &[],
        )
    }),
    ("topics with long names", || {
        let all = (1..1000).flat_map(|number| topic(number, &"a".repeat(1024)));
        let mut bytes: Vec<u8> = mcap().into_iter().chain(all).collect();
        bytes.truncate(SIZE);
        bytes
    }),
    ("messages that claim to be long", || {
        repeated(&[mcap(), topic(1, "a")].concat(), &message(u32::MAX), &[])
    }),
    ("a chunk that claims exabytes", || {
        [mcap(), chunk(u64::MAX, "", &vec![5; SIZE - 1000])].concat()
    }),
    ("a chunk by Zstandard", || {
        // The largest window, then blocks that repeat one byte 128 Ki times.
        let frame = b"\x28\xb5\x2f\xfd\x00\xf8";
        let block = [&(((128_u32 << 10) << 3) | 2).to_le_bytes()[..3], &[5]].concat();
        let content = repeated(frame, &block, &[]);
        [mcap(), chunk(1 << 40, "zstd", &content[..SIZE - 1000])].concat()
    }),
    ("a chunk by LZ4", || {
        // Blocks that claim four megabytes.
        let frame = b"\x04\x22\x4d\x18\x60\x70\x73";
        let content = repeated(
            frame,
            &[0x00, 0x00, 0x40, 0x00, 0x1f, 0x05, 0x01, 0x00],
            &[0xff],
        );
        [mcap(), chunk(1 << 40, "lz4", &content[..SIZE - 1000])].concat()
    }),
    ("chunks in chunks", || {
        let mut inner = vec![5; SIZE / 2];
        for _ in 0..1000 {
            inner = chunk(inner.len() as u64, "", &inner);
        }
        [mcap(), inner].concat()
    }),
];

/// Bytes in the formats of streams only.
const STREAMS: [Malice; 4] = [
    ("marks", || repeated(&[], b"\xaa\x55", &[])),
    ("a mark, then nothing", || repeated(b"\xaa\x55", &[1], &[])),
    ("ends at every other place", || {
        repeated(&[], b"\xff\x01", &[])
    }),
    ("frames of many sizes", || {
        let sizes = (1..).map(|size| [&b"\xaa\x55"[..], &vec![1; size % 1000]].concat());
        let mut bytes: Vec<u8> = sizes.take(2000).flatten().collect();
        bytes.truncate(SIZE);
        bytes
    }),
];

/// Returns the inputs for recordings.
pub(super) fn of_recordings() -> Vec<Malice> {
    [&TEXTS[..], &FILES, &TOPICS].concat()
}

/// Returns the inputs for streams. Their first byte says what is known: here only that they are read from their start.
pub(super) fn of_streams() -> Vec<Malice> {
    [&TEXTS[..], &STREAMS].concat()
}
