//! Permissions and owners of files: a file that replaces another one is for the same people, and a file that cannot be
//! replaced is found before the work.
//!
//! Outside of Unix, files have neither modes nor groups, and the system's errors are all that is known.

use std::fs::{File, Metadata};
use std::io;
use std::path::Path;

/// The bit of a folder's mode by which only the owner of a file may replace or remove it.
#[cfg(unix)]
const STICKY: u32 = 0o1000;

/// Gives a new file the owner, the group, the permissions and the access list of the file that it replaces, as far as
/// the system lets this user. The new file can be read and written by nobody, apart from its writer, who could not do
/// so with the old one. The bits that make a file run as its owner or group are dropped: the file has other content,
/// and perhaps another owner.
///
/// # Errors
/// Returns the system's error if the file would be open to more people than the old one.
#[cfg(unix)]
pub(crate) fn keep_access(new: &File, path: &Path, old: &Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, fchown};
    let found = new.metadata()?;
    let mut mode = old.mode() & 0o777;
    let is_same = (found.uid(), found.gid()) == (old.uid(), old.gid());
    // Only a privileged user may give files away; a member of a group may give it the file.
    let is_given = is_same
        || fchown(new, Some(old.uid()), Some(old.gid()))
            .or_else(|_| fchown(new, None, Some(old.gid())))
            .is_ok();
    if !is_given {
        // The members of the old group are others now, and those of the new one were others before: all get only
        // what both had.
        let common = mode >> 3 & mode & 0o7;
        mode = mode & 0o700 | common << 3 | common;
    }
    if !keep_list(new, path, is_given) {
        mode &= 0o700;
    }
    set_mode(new, new.metadata()?.mode() & 0o777, mode)
}

/// Gives a new file the access list of the one at a path, or none if that has none: a list grants and denies what the
/// mode does not show. Returns false if the new file cannot have the same list.
#[cfg(target_os = "linux")]
fn keep_list(new: &File, path: &Path, is_of_same_group: bool) -> bool {
    use rustix::fs::{XattrFlags, fremovexattr, fsetxattr, getxattr};
    use rustix::io::Errno;
    const LIST: &str = "system.posix_acl_access";
    /// The size of the largest attribute that the system has, in bytes.
    const LARGEST: usize = 1 << 16;
    let mut list = vec![0; LARGEST];
    match getxattr(path, LIST, &mut list[..]) {
        Ok(length) => {
            is_of_same_group && fsetxattr(new, LIST, &list[..length], XattrFlags::empty()).is_ok()
        }
        // A new file may have inherited a list from its folder.
        Err(Errno::NODATA) => matches!(fremovexattr(new, LIST), Ok(()) | Err(Errno::NODATA)),
        Err(error) => error == Errno::OPNOTSUPP,
    }
}

/// Returns true: lists are kept on Linux only.
#[cfg(all(unix, not(target_os = "linux")))]
fn keep_list(_: &File, _: &Path, _: bool) -> bool {
    true
}

/// Sets the mode of a file unless it has it. Where only the owner may set it, or where files have no modes of their
/// own, a mode that opens the file to nobody else is accepted as it is.
#[cfg(unix)]
fn set_mode(file: &File, now: u32, mode: u32) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    if now == mode {
        return Ok(());
    }
    let set = file.set_permissions(PermissionsExt::from_mode(mode));
    let is_open_to_more = (now | mode) & 0o077 != mode & 0o077;
    if is_open_to_more { set } else { Ok(()) }
}

/// Gives a new file the permissions of the file that it replaces.
#[cfg(not(unix))]
pub(crate) fn keep_access(new: &File, _: &Path, old: &Metadata) -> io::Result<()> {
    new.set_permissions(old.permissions())
}

/// Opens a file or a folder that was just made in a folder to all who may write there, regardless of the umask. What
/// root makes then belongs to the folder's owner. If the system refuses, it stays as it is.
#[cfg(unix)]
pub(crate) fn share(new: &File, folder: &Path) {
    use std::os::unix::fs::{MetadataExt, fchown};
    let (Ok(found), Ok(folder)) = (new.metadata(), folder.metadata()) else {
        return;
    };
    let writers = |class: u32| {
        let may_write = folder.mode() & class & 0o222 != 0;
        if may_write { folder.mode() & class } else { 0 }
    };
    let (mut group, others) = (writers(0o070), writers(0o007));
    let is_same = (found.uid(), found.gid()) == (folder.uid(), folder.gid());
    if !is_same && fchown(new, Some(folder.uid()), Some(folder.gid())).is_err() {
        let is_given = group != 0 && fchown(new, None, Some(folder.gid())).is_ok();
        // Another group may do what everybody may.
        group = if is_given { group } else { others << 3 };
    }
    // A file is not run; a folder like `/tmp` has inner ones like it.
    let kept = if found.is_dir() { 0o1777 } else { 0o666 };
    let sticky = folder.mode() & STICKY;
    let now = found.mode() & 0o7777;
    let _ = set_mode(new, now, now | (group | others | sticky) & kept);
}

/// Checks whether a file can be replaced, so that an error comes before the work rather than after it. What only the
/// attempt shows is not found.
///
/// # Errors
/// Returns an error that says why this user cannot replace the file.
#[cfg(unix)]
pub(crate) fn check_replaceable(path: &Path, folder: &Path, file: &Metadata) -> io::Result<()> {
    if is_protected(folder, file) {
        let reason = "it belongs to another user, and in this folder only the owner of a file may replace it";
        return Err(io::Error::new(io::ErrorKind::PermissionDenied, reason));
    }
    check_attributes(path)
}

/// Returns true if a folder is like `/tmp`, and this user owns neither the folder nor the file in it.
#[cfg(unix)]
fn is_protected(folder: &Path, file: &Metadata) -> bool {
    is_protected_from(rustix::process::geteuid().as_raw(), folder, file)
}

#[cfg(unix)]
fn is_protected_from(user: u32, folder: &Path, file: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    let is_sticky = |folder: Metadata| {
        folder.mode() & STICKY != 0 && ![0, folder.uid(), file.uid()].contains(&user)
    };
    folder.metadata().is_ok_and(is_sticky)
}

/// Refuses a file that the system replaces for no user. A system that does not know these attributes refuses only
/// later.
#[cfg(target_os = "linux")]
fn check_attributes(path: &Path) -> io::Result<()> {
    use rustix::fs::{AtFlags, CWD, StatxAttributes, StatxFlags, statx};
    let found = statx(CWD, path, AtFlags::SYMLINK_NOFOLLOW, StatxFlags::empty());
    let attributes = found.map_or(StatxAttributes::empty(), |found| found.stx_attributes);
    let reason = if attributes.contains(StatxAttributes::MOUNT_ROOT) {
        "it is a mount point, which cannot be replaced"
    } else if attributes.intersects(StatxAttributes::IMMUTABLE | StatxAttributes::APPEND) {
        "it is marked as immutable or append-only (chattr)"
    } else {
        return Ok(());
    };
    Err(io::Error::new(io::ErrorKind::PermissionDenied, reason))
}

/// Returns Ok: such attributes are asked for on Linux only.
#[cfg(all(unix, not(target_os = "linux")))]
fn check_attributes(_: &Path) -> io::Result<()> {
    Ok(())
}

/// Returns Ok: only the attempt shows it.
#[cfg(not(unix))]
pub(crate) fn check_replaceable(_: &Path, _: &Path, _: &Metadata) -> io::Result<()> {
    Ok(())
}

/// Returns true if this user may remove a file, apart from a whole file system that is read-only at present.
#[cfg(unix)]
pub(crate) fn is_removable(path: &Path) -> bool {
    use rustix::fs::{Access, access};
    use rustix::io::Errno;
    let (Some(folder), Ok(file)) = (path.parent(), path.symlink_metadata()) else {
        return false;
    };
    let may_write = access(folder, Access::WRITE_OK | Access::EXEC_OK);
    !matches!(may_write, Err(Errno::ACCESS | Errno::PERM)) && !is_protected(folder, &file)
}

/// Returns true: only the attempt shows it.
#[cfg(not(unix))]
pub(crate) fn is_removable(_: &Path) -> bool {
    true
}

/// Does nothing: there is no umask.
#[cfg(not(unix))]
pub(crate) fn share(_: &File, _: &Path) {}

#[cfg(all(test, unix))]
#[path = "../../../../tests/common/skip.rs"]
mod skip;

#[cfg(all(test, unix))]
mod tests {
    use super::skip::{lacking, skipped};
    use super::*;
    use std::fs::{self, Permissions};
    use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};

    fn set(path: &Path, mode: u32) {
        fs::set_permissions(path, Permissions::from_mode(mode)).expect("set");
    }

    fn mode(path: &Path) -> u32 {
        path.metadata().expect("there").mode() & 0o7777
    }

    #[test]
    fn a_new_file_is_for_the_same_people_as_the_old_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let (old, new) = (folder.path().join("old"), folder.path().join("new"));
        fs::write(&old, "").expect("written");
        for (own, expected) in [(0o640, 0o640), (0o600, 0o600), (0o4755, 0o755)] {
            set(&old, own);
            // Only root may give a file to others.
            let given = chown(&old, Some(1001), Some(2000)).is_ok();
            let file = File::create(&new).expect("made");
            let found = old.metadata().expect("there");
            keep_access(&file, &old, &found).expect("kept");
            assert_eq!(mode(&new), expected);
            let is_same = |new: &Metadata| (new.uid(), new.gid()) == (found.uid(), found.gid());
            assert!(is_same(&file.metadata().expect("there")), "{given}");
            fs::remove_file(&new).expect("removed");
        }
    }

    /// With the mode alone, the group would get what the list grants to a user, and a new file inherits a list.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_new_file_has_the_access_list_of_the_old_one() {
        use std::process::Command;
        let folder = tempfile::tempdir().expect("a folder");
        let run = |program: &str, arguments: &[&str], path: &Path| {
            let run = Command::new(program).args(arguments).arg(path).output();
            run.map(|run| String::from_utf8(run.stdout).expect("text"))
        };
        let granted = ["-m", "user:1002:rw,group::---"];
        let list = |path: &Path| run("getfacl", &["-cpn"], path).expect("getfacl");
        let probe = folder.path().join("probe");
        fs::write(&probe, "").expect("written");
        if run("setfacl", &granted, &probe).is_err() {
            lacking("setfacl");
            return;
        }
        if !list(&probe).contains("user:1002:rw") {
            skipped("the file system for temporary files has no access lists");
            return;
        }
        run("setfacl", &["-dm", "user:1003:rw"], folder.path()).expect("set");
        for (name, granted) in [("list", Some(granted)), ("none", None)] {
            let (old, new) = (folder.path().join("old"), folder.path().join(name));
            fs::write(&old, "").expect("written");
            run("setfacl", &["-b"], &old).expect("set");
            set(&old, 0o640);
            if let Some(granted) = granted {
                run("setfacl", &granted, &old).expect("set");
            }
            let file = File::create(&new).expect("made");
            assert!(list(&new).contains("user:1003"), "inherited");
            keep_access(&file, &old, &old.metadata().expect("there")).expect("kept");
            assert_eq!(list(&new), list(&old), "{name}");
            assert_eq!(mode(&new), mode(&old), "{name}");
        }
        // For another group, the list would be for other people.
        let (old, new) = (folder.path().join("list"), folder.path().join("closed"));
        let file = File::create(&new).expect("made");
        assert!(!keep_list(&file, &old, false));
    }

    #[test]
    fn a_mount_point_is_refused_before_the_work() {
        #[cfg(target_os = "linux")]
        {
            use rustix::fs::{AtFlags, CWD, StatxAttributes, StatxFlags, statx};
            let root = Path::new("/");
            // Kernels before 5.8 do not say it.
            let known = statx(CWD, root, AtFlags::empty(), StatxFlags::empty());
            let mask = known.map(|found| found.stx_attributes_mask);
            if mask.is_ok_and(|mask| mask.contains(StatxAttributes::MOUNT_ROOT)) {
                let refused = check_replaceable(root, root, &root.metadata().expect("there"));
                let refused = refused.expect_err("a mount point").to_string();
                assert!(refused.contains("mount point"), "{refused}");
            }
        }
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("own");
        fs::write(&path, "").expect("written");
        let found = path.metadata().expect("there");
        check_replaceable(&path, folder.path(), &found).expect("replaceable");
        assert!(is_removable(&path));
    }

    #[test]
    fn only_the_owner_replaces_a_file_in_a_folder_like_tmp() {
        if !rustix::process::geteuid().is_root() {
            skipped(
                "replacing files of others in a folder like /tmp: only root can make such files",
            );
            return;
        }
        let folder = tempfile::tempdir().expect("a folder");
        set(folder.path(), 0o1777);
        let path = folder.path().join("theirs");
        fs::write(&path, "").expect("written");
        chown(&path, Some(1001), None).expect("given");
        let found = path.metadata().expect("there");
        let replaceable = check_replaceable(&path, folder.path(), &found);
        replaceable.expect("root may replace it");
        for (user, expected) in [(0, false), (1001, false), (1002, true)] {
            let is_other = is_protected_from(user, folder.path(), &found);
            assert_eq!(is_other, expected, "{user}");
        }
    }

    /// The umask of its maker does not close a lock to the others who share a library.
    #[test]
    fn what_is_made_in_a_shared_folder_is_shared() {
        let folder = tempfile::tempdir().expect("a folder");
        let (file, inner) = (folder.path().join("file"), folder.path().join("inner"));
        fs::write(&file, "").expect("written");
        fs::create_dir(&inner).expect("made");
        for (shared, expected) in [
            (0o755, (0o600, 0o700)),
            (0o775, (0o660, 0o770)),
            (0o777, (0o666, 0o777)),
            (0o1777, (0o666, 0o1777)),
        ] {
            set(&file, 0o600);
            set(&inner, 0o700);
            set(folder.path(), shared);
            for path in [&file, &inner] {
                share(&File::open(path).expect("opened"), folder.path());
            }
            assert_eq!((mode(&file), mode(&inner)), expected, "{shared:o}");
        }
        // Only root may give a folder away.
        if chown(folder.path(), Some(1001), Some(1001)).is_ok() {
            share(&File::open(&file).expect("opened"), folder.path());
            let found = file.metadata().expect("there");
            assert_eq!((found.uid(), found.gid()), (1001, 1001));
        }
    }
}
