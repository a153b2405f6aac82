//! Recordings that are played, or followed while they grow, are cut or replaced.

use std::fs::{self, File};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant, SystemTime};

use taxel_core::frame::FrameSize;
use taxel_files::ReadError;
use taxel_files::acquire::{AcquireEvent, AcquireOptions, FrameSource, Playback, acquire};

use super::frame_size;

/// Plays the recording of that path.
fn run(
    path: &Path,
    options: &AcquireOptions,
    stop: &AtomicBool,
    consumer: &mut dyn FnMut(AcquireEvent<'_>) -> ControlFlow<()>,
) -> Result<(), ReadError> {
    acquire(&FrameSource::File(path.to_owned()), options, stop, consumer)
}

#[test]
fn a_wrong_line_that_stands_in_a_file_is_counted_if_the_file_grows_and_else_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("r.jsonl");
    let line = "{\"frame\":[[1,2]]}\n";
    let content = line.repeat(2) + "{\"frame\":[[1\n" + &line.repeat(3);
    for grows in [false, true] {
        fs::write(&path, &content).expect("written");
        let mut file = File::options().append(true).open(&path).expect("opened");
        if !grows {
            let long_ago = SystemTime::now() - Duration::from_secs(60);
            file.set_modified(long_ago).expect("its time is set");
        }
        let (options, stop) = (AcquireOptions::default(), AtomicBool::new(false));
        let (mut frames, mut dropped) = (0, 0);
        let result = run(&path, &options, &stop, &mut |event| {
            match event {
                AcquireEvent::Frame { .. } => frames += 1,
                AcquireEvent::Tick(counts) => dropped = dropped.max(counts.dropped),
                _ => {}
            }
            if frames == 4 && grows {
                file.write_all(line.as_bytes()).expect("written");
                frames += 10;
            }
            if frames == 16 && dropped > 0 {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        let error = result.err().map(|error| error.to_string());
        let error = error.map(|error| error.starts_with("line 3, "));
        let expected = if grows { (16, None) } else { (2, Some(true)) };
        assert_eq!((frames, error), expected);
    }
}

#[test]
fn the_channels_of_a_file_that_is_rewritten_keep_their_names_and_count_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("r.jsonl");
    let lines = |names: &[&str]| -> String {
        let line = |name| format!("{{\"channel\":\"{name}\",\"frame\":[[1,2]]}}\n");
        names.iter().map(line).collect()
    };
    fs::write(&path, lines(&["left", "right", "left"])).expect("written");
    let options = AcquireOptions {
        channel: Some("left".to_owned()),
        ..AcquireOptions::default()
    };
    let (mut channels, mut frames) = (Vec::new(), Vec::new());
    let result = run(&path, &options, &AtomicBool::new(false), &mut |event| {
        match event {
            AcquireEvent::Channel(info) => channels.extend(info.name.clone()),
            AcquireEvent::Frame { frame, .. } => {
                frames.push((channels[frame.channel].clone(), frame.number));
                if frames.len() == 3 {
                    File::create(&path).expect("truncated");
                }
            }
            AcquireEvent::Anew(_) => {
                fs::write(&path, lines(&["right", "top", "left"])).expect("written");
            }
            _ => {}
        }
        if frames.len() == 6 {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    assert!(result.is_ok());
    assert_eq!(channels, ["left", "right", "top"]);
    let frames = frames.iter().map(|(name, number)| (name.as_str(), *number));
    assert_eq!(
        frames.collect::<Vec<_>>(),
        [
            ("left", 0),
            ("right", 0),
            ("left", 1),
            ("right", 1),
            ("top", 0),
            ("left", 2)
        ]
    );
}

#[test]
fn a_torn_line_of_a_file_that_is_truncated_or_replaced_is_not_a_frame() {
    let folder = tempfile::tempdir().expect("a folder");
    let (path, other) = (folder.path().join("r.csv"), folder.path().join("other.csv"));
    let header = "time_s,r0c0,r0c1\n";
    for is_replaced in [false, true] {
        fs::write(&path, header.to_owned() + "0.0,1,11\n0.1,2,22\n").expect("written");
        let (mut values, mut ticks) = (Vec::new(), 0);
        let (options, stop) = (AcquireOptions::default(), AtomicBool::new(false));
        let result = run(&path, &options, &stop, &mut |event| {
            match event {
                AcquireEvent::Frame { frame, .. } => values.push(frame.values()[1]),
                AcquireEvent::Tick(_) => ticks += 1,
                _ => return ControlFlow::Continue(()),
            }
            if values.len() == 4 || ticks == 100 {
                return ControlFlow::Break(());
            }
            if ticks == 1 {
                let mut file = File::options().append(true).open(&path).expect("opened");
                file.write_all(b"0.2,3,33\n0.3,4,4").expect("written");
            }
            // The line has been read up to where it is torn.
            if ticks == 2 {
                let new = if is_replaced { &other } else { &path };
                fs::write(new, header.to_owned() + "0.0,7,77\n").expect("written");
                fs::rename(new, &path).expect("renamed");
            }
            ControlFlow::Continue(())
        });
        assert!(result.is_ok());
        assert_eq!(values, [11.0, 22.0, 33.0, 77.0]);
    }
}

/// Returns the first values of the frames of a file that holds one content, then another one, and how many frames
/// were dropped. `size` is that of a frame, if the file does not state it. Stops after `count` frames.
fn values_of_a_rewritten(
    path: &Path,
    size: Option<FrameSize>,
    [before, after]: [&[u8]; 2],
    count: usize,
) -> (Vec<f64>, u64) {
    fs::write(path, before).expect("written");
    let options = AcquireOptions {
        size,
        ..AcquireOptions::default()
    };
    let (mut values, mut times) = (Vec::new(), Vec::new());
    let (mut ticks, mut dropped, mut is_cut) = (0, 0, false);
    let result = run(path, &options, &AtomicBool::new(false), &mut |event| {
        match event {
            AcquireEvent::Frame { frame, time } => {
                values.push(frame.values()[0]);
                times.extend(time);
            }
            AcquireEvent::Tick(counts) => {
                (ticks, dropped) = (ticks + 1, counts.dropped);
                if values.len() == 2 && !is_cut {
                    is_cut = true;
                    File::create(path).expect("truncated");
                } else if values.len() == count || ticks == 100 {
                    return ControlFlow::Break(());
                }
            }
            AcquireEvent::Anew(_) => fs::write(path, after).expect("written"),
            _ => {}
        }
        ControlFlow::Continue(())
    });
    assert!(result.is_ok(), "{result:?}");
    // Those of a file that is written anew go on, too.
    assert!(times.is_sorted(), "{times:?}");
    (values, dropped)
}

/// The content before each cut has two frames; the one after it has three, with the first values 3, 4 and 5.
#[test]
fn a_file_that_is_truncated_keeps_its_format_and_arrangement() {
    let folder = tempfile::tempdir().expect("a folder");
    let named = "r0c0,r0c1,r1c0,r1c1\n1,0,0,0\n2,0,0,0\n";
    let timed = "time_s,r0c0,r0c1,r1c0,r1c1\n0,1,0,0,0\n1,2,0,0,0\n";
    let rows = "1 0\n0 0\n\n2 0\n0 0\n\n";
    let json = "{\"frame\":[[1,0],[0,0]]}\n{\"frame\":[[2,0],[0,0]]}\n";
    let more_json = json.replace("[[1", "[[4").replace("[[2", "[[5");
    let json = |torn: &str| {
        (
            json,
            format!("{torn}{{\"frame\":[[3,0],[0,0]]}}\n{more_json}"),
        )
    };
    let echo = "data:\n- 1\n- 0\n- 0\n- 0\n---\ndata:\n- 2\n- 0\n- 0\n- 0\n---\n";
    let table = |head: &str| (named, format!("{head}3,0,0,0\n4,0,0,0\n5,0,0,0\n"));
    let clocked = |head: &str| (timed, format!("{head}3,3,0,0,0\n4,4,0,0,0\n5,5,0,0,0\n"));
    let blocks = |head: &str| (rows, format!("{head}3 0\n0 0\n\n4 0\n0 0\n\n5 0\n0 0\n\n"));
    let cases = [
        ("cut between lines", table(""), 0),
        ("cut in a line", table("0,0\n"), 1),
        ("behind zero bytes", table("\0\0\0"), 0),
        ("behind a message", table("garbage here\n"), 0),
        (
            "behind two messages",
            table("garbage here\ngarbage, there\n"),
            0,
        ),
        (
            "with its header",
            (named, named.replace("1,0,0,0\n2", "3,0,0,0\n4,0,0,0\n5")),
            0,
        ),
        ("times, cut between lines", clocked(""), 0),
        ("times, cut in a line", clocked("0,0,0\n"), 1),
        ("rows, cut between frames", blocks(""), 0),
        ("rows, cut between rows", blocks("0 0\n\n"), 1),
        ("rows, cut in a row", blocks("9\n0 0\n\n"), 1),
        ("rows, behind a message", blocks("garbage here\n\n"), 1),
        ("rows, behind zero bytes", blocks("\0\0\0\0"), 0),
        (
            "another size",
            (
                rows,
                "3 0 0\n0 0 0\n\n4 0 0\n0 0 0\n\n5 0 0\n0 0 0\n\n".to_owned(),
            ),
            0,
        ),
        (
            "other names",
            (
                named,
                "time,r0c0,r0c1,r0c2\n0,3,0,0\n1,4,0,0\n2,5,0,0\n".to_owned(),
            ),
            0,
        ),
        ("JSON, cut between lines", json(""), 0),
        ("JSON, cut in a line", json("\": [[1,2],[3,4]]}\n"), 1),
        ("JSON, behind zero bytes", json("\0\0\0"), 0),
        ("another format", (named, json("").1), 0),
        (
            "messages, cut in a list",
            (
                echo,
                format!(
                    "- 0\n- 0\n---\n{}data: [5, 0, 0, 0]\n---\n",
                    echo.replace("- 1", "- 3").replace("- 2", "- 4")
                ),
            ),
            1,
        ),
    ];
    // They wait most of the time.
    std::thread::scope(|scope| {
        for (name, (before, after), expected) in cases {
            let path = folder.path().join(name);
            scope.spawn(move || {
                let contents = [before.as_bytes(), after.as_bytes()];
                // Such messages do not state the size of a frame.
                let size = before.starts_with("data:").then(|| frame_size(2, 2));
                let (values, dropped) = values_of_a_rewritten(&path, size, contents, 5);
                assert_eq!(values, [1.0, 2.0, 3.0, 4.0, 5.0], "{name}");
                assert_eq!(dropped, expected, "{name}");
            });
        }
    });
}

#[test]
fn a_file_that_no_longer_grows_is_silent() {
    let folder = tempfile::tempdir().expect("a folder");
    let silence = |is_removed: bool| {
        let path = folder.path().join(format!("{is_removed}.jsonl"));
        let line = "{\"frame\":[[1,2]]}\n";
        fs::write(&path, line).expect("written");
        let (options, mut ticks, mut silence) = (AcquireOptions::default(), 0, None);
        let result = run(&path, &options, &AtomicBool::new(false), &mut |event| {
            match event {
                AcquireEvent::Tick(_) => ticks += 1,
                AcquireEvent::Silent { counts, reason } => {
                    silence = Some((counts.frames, reason.to_owned()));
                }
                _ => {}
            }
            if ticks == 1 {
                let mut file = File::options().append(true).open(&path).expect("opened");
                file.write_all(line.as_bytes()).expect("written");
                if is_removed {
                    fs::remove_file(&path).expect("removed");
                }
                ticks = 2;
            }
            if silence.is_some() || ticks == 200 {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        assert!(result.is_ok());
        silence
    };
    std::thread::scope(|scope| {
        for is_removed in [false, true] {
            scope.spawn(move || {
                let end = if is_removed {
                    "; its file was moved or removed"
                } else {
                    ""
                };
                let reason = format!("the source has gone silent{end}");
                assert_eq!(silence(is_removed), Some((2, reason)));
            });
        }
    });
}

#[test]
fn a_consumer_that_broke_off_while_more_was_waited_for_gets_no_more() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("r.bin");
    // The end of the file confirms its last frame.
    fs::write(&path, b"\xaa\x55\x01\x02".repeat(20)).expect("written");
    let options = AcquireOptions {
        size: Some(frame_size(1, 2)),
        ..AcquireOptions::default()
    };
    let (mut frames, mut has_ended) = (0, false);
    let result = run(&path, &options, &AtomicBool::new(false), &mut |event| {
        assert!(!has_ended, "{event:?}");
        match event {
            AcquireEvent::Frame { .. } => frames += 1,
            AcquireEvent::Tick(_) => has_ended = frames == 19,
            _ => {}
        }
        if has_ended {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    assert!(result.is_ok() && has_ended);
}

#[test]
fn ticks_come_ten_times_a_second_whether_playback_waits_or_lags() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("many.csv");
    let rows = (0..200).map(|row| format!("{},1,2\n", f64::from(row) * 0.002));
    fs::write(
        &path,
        "time_s,r0c0,r0c1\n".to_owned() + &rows.collect::<String>(),
    )
    .expect("written");
    for (speed, lag) in [(1.0, 0), (1e9, 2)] {
        let mut options = AcquireOptions::default();
        let repeat = false;
        options.playback = Playback::Paced { speed, repeat };
        let (mut ticks, start) = (0, Instant::now());
        let result = run(&path, &options, &AtomicBool::new(false), &mut |event| {
            match event {
                AcquireEvent::Tick(_) => ticks += 1,
                AcquireEvent::Frame { .. } => std::thread::sleep(Duration::from_millis(lag)),
                _ => {}
            }
            ControlFlow::Continue(())
        });
        assert!(result.is_ok());
        let most = start.elapsed().as_millis() / 100;
        assert!(
            (2..=most).contains(&ticks),
            "{ticks} ticks in {most} tenths"
        );
    }
}

#[test]
fn a_recording_that_is_repeated_has_the_same_numbers_in_each_round() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("two.jsonl");
    fs::write(&path, "{\"frame\":[[1,2]]}\n{\"frame\":[[3,4]]}\n").expect("written");
    let options = AcquireOptions {
        playback: Playback::Paced {
            speed: 1e9,
            repeat: true,
        },
        ..AcquireOptions::default()
    };
    let mut numbers = Vec::new();
    let result = run(&path, &options, &AtomicBool::new(false), &mut |event| {
        if let AcquireEvent::Frame { frame, .. } = event {
            numbers.push(frame.number);
        }
        if numbers.len() == 5 {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    assert!(result.is_ok());
    assert_eq!(numbers, [0, 1, 0, 1, 0]);
}
