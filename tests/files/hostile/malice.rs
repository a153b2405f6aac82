//! Malicious inputs of a mebibyte, each of another kind.

mod archives;

pub(super) mod frames;

pub(crate) mod packed;

/// The length of an input, which is also the limit for files.
pub(crate) const SIZE: usize = 1 << 20;

/// A description, and a function that makes the bytes.
pub(crate) type Malice = (&'static str, fn() -> Vec<u8>);

/// An input that the reader of recordings unpacks completely, up to 256 MiB, because the values of a frame are spread
/// over the whole array.
pub(crate) const UNPACKED: &str = "an array in the other order that unpacks to much";

/// Returns the malicious inputs for a body.
pub(crate) fn all(body: &str) -> Vec<Malice> {
    let general: [Malice; 5] = [
        ("zeros", || vec![0; SIZE]),
        ("no text", || vec![0xff; SIZE]),
        ("spaces", || vec![b' '; SIZE]),
        ("line ends", || vec![b'\n'; SIZE]),
        ("letters of four bytes", || filled("", "𝔸", "")),
    ];
    let own: &[Malice] = match body {
        "shape" => &SHAPES,
        "job" => &JOBS,
        "exchange" => &EXCHANGES,
        "config" => &CONFIGS,
        "play" => &SCRIPTS,
        "archive" => archives::ATLASES,
        "model" => archives::MODELS,
        "recording" => &frames::of_recordings(),
        "stream" => &frames::of_streams(),
        // For the other bodies, only the general ones make sense at this length.
        _ => &[],
    };
    [&general[..], own].concat()
}

/// Returns the bytes of the input with a description.
pub(crate) fn of(body: &str, what: &str) -> Vec<u8> {
    let mut all = all(body).into_iter();
    let found = all.find(|(name, _)| *name == what);
    found.expect("there is one of that name").1()
}

/// Returns the bytes of an input, as its body expects them.
pub(crate) fn bytes(body: &str, index: usize) -> Vec<u8> {
    let mut bytes = all(body)[index].1();
    if body == "stream" {
        // This first byte says that the stream is read from its start, and nothing else.
        bytes.insert(0, b'd');
        bytes.truncate(SIZE);
    }
    bytes
}

/// Returns a start, as many repetitions as fit, and an end.
fn filled(start: &str, again: &str, end: &str) -> Vec<u8> {
    let times = (SIZE - start.len() - end.len()) / again.len();
    [start, &again.repeat(times), end].concat().into_bytes()
}

/// Like [`filled`], for bytes.
fn repeated(start: &[u8], again: &[u8], end: &[u8]) -> Vec<u8> {
    let times = (SIZE - start.len() - end.len()) / again.len();
    [start, &again.repeat(times), end].concat()
}

/// Returns a start, followed by as many pieces with numbers from 0 as fit.
fn numbered(start: &str, piece: &dyn Fn(u32) -> String) -> Vec<u8> {
    let mut text = start.to_owned();
    for number in 0.. {
        let next = piece(number);
        if text.len() + next.len() > SIZE {
            break;
        }
        text += &next;
    }
    text.into_bytes()
}

/// A stored shape in which one part is repeated as often as fits.
macro_rules! in_shape {
    ($start:expr, $again:expr, $end:expr) => {
        || {
            filled(
                concat!("{\"format\":\"taxel-shape/1\",", $start),
                $again,
                $end,
            )
        }
    };
}

const SHAPES: [Malice; 5] = [
    ("deep lists", || filled("", "[", "")),
    ("deep sources", in_shape!("", "\"source\":{", "")),
    (
        "a key again and again",
        in_shape!("", "\"name\":\"a\",", "\"a\":1}"),
    ),
    (
        "a long row in escapes",
        in_shape!("\"imprint\":[\"", "\\u0023", "\"]}"),
    ),
    (
        "rows that are long",
        in_shape!(
            "\"imprint\":[",
            "\"################################################################################################\",",
            "\"\"]}"
        ),
    ),
];

const JOBS: [Malice; 3] = [
    ("deep pictures", || filled("{\"picture\":", "[", "")),
    ("many rows", || {
        filled("{\"imprint\":[", "\"#\",", "\"#\"]}")
    }),
    ("a long fraction", || filled("{\"x0\":0.", "0", "1}")),
];

const EXCHANGES: [Malice; 3] = [
    ("a long row of numbers", || filled("", "1,", "1")),
    ("many rows of numbers", || filled("", "1\n", "")),
    ("a long shape", || {
        let mut bytes = filled(
            "0123456789ab{'descr': '|b1', 'fortran_order': False, 'shape': (",
            "1,",
            ")}\n",
        );
        bytes[..12].copy_from_slice(b"\x93NUMPY\x02\x00\xf4\xff\x0f\x00");
        bytes
    }),
];

const CONFIGS: [Malice; 2] = [
    ("deep lists", || filled("theme = ", "[", "")),
    ("deep keys", || filled("a", ".a", " = 1")),
];

const SCRIPTS: [Malice; 3] = [
    ("a long text in escapes", || {
        filled("Type \"", "\\u0007", "x")
    }),
    ("a pattern that repeats", || filled("Expect /a", "{9}", "/")),
    ("many screens", || filled("", "Screen\n", "Quit now")),
];
