//! Every link from one document to another, or within one, leads somewhere.

use std::collections::BTreeSet;
use std::fs;

use crate::docs::{document, documents, in_docs, root};

/// Returns the text without fenced code.
fn prose(text: &str) -> String {
    let parts = text.split("```").enumerate();
    parts
        .filter(|(index, _)| index % 2 == 0)
        .map(|(_, part)| part)
        .collect()
}

/// Returns the targets of `[…](target)` and of `src="target"`.
fn targets(text: &str) -> Vec<String> {
    let prose = prose(text);
    let ends = [("](", ')'), ("src=\"", '"')];
    let mut found = Vec::new();
    for (start, end) in ends {
        for rest in prose.split(start).skip(1) {
            if let Some((target, _)) = rest.split_once(end) {
                found.push(target.to_owned());
            }
        }
    }
    found
}

/// Returns the anchors of a page: its headings, converted as code hosts do it (lower case, only letters and digits, a
/// dash for a space), and the anchors that the page sets itself.
fn anchors(text: &str) -> BTreeSet<String> {
    let prose = prose(text);
    let headings = prose.lines().filter(|line| line.starts_with('#'));
    let anchor = |heading: &str| {
        let heading = heading.trim_start_matches('#').trim().to_lowercase();
        let kept = heading
            .chars()
            .filter(|letter| letter.is_alphanumeric() || " -_".contains(*letter));
        kept.map(|letter| if letter == ' ' { '-' } else { letter })
            .collect::<String>()
    };
    let named = prose.split("<a id=\"").skip(1);
    let named = named.filter_map(|rest| Some(rest.split_once('"')?.0.to_owned()));
    headings.map(anchor).chain(named).collect()
}

/// The package contains neither the repository's checks nor its fuzz targets.
fn is_packaged(path: &str) -> bool {
    let left_out = path.contains(".ci/") || path.contains("fuzz/");
    !left_out || root().join(".ci").exists()
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let mut checked = 0;
    for (page, text) in documents() {
        let at = page.display();
        let folder = root().join(page.parent().expect("a folder"));
        let targets = targets(&text).into_iter();
        for target in
            targets.filter(|target| !target.starts_with("https://") && is_packaged(target))
        {
            let (file, anchor) = target.split_once('#').unwrap_or((&target, ""));
            let path = if file.is_empty() {
                root().join(&page)
            } else {
                folder.join(file)
            };
            assert!(path.exists(), "{at}: {target} leads nowhere");
            if !anchor.is_empty() {
                let text = fs::read_to_string(&path).expect("a page");
                let there = anchors(&text).contains(anchor);
                assert!(there, "{at}: {target}: no such heading");
            }
            checked += 1;
        }
    }
    assert!(checked >= 20, "{checked} links were found");
}

/// Readers cannot find a page that the guide does not link to, nor the guide if the README does not.
#[test]
fn every_page_is_linked_from_the_guide() {
    let linked = targets(&document("docs/README.md"));
    for page in in_docs("md") {
        let name = page.file_name().expect("a name").to_string_lossy();
        let found = linked
            .iter()
            .any(|link| link.split('#').next() == Some(&name));
        assert!(
            found || name == "README.md",
            "the guide does not link to {name}"
        );
    }
    assert!(targets(&document("README.md")).contains(&"docs/README.md".to_owned()));
}

/// Paths in the documents' prose, such as `src/lib.rs`, must exist.
#[test]
fn every_path_named_exists() {
    let rooms = "src/ crates/ tests/ examples/ benches/ library/ docs/ .ci/ fuzz/";
    let mut missing = Vec::new();
    for (page, text) in documents() {
        // Changes name what there was.
        if page.starts_with("CHANGELOG.md") {
            continue;
        }
        let prose = prose(&text);
        let codes = prose.split('`').skip(1).step_by(2);
        // A pattern, a command, a place to fill in.
        let paths = codes.filter(|code| !code.contains([' ', '*', '\n']) && !code.contains("NAME"));
        for path in paths.filter_map(|code| code.split("::").next()) {
            let is_ours = rooms.split(' ').any(|room| path.starts_with(room));
            if is_ours && is_packaged(path) && !root().join(path).exists() {
                missing.push(format!("{}: {path}", page.display()));
            }
        }
    }
    assert!(missing.is_empty(), "no such files: {missing:#?}");
}
