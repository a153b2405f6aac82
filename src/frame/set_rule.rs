//! A rule, and who set it: an argument, the settings, the recording or a key.

use crate::frame::processing::Processing;
use crate::frame::rule::Rule;

/// A rule and who set it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetRule {
    /// The rule.
    pub rule: Rule,
    /// Pieces of fewer taxels are dropped; 0 or 1 drops none.
    pub least: u32,
    /// Where it is from.
    pub from: RuleOrigin,
}

/// Where a rule is from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RuleOrigin {
    /// An argument of the command.
    #[default]
    Flag,
    /// The recording, or the description beside it.
    File,
    /// The user's settings.
    Settings,
    /// A key of the live page.
    Key,
}

impl RuleOrigin {
    /// Its name in answers and descriptions.
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
    /// Sets the rule by which frames are processed, or removes it. After a removal, the smallest size of a piece is
    /// kept for the next rule.
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
    fn a_rule_is_applied_with_its_least_and_taken_away_without() {
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
