//! The rule for where the program may write files.
//!
//! On a terminal a person names the file, and is asked before an existing one is replaced. A script does both itself,
//! and may come from a stranger: it may write only below its own folder, no hidden files, and may replace only files
//! that it has written itself. `taxel script --allow-outside` lifts these limits.

use std::path::{Component, Path, PathBuf};
use std::sync::Mutex;

use crate::lock::locked;
use crate::storage::{Existing, location};

#[derive(Debug, Default)]
pub(in crate::tui) struct WriteAccess {
    /// The folder that a script is confined to; None for anywhere.
    folder: Option<PathBuf>,
    written: Mutex<Vec<PathBuf>>,
}

impl WriteAccess {
    pub(in crate::tui::runtime) fn below(folder: PathBuf) -> Self {
        Self {
            folder: Some(folder),
            written: Mutex::default(),
        }
    }

    pub(in crate::tui::runtime) fn is_confined(&self) -> bool {
        self.folder.is_some()
    }

    pub(in crate::tui::runtime) fn path(
        &self,
        name: &str,
        existing: Existing,
    ) -> Result<PathBuf, String> {
        let Some(folder) = &self.folder else {
            return location::below_home(name)
                .ok_or_else(|| format!("{name}: no home folder, so ~ cannot be used"));
        };
        let path = inside(folder, name)?;
        // If a thread panicked here, it has added a path or not: the list is whole.
        let mut written = locked(&self.written);
        if existing == Existing::Replaced && path.exists() && !written.contains(&path) {
            return Err(format!(
                "{name}: existed before the script; without --allow-outside, a script replaces only its own files"
            ));
        }
        if existing == Existing::Kept && !path.exists() {
            written.push(path.clone());
        }
        Ok(path)
    }
}

fn inside(folder: &Path, name: &str) -> Result<PathBuf, String> {
    let visible = |component: Component<'_>| match component {
        Component::Normal(name) => !name.as_encoded_bytes().starts_with(b"."),
        _ => false,
    };
    let is_below =
        |path: &Path| path.components().next().is_some() && path.components().all(visible);
    let resolved = || {
        let folder = folder.canonicalize().ok()?;
        let path = folder.join(name);
        let parent = path.parent()?.canonicalize().ok()?;
        let path = parent.join(path.file_name()?);
        is_below(path.strip_prefix(&folder).ok()?).then_some(path)
    };
    resolved().ok_or_else(|| {
        // Only of a path that cannot lead outside may a script learn what exists; `~` is meant as the home folder.
        let parent = Path::new(name).parent();
        let parent = parent.filter(|parent| is_below(parent) && !parent.starts_with("~"));
        // A link on the way may lead outside, where a script may not learn what exists.
        let is_missing = |parent: &&Path| {
            let is_there = |path: &&Path| folder.join(path).symlink_metadata().is_ok();
            let (Ok(own), Some(known)) = (folder.canonicalize(), parent.ancestors().find(is_there))
            else {
                return false;
            };
            let real = folder.join(known).canonicalize();
            known != *parent && real.is_ok_and(|real| real.starts_with(&own))
        };
        match parent.filter(is_missing) {
            Some(parent) => format!("{name}: there is no folder {}", parent.display()),
            None => format!(
                "{name}: without --allow-outside, a script writes only below its folder, and no hidden files"
            ),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_script_writes_below_its_folder_only() {
        let outside = tempfile::tempdir().expect("a folder");
        let folder = outside.path().join("own");
        for path in ["own/deeper", "own/.hidden"] {
            fs::create_dir_all(outside.path().join(path)).expect("made");
        }
        #[cfg(unix)]
        std::os::unix::fs::symlink(outside.path(), folder.join("link")).expect("linked");
        let access = WriteAccess::below(folder.clone());
        let absolute = folder.join("a.csv");
        let absolute = absolute.to_str().expect("text");
        for name in [
            "a.csv",
            "./a.csv",
            "deeper/a.csv",
            "deeper/../a.csv",
            absolute,
        ] {
            assert!(access.path(name, Existing::Kept).is_ok(), "{name}");
        }
        for name in [
            "",
            "..",
            "../a.csv",
            "deeper/../../a.csv",
            "~/a.csv",
            "/a.csv",
            ".a.csv",
            ".hidden/a.csv",
            "link/a.csv",
            "link/nowhere/a.csv",
            "../nowhere/a.csv",
        ] {
            let refused = access.path(name, Existing::Kept).expect_err(name);
            assert!(refused.contains("--allow-outside"), "{refused}");
        }
        let missing = access.path("nowhere/a.csv", Existing::Kept);
        let missing = missing.expect_err("no folder");
        assert_eq!(missing, "nowhere/a.csv: there is no folder nowhere");
    }

    #[test]
    fn a_script_replaces_its_own_files_only() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("theirs.csv"), "").expect("written");
        let access = WriteAccess::below(folder.path().to_owned());
        let own = access.path("own.csv", Existing::Kept).expect("free");
        fs::write(own, "").expect("written");
        assert!(access.path("own.csv", Existing::Replaced).is_ok());
        assert!(
            access.path("theirs.csv", Existing::Kept).is_ok(),
            "refused when it is written"
        );
        let refused = access.path("theirs.csv", Existing::Replaced);
        assert!(refused.is_err_and(|message| message.contains("before the script")));
    }
}
