//! How the program ended, for the exit status.

use signal_hook::consts::SIGHUP;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Quit,
    RecordingFailed,
    Signal(i32),
    Hangup,
}

impl Outcome {
    /// Returns the exit status: 0, 1 after a failure, or 128 and the signal's number as in a shell. A lost terminal
    /// counts as SIGHUP.
    pub fn status(self) -> u8 {
        match self {
            Self::Quit => 0,
            Self::RecordingFailed => 1,
            Self::Signal(number) => 128_u8.saturating_add(u8::try_from(number).unwrap_or(127)),
            Self::Hangup => Self::Signal(SIGHUP).status(),
        }
    }
}
