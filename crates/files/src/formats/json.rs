//! Values as JSON text, objects read from it, Python's `NaN`; an imprint with its descriptors, the answer of
//! `taxel batch` and of `--json`.

use std::borrow::Cow;
use std::io::{self, Write};

use serde::de::{DeserializeOwned, Error};
use serde::ser::{SerializeMap, SerializeSeq, Serializer};
use serde::{Deserialize, Serialize};
use taxel_core::description::{DESCRIPTORS, Description, each_region};
use taxel_core::imprint::Imprint;
use taxel_core::quote::{did_you_mean, is_invisible, shortened_message};

use crate::error::ReadError;

/// Why no value of these crates fails to be written.
const WRITABLE: &str = "keys are texts, and memory takes every byte";

/// Returns a value as JSON on one line.
pub fn text(value: &(impl Serialize + ?Sized)) -> String {
    serde_json::to_string(value).expect(WRITABLE)
}

/// Returns a value as JSON over several lines.
pub fn pretty(value: &(impl Serialize + ?Sized)) -> String {
    serde_json::to_string_pretty(value).expect(WRITABLE)
}

/// Returns a value as JSON on one line, with everything except ASCII escaped: the same bytes in every locale, and
/// safe to print even if it quotes text from files.
pub fn ascii(value: &(impl Serialize + ?Sized)) -> String {
    let mut text = Vec::new();
    extend_ascii(&mut text, value);
    String::from_utf8_lossy(&text).into_owned()
}

/// Appends a value to a text, as [`ascii`] writes it.
pub fn extend_ascii(text: &mut Vec<u8>, value: &(impl Serialize + ?Sized)) {
    let mut writer = serde_json::Serializer::with_formatter(text, AsciiFormatter);
    value.serialize(&mut writer).expect(WRITABLE);
}

/// Writes JSON in ASCII. Other characters occur only inside strings, where `\u` can replace them.
struct AsciiFormatter;

impl serde_json::ser::Formatter for AsciiFormatter {
    fn write_string_fragment<W: ?Sized + Write>(
        &mut self,
        writer: &mut W,
        fragment: &str,
    ) -> io::Result<()> {
        if fragment.bytes().all(|byte| matches!(byte, b' '..=b'~')) {
            return writer.write_all(fragment.as_bytes());
        }
        for unit in fragment.encode_utf16() {
            match u8::try_from(unit) {
                Ok(byte @ b' '..=b'~') => writer.write_all(&[byte])?,
                _ => write!(writer, "\\u{unit:04x}")?,
            }
        }
        Ok(())
    }

    fn write_raw_fragment<W: ?Sized + Write>(
        &mut self,
        writer: &mut W,
        fragment: &str,
    ) -> io::Result<()> {
        self.write_string_fragment(writer, fragment)
    }
}

/// A line with `null` for each `NaN`: Python writes it, although JSON has no such number.
fn without_nan(line: &[u8]) -> Cow<'_, [u8]> {
    if !line.windows(3).any(|word| word == b"NaN") {
        return Cow::Borrowed(line);
    }
    let mut own = Vec::with_capacity(line.len() + 64);
    let (mut in_text, mut escaped) = (false, false);
    let mut rest = line;
    while let [byte, after @ ..] = rest {
        if !in_text && let Some(after) = rest.strip_prefix(b"NaN") {
            own.extend_from_slice(b"null");
            rest = after;
            continue;
        }
        in_text ^= *byte == b'"' && !escaped;
        escaped = in_text && *byte == b'\\' && !escaped;
        own.push(*byte);
        rest = after;
    }
    Cow::Owned(own)
}

/// Returns what is wrong with a JSON text, without the position, which callers report. Where a name is like one of those
/// that are expected, only that one is named.
pub fn message(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let end = text.rfind(" at line ").unwrap_or(text.len());
    let text = text[..end]
        .replace(|c: char| c.is_control() || is_invisible(c), "\u{fffd}")
        .replacen(" field `", " key `", 1)
        .replacen(" variant `", " value `", 1)
        .replacen("a nonzero u32", "a whole number from 1 to 4294967295", 1);
    // As in: unknown key `lenght`, expected one of `length`, `width`
    let mut parts = text.split('`');
    if let (Some(unknown), Some(found)) = (parts.next(), parts.next())
        && text.contains("expected one of")
    {
        let meant = did_you_mean(found, parts.skip(1).step_by(2));
        if !meant.is_empty() {
            return format!("{unknown}{found:?}{meant}");
        }
    }
    shortened_message(&text)
}

/// Reads an object. A type that serde derives would take a list, too, as its keys in the order of the source code.
///
/// # Errors
/// Returns the error of the parser if the text is not one object of this type.
pub fn object<'a, T: Deserialize<'a>>(text: &'a [u8]) -> serde_json::Result<T> {
    if !text.trim_ascii_start().starts_with(b"{") {
        return Err(serde_json::Error::custom("not a JSON object"));
    }
    serde_json::from_slice(text)
}

/// Reads an object from a line. An error names the column; which line it is, only the caller knows.
///
/// # Errors
/// Returns the error of the parser if the line is not one object of this type.
pub fn of_line<'a, T: Deserialize<'a>>(line: &'a [u8]) -> Result<T, ReadError> {
    object(line).map_err(|error| ReadError {
        line: None,
        ..error.into()
    })
}

/// Reads an object from a line that may have Python's `NaN`. An error in a line that has one names no column: it would
/// be that of the changed line.
///
/// # Errors
/// Those of [`of_line`].
pub fn of_line_with_nan<T: DeserializeOwned>(line: &[u8]) -> Result<T, ReadError> {
    let plain = without_nan(line);
    of_line(&plain).map_err(|error| match plain {
        Cow::Borrowed(_) => error,
        Cow::Owned(_) => ReadError {
            column: None,
            ..error
        },
    })
}

/// An imprint that serialises as `{"imprint":[…],"na":…,"regions":[{"kind":…,…},…]}`.
///
/// ```
/// use taxel_files::formats::DescribedImprint;
/// use taxel_core::prelude::*;
/// let one: Imprint = "..\n.#".parse().unwrap();
/// let json = serde_json::to_string(&DescribedImprint(&one)).unwrap();
/// assert!(json.starts_with(r#"{"imprint":["..",".#"],"na":1,"regions":[{"kind":"exterior","na":1,"nae":1,"ce":1,"#));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct DescribedImprint<'a>(pub &'a Imprint);

impl Serialize for DescribedImprint<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3))?;
        map.serialize_entry("imprint", self.0)?;
        map.serialize_entry("na", &self.0.count())?;
        map.serialize_entry("regions", &Regions(self.0))?;
        map.end()
    }
}

/// The regions of an imprint as a list, serialised one by one: a batch describes millions of imprints.
struct Regions<'a>(&'a Imprint);

impl Serialize for Regions<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut list = serializer.serialize_seq(None)?;
        let mut written = Ok(());
        each_region(self.0, |region| {
            if written.is_ok() {
                written = list.serialize_element(&RegionRecord(Description::of(region)));
            }
        });
        written?;
        list.end()
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct RegionRecord(pub Description);

impl Serialize for RegionRecord {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("kind", self.0.kind.name())?;
        for descriptor in DESCRIPTORS.iter().filter(|descriptor| descriptor.in_answer) {
            map.serialize_entry(descriptor.key, &(descriptor.measure)(&self.0))?;
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_not_an_object() {
        #[derive(Debug, PartialEq, Deserialize)]
        struct Keys {
            name: String,
        }
        let keys = |text: &str| object::<Keys>(text.as_bytes()).map_err(|error| message(&error));
        let name = "a".to_owned();
        assert_eq!(keys("{\"name\":\"a\"} "), Ok(Keys { name }));
        for text in ["[\"a\"]", "[]", "3", "", "{}", "{\"name\":\"a\"}]"] {
            assert!(keys(text).is_err(), "{text}");
        }
    }
}
