//! Malicious inputs of a mebibyte, each of another kind.

mod archives;

mod frames;

mod packed;

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
        "imprint" => &IMPRINTS,
        "exchange" => &EXCHANGES,
        "config" => &CONFIGS,
        "range" => &RANGES,
        "npy" => &ARRAYS,
        "keys" => &KEYS,
        "terminal" => &TERMINALS,
        "script" | "play" => &SCRIPTS,
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

const SHAPES: [Malice; 17] = [
    ("deep lists", || filled("", "[", "")),
    ("deep objects", || filled("", "{\"source\":", "")),
    ("deep rows", in_shape!("\"imprint\":", "[", "")),
    ("deep sources", in_shape!("", "\"source\":{", "")),
    ("a long name", in_shape!("\"name\":\"", "a", "\"}")),
    ("a long format", || {
        filled("{\"format\":\"", "a", "\",\"name\":\"a\"}")
    }),
    ("a long key", in_shape!("\"", "a", "\":1}")),
    ("a long key in escapes", in_shape!("\"", "\\u00e9", "\":1}")),
    (
        "a key again and again",
        in_shape!("", "\"name\":\"a\",", "\"a\":1}"),
    ),
    (
        "a parameter again and again",
        in_shape!("\"sensor\":{", "\"rows\":1,", "\"rows\":1}}"),
    ),
    ("many rows", in_shape!("\"imprint\":[", "\"\",", "\"\"]}")),
    ("a long row", in_shape!("\"imprint\":[\"", "#", "\"]}")),
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
    (
        "a long number",
        in_shape!("\"sensor\":{\"rows\":", "7", "}}"),
    ),
    (
        "a long fraction",
        in_shape!("\"sensor\":{\"threshold\":0.", "3", "}}"),
    ),
    (
        "an unknown kind",
        in_shape!(
            "\"name\":\"a\",\"sensor\":{},\"imprint\":[\"#\"],\"source\":{\"figure\":\"",
            "x",
            "\"}}"
        ),
    ),
];

const JOBS: [Malice; 14] = [
    ("deep lists", || filled("", "[", "")),
    ("deep pictures", || filled("{\"picture\":", "[", "")),
    ("deep sensors", || filled("", "{\"sensor\":", "")),
    ("a long kind", || filled("{\"figure\":\"", "a", "\"}")),
    ("a long name", || {
        filled(
            "{\"picture\":\"",
            "a",
            "\",\"x0\":1,\"y0\":1,\"angle\":0,\"zoom_x\":1,\"zoom_y\":1}",
        )
    }),
    ("a long key", || filled("{\"", "a", "\":1}")),
    ("a key again and again", || {
        filled("{", "\"x0\":1,", "\"x0\":1}")
    }),
    ("many rows", || {
        filled("{\"imprint\":[", "\"#\",", "\"#\"]}")
    }),
    ("a long row", || filled("{\"imprint\":[\"", "#", "\"]}")),
    ("a long row in escapes", || {
        filled("{\"imprint\":[\"", "\\u002e", "\"]}")
    }),
    ("a long number", || {
        filled("{\"imprint\":[\"#\"],\"x0\":", "9", "}")
    }),
    ("a long fraction", || filled("{\"x0\":0.", "0", "1}")),
    ("a long exponent", || filled("{\"x0\":1e", "9", "}")),
    ("spaces around a pose", || {
        filled("{\"imprint\":[\"#\"]", " ", "}")
    }),
];

const IMPRINTS: [Malice; 4] = [
    ("a long row", || filled("", "#", "\n")),
    ("many rows", || filled("", "#\n", "")),
    ("returns", || filled("#", "\r", "")),
    ("long rows", || filled("", &("#".repeat(16_000) + "\n"), "")),
];

const EXCHANGES: [Malice; 16] = [
    ("a comment", || filled("P1", "#", "\n1 1 1")),
    ("comments", || filled("P1", "# a\n", "1 1 1")),
    ("a long width", || filled("P1 ", "9", " 1 1")),
    ("many bits", || filled("P4 1 1 ", "a", "")),
    ("a long row of numbers", || filled("", "1,", "1")),
    ("many rows of numbers", || filled("", "1\n", "")),
    ("a long number", || filled("0.", "0", "")),
    ("a quote", || filled("\"", "1", "")),
    ("comments of a table", || filled("", "# a\n", "1")),
    ("blank lines before a table", || filled("", "\n", "1")),
    ("a wide gap", || filled("1", " ", "1")),
    ("many names", || filled("", "a,", "a\n1")),
    ("old line ends", || filled("", "1\r", "")),
    ("many shades", || filled("P2 64 64 255 ", "7 ", "")),
    ("a long shade", || filled("P2 1 1 9 ", "9", "")),
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

const CONFIGS: [Malice; 7] = [
    ("deep lists", || filled("theme = ", "[", "")),
    ("deep tables", || filled("theme = ", "{a=", "")),
    ("deep keys", || filled("a", ".a", " = 1")),
    ("a long text", || filled("theme = \"", "a", "\"")),
    ("a long key", || filled("", "a", " = 1")),
    ("tables", || filled("", "[sensor]\n", "")),
    ("a long number", || filled("[sensor]\nrows = ", "7", "")),
];

const KEYS: [Malice; 5] = [
    ("brackets", || filled("", "<", "")),
    ("names", || filled("", "<Down>", "")),
    ("a long name", || filled("<", "a", ">")),
    ("long numbers", || filled("<", "9", "x:Down>")),
    ("nothing so often", || filled("", "<0x:Down>", "")),
];

const RANGES: [Malice; 6] = [
    ("a long number", || filled("", "7", "")),
    ("a long fraction", || filled("0.", "3", "")),
    ("zeros in front", || filled("", "0", "1:2:1")),
    ("zeros behind", || filled("1.", "0", ":2:1")),
    ("many parts", || filled("", ":", "")),
    ("a long shard", || filled("1/", "9", "")),
];

const ARRAYS: [Malice; 2] = [
    ("a long header", || {
        let header = "{'descr': '<u8', 'fortran_order': False,";
        let mut bytes = filled(&format!("0123456789{header}"), " ", "");
        bytes[..10].copy_from_slice(b"\x93NUMPY\x01\x00\xff\xff");
        bytes
    }),
    ("a header that is not there", || {
        let mut bytes = filled("0123456789", "\0", "");
        bytes[..10].copy_from_slice(b"\x93NUMPY\x01\x00\x00\x00");
        bytes
    }),
];

const TERMINALS: [Malice; 9] = [
    ("escapes", || filled("", "\x1b", "")),
    ("a long sequence", || filled("\x1b[", "1;", "A")),
    ("a long number", || filled("\x1b[", "9", "~")),
    ("a long answer", || filled("\x1b]", "a", "\x07")),
    ("an answer of escapes", || filled("\x1b]", "\x1b", "")),
    ("a paste", || filled("\x1b[200~", "a\r\n", "\x1b[201~")),
    ("a paste without an end", || {
        filled("\x1b[200~", "\x1b[201", "")
    }),
    ("pastes", || filled("", "\x1b[200~a\x1b[201~", "")),
    ("mouse reports", || filled("", "\x1b[<0;99999;3M", "")),
];

const SCRIPTS: [Malice; 12] = [
    ("a long word", || filled("", "a", "")),
    ("a long size", || filled("Size ", "8", "x24")),
    ("long keys", || filled("Keys ", "<9999x:Down>", "")),
    ("a long text", || filled("Type \"", "a", "")),
    ("a long text in escapes", || {
        filled("Type \"", "\\u0007", "x")
    }),
    ("a long name", || filled("Screen ", "a", "\u{7}")),
    ("a long pointer", || filled("State ", "/a", "")),
    ("a long pattern", || filled("Expect /", "a", "/")),
    ("a deep pattern", || filled("Expect /", "(", "/")),
    ("a pattern that repeats", || filled("Expect /a", "{9}", "/")),
    ("a long way", || filled("Drag ", "0,0 9,9 ", "")),
    ("many screens", || filled("", "Screen\n", "Quit now")),
];
