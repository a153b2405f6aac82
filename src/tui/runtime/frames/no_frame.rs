//! The reasons why a source on the live page gives no frame, in sentences. No flag can be typed on the page, so they
//! also say where to give what is missing: after `:watch`, or in the shell for standard input, which can be read only
//! once.

use crate::acquire::{AcquireError, FrameSource};
use crate::formats::recording::RecordingError;
use crate::formats::stream::{NoFrameReason, StreamCounts, StreamRefusal};
use crate::formats::value::counted;

const FORMAT_HINT: &str = "; after Esc, add one to :watch, as in --format lines";

const SIZE_HINT: &str = "; after Esc, add them to :watch, as in --rows R --columns C";

/// Returns the reason why a source cannot be read.
pub(super) fn reason(source: &FrameSource, error: &AcquireError) -> String {
    let hint = match (error, source) {
        (AcquireError::Recording(error), _) if error.is_of_size() => SIZE_HINT,
        (AcquireError::NotStream { .. }, FrameSource::File(_)) => {
            "; watch it again when it is complete"
        }
        (AcquireError::NotStream { .. }, _) => "; save it to a file, and watch that",
        _ => "",
    };
    format!("{error}{hint}")
}

/// Returns the reason why no frame comes, given what is said of the silence. It stays true while the silence lasts: a
/// page on which nothing changes sends nothing.
pub(super) fn silence(source: &FrameSource, counts: &StreamCounts, what: &str) -> String {
    let refusal = counts.refusal();
    // A file has no baud, and sends nothing.
    if let (FrameSource::File(_), None, 0, 1..) = (source, refusal, counts.frames, counts.bytes) {
        let bytes = counted(counts.bytes, "byte");
        return format!("no frame yet: none in {bytes}; rows, columns or format?");
    }
    let hint = refusal.map_or("", |refusal| hint(source, refusal));
    format!("no frame for more than 2 s: {what}{hint}")
}

/// Returns the reason why a stream came to its end without a frame; None if there was one.
pub(super) fn reason_at_end(source: &FrameSource, counts: &StreamCounts) -> Option<String> {
    let reason = counts.no_frame_reason()?;
    let hint = match (reason, source) {
        (NoFrameReason::Refused(StreamRefusal::Unknown), FrameSource::File(_)) => {
            return Some(RecordingError::Unknown.to_string());
        }
        (NoFrameReason::Refused(refusal), source) => hint(source, refusal),
        (NoFrameReason::Undecoded { reason: None, .. }, _) => "; rows, columns or format?",
        _ => "",
    };
    Some(format!("{reason}{hint}"))
}

fn hint(source: &FrameSource, refusal: StreamRefusal) -> &'static str {
    match (refusal, source) {
        (StreamRefusal::Unknown, FrameSource::Standard) => {
            "; start again in the shell, with --format lines"
        }
        (StreamRefusal::Unknown, _) => FORMAT_HINT,
        (refusal, FrameSource::Standard) if refusal.is_of_size() => {
            "; start again in the shell, with --rows R --columns C"
        }
        (refusal, _) if refusal.is_of_size() => SIZE_HINT,
        _ => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::recording::RecordingFormat;
    use crate::formats::stream::Silence;

    #[test]
    fn standard_input_is_not_read_again_by_watch() {
        let counts = StreamCounts {
            bytes: 9,
            unshaped: Some(4),
            ..StreamCounts::default()
        };
        let said = reason_at_end(&FrameSource::Standard, &counts);
        let end = "start again in the shell, with --rows R --columns C";
        assert!(said.is_some_and(|said| said.ends_with(end)));
    }

    #[test]
    fn a_recording_that_is_not_a_stream_can_be_watched_as_a_file() {
        let format = RecordingFormat::Npy;
        let error = AcquireError::NotStream { format };
        for (source, hint) in [
            (FrameSource::Standard, "save it to a file, and watch that"),
            (
                FrameSource::File("a.npy".into()),
                "watch it again when it is complete",
            ),
        ] {
            let expected = format!("a recording (npy), not a stream; {hint}");
            assert_eq!(reason(&source, &error), expected);
        }
    }

    #[test]
    fn a_file_without_a_frame_is_not_asked_for_its_baud() {
        let file = FrameSource::File("a.txt".into());
        let counts = StreamCounts {
            bytes: 272,
            ..StreamCounts::default()
        };
        let said = "no frame yet: none in 272 bytes; rows, columns or format?";
        // The message stays the same when nothing more comes.
        for bytes_per_second in [136.0, 0.0] {
            let what = Silence {
                bytes_per_second,
                counts: &counts,
                has_vanished: false,
            };
            assert_eq!(silence(&file, &counts, &what.reason(false)), said);
        }
    }
}
