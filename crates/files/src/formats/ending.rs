//! The endings of file names.

use std::path::Path;

/// Returns true if a file's name has this extension, in upper or lower case. The rest of the name need not be UTF-8.
pub fn has_ending(path: impl AsRef<Path>, ending: &str) -> bool {
    let own = path.as_ref().extension();
    own.is_some_and(|own| own.eq_ignore_ascii_case(ending))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ending_is_found_in_upper_and_lower_case() {
        assert!(has_ending("a.csv", "csv") && has_ending("a/b.c.CSV", "csv"));
        assert!(
            !has_ending("csv", "csv")
                && !has_ending(".csv", "csv")
                && !has_ending("a.csv.gz", "csv")
        );
    }
}
