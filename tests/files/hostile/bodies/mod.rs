//! Functions that hostile bytes are given to: by property tests here, by the fuzz targets in `fuzz/`. None may panic,
//! whatever the bytes are. A value that is read must be the same when it is written and read again, and a message must
//! be short however long the quoted input is. A body returns true if the bytes could be read.

mod archive;

mod formats;

mod frames;

mod model;

mod keys;

mod screen;

pub(crate) use archive::with_spread;
pub(crate) use screen::session_of;

/// A body: its name, here and as a fuzz target; the folder of its usual inputs in `tests/files/hostile/seeds`; and the
/// function that is given the bytes.
pub(crate) type Body = (&'static str, &'static str, fn(&[u8]) -> bool);

/// All bodies.
pub(crate) const BODIES: [Body; 21] = [
    ("shape", "shape", formats::shape),
    ("job", "job", formats::job),
    ("imprint", "imprint", formats::imprint),
    ("exchange", "exchange", formats::exchange),
    ("svg", "svg", formats::svg),
    ("points", "points", formats::points),
    ("range", "range", formats::range),
    ("npy", "npy", formats::npy),
    ("archive", "archive", archive::archive),
    ("arrays", "arrays", archive::arrays),
    ("model", "model", model::model),
    ("model_arrays", "model_arrays", model::model_arrays),
    ("named_shape", "named_shape", model::named),
    ("config", "config", formats::config),
    ("keys", "keys", keys::keys),
    ("command", "command", screen::command),
    ("play", "script", screen::play),
    ("session", "session", screen::session),
    ("recording", "recording", frames::recording),
    ("stream", "stream", frames::stream),
    ("metadata", "metadata", frames::metadata),
];

/// Returns the body with a name.
pub(crate) fn body(name: &str) -> fn(&[u8]) -> bool {
    let found = BODIES.into_iter().find(|(own, ..)| *own == name);
    found.expect("there is a body of that name").2
}

/// The length limit of messages, however long the quoted input is.
const LONGEST_MESSAGE: usize = 1000;

/// Checks that the message of a refusal is short; returns false, since nothing was read.
fn refused(message: &str) -> bool {
    is_short(message);
    false
}

fn is_short(message: &str) {
    let length = message.chars().count();
    assert!(
        length <= LONGEST_MESSAGE,
        "a message of {length} characters"
    );
}
