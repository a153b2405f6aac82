//! Rust source read as text: its tokens with their lines, the paths among them, and the modules that a file lists.

use std::fs;
use std::path::Path;

/// A word or a punctuation mark, with its line. Comments, strings and character literals are left out.
pub(crate) type Token<'a> = (&'a str, usize);

pub(crate) struct Source<'a> {
    pub(crate) file: &'a str,
    pub(crate) text: &'a str,
    /// The path of the module: `[a, b]` for `src/a/b.rs` and `src/a/b/mod.rs`, `[]` for `src/lib.rs`.
    pub(crate) module: Vec<&'a str>,
    pub(crate) tokens: Vec<Token<'a>>,
}

pub(crate) fn source((file, text): &(String, String)) -> Source<'_> {
    let inner = file.trim_start_matches("src/").trim_end_matches(".rs");
    let mut module: Vec<_> = inner.split('/').collect();
    module.pop_if(|last| *last == "mod" || inner == "lib");
    Source {
        file,
        text,
        module,
        tokens: tokens(text),
    }
}

/// Returns the modules that the file of `module` lists, in order.
pub(crate) fn listed<'a>(module: &[&str], all: &[Source<'a>]) -> Vec<&'a str> {
    let file = all.iter().find(|source| source.module == module);
    let tokens = file.map_or(&[][..], |file| shipped(&file.tokens));
    let mut depth = 0_usize;
    let modules = tokens.windows(2).filter(|pair| {
        depth += usize::from(pair[0].0 == "{");
        depth -= usize::from(pair[0].0 == "}").min(depth);
        depth == 0 && pair[0].0 == "mod"
    });
    modules.map(|pair| pair[1].0).collect()
}

/// Returns the tokens before `mod tests {` with its `#[cfg(test)]`; clippy ensures that nothing follows these tests.
pub(crate) fn shipped<'t, 'a>(tokens: &'t [Token<'a>]) -> &'t [Token<'a>] {
    let is_start = |part: &[Token<'_>]| {
        let words = part.iter().map(|token| token.0);
        words.eq(["mod", "tests", "{"])
    };
    let start = tokens.windows(3).position(is_start);
    let before = &tokens[..start.unwrap_or(0)];
    // Only the attributes of `mod tests` stand between it and the end of the item before.
    let end = before
        .iter()
        .rposition(|token| matches!(token.0, ";" | "}"));
    let mut attributes = before[end.unwrap_or(0)..].iter();
    let of_tests = attributes.any(|token| token.0 == "test");
    if of_tests { before } else { tokens }
}

/// Returns every path, with the line of its last word. Groups of `use` are split into single paths.
pub(crate) fn paths<'a>(tokens: &[Token<'a>]) -> Vec<(Vec<&'a str>, usize)> {
    let (mut found, mut at) = (Vec::new(), 0);
    while at < tokens.len() {
        at = path(tokens, at, &[], &mut found);
    }
    // One word is not a path, unless it is the name of a crate: `use ratatui as r`.
    found.retain(|(path, _)| path.len() > 1 || matches!(path[0], "ratatui" | "crossterm" | "clap"));
    found
}

/// Reads the path that continues `prefix` at `at`, and returns where it ends.
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

/// Returns the length of the lexeme at the start of `rest`, and whether it is a token.
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
            let mut escaped = true; // otherwise the opening quote would be the end
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

/// Reads the `.rs` files below `folder`; names them by their paths from `root`.
pub(crate) fn read(root: &Path, folder: &Path, files: &mut Vec<(String, String)>) {
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
