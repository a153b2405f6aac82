//! The law of the rooms, held by reading the source as text.
//!
//! A room is a folder or a file directly under `src/`. `lib.rs` lists the rooms in reading order, and a room names only
//! rooms above it. Inside a room files may name each other as long as there is no cycle. The last tests break each rule
//! on sources of their own: a check that cannot fail is worth nothing.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// The modules that may touch files and streams.
const DOORS: &str = "storage formats cli tui/runtime tui/terminal main";

/// A word or a mark with its line; comments, strings and characters are left out.
type Token<'a> = (&'a str, usize);

struct Source<'a> {
    file: &'a str,
    text: &'a str,
    /// `src/a/b.rs` and `src/a/b/mod.rs` stand at `[a, b]`, `src/lib.rs` at `[]`.
    place: Vec<&'a str>,
    tokens: Vec<Token<'a>>,
}

/// What breaks the law, as `file:line: what; law: which`.
fn violations(files: &[(String, String)]) -> Vec<String> {
    let sources: Vec<_> = files.iter().map(source).collect();
    let mut found = Vec::new();
    let mut edges = Edges::new();
    for source in &sources {
        let mut refuse = |line: usize, what: &str, law: &str| {
            found.push(format!("{}:{line}: `{what}`; law: {law}", source.file));
        };
        form(source, &mut refuse);
        rooms(source, &mut refuse);
        if source.place != ["main"] && !source.place.contains(&"tests") {
            order(source, &sources, &mut edges, &mut refuse);
        }
    }
    found.extend(cycles(&edges));
    found
}

/// Which file names which other file of its room, and on which line first; by module paths.
type Edges = BTreeMap<String, BTreeMap<String, usize>>;

/// One line for each pair of files that is part of a cycle.
fn cycles(edges: &Edges) -> Vec<String> {
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
    for (from, targets) in edges {
        for (to, line) in targets {
            if reaches(to, from) {
                found.push(format!(
                    "src/{from}.rs:{line}: `{to}`; law: no cycle inside a room"
                ));
            }
        }
    }
    found
}

fn source((file, text): &(String, String)) -> Source<'_> {
    let inner = file.trim_start_matches("src/").trim_end_matches(".rs");
    let mut place: Vec<_> = inner.split('/').collect();
    place.pop_if(|last| *last == "mod" || inner == "lib");
    Source {
        file,
        text,
        place,
        tokens: tokens(text),
    }
}

/// A sentence of purpose at the top.
fn form(source: &Source<'_>, refuse: &mut impl FnMut(usize, &str, &str)) {
    let first = source.text.lines().next().unwrap_or_default();
    if !first.starts_with("//! ") {
        refuse(1, first, "a file begins with its purpose, a `//!` line");
    }
}

/// The screen's crates stay in `tui`, files and streams in the rooms with a door; tests too.
fn rooms(source: &Source<'_>, refuse: &mut impl FnMut(usize, &str, &str)) {
    let place = source.place.join("/");
    let below = |room: &str| Path::new(&place).starts_with(room);
    for (path, line) in paths(&source.tokens) {
        let name = path.join("::");
        if (path.contains(&"ratatui") || path.contains(&"crossterm")) && !below("tui") {
            refuse(line, &name, "only src/tui/ names ratatui and crossterm");
        }
        // A glob, or a second name for std, would hide what is taken from it.
        let taken = matches!(path[..], ["std", "fs" | "io" | "*" | "self", ..]);
        let file = path.len() > 1 && path[..path.len() - 1].contains(&"File");
        if (taken || file) && !DOORS.split(' ').any(below) {
            refuse(line, &name, &format!("I/O only in {DOORS}"));
        }
    }
}

/// A module names what `lib.rs` lists above its room, and notes which siblings it names.
fn order(
    source: &Source<'_>,
    all: &[Source<'_>],
    edges: &mut Edges,
    refuse: &mut impl FnMut(usize, &str, &str),
) {
    let place = &source.place;
    let Some((own, parent)) = place.split_last() else {
        return; // the root names what it likes
    };
    if !listed(parent, all).contains(own) {
        refuse(1, own, "a file is listed by its parent");
    }
    let rooms = listed(&[], all);
    let rank = |word: &str| rooms.iter().position(|name| *name == word);
    for (path, line) in paths(shipped(&source.tokens)) {
        let name = path.join("::");
        let target = match path[..] {
            ["super", "super", ..] => {
                refuse(line, &name, "no `super::super`, but `crate::`");
                continue;
            }
            ["super", ref rest @ ..] => [parent, rest].concat(),
            ["crate", ref rest @ ..] => rest.to_vec(),
            _ => continue,
        };
        match (target.first().and_then(|room| rank(room)), rank(place[0])) {
            (Some(it), Some(me)) if it < me => {}
            (Some(it), Some(me)) if it == me => {
                let depth = (1..=target.len())
                    .rev()
                    .find(|&depth| all.iter().any(|other| other.place == target[..depth]));
                let file = &target[..depth.unwrap_or(1)];
                // What a file says of itself or of its own folder's front page is no edge.
                if file != place && !(place.starts_with(file) && target.len() == file.len()) {
                    let targets = edges.entry(place.join("/")).or_default();
                    targets.entry(file.join("/")).or_insert(line);
                }
            }
            (Some(_), _) => refuse(line, &name, "only rooms listed above its own"),
            (None, _) => refuse(line, &name, "module paths, no item of the root"),
        }
    }
}

/// The modules that the file at `place` lists, in order.
fn listed<'a>(place: &[&str], all: &[Source<'a>]) -> Vec<&'a str> {
    let file = all.iter().find(|source| source.place == place);
    let tokens = file.map_or(&[][..], |file| shipped(&file.tokens));
    let mut depth = 0_usize;
    let modules = tokens.windows(2).filter(|pair| {
        depth += usize::from(pair[0].0 == "{");
        depth -= usize::from(pair[0].0 == "}").min(depth);
        depth == 0 && pair[0].0 == "mod"
    });
    modules.map(|pair| pair[1].0).collect()
}

/// What stands before `#[cfg(test)] mod tests {`; clippy sees to it that nothing follows that.
fn shipped<'t, 'a>(tokens: &'t [Token<'a>]) -> &'t [Token<'a>] {
    let same = |part: &[Token<'_>], words: &[&str]| part.iter().map(|token| &token.0).eq(words);
    let is_start = |part: &[Token<'_>]| same(part, &["mod", "tests", "{"]);
    let start = tokens.windows(3).position(is_start);
    let before = &tokens[..start.unwrap_or(0)];
    // Its attributes are all that stands between it and the end of the item before.
    let end = before
        .iter()
        .rposition(|token| matches!(token.0, ";" | "}"));
    let mut attributes = before[end.unwrap_or(0)..].windows(5);
    let of_tests = attributes.any(|part| same(part, &["cfg", "(", "test", ")", "]"]));
    if of_tests { before } else { tokens }
}

/// Every path, the groups of `use` taken apart, with the line of its last word.
fn paths<'a>(tokens: &[Token<'a>]) -> Vec<(Vec<&'a str>, usize)> {
    let (mut found, mut at) = (Vec::new(), 0);
    while at < tokens.len() {
        at = path(tokens, at, &[], &mut found);
    }
    // One word is no path, unless it is a crate: `use ratatui as r`.
    found.retain(|(path, _)| path.len() > 1 || matches!(path[0], "ratatui" | "crossterm"));
    found
}

/// Reads the path that continues `prefix` at `at`, and says where it ends.
fn path<'a>(
    tokens: &[Token<'a>],
    mut at: usize,
    prefix: &[&'a str],
    found: &mut Vec<(Vec<&'a str>, usize)>,
) -> usize {
    let word_at = |at: usize| tokens.get(at).map_or("", |token| token.0);
    let mut path = prefix.to_vec();
    loop {
        match word_at(at) {
            "{" if !path.is_empty() => {
                at += 1;
                while !matches!(word_at(at), "}" | "") {
                    at = self::path(tokens, at, &path, found);
                }
                return at + 1;
            }
            "as" if !path.is_empty() => return at + 2,
            "*" if !path.is_empty() => path.push("*"),
            word if word.starts_with(|c: char| c.is_alphabetic() || c == '_') => path.push(word),
            _ => return at + 1,
        }
        let next = word_at(at + 2).starts_with(|c: char| c.is_alphabetic() || "_{*".contains(c));
        if word_at(at + 1) != "::" || !next {
            found.push((path, tokens[at].1));
            return at + 1;
        }
        at += 2;
    }
}

fn tokens(text: &str) -> Vec<Token<'_>> {
    let (mut found, mut rest, mut line) = (Vec::new(), text, 1);
    while !rest.is_empty() {
        let (length, is_token) = lexeme(rest);
        let (word, after) = rest.split_at(length);
        if is_token {
            found.push((word, line));
        }
        line += word.matches('\n').count();
        rest = after;
    }
    found
}

/// The length of what `rest` begins with, and whether it is a token.
fn lexeme(rest: &str) -> (usize, bool) {
    let past = |from: usize, end: &str| {
        let at = rest.get(from..).and_then(|tail| tail.find(end));
        at.map_or(rest.len(), |at| from + at + end.len())
    };
    let word = rest.find(|c: char| !c.is_alphanumeric() && c != '_');
    let word = word.unwrap_or(rest.len());
    let quote = word + rest[word..].find(|c| c != '#').unwrap_or(0);
    let raw = matches!(&rest[..word], "r" | "br" | "cr") && rest[quote..].starts_with('"');
    let mut chars = rest.chars();
    match [chars.next(), chars.next(), chars.next()] {
        _ if raw => (past(quote + 1, &format!("\"{}", &rest[word..quote])), false),
        _ if word > 0 => (word, true),
        [Some('/'), Some('/'), _] => (past(0, "\n"), false),
        [Some('/'), Some('*'), _] => (past(2, "*/"), false),
        [Some(':'), Some(':'), _] => (2, true),
        [Some('"'), ..] => {
            let mut escaped = true; // or the opening quote would be the end
            let end = rest.find(|c| {
                let ends = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                ends
            });
            (end.map_or(rest.len(), |end| end + 1), false)
        }
        [Some('\''), Some('\\'), Some(c)] => (past(2 + c.len_utf8(), "'"), false),
        [Some('\''), Some(c), Some('\'')] => (2 + c.len_utf8(), false),
        [Some(space), ..] if space.is_whitespace() => (space.len_utf8(), false),
        [first, ..] => (first.map_or(1, char::len_utf8), true),
    }
}

/// The `.rs` files below `folder`, by their names from `root`.
fn read(root: &Path, folder: &Path, files: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.strip_prefix(root).expect("below the root");
        let name = name.to_string_lossy().replace('\\', "/");
        if path.is_dir() {
            read(root, &path, files);
        } else if path.extension().is_some_and(|end| end == "rs") {
            files.push((name, fs::read_to_string(&path).expect("a text")));
        }
    }
}

#[test]
fn the_source_keeps_the_law() {
    let (root, mut files) = (Path::new(env!("CARGO_MANIFEST_DIR")), Vec::new());
    read(root, &root.join("src"), &mut files);
    files.sort();
    assert!(files.iter().any(|(name, _)| name == "src/lib.rs"));
    let found = violations(&files);
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

/// Tests, benchmarks and examples name what they like, but they are read too.
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
        form(&source, &mut |line, what, law| {
            found.push(format!("{}:{line}: `{what}`; law: {law}", source.file));
        });
    }
    assert!(found.is_empty(), "\n{}\n", found.join("\n"));
}

/// A small tree that keeps the law, then what breaks it: file, text (`¶` ends a line), violation.
const TREE: &str = "
src/lib.rs | pub mod a;¶#[cfg(unix)]¶/// mod z;¶mod b;¶pub mod x;¶mod y { mod c; }¶pub mod tui;
src/x/mod.rs | pub mod p;¶pub(crate) mod q;¶mod r;¶pub use q::Q;
src/a.rs |
src/b.rs |
src/x/p.rs |
src/x/q.rs | use super::p;
src/x/r.rs | use super::q::Q;
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
src/x/q.rs | use super::super::a; | 2: `super::super::a`; law: no `super::super`
src/x/q.rs | use crate::tui; | 2: `crate::tui`
src/c.rs | | 1: `c`; law: a file is listed
src/main.rs | use ratatui as r; | 2: `ratatui`; law: only src/tui/
src/a.rs | fn f(e: crossterm::Event) {} | 2: `crossterm::Event`
src/a.rs | use std::{¶    fmt,¶    io::{self, Read},¶}; | 4: `std::io::self`; law: I/O
src/tui/mod.rs | mod runtime;¶use std::fs; | 3: `std::fs`
src/a.rs | fn f() { File::open(p) } | 2: `File::open`
src/a.rs | #[cfg(test)]¶mod tests { use std::fs; } | 3: `std::fs`"#;
const KEPT: &str = r##"
src/a.rs | use std::{fmt, iter}; // crate::b¶/* crate::b */ pub(crate) struct A;
src/a.rs | /// [`crate::b::B`]¶const T: &str = "\"use crate::b;"; use self::c::D;
src/a.rs | const T: &str = r#"" use std::io; crate::b "#;
src/a.rs | #[cfg(test)]¶#[expect(x)]¶mod tests { use super::*; use crate::b::B; }
src/b.rs | use crate::{a::{self, A}, a as z};¶use super::a::B; use crate::b::own;
src/x/q.rs | use crate::{b, x::p::{self, P}}; use super::p::*; use crate::x::q::own;
src/x/mod.rs | pub mod q; pub mod p; mod r; use crate::x::q; use crate::a; use super::b;
src/x/tests.rs | use super::*; use crate::tui;
src/tui/mod.rs | mod runtime; use ratatui::Frame; use crossterm::event;
src/tui/runtime.rs | use std::{fs, io}; fn f() { fs::File::open(p) }
src/main.rs | use taxel::tui; use std::io::stdin; use std::fs;"##;

/// The violations of the tree with one file put in or replaced.
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
fn each_breach_is_caught() {
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
fn what_keeps_the_law_passes() {
    for row in KEPT.lines().skip(1) {
        let (file, text) = row.split_once(" |").expect("a text");
        assert_eq!(found(file, text), [""; 0], "{row}");
    }
}
