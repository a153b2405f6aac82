//! `--export FILE` and `taxel export`: the file to write, and its format.

use std::path::{Path, PathBuf};

use crate::formats::{DrawingFormat, ImprintFormat};
use crate::storage::Existing;

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExportFormat {
    /// The imprint, as text, PBM, CSV or NPY.
    Imprint(ImprintFormat),
    /// A drawing of the imprint with its descriptors.
    Drawing(DrawingFormat),
}

impl ExportFormat {
    /// Returns the format of this name, as in `--format`.
    fn of(name: &str) -> Option<Self> {
        let format = name.parse().map(Self::Imprint);
        format.or_else(|_| name.parse().map(Self::Drawing)).ok()
    }

    /// Returns the format of a file's extension.
    fn of_ending(path: &Path) -> Option<Self> {
        let format = ImprintFormat::of_ending(&ending(path)).map(Self::Imprint);
        format.or_else(|| DrawingFormat::of_path(path).map(Self::Drawing))
    }
}

/// Returns the names of all formats, for `--format`.
pub(crate) fn names() -> Vec<&'static str> {
    let imprints = ImprintFormat::ALL.iter().map(|format| format.name());
    let drawings = DrawingFormat::ALL.iter().map(|format| format.name());
    imprints.chain(drawings).collect()
}

/// A file to write.
#[derive(Clone, Debug)]
pub(crate) struct Export {
    /// Its path; None for standard output.
    pub(crate) path: Option<PathBuf>,
    /// The format that is written.
    pub(crate) format: ExportFormat,
    /// Whether an existing file is replaced.
    pub(crate) existing: Existing,
}

impl Export {
    /// Creates an export to `path`, or to standard output for `-`, in the format named by `format`, or else by the
    /// path's extension.
    ///
    /// # Errors
    /// Returns a message if neither names a format.
    pub(crate) fn new(
        path: &Path,
        format: Option<&str>,
        existing: Existing,
    ) -> Result<Self, String> {
        let format = match format {
            Some(name) => ExportFormat::of(name),
            None => ExportFormat::of_ending(path),
        };
        let is_standard = path.as_os_str() == "-";
        let format = format.ok_or_else(|| {
            if is_standard {
                return "writing to standard output needs '--format'".to_owned();
            }
            format!(
                "'{}': expected a name that ends in .txt, .pbm, .csv, .npy, .svg or .png, or a '--format'",
                path.display()
            )
        })?;
        Ok(Self {
            path: (!is_standard).then(|| path.to_owned()),
            format,
            existing,
        })
    }

    /// Returns true if it is a drawing.
    pub(crate) fn is_drawing(&self) -> bool {
        matches!(self.format, ExportFormat::Drawing(_))
    }
}

/// Returns the extension of a file's name in lower case; empty if there is none.
pub(crate) fn ending(path: &Path) -> String {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.map_or_else(String::new, str::to_ascii_lowercase)
}
