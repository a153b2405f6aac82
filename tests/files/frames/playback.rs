//! Recordings that are played, or followed while they grow.

use std::fs::{self, File};
use std::io::Write;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

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
fn a_wrong_line_that_stands_in_a_file_is_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("r.jsonl");
    let line = "{\"frame\":[[1,2]]}\n";
    fs::write(&path, line.repeat(2) + "{\"frame\":[[1\n" + &line.repeat(3)).expect("written");
    let (options, stop) = (AcquireOptions::default(), AtomicBool::new(false));
    let (mut frames, mut ended) = (0, None);
    let result = run(&path, &options, &stop, &mut |event| {
        match event {
            AcquireEvent::Frame { .. } => frames += 1,
            AcquireEvent::Ended(counts) => ended = Some(counts.dropped),
            _ => {}
        }
        ControlFlow::Continue(())
    });
    assert_eq!((result, frames, ended), (Ok(()), 5, Some(1)));
}

#[test]
fn a_file_that_no_longer_grows_is_silent() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("grows.jsonl");
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
            ticks = 2;
        }
        if silence.is_some() || ticks == 200 {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    });
    assert!(result.is_ok());
    assert_eq!(silence, Some((2, "the source has gone silent".to_owned())));
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
