//! Whether the frames of the live page are recorded, and why not.

/// The recording that runs, and what became of those that were asked for.
#[derive(Clone, Debug, Default)]
pub struct RecordingState {
    /// The file that is written.
    name: Option<String>,
    /// Why there is none although one was asked for.
    refusal: Option<String>,
    /// Why the recording that was asked for together with the source has failed.
    write_failure: Option<String>,
}

impl RecordingState {
    /// The file that is recorded in; None without one.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Why nothing is recorded although it was asked for; None where it is, or was not asked for.
    pub fn refusal(&self) -> Option<&str> {
        self.refusal.as_deref()
    }

    /// Why the recording that was asked for together with the source has failed; None where it has not. Later recordings
    /// do not change that.
    pub fn write_failure(&self) -> Option<&str> {
        self.write_failure.as_deref()
    }

    /// Notes that a recording has begun, or ended.
    pub(super) fn set(&mut self, name: Option<String>) {
        self.name = name;
        self.refusal = None;
    }

    /// Notes that a recording has failed, or cannot be begun, and why. `asked` is the file that was asked for together with
    /// the source.
    pub(super) fn fail(&mut self, reason: String, asked: Option<&str>) {
        if asked.is_some() && self.name() == asked {
            self.write_failure = Some(reason.clone());
        }
        self.name = None;
        self.refusal = Some(reason);
    }

    /// Notes that no more frames are recorded.
    pub(super) fn stop(&mut self) {
        self.name = None;
    }

    /// Forgets that a recording was refused.
    pub(super) fn forget_refusal(&mut self) {
        self.refusal = None;
    }
}
