//! The choice of a channel by its name.

use taxel_core::quote::did_you_mean;

use crate::formats::recording::event::{ChannelInfo, UNNAMED_CHANNEL};

/// A choice of the requested channel, or else of the first one. If the stream has no channels, all frames are taken.
#[derive(Clone, Debug, Default)]
pub struct ChannelChoice {
    asked: Option<String>,
    /// The names of the channels so far; `unnamed` for a channel without a name.
    pub names: Vec<String>,
    chosen: Option<usize>,
}

impl ChannelChoice {
    /// Chooses the channel of that name, or the first channel if there is no name.
    pub fn new(asked: Option<&str>) -> Self {
        Self {
            asked: asked.map(str::to_owned),
            ..Self::default()
        }
    }

    /// Adds the next channel. Returns true if it is the chosen one.
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

    /// Returns true if frames of the channel with that index are taken. Until the requested channel appears, frames
    /// of other channels are not taken.
    pub fn takes(&self, channel: usize) -> bool {
        match self.chosen {
            Some(chosen) => chosen == channel,
            None => self.names.is_empty(),
        }
    }

    /// Returns the message that the channel that was asked for is not among the channels so far; None if it is, or if
    /// there are no channels.
    pub fn missing(&self) -> Option<String> {
        let asked = self.asked.as_deref().filter(|_| self.chosen.is_none())?;
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        (!names.is_empty()).then(|| no_channel(asked, &names))
    }
}

/// Returns the message that a recording has no channel of this name; it lists the others.
pub fn no_channel(asked: &str, names: &[&str]) -> String {
    if names == [UNNAMED_CHANNEL] {
        return format!(
            "no channel named {asked:?}: the recording has one channel, without a name; leave out --channel"
        );
    }
    format!(
        "no channel named {asked:?}; channels: {}{}",
        names.join(", "),
        did_you_mean(asked, names.iter().copied())
    )
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
    fn frames_of_other_channels_are_not_taken_before_the_chosen_one_appears() {
        let mut choice = ChannelChoice::new(Some("right"));
        assert!(!choice.add(&channel(Some("left"))));
        assert!(!choice.takes(0));
        assert!(choice.add(&channel(Some("right"))));
        assert!(!choice.add(&channel(Some("right"))), "only the first one");
        assert_eq!(
            [0, 1, 2].map(|index| choice.takes(index)),
            [false, true, false]
        );
        assert_eq!(choice.names, ["left", "right", "right"]);
        assert_eq!(choice.missing(), None);
    }

    #[test]
    fn a_channel_that_never_appears_is_reported_with_the_others() {
        let mut choice = ChannelChoice::new(Some("righ"));
        assert_eq!(choice.missing(), None, "a stream has none");
        choice.add(&channel(Some("left")));
        choice.add(&channel(Some("right")));
        let said = r#"no channel named "righ"; channels: left, right; did you mean "right"?"#;
        assert_eq!(choice.missing().as_deref(), Some(said));
    }

    #[test]
    fn without_a_name_the_first_channel_is_taken_or_all_frames() {
        assert!(ChannelChoice::new(Some("right")).takes(0));
        let mut choice = ChannelChoice::new(None);
        assert!(choice.takes(0));
        assert!(choice.add(&channel(None)));
        assert!(!choice.add(&channel(Some("right"))));
        assert!(choice.takes(0) && !choice.takes(1));
    }
}
