//! The channel of a source that is answered.

use crate::acquire::FrameSource;
use crate::cli::arguments::watch::WatchArguments;
use crate::cli::commands::watch::check::channels;
use crate::cli::commands::watch::reports::SourceReports;
use crate::cli::error::CliError;
use crate::formats::recording::{ChannelChoice, ChannelInfo};
use crate::frame::Frame;
use crate::quote::as_argument;

/// A gate that lets the frames of one channel pass.
///
/// If no channel is named, the first frame of a recording is held back until the next one comes: a second channel
/// before that is an error, a later one is left out.
pub(super) struct ChannelGate<'a> {
    asked: &'a WatchArguments,
    source: &'a FrameSource,
    choice: ChannelChoice,
    channels: Vec<ChannelInfo>,
    first: FirstFrame,
}

enum FirstFrame {
    Missing,
    Came { held: Option<(Frame, Option<f64>)> },
}

impl<'a> ChannelGate<'a> {
    pub(super) fn new(source: &'a FrameSource, asked: &'a WatchArguments) -> Self {
        Self {
            asked,
            source,
            choice: ChannelChoice::new(asked.processing.channel.as_deref()),
            channels: Vec::new(),
            first: FirstFrame::Missing,
        }
    }

    fn wanted(&self) -> Option<&'a str> {
        self.asked.processing.channel.as_deref()
    }

    pub(super) fn has_channels(&self) -> bool {
        !self.channels.is_empty()
    }

    pub(super) fn name(&self, channel: usize) -> Option<&str> {
        self.channels.get(channel)?.name.as_deref()
    }

    /// Adds a channel. Returns true if it is the watched one. Other channels that appear once frames are answered are
    /// left out.
    pub(super) fn add(
        &mut self,
        info: &ChannelInfo,
        reports: &mut SourceReports<'_>,
    ) -> Result<bool, CliError> {
        self.channels.push(info.clone());
        let is_chosen = self.choice.add(info);
        let names = self.choice.names();
        if self.wanted().is_some() || names.len() == 1 {
            return Ok(is_chosen);
        }
        if matches!(self.first, FirstFrame::Came { held: None }) {
            let (own, other) = (&names[0], info.shown_name());
            let flag = as_argument(other);
            reports.say(&format!(
                "channel {other} is left out, since {own} came first; --channel {flag} takes it"
            ));
            return Ok(false);
        }
        let all = match self.source {
            FrameSource::File(path) => channels(path, self.asked, None)?.0,
            _ => names.to_vec(),
        };
        let names = all.join(", ");
        let message = format!("several channels, choose one with --channel: {names}");
        Err(reports.refused(&message))
    }

    pub(super) fn admits(
        &mut self,
        frame: &Frame,
        time: Option<f64>,
        reports: &mut SourceReports<'_>,
    ) -> bool {
        if !self.choice.takes(frame.channel) {
            return false;
        }
        if !matches!(self.first, FirstFrame::Missing) {
            return true;
        }
        let held = (self.wanted().is_none() && self.has_channels()).then(|| (frame.clone(), time));
        let passes = held.is_none();
        self.first = FirstFrame::Came { held };
        if let (Some(wanted), false) = (self.wanted(), self.has_channels()) {
            reports.say(&format!(
                "no channel named {wanted:?}: a stream has none, and all frames are taken"
            ));
        }
        passes
    }

    pub(super) fn release(&mut self) -> Option<(Frame, Option<f64>)> {
        match &mut self.first {
            FirstFrame::Missing => None,
            FirstFrame::Came { held } => held.take(),
        }
    }

    pub(super) fn no_frame_reason(&self) -> Option<String> {
        let is_missing = matches!(self.first, FirstFrame::Missing);
        let reason = || {
            self.choice
                .missing()
                .unwrap_or_else(|| "no frames".to_owned())
        };
        is_missing.then(reason)
    }
}
