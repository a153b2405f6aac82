//! The table of commands, and the completion of what is typed.

use crate::figure::Kind;

/// A command: its name, what may follow it, what it does.
#[derive(Clone, Copy, Debug)]
pub struct Command {
    /// The first word.
    pub name: &'static str,
    /// What may follow.
    pub arguments: &'static str,
    /// What it does.
    pub help: &'static str,
}

const fn command(name: &'static str, arguments: &'static str, help: &'static str) -> Command {
    Command {
        name,
        arguments,
        help,
    }
}

/// All commands, by name.
pub const COMMANDS: &[Command] = &[
    command(
        "copy",
        "[imprint|descriptors]",
        "into the clipboard of your terminal",
    ),
    command("coverage", "", "shades, percent, the imprint again"),
    command("delete", "[NAME]", "remove a shape"),
    command("figure", "[KIND --side 3 ...]", "touch a figure"),
    command("grab", "", "hold the shape"),
    command("help", "", "all keys"),
    command("load", "[NAME]", "bring a shape onto the matrix"),
    command("mouse", "", "have the mouse reported, or not"),
    command("new", "", "empty the matrix"),
    command("panel", "", "on a narrow screen: descriptors, matrix"),
    command("picture", "[NAME]", "move a shape about"),
    command("quit", "", "leave; quit! without a question"),
    command("redo", "", "make it again"),
    command("redraw", "", "draw the screen anew"),
    command("region", "", "the next piece or hole"),
    command("restore", "NAME", "bring back a removed shape"),
    command("save", "[NAME]", "store what is on the matrix"),
    command("sensor", "[--columns 32 ...]", "change the sensor"),
    command("toggle", "", "turn a taxel over"),
    command("turn", "DEGREES", "turn the shape, clockwise as seen"),
    command("undo", "", "take back the last change"),
    command("zoom", "in|out", "make a picture larger, smaller"),
];

/// The line with its last word completed as far as it is certain, and what it could become.
pub fn complete(line: &str) -> (String, Vec<&'static str>) {
    let (before, last) = line
        .rsplit_once(' ')
        .map_or(("", line), |(before, last)| (before, last));
    let candidates: Vec<&'static str> = match before.split_whitespace().collect::<Vec<_>>()[..] {
        [] => COMMANDS.iter().map(|command| command.name).collect(),
        ["figure"] => Kind::ALL.map(Kind::name).to_vec(),
        ["copy"] => vec!["descriptors", "imprint"],
        ["zoom"] => vec!["in", "out"],
        _ => Vec::new(),
    };
    let fitting: Vec<&'static str> = candidates
        .into_iter()
        .filter(|candidate| candidate.starts_with(last))
        .collect();
    let Some((first, others)) = fitting.split_first() else {
        return (line.to_owned(), fitting);
    };
    let common = others.iter().fold(*first, |common, other| {
        let length = common
            .bytes()
            .zip(other.bytes())
            .take_while(|(a, b)| a == b)
            .count();
        &common[..length]
    });
    let space = if fitting.len() == 1 { " " } else { "" };
    let before = if before.is_empty() {
        String::new()
    } else {
        format!("{before} ")
    };
    (format!("{before}{common}{space}"), fitting)
}
