//! Lists the commands of the program, as its help texts name them, for tests that check every command.

/// Returns the names of all commands in the order of the help texts, each before its subcommands. The program itself
/// has the empty name. `help` returns the help of a command.
pub(crate) fn commands(help: &dyn Fn(&str) -> String) -> Vec<String> {
    with_subcommands("", help)
}

fn with_subcommands(command: &str, help: &dyn Fn(&str) -> String) -> Vec<String> {
    let text = help(command);
    let (start, end) = if command.is_empty() {
        // The program's own help lists its commands in groups.
        ("\nTouch:\n", "\nOptions:\n")
    } else {
        ("\nCommands:\n", "\n\n")
    };
    let listed = text.split_once(start).map_or("", |(_, below)| {
        let (listed, _) = below.split_once(end).expect("the list ends");
        listed
    });
    let mut found = vec![command.to_owned()];
    for line in listed.lines().filter_map(|line| line.strip_prefix("  ")) {
        let name = line.split(' ').next().expect("a word");
        // Lines with a deeper indent continue the description of a command.
        if !name.is_empty() && name != "help" {
            let path = format!("{command} {name}");
            found.extend(with_subcommands(path.trim_start(), help));
        }
    }
    found
}
