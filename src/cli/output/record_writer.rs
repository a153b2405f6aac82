//! Writes the file of `--record` on a separate thread, so that a disk that hangs does not delay any key.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::Builder;

use crate::tui::runtime::work::threads::PATIENCE;

/// Writes the file. Dropped, as by a panic, it waits for the last lines too: they tell most.
pub(crate) struct RecordWriter(Option<RecordSink>);

/// Where lines go.
enum RecordSink {
    /// To the thread, which returns the first error.
    Thread(Sender<String>, Receiver<io::Result<()>>),
    /// Where the system gives no thread.
    Here(RecordFile),
}

/// The file.
struct RecordFile {
    /// Its path.
    path: PathBuf,
    /// The open file.
    file: Arc<File>,
    /// Whether anything has been written.
    begun: bool,
    /// The bytes of the whole lines.
    length: u64,
    /// Called with the first error, at once.
    on_failure: OnFailure,
    /// The error that ended it.
    failed: io::Result<()>,
}

/// Called with the error that ends a record, on the thread that writes it.
pub(crate) type OnFailure = Arc<dyn Fn(&io::Error) + Send + Sync>;

impl RecordFile {
    fn new(path: PathBuf, file: Arc<File>, on_failure: OnFailure) -> Self {
        Self {
            path,
            file,
            begun: false,
            length: 0,
            on_failure,
            failed: Ok(()),
        }
    }

    /// Appends lines. After the first error nothing more is written: the record ends after a whole line, without a gap.
    fn write(&mut self, lines: &str) {
        for line in lines.split_inclusive('\n') {
            self.begun = true;
            if self.failed.is_err() {
                return;
            }
            self.failed = self.file.as_ref().write_all(line.as_bytes());
            match &self.failed {
                Ok(()) => self.length += line.len() as u64,
                Err(error) => {
                    // A line that is cut would be an error of the script. At worst it stays.
                    let _ = self.file.set_len(self.length);
                    (self.on_failure)(error);
                }
            }
        }
    }

    /// Ends it; an empty one is removed.
    fn finish(self) -> io::Result<()> {
        if !self.begun {
            // At worst an empty file stays.
            let _ = fs::remove_file(&self.path);
        }
        self.failed
    }
}

impl RecordWriter {
    /// Writes to a file that is open and empty.
    pub(crate) fn start(path: PathBuf, file: File, on_failure: OnFailure) -> Self {
        let file = Arc::new(file);
        let (lines, given) = channel::<String>();
        let (done, ended) = channel();
        let mut own = RecordFile::new(path.clone(), Arc::clone(&file), Arc::clone(&on_failure));
        let thread = Builder::new().spawn(move || {
            for lines in given {
                own.write(&lines);
            }
            // Nobody may be waiting any more.
            let _ = done.send(own.finish());
        });
        match thread {
            Ok(_) => Self(Some(RecordSink::Thread(lines, ended))),
            Err(_) => Self(Some(RecordSink::Here(RecordFile::new(
                path, file, on_failure,
            )))),
        }
    }

    /// Appends lines, soon.
    pub(crate) fn write(&mut self, text: String) {
        match &mut self.0 {
            // The thread ends only after this end of the channel.
            Some(RecordSink::Thread(lines, _)) => drop(lines.send(text)),
            Some(RecordSink::Here(file)) => file.write(&text),
            None => {}
        }
    }

    /// Waits for what is not written yet, but not for long.
    ///
    /// # Errors
    /// The one that ended the record early; that the disk does not answer.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.end()
    }

    fn end(&mut self) -> io::Result<()> {
        let ended = match self.0.take() {
            Some(RecordSink::Thread(lines, ended)) => {
                drop(lines);
                ended
            }
            Some(RecordSink::Here(file)) => return file.finish(),
            None => return Ok(()),
        };
        match ended.recv_timeout(PATIENCE) {
            Ok(ended) => ended,
            Err(RecvTimeoutError::Timeout) => Err(io::Error::other("the disk does not answer")),
            Err(RecvTimeoutError::Disconnected) => {
                Err(io::Error::other("the thread that writes has failed"))
            }
        }
    }
}

impl Drop for RecordWriter {
    fn drop(&mut self) {
        // Whoever wants to know has called `finish`.
        let _ = self.end();
    }
}
