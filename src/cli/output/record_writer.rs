//! Writes the file of `--record` on a separate thread, so that a disk that hangs does not delay any key.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::Builder;

use crate::storage::FileId;
use crate::tui::runtime::work::threads::PATIENCE;

pub(crate) struct RecordWriter(Option<RecordSink>);

enum RecordSink {
    Thread(Sender<String>, Receiver<io::Result<()>>),
    Here(RecordFile),
}

struct RecordFile {
    path: PathBuf,
    file: Arc<File>,
    begun: bool,
    /// The length of the whole lines written, in bytes.
    length: u64,
    /// The function that is called with the first error, at once.
    on_failure: OnFailure,
    failed: io::Result<()>,
}

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

    /// Appends lines. After the first error nothing more is written: the record ends after a whole line, without a
    /// gap.
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
                    // A truncated line would be an error in the script, so it is removed. If that fails, it stays.
                    let _ = self.file.set_len(self.length);
                    (self.on_failure)(error);
                }
            }
        }
    }

    /// Ends the record and removes the file if it is empty, unless another file has its name by now.
    fn finish(self) -> io::Result<()> {
        if !self.begun && FileId::of(&self.file).is_ok_and(|id| id.is_at(&self.path)) {
            // If this fails, an empty file stays.
            let _ = fs::remove_file(&self.path);
        }
        self.failed
    }
}

impl RecordWriter {
    pub(crate) fn start(path: PathBuf, file: File, on_failure: OnFailure) -> Self {
        let file = Arc::new(file);
        let (lines, given) = channel::<String>();
        let (done, ended) = channel();
        let mut own = RecordFile::new(path.clone(), Arc::clone(&file), Arc::clone(&on_failure));
        let thread = Builder::new().spawn(move || {
            for lines in given {
                own.write(&lines);
            }
            // The receiver may have stopped waiting.
            let _ = done.send(own.finish());
        });
        match thread {
            Ok(_) => Self(Some(RecordSink::Thread(lines, ended))),
            Err(_) => Self(Some(RecordSink::Here(RecordFile::new(
                path, file, on_failure,
            )))),
        }
    }

    pub(crate) fn write(&mut self, text: String) {
        match &mut self.0 {
            // The thread ends only after this end of the channel is dropped.
            Some(RecordSink::Thread(lines, _)) => drop(lines.send(text)),
            Some(RecordSink::Here(file)) => file.write(&text),
            None => {}
        }
    }

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
        // A caller that needs the error has called `finish`.
        let _ = self.end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn an_empty_record_is_removed_but_not_a_file_that_took_its_name() {
        for is_replaced in [false, true] {
            let folder = tempfile::tempdir().expect("a folder");
            let path = folder.path().join("record");
            let file = File::create_new(&path).expect("made");
            let record = RecordWriter::start(path.clone(), file, Arc::new(|_| ()));
            if is_replaced {
                let other = folder.path().join("other");
                fs::write(&other, "precious").expect("written");
                fs::rename(&other, &path).expect("moved");
            }
            record.finish().expect("ended");
            assert_eq!(path.exists(), is_replaced);
        }
    }
}
