//! Tests the commit that a build reports.

use std::path::Path;
use std::process::Command;

#[path = "../../build.rs"]
#[expect(dead_code, reason = "its main is cargo's to call")]
mod build;

fn git(folder: &Path, line: &str) -> String {
    let mut command = Command::new("git");
    // A git hook runs the tests with the variables of its own repository; and the user's settings may sign commits.
    for variable in build::OF_GIT {
        command.env_remove(variable);
    }
    command.envs([
        ("GIT_CONFIG_GLOBAL", "/dev/null"),
        ("GIT_CONFIG_NOSYSTEM", "1"),
    ]);
    let output = command
        .arg("-C")
        .arg(folder)
        .args(["-c", "user.name=test", "-c", "user.email=test@localhost"])
        .args(line.split(' '))
        .output()
        .expect("git runs");
    assert!(output.status.success(), "git {line}: {output:?}");
    String::from_utf8(output.stdout).expect("text")
}

#[test]
fn without_git_the_commit_is_the_one_noted_in_the_package() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_eq!(build::commit(folder.path()), None);
    let note = folder.path().join(".cargo_vcs_info.json");
    for (noted, commit) in [
        (
            "{\n  \"git\": {\n    \"sha1\": \"0123456789abcdef0123456789abcdef01234567\"\n  },\n  \"path_in_vcs\": \"\"\n}",
            Some("012345678"),
        ),
        ("{\"git\":{\"sha1\":\"0123\"}}", None),
        ("{\"git\":{\"sha1\":\"0123456789\u{1b}[2J\"}}", None),
        ("{}", None),
    ] {
        std::fs::write(&note, noted).expect("written");
        assert_eq!(build::commit(folder.path()).as_deref(), commit, "{noted}");
    }
}

#[test]
fn the_commit_is_read_from_the_packages_own_repository() {
    if Command::new("git").arg("--version").output().is_err() {
        crate::skip::lacking("git");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let (folder, inner) = (folder.path(), folder.path().join("src"));
    git(folder, "init -q");
    std::fs::create_dir(&inner).expect("a folder");
    std::fs::write(inner.join("main.rs"), "fn main() {}\n").expect("written");
    git(folder, "add .");
    git(folder, "commit -q -m first");
    let head = git(folder, "rev-parse HEAD")[..9].to_owned();
    assert_eq!(build::commit(folder), Some(head.clone()));
    assert_eq!(build::commit(&inner), None, "a package inside of another");
    std::fs::write(inner.join("main.rs"), "fn main() { loop {} }\n").expect("written");
    assert_eq!(build::commit(folder), Some(format!("{head}, changed")));
}
