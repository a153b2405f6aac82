//! The channels of a recording or a stream, as they appear.

use crate::formats::recording::event::ChannelInfo;
use crate::frame::Frame;

/// The channels so far, in the order of their first frames. A limit keeps names that change with every frame from
/// filling the memory.
#[derive(Debug)]
pub(in crate::formats) struct ChannelTable {
    /// The channels, as their first frames describe them.
    channels: Vec<ChannelInfo>,
    /// The number of frames of each channel.
    frames: Vec<u64>,
    /// The number of channels that were reported.
    reported: usize,
    /// The most channels, and what they are called.
    most: (usize, &'static str),
}

impl ChannelTable {
    /// Creates a table without channels, for at most that many of them.
    pub(super) fn new(most: usize, called: &'static str) -> Self {
        Self {
            channels: Vec::new(),
            frames: Vec::new(),
            reported: 0,
            most: (most, called),
        }
    }

    /// Returns the index of the channel of that name. If it is new, it is added with the other fields of `info`.
    ///
    /// # Errors
    /// Returns a message if there are too many channels.
    pub(super) fn index_of(
        &mut self,
        name: Option<&str>,
        info: impl FnOnce() -> ChannelInfo,
    ) -> Result<usize, String> {
        let mut names = self.channels.iter().map(|known| known.name.as_deref());
        if let Some(known) = names.position(|known| known == name) {
            return Ok(known);
        }
        let (most, called) = self.most;
        if self.channels.len() == most {
            return Err(format!("more than {most} {called}"));
        }
        self.channels.push(ChannelInfo {
            name: name.map(str::to_owned),
            ..info()
        });
        self.frames.push(0);
        Ok(self.channels.len() - 1)
    }

    /// Returns true if a channel has a name.
    pub(in crate::formats) fn has_names(&self) -> bool {
        self.channels.iter().any(|info| info.name.is_some())
    }

    /// Returns a channel as its first frame described it.
    pub(super) fn info(&self, channel: usize) -> &ChannelInfo {
        &self.channels[channel]
    }

    /// Numbers a frame as the next one of a channel.
    pub(super) fn number(&mut self, channel: usize, frame: &mut Frame) {
        frame.channel = channel;
        frame.number = self.frames[channel];
        self.frames[channel] += 1;
    }

    /// Returns the channels that were added since the last call, to report them.
    pub(in crate::formats) fn take_new(&mut self) -> &[ChannelInfo] {
        let reported = std::mem::replace(&mut self.reported, self.channels.len());
        &self.channels[reported..]
    }
}
