//! Sources that are lost, come back, or turn out to be something else.

use std::fs;
use std::io::Write;
use std::net::TcpListener;
use std::ops::ControlFlow;
use std::thread::JoinHandle;

use taxel_core::frame::FrameSize;

use super::*;

/// Sends these texts over one connection after the other; each ends with its text.
fn sender(texts: Vec<Vec<u8>>) -> (FrameSource, JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("its address").to_string();
    let sender = std::thread::spawn(move || {
        for text in texts {
            let (mut connection, _) = listener.accept().expect("a connection");
            connection.write_all(&text).expect("sent");
        }
    });
    (FrameSource::Tcp(address), sender)
}

fn sized(columns: u16, rows: u16) -> AcquireOptions {
    AcquireOptions {
        size: Some(FrameSize::new(columns, rows).expect("an allowed size")),
        ..AcquireOptions::default()
    }
}

fn run(
    source: &FrameSource,
    options: &AcquireOptions,
    take: &mut dyn FnMut(AcquireEvent<'_>) -> bool,
) -> Result<(), ReadError> {
    acquire(source, options, &AtomicBool::new(false), &mut |event| {
        if take(event) {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    })
}

/// The first connection ends with the last byte of a frame, the second one byte later.
#[test]
fn the_rest_of_a_lost_connection_is_reported_or_counted() {
    let frames = [0xaa, 0x55, 1, 2, 3, 4].repeat(3);
    let torn = [&frames[..], b"?"].concat();
    let (source, sender) = sender(vec![frames, torn]);
    let options = AcquireOptions {
        format: Format::of_stream("flexitac").ok(),
        ..sized(2, 2)
    };
    let (mut events, mut dropped) = (Vec::new(), 0);
    let result = run(&source, &options, &mut |event| {
        match event {
            AcquireEvent::Frame { .. } => events.push("frame"),
            AcquireEvent::Lost(_) => events.push("lost"),
            AcquireEvent::Tick(counts) => dropped = counts.dropped,
            _ => {}
        }
        let losses = events.iter().filter(|event| **event == "lost").count();
        losses < 2 || dropped == 0
    });
    sender.join().expect("all was sent");
    assert_eq!(result, Ok(()));
    let frames = events.split(|event| *event == "lost").map(<[_]>::len);
    assert_eq!(frames.collect::<Vec<_>>(), [3, 2, 0]);
    assert_eq!(dropped, 1);
}

#[test]
fn the_times_of_a_source_go_on_over_a_gap() {
    let text = |times: &[f64]| {
        let line = |time| format!("{{\"time\":{time},\"frame\":[[1,2]]}}\n");
        times.iter().map(line).collect::<String>().into_bytes()
    };
    let texts = vec![text(&[0.0, 0.1, 0.2, 0.3]), text(&[1.8, 1.9, 2.0])];
    let (source, sender) = sender(texts);
    let mut times = Vec::new();
    let result = run(&source, &sized(2, 1), &mut |event| {
        if let AcquireEvent::Frame { time, .. } = event {
            times.extend(time);
        }
        times.len() < 5
    });
    sender.join().expect("all was sent");
    assert_eq!(result, Ok(()));
    // An object of JSON is whole, even if it is the first line.
    assert_eq!(times, [0.0, 0.1, 0.2, 0.3, 1.8]);
}

#[test]
fn a_source_that_turns_out_to_be_invalid_is_not_waited_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("line");
    let source = FrameSource::Serial(path.clone());
    let options = AcquireOptions {
        waits: true,
        ..AcquireOptions::default()
    };
    let mut events = 0;
    let result = run(&source, &options, &mut |event| {
        match event {
            AcquireEvent::Absent(_) => fs::write(&path, "").expect("written"),
            _ => events += 1,
        }
        events < 100
    });
    let error = result.expect_err("a file").to_string();
    assert!(error.contains("it is not a serial line"), "{error}");
}

#[test]
fn a_file_that_becomes_a_recording_is_not_taken_for_a_stream() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("touch.npy");
    fs::write(&path, b"\x93NUM").expect("written");
    let source = FrameSource::File(path.clone());
    let result = run(&source, &AcquireOptions::default(), &mut |event| {
        if let AcquireEvent::Tick(counts) = event
            && counts.bytes == 4
        {
            let mut file = File::options().append(true).open(&path).expect("opened");
            let rest = [&b"PY\x01\x00v\x00{"[..], &[b' '; 64]].concat();
            file.write_all(&rest).expect("written");
        }
        true
    });
    let error = result.expect_err("an array").to_string();
    assert!(error.contains("a recording (npy), not a stream"), "{error}");
}

/// A connection and a serial line are live even if they are read only once; a pipe may hold a file.
#[test]
fn frames_of_a_live_source_have_times_of_arrival() {
    let (source, sender) = sender(vec![b"?\n1 2\n3 4\n5 6\n".to_vec()]);
    let options = AcquireOptions {
        playback: Playback::Once,
        ..sized(2, 1)
    };
    let mut times = Vec::new();
    let result = run(&source, &options, &mut |event| {
        if let AcquireEvent::Frame { time, .. } = event {
            times.push(time);
        }
        true
    });
    sender.join().expect("all was sent");
    assert_eq!(result, Ok(()));
    assert_eq!(times[0], Some(0.0));
    assert!(times.iter().all(Option::is_some));
    let fifo = FrameSource::Fifo("pipe".into());
    let live = [Playback::Live, Playback::Once].map(|playback| fifo.arrives(playback));
    assert_eq!(live, [true, false]);
}
