//! A file that does not have its final name yet.
//!
//! If the file system has files without a name (`O_TMPFILE`, on Linux), the file has none until it is complete: a
//! program that is killed leaves nothing behind. Elsewhere it is called `.taxel-tmp-XXXXXXXXXXXXXXXX`, with a random
//! ending, in the folder that it is for, and its writer holds a lock on it. Such a file without a lock was left by a
//! program that died; the next program that writes into the folder removes it ([`remove_left_over`]). The name is long
//! and strange, so that no file of a user has one like it.

use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant, SystemTime};

use tempfile::{Builder, NamedTempFile, TempPath};

use crate::lock::locked;
use crate::storage::access::keep_access;

/// The beginning of the name of a temporary file.
const PREFIX: &str = ".taxel-tmp-";

/// The number of random letters and digits that follow the prefix: more than a word has.
const RANDOM: usize = 16;

/// The age at which a file without a lock is removed, since its last change: a younger one may have been made just
/// now.
const FRESH: Duration = Duration::from_secs(60);

/// The age at which a file is removed if the file system has no locks, so that nothing shows whether the writer still
/// runs.
const FRESH_WITHOUT_LOCKS: Duration = Duration::from_secs(24 * 60 * 60);

/// A file without its final name. If it is dropped, nothing is left of it.
#[derive(Debug)]
pub(crate) struct TemporaryFile {
    file: File,
    /// The temporary name; None if the file has no name.
    path: Option<TempPath>,
}

impl TemporaryFile {
    /// Creates a file in a folder, with the permissions that the user's files usually have. A private one can be opened
    /// by its owner only.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(crate) fn new(folder: &Path, is_private: bool) -> io::Result<Self> {
        remove_left_over(folder);
        let made = match unnamed(folder) {
            // Nobody else can open it as long as it has no name.
            Some(file) => Self { file, path: None },
            None => Self::named(folder, is_private)?,
        };
        // File systems without locks are accepted.
        let _ = made.file.try_lock();
        Ok(made)
    }

    /// Creates a file with this path, otherwise like [`Self::new`]. Only for a caller that holds a lock on the folder.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(crate) fn at(path: &Path, is_private: bool) -> io::Result<Self> {
        Ok(Self {
            file: options(is_private).open(path)?,
            path: Some(TempPath::try_from_path(path)?),
        })
    }

    /// Creates a file under a random name.
    fn named(folder: &Path, is_private: bool) -> io::Result<Self> {
        // Not with the builder's own method: its permissions are always tight, and its error names the temporary file
        // instead of giving the system's message.
        let options = options(is_private);
        let made = builder().make_in(folder, |path| options.open(path))?;
        let (file, path) = made.into_parts();
        Ok(Self {
            file,
            path: Some(path),
        })
    }

    /// Returns the open file.
    pub(crate) fn file(&self) -> &File {
        &self.file
    }

    /// Gives the file its name, in place of the file that has it if `replace`. Returns the open file that has the
    /// name: a copy if the file system cannot link a file without a name.
    ///
    /// # Errors
    /// Returns [`ErrorKind::AlreadyExists`] if a file of that name exists and must be kept, or the system's error.
    pub(crate) fn persist(self, folder: &Path, path: &Path, replace: bool) -> io::Result<File> {
        let (file, named) = match self.path {
            Some(named) => (self.file, named),
            None if !replace => match link(&self.file, path) {
                Err(error) if error.kind() != ErrorKind::AlreadyExists => {
                    copied(self.file, folder)?
                }
                linked => return linked.map(|()| self.file),
            },
            None => {
                // A link cannot replace a file; renaming can.
                let linked = builder().make_in(folder, |path| link(&self.file, path));
                match linked {
                    Ok(linked) => (self.file, NamedTempFile::into_parts(linked).1),
                    Err(_) => copied(self.file, folder)?,
                }
            }
        };
        rename(named, path, replace).map(|()| file)
    }
}

impl Write for TemporaryFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for TemporaryFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// A file that is being replaced, under a temporary name. If it is dropped, the file is deleted.
#[derive(Debug)]
pub(crate) struct OldFile {
    /// The file's own name.
    path: PathBuf,
    temporary: TempPath,
    /// The lock that keeps other writers from removing the file. Without locks there is no such protection.
    _lock: Option<File>,
}

impl OldFile {
    /// Gives a regular file a temporary name in its folder, beside its own.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(crate) fn linked(folder: &Path, path: &Path) -> io::Result<Self> {
        Self::named(folder, path, |temporary| fs::hard_link(path, temporary))
    }

    /// Gives a regular file a temporary name in its folder, in place of its own.
    ///
    /// # Errors
    /// Returns the system's error.
    pub(crate) fn moved(folder: &Path, path: &Path) -> io::Result<Self> {
        Self::named(folder, path, |temporary| {
            match temporary.symlink_metadata() {
                Ok(_) => Err(ErrorKind::AlreadyExists.into()),
                Err(_) => fs::rename(path, temporary),
            }
        })
    }

    fn named(
        folder: &Path,
        path: &Path,
        name: impl FnMut(&Path) -> io::Result<()>,
    ) -> io::Result<Self> {
        let lock = File::open(path).ok();
        let locked = lock.inspect(|file| drop(file.try_lock()));
        let named = builder()
            .make_in(folder, name)
            .map_err(|error| plain(&error))?;
        Ok(Self {
            path: path.to_owned(),
            temporary: named.into_temp_path(),
            _lock: locked,
        })
    }

    /// Gives the file its own name again, in place of the file that has it.
    ///
    /// # Errors
    /// Returns a message that says where the file stays if the system refuses.
    pub(crate) fn put_back(self) -> Result<(), String> {
        self.temporary.persist(&self.path).map_err(|failed| {
            let mut temporary = failed.path;
            temporary.disable_cleanup(true);
            let (path, temporary) = (self.path.display(), temporary.display());
            format!(
                "the old {path} is now {temporary}; rename it, since taxel removes such files when it next writes there"
            )
        })
    }
}

/// Returns the options to create a file that its owner can read and write, and if it is not private also others, as
/// the umask has it.
#[cfg_attr(
    not(unix),
    expect(unused_variables, reason = "files have no modes there")
)]
fn options(is_private: bool) -> OpenOptions {
    let mut options = File::options();
    options.read(true).write(true).create_new(true);
    #[cfg(unix)]
    if is_private {
        std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    }
    options
}

/// Returns a builder of random names for temporary files.
pub(super) fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).rand_bytes(RANDOM);
    builder
}

/// Returns the system's own message, without the path that a library adds.
pub(super) fn plain(error: &io::Error) -> io::Error {
    match error.raw_os_error() {
        Some(code) => io::Error::from_raw_os_error(code),
        None => error.kind().into(),
    }
}

/// Renames a file to `path`, replacing the file there, if any.
fn rename(from: TempPath, path: &Path, replace: bool) -> io::Result<()> {
    let renamed = if replace {
        from.persist(path)
    } else {
        from.persist_noclobber(path)
    };
    let Err(failed) = renamed else {
        return Ok(());
    };
    // The file system has neither links nor a renaming that keeps the other file: an empty file takes the name first.
    let unsupported = !replace
        && matches!(
            failed.error.kind(),
            ErrorKind::PermissionDenied | ErrorKind::Unsupported | ErrorKind::InvalidInput
        );
    if !unsupported {
        return Err(plain(&failed.error));
    }
    File::options().write(true).create_new(true).open(path)?;
    failed.path.persist(path).map_err(|failed| {
        let _ = fs::remove_file(path);
        plain(&failed.error)
    })
}

/// Copies the content to a file with a random name, for a file system that cannot link a file without a name.
fn copied(mut file: File, folder: &Path) -> io::Result<(File, TempPath)> {
    let mut copy = TemporaryFile::named(folder, true)?;
    file.rewind()?;
    keep_access(&copy.file, of_descriptor(&file).as_ref(), &file.metadata()?)?;
    io::copy(&mut Read::by_ref(&mut file), &mut copy.file)?;
    copy.file.sync_all()?;
    let path = copy.path.ok_or(ErrorKind::NotFound)?;
    Ok((copy.file, path))
}

/// Creates a file without a name; None if the system has no such files, or could not name the file later.
#[cfg(target_os = "linux")]
fn unnamed(folder: &Path) -> Option<File> {
    use rustix::fs::{Mode, OFlags, open};
    let flags = OFlags::RDWR | OFlags::TMPFILE | OFlags::CLOEXEC;
    let file: File = open(folder, flags, Mode::from_raw_mode(0o666)).ok()?.into();
    // Without /proc it would stay without a name.
    fs::symlink_metadata(of_descriptor(&file)).ok()?;
    Some(file)
}

/// Gives a file without a name one that is free.
#[cfg(target_os = "linux")]
fn link(file: &File, path: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, linkat};
    Ok(linkat(
        CWD,
        of_descriptor(file),
        CWD,
        path,
        AtFlags::SYMLINK_FOLLOW,
    )?)
}

/// Returns the path under which the system lists an open file.
#[cfg(target_os = "linux")]
fn of_descriptor(file: &File) -> String {
    use std::os::fd::AsRawFd;
    format!("/proc/self/fd/{}", file.as_raw_fd())
}

/// Returns None: on other systems every file has a name.
#[cfg(not(target_os = "linux"))]
fn unnamed(_: &Path) -> Option<File> {
    None
}

/// Never called: there is no file without a name.
#[cfg(not(target_os = "linux"))]
fn of_descriptor(_: &File) -> String {
    String::new()
}

/// Never called: there is no file without a name.
#[cfg(not(target_os = "linux"))]
fn link(_: &File, _: &Path) -> io::Result<()> {
    Err(ErrorKind::Unsupported.into())
}

/// Removes the temporary files that programs have left in a folder when they died. What cannot be removed stays.
///
/// A folder is searched once a minute at most, since a program may write thousands of files into it.
fn remove_left_over(folder: &Path) {
    if was_searched(folder) {
        return;
    }
    for path in temporaries(folder) {
        if is_left_over(&path).unwrap_or(false) {
            let _ = fs::remove_file(path);
        }
    }
}

/// Returns true if this program has searched a folder in the last minute; notes that it has from now on.
fn was_searched(folder: &Path) -> bool {
    static SEARCHED: Mutex<BTreeMap<PathBuf, Instant>> = Mutex::new(BTreeMap::new());
    let mut searched = locked(&SEARCHED);
    searched.retain(|_, at| at.elapsed() < FRESH);
    let is_new = !searched.contains_key(folder);
    if is_new {
        searched.insert(folder.to_owned(), Instant::now());
    }
    !is_new
}

/// Iterates over the paths in a folder that are named like something temporary.
pub(super) fn temporaries(folder: &Path) -> impl Iterator<Item = PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let named = entries.filter(|entry| entry.file_name().to_str().is_some_and(is_temporary));
    named.map(|entry| entry.path())
}

/// Returns true if a name is that of a temporary file: `.taxel-tmp-` and sixteen letters or digits.
pub(crate) fn is_temporary(name: &str) -> bool {
    let random = name.strip_prefix(PREFIX);
    random.is_some_and(|random| {
        random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
    })
}

/// Returns true if the program that held the lock of a regular file has died.
pub(super) fn is_left_over(path: &Path) -> io::Result<bool> {
    let found = path.symlink_metadata()?;
    if !found.file_type().is_file() {
        return Ok(false);
    }
    let age = SystemTime::now().duration_since(found.modified()?);
    // A time in the future: a clock was changed.
    let Ok(age) = age else { return Ok(false) };
    Ok(age > FRESH
        && match File::open(path)?.try_lock() {
            Ok(()) => true,
            Err(fs::TryLockError::WouldBlock) => false,
            Err(fs::TryLockError::Error(_)) => age > FRESH_WITHOUT_LOCKS,
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Makes a file with a name and an age.
    fn aged(folder: &Path, name: &str, age: Duration) -> File {
        let file = File::create(folder.join(name)).expect("made");
        file.set_modified(SystemTime::now() - age).expect("aged");
        file
    }

    #[test]
    fn the_next_writer_removes_what_dead_programs_left() {
        let folder = tempfile::tempdir().expect("a folder");
        let hour = Duration::from_secs(3600);
        // Other files, also those that a user may have called like this.
        let stays = [
            ".taxel-backup",
            ".taxel-config",
            ".taxel-tmp",
            ".taxel-tmp-a b c d e f g h ",
            ".taxel-tmp-backup",
            ".taxel-tmp-toolong0toolong0t",
            "taxel-tmp-AbC123AbC123AbC1",
        ];
        for name in stays {
            aged(folder.path(), name, hour);
        }
        aged(folder.path(), ".taxel-tmp-AbC123AbC123AbC1", hour);
        let fresh = ".taxel-tmp-Fresh1Fresh1Fres";
        aged(folder.path(), fresh, Duration::ZERO);
        let held = ".taxel-tmp-Held01Held01Held";
        let lock = aged(folder.path(), held, hour);
        lock.lock().expect("locked");
        drop(TemporaryFile::new(folder.path(), false).expect("made"));
        let files = fs::read_dir(folder.path()).expect("read");
        let names = files.map(|entry| entry.expect("read").file_name());
        let left: BTreeSet<_> = names
            .map(|name| name.into_string().expect("text"))
            .collect();
        let expected = stays.into_iter().chain([fresh, held]);
        assert_eq!(left, expected.map(str::to_owned).collect());
        // The folder was searched just now.
        let later = ".taxel-tmp-Later1Later1Late";
        aged(folder.path(), later, hour);
        drop(TemporaryFile::new(folder.path(), false).expect("made"));
        assert!(folder.path().join(later).exists());
    }

    #[cfg(unix)]
    #[test]
    fn a_private_file_is_never_open_to_others() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().expect("a folder");
        let named = TemporaryFile::named(folder.path(), true);
        let at = TemporaryFile::at(&folder.path().join("at"), true);
        for made in [named, at] {
            let found = made.expect("made").file().metadata().expect("there");
            assert_eq!(found.permissions().mode() & 0o777, 0o600);
        }
    }

    #[test]
    fn a_file_gets_its_name_however_it_was_made() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a");
        let ways: [fn(&Path, bool) -> io::Result<TemporaryFile>; 2] =
            [TemporaryFile::new, TemporaryFile::named];
        for make in ways {
            for (replace, content) in [(false, "one"), (true, "two")] {
                let mut file = make(folder.path(), false).expect("made");
                file.write_all(content.as_bytes()).expect("written");
                let mut file = file.persist(folder.path(), &path, replace).expect("named");
                assert_eq!(fs::read_to_string(&path).ok().as_deref(), Some(content));
                file.write_all(b"!").expect("written");
                let more = format!("{content}!");
                assert_eq!(fs::read_to_string(&path).ok(), Some(more));
            }
            let file = make(folder.path(), false).expect("made");
            let kept = file
                .persist(folder.path(), &path, false)
                .expect_err("it is there");
            assert_eq!(kept.kind(), ErrorKind::AlreadyExists);
            fs::remove_file(&path).expect("removed");
        }
        let mut file = TemporaryFile::new(folder.path(), false).expect("made");
        file.write_all(b"three").expect("written");
        let (mut open, copy) = copied(file.file, folder.path()).expect("copied");
        open.write_all(b", four").expect("written");
        assert_eq!(
            fs::read_to_string(&copy).ok().as_deref(),
            Some("three, four")
        );
        drop(copy);
        assert_eq!(fs::read_dir(folder.path()).expect("read").count(), 0);
    }
}
