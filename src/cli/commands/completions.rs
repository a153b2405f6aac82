//! `taxel completions`: writes the completions of `taxel` for a shell, made from the definitions of the commands.
//! Shells get the names of shapes and models from `taxel library list --names` and `taxel model list --names` when
//! they complete; if no name fits, they offer files.

use std::collections::BTreeSet;
use std::iter;

use clap::Command;
use clap::builder::PossibleValue;
use clap_complete::shells::{Bash, Fish, Zsh};
use clap_complete::{Generator, generate};

use crate::cli::arguments::program::Shell;
use crate::storage::ModelChoice;

/// The end of the script for bash, which adds names to clap's completions. `VALUES` is replaced by all flags with a
/// value, which are not arguments of a command, and `SETS` by the built-in models. The names are those of the folder
/// that `--library` names on the line, or else of the user's library. A blank in a name is escaped, unless the word
/// starts with a quotation mark, which is not part of the text that bash replaces.
const NAMES_OF_BASH: &str = r#"
_taxel_names() {
    _taxel "$@"
    local values=" VALUES " cur="${COMP_WORDS[COMP_CWORD]}" flag="" quote="" command kinds kind name word at
    local -a words=() library=()
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
    case "$flag $command" in
        "--model "*) kinds="models sets" ;;
        "--picture "* | "--mask "*) kinds="shapes" ;;
        --*) return 0 ;;
        " library save" | " model train") kinds="shapes" ;;
        " model separate") kinds="shapes models sets" ;;
        *)
            ((${#words[@]} == 0)) || return 0
            case "$command" in
                picture | describe | export | recogni[sz]e | "library show") kinds="shapes" ;;
                "library delete") kinds="own" ;;
                "library restore") kinds="deleted" ;;
                "model show" | "model confusion" | "model touches") kinds="models sets" ;;
                "model delete") kinds="models" ;;
                *) return 0 ;;
            esac
            ;;
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
    done < <(for kind in $kinds; do
        case "$kind" in
            shapes) taxel library list --names "${library[@]}" ;;
            own) taxel library list --names --own "${library[@]}" ;;
            deleted) taxel library list --names --deleted "${library[@]}" ;;
            models) taxel model list --names "${library[@]}" ;;
            sets) printf '%s\n' SETS ;;
        esac 2> /dev/null
    done)
}

complete -F _taxel_names -o bashdefault -o default taxel
"#;

/// The functions for zsh that offer names of one kind, or files. `SETS` is replaced by the built-in models.
const NAMES_OF_ZSH: &str = r#"(( $+functions[_taxel_names] )) ||
_taxel_names() {
    local kind=$1
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
    names=(${(f)"$(_call_program names taxel $@ --names ${(q)library} 2> /dev/null)"})
    [[ $kind == set ]] && names+=(SETS)
    _alternative "names:$kind:compadd -a names" 'files:file:_files'
}
_taxel_shapes() { _taxel_names shape library list }
_taxel_own() { _taxel_names shape library list --own }
_taxel_deleted() { _taxel_names shape library list --deleted }
_taxel_models() { _taxel_names model model list }
_taxel_sets() { _taxel_names set model list }

"#;

/// The beginnings of arguments in clap's script for zsh that are names, and the kind of these names. The help of an
/// argument may have several lines.
const ARGUMENTS_OF_ZSH: [(&str, &str); 8] = [
    ("':what -- ", "shapes"),
    ("'*::set -- ", "shapes"),
    ("'--picture=[", "shapes"),
    ("'--mask=[", "shapes"),
    ("':name -- Name of the shape", "shapes"),
    ("':name -- Name of the model", "models"),
    ("':model -- ", "sets"),
    ("'--model=[", "sets"),
];

/// The end of the script for fish, which escapes what it inserts. `SETS` is replaced by the built-in models.
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
function __fish_taxel_sets
    __fish_taxel_names model list
    printf '%s\n' SETS
end
complete -c taxel -n "__fish_taxel_using_subcommand picture describe export recognise recognize" -a "(__fish_taxel_names library list)" -d shape
complete -c taxel -n "__fish_taxel_using_subcommand library; and __fish_seen_subcommand_from show save" -a "(__fish_taxel_names library list)" -d shape
complete -c taxel -n "__fish_taxel_using_subcommand library; and __fish_seen_subcommand_from delete" -a "(__fish_taxel_names library list --own)" -d shape
complete -c taxel -n "__fish_taxel_using_subcommand library; and __fish_seen_subcommand_from restore" -a "(__fish_taxel_names library list --deleted)" -d shape
complete -c taxel -n "__fish_taxel_using_subcommand model; and __fish_seen_subcommand_from train separate" -a "(__fish_taxel_names library list)" -d shape
complete -c taxel -n "__fish_taxel_using_subcommand model; and __fish_seen_subcommand_from show confusion touches separate" -a "(__fish_taxel_sets)" -d model
complete -c taxel -n "__fish_taxel_using_subcommand model; and __fish_seen_subcommand_from delete" -a "(__fish_taxel_names model list)" -d model
complete -c taxel -n "__fish_taxel_using_subcommand sweep" -l picture -r -a "(__fish_taxel_names library list)" -d shape
complete -c taxel -n "__fish_taxel_using_subcommand recognise" -l mask -r -a "(__fish_taxel_names library list)" -d shape
complete -c taxel -n "__fish_taxel_using_subcommand recognise recognize frames watch" -l model -r -a "(__fish_taxel_sets)" -d model
"#;

/// Changes clap's script for zsh, so that it offers names in place of files. `functions` offer them.
fn names_of_zsh(script: &str, functions: &str) -> String {
    let mut changed = String::new();
    let (mut command, mut kind) = ("", None);
    for line in script.lines() {
        if line.starts_with("if [ \"$funcstack[1]\"") {
            changed += functions;
        }
        // A subcommand is a case of the script.
        if let Some(name) = line
            .strip_prefix('(')
            .and_then(|line| line.strip_suffix(')'))
        {
            command = name;
        }
        if line.starts_with('\'') {
            let begins = |argument: &&(&str, &str)| line.starts_with(argument.0);
            kind = ARGUMENTS_OF_ZSH.iter().find(begins).map(|&(_, kind)| kind);
        }
        let kind = match (kind, command) {
            (Some("shapes"), "delete") => Some("own"),
            (Some("shapes"), "restore") => Some("deleted"),
            (kind, _) => kind,
        };
        match (kind, line.strip_suffix(":_default' \\")) {
            (Some(kind), Some(start)) => changed += &format!("{start}:_taxel_{kind}' \\"),
            _ => changed += line,
        }
        changed.push('\n');
    }
    changed
}

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

/// Returns the completions of all commands, as a script for a shell.
pub(crate) fn script(shell: Shell, mut all: Command) -> String {
    let sets = ModelChoice::BUILT_IN.map(|set| set.name().to_owned());
    let with_sets = |text: &str| text.replace("SETS", &sets.join(" "));
    match shell {
        Shell::Bash => {
            let script = generated(Bash, &mut all);
            let case = |names: &str| format!("taxel,{names})");
            let values: Vec<String> = flags_with_value(&all).into_iter().collect();
            with_aliases(script, &all, case, " | taxel,")
                + &with_sets(NAMES_OF_BASH).replace("VALUES", &values.join(" "))
        }
        Shell::Zsh => {
            let script = generated(Zsh, &mut all);
            let case = |names: &str| format!("\n({names})\n");
            let script = with_aliases(script, &all, case, "|");
            names_of_zsh(&script, &with_sets(NAMES_OF_ZSH))
        }
        Shell::Fish => {
            let script = generated(Fish, &mut all) + &words_of_fish(&all);
            let case = |names: &str| format!("__fish_taxel_using_subcommand {names}\"");
            with_aliases(script + &with_sets(NAMES_OF_FISH), &all, case, " ")
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
