//! The state of a recording: whether the frames of the live page are recorded, and if not, why.

#[derive(Clone, Debug, Default)]
pub struct RecordingState {
    /// The file that is written; None if nothing is recorded.
    name: Option<String>,
    /// The number in the history that the next frame had when the recording was requested: frames before it are not
    /// recorded.
    from: u64,
    /// Why nothing is recorded although it was requested.
    refusal: Option<String>,
    write_failure: Option<String>,
    /// Whether a recording ended because its source was left, which the user has not been told yet.
    was_stopped: bool,
}

impl RecordingState {
    /// Returns the file that is written; None if nothing is recorded.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    pub(super) fn from(&self) -> u64 {
        self.from
    }

    /// Returns why nothing is recorded although it was requested; None if it is recorded, or was not requested.
    pub fn refusal(&self) -> Option<&str> {
        self.refusal.as_deref()
    }

    /// Returns why the recording that was requested together with the source has failed; None if it has not. Later
    /// recordings do not change that.
    pub fn write_failure(&self) -> Option<&str> {
        self.write_failure.as_deref()
    }

    pub(super) fn request(&mut self, next_number: u64) {
        self.from = next_number;
    }

    pub(super) fn set(&mut self, name: Option<String>) {
        self.name = name;
        self.refusal = None;
        self.was_stopped = false;
    }

    /// Notes why a recording has failed, or why it cannot be begun. `asked` is the file that was requested together
    /// with the source.
    pub(super) fn fail(&mut self, reason: String, asked: Option<&str>) {
        if asked.is_some() && self.name() == asked {
            self.write_failure = Some(reason.clone());
        }
        self.name = None;
        self.refusal = Some(reason);
    }

    /// Notes that no more frames are recorded, because the source is left.
    pub(super) fn stop(&mut self) {
        self.was_stopped |= self.name.take().is_some();
    }

    /// Returns true once if a recording ended because its source was left.
    pub(super) fn take_stopped(&mut self) -> bool {
        std::mem::take(&mut self.was_stopped)
    }

    pub(super) fn forget_refusal(&mut self) {
        self.refusal = None;
    }
}
