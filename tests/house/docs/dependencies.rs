//! The page about dependencies, made from the comments of `Cargo.toml`, the output of `cargo tree` and `deny.toml`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::process::Command;
use std::sync::LazyLock;

use crate::docs::{document, root};

/// The text of `Cargo.toml` with its comments. A package has it as `Cargo.toml.orig`, because cargo strips the
/// comments.
static MANIFEST: LazyLock<String> = LazyLock::new(|| {
    let written = root().join("Cargo.toml.orig");
    fs::read_to_string(written).unwrap_or_else(|_| document("Cargo.toml"))
});
const DENY: &str = include_str!("../../../deny.toml");

/// Returns the whole generated block.
pub(crate) fn block() -> String {
    let tree = tree("normal");
    let (own, tests) = (direct("dependencies"), direct("dev-dependencies"));
    let skipped: String = skipped()
        .into_iter()
        .map(|(name, reason)| format!("- `{name}`: {reason}.\n"))
        .collect();
    format!(
        "\nThe program is made of {} crates, counting itself and crates that run only at build time \
         (`cargo tree -e normal --prefix none --no-dedupe | sort -u | wc -l`).\n\
         It depends on {} of them directly:\n\n{}\n\
         An older version of these crates is included, too, because other crates still need it:\n\n{skipped}\n\
         Tests and benchmarks also use:\n\n{}\n",
        tree.len(),
        own.len(),
        table(&own),
        table(&tests),
    )
}

fn table(rows: &[(&str, String)]) -> String {
    let rows: String = rows
        .iter()
        .map(|(name, reason)| format!("| `{name}` | {reason} |\n"))
        .collect();
    format!("| crate | purpose |\n|---|---|\n{rows}")
}

/// Returns the crates in a section of the manifest, each with the comment above it.
fn direct(section: &str) -> Vec<(&'static str, String)> {
    let (_, rest) = MANIFEST
        .split_once(&format!("\n[{section}]\n"))
        .expect("the manifest has the section");
    let lines = rest.lines().take_while(|line| !line.starts_with('['));
    let mut reason: Vec<&str> = Vec::new();
    let mut found = Vec::new();
    for line in lines {
        if let Some(comment) = line.strip_prefix('#') {
            reason.push(comment.trim());
        } else if let Some((name, _)) = line.split_once(" = ") {
            assert!(!reason.is_empty(), "Cargo.toml says why it uses {name}");
            found.push((name, std::mem::take(&mut reason).join(" ")));
        }
    }
    found
}

/// Returns the names and versions of all crates in the dependency tree, for these kinds of dependencies.
fn tree(kinds: &str) -> BTreeSet<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or("cargo".into());
    let output = Command::new(cargo)
        .args(["tree", "--offline", "--locked", "--no-dedupe"])
        .args(["--edges", kinds, "--prefix", "none"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo can be started");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "cargo tree: {said}");
    let text = String::from_utf8(output.stdout).expect("names are text");
    text.lines().map(str::to_owned).collect()
}

/// Returns the crates that `deny.toml` allows in more than one version, with the reasons.
fn skipped() -> Vec<(&'static str, &'static str)> {
    let quoted = |line: &'static str, key: &str| {
        let (_, rest) = line.split_once(&format!("{key} = \""))?;
        Some(rest.split_once('"')?.0)
    };
    DENY.lines()
        .filter(|line| line.trim_start().starts_with("{ crate = "))
        .map(|line| {
            let both = (quoted(line, "crate"), quoted(line, "reason"));
            let (Some(name), Some(reason)) = both else {
                panic!("deny.toml: no name or no reason in {line}");
            };
            (name, reason)
        })
        .collect()
}

/// The limit is this project's own.
#[test]
fn the_program_has_at_most_140_crates() {
    let crates = tree("normal");
    assert!(
        crates.iter().any(|line| line.starts_with("clap ")),
        "the tree is that of the program"
    );
    assert!(crates.len() <= 140, "{} crates", crates.len());
}

#[test]
fn only_crates_named_in_deny_toml_have_two_versions() {
    let mut versions: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for line in tree("normal,build,dev") {
        let mut words = line.split_whitespace();
        let (Some(name), Some(version)) = (words.next(), words.next()) else {
            continue;
        };
        let version = version.trim_start_matches('v').to_owned();
        versions.entry(name.to_owned()).or_default().insert(version);
    }
    let mut twice = Vec::new();
    for (name, versions) in versions {
        // All versions except the newest, as `cargo deny` counts.
        let newest = versions.iter().max_by_key(|version| numbers(version));
        let older = versions.iter().filter(|&version| Some(version) != newest);
        twice.extend(older.map(|version| format!("{name}@{version}")));
    }
    let named: Vec<_> = skipped().into_iter().map(|(name, _)| name).collect();
    let covers = |name: &str, found: &str| {
        found == name
            || found
                .strip_prefix(name)
                .is_some_and(|rest| rest.starts_with('.'))
    };
    for found in &twice {
        assert!(
            named.iter().any(|name| covers(name, found)),
            "{found} is not the only one of its name, and deny.toml does not say why"
        );
    }
    for name in named {
        assert!(
            twice.iter().any(|found| covers(name, found)),
            "{name} is not there twice any more; deny.toml needs no reason for it"
        );
    }
}

fn numbers(version: &str) -> Vec<u64> {
    let numbers = version
        .split(['.', '-', '+'])
        .map_while(|part| part.parse().ok());
    numbers.collect()
}
