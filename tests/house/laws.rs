//! The laws of the rooms, checked by reading the source as text.
//!
//! A room is a folder or a file directly under `src/`. `lib.rs` lists the rooms in reading order, and a room names
//! only rooms above it. Inside a room, files may name each other as long as there is no cycle. The last tests break
//! each law in small example sources, because a check that cannot fail proves nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::source::{Source, Token, listed, paths, read, shipped, source};

/// The modules that may open files and streams.
const DOORS: &str = "storage acquire memory cli tui/runtime tui/terminal main";

/// The module that may use the traits of `std::io`, for readers and writers that its callers open.
const READER: &str = "formats";

/// Crates that only one room may name, with that room.
const OWNED: [(&str, &str); 5] = [
    ("ratatui", "tui"),
    ("crossterm", "tui"),
    ("clap", "cli"),
    ("clap_complete", "cli"),
    ("clap_mangen", "cli"),
];

/// The highest number of lines in `src` that may turn an impossible case into a value, with `unwrap_or(0)` and the
/// like. Such a value hides a mistake behind a plausible number. Some of these lines are true defaults, which the text
/// does not show, so they are counted rather than forbidden: a new one must replace another. The number only goes
/// down.
const MOST_FALLBACKS: usize = 47;

/// Returns the violations of the laws, as `file:line: name; law: the law`.
fn violations(files: &[(String, String)]) -> Vec<String> {
    let sources: Vec<_> = files.iter().map(source).collect();
    let mut found = Vec::new();
    let mut edges = Edges::new();
    for source in &sources {
        let mut report = |line: usize, what: &str, law: &str| {
            found.push(format!("{}:{line}: `{what}`; law: {law}", source.file));
        };
        purpose(source, &mut report);
        owned(source, &mut report);
        if source.module.is_empty() {
            map(source, &sources, &mut report);
        }
        if source.module.len() > 1 {
            folder_map(source, &sources, &mut report);
        }
        if source.module != ["main"] && !source.module.contains(&"tests") {
            order(source, &sources, &mut edges, &mut report);
        }
    }
    found.extend(cycles(&edges, &sources));
    found.extend(names(&sources));
    found
}

/// For each file, the other files of its room that it names, with the first line that does; by module paths.
type Edges = BTreeMap<String, BTreeMap<String, usize>>;

/// Returns one line for each pair of files that is part of a cycle.
fn cycles(edges: &Edges, sources: &[Source<'_>]) -> Vec<String> {
    let reaches = |from: &str, wanted: &str| {
        let (mut seen, mut waiting) = (vec![from], vec![from]);
        while let Some(module) = waiting.pop() {
            for next in edges.get(module).into_iter().flatten() {
                if next.0 == wanted {
                    return true;
                }
                if !seen.contains(&next.0.as_str()) {
                    seen.push(next.0);
                    waiting.push(next.0);
                }
            }
        }
        false
    };
    let mut found = Vec::new();
    for source in sources {
        let from = source.module.join("/");
        for (to, line) in edges.get(&from).into_iter().flatten() {
            if reaches(to, &from) {
                found.push(format!(
                    "{}:{line}: `{to}`; law: no cycle inside a room",
                    source.file
                ));
            }
        }
    }
    found
}

/// Checks that a file begins with a sentence about its purpose.
fn purpose(source: &Source<'_>, report: &mut impl FnMut(usize, &str, &str)) {
    let first = source.text.lines().next().unwrap_or_default();
    if !first.starts_with("//! ") {
        report(1, first, "a file begins with its purpose, a `//!` line");
    }
}

/// Checks that only its owner names a crate, and that only the rooms in [`DOORS`] name files and streams; in unit
/// tests, too.
fn owned(source: &Source<'_>, report: &mut impl FnMut(usize, &str, &str)) {
    let module = source.module.join("/");
    let below = |room: &str| Path::new(&module).starts_with(room);
    for (path, line) in paths(&source.tokens) {
        let name = path.join("::");
        for (owned, room) in OWNED {
            if path.contains(&owned) && !below(room) {
                report(line, &name, &format!("only src/{room}/ names {owned}"));
            }
        }
        // A glob import, or another name for `std`, would hide what is imported.
        let opens = matches!(
            path[..],
            ["std", "fs" | "*" | "self", ..]
                | ["std", "io", "*", ..]
                | [_, .., "stdin" | "stdout" | "stderr"]
        );
        let file = path.len() > 1 && path[..path.len() - 1].contains(&"File");
        let reads = matches!(path[..], ["std", "io", ..]);
        let is_door = DOORS.split(' ').any(below);
        if !is_door && (opens || file || reads && !below(READER)) {
            report(line, &name, &format!("I/O only in {DOORS}"));
        }
    }
}

/// Checks that the map in the documentation of `lib.rs` shows the rooms that are declared below it, in the same order.
fn map(root: &Source<'_>, all: &[Source<'_>], report: &mut impl FnMut(usize, &str, &str)) {
    let lines = root.text.lines().zip(1..);
    let mut rows = lines
        .skip_while(|(line, _)| *line != "//! # Map")
        .skip_while(|(line, _)| *line != "//! ```text")
        .skip(1)
        .take_while(|(line, _)| *line != "//! ```")
        // Lines with a deeper indent continue the row above.
        .filter_map(|(line, number)| Some((line.strip_prefix("//!  ")?, number)))
        .filter(|(row, _)| row.starts_with(|c: char| c.is_ascii_lowercase()))
        // A row names one or more rooms, then describes them.
        .flat_map(|(row, number)| {
            let columns = row
                .split("  ")
                .map(str::trim)
                .filter(|word| !word.is_empty());
            columns
                .take_while(|word| !word.contains(' '))
                .map(move |word| (word, number))
        });
    for room in listed(&[], all) {
        let (shown, line) = rows.next().unwrap_or(("nothing", 1));
        if shown != room {
            let law = format!("the map shows `{room}` here, as the modules are declared");
            return report(line, shown, &law);
        }
    }
    if let Some((shown, line)) = rows.next() {
        report(line, shown, "the map shows declared modules only");
    }
}

/// Checks that the map in the documentation of a folder below a room names the modules that the folder lists, each at
/// the start of a line or column. A drawing is a map if it begins with one of these modules; a room's drawing shows
/// how its data flows instead.
fn folder_map(source: &Source<'_>, all: &[Source<'_>], report: &mut impl FnMut(usize, &str, &str)) {
    let modules = listed(&source.module, all);
    let rows: Vec<_> = (source.text.lines().zip(1..))
        .skip_while(|(line, _)| *line != "//! ```text")
        .skip(1)
        .take_while(|(line, _)| *line != "//! ```")
        .filter_map(|(line, number)| Some((line.strip_prefix("//! ")?, number)))
        .collect();
    let names = |row| {
        let columns = str::split(row, "  ").map(str::trim);
        columns.filter_map(|column| column.split([' ', ':']).next())
    };
    let first = |row| names(row).next().unwrap_or_default();
    let Some((_, start)) = rows
        .first()
        .filter(|(row, _)| modules.contains(&first(row)))
    else {
        return;
    };
    for (row, line) in &rows {
        let name = first(row);
        // A line without a name continues the one above.
        if !name.is_empty() && !modules.contains(&name) {
            report(*line, name, "the map of a folder shows its modules only");
        }
    }
    for module in modules {
        if module != "tests"
            && !rows
                .iter()
                .any(|(row, _)| names(row).any(|name| name == module))
        {
            report(
                *start,
                module,
                "the map of a folder shows each of its modules",
            );
        }
    }
}

/// Returns the names of the types that these tokens define for other files, with their lines.
fn types<'a>(tokens: &[Token<'a>]) -> Vec<Token<'a>> {
    let defines = |words: &[Token<'_>]| {
        let visible = matches!(words[0].0, "pub" | ")"); // `pub` or the end of `pub(crate)`
        visible && matches!(words[1].0, "struct" | "enum" | "trait" | "union" | "type")
    };
    let found = tokens.windows(3).filter(|words| defines(words));
    found.map(|words| words[2]).collect()
}

/// Checks that a type name that other files see is defined only once in the crate, tests aside.
fn names(sources: &[Source<'_>]) -> Vec<String> {
    let mut homes = BTreeMap::<&str, Vec<String>>::new();
    for source in sources {
        for (name, line) in types(shipped(&source.tokens)) {
            let home = format!("{}:{line}", source.file);
            homes.entry(name).or_default().push(home);
        }
    }
    homes.retain(|_, homes| homes.len() > 1);
    let line = |(name, homes): (&str, Vec<String>)| {
        format!(
            "{}: `{name}`; law: a type name is defined once",
            homes.join(" and ")
        )
    };
    homes.into_iter().map(line).collect()
}

/// Returns the lines where an impossible case silently becomes 0, a maximum or a default, tests included.
fn fallbacks(source: &Source<'_>) -> BTreeSet<usize> {
    let zero = |word: &str| {
        let suffix = word.trim_start_matches('0');
        suffix.len() < word.len() && !suffix.starts_with(char::is_numeric)
    };
    let words: Vec<_> = source.tokens.iter().map(|token| token.0).collect();
    // A `map_or` whose function returns its argument unchanged is an `unwrap_or`.
    let same = |rest: &[&str]| match rest {
        [")", ..] => true,
        [",", "|", "&", from, "|", to, ")", ..] | [",", "|", from, "|", to, ")", ..] => from == to,
        _ => false,
    };
    let silent = |at: &usize| match &words[*at..] {
        ["unwrap_or_default", ..] => true,
        ["unwrap_or" | "map_or", "(", given @ ..] => match given {
            ["MAX", rest @ ..] | [_, "::", "MAX", rest @ ..] => same(rest),
            [whole, ".", digits, rest @ ..] if zero(whole) => zero(digits) && same(rest),
            [whole, rest @ ..] => zero(whole) && same(rest),
            [] => false,
        },
        _ => false,
    };
    let lines = (0..words.len()).filter(silent);
    lines.map(|at| source.tokens[at].1).collect()
}

/// Checks that a module names only modules that `lib.rs` lists above its room, and records the siblings that it names.
fn order(
    source: &Source<'_>,
    all: &[Source<'_>],
    edges: &mut Edges,
    report: &mut impl FnMut(usize, &str, &str),
) {
    let module = &source.module;
    let Some((own, parent)) = module.split_last() else {
        return; // the root may name anything
    };
    if !listed(parent, all).contains(own) {
        report(1, own, "a file is listed by its parent");
    }
    let (rooms, children) = (listed(&[], all), listed(module, all));
    let rank = |word: &str| rooms.iter().position(|name| *name == word);
    for (path, line) in paths(shipped(&source.tokens)) {
        let name = path.join("::");
        let target = match path[..] {
            ["super", "super", ..] => {
                report(line, &name, "no `super::super`, but `crate::`");
                continue;
            }
            ["super", ref rest @ ..] => [parent, rest].concat(),
            ["crate", ref rest @ ..] => rest.to_vec(),
            ["self", ref rest @ ..] => [module, rest].concat(),
            [first, ..] if children.contains(&first) => [module, &path[..]].concat(),
            _ => continue,
        };
        match (target.first().and_then(|room| rank(room)), rank(module[0])) {
            (Some(it), Some(me)) if it < me => {}
            (Some(it), Some(me)) if it == me => {
                let depth = (1..=target.len())
                    .rev()
                    .find(|&depth| all.iter().any(|other| other.module == target[..depth]));
                let file = &target[..depth.unwrap_or(1)];
                let file = &reexported(file, &target, all);
                // A name in the file itself or in the front page of its own folder is not an edge.
                if file != module && !(module.starts_with(file) && target.len() == file.len()) {
                    let targets = edges.entry(module.join("/")).or_default();
                    targets.entry(file.join("/")).or_insert(line);
                }
            }
            (Some(_), _) => report(line, &name, "only rooms listed above its own"),
            (None, _) => report(line, &name, "module paths, no item of the root"),
        }
    }
}

/// Returns the file that defines an item: `file`, or the file below it from which `file` re-exports the item, perhaps
/// through the front pages of folders in between.
fn reexported<'a>(file: &[&'a str], target: &[&'a str], all: &[Source<'a>]) -> Vec<&'a str> {
    let item = target.get(file.len());
    let front = all.iter().find(|source| source.module == file);
    let (Some(item), Some(front)) = (item, front) else {
        return file.to_vec();
    };
    let candidates = paths(shipped(&front.tokens))
        .into_iter()
        .filter_map(|(path, _)| {
            let (last, path) = path.split_last()?;
            let path = path.strip_prefix(&["self"]).unwrap_or(path);
            let home = [file, path].concat();
            let is_home =
                last == item && home != file && all.iter().any(|other| other.module == home);
            is_home.then_some(home)
        });
    match candidates.max_by_key(Vec::len) {
        Some(home) => reexported(&home, &[&home[..], &[*item]].concat(), all),
        None => file.to_vec(),
    }
}

/// Returns the files of `src/`, sorted.
fn own_files() -> Vec<(String, String)> {
    let (root, mut files) = (Path::new(env!("CARGO_MANIFEST_DIR")), Vec::new());
    read(root, &root.join("src"), &mut files);
    files.sort();
    assert!(files.iter().any(|(name, _)| name == "src/lib.rs"));
    files
}

#[test]
fn the_source_keeps_the_laws() {
    let found = violations(&own_files());
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

#[test]
fn few_impossible_cases_become_values() {
    let files = own_files();
    let by_file = files.iter().map(|file| (&file.0, fallbacks(&source(file))));
    let by_file: Vec<_> = by_file.filter(|(_, lines)| !lines.is_empty()).collect();
    let count: usize = by_file.iter().map(|(_, lines)| lines.len()).sum();
    println!("{count} silent fallbacks");
    assert!(count <= MOST_FALLBACKS, "{count} lines: {by_file:#?}");
}

/// Tests, benchmarks and examples may name anything, but people read them, too.
#[test]
fn every_file_states_its_purpose() {
    let (root, mut files) = (Path::new(env!("CARGO_MANIFEST_DIR")), Vec::new());
    for folder in ["tests", "benches", "examples"] {
        read(root, &root.join(folder), &mut files);
    }
    assert!(files.len() > 40, "{}", files.len());
    let mut found = Vec::new();
    for file in &files {
        let source = source(file);
        purpose(&source, &mut |line, what, law| {
            found.push(format!("{}:{line}: `{what}`; law: {law}", source.file));
        });
    }
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

/// A small tree that keeps the laws, followed by breaches: file, text (`¶` ends a line), violation.
const TREE: &str = "
src/lib.rs | //! # Map¶//! ```text¶//!  a   b    both of them¶//!       and more¶//!  x  the rest   end¶//!  ────¶//!  y    why not¶//!  formats¶//!  tui  the screen    end¶//! ```¶pub mod a;¶#[cfg(unix)]¶/// mod z;¶mod b;¶pub mod x;¶mod y { mod c; }¶mod formats;¶pub mod tui;
src/x/mod.rs | pub mod p;¶pub(crate) mod q;¶mod r;¶pub use q::Q;
src/a.rs |
src/b.rs |
src/x/p.rs |
src/x/q.rs | use super::p;
src/x/r.rs | use super::q::Q; use super::front;
src/tui/mod.rs | mod runtime;";
const BREACHES: &str = r#"
src/a.rs | use crate::b::B; | 2: `crate::b::B`; law: only rooms listed above
src/a.rs | ¶fn f() { crate::b::g() } | 3: `crate::b::g`
src/b.rs | use crate::{¶    a::{A as C, D},¶    x::{self, p},¶}; | 4: `crate::x::self`
src/b.rs | use crate::{¶    a::{A as C, D},¶    x::{self, p},¶}; | 4: `crate::x::p`
src/b.rs | use super::x; | 2: `super::x`
src/b.rs | use crate::Q; | 2: `crate::Q`; law: module paths
src/b.rs | use crate::*; | 2: `crate::*`
src/b.rs | mod tests { use crate::x; } | 2: `crate::x`
src/b.rs | const C: char = '"'; use crate::x; // " | 2: `crate::x`
src/b.rs | fn f<'a>(t: &'a str) -> &'a crate::x::q::Q {} | 2: `crate::x::q::Q`
src/x/p.rs | use super::q; | 2: `x/q`; law: no cycle inside a room
src/x/p.rs | use crate::x::q::Q; | 2: `x/q`; law: no cycle
src/x/p.rs | use crate::x::r::f; | 2: `x/r`; law: no cycle
src/x/p.rs | use crate::x::Q; | 2: `x/q`; law: no cycle
src/x/p.rs | use super::Q; | 2: `x/q`; law: no cycle
src/x/mod.rs | pub mod p; mod q;¶mod r; use r::f; | 3: `x/r`; law: no cycle
src/x/mod.rs | pub mod p; mod q;¶mod r; fn front() { r::f() } | 3: `x/r`; law: no cycle
src/x/mod.rs | pub mod p; mod q;¶mod r; fn front() { self::r::f() } | 3: `x/r`; law: no cycle
src/x/p.rs | pub(crate) struct A; mod z { pub enum A {} } | 2 and src/x/p.rs:2: `A`; law: a type name is defined once
src/b.rs | pub trait X { type T; }¶pub(super) type X<T> = u8; | 2 and src/b.rs:3: `X`; law: a type
src/x/q.rs | use super::super::a; | 2: `super::super::a`; law: no `super::super`
src/x/q.rs | use crate::tui; | 2: `crate::tui`
src/c.rs | | 1: `c`; law: a file is listed
src/lib.rs | //! # Map¶//! ```text¶//!  b  first of two¶//!  a  of them¶//! ```¶mod a; mod b; | 4: `b`; law: the map shows `a` here
src/lib.rs | //! # Map¶//! ```text¶//!  a  that one¶//! ```¶mod a; mod b; | 1: `nothing`; law: the map shows `b`
src/lib.rs | //! # Map¶//! ```text¶//!  a  b  both of them¶//! ```¶mod a; | 4: `b`; law: the map shows declared modules only
src/x/r.rs | //! ```text¶//! g  one¶//! h  gone¶//! ```¶mod g; | 4: `h`; law: the map of a folder shows its modules only
src/x/r.rs | //! ```text¶//! g  one¶//! ```¶mod g;¶mod h; | 3: `h`; law: the map of a folder shows each of its modules
src/main.rs | use ratatui as r; | 2: `ratatui`; law: only src/tui/
src/tui/mod.rs | mod runtime;¶use clap as c; | 3: `clap`; law: only src/cli/
src/a.rs | fn f(s: clap_complete::Shell) {} | 2: `clap_complete::Shell`; law: only src/cli/
src/a.rs | fn f(e: crossterm::Event) {} | 2: `crossterm::Event`
src/a.rs | use std::{¶    fmt,¶    io::{self, Read},¶}; | 4: `std::io::self`; law: I/O
src/tui/mod.rs | mod runtime;¶use std::fs; | 3: `std::fs`
src/a.rs | fn f() { File::open(p) } | 2: `File::open`
src/formats/mod.rs | use std::fs; | 2: `std::fs`; law: I/O
src/formats/mod.rs | use std::io::{self, Read};¶fn f() { io::stdin() } | 3: `io::stdin`; law: I/O
src/a.rs | #[cfg(test)]¶mod tests { use std::fs; } | 3: `std::fs`"#;
const KEPT: &str = r##"
src/a.rs | use std::{fmt, iter}; // crate::b¶/* crate::b */ pub(crate) struct A;
src/a.rs | /// [`crate::b::B`]¶const T: &str = "\"use crate::b;"; use self::c::D;
src/a.rs | const T: &str = r#"" use std::io; crate::b "#;
src/a.rs | #[cfg(test)]¶#[expect(x)]¶mod tests { use super::*; use crate::b::B; }
src/b.rs | use crate::{a::{self, A}, a as z};¶use super::a::B; use crate::b::own;
src/b.rs | pub struct A; fn f() { struct A; }¶#[cfg(test)]¶mod tests { pub struct A; }
src/x/q.rs | use crate::{b, x::p::{self, P}}; use super::p::*; use crate::x::q::own;
src/x/mod.rs | pub mod q; pub mod p; mod r; use crate::x::q; use crate::a; use super::b;
src/x/mod.rs | //! ```text¶//! p  then q¶//! ```¶pub mod q; pub mod p; mod r;
src/x/r.rs | //! ```text¶//! g   one    h: two  i¶//!         and more¶//! j three¶//! ```¶mod g; mod h; mod i; mod j; mod tests;
src/x/r.rs | //! ```text¶//! in -> g -> out¶//! ```¶mod g; mod h;
src/x/tests.rs | use super::*; use crate::tui;
src/tui/mod.rs | mod runtime; use ratatui::Frame; use crossterm::event;
src/formats/mod.rs | use std::io::{self, Read};
src/tui/runtime.rs | use std::{fs, io}; fn f() { fs::File::open(p) }
src/main.rs | use taxel::tui; use std::io::stdin; use std::fs;"##;

/// Returns the violations of the tree with one file added or replaced.
fn found(file: &str, text: &str) -> Vec<String> {
    let rows = TREE.lines().filter_map(|row| row.split_once(" |"));
    let others = rows.filter(|(name, _)| *name != file);
    let whole = |(name, text): (&str, &str)| {
        let text = text.trim().replace('¶', "\n");
        (name.to_owned(), format!("//! Why.\n{text}"))
    };
    violations(&others.chain([(file, text)]).map(whole).collect::<Vec<_>>())
}

#[test]
fn each_breach_of_a_law_is_caught() {
    for row in BREACHES.lines().skip(1) {
        let (left, expected) = row.rsplit_once("| ").expect("a violation");
        let (file, text) = left.split_once(" |").expect("a text");
        let (found, start) = (found(file, text), format!("{file}:{expected}"));
        let caught = found.iter().any(|line| line.starts_with(&start));
        assert!(caught, "{row}\n{found:?}");
    }
    let bare = [("src/lib.rs".to_owned(), "fn f() {}".to_owned())];
    assert_eq!(violations(&bare).len(), 1);
}

#[test]
fn sources_that_keep_the_laws_pass() {
    for row in KEPT.lines().skip(1) {
        let (file, text) = row.split_once(" |").expect("a text");
        assert_eq!(found(file, text), [""; 0], "{row}");
    }
}

#[test]
fn each_silent_fallback_is_counted() {
    let silent = "a.unwrap_or(0)¶a.unwrap_or(0_u8)¶a.unwrap_or(0.0)¶a.unwrap_or(u64::MAX)¶a.unwrap_or_default()¶a.map_or(0, |x| x)¶a.map_or(0.0, |x| x)¶a.map_or(MAX, |x| x)¶a.map_or(u64::MAX, |x| x)¶a.map_or(0, |&x| x)";
    let said = "a.unwrap_or(1)¶a.unwrap_or(b)¶a.unwrap_or(10)¶a.unwrap_or(0.5)¶a.map_or(0, f)¶a.map_or(0, |x| y)¶a.map_or(1, |x| x)¶// a.unwrap_or(0)";
    for (text, count) in [(silent, 10), (said, 0)] {
        let file = ("src/a.rs".to_owned(), text.replace('¶', "\n"));
        let lines = fallbacks(&source(&file));
        assert_eq!(lines.len(), count, "{lines:?} of {text}");
    }
}
