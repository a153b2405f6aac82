//! The longer texts of the help, which follow the flags of a command: explanations and examples.
//!
//! A text may begin with some lines of explanation; then comes `Examples:` with one command per line, indented. Man
//! pages are made from the same texts. No line is wider than 80 columns. A test runs every example
//! (`tests/cli/shell.rs`).
//!
//! The texts explain the meaning of values and of missing ones, formats of input, and in a line each, what may
//! surprise; they do not repeat the help of a flag. Commands are indented by two spaces, and long ones continue after
//! a `\`.

/// The purpose of the program: the first lines of `taxel --help`.
pub(crate) const ABOUT: &str = "\
Which shapes can a robot recognise by touching them once?

taxel simulates how a tactile sensor touches flat shapes, computes their exact
imprints and describes them. Without a command, it opens the screen, where you
can do all of this and see the result as you type.";

/// Below the flags of `taxel --help`: units, exit status and an example of most commands.
pub(crate) const EXAMPLES: &str = "\
Lengths are in cells: 1 is the side of a cell of the sensor. x runs to the
right, y down.
Exit status: 0 success, 1 wrong input, 2 wrong command line, 3 not the expected
answer, 128 + n ended by signal n.
Settings: 'taxel config'. Environment and files: 'taxel man | man -l -'.

Examples:
  taxel
  taxel figure ellipse --x0 1.99 --y0 1.47 --thickness 2
  taxel figure hexagon --side 3 --angle 17 --json
  taxel picture washer --x0 6 --angle 30 --save \"turned washer\"
  taxel library list
  taxel describe imprint.txt
  taxel export washer washer.svg
  taxel batch < poses.jsonl > answers.jsonl";

/// `taxel library`: what a library is, and which folder it is.
pub(crate) const LIBRARY_EXAMPLES: &str = "\
A library is a folder with one JSON file per shape. The shapes that come with
the program are always listed; you can copy them, but not change them. A name
has 1 to 64 letters, digits, spaces, '-', '_' or '.'; case does not matter.
The folder is the one that --library names; if it is not given, the one in the
variable TAXEL_LIBRARY, then the 'library' of the settings, then
~/.local/share/taxel/library.

Examples:
  taxel library list
  taxel library show washer
  taxel library save ring imprint.txt
  taxel library --library ./shapes check";

/// `taxel library list`.
pub(crate) const LIST_EXAMPLES: &str = "\
Prints size (columns x rows), active taxels, pieces and holes. Files that cannot
be read are listed as broken, with the reason.

Examples:
  taxel library list
  taxel library list --json";

/// `taxel library show`.
pub(crate) const SHOW_EXAMPLES: &str = "\
Examples:
  taxel library show washer
  taxel library show \"my nut\" --pitch 2.5
  taxel library show key --json";

/// `taxel library save`.
pub(crate) const SAVE_EXAMPLES: &str = "\
A file holds a stored shape or an imprint. If a stored shape and a file have the
same name, taxel uses the shape, so you can copy a shape.

Examples:
  taxel library save ring imprint.txt
  taxel library save \"my washer\" washer
  printf '.##.\\n#..#\\n.##.\\n' | taxel library save ring - --force";

/// `taxel library delete`.
pub(crate) const DELETE_EXAMPLES: &str = "\
The last 50 deleted shapes are kept.

Examples:
  taxel library delete ring
  taxel library restore ring";

/// `taxel library restore`.
pub(crate) const RESTORE_EXAMPLES: &str = "\
If several shapes of that name were deleted, the last one is restored.

Examples:
  taxel library restore ring";

/// `taxel library path`.
pub(crate) const PATH_EXAMPLES: &str = "\
Examples:
  taxel library path
  ls \"$(taxel library path)\"";

/// `taxel library check`.
pub(crate) const CHECK_EXAMPLES: &str = r#"Reads every shape and lists broken ones, shapes whose file holds another name,
and other files in the folder. The exit status is 1 if a shape is broken, or if
--library names a folder that does not exist. --json prints an array on one
line, with an object for each finding:
  {"finding":"broken","name":"ring","reason":"..."}
  {"finding":"name","name":"Ring","reason":"..."}
  {"finding":"other file","path":"shapes/notes.txt","reason":"..."}

Examples:
  taxel library check
  taxel library check --json
  taxel library check --library ./shapes"#;
