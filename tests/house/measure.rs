//! Three measures of the source: lines of documentation for each line of code, room by room; the length of functions; and
//! documentation that begins with a pronoun.
//!
//! All are measured on the text. A line of documentation begins with `///` or `//!`; other comments and empty lines
//! are not counted, and everything else is code. Unit tests at the end of a file are ignored. A function ends at the
//! first line that closes it at its own indentation, which is where rustfmt puts it.

use std::collections::BTreeMap;
use std::path::Path;

use crate::source::read;

/// The least number of lines of documentation per hundred lines of code, in every folder below `src/`.
const LEAST_DOCS: usize = 20;

/// The highest number of lines of a function, from `fn` to its closing brace. A longer function usually hides two.
const LONGEST: usize = 60;

/// Words that begin no paragraph of documentation: a sentence such as "Those of the writer." says nothing by itself.
const PRONOUNS: [&str; 5] = ["That", "Those", "What", "Which", "Who"];

/// Returns the lines of a file before its unit tests.
fn shipped(text: &str) -> Vec<&str> {
    let lines: Vec<&str> = text.lines().collect();
    let is_tests = |pair: &[&str]| {
        pair[0].trim() == "#[cfg(test)]" && pair[1].trim_start().starts_with("mod tests {")
    };
    let end = lines.windows(2).position(is_tests);
    lines[..end.unwrap_or(lines.len())].to_vec()
}

/// Returns the number of lines of documentation and of code in a file.
fn counts(text: &str) -> (usize, usize) {
    let (mut docs, mut code) = (0, 0);
    for line in shipped(text) {
        let line = line.trim();
        if line.starts_with("///") || line.starts_with("//!") {
            docs += 1;
        } else if !line.is_empty() && !line.starts_with("//") {
            code += 1;
        }
    }
    (docs, code)
}

/// Returns the paragraphs of documentation that begin with a pronoun, by their line number. A question may.
fn pronouns(text: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    let mut is_start = true;
    for (number, line) in (1..).zip(shipped(text)) {
        let line = line.trim();
        let docs = line
            .strip_prefix("///")
            .or_else(|| line.strip_prefix("//!"));
        let docs = docs.map_or("", str::trim);
        let first = docs.split(' ').next().unwrap_or_default();
        if is_start && PRONOUNS.contains(&first) && !docs.ends_with('?') {
            found.push((number, docs));
        }
        is_start = docs.is_empty() || docs.starts_with('#');
    }
    found
}

/// Returns the functions of a file that are too long, with their lengths.
fn long_functions(text: &str) -> Vec<(&str, usize)> {
    let lines = shipped(text);
    let mut found = Vec::new();
    for (start, line) in lines.iter().enumerate() {
        let item = line.trim_start();
        let indent = &line[..line.len() - item.len()];
        // A function that is closed or only declared in its first line is short.
        let Some(name) = function(item).filter(|_| !item.ends_with([';', '}'])) else {
            continue;
        };
        let closing = format!("{indent}}}");
        let length = lines[start..]
            .iter()
            .position(|line| line.starts_with(&closing));
        let length = length.map_or(lines.len() - start, |end| end + 1);
        if length > LONGEST {
            found.push((name, length));
        }
    }
    found
}

/// Returns the name of the function that a line begins, after its visibility and qualifiers.
fn function(item: &str) -> Option<&str> {
    let item = match item.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(") ")?.1,
        Some(rest) => rest,
        None => item,
    };
    let mut words = item.split(' ').filter(|word| !word.is_empty());
    words
        .find(|word| !matches!(*word, "const" | "async"))
        .filter(|word| *word == "fn")?;
    words.next()?.split(['(', '<']).next()
}

/// Returns the names and texts of the files of `src/`.
fn files() -> Vec<(String, String)> {
    let (root, mut files) = (Path::new(env!("CARGO_MANIFEST_DIR")), Vec::new());
    read(root, &root.join("src"), &mut files);
    // Unit tests in files of their own are ignored.
    files.retain(|(name, _)| !name.ends_with("/tests.rs"));
    assert!(files.len() > 300, "{}", files.len());
    files
}

#[test]
fn every_room_has_a_line_of_documentation_for_five_lines_of_code() {
    let mut rooms: BTreeMap<String, (usize, usize)> = BTreeMap::new();
    for (name, text) in files() {
        let inner = name.trim_start_matches("src/");
        if let Some((room, _)) = inner.split_once('/') {
            let (docs, code) = counts(&text);
            let sum = rooms.entry(room.to_owned()).or_default();
            *sum = (sum.0 + docs, sum.1 + code);
        }
    }
    assert!(rooms.contains_key("tui") && rooms.contains_key("cli"));
    for (room, (docs, code)) in rooms {
        let found = 100 * docs / code.max(1);
        assert!(
            found >= LEAST_DOCS,
            "src/{room}: {docs} lines of documentation for {code} of code, expected {LEAST_DOCS} %"
        );
    }
}

#[test]
fn no_function_is_longer_than_sixty_lines() {
    let mut found = Vec::new();
    for (name, text) in files() {
        for (function, length) in long_functions(&text) {
            found.push(format!("{name}: {function} has {length} lines"));
        }
    }
    assert!(found.is_empty(), "expected {LONGEST} at most: {found:#?}");
}

#[test]
fn no_documentation_begins_with_a_pronoun() {
    let mut found = Vec::new();
    for (name, text) in files() {
        let own = pronouns(&text);
        found.extend(
            own.into_iter()
                .map(|(line, docs)| format!("{name}:{line}: {docs}")),
        );
    }
    assert!(found.is_empty(), "say what it is instead: {found:#?}");
    let text = "//! Which shape is it?\n\n/// What is left.\nfn a() {}\n\n/// A line.\n/// Which\n///\n/// # Errors\n/// Those of b.\n";
    assert_eq!(pronouns(text), [(3, "What is left."), (10, "Those of b.")]);
}

#[test]
fn long_functions_and_lines_of_documentation_are_found() {
    let body = "    work();\n".repeat(60);
    for head in [
        "fn long() {",
        "pub(crate) const fn long() {",
        "pub async fn long(",
        "    fn long() {",
    ] {
        let indent = &head[..head.len() - head.trim_start().len()];
        let text = format!("//! Purpose.\n\n{head}\n{body}{indent}}}\n");
        assert_eq!(long_functions(&text), [("long", 62)], "{head}");
    }
    let short = format!(
        "fn short() {{\n{}}}\nfn next() {{}}\nlet fn_like = 1;\n",
        "    work();\n".repeat(58)
    );
    assert!(long_functions(&short).is_empty());
    let of_tests = format!("#[cfg(test)]\nmod tests {{\n    fn long() {{\n{body}    }}\n}}\n");
    assert!(long_functions(&of_tests).is_empty());
    let text =
        "//! Head.\n\n// A reason.\n/// An item.\nfn item() {}\n\n#[cfg(test)]\nmod tests {\n}\n";
    assert_eq!(counts(text), (2, 1));
}
