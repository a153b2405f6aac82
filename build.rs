//! Sets the version that `taxel --version` prints; an optimised build also gets the commit that it was built from.
//!
//! The commit comes from `TAXEL_COMMIT` if a packager sets it, from the published package, or from git; without any of
//! these, only the version is shown. A build for tests has no commit: it would have to be rebuilt after each commit.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// The paths whose changes can change the program.
const SOURCES: [&str; 6] = [
    "src",
    "crates",
    "library",
    "build.rs",
    "Cargo.toml",
    "Cargo.lock",
];

/// The number of characters shown of a commit's name; this is enough for a repository of this size.
const LENGTH: usize = 9;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-env-changed=TAXEL_COMMIT");
    let version = env::var("CARGO_PKG_VERSION").unwrap_or_default();
    let folder = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let optimised = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let named = env::var("TAXEL_COMMIT").ok().filter(|name| is_plain(name));
    let commit = named.or_else(|| optimised.then(|| commit(&folder)).flatten());
    if optimised {
        watch(&folder);
    }
    let shown = match commit {
        Some(commit) => format!("{version} ({commit})"),
        None => version,
    };
    println!("cargo:rustc-env=TAXEL_VERSION={shown}");
}

/// Returns the commit of the package in a folder, with ", changed" if its sources were changed since.
pub(crate) fn commit(folder: &Path) -> Option<String> {
    packaged(folder).or_else(|| {
        // A repository around the package that does not contain it tells nothing about its commit.
        let top = fs::canonicalize(git(folder, &["rev-parse", "--show-toplevel"])?).ok()?;
        if top != fs::canonicalize(folder).ok()? {
            return None;
        }
        let commit = git(folder, &["rev-parse", "HEAD"])?;
        let commit = commit.get(..LENGTH)?;
        let status = ["status", "--porcelain", "--untracked-files=no", "--"];
        let changed = git(folder, &[&status[..], &SOURCES].concat())?;
        let changed = if changed.is_empty() { "" } else { ", changed" };
        Some(format!("{commit}{changed}"))
    })
}

/// Returns the commit that `cargo package` recorded.
fn packaged(folder: &Path) -> Option<String> {
    let noted = fs::read_to_string(folder.join(".cargo_vcs_info.json")).ok()?;
    let (_, rest) = noted.split_once("\"sha1\"")?;
    let commit = rest.split('"').nth(1)?;
    let short = commit.get(..LENGTH).filter(|_| is_plain(commit))?;
    // `cargo package --allow-dirty` packs changed files.
    let changed = noted.contains("\"dirty\": true");
    Some(format!("{short}{}", if changed { ", changed" } else { "" }))
}

/// Returns true if a name has only letters and digits, so that nothing else gets into the program's output.
fn is_plain(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric())
}

/// Makes cargo run this script again when another commit is checked out or the sources change.
fn watch(folder: &Path) {
    let paths = SOURCES.map(|source| folder.join(source));
    let branch = git(folder, &["rev-parse", "--symbolic-full-name", "HEAD"]);
    let of_git = ["HEAD", "packed-refs", branch.as_deref().unwrap_or("HEAD")]
        .map(|name| git(folder, &["rev-parse", "--git-path", name]))
        .into_iter()
        .flatten()
        .map(|path| folder.join(path));
    // Cargo considers a missing file changed at every build.
    for path in paths.into_iter().chain(of_git).filter(|path| path.exists()) {
        println!("cargo:rerun-if-changed={}", path.display());
    }
}

/// The environment variables by which a git hook points git to a repository other than the folder's.
pub(crate) const OF_GIT: [&str; 4] = [
    "GIT_DIR",
    "GIT_WORK_TREE",
    "GIT_INDEX_FILE",
    "GIT_OBJECT_DIRECTORY",
];

/// Runs git and returns what it prints; None if it fails or is not installed.
fn git(folder: &Path, arguments: &[&str]) -> Option<String> {
    let mut command = Command::new("git");
    for variable in OF_GIT {
        command.env_remove(variable);
    }
    let output = command
        .arg("-C")
        .arg(folder)
        .args(arguments)
        .output()
        .ok()?;
    let answer = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| answer.trim().to_owned())
}
