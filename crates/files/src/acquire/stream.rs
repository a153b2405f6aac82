//! Reads a source of bytes until it ends. If it may come back, taxel tries to open it again each second.

use std::io;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::acquire::byte_input::{ByteInput, ReadOutcome};
use crate::acquire::event::{AcquireError, AcquireEvent, AcquireOptions, AcquireSink, Playback};
use crate::acquire::source::FrameSource;
use crate::acquire::stream_report::StreamReporter;
use crate::acquire::ticker::TICK;

/// The number of bytes read at a time.
const CHUNK: usize = 1 << 16;

/// The time after which a lost source is tried again.
const RETRY: Duration = Duration::from_secs(1);

/// Reads a source of bytes.
pub(super) fn run(
    source: &FrameSource,
    options: &AcquireOptions,
    stop: &AtomicBool,
    consumer: &mut AcquireSink<'_>,
) -> Result<(), AcquireError> {
    let reader = StreamReader {
        source,
        options,
        stop,
        reporter: StreamReporter::new(source, options, consumer),
    };
    reader.read()
}

/// A reader of a source of bytes.
struct StreamReader<'a, 'b> {
    source: &'a FrameSource,
    options: &'a AcquireOptions,
    stop: &'a AtomicBool,
    reporter: StreamReporter<'a, 'b>,
}

impl StreamReader<'_, '_> {
    /// Reads the source to its end, or until no more is wanted.
    fn read(mut self) -> Result<(), AcquireError> {
        let Some(mut input) = self.first_input()? else {
            return Ok(());
        };
        self.reporter.begin();
        let comes_back = self.source.comes_back() && self.options.playback != Playback::Once;
        let mut bytes = vec![0; CHUNK];
        while !self.stop.load(Ordering::Relaxed) {
            let lost = match input.read(&mut bytes) {
                Ok(ReadOutcome::Bytes(count)) => match self.reporter.decode(&bytes[..count])? {
                    ControlFlow::Continue(()) => continue,
                    ControlFlow::Break(()) => return Ok(()),
                },
                Ok(ReadOutcome::Anew(how)) => {
                    if self.reporter.begin_anew(how).is_break() {
                        return Ok(());
                    }
                    continue;
                }
                Ok(ReadOutcome::End) if comes_back => {
                    io::Error::new(io::ErrorKind::UnexpectedEof, "the other end has closed it")
                }
                Ok(ReadOutcome::End) => {
                    self.reporter.check_start()?;
                    if self.end().is_continue() {
                        let _ = self.reporter.report_end();
                    }
                    return Ok(());
                }
                Err(error) if comes_back => error,
                Err(error) => {
                    // What came before counts.
                    let _ = self.reporter.cut_off();
                    return Err(AcquireError::reading(error));
                }
            };
            if self.reporter.interrupt().is_break() {
                return Ok(());
            }
            match self.again(AcquireEvent::Lost(&lost))? {
                Some(found) => input = found,
                None => return Ok(()),
            }
            self.reporter.resume();
        }
        // No more is wanted.
        let _ = self.reporter.cut_off();
        Ok(())
    }

    /// Reports what is left at the end of the source. A file, or anything that is read to its end, ends as intended. A
    /// live pipe may end because its writer died in the middle of a number.
    fn end(&mut self) -> ControlFlow<()> {
        if self.options.playback == Playback::Once && !self.source.comes_back() {
            self.reporter.finish()
        } else {
            self.reporter.cut_off()
        }
    }

    /// Opens the source. Returns None if no more is wanted meanwhile.
    fn open(&mut self) -> io::Result<Option<ByteInput>> {
        ByteInput::open(self.source, self.options, &mut || self.wait())
    }

    /// Reports a tick while opening a source or waiting for it. Returns `Break` if no more is wanted.
    fn wait(&mut self) -> ControlFlow<()> {
        if self.stop.load(Ordering::Relaxed) {
            return ControlFlow::Break(());
        }
        self.reporter.wait()
    }

    /// Opens the source; if it does not exist yet, waits for it if the options say so. None if no more is wanted.
    fn first_input(&mut self) -> Result<Option<ByteInput>, AcquireError> {
        match self.open() {
            Ok(input) => Ok(input),
            Err(error) if self.options.waits && self.source.comes_back() && !is_invalid(&error) => {
                self.again(AcquireEvent::Absent(&error))
            }
            Err(error) => Err(AcquireError::opening(error)),
        }
    }

    /// Reports why it waits for the source, and tries to open it each second until it exists. None if no more is
    /// wanted.
    ///
    /// # Errors
    /// Returns an error if what exists by then is invalid.
    fn again(&mut self, event: AcquireEvent<'_>) -> Result<Option<ByteInput>, AcquireError> {
        let since = Instant::now();
        if self.reporter.report(event).is_break() {
            return Ok(None);
        }
        loop {
            let next = Instant::now() + RETRY;
            while Instant::now() < next {
                if self.wait().is_break() {
                    return Ok(None);
                }
                std::thread::sleep(TICK);
            }
            match self.open() {
                Ok(None) => return Ok(None),
                Ok(Some(input)) => {
                    let gap = since.elapsed();
                    let back = self.reporter.report(AcquireEvent::Back { gap });
                    return Ok(back.is_continue().then_some(input));
                }
                Err(error) if is_invalid(&error) => return Err(AcquireError::opening(error)),
                Err(_) => {}
            }
        }
    }
}

/// Returns true if the source is not one that can be opened. Waiting does not make it valid.
fn is_invalid(error: &io::Error) -> bool {
    error.kind() == io::ErrorKind::InvalidInput
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};
    use std::io::Write;
    use std::net::TcpListener;

    use super::*;
    use crate::formats::stream::StreamFormat;
    use crate::frame::FrameSize;

    /// Two connections: the first ends with the last byte of a frame, the second one byte later.
    #[test]
    fn the_rest_of_a_lost_connection_is_reported_counted_or_withdrawn() {
        const FRAME: [u8; 6] = [0xaa, 0x55, 1, 2, 3, 4];
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("its address").to_string();
        let sender = std::thread::spawn(move || {
            for rest in [&b""[..], &b"?"[..]] {
                let (mut connection, _) = listener.accept().expect("a connection");
                connection.write_all(&FRAME.repeat(2)).expect("sent");
                std::thread::sleep(Duration::from_millis(300));
                connection.write_all(rest).expect("sent");
            }
        });
        let options = AcquireOptions {
            format: Some(StreamFormat::Flexitac),
            size: Some(FrameSize::new(2, 2).expect("an allowed size")),
            ..AcquireOptions::default()
        };
        let (mut events, mut dropped) = (Vec::new(), 0);
        let source = FrameSource::Tcp(address);
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            let losses = events.iter().filter(|event| **event == "lost").count();
            match event {
                AcquireEvent::Frame { .. } => events.push("frame"),
                AcquireEvent::Provisional(_) => events.push("provisional"),
                AcquireEvent::Withdrawn => events.push("withdrawn"),
                AcquireEvent::Lost(_) => events.push("lost"),
                AcquireEvent::Tick(counts) if losses == 2 => {
                    dropped = counts.dropped;
                    return ControlFlow::Break(());
                }
                _ => {}
            }
            ControlFlow::Continue(())
        });
        sender.join().expect("all was sent");
        assert!(result.is_ok());
        let first = ["frame", "provisional", "frame", "lost"];
        let second = ["frame", "provisional", "withdrawn", "lost"];
        assert_eq!(events, [first, second].concat());
        assert_eq!(dropped, 1);
    }

    /// Returns the times of the first five frames of two connections, of which each loses its first line.
    fn times_over_a_gap(connections: [String; 2]) -> Vec<Option<f64>> {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("its address").to_string();
        let sender = std::thread::spawn(move || {
            for lines in connections {
                let (mut connection, _) = listener.accept().expect("a connection");
                connection.write_all(lines.as_bytes()).expect("sent");
            }
        });
        let options = AcquireOptions {
            size: Some(FrameSize::new(2, 1).expect("an allowed size")),
            ..AcquireOptions::default()
        };
        let mut times = Vec::new();
        let source = FrameSource::Tcp(address);
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            if let AcquireEvent::Frame { time, .. } = event {
                times.push(time);
            }
            if times.len() == 5 {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
        sender.join().expect("all was sent");
        assert!(result.is_ok());
        times
    }

    #[test]
    fn a_source_that_turns_out_to_be_invalid_is_not_waited_for() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("line");
        let source = FrameSource::Serial(path.clone());
        let options = AcquireOptions::default().with_waits(true);
        let mut events = 0;
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            match event {
                AcquireEvent::Absent(_) => fs::write(&path, "").expect("written"),
                _ => events += 1,
            }
            if events == 100 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        let error = result.expect_err("a file").to_string();
        assert!(error.contains("it is not a serial line"), "{error}");
    }

    /// Reads a FIFO into which these pieces are written, each once the one before was read. Returns the result.
    fn read_in_pieces(pieces: &[&[u8]]) -> Result<(), AcquireError> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&path).status();
        assert!(made.expect("mkfifo starts").success());
        let source = FrameSource::new(path.as_os_str());
        let (mut writer, mut written, mut left) = (None, 0, pieces.iter());
        let options = AcquireOptions::default();
        run(&source, &options, &AtomicBool::new(false), &mut |event| {
            if let AcquireEvent::Tick(counts) = event
                && counts.bytes == written
            {
                let Some(piece) = left.next() else {
                    writer = None;
                    return ControlFlow::Continue(());
                };
                // The pipe is open for reading.
                let open = || File::options().write(true).open(&path).expect("opened");
                let writer = writer.get_or_insert_with(open);
                writer.write_all(piece).expect("written");
                written += piece.len() as u64;
            }
            ControlFlow::Continue(())
        })
    }

    #[test]
    fn a_recording_that_arrives_in_pieces_is_not_taken_for_a_stream() {
        for (recording, format) in [
            (&b"\x93NUMPY\x01\x00v\x00{'descr': '|u1', "[..], "npy"),
            (b"DATA_TYPE MOVIE\nROWS 2\nCOLS 2\n", "tekscan"),
            (b"FRAME,1\n,\nSENSOR,left\n,\nSENSELS,\n", "xsensor"),
        ] {
            let (start, rest) = recording.split_at(4);
            let refused = read_in_pieces(&[start, rest]).expect_err("a recording");
            let expected = format!("a recording ({format}), not a stream");
            assert_eq!(refused.to_string(), expected);
        }
        // After its first frame, a stream may contain anything.
        let stream = [&b"1 2\n\n3 4\n\n"[..], b"DATA_TYPE MOVIE\n"];
        assert!(read_in_pieces(&stream).is_ok());
    }

    #[test]
    fn a_file_that_becomes_a_recording_is_not_taken_for_a_stream() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("touch.npy");
        fs::write(&path, b"\x93NUM").expect("written");
        let source = FrameSource::File(path.clone());
        let options = AcquireOptions::default();
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            if let AcquireEvent::Tick(counts) = event
                && counts.bytes == 4
            {
                let mut file = File::options().append(true).open(&path).expect("opened");
                file.write_all(b"PY\x01\x00v\x00{").expect("written");
            }
            ControlFlow::Continue(())
        });
        assert!(matches!(result, Err(AcquireError::NotStream { .. })));
        // The frames before the file was replaced do not make it a stream.
        fs::write(&path, b"1 2\n3 4\n\n5 6\n7 8\n\n").expect("written");
        let other = folder.path().join("other");
        fs::write(&other, b"\x93NUMPY\x01\x00v\x00{").expect("written");
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            if let AcquireEvent::Tick(counts) = event
                && counts.frames == 2
                && other.exists()
            {
                fs::rename(&other, &path).expect("renamed");
            }
            ControlFlow::Continue(())
        });
        assert!(matches!(result, Err(AcquireError::NotStream { .. })));
    }

    /// A connection and a serial line are live even if they are read only once; a pipe may hold a file.
    #[test]
    fn frames_of_a_live_source_have_times_of_arrival() {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let address = listener.local_addr().expect("its address").to_string();
        let sender = std::thread::spawn(move || {
            let (mut connection, _) = listener.accept().expect("a connection");
            connection.write_all(b"?\n1 2\n3 4\n").expect("sent");
        });
        let options = AcquireOptions {
            size: Some(FrameSize::new(2, 1).expect("an allowed size")),
            playback: Playback::Once,
            ..AcquireOptions::default()
        };
        let (mut times, source) = (Vec::new(), FrameSource::Tcp(address));
        let result = run(&source, &options, &AtomicBool::new(false), &mut |event| {
            if let AcquireEvent::Frame { time, .. } = event {
                times.push(time);
            }
            ControlFlow::Continue(())
        });
        sender.join().expect("all was sent");
        assert!(result.is_ok());
        assert_eq!((times.len(), times[0]), (2, Some(0.0)));
        assert!(times[1].is_some());
        let fifo = FrameSource::Fifo("pipe".into());
        let live = [Playback::Live, Playback::Once].map(|playback| fifo.arrives(playback));
        assert_eq!(live, [true, false]);
    }

    #[test]
    fn the_times_of_a_source_go_on_over_a_gap() {
        let json = |time: f64| format!("{{\"time\":{time},\"frame\":[[1,2]]}}\n");
        let stamped = |time: f64| format!("{{\"t_ms\":{},\"frame\":[[1,2]]}}\n", 1e6 + 1e3 * time);
        let dated = |time: f64| format!("2024-05-01 12:00:0{time},1,2\n");
        // Midnight is in the gap.
        let clock = |time: f64| {
            let (hour, second) = if time < 1.0 {
                ("23:59", 59.0)
            } else {
                ("00:00", -1.0)
            };
            format!("{hour}:{:04.1},1,2\n", second + time)
        };
        // The first line of a connection may be torn, but an object of JSON is whole.
        let (whole, torn) = ([0.0, 0.1, 0.2, 0.3, 1.8], [0.0, 0.1, 0.2, 1.8, 1.9]);
        let formats: [(&(dyn Fn(f64) -> String + Sync), _); 4] = [
            (&json, whole),
            (&stamped, whole),
            (&dated, torn),
            (&clock, torn),
        ];
        std::thread::scope(|scope| {
            for (line, expected) in formats {
                scope.spawn(move || {
                    let text = |times: &[f64]| times.iter().map(|&time| line(time)).collect();
                    let connections = [text(&[0.0, 0.1, 0.2, 0.3]), text(&[1.8, 1.9, 2.0])];
                    let times = times_over_a_gap(connections);
                    assert_eq!(times, expected.map(Some), "{}", line(0.0));
                });
            }
        });
    }
}
