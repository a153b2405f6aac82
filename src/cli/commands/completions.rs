//! `taxel completions`: writes a shell's completions for `taxel`, made from the definitions of the commands. Names of
//! shapes come from `taxel library list --names` at the moment when they are asked for; where no name fits, shells
//! offer files.

use clap::Command;
use clap::builder::PossibleValue;
use clap_complete::generate;
use clap_complete::shells::{Bash, Fish, Zsh};

/// A shell with completions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shell {
    /// Its script is the one of clap, wrapped: names are added where a command takes one.
    Bash,
    /// Its script is changed line by line, see [`NAMES_OF_ZSH`].
    Zsh,
    /// Lines are added behind clap's script.
    Fish,
}

impl Shell {
    /// All of them.
    pub(crate) const ALL: [Self; 3] = [Self::Bash, Self::Zsh, Self::Fish];

    /// Its name, as in the argument.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Bash => "bash",
            Self::Zsh => "zsh",
            Self::Fish => "fish",
        }
    }

    /// The shell of that name; None for any other word.
    pub(crate) fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shell| shell.name() == name)
    }
}

/// The names are those of the folder that `--library` on the line names, else of the user's library.
/// For bash: what clap wrote, and names of shapes where a command takes one. A blank in a name is escaped, unless the
/// word was begun with a quotation mark: that is not part of what bash replaces.
const SHAPES_OF_BASH: &str = r#"
_taxel_shapes() {
    _taxel "$@"
    local cur="${COMP_WORDS[COMP_CWORD]}" first=2 quote="" name at
    local -a words=() library=()
    for ((at = 0; at <= COMP_CWORD; at++)); do
        if [[ "${COMP_WORDS[at]}" != --library ]]; then
            words+=("${COMP_WORDS[at]}")
            continue
        fi
        [[ "${COMP_WORDS[at + 1]}" == "=" ]] && ((at++))
        ((++at < COMP_CWORD)) || return 0
        name="${COMP_WORDS[at]//[\\\"\']/}"
        library=(--library "${name/#\~/$HOME}")
    done
    local command="${words[1]}"
    case "$command" in
        library | model)
            command+=" ${words[2]}"
            first=3
            ;;
    esac
    case "$command" in
        "library save" | "model train")
            [[ "$3" == --* ]] && return 0
            ;;
        picture | describe | export | recognise | "library show" | "library delete")
            ((${#words[@]} - 1 == first)) || [[ "$3" == --json ]] || return 0
            ;;
        sweep)
            [[ "$3" == --picture ]] || return 0
            ;;
        *)
            return 0
            ;;
    esac
    ((${#words[@]} > first)) && [[ "$cur" != -* ]] || return 0
    case "$cur" in
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
    done < <(taxel library list --names "${library[@]}" 2> /dev/null)
}

complete -F _taxel_shapes -o bashdefault -o default taxel
"#;

/// For zsh: the function that offers names of shapes, or files.
const SHAPES_OF_ZSH: &str = r#"(( $+functions[_taxel_shapes] )) ||
_taxel_shapes() {
    local -a shapes library line
    line=(${(z)LBUFFER})
    local at=${line[(I)--library]} joined=${line[(r)--library=*]} folder=""
    if (( at && at < $#line )); then
        folder=${line[at+1]}
    elif [[ -n $joined ]]; then
        folder=${joined#--library=}
    fi
    folder=${(Q)folder}
    [[ -n $folder ]] && library=(--library "${folder/#\~/$HOME}")
    shapes=(${(f)"$(_call_program shapes taxel library list --names ${(q)library} 2> /dev/null)"})
    _alternative 'shapes:shape:compadd -a shapes' 'files:file:_files'
}

"#;

/// Where clap's script for zsh takes any file: an argument that is a name of a shape begins and ends so.
const NAMES_OF_ZSH: [(&str, &str); 4] = [
    ("':what -- ", ":_default' \\"),
    ("'*::set -- ", ":_default' \\"),
    ("':name -- Name of the shape", ":_default' \\"),
    ("'--picture=[", ":_default' \\"),
];

/// For fish, which escapes what it inserts.
const SHAPES_OF_FISH: &str = r#"
function __fish_taxel_shapes
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
    taxel library list --names $library 2> /dev/null
end
complete -c taxel -n "__fish_taxel_using_subcommand picture describe export recognise" -a "(__fish_taxel_shapes)" -d shape
complete -c taxel -n "__fish_taxel_using_subcommand library; and __fish_seen_subcommand_from show save delete" -a "(__fish_taxel_shapes)" -d shape
complete -c taxel -n "__fish_taxel_using_subcommand model; and __fish_seen_subcommand_from train" -a "(__fish_taxel_shapes)" -d shape
complete -c taxel -n "__fish_taxel_using_subcommand sweep" -l picture -r -a "(__fish_taxel_shapes)" -d shape
"#;

/// The script for zsh, with names of shapes where clap has any file.
fn shapes_of_zsh(script: &str) -> String {
    let mut changed = String::new();
    for line in script.lines() {
        if line.starts_with("if [ \"$funcstack[1]\"") {
            changed += SHAPES_OF_ZSH;
        }
        let is_shape = |(start, end): &(&str, &str)| line.starts_with(start) && line.ends_with(end);
        if NAMES_OF_ZSH.iter().any(is_shape) {
            changed += &line.replace(":_default' \\", ":_taxel_shapes' \\");
        } else {
            changed += line;
        }
        changed.push('\n');
    }
    changed
}

/// The completions of all commands, as a script for the shell.
pub(crate) fn script(shell: Shell, mut all: Command) -> Vec<u8> {
    let (mut script, name) = (Vec::new(), "taxel");
    match shell {
        Shell::Bash => {
            generate(Bash, &mut all, name, &mut script);
            script.extend(SHAPES_OF_BASH.as_bytes());
        }
        Shell::Zsh => {
            generate(Zsh, &mut all, name, &mut script);
            script = shapes_of_zsh(&String::from_utf8_lossy(&script)).into_bytes();
        }
        Shell::Fish => {
            generate(Fish, &mut all, name, &mut script);
            script.extend(words_of_fish(&all).into_bytes());
            script.extend(SHAPES_OF_FISH.as_bytes());
        }
    }
    script
}

/// The words that commands take as arguments, for fish: clap's generator writes only commands and flags for it.
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
