//! Chooses the channel of a source to watch, while the channels become known one after the other.

use crate::formats::recording::event::ChannelInfo;

/// The channel that was asked for, or else the first one. A stream without channels has all its frames taken.
#[derive(Clone, Debug, Default)]
pub struct ChannelChoice {
    /// The name that was asked for.
    asked: Option<String>,
    /// The names of the channels so far.
    names: Vec<String>,
    /// The index of the channel that is watched, once that is known.
    chosen: Option<usize>,
}

impl ChannelChoice {
    /// The channel of that name; without a name the first one.
    pub fn new(asked: Option<&str>) -> Self {
        Self {
            asked: asked.map(str::to_owned),
            ..Self::default()
        }
    }

    /// Adds the next channel. Returns whether it is the one that is watched.
    pub fn add(&mut self, info: &ChannelInfo) -> bool {
        let name = info.shown_name();
        let fits = self.asked.as_deref().is_none_or(|asked| asked == name);
        let is_chosen = fits && self.chosen.is_none();
        if is_chosen {
            self.chosen = Some(self.names.len());
        }
        self.names.push(name.to_owned());
        is_chosen
    }

    /// Whether frames of the channel of that index are taken. As long as the one that was asked for has not come, those of
    /// the others are not.
    pub fn takes(&self, channel: usize) -> bool {
        match self.chosen {
            Some(chosen) => chosen == channel,
            None => self.names.is_empty(),
        }
    }

    /// The names of the channels so far; `unnamed` for one without.
    pub fn names(&self) -> &[String] {
        &self.names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: Option<&str>) -> ChannelInfo {
        ChannelInfo {
            name: name.map(str::to_owned),
            ..ChannelInfo::default()
        }
    }

    #[test]
    fn frames_of_others_are_not_taken_before_the_channel_comes() {
        let mut choice = ChannelChoice::new(Some("right"));
        assert!(!choice.add(&channel(Some("left"))));
        assert!(!choice.takes(0));
        assert!(choice.add(&channel(Some("right"))));
        assert!(!choice.add(&channel(Some("right"))), "only the first one");
        assert_eq!(
            [0, 1, 2].map(|index| choice.takes(index)),
            [false, true, false]
        );
        assert_eq!(choice.names(), ["left", "right", "right"]);
    }

    #[test]
    fn without_a_name_the_first_channel_is_taken_and_of_a_stream_all_frames() {
        assert!(ChannelChoice::new(Some("right")).takes(0));
        let mut choice = ChannelChoice::new(None);
        assert!(choice.takes(0));
        assert!(choice.add(&channel(None)));
        assert!(!choice.add(&channel(Some("right"))));
        assert!(choice.takes(0) && !choice.takes(1));
    }
}
