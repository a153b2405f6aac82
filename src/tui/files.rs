//! Opens and writes files for the screen: imprints in any format, shapes, outlines, drawings. Checks sources of frames
//! before they are watched, and lists paths for completion.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex};

use taxel_core::lock::locked;
use taxel_core::parameter::Parameter;
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_files::formats::file::system_reason;
use taxel_files::formats::recording::may_be_recording;
use taxel_files::formats::{Content, MAX_DRAWING_BYTES, read_content};
use taxel_files::storage::{Existing, FileError, ModelChoice, Models, below_home};

use crate::cli::input::outlines::OutlineFlags;
use crate::tui::app::Document;
use crate::tui::live::{WatchRequest, source};

/// The largest size of a file that is opened, in bytes. One byte more is read at most, and the file is refused then.
const MOST: u64 = MAX_DRAWING_BYTES as u64;

const MOST_PATHS: usize = 500;

pub(crate) fn watchable(
    mut request: Arc<WatchRequest>,
    models: &Models,
    access: &WriteAccess,
) -> Result<Arc<WatchRequest>, String> {
    let source = source::readable(&request.source, access)?;
    if let Some(reason) = source.unused_baud().filter(|_| request.baud_named) {
        return Err(format!("--baud has no effect {reason}"));
    }
    if let Some(choice) = request.model.clone().filter(ModelChoice::is_read) {
        let choice = models.locate(choice).map_err(|error| error.to_string())?;
        Arc::make_mut(&mut request).model = Some(choice);
    }
    Ok(request)
}

/// A file to open, and what it does not say itself.
#[derive(Clone, Debug, PartialEq)]
pub struct FileToOpen {
    pub(crate) name: String,
    pub(crate) pitch: Option<f64>,
    pub(crate) outlines: OutlineFlags,
}

/// Opens a file for the sensor in use, which `change` is the key to change. Also returns, in words, what the file has
/// beside its outline. A stored shape has a sensor of its own; what an imprint does not say, such as pitch and
/// threshold, is that of the sensor.
pub(crate) fn open(
    file: &FileToOpen,
    sensor: Sensor,
    change: &str,
) -> Result<(Document, Option<String>), String> {
    let FileToOpen {
        name,
        pitch,
        outlines,
    } = file;
    let on_pitch = |sensor: Sensor| match pitch {
        Some(pitch) => sensor.with(Parameter::Pitch, *pitch).unwrap_or(sensor),
        None => sensor,
    };
    let sensor = on_pitch(sensor);
    let bytes = bytes(name)?;
    let sentence = |reason: String| {
        if may_be_recording(&bytes) {
            format!("{reason}; if this is a recording, use :watch")
        } else {
            reason
        }
    };
    if outlines.is_outline(name, &bytes) {
        let known = pitch.or(Some(sensor.pitch_mm()).filter(|&pitch| pitch != 1.0));
        let read = outlines.outline(&bytes, name, known);
        let (outline, left_out) = read.map_err(|failure| sentence(failure.text))?;
        let hint = match outline.pitch_mm() {
            Some(_) => format!("{change} changes the sensor"),
            None => "if it is in mm, add --unit mm --pitch MM".to_owned(),
        };
        let source = Source::from(outline.in_the_middle(&sensor));
        let fits = source.check_size(&sensor);
        fits.map_err(|error| format!("{error}; {hint}"))?;
        return Ok((Document::touched(sensor, source), left_out));
    }
    outlines.refuse().map_err(|failure| failure.text)?;
    let content = read_content(&bytes).map_err(|error| sentence(error.to_string()))?;
    let document = match content {
        Content::Shape(shape) => {
            let document = Document::of_shape(&shape);
            document.on(on_pitch(document.sensor))
        }
        Content::Imprint(imprint) => {
            let sensor = sensor
                .with(Parameter::Columns, imprint.columns().into())
                .and_then(|sensor| sensor.with(Parameter::Rows, imprint.rows().into()))
                .map_err(|error| error.labelled())?;
            Document::drawn(sensor, imprint)
        }
    };
    Ok((document, None))
}

fn bytes(name: &str) -> Result<Vec<u8>, String> {
    let path = below_home(name).ok_or("no home folder, so ~ cannot be used")?;
    let sentence = |error: std::io::Error| format!("cannot read: {}", system_reason(&error));
    let kind = fs::metadata(&path).map_err(sentence)?;
    if !kind.is_file() {
        return Err("not a regular file".to_owned());
    }
    beginning(&path).map_err(sentence)
}

fn beginning(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(MOST + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Writes a file. Returns its absolute path; None if it exists and is to be kept.
pub(crate) fn write(
    access: &WriteAccess,
    name: &str,
    existing: Existing,
    write: &impl Fn(&Path, Existing) -> Result<(), FileError>,
) -> Result<Option<String>, String> {
    let path = access.path(name, existing)?;
    match write(&path, existing) {
        Ok(()) => {
            let whole = std::path::absolute(&path);
            Ok(Some(
                whole.as_deref().unwrap_or(&path).display().to_string(),
            ))
        }
        Err(error) if error.exists() && existing == Existing::Kept => Ok(None),
        Err(error) => Err(error.to_string()),
    }
}

/// Returns the paths that begin like this, as they are typed; folders end in a slash. Hidden ones are offered only if
/// a dot was typed.
pub(crate) fn paths(start: &str) -> Vec<String> {
    let (folder, typed) = start
        .rfind('/')
        .map_or(("", start), |slash| start.split_at(slash + 1));
    let place = if folder.is_empty() { "./" } else { folder };
    let entries = below_home(place).and_then(|place| fs::read_dir(place).ok());
    let offered = entries.into_iter().flatten().flatten().filter_map(|entry| {
        let name = entry.file_name().into_string().ok()?;
        let fits = name.starts_with(typed) && (typed.starts_with('.') || !name.starts_with('.'));
        let slash = if Path::is_dir(&entry.path()) { "/" } else { "" };
        fits.then(|| format!("{folder}{name}{slash}"))
    });
    let mut paths: Vec<String> = offered.take(MOST_PATHS).collect();
    paths.sort_unstable();
    paths
}

/// The rule for where the program may write files. On a terminal a person names the file, and is asked before an existing
/// one is replaced. A script does both itself, and may come from a stranger: it may write only below its own folder, no
/// hidden files, and may replace only files that it has written itself. `taxel script --allow-outside` lifts these
/// limits.
#[derive(Debug, Default)]
pub(crate) struct WriteAccess {
    /// The folder that a script is confined to; None for anywhere.
    pub(crate) folder: Option<PathBuf>,
    written: Mutex<Vec<PathBuf>>,
}

impl WriteAccess {
    pub(crate) fn below(folder: PathBuf) -> Self {
        Self {
            folder: Some(folder),
            written: Mutex::default(),
        }
    }

    pub(crate) fn path(&self, name: &str, existing: Existing) -> Result<PathBuf, String> {
        let Some(folder) = &self.folder else {
            return below_home(name)
                .ok_or_else(|| format!("{name}: no home folder, so ~ cannot be used"));
        };
        let path = inside(folder, name)?;
        // If a thread panicked here, it has added a path or not: the list is whole.
        let mut written = locked(&self.written);
        if existing == Existing::Replaced && path.exists() && !written.contains(&path) {
            return Err(format!(
                "{name}: existed before the script; without --allow-outside, a script replaces only its own files"
            ));
        }
        if existing == Existing::Kept && !path.exists() {
            written.push(path.clone());
        }
        Ok(path)
    }
}

fn inside(folder: &Path, name: &str) -> Result<PathBuf, String> {
    let visible = |component: Component<'_>| match component {
        Component::Normal(name) => !name.as_encoded_bytes().starts_with(b"."),
        _ => false,
    };
    let is_below =
        |path: &Path| path.components().next().is_some() && path.components().all(visible);
    let resolved = || {
        let folder = folder.canonicalize().ok()?;
        let path = folder.join(name);
        let parent = path.parent()?.canonicalize().ok()?;
        let path = parent.join(path.file_name()?);
        is_below(path.strip_prefix(&folder).ok()?).then_some(path)
    };
    resolved().ok_or_else(|| {
        let parent = Path::new(name).parent();
        // `~` is meant as the home folder.
        let parent = parent.filter(|parent| is_below(parent) && !parent.starts_with("~"));
        match parent.filter(|parent| !folder.join(parent).exists()) {
            Some(parent) => format!("{name}: there is no folder {}", parent.display()),
            None => format!(
                "{name}: without --allow-outside, a script writes only below its folder, and no hidden files"
            ),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_script_writes_below_its_folder_only() {
        let outside = tempfile::tempdir().expect("a folder");
        let folder = outside.path().join("own");
        for path in ["own/deeper", "own/.hidden"] {
            fs::create_dir_all(outside.path().join(path)).expect("made");
        }
        #[cfg(unix)]
        std::os::unix::fs::symlink(outside.path(), folder.join("link")).expect("linked");
        let access = WriteAccess::below(folder.clone());
        let absolute = folder.join("a.csv");
        let absolute = absolute.to_str().expect("text");
        for name in [
            "a.csv",
            "./a.csv",
            "deeper/a.csv",
            "deeper/../a.csv",
            absolute,
        ] {
            assert!(access.path(name, Existing::Kept).is_ok(), "{name}");
        }
        for name in [
            "",
            "..",
            "../a.csv",
            "deeper/../../a.csv",
            "~/a.csv",
            "/a.csv",
            ".a.csv",
            ".hidden/a.csv",
            "link/a.csv",
            "../nowhere/a.csv",
        ] {
            let refused = access.path(name, Existing::Kept).expect_err(name);
            assert!(refused.contains("--allow-outside"), "{refused}");
        }
        let missing = access.path("nowhere/a.csv", Existing::Kept);
        let missing = missing.expect_err("no folder");
        assert_eq!(missing, "nowhere/a.csv: there is no folder nowhere");
    }

    #[test]
    fn a_script_replaces_its_own_files_only() {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("theirs.csv"), "").expect("written");
        let access = WriteAccess::below(folder.path().to_owned());
        let own = access.path("own.csv", Existing::Kept).expect("free");
        fs::write(own, "").expect("written");
        assert!(access.path("own.csv", Existing::Replaced).is_ok());
        assert!(
            access.path("theirs.csv", Existing::Kept).is_ok(),
            "refused when it is written"
        );
        let refused = access.path("theirs.csv", Existing::Replaced);
        assert!(refused.is_err_and(|message| message.contains("before the script")));
    }
}
