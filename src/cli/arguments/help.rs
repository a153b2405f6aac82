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

/// `taxel figure`: the sensor to which the ranges of the flags apply.
pub(crate) const FIGURE_EXAMPLES: &str = "\
The ranges are for a sensor of 16 x 16; for another sensor, replace 16 with its
larger side. A flag that you leave out has its default.

Examples:
  taxel figure ellipse --x0 1.99 --y0 1.47 --thickness 2
  taxel figure rectangle --length 6 --width 3 --angle 30 --pitch 2.5
  taxel figure triangle --side 5 --x0 -0.8 --columns 32 --rows 8 --json
  taxel figure hexagon --side 6 --thickness 2.5 --save \"my nut\"
  taxel figure ellipse --angle 30 --radius-x 6 --export oval.svg";

/// `taxel picture`: where a picture comes from, and which sensor touches it.
pub(crate) const PICTURE_EXAMPLES: &str = "\
If a stored shape and a file have the same name, taxel uses the shape. A file
holds a stored shape or an imprint. A stored shape keeps its sensor; an imprint
gets a sensor of 16 x 16, or of its own size if that is larger. Without flags,
the picture stays as it is.

Examples:
  taxel picture washer --x0 6 --y0 4.5
  taxel picture key --angle 30 --zoom-x 0.8 --zoom-y 0.8 --json
  taxel picture imprint.txt --x0 2 --save \"moved imprint\"";

/// `taxel describe`: the formats that can be read.
pub(crate) const DESCRIBE_EXAMPLES: &str = "\
An imprint is text with one line per row, '#' for an active taxel and '.' for an
inactive one; or a table of numbers (CSV), a bitmap (PBM) or a numpy array
(NPY). In a table or an array, inactive taxels are 0, and active ones 1 or 255.
An imprint has at most 64 x 64 taxels. taxel recognises the format from the
content, not from the extension. A stored shape is a JSON file. If a stored
shape and a file have the same name, taxel uses the shape.

Examples:
  taxel describe washer
  taxel describe imprint.txt --pitch 2.5
  taxel describe ./washer.json --json
  printf '.##.\\n#..#\\n.##.\\n' | taxel describe -";

/// `taxel export`: the formats that can be written.
pub(crate) const EXPORT_EXAMPLES: &str = "\
The extension of TO decides the format:
  .txt  rows of '#' and '.'         .svg  a drawing: matrix, outline (if known),
  .pbm  a bitmap, P4                      rectangle, CG, CD, axes, legend
  .csv  a table of 0 and 1
  .npy  a numpy array of bool
Drawings are grey; with a pitch they are in mm. An existing file is replaced
only with --force. To export a figure, use 'taxel figure ... --export'.

Examples:
  taxel export washer washer.svg --pitch 2.5
  taxel export imprint.txt imprint.npy --force
  taxel export key - --format pbm-plain
  taxel figure hexagon --angle 17 --export hexagon.svg";

/// `taxel batch`: the format of a line, and what happens if one is wrong.
pub(crate) const BATCH_EXAMPLES: &str = r###"Each line is a JSON object:
  {"figure":"hexagon","side":3,"x0":2.1,"y0":1.35,"angle":17,"thickness":1}
  {"picture":["##","#."],"x0":5,"y0":3,"angle":10,"zoom_x":1.5,"zoom_y":1}
  {"picture":"washer","x0":2,"y0":2,"angle":0,"zoom_x":1,"zoom_y":1}
  {"imprint":[".##.","#..#",".##."]}
  {"frame":[[0,3,8],[1,9,12]],"at_least":5}
Sizes, position, angle and zooms have no defaults here, unlike the flags of
other commands; a figure without "thickness" is solid. Give a picture by its
rows or by its name in the library. A figure or picture may have its own sensor:
  "sensor":{"columns":32,"rows":32,"threshold":0.5}
A frame holds the values of a sensor, row by row. Its threshold is
"at_least":VALUE, "percent":P or "low":VALUE,"high":VALUE; "least":TAXELS drops
pieces of fewer taxels.

Each answer is one line, in the order of the input. If a line is wrong or longer
than 1 MiB, its answer is {"error":"line 3: ..."}, the other lines are still
answered, and the exit status is 1. Blank lines are skipped. Whenever the input
pauses, all answers so far are written.

Examples:
  taxel batch poses.jsonl > answers.jsonl
  echo '{"imprint":["##","#."]}' | taxel batch"###;

/// `taxel sweep`: ranges and their defaults.
pub(crate) const SWEEP_EXAMPLES: &str = "\
A range is START:END:STEP with the end included, or one number; decimals are
exact. By default, x0 and y0 run over one cell in steps of 0.01, at every whole
degree: 3.6 million poses. The cell of a figure starts at x0 = y0 = 5; that of a
picture is the cell that it lies in. If the sensor would cut off the shape there
at some angle, taxel takes the cell nearest to the middle of the sensor in which
nothing is cut off. The summary states the ranges. Figures are solid without
--thickness. A picture keeps its own sensor, unless flags change it.

Examples:
  taxel sweep rectangle --length 6 --width 3
  taxel sweep ellipse --radius-x 4 --radius-y 4 --thickness 2 --angle 0 --json
  taxel sweep --picture key --columns 32 --rows 32 --x0 11:11.9:0.1 \\
    --y0 11:11.9:0.1 --zoom-x 0.8:1.2:0.1 --atlas key.csv
  taxel sweep hexagon --side 12 --columns 64 --rows 64 --x0 20:20.99:0.01 \\
    --shard 3/40 --atlas hexagon-3.npz --quiet";

/// `taxel merge`.
pub(crate) const MERGE_EXAMPLES: &str = "\
All shards together give the same atlas as one sweep of the whole grid, or the
same model as one training. Each file says whether it is an atlas or a model.

Examples:
  taxel merge hexagon-*.npz --out hexagon.npz
  taxel merge a.npz b.npz --out both.csv --json
  taxel merge part-*.npz --out parts.npz";

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

/// `taxel frames`: the formats of recordings, the order of processing, and what happens to a damaged one.
pub(crate) const FRAMES_EXAMPLES: &str = "\
A recording is a file from Tekscan or XSENSOR, or is MCAP, NPY, NPZ, JSON lines,
the output of 'ros2 topic echo' or a table of numbers.
taxel recognises the format from the content. Without a flag under Frames, it
lists the channels. Frames are cropped, flipped, turned, masked, tared and
multiplied by the gain, in this order; then the threshold makes the imprint.
Values are in the recording's own unit.

If a recording is damaged, taxel processes the complete frames before the
damage and reports where the damage is; the exit status is 1.

Examples:
  taxel frames recording.csv
  taxel frames recording.csv --peak --at-least 10
  taxel frames recording.csv --all --percent 25 --tare 2 --json
  taxel frames recording.csv --csv --tare 2 > force.csv
  taxel frames recording.csv --frame 3 --low 5 --high 20 --heat --ascii
  taxel frames recording.csv --peak --at-least 10 --heat --export touch.svg
  taxel frames recording.csv --peak --at-least 10 --model parts --noise 0.01
  taxel frames recording.csv --noise-report --at-least 10 --export mask.txt
  taxel frames plain.csv --rows 4 --columns 5 --label-column 21 \\
    --time-column 22:ms --crop 1,0,3x3 --json";

/// `taxel watch`: what is answered, what a stream may be, and what is recorded.
pub(crate) const WATCH_EXAMPLES: &str = "\
On a terminal, a page shows the frames; it stays open when the source has ended,
even with --once. With --json, or in a pipeline, taxel prints a line for each
frame, like 'taxel frames --all --json'; without a threshold, the imprint in it
is null. A stream consists of lines of numbers, JSON lines, the output of
'ros2 topic echo', or the bytes of FlexiTac or MatSense; taxel recognises the
format from the content. A recording is played at its own rate. If a serial line
or connection is lost, taxel tries again every second, unless --once is given;
on a terminal, it also waits for one that does not exist yet. Torn, short, long
and garbled frames are dropped and counted.

--write records every frame, shown or not; numpy can open the file at any time.
A .json file of the same name describes the values. The source's own labels are
not recorded; the lines of --json have them.

Examples:
  taxel watch recording.csv --once --at-least 10
  taxel watch - --format lines --percent 50 --write touch.npy < rows.txt
  taxel watch touch.npy --speed 10 --at-least 9
  taxel watch recording.csv --once --percent 40 --model parts
  taxel watch touch.npy --once --at-least 9 | taxel recognise - --model parts";
