//! `taxel watch` and the files around it: a source that is also the target, files that are truncated or replaced while
//! they grow, missing channels, full disks.

use std::fs;
use std::io::{BufRead, BufReader, Write};

use serde_json::Value;
use taxel_core::frame::Frame;
use taxel_files::acquire::FrameRecorder;
use taxel_files::formats::recording::{FrameMark, RecordingMetadata};
use taxel_files::storage::Existing;

use super::array::{self, array};
use super::watch::{lines, sample, started, stream};
use super::{finish, program, run_in, sh, taxel};

/// Runs a command that must fail, and returns its message.
fn failure(line: &str, input: impl AsRef<[u8]>) -> String {
    let run = taxel(line, input);
    assert_eq!(run.status, Some(1), "{line}: {}", run.stderr);
    run.stderr
}

#[test]
fn a_source_is_never_its_own_target() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (own, other, json) = (path("s.npy"), path("other.npy"), path("p.json"));
    fs::copy(sample("records.npy"), &own).expect("copied");
    fs::hard_link(&own, &other).expect("linked");
    fs::copy(sample("tekscan.asf"), &json).expect("copied");
    let before = fs::read(&own).expect("read");
    for line in [
        format!("watch {own} --once --write {own} --force"),
        format!("watch {own} --once --write {other} --force"),
        format!("watch {own} --once --write {own}"),
        format!("watch {json} --once --write {} --force", path("p.npy")),
    ] {
        let said = failure(&line, "");
        assert!(said.contains("record to another file"), "{line}: {said}");
    }
    let input = fs::File::open(&own).expect("opened");
    let mut child = program(&["watch", "-", "--write", &own, "--force"], "C.UTF-8");
    let child = child.stdin(input).spawn().expect("it starts");
    let run = child.wait_with_output().expect("it ends");
    assert_eq!(run.status.code(), Some(1), "{run:?}");
    assert_eq!(fs::read(&own).expect("read"), before);
    assert_eq!(
        fs::read(&json).expect("read"),
        fs::read(sample("tekscan.asf")).expect("read")
    );
    assert!(!folder.path().join("s.json").exists());
}

/// Neither an error nor a silent source leaves a recording without frames.
#[test]
fn a_recording_appears_with_its_first_frame() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("new.npy");
    let names = || fs::read_dir(folder.path()).expect("read").count();
    let write = format!("--once --write {}", file.display());
    for (line, input) in [
        ("watch /nothing/there", ""),
        ("watch - --format lines --rows 2 --columns 2", "x y\n"),
        ("watch -", ""),
    ] {
        let said = failure(&format!("{line} {write}"), input);
        let expected = format!("no frame came, so {} was not written", file.display());
        // The error of a source that cannot be opened says enough.
        let is_missing = line.contains("nothing");
        assert_eq!(said.contains(&expected), !is_missing, "{line}: {said}");
        assert_eq!(names(), 0, "{line}");
    }
    let run = taxel(&format!("watch - {write}"), stream(0..3));
    assert_eq!((run.status, names()), (Some(0), 2), "{}", run.stderr);
}

#[test]
fn the_second_recording_to_one_file_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("both.npy");
    let begun = || FrameRecorder::create(&file, Existing::Kept, &RecordingMetadata::default());
    let (mut first, mut late) = (begun().expect("free"), begun().expect("still free"));
    let frame = Frame::default();
    first.add(&frame, None).expect("recorded");
    assert_eq!(first.finish().expect("written"), 1);
    let both = || [file.clone(), file.with_extension("json")].map(|path| fs::read(path).ok());
    let before = both();
    let error = late.add(&frame, None).expect_err("the file is there");
    assert!(error.to_string().contains("already exists"), "{error}");
    assert_eq!(late.finish().expect("nothing was recorded"), 0);
    assert_eq!(both(), before);
}

/// Only frames replace a recording.
#[test]
fn an_old_recording_is_kept_until_the_first_frame() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("touch.npy");
    let write = format!("--once --write {} --force", file.display());
    let run = taxel(&format!("watch - {write}"), stream(0..9));
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    let both = || {
        let read = |path| fs::read(path).expect("it is there");
        (read(file.clone()), read(file.with_extension("json")))
    };
    let before = both();
    for (line, input) in [
        ("watch /nothing/there", ""),
        ("watch - --model nosuch", "1 2\n3 4\n\n"),
        ("watch - --format lines --rows 2 --columns 2", "x y\n"),
        ("watch -", ""),
    ] {
        failure(&format!("{line} {write}"), input);
        assert_eq!(both(), before, "{line}");
    }
    let run = taxel(&format!("watch - {write}"), stream(0..3));
    assert_eq!(run.status, Some(0), "{}", run.stderr);
    assert_ne!(both(), before);
    let names = fs::read_dir(folder.path()).expect("read").count();
    assert_eq!(names, 2, "nothing is left behind");
}

/// Each of these changes begins the file anew, after an incomplete end. A file in the format of a recording is also
/// followed as soon as it grows.
#[test]
fn a_growing_file_is_followed_after_it_was_truncated_or_replaced() {
    for flags in [&["--format", "lines"][..], &[]] {
        read_on(flags);
    }
}

fn read_on(flags: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("g.txt");
    let path = file.to_str().expect("UTF-8");
    fs::write(&file, stream(10..15)).expect("written");
    let mut child = started(&[&["watch", path][..], flags].concat());
    let mut output = BufReader::new(child.stdout.take().expect("piped"));
    let mut frame = 0;
    let mut numbers = |expected: std::ops::Range<u32>| {
        for number in expected {
            let mut answer = String::new();
            output.read_line(&mut answer).expect("it answers");
            let answer = &lines(&answer)[0];
            assert_eq!(answer["sum"], 9 + number);
            assert_eq!(answer["frame"], frame, "they are counted on");
            frame += 1;
        }
    };
    numbers(10..15);
    let mut grown = fs::File::options().append(true).open(&file);
    let grown = grown.as_mut().expect("opened");
    grown.write_all(b"20 2\n3 4\n\n99").expect("written");
    numbers(20..21);
    // The new contents are shorter.
    fs::write(&file, stream(31..33)).expect("written");
    numbers(31..33);
    // Another file with this name, at once, and after there was none.
    fs::rename(&file, folder.path().join("g.1")).expect("renamed");
    fs::write(&file, stream(51..59)).expect("written");
    numbers(51..59);
    fs::remove_file(&file).expect("removed");
    fs::write(&file, stream(61..69)).expect("written");
    numbers(61..69);
    child.kill().expect("it is killed");
    let said = finish(child, b"").stderr;
    let count = |what: &str| said.matches(what).count();
    assert_eq!(count("was truncated"), 1, "{said}");
    assert_eq!(count("was replaced"), 2, "{said}");
}

/// The name of a growing file, its header, its frame of a given sum, and wrong pieces.
type GrowingCase<'a> = (&'a str, &'a str, &'a dyn Fn(u32) -> String, &'a [&'a str]);

/// Each piece is appended to the file behind two frames of 2 × 2, and followed by whole frames.
#[test]
fn a_wrong_frame_in_a_growing_file_is_counted_and_the_watch_goes_on() {
    let json = |sum: u32| format!("{{\"frame\":[[{sum},0],[0,0]]}}\n");
    let rows = |sum: u32| format!("{sum} 0\n0 0\n\n");
    let table = |sum: u32| format!("0.{sum},{sum},0,0,0\n");
    let echo = |sum: u32| format!("data: [{sum}, 0, 0, 0]\n---\n");
    let header = "time,r0c0,r0c1,r1c0,r1c1\n";
    let cases: [GrowingCase<'_>; 4] = [
        (
            "g.jsonl",
            "",
            &json,
            &[
                "garbage\n",
                "{\"frame\":[[1,2\n",
                "\0\0\0\n",
                "{\"status\":\"ok\"}\n",
                "{\"frame\":[[1,2],[3,4],[5,6]]}\n",
            ],
        ),
        (
            "g.txt",
            "",
            &rows,
            &[
                "garbage 1\n3 4\n\n",
                "1 2\n\n",
                "1 2\n3\n\n",
                "1 2\n3 4\n5 6\n7 8\n\n",
            ],
        ),
        (
            "g.csv",
            header,
            &table,
            &["0.6,1,2\n", "0.6,1,2,3,x\n", "0.6,1,2,3,4,5\n"],
        ),
        (
            "g.yaml",
            "",
            &echo,
            &["data: [1, 2, 3]\n---\n", "data: [1, x]\n- 3\n---\n"],
        ),
    ];
    let folder = tempfile::tempdir().expect("a folder");
    std::thread::scope(|scope| {
        for (name, header, frame, pieces) in cases {
            let file = folder.path().join(name);
            fs::write(&file, header.to_owned() + &frame(1) + &frame(2)).expect("written");
            let texts: Vec<_> = (3..)
                .zip(pieces)
                .map(|(n, wrong)| (n, (*wrong).to_owned() + &frame(n)))
                .collect();
            scope.spawn(move || go_on_behind(&file, &texts));
        }
    });
}

/// Watches a growing file of frames of 2 × 2 with the sums 1 and 2, and appends texts, each with a wrong frame before
/// one of that sum.
fn go_on_behind(file: &std::path::Path, texts: &[(u32, String)]) {
    let path = file.to_str().expect("UTF-8");
    let mut child = started(&["watch", path, "--rows", "2", "--columns", "2"]);
    let mut output = BufReader::new(child.stdout.take().expect("piped"));
    let mut sum = || {
        let mut answer = String::new();
        output.read_line(&mut answer).expect("it answers");
        lines(&answer)[0]["sum"].clone()
    };
    assert_eq!([sum(), sum()], [1, 2].map(Value::from));
    let mut grown = fs::File::options().append(true).open(file).expect("opened");
    for (number, text) in texts {
        grown.write_all(text.as_bytes()).expect("written");
        assert_eq!(sum(), *number, "{text}");
    }
    // The last wrong frame is reported a second after the one before.
    let mut messages = BufReader::new(child.stderr.take().expect("piped"));
    let (mut said, wrong) = (String::new(), texts.len());
    while !said.contains(&format!("{wrong} frames dropped so far")) {
        let read = messages.read_line(&mut said).expect("UTF-8");
        assert!(read > 0, "it ended: {said}");
    }
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
    assert!(said.contains(" (line "), "{said}");
}

#[test]
fn an_incomplete_first_frame_is_waited_for() {
    let folder = tempfile::tempdir().expect("a folder");
    for (index, (flags, pieces)) in [
        ("", ["1 2\n3", " 4\n", "\n", "5 6\n7 8\n\n"]),
        (
            "",
            [
                "{\"frame\":[[1,2",
                "],[3,4]]",
                "}\n",
                "{\"frame\":[[5,6],[7,8]]}\n",
            ],
        ),
        ("", ["r0c0,r0c1", ",r1c0,r1c1\n1,2", ",3,4\n", "5,6,7,8\n"]),
        ("--rows 2 --columns 2", ["1", " 2 3", " 4\n", "5 6 7 8\n"]),
    ]
    .into_iter()
    .enumerate()
    {
        let file = folder.path().join(format!("{index}.txt"));
        fs::write(&file, pieces[0]).expect("written");
        let line = format!("watch {} --json {flags}", file.display());
        let mut child = started(&line.split_whitespace().collect::<Vec<_>>());
        for piece in &pieces[1..] {
            std::thread::sleep(std::time::Duration::from_millis(300));
            let mut grown = fs::File::options().append(true).open(&file);
            let grown = grown.as_mut().expect("opened");
            grown.write_all(piece.as_bytes()).expect("written");
        }
        let mut output = BufReader::new(child.stdout.take().expect("piped"));
        for sum in [10, 26] {
            let mut answer = String::new();
            output.read_line(&mut answer).expect("it answers");
            assert_eq!(lines(&answer)[0]["sum"], sum, "{line}");
        }
        child.kill().expect("it is killed");
        assert_eq!(finish(child, b"").stderr, "");
    }
}

/// Each frame of a board is shown when it is written, not when a block of many is full.
#[test]
fn the_bytes_of_a_board_are_followed_frame_by_frame() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("board.bin");
    let frame = |value: u8| [&[0xaa, 0x55][..], &[value; 4]].concat();
    let begun: Vec<u8> = (1..=12).flat_map(frame).collect();
    fs::write(&file, begun).expect("written");
    let line = format!("watch {} --rows 2 --columns 2", file.display());
    let mut child = started(&line.split_whitespace().collect::<Vec<_>>());
    let mut output = BufReader::new(child.stdout.take().expect("piped"));
    let mut sum = || {
        let mut answer = String::new();
        output.read_line(&mut answer).expect("it answers");
        lines(&answer)[0]["sum"].clone()
    };
    // A frame is complete when the next one begins.
    for value in 1..=11 {
        assert_eq!(sum(), 4 * value);
    }
    let grown = fs::File::options().append(true).open(&file);
    let appended = grown
        .expect("opened")
        .write_all(&[frame(13), frame(14)].concat());
    appended.expect("written");
    assert_eq!([sum(), sum()], [48, 52]);
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
}

#[test]
fn frames_of_another_size_do_not_end_a_recording() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("touch.npy");
    let name = file.to_str().expect("UTF-8");
    let frame = |columns: usize| format!("{{\"frame\":[{:?}]}}\n", vec![5; columns]);
    let stream: String = [2, 3, 2, 3, 3, 3, 3, 2, 2, 2].map(frame).concat();
    let run = taxel(&format!("watch - --format jsonl --write {name}"), stream);
    assert_eq!(run.status, Some(0), "{run:?}");
    let sums: Vec<Value> = lines(&run.stdout)
        .iter()
        .map(|line| line["sum"].clone())
        .collect();
    assert_eq!(sums, [10; 5]);
    assert!(run.stderr.contains("5 frames dropped so far"), "{run:?}");
    let listed = taxel(&format!("frames {name} --json"), "");
    assert_eq!(lines(&listed.stdout)[0]["channels"][0]["frames"], 5);
}

#[test]
fn a_file_that_no_longer_grows_ends_at_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("old.txt");
    for (text, expected) in [("1 2\n3 4\n\n", ""), ("1 2\n3", "line 2: found 1 value")] {
        fs::write(&file, text).expect("written");
        let earlier = std::time::SystemTime::now() - std::time::Duration::from_secs(60);
        let opened = fs::File::options().write(true).open(&file);
        opened.expect("opened").set_modified(earlier).expect("set");
        let line = format!("watch {} --json --rows 2 --columns 2", file.display());
        let run = taxel(&line, "");
        assert_eq!(run, taxel(&format!("{line} --once"), ""), "{text}");
        assert_eq!(run.status, Some(i32::from(!expected.is_empty())), "{run:?}");
        assert!(run.stderr.contains(expected), "{run:?}");
    }
}

#[test]
fn a_file_without_frames_that_no_longer_grows_ends_at_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("old.txt");
    let name = file.to_str().expect("UTF-8");
    for text in ["", "# comment\n", "words\n"] {
        fs::write(&file, text).expect("written");
        let earlier = std::time::SystemTime::now() - std::time::Duration::from_secs(60);
        let opened = fs::File::options().write(true).open(&file);
        opened.expect("opened").set_modified(earlier).expect("set");
        let run = taxel(&format!("watch {name}"), "");
        assert_eq!(run, taxel(&format!("watch {name} --once"), ""), "{text}");
        assert_eq!(run.status, Some(1), "{text}");
    }
    fs::write(&file, "").expect("written");
    super::refused(
        &taxel(&format!("watch {name}"), ""),
        1,
        &format!("{name}: empty, expected frames of a sensor"),
    );
}

#[test]
fn a_missing_channel_is_refused_in_a_recording_and_reported_in_a_stream() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("touch.npy");
    let one = "no channel named \"nope\": the recording has one channel, without a name; leave out --channel\n";
    let several = "no channel named \"nope\"; channels: ";
    for (name, expected) in [
        ("u2.npy", one),
        ("xsensor.csv", several),
        ("topics.mcap", several),
    ] {
        let path = sample(name);
        let listed = failure(
            &format!("frames {path} --channel nope --all --at-least 1"),
            "",
        );
        let line = format!("watch {path} --channel nope --write {}", file.display());
        let watched = failure(&line, "");
        assert!(watched.contains(expected), "{name}: {watched}");
        assert_eq!(listed, watched, "{name}");
        assert!(!file.exists());
    }
    let line = format!("watch --once {} --channel unnamed", sample("u2.npy"));
    assert!(!taxel(&line, "").stdout.is_empty());
    let run = taxel("watch - --channel nope", stream(0..3));
    assert_eq!((run.status, lines(&run.stdout).len()), (Some(0), 3));
    let said =
        "standard input: no channel named \"nope\": a stream has none, and all frames are taken\n";
    assert_eq!(run.stderr, said);
}

#[test]
fn the_channels_of_json_lines_are_chosen_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("two.jsonl");
    let path = file.to_str().expect("UTF-8");
    let line = |channel: &str, value: u32| {
        format!("{{\"channel\":\"{channel}\",\"frame\":[[{value},1]]}}\n")
    };
    let input: String = (0..6)
        .map(|n| line("left", n) + &line("right", 100 + n))
        .collect();
    fs::write(&file, &input).expect("written");
    let all_of = format!("frames {path} --all --at-least 9");
    for (command, input) in [
        ("watch -", input.as_str()),
        (&format!("watch {path} --once"), ""),
        (&all_of, ""),
    ] {
        let told = failure(command, input);
        assert!(
            told.contains("choose one with --channel: left, right"),
            "{command}: {told}"
        );
        let run = taxel(&format!("{command} --json --channel right"), input);
        let found = lines(&run.stdout);
        assert_eq!(
            (run.status, found.len()),
            (Some(0), 6),
            "{command}: {}",
            run.stderr
        );
        assert_eq!(
            (&found[5]["frame"], &found[5]["sum"]),
            (&5.into(), &106.into())
        );
        assert_eq!(found[5]["channel"], "right");
        let told = failure(&format!("{command} --channel up"), input);
        let expected = "no channel named \"up\"; channels: left, right";
        assert!(told.contains(expected), "{command}: {told}");
    }
}

#[test]
fn a_channel_that_appears_after_the_first_answers_is_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("two.jsonl");
    let channels = ["left", "left", "right", "left", "top", "right"];
    let lines_of = |(value, channel): (u32, &str)| {
        format!("{{\"channel\":\"{channel}\",\"frame\":[[{value},0]]}}\n")
    };
    let input: String = (1..).zip(channels).map(lines_of).collect();
    fs::write(&file, &input).expect("written");
    let path = file.to_str().expect("UTF-8");
    for (source, name, input) in [("-", "standard input", input.as_str()), (path, path, "")] {
        let target = folder.path().join(format!("{}.npy", input.len()));
        let command = format!("watch {source} --once --write {}", target.display());
        let run = taxel(&command, input);
        let sums = lines(&run.stdout)
            .into_iter()
            .map(|line| line["sum"].clone());
        assert_eq!(sums.collect::<Vec<_>>(), [1, 2, 4], "{source}");
        let said = ["right", "top"].map(|other| {
            format!("{name}: channel {other} is left out, since left came first; --channel {other} takes it\n")
        });
        assert_eq!((run.status, run.stderr), (Some(0), said.concat()));
        let recorded = fs::read(&target).expect("written");
        assert_eq!(array::records(&recorded), Some(3));
    }
}

#[test]
fn the_marks_of_a_recording_are_listed_by_the_numbers_of_its_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("touch-1.npy");
    let mut metadata = RecordingMetadata::default();
    let mark = |number| FrameMark { number, time: None };
    metadata.marks = [52, 59].map(mark).to_vec();
    let recorder = FrameRecorder::create(&path, Existing::Kept, &metadata);
    let mut recorder = recorder.expect("begun");
    for number in 50..60 {
        let mut frame = Frame::default();
        frame.number = number;
        recorder.add(&frame, None).expect("recorded");
    }
    recorder.finish().expect("finished");
    let command = format!("frames {}", path.display());
    let listed = taxel(&command, "").stdout;
    assert!(listed.contains("marks     2, 9\n"), "{listed}");
    let listed = taxel(&format!("{command} --json"), "").stdout;
    assert_eq!(
        lines(&listed)[0]["channels"][0]["marks"],
        serde_json::json!([2, 9])
    );
}

#[test]
fn only_frames_that_arrive_later_in_a_file_have_the_time_of_arrival() {
    let folder = tempfile::tempdir().expect("a folder");
    for flags in [&["--format", "lines"][..], &[]] {
        let file = folder.path().join("g.txt");
        fs::write(&file, stream(0..3)).expect("written");
        let target = folder.path().join(format!("touch-{}.npy", flags.len()));
        let arguments = ["watch", file.to_str().expect("UTF-8"), "--write"];
        let target = target.to_str().expect("UTF-8");
        let mut child = started(&[&arguments[..], &[target], flags].concat());
        let mut output = BufReader::new(child.stdout.take().expect("piped"));
        let mut time = || {
            let mut answer = String::new();
            output.read_line(&mut answer).expect("it answers");
            lines(&answer)[0]["time"].clone()
        };
        assert_eq!(
            [time(), time(), time()],
            [Value::Null, Value::Null, Value::Null]
        );
        let mut grown = fs::File::options()
            .append(true)
            .open(&file)
            .expect("opened");
        let mut last = -1.0;
        for number in 3..6 {
            // Waits until everything has been read.
            std::thread::sleep(std::time::Duration::from_millis(300));
            let added = grown.write_all(stream(number..number + 1).as_bytes());
            added.expect("written");
            let time = time().as_f64().expect("a time");
            assert!(
                time == 0.0 && number == 3 || time >= last + 0.2,
                "{time} after {last}"
            );
            last = time;
        }
        // All of a file that takes its place has arrived just now.
        fs::write(&file, stream(6..8)).expect("written");
        assert!(time().as_f64() >= Some(last));
        child.kill().expect("it is killed");
        let said = finish(child, b"").stderr;
        assert!(
            said.ends_with("reading it again from its start\n"),
            "{said}"
        );
    }
}

/// A limit of the system acts as a full disk: it cuts off the last record.
#[test]
fn a_recording_on_a_full_disk_ends_with_its_last_whole_record() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("touch.npy");
    let child = sh("trap '' XFSZ; ulimit -f 9; exec \"$0\" \"$@\"")
        .args(["watch", "-", "--format", "lines", "--write"])
        .arg(&file)
        .spawn()
        .expect("there is a shell");
    // More frames than are kept in memory.
    let run = finish(child, stream(0..6000).as_bytes());
    assert_eq!(run.status, Some(1), "{}", run.stderr);
    let reason = format!("{}: cannot record: File too large", file.display());
    // Until the disk is full, frames that come too fast are recorded without an answer.
    let said = run.stderr.lines();
    let said: Vec<&str> = said
        .filter(|line| !line.ends_with("recorded but not printed"))
        .collect();
    let goes_on = format!("standard input: {reason}; the answers go on");
    assert_eq!(said, [goes_on, format!("error: {reason}")]);
    let last = lines(&run.stdout).pop().expect("answers");
    assert_eq!(last["frame"], 5999, "{last}");
    let bytes = fs::read(&file).expect("it is there");
    let records = (bytes.len() - 256) / 48;
    // The limit is nine blocks, each of 512 bytes or more.
    assert!(records >= (9 * 512 - 256) / 48, "{records}");
    assert_eq!(bytes.len(), 256 + 48 * records);
    assert_eq!(array::records(&bytes), Some(records));
    let beside = fs::read(file.with_extension("json")).expect("it is there");
    let beside: Value = serde_json::from_slice(&beside).expect("JSON");
    assert_eq!(beside["ended"], true);
    let reason = beside["ended_by"].as_str().expect("a reason");
    assert!(reason.contains("File too large"), "{reason}");
    let line = format!("frames {} --all --at-least 1 --json", file.display());
    let again = taxel(&line, "");
    for (number, frame) in lines(&again.stdout).iter().enumerate() {
        assert_eq!(frame["sum"], 9 + number, "{frame}");
    }
    assert_eq!(lines(&again.stdout).len(), records);
    assert!(
        again
            .stderr
            .contains("the recording ended early: File too large")
            && !again.stderr.contains("killed"),
        "{}",
        again.stderr
    );
}

/// Returns the metadata beside a recording, as JSON.
fn beside(file: &std::path::Path) -> Value {
    let beside = fs::read(file.with_extension("json")).expect("it is there");
    serde_json::from_slice(&beside).expect("JSON")
}

#[test]
fn a_recording_continues_after_the_reader_of_the_answers_is_gone() {
    let folder = tempfile::tempdir().expect("a folder");
    let source = folder.path().join("s.txt");
    fs::write(&source, stream(0..2000)).expect("written");
    for from in ["-", &format!("{} --once", source.display())] {
        let file = folder.path().join("touch.npy");
        let line = format!(
            "watch {from} --format lines --force --write {}",
            file.display()
        );
        let (reader, writer) = std::io::pipe().expect("a pipe");
        drop(reader);
        let mut command = program(&line.split(' ').collect::<Vec<_>>(), "C.UTF-8");
        let mut child = command.stdout(writer).spawn().expect("it starts");
        let mut input = child.stdin.take().expect("piped");
        if from == "-" {
            for frames in [0..1000, 1000..2000] {
                let sent = input.write_all(stream(frames).as_bytes());
                sent.expect("it reads");
                std::thread::sleep(std::time::Duration::from_millis(300));
            }
        }
        drop(input);
        let run = child.wait_with_output().expect("it ends");
        let stderr = String::from_utf8_lossy(&run.stderr);
        assert_eq!(run.status.code(), Some(0), "{from}: {stderr}");
        let expected = "standard output is closed; the recording continues\n";
        assert!(stderr.ends_with(expected), "{from}: {stderr}");
        let bytes = fs::read(&file).expect("it is there");
        assert_eq!(array::records(&bytes), Some(2000), "{from}");
        assert_eq!(beside(&file).get("ended_by"), None, "{from}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_recording_continues_if_the_answers_cannot_be_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("touch.npy");
    let name = file.to_str().expect("UTF-8");
    let full = fs::File::options().write(true).open("/dev/full");
    let mut command = program(&["watch", "-", "--write", name], "C.UTF-8");
    let command = command.stdout(full.expect("there is one"));
    let mut child = command.spawn().expect("it starts");
    let input = child.stdin.as_mut().expect("piped");
    input.write_all(stream(0..3).as_bytes()).expect("read");
    // Waits until an answer was written in vain.
    std::thread::sleep(std::time::Duration::from_millis(500));
    let run = finish(child, stream(3..6).as_bytes());
    let reason = "cannot write to standard output: No space left on device";
    let said = format!("standard input: {reason}; the recording continues\nerror: {reason}\n");
    assert_eq!((run.status, run.stderr), (Some(1), said));
    let recorded = fs::read(&file).expect("written");
    assert_eq!(array::records(&recorded), Some(6));
    assert_eq!(beside(&file).get("ended_by"), None);
}

#[test]
fn a_recording_that_an_error_ends_says_which() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("touch.npy");
    let name = file.to_str().expect("UTF-8");
    let bad = folder.path().join("bad.csv");
    fs::write(&bad, "r0c0,r0c1\n1,2\n3,x\n").expect("written");
    let said = failure(
        &format!("watch {} --once --write {name}", bad.display()),
        "",
    );
    let reason = beside(&file)["ended_by"].clone();
    assert_eq!(said, format!("error: {}\n", reason.as_str().expect("text")));
}

#[test]
fn dots_in_place_of_values_mean_omitted_values_and_nothing_else_does() {
    let line = "watch - --once --format ros2 --rows 1 --columns 2";
    let noise =
        "a...b\n[0, 1]\n---\nname: '...'\n[2, 3]\n---\n[0 x ...]\n---\n[...]\n---\n[4, 5]\n---\n";
    let run = taxel(line, noise);
    assert_eq!(
        (run.status, lines(&run.stdout).len()),
        (Some(0), 3),
        "{}",
        run.stderr
    );
    assert!(run.stderr.contains("2 frames dropped"), "{}", run.stderr);
    for cut in [
        "data:\n- 0\n- 1\n- '...'\n---\n",
        "array('H', [0, 1, '...'])\n---\n",
        "[0, 1, ...]\n---\n",
    ] {
        let said = failure(line, cut);
        assert!(
            said.contains("run ros2 topic echo with --full-length"),
            "{cut}: {said}"
        );
    }
}

#[test]
fn the_message_says_why_lines_of_json_are_not_frames() {
    let line = "watch - --once --at-least 9";
    let text = "{\"t\":0.1,\"frame\":[[0,30],[40,50]],\"label\":1.5}\n";
    for (input, reason) in [
        (
            text.repeat(3),
            "line 3, column 46: \"label\" and \"channel\" are whole numbers or texts",
        ),
        (
            format!("{text}{{\"frame\":[[1,2],[3]]}}\n"),
            "row 2 has 1 value, expected 2",
        ),
    ] {
        let said = failure(line, &input);
        let expected = "bytes but no frame; the last one dropped: ";
        assert!(said.contains(expected) && said.contains(reason), "{said}");
        assert!(!said.contains("--rows"), "{said}");
    }
}

#[test]
fn noise_and_greetings_before_the_first_frame_do_not_affect_the_format() {
    let frames: String = (1..5).map(|n| format!("1 2\r\n3 {n}\r\n\r\n")).collect();
    for greeting in [
        &b"\xf8\x80 3\r\n"[..],
        b"\x82l\xeel\x8c rl\r\nready\r\n\r\n",
        "Gr\u{f6}\u{df}e 2\u{d7}2\r\n\r\n".as_bytes(),
    ] {
        let input = [greeting, frames.as_bytes()].concat();
        for shape in ["", "--rows 2 --columns 2"] {
            let run = taxel(&format!("watch - --once --at-least 4 {shape}"), &input);
            assert_eq!(run.status, Some(0), "{}", run.stderr);
            let sums = lines(&run.stdout);
            let last = sums.last().expect("a frame");
            assert_eq!((sums.len() >= 3, &last["sum"]), (true, &10.into()));
        }
    }
    for input in [&b"\xff\xfe\xfd\xfc"[..], b"hello\nworld\n"] {
        let said = failure("watch - --once", input);
        assert!(said.contains("--format"), "{said}");
    }
}

#[test]
fn the_message_says_why_lines_of_numbers_are_not_frames() {
    let timed = "50,1,2,3,1\n100,1,2,3,2\n150,1,2,3,3\n";
    let said = failure("watch - --once --rows 2 --columns 2", timed);
    let expected = "35 bytes but no frame; the last one dropped: line 3: 5 numbers a line, expected 4 (or 2 for a row): which is the time?";
    assert!(said.contains(expected), "{said}");
    for (line, text) in [
        ("watch - --once", "1,2\r3,4\r\r5,6\r7,8\r"),
        ("watch - --once --rows 2 --columns 2", "1,2,3,4\r5,6,7,8\r"),
    ] {
        let said = failure(line, text);
        let expected = "text whose lines end in CR alone (save it with LF or CR LF)";
        assert!(said.contains(expected), "{said}");
    }
    let wide = ("1 ".repeat(600) + "\n").repeat(2) + "\n";
    let expected = "600 numbers a line, but the rows and columns of a frame are not stated: --rows 24 --columns 25 for a frame a line";
    let said = failure("watch - --once", wide.repeat(3));
    assert!(said.contains(expected), "{said}");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("wide.txt");
    fs::write(&file, wide.repeat(3)).expect("written");
    let said = failure(&format!("frames {}", file.display()), "");
    assert!(said.contains(expected), "{said}");
}

#[test]
fn bad_values_and_a_torn_recording_are_reported() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let one = |value: f64| array("(1, 1, 1)", false, &[value]);
    let large = "is too large, expected at most 1e300";
    for (name, content, expected) in [
        ("large.npy", one(1e308), large),
        ("large.jsonl", b"{\"frame\":[[1e308]]}\n".to_vec(), large),
        (
            "large.csv",
            b"time,r0c0,r0c1\n0.0,1,1e308\n".to_vec(),
            large,
        ),
        (
            "infinite.npy",
            one(f64::INFINITY),
            "infinite, expected a number",
        ),
    ] {
        fs::write(path(name), content).expect("written");
        let said = failure(&format!("frames {} --at-least 1 --all", path(name)), "");
        assert!(said.contains(expected), "{name}: {said}");
    }
    let whole = fs::read(sample("topics.mcap")).expect("read");
    fs::write(path("torn.mcap"), &whole[..whole.len() / 2]).expect("written");
    let run = taxel(&format!("frames {} --json", path("torn.mcap")), "");
    let listed: Value = serde_json::from_str(&run.stdout).expect(&run.stdout);
    assert_eq!((run.status, &listed["format"]), (Some(1), &"mcap".into()));
}

#[test]
fn a_tare_that_does_not_fit_is_reported_as_not_used() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("touch.npy");
    let file = file.to_str().expect("UTF-8");
    let crop = "--at-least 5 --crop 1,1,3x2";
    let record = format!(
        "watch --once {} {crop} --tare 2 --write {file}",
        sample("tekscan.asf")
    );
    let recorded = lines(&taxel(&record, "").stdout);
    for command in ["frames --all --json", "watch --once"] {
        let run = taxel(&format!("{command} {file} --at-least 5"), "");
        let expected = "the recording's tare of 3 × 2 cells is not used";
        assert!(run.stderr.contains(expected), "{}", run.stderr);
        let again = taxel(&format!("{command} {file} {crop}"), "");
        assert_eq!((again.status, again.stderr.as_str()), (Some(0), ""));
        let imprints = |lines: &[Value]| -> Vec<Value> {
            lines.iter().map(|line| line["imprint"].clone()).collect()
        };
        assert_eq!(imprints(&lines(&again.stdout)), imprints(&recorded));
    }
}

/// On Linux a file name is any bytes, not always UTF-8.
#[cfg(target_os = "linux")]
#[test]
fn a_recording_may_have_any_file_name() {
    use std::ffi::{OsStr, OsString};
    use std::os::unix::ffi::OsStrExt;

    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(OsStr::from_bytes(b"a\xffb.NPY"));
    let (source, target) = (sample("tekscan.asf"), path.as_os_str().to_owned());
    let line = format!("watch {source} --once --at-least 5 --write");
    let mut arguments: Vec<OsString> = line.split(' ').map(OsString::from).collect();
    arguments.push(target);
    let run = run_in("C.UTF-8", &arguments, b"");
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""));
    assert!(path.is_file());
    *arguments.last_mut().expect("a name") = "a.csv".into();
    let run = run_in("C.UTF-8", &arguments, b"");
    assert_eq!(run.status, Some(2));
    let said = "expected a name that ends in .npy";
    assert!(run.stderr.contains(said), "{}", run.stderr);
}

#[test]
fn a_channel_whose_rows_and_columns_are_unknown_is_refused() {
    let topics = sample("topics.mcap");
    let all = failure(&format!("watch --once {topics}"), "");
    let names = "--channel: /pad, /state#pad, /state#tip, /image";
    assert!(all.contains(names), "{all}");
    let tip = "--channel /state#tip --at-least 1";
    let said = failure(&format!("watch --once {topics} {tip}"), "");
    assert!(
        said.contains("3 values a frame, but its rows and columns are not stated"),
        "{said}"
    );
    assert_eq!(said, failure(&format!("frames {topics} --all {tip}"), ""));
    let run = taxel(
        &format!("watch --once {topics} {tip} --rows 1 --columns 3"),
        "",
    );
    assert_eq!((run.status, run.stdout.lines().count()), (Some(0), 3));
}

#[test]
fn a_recording_without_frames_is_refused_also_with_loop() {
    let folder = tempfile::tempdir().expect("a folder");
    let empty = folder.path().join("empty.npy");
    fs::write(&empty, array("(0, 4, 4)", false, &[])).expect("written");
    let name = empty.to_str().expect("UTF-8");
    for more in ["--once", "--loop"] {
        let run = taxel(&format!("watch {name} {more} --json --at-least 1"), "");
        super::refused(
            &run,
            1,
            &format!("{name}: an empty array of shape (0, 4, 4), expected frames"),
        );
    }
    let growing = folder.path().join("growing.txt");
    fs::write(&growing, "5\n6\n").expect("written");
    for stream in ["- --format lines", &growing.to_string_lossy()] {
        for flag in ["loop", "speed"] {
            let value = if flag == "speed" { " 3" } else { "" };
            let run = taxel(&format!("watch {stream} --{flag}{value}"), "");
            let expected = format!("--{flag} has no effect on a stream: it is for recordings");
            super::refused(&run, 2, &expected);
        }
    }
    // An error in the source is reported before the missing frames for the tare.
    let bad = folder.path().join("bad.csv");
    fs::write(&bad, "r0c0,r0c1\n1,2\n3,x\n").expect("written");
    let run = taxel(&format!("watch {} --tare 3 --once", bad.display()), "");
    let expected = format!(
        "{}: line 3, column 2: found \"x\", expected a number; if it is the label: --label-column 2",
        bad.display()
    );
    super::refused(&run, 1, &expected);
    let run = taxel("watch nowhere.npy --tare 3 --once", "");
    assert!(!run.stderr.contains("tare"), "{}", run.stderr);
    // An endless device that cannot be set up as a serial line.
    for device in ["/dev/urandom", "/dev/zero"] {
        let said = failure(&format!("watch {device}"), "");
        let line = "it is not a serial line; 'taxel watch -' reads it";
        assert!(said.contains(line), "{said}");
    }
    for command in [
        "watch ''",
        "describe ''",
        "recognise ''",
        "recognise a --model ''",
    ] {
        let mut words: Vec<&str> = command.split(' ').collect();
        let empty = words.iter_mut().find(|word| **word == "''");
        *empty.expect("there") = "";
        let run = run_in("C.UTF-8", &words, b"");
        assert_eq!(run.status, Some(2), "{run:?}");
        assert!(run.stderr.contains("expected a name or a path"), "{run:?}");
    }
}
