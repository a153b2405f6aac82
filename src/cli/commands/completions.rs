//! `taxel completions`: writes the completions of `taxel` for a shell, made from the definitions of the commands.
//! Shells get the names of shapes and models from `taxel library list --names` and `taxel model list --names` when
//! they complete; if no name fits, they offer files.

use std::collections::BTreeSet;
use std::iter;

use clap::builder::{PossibleValue, Resettable};
use clap::{Arg, Command};
use clap_complete::shells::{Bash, Fish, Zsh};
use clap_complete::{Generator, generate};

use crate::cli::arguments::program::Shell;
use crate::storage::ModelChoice;

/// A list of names that a shell offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Names {
    /// The shapes of the library.
    Shapes,
    /// The user's own shapes of the library.
    Own,
    /// The deleted shapes.
    Deleted,
    /// The models beside the library.
    Models,
    /// The built-in models.
    BuiltIn,
}

impl Names {
    /// Returns the command that lists the names with `--names`; `sets` for the built-in models, which are part of the
    /// script.
    const fn list(self) -> &'static str {
        match self {
            Self::Shapes => "library list",
            Self::Own => "library list --own",
            Self::Deleted => "library list --deleted",
            Self::Models => "model list",
            Self::BuiltIn => "sets",
        }
    }

    /// Returns what a name belongs to.
    const fn label(self) -> &'static str {
        match self {
            Self::Shapes | Self::Own | Self::Deleted => "shape",
            Self::Models | Self::BuiltIn => "model",
        }
    }
}

/// The stored shapes.
const SHAPES: &[Names] = &[Names::Shapes];

/// All models.
const MODELS: &[Names] = &[Names::Models, Names::BuiltIn];

/// Shapes, and models for their shapes.
const SETS: &[Names] = &[Names::Shapes, Names::Models, Names::BuiltIn];

/// The arguments that are names: the command, the argument's id, and the names. All others are files or values.
const NAMED: [(&str, &str, &[Names]); 19] = [
    ("picture", "what", SHAPES),
    ("describe", "what", SHAPES),
    ("export", "what", SHAPES),
    ("sweep", "picture", SHAPES),
    ("recognise", "what", SHAPES),
    ("recognise", "mask", SHAPES),
    ("recognise", "model", MODELS),
    ("frames", "model", MODELS),
    ("watch", "model", MODELS),
    ("library show", "name", SHAPES),
    ("library save", "what", SHAPES),
    ("library delete", "name", &[Names::Own]),
    ("library restore", "name", &[Names::Deleted]),
    ("model train", "set", SHAPES),
    ("model separate", "set", SETS),
    ("model show", "model", MODELS),
    ("model confusion", "model", MODELS),
    ("model touches", "model", MODELS),
    ("model delete", "name", &[Names::Models]),
];

/// An argument of [`NAMED`].
struct Named<'a> {
    /// The names of the command that `command` belongs to, if any, followed by a space.
    within: &'static str,
    /// The command.
    command: &'a Command,
    /// The argument.
    argument: &'a Arg,
    /// The names that the argument takes.
    names: &'static [Names],
}

/// Returns the arguments of [`NAMED`] that are defined: all of them.
fn named(all: &Command) -> impl Iterator<Item = Named<'_>> {
    NAMED.iter().filter_map(move |&(path, id, names)| {
        let mut words = path.split(' ');
        let command = words.try_fold(all, |command, name| command.find_subcommand(name))?;
        let argument = command
            .get_arguments()
            .find(|argument| argument.get_id() == id)?;
        Some(Named {
            within: path.strip_suffix(command.get_name())?,
            command,
            argument,
            names,
        })
    })
}

/// The end of the script for bash, which adds names to clap's completions. `VALUES` is replaced by all flags with a
/// value, which are not arguments of a command, `CASES` by [`cases_of_bash`], and `SETS` by the built-in models. The
/// names are those of the folder that `--library` names on the line, or else of the user's library. A blank in a name
/// is escaped, unless the word starts with a quotation mark, which is not part of the text that bash replaces.
const NAMES_OF_BASH: &str = r#"
_taxel_names() {
    _taxel "$@"
    local values=" VALUES " cur="${COMP_WORDS[COMP_CWORD]}" flag="" quote="" command list name word at
    local -a words=() library=() lists=()
    for ((at = 1; at < COMP_CWORD; at++)); do
        word="${COMP_WORDS[at]}"
        if [[ "$word" != -* || "$word" == - ]]; then
            words+=("$word")
            continue
        fi
        [[ "$values" == *" $word "* ]] || continue
        [[ "${COMP_WORDS[at + 1]}" == "=" ]] && ((at++))
        if ((++at >= COMP_CWORD)); then
            flag="$word"
        elif [[ "$word" == --library ]]; then
            name="${COMP_WORDS[at]//[\\\"\']/}"
            library=(--library "${name/#\~/$HOME}")
        fi
    done
    command="${words[0]}"
    words=("${words[@]:1}")
    case "$command" in
        library | model)
            command+=" ${words[0]}"
            words=("${words[@]:1}")
            ;;
    esac
    case "$command ${flag:-${#words[@]}}" in
CASES        *) return 0 ;;
    esac
    case "$cur" in
        -*) return 0 ;;
        =) cur="" ;;
        \"* | \'*)
            quote="${cur:0:1}"
            cur="${cur:1}"
            ;;
        *)
            cur="${cur//\\/}"
            ;;
    esac
    COMPREPLY=()
    while IFS= read -r name; do
        [[ "$name" == "$cur"* ]] || continue
        [[ -n "$quote" ]] || printf -v name %q "$name"
        COMPREPLY+=("$name")
    done < <(for list in "${lists[@]}"; do
        case "$list" in
            sets) printf '%s\n' SETS ;;
            *) taxel $list --names "${library[@]}" ;;
        esac 2> /dev/null
    done)
}

complete -F _taxel_names -o bashdefault -o default taxel
"#;

/// The function for zsh that offers the names of some lists, or files. `$1` is what such a name belongs to. `SETS` is
/// replaced by the built-in models.
const NAMES_OF_ZSH: &str = r#"(( $+functions[_taxel_names] )) ||
_taxel_names() {
    local label=$1 list
    shift
    local -a names library line
    line=(${(z)LBUFFER})
    local at=${line[(I)--library]} joined=${line[(r)--library=*]} folder=""
    if (( at && at < $#line )); then
        folder=${line[at+1]}
    elif [[ -n $joined ]]; then
        folder=${joined#--library=}
    fi
    folder=${(Q)folder}
    [[ -n $folder ]] && library=(--library "${folder/#\~/$HOME}")
    for list; do
        if [[ $list == sets ]]; then
            names+=(SETS)
        else
            names+=(${(f)"$(_call_program names taxel $list --names ${(q@)library} 2> /dev/null)"})
        fi
    done
    _alternative "names:${label}:compadd -a names" 'files:file:_files'
}

"#;

/// The function for fish that lists names; fish escapes what it inserts.
const NAMES_OF_FISH: &str = r#"
function __fish_taxel_names
    set -l words (commandline -opc)
    set -l folder
    if set -l at (contains -i -- --library $words); and test $at -lt (count $words)
        set folder $words[(math $at + 1)]
    else
        set folder (string replace -f -- --library= "" $words)
    end
    set -l library
    if test -n "$folder[1]"
        set library --library (string replace -r '^~' $HOME -- $folder[1])
    end
    taxel $argv --names $library 2> /dev/null
end
"#;

/// Returns the flags with a value of a command and of its subcommands.
fn flags_with_value(command: &Command) -> BTreeSet<String> {
    let own = command
        .get_arguments()
        .filter(|argument| argument.get_action().takes_values());
    let own = own.filter_map(|argument| argument.get_long());
    let flags = own.map(|flag| format!("--{flag}"));
    let inner = command.get_subcommands().flat_map(flags_with_value);
    flags.chain(inner).collect()
}

/// Lets a script complete after an alias of a command, such as `recognize`: clap leaves these out, since it does not
/// offer them. `case` is the script's pattern for a name, in which more names are separated by `or`.
fn with_aliases(
    mut script: String,
    all: &Command,
    case: impl Fn(&str) -> String,
    or: &str,
) -> String {
    for command in all.get_subcommands() {
        let name = command.get_name();
        let names: Vec<&str> = iter::once(name).chain(command.get_all_aliases()).collect();
        script = script.replace(&case(name), &case(&names.join(or)));
    }
    script
}

/// Returns clap's completions of all commands, as a script for a shell.
fn generated(shell: impl Generator, all: &mut Command) -> String {
    let mut script = Vec::new();
    generate(shell, all, "taxel", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// Returns a case of the script for bash for each argument of [`NAMED`]: its command, in each spelling, with its flag
/// or with the number of arguments before it.
fn cases_of_bash(all: &Command) -> String {
    let case = |named: Named<'_>| {
        let (command, argument) = (named.command, named.argument);
        let mut before = command.get_positionals();
        let at = match (argument.get_long(), argument.get_num_args()) {
            (Some(flag), _) => format!("--{flag}"),
            (None, Some(number)) if number.max_values() > 1 => "[0-9]*".to_owned(),
            (None, _) => before
                .position(|own| own == argument)
                .map_or_else(String::new, |at| at.to_string()),
        };
        let names = iter::once(command.get_name()).chain(command.get_all_aliases());
        let patterns: Vec<_> = names
            .map(|name| format!("\"{}{name} \"{at}", named.within))
            .collect();
        format!(
            "        {}) lists=({}) ;;\n",
            patterns.join(" | "),
            quoted(named.names)
        )
    };
    named(all).map(case).collect()
}

/// Returns the lists of names in quotation marks.
fn quoted(names: &[Names]) -> String {
    let lists = names.iter().map(|names| format!("\"{}\"", names.list()));
    lists.collect::<Vec<_>>().join(" ")
}

/// Returns the action for zsh that offers names in place of files.
fn action_of_zsh(names: &[Names]) -> String {
    let label = names.first().map_or("name", |names| names.label());
    format!("_taxel_names {label} {}", quoted(names))
}

/// Gives the arguments of [`NAMED`] a single value, which is the action that offers the names: clap writes the values
/// of an argument into its script for zsh. `within` is the command's name, after that of the command it belongs to.
fn with_actions_of_zsh(command: Command, within: &str) -> Command {
    let with_action = |argument: Arg| {
        let is_own = |(path, id, _): &&(&str, &str, _)| *path == within && argument.get_id() == *id;
        match NAMED.iter().find(is_own) {
            Some((_, _, names)) => argument
                .value_parser([PossibleValue::new(action_of_zsh(names))])
                .default_value(Resettable::Reset),
            None => argument,
        }
    };
    command.mut_args(with_action).mut_subcommands(|own| {
        let path = format!("{within} {}", own.get_name());
        with_actions_of_zsh(own, path.trim_start())
    })
}

/// Returns the completions for zsh, with names in place of files. `functions` offer them.
fn script_of_zsh(all: Command, functions: &str) -> String {
    let script = generated(Zsh, &mut with_actions_of_zsh(all, ""));
    let script = NAMED.iter().fold(script, |script, (_, _, names)| {
        let action = action_of_zsh(names);
        let value = action.replace(' ', "\\ ");
        script.replace(&format!(":({value})'"), &format!(": {action}'"))
    });
    let main = "if [ \"$funcstack[1]\"";
    script.replacen(main, &format!("{functions}{main}"), 1)
}

/// Returns a line of the script for fish for each list of names of each argument of [`NAMED`]. Arguments without a flag
/// are not told apart.
fn names_of_fish(all: &Command, sets: &str) -> String {
    let lines = |named: Named<'_>| {
        let name = named.command.get_name();
        let condition = match named.within.trim_end() {
            "" => format!("__fish_taxel_using_subcommand {name}"),
            group => format!(
                "__fish_taxel_using_subcommand {group}; and __fish_seen_subcommand_from {name}"
            ),
        };
        let flag = named
            .argument
            .get_long()
            .map_or_else(String::new, |flag| format!("-l {flag} -r "));
        let line = move |names: &Names| {
            let offered = match names {
                Names::BuiltIn => sets.to_owned(),
                _ => format!("(__fish_taxel_names {})", names.list()),
            };
            format!(
                "complete -c taxel -n \"{condition}\" {flag}-a \"{offered}\" -d {}\n",
                names.label()
            )
        };
        named.names.iter().map(line).collect::<String>()
    };
    named(all).map(lines).collect()
}

/// Returns the completions of all commands, as a script for a shell.
pub(crate) fn script(shell: Shell, mut all: Command) -> String {
    let sets: Vec<&str> = ModelChoice::BUILT_IN
        .iter()
        .map(ModelChoice::name)
        .collect();
    let sets = sets.join(" ");
    match shell {
        Shell::Bash => {
            let script = generated(Bash, &mut all);
            let case = |names: &str| format!("taxel,{names})");
            let values: Vec<String> = flags_with_value(&all).into_iter().collect();
            let names = NAMES_OF_BASH.replace("VALUES", &values.join(" "));
            let names = names
                .replace("CASES", &cases_of_bash(&all))
                .replace("SETS", &sets);
            with_aliases(script, &all, case, " | taxel,") + &names
        }
        Shell::Zsh => {
            let case = |names: &str| format!("\n({names})\n");
            let script = script_of_zsh(all.clone(), &NAMES_OF_ZSH.replace("SETS", &sets));
            with_aliases(script, &all, case, "|")
        }
        Shell::Fish => {
            let script = generated(Fish, &mut all) + &words_of_fish(&all);
            let script = script + NAMES_OF_FISH + &names_of_fish(&all, &sets);
            let case = |names: &str| format!("__fish_taxel_using_subcommand {names}\"");
            with_aliases(script, &all, case, " ")
        }
    }
}

/// Returns the words that commands take as arguments, for fish: clap's script has only commands and flags.
fn words_of_fish(all: &Command) -> String {
    let mut lines = String::new();
    for command in all.get_subcommands() {
        for argument in command.get_positionals() {
            let values = argument.get_possible_values();
            let words: Vec<&str> = values.iter().map(PossibleValue::get_name).collect();
            if !words.is_empty() {
                lines += &format!(
                    "complete -c taxel -n \"__fish_taxel_using_subcommand {}\" -f -a \"{}\"\n",
                    command.get_name(),
                    words.join(" ")
                );
            }
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::definitions;

    #[test]
    fn every_argument_that_is_a_name_is_defined_and_offers_names_in_each_shell() {
        let all = definitions::all();
        assert_eq!(named(&all).count(), NAMED.len());
        let zsh = script(Shell::Zsh, all.clone());
        assert_eq!(zsh.matches(": _taxel_names ").count(), NAMED.len(), "{zsh}");
        assert_eq!(zsh.matches("_taxel_names\\").count(), 0, "{zsh}");
        let bash = script(Shell::Bash, all.clone());
        assert_eq!(bash.matches(") lists=(\"").count(), NAMED.len(), "{bash}");
        let fish = script(Shell::Fish, all);
        let lines = NAMED.iter().map(|(_, _, names)| names.len()).sum::<usize>();
        assert_eq!(
            fish.matches("-d shape\n").count() + fish.matches("-d model\n").count(),
            lines,
            "{fish}"
        );
    }
}
