//! Tests of `taxel watch`: live frames from pipes, pseudo-terminals and recordings, and their recording.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::process::{Child, Command};
use std::time::Duration;

use serde_json::Value;

use super::skip::lacking;
use super::{misused, program, python_has, sh, taxel, until, wait};

pub(super) fn sample(name: &str) -> String {
    format!(
        "{}/tests/files/frames/samples/{name}",
        env!("CARGO_MANIFEST_DIR")
    )
}

pub(super) fn lines(text: &str) -> Vec<Value> {
    let lines = text.lines();
    lines
        .map(|line| serde_json::from_str(line).expect(line))
        .collect()
}

/// Returns frames of 2 × 2 as lines; the first values are these numbers.
pub(super) fn stream(frames: std::ops::Range<u32>) -> String {
    frames
        .map(|number| format!("{number} 2\n3 4\n\n"))
        .collect()
}

#[test]
fn watch_and_frames_answer_a_recording_alike() {
    for (name, shape) in [
        ("tekscan.asf", ""),
        ("named.csv", ""),
        ("flexitac.bin", "--rows 4 --columns 5"),
    ] {
        let flags = format!("{} --at-least 9 --tare 2 {shape}", sample(name));
        let watched = taxel(&format!("watch --once {flags}"), "");
        let listed = taxel(&format!("frames --all --json {flags}"), "");
        assert_eq!(watched, listed, "{name}");
        assert_eq!(lines(&watched.stdout).len(), 3, "{name}");
    }
    // A recording without a threshold has frames, but no imprints.
    let run = taxel(&format!("watch --once {}", sample("u2.npy")), "");
    assert_eq!(lines(&run.stdout)[0]["imprint"], Value::Null);
    // At ten thousand times its speed.
    let run = taxel(&format!("watch --speed 10000 {}", sample("named.csv")), "");
    assert_eq!(lines(&run.stdout).len(), 3);
}

#[test]
fn a_stream_is_a_filter_in_a_pipeline() {
    let run = taxel(
        "watch - --percent 75",
        stream(0..3) + "1 x\n\n" + &stream(3..5),
    );
    let found = lines(&run.stdout);
    assert_eq!((run.status, found.len()), (Some(0), 5));
    assert_eq!(found[0]["imprint"], serde_json::json!(["..", "##"]));
    assert!(found[4]["time"].as_f64().is_some_and(|time| time >= 0.0));
    assert_eq!(
        run.stderr,
        "warning: standard input: 1 frame dropped so far (torn, short, long or garbled), the last: 1 x (line 10, column 2: found \"x\", expected a number; if it is the label: --label-column 2)\n"
    );
    let run = taxel("watch - --once", [0xff; 100]);
    assert_eq!(run.status, Some(1));
    assert!(
        run.stderr.contains("--rows and --columns"),
        "{}",
        run.stderr
    );
    let run = taxel("watch - --once --tare 3", stream(0..2));
    assert_eq!((run.status, run.stdout.as_str()), (Some(1), ""));
    assert!(
        run.stderr
            .ends_with("the tare needs 3 frames, but there are only 2\n"),
        "{}",
        run.stderr
    );
    let run = taxel("watch - --at-least 3", "");
    assert_eq!(
        (run.status, run.stderr.as_str()),
        (
            Some(1),
            "error: standard input: empty, expected frames of a sensor\n"
        )
    );
    // A recording is not a stream.
    let bytes = fs::read(sample("u2.npy")).expect("a sample");
    let run = taxel("watch - --once", bytes);
    let message = "standard input: a recording (npy), not a stream; save it to a file, then type taxel frames FILE";
    super::refused(&run, 1, message);
    misused("watch - --once --speed 2", "the argument '--once'");
    for (flag, why) in [
        ("baud 9600", "standard input: it is for serial lines"),
        ("loop", "a stream: it is for recordings"),
    ] {
        let name = flag.split(' ').next().expect("a name");
        let run = taxel(&format!("watch - --format lines --{flag}"), stream(0..3));
        super::refused(&run, 2, &format!("--{name} has no effect on {why}"));
    }
    misused("watch - --write touch.txt", "invalid value 'touch.txt'");
}

/// Returns what numpy reads from a file, which it must be able to load.
fn numpy(path: &Path) -> String {
    let script = "import sys, numpy; a = numpy.load(sys.argv[1]); print(len(a), a.dtype.names, a['values'].sum())";
    let run = Command::new("python3")
        .args(["-c", script])
        .arg(path)
        .output()
        .expect("Python runs");
    assert!(run.status.success(), "{}: {run:?}", path.display());
    String::from_utf8_lossy(&run.stdout).into_owned()
}

#[test]
fn a_recording_of_a_stream_is_read_by_taxel_and_numpy() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("touch.npy");
    let line = format!("watch - --once --at-least 3 --write {}", file.display());
    let run = taxel(&line, stream(0..50));
    assert_eq!((run.status, lines(&run.stdout).len()), (Some(0), 50));
    let again = taxel(
        &format!("frames {} --all --at-least 3 --json", file.display()),
        "",
    );
    let (first, again) = (lines(&run.stdout), lines(&again.stdout));
    assert_eq!(again.len(), 50);
    for (first, again) in first.iter().zip(&again) {
        assert_eq!(
            (&first["sum"], &first["imprint"]),
            (&again["sum"], &again["imprint"])
        );
        assert_eq!(first["frame"], again["label"]);
    }
    if python_has("numpy") {
        assert_eq!(numpy(&file), "50 ('time', 'number', 'values') 1675.0\n");
    }
    let beside = fs::read_to_string(file.with_extension("json")).expect("it is there");
    let beside: Value = serde_json::from_str(&beside).expect("JSON");
    assert_eq!(
        (&beside["format"], &beside["source"]),
        (&"taxel-touch/1".into(), &"standard input".into())
    );
    // The recording is not replaced by mistake.
    let run = taxel(&line, stream(0..1));
    assert_eq!(run.status, Some(1));
    assert!(run.stderr.contains("--force replaces it"), "{}", run.stderr);
    assert_eq!(
        taxel(&format!("{line} --force"), stream(0..1)).status,
        Some(0)
    );
}

pub(super) fn started(arguments: &[&str]) -> Child {
    program(arguments, "C.UTF-8")
        .spawn()
        .expect("the program starts")
}

/// The program is killed at many moments: the file that was recorded until then opens, and none of its frames is
/// wrong.
#[test]
fn after_a_kill_the_recording_opens_and_every_frame_is_right() {
    let folder = tempfile::tempdir().expect("a folder");
    let has_numpy = python_has("numpy");
    // The rounds run together, because they mostly wait.
    std::thread::scope(|scope| {
        for round in 0..12 {
            let file = folder.path().join(format!("touch-{round}.npy"));
            scope.spawn(move || {
                is_right_after_a_kill(round, &file);
                if has_numpy {
                    numpy(&file);
                }
            });
        }
    });
}

/// Kills a recording; each round records more frames and takes longer.
fn is_right_after_a_kill(round: u32, file: &Path) {
    let path = file.to_str().expect("UTF-8");
    let mut child = started(&["watch", "-", "--format", "lines", "--write", path]);
    let mut input = child.stdin.take().expect("piped");
    let mut output = BufReader::new(child.stdout.take().expect("piped"));
    // In some rounds longer than records are kept in memory.
    let mut answer = String::new();
    for piece in 0..=round / 3 {
        let frames = stream(piece * 100..(piece + 1) * 100);
        input.write_all(frames.as_bytes()).expect("it reads");
        for _ in 0..99 {
            answer.clear();
            output.read_line(&mut answer).expect("it answers");
        }
        std::thread::sleep(Duration::from_millis(u64::from(round) * 40));
    }
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
    let run = taxel(&format!("frames {path} --all --at-least 1 --json"), "");
    for (number, frame) in lines(&run.stdout).iter().enumerate() {
        assert_eq!(frame["sum"], 9 + number, "{frame}");
    }
    if lines(&run.stdout).is_empty() {
        assert!(
            run.stderr.is_empty()
                || run.stderr.contains("no frames")
                || run.stderr.contains("expected frames"),
            "{}",
            run.stderr
        );
    }
    // More than a second after the first hundred frames, these are in the file.
    assert!(
        round < 9 || lines(&run.stdout).len() >= 100,
        "round {round}"
    );
}

/// Only a recording must first be searched for other channels.
#[test]
fn the_first_frame_of_a_stream_is_answered_before_the_second_comes() {
    let mut watch = started(&[
        "watch",
        "-",
        "--format",
        "lines",
        "--rows",
        "2",
        "--columns",
        "2",
    ]);
    let mut input = watch.stdin.take().expect("piped");
    let output = watch.stdout.take().expect("piped");
    let (sender, answers) = std::sync::mpsc::channel();
    std::thread::spawn(move || {
        let mut answer = String::new();
        let read = BufReader::new(output).read_line(&mut answer);
        // The receiver may have stopped waiting.
        let _ = sender.send(read.map(|_| answer));
    });
    input.write_all(stream(7..8).as_bytes()).expect("written");
    let answer = answers.recv_timeout(Duration::from_secs(20));
    drop(input);
    assert!(watch.wait().expect("it ends").success());
    let answer = answer.expect("an answer while the stream is open");
    assert_eq!(lines(&answer.expect("read"))[0]["frame"], 0);
}

#[test]
fn a_fifo_is_read_until_its_writer_closes_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let fifo = folder.path().join("frames");
    if !wait::fifo(&fifo) {
        return;
    }
    let child = started(&["watch", fifo.to_str().expect("UTF-8")]);
    let mut writer = wait::writer_of(&fifo);
    // The frames are split anywhere.
    for piece in stream(0..40).as_bytes().chunks(7) {
        writer.write_all(piece).expect("it is read");
    }
    drop(writer);
    let run = super::finish(child, b"");
    assert_eq!(
        (run.status, lines(&run.stdout).len()),
        (Some(0), 40),
        "{}",
        run.stderr
    );
}

/// Returns true if a program has locked a file, which is how it claims a serial line.
fn has_locked(program: &Child, file: &Path) -> bool {
    let id = program.id().to_string();
    let inode = fs::metadata(file).expect("it is there").ino().to_string();
    let locks = fs::read_to_string("/proc/locks").expect("Linux lists its locks");
    // `1: FLOCK  ADVISORY  WRITE 19846 00:1a:4 0 EOF`
    locks.lines().any(|line| {
        let words: Vec<&str> = line.split_whitespace().collect();
        words.contains(&id.as_str())
            && words
                .iter()
                .any(|word| word.rsplit(':').next() == Some(inode.as_str()))
    })
}

/// A pair of pseudo-terminals acts as a serial line; its incomplete start is dropped.
#[test]
fn a_serial_line_is_read_and_a_busy_one_is_reported_as_busy() {
    let folder = tempfile::tempdir().expect("a folder");
    let (ours, theirs) = (folder.path().join("ours"), folder.path().join("theirs"));
    let end = |path: &Path| format!("pty,raw,echo=0,link={}", path.display());
    let socat = Command::new("socat")
        .args([end(&ours), end(&theirs)])
        .spawn();
    let Ok(mut socat) = socat else {
        lacking("socat");
        return;
    };
    until("pair of terminals by socat", || {
        let ended = socat.try_wait().expect("a child");
        assert_eq!(ended, None, "socat has ended");
        ours.exists() && theirs.exists()
    });
    let path = theirs.to_str().expect("UTF-8");
    let mut child = started(&["watch", path, "--baud", "250000", "--format", "lines"]);
    until("lock of the line", || has_locked(&child, &theirs));
    let busy = taxel(&format!("watch {path}"), "");
    assert_eq!(busy.status, Some(1));
    assert!(
        busy.stderr.contains("busy") || busy.stderr.contains("another program"),
        "{}",
        busy.stderr
    );
    let mut writer = fs::File::options()
        .write(true)
        .open(&ours)
        .expect("it is there");
    writer
        .write_all(("3 4\n\n".to_owned() + &stream(7..27)).as_bytes())
        .expect("written");
    let mut output = BufReader::new(child.stdout.take().expect("piped"));
    for number in 7..27 {
        let mut answer = String::new();
        output.read_line(&mut answer).expect("it answers");
        assert_eq!(lines(&answer)[0]["sum"], 9 + number);
    }
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
    socat.kill().expect("it is killed");
    socat.wait().expect("it ends");
}

/// The metadata beside a recording applies when it is read again: threshold, unit and tare.
#[test]
fn the_description_of_a_recording_is_read_with_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("touch.npy");
    let path = file.to_str().expect("UTF-8");
    let flags = "--once --low 5 --high 12 --least 2 --tare 2";
    let line = format!("watch {} {flags} --write {path}", sample("tekscan.asf"));
    let watched = taxel(&line, "");
    assert_eq!(watched.status, Some(0), "{}", watched.stderr);
    let again = taxel(&format!("frames {path} --all --json"), "");
    assert_eq!((again.status, again.stderr.as_str()), (Some(0), ""));
    let pairs = lines(&watched.stdout).into_iter().zip(lines(&again.stdout));
    let mut count = 0;
    for (first, again) in pairs {
        for key in ["imprint", "na", "tare", "sum"] {
            assert_eq!(first[key], again[key], "{key}");
        }
        assert_eq!(again["rule"]["from"], "file");
        assert_eq!(again["rule"]["low"], 5);
        count += 1;
    }
    assert_eq!(count, 3);
    let played = taxel(&format!("watch {path} --once"), "");
    assert_eq!(played.stdout, again.stdout);
    let listed = taxel(&format!("frames {path} --json"), "");
    let channel = &lines(&listed.stdout)[0]["channels"][0];
    assert_eq!(
        (&channel["unit"], &channel["pitch_mm"]),
        (&"raw".into(), &serde_json::json!([2.5, 2.5]))
    );
    // Flags override it.
    let plain = taxel(
        &format!("frames {path} --peak --json --at-least 9 --tare 0"),
        "",
    );
    let plain = &lines(&plain.stdout)[0];
    assert_eq!(
        plain["rule"],
        serde_json::json!({"at_least": 9, "from": "flag"})
    );
    assert_eq!(plain.get("tare"), None);
    // A description that is broken or missing is reported.
    for (text, told) in [
        (
            "{\"format\":\"taxel-touch/1\",\"ru",
            "touch.json: line 1, column 29: EOF ",
        ),
        (
            "{\"format\":\"taxel-touch/2\"}",
            "touch.json: format: \"taxel-touch/2\" is unknown",
        ),
        (
            "",
            "touch.json: missing; the recording's threshold and tare are unknown",
        ),
    ] {
        let beside = file.with_extension("json");
        match text {
            "" => fs::remove_file(beside).expect("removed"),
            _ => fs::write(beside, text).expect("written"),
        }
        for line in ["frames --peak", "watch --once"] {
            let run = taxel(&format!("{line} {path} --at-least 9"), "");
            assert_eq!(run.status, Some(0), "{}", run.stderr);
            assert!(
                !run.stdout.is_empty() && run.stderr.contains(told),
                "{line}: {}",
                run.stderr
            );
        }
    }
}

/// Returns frames as JSON lines at intervals of a tenth of a second, by the clock of the sensor.
fn clocked(from: f64, frames: u32) -> String {
    // The first frame may be incomplete.
    let lines = (0..frames).map(|number| {
        let time = from + f64::from(number) / 10.0;
        format!("{{\"t\": {time:.1}, \"frame\": [[1, 2], [3, 4]]}}\n")
    });
    "torn\n".to_owned() + &lines.collect::<String>()
}

/// The hangup of a lost connection to the machine ends it, but not under `nohup`.
#[test]
fn a_hangup_ends_a_recording_in_a_pipeline() {
    // The tests may run under `nohup`, too, and a shell cannot trap signals that are ignored when it starts.
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status
        .lines()
        .find_map(|line| line.strip_prefix("SigIgn:\t"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask, 16).ok());
    let inherited = mask.is_some_and(|mask| mask & 1 == 1);
    for ignored in [inherited, true] {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("touch.npy");
        let path = file.to_str().expect("UTF-8");
        let trap = if ignored { "trap '' HUP;" } else { "" };
        let mut command = sh(&format!("{trap} exec \"$0\" watch - --write \"$1\""));
        let mut child = command.arg(path).spawn().expect("it starts");
        let mut output = BufReader::new(child.stdout.take().expect("piped"));
        let mut input = child.stdin.take().expect("piped");
        let mut sends = |frames| {
            input
                .write_all(stream(frames).as_bytes())
                .expect("it reads");
            let mut answer = String::new();
            output.read_line(&mut answer).expect("it answers");
        };
        sends(0..3);
        let id = rustix::process::Pid::from_child(&child);
        rustix::process::kill_process(id, rustix::process::Signal::HUP).expect("it runs still");
        if ignored {
            sends(3..5);
        }
        drop(input);
        let status = child.wait().expect("it ends").code();
        assert_eq!(status, Some(if ignored { 0 } else { 129 }));
        let beside = fs::read_to_string(file.with_extension("json")).expect("it is there");
        let beside: Value = serde_json::from_str(&beside).expect("JSON");
        assert_eq!(beside["ended"], true, "{beside}");
    }
}

/// The reader of a pipe is stopped: it neither reads nor closes the pipe.
#[test]
fn a_signal_ends_a_watch_whose_answers_nobody_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    let (source, file) = (folder.path().join("s.txt"), folder.path().join("touch.npy"));
    fs::write(&source, stream(0..5000)).expect("written");
    let recorded = format!(" --write {}", file.display());
    for write in ["", &recorded] {
        let line = format!("watch {} --format lines --once{write}", source.display());
        let (mut reader, writer) = std::io::pipe().expect("a pipe");
        let mut command = program(&line.split(' ').collect::<Vec<_>>(), "C.UTF-8");
        let mut child = command.stdout(writer).spawn().expect("it starts");
        // The pipe holds the writer open as long as the command does.
        drop(command);
        reader.read_exact(&mut [0]).expect("it answers");
        std::thread::sleep(Duration::from_millis(300));
        let id = rustix::process::Pid::from_child(&child);
        rustix::process::kill_process(id, rustix::process::Signal::TERM).expect("it runs still");
        let mut status = None;
        until("end", || {
            status = child.try_wait().expect("asked");
            status.is_some()
        });
        assert_eq!(status.and_then(|status| status.code()), Some(143), "{line}");
    }
}

/// While the connection is lost, the clock of the sensor may continue or restart.
#[test]
fn times_continue_when_a_connection_is_made_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("touch.npy");
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
    let port = listener.local_addr().expect("an address").port();
    let source = format!("tcp://127.0.0.1:{port}");
    let path = file.to_str().expect("UTF-8");
    let mut child = started(&["watch", &source, "--write", path]);
    let mut output = BufReader::new(child.stdout.take().expect("piped"));
    let mut times = Vec::new();
    for from in [100.0, 103.5, 1.0] {
        let mut connection = wait::connection(&listener);
        let sent = connection.write_all(clocked(from, 24).as_bytes());
        sent.expect("it reads");
        for _ in 0..24 {
            let mut answer = String::new();
            output.read_line(&mut answer).expect("it answers");
            times.push(lines(&answer)[0]["time"].as_f64().expect("a time"));
        }
    }
    let id = rustix::process::Pid::from_child(&child);
    rustix::process::kill_process(id, rustix::process::Signal::TERM).expect("it still runs");
    let ended = super::finish(child, b"");
    assert_eq!(ended.status, Some(143), "{}", ended.stderr);
    let said = [
        "the other end has closed it; trying again each second",
        "back after",
    ];
    let says = said.iter().all(|text| ended.stderr.contains(text));
    assert!(says, "{}", ended.stderr);
    // Nothing listens on this port. A port that was just released might be another test's by now.
    let refused = taxel("watch tcp://127.0.0.1:1", "");
    assert_eq!(refused.status, Some(1));
    assert!(refused.stderr.contains("cannot open"), "{}", refused.stderr);
    let firsts = [0, 23, 24, 48].map(|frame| times[frame]);
    assert_eq!(firsts, [0.0, 2.3, 3.5, -99.0]);
}
