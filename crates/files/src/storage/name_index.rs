//! The names of a library's files by their folded form, read once while the folder does not change.
//!
//! Usually a shape is called exactly as its file is, and that file is found without a list. A name that differs in
//! case, or that no file has, would need a list of the whole folder each time.

use std::collections::HashMap;
use std::io::ErrorKind;
use std::path::Path;
use std::sync::Mutex;
use std::time::{Duration, SystemTime};

use crate::formats::name::{Name, folded};
use crate::lock::locked;
use crate::storage::error::LibraryError;

/// The age that a folder's last change must have for its list to be kept: a later change within one step of the file
/// system's clock would leave the same time. The coarsest clocks have steps of two seconds.
const SETTLED: Duration = Duration::from_secs(3);

/// The list of a folder, if it could be kept.
#[derive(Debug, Default)]
pub(crate) struct NameIndex {
    kept: Mutex<Option<KeptNames>>,
}

/// The names as they were when the folder had last changed.
#[derive(Debug)]
struct KeptNames {
    changed: SystemTime,
    /// The names, by their folded form.
    names: HashMap<String, String>,
}

impl NameIndex {
    /// Returns the name in the folder that is the same as `name`, as its file has it. `list` reads the folder's
    /// names.
    ///
    /// # Errors
    /// Returns the errors of `list`.
    pub(crate) fn find(
        &self,
        folder: &Path,
        name: &Name,
        list: impl FnOnce() -> Result<Vec<String>, LibraryError>,
    ) -> Result<Option<String>, LibraryError> {
        let changed = folder.metadata().and_then(|found| found.modified());
        if (changed.as_ref()).is_err_and(|error| error.kind() == ErrorKind::NotFound) {
            return Ok(None);
        }
        let changed = changed.ok();
        // A thread that panicked here left the old list or none.
        let mut kept = locked(&self.kept);
        let folded_name = folded(name.as_str());
        if let Some(kept) = kept.as_ref().filter(|kept| Some(kept.changed) == changed) {
            return Ok(kept.names.get(&folded_name).cloned());
        }
        let mut names = HashMap::new();
        let now = SystemTime::now();
        for own in list()? {
            names.entry(folded(&own)).or_insert(own);
        }
        let found = names.get(&folded_name).cloned();
        let settled = |changed: &SystemTime| {
            let age = now.duration_since(*changed);
            age.is_ok_and(|age| age > SETTLED)
        };
        *kept = changed
            .filter(settled)
            .map(|changed| KeptNames { changed, names });
        Ok(found)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;
    use std::fs::File;

    #[test]
    fn a_folder_is_read_again_only_after_a_change() {
        let folder = tempfile::tempdir().expect("a folder");
        let at = |seconds| SystemTime::now() - Duration::from_secs(seconds);
        let set = |time| {
            let opened = File::open(folder.path()).expect("opened");
            opened.set_modified(time).expect("set");
        };
        let index = NameIndex::default();
        let reads = Cell::new(0);
        let find = |name: &str, names: &[&str]| {
            let name = Name::new(name).expect("a name");
            let found = index.find(folder.path(), &name, || {
                reads.set(reads.get() + 1);
                Ok(names.iter().map(|&name| name.to_owned()).collect())
            });
            found.expect("listed")
        };
        set(at(100));
        for _ in 0..5 {
            assert_eq!(find("ring", &["Ring"]).as_deref(), Some("Ring"));
            assert_eq!(find("cross", &["Ring"]), None);
        }
        assert_eq!(reads.get(), 1);
        set(at(50));
        assert_eq!(find("cross", &["Cross"]).as_deref(), Some("Cross"));
        assert_eq!(reads.get(), 2);
        // The folder has just changed, and may change again within the same step of the clock.
        set(at(0));
        assert_eq!(find("a", &["A"]).as_deref(), Some("A"));
        assert_eq!(find("b", &["A", "B"]).as_deref(), Some("B"));
        assert_eq!(reads.get(), 4);
    }
}
