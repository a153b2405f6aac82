//! A rule together with its origin: an argument, the settings, the recording or a key.

use crate::frame::processing::Processing;
use crate::frame::rule::Rule;

/// A rule and its origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetRule {
    /// The rule.
    pub rule: Rule,
    /// The smallest number of taxels of a piece; smaller pieces are dropped. 0 or 1 drops none.
    pub least: u32,
    /// The origin of the rule.
    pub from: RuleOrigin,
}

/// The origin of a rule.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RuleOrigin {
    /// An argument on the command line.
    #[default]
    Flag,
    /// The recording, or the metadata beside it.
    File,
    /// The user's settings.
    Settings,
    /// A key on the live page.
    Key,
}

impl RuleOrigin {
    /// Returns the name of the origin, as in answers and descriptions.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flag => "flag",
            Self::File => "file",
            Self::Settings => "settings",
            Self::Key => "key",
        }
    }
}

impl SetRule {
    /// Sets or removes the rule by which frames are processed. If it is removed, the smallest size of a piece is kept
    /// for the next rule.
    pub fn apply(rule: Option<Self>, processing: &mut Processing) {
        processing.rule = rule.map(|set| set.rule);
        if let Some(set) = rule {
            processing.least = set.least;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_removed_rule_leaves_the_smallest_size_of_a_piece() {
        let mut processing = Processing::default();
        let rule = SetRule {
            rule: Rule::AtLeast(2.0),
            least: 3,
            from: RuleOrigin::Flag,
        };
        SetRule::apply(Some(rule), &mut processing);
        assert_eq!(
            (processing.rule, processing.least),
            (Some(Rule::AtLeast(2.0)), 3)
        );
        SetRule::apply(None, &mut processing);
        assert_eq!((processing.rule, processing.least), (None, 3));
    }
}
