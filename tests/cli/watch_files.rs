//! `taxel watch` and the files around it: a source that is also the target, files that grow, missing channels, full
//! disks.

use std::fs;
use std::io::{BufRead, BufReader, Write};

use serde_json::Value;
use taxel_core::frame::Frame;
use taxel_files::acquire::FrameRecorder;
use taxel_files::formats::recording::{FrameMark, RecordingMetadata};
use taxel_files::storage::Existing;

use super::array;
use super::watch::{lines, sample, started, stream};
use super::{finish, program, sh, taxel};

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

/// Only frames make or replace a recording.
#[test]
fn a_recording_appears_with_its_first_frame() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("new.npy");
    let names = || fs::read_dir(folder.path()).expect("read").count();
    let write = format!("--once --force --write {}", file.display());
    for (line, input) in [
        ("watch /nothing/there", ""),
        ("watch - --model nosuch", "1 2\n3 4\n\n"),
        ("watch - --format lines --rows 2 --columns 2", "x y\n"),
        ("watch -", ""),
    ] {
        let said = failure(&format!("{line} {write}"), input);
        let expected = format!("no frame came, so {} was not written", file.display());
        // The error of a source that cannot be opened, or of a model, says enough.
        let is_opened = !line.contains("no");
        assert_eq!(
            said.contains(&expected),
            is_opened || line.contains("lines"),
            "{line}: {said}"
        );
        assert_eq!(names(), 0, "{line}");
    }
    let run = taxel(&format!("watch - {write}"), stream(0..3));
    assert_eq!((run.status, names()), (Some(0), 2), "{}", run.stderr);
    let both = || [file.clone(), file.with_extension("json")].map(|path| fs::read(path).ok());
    let before = both();
    failure(&format!("watch - {write}"), "");
    assert_eq!(both(), before);
    let run = taxel(&format!("watch - {write}"), stream(0..9));
    assert_eq!(
        (run.status, names()),
        (Some(0), 2),
        "nothing is left behind"
    );
    assert_ne!(both(), before);
}

/// A file in the format of a recording is also followed, as soon as it grows.
#[test]
fn a_growing_file_is_followed_until_it_is_truncated() {
    for flags in [&["--format", "lines"][..], &[]] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("g.txt");
        let path = file.to_str().expect("UTF-8");
        fs::write(&file, stream(10..15)).expect("written");
        let mut child = started(&[&["watch", path][..], flags].concat());
        let mut output = BufReader::new(child.stdout.take().expect("piped"));
        let mut numbers = |expected: std::ops::Range<u32>| {
            for number in expected {
                let mut answer = String::new();
                output.read_line(&mut answer).expect("it answers");
                let answer = &lines(&answer)[0];
                assert_eq!(answer["sum"], 9 + number);
                assert_eq!(answer["frame"], number - 10);
            }
        };
        numbers(10..15);
        let mut grown = fs::File::options().append(true).open(&file);
        let grown = grown.as_mut().expect("opened");
        grown.write_all(b"15 2\n3 4\n\n99").expect("written");
        numbers(15..16);
        fs::write(&file, stream(31..33)).expect("written");
        let ended = finish(child, b"");
        assert_eq!(ended.status, Some(1));
        let said = "cannot read: it was truncated meanwhile";
        assert!(ended.stderr.contains(said), "{}", ended.stderr);
    }
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
    let told = failure(&all_of, "");
    assert!(
        told.contains("choose one with --channel: left, right"),
        "{told}"
    );
}

#[test]
fn channels_after_the_first_are_left_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("two.jsonl");
    let channels = ["left", "right", "left", "left", "top", "right"];
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
        assert_eq!(sums.collect::<Vec<_>>(), [1, 3, 4], "{source}");
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
        child.kill().expect("it is killed");
        child.wait().expect("a child");
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
