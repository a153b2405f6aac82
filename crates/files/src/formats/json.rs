//! Values as JSON text, Python's `NaN`, and the messages of the parser without positions, which callers report
//! themselves.

use std::borrow::Cow;
use std::fmt;
use std::io::{self, Write};

use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, forward_to_deserialize_any};

use crate::quote::shortened_message;

/// Returns a value as JSON on one line.
pub fn text(value: &(impl Serialize + ?Sized)) -> String {
    serde_json::to_string(value).unwrap_or_else(|error| failure(&error))
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
    let start = text.len();
    let mut writer = serde_json::Serializer::with_formatter(&mut *text, AsciiFormatter);
    if let Err(error) = value.serialize(&mut writer) {
        text.truncate(start);
        text.extend(failure(&error).bytes());
    }
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

/// Returns a value as JSON over several lines.
pub fn pretty(value: &(impl Serialize + ?Sized)) -> String {
    serde_json::to_string_pretty(value).unwrap_or_else(|error| failure(&error))
}

/// Returns what was written as JSON in memory, for a file. It cannot fail: the keys of all values of this crate are texts.
pub fn written(text: serde_json::Result<Vec<u8>>) -> Vec<u8> {
    text.expect("keys are texts, and memory takes every byte")
}

/// Returns an object with the error, for a value that cannot be written as JSON. All values of this crate can be
/// written: their keys are texts and their numbers finite. If one ever fails, the error takes its place, as in the
/// answers of a batch, so nobody mistakes it for an empty answer.
fn failure(error: &serde_json::Error) -> String {
    format!("{{\"error\":{:?}}}", error.to_string())
}

/// A line in which each `NaN` is replaced by `null`: Python writes it, although JSON has no such number.
#[derive(Debug)]
pub struct WithoutNan<'a> {
    /// The line, which is JSON as far as numbers are concerned.
    pub line: Cow<'a, [u8]>,
    /// The positions of the replaced words, which are longer now.
    replaced: Vec<usize>,
}

impl<'a> WithoutNan<'a> {
    /// Replaces the words.
    pub fn new(line: &'a [u8]) -> Self {
        let mut replaced = Vec::new();
        if !line.windows(3).any(|word| word == b"NaN") {
            let line = Cow::Borrowed(line);
            return Self { line, replaced };
        }
        let mut own = Vec::with_capacity(line.len() + 64);
        let (mut in_text, mut escaped) = (false, false);
        let mut rest = line;
        while let [byte, after @ ..] = rest {
            if !in_text && let Some(after) = rest.strip_prefix(b"NaN") {
                replaced.push(own.len());
                own.extend_from_slice(b"null");
                rest = after;
                continue;
            }
            in_text ^= *byte == b'"' && !escaped;
            escaped = in_text && *byte == b'\\' && !escaped;
            own.push(*byte);
            rest = after;
        }
        Self {
            line: Cow::Owned(own),
            replaced,
        }
    }

    /// Converts a column of this line to one of the original line, both from 1.
    pub fn column(&self, column: usize) -> usize {
        let before = self.replaced.iter().filter(|&&start| start + 4 < column);
        column - before.count()
    }
}

/// Returns what is wrong with a JSON text, in words that require no knowledge of the parser, and without the
/// position, which callers report.
pub fn message(error: &serde_json::Error) -> String {
    shortened_message(&plain(&error.to_string()))
}

/// Returns what is wrong with a line that should be a JSON object: its [`message`], or that it is not JSON at all.
/// `expected` describes the object.
pub fn message_of_line(line: &[u8], error: &serde_json::Error, expected: &str) -> String {
    match message(error) {
        text if text == VALUE && !line.trim_ascii_start().starts_with(b"{") => {
            format!("not JSON, expected {expected}")
        }
        text => text,
    }
}

/// Rewrites a message of the parser in our words. Messages that are ours already are returned as they are.
pub fn plain(text: &str) -> String {
    let text = text.rfind(" at line ").map_or(text, |end| &text[..end]);
    let known = PARSER.iter().find(|(theirs, _)| *theirs == text);
    if let Some((_, ours)) = known {
        return (*ours).to_owned();
    }
    let quoted = |start: &str| text.strip_prefix(start)?.strip_suffix('`');
    if let Some(key) = quoted("duplicate field `") {
        return format!("{key}: given twice");
    }
    if let Some(key) = quoted("missing field `") {
        return format!("{key}: missing");
    }
    let types = ["invalid type: ", "invalid value: "];
    let mismatch = types.into_iter().find_map(|start| text.strip_prefix(start));
    match mismatch.and_then(|rest| rest.rsplit_once(", expected ")) {
        Some((found, expected)) => {
            format!("found {}, expected {}", noun(found), kind(expected))
        }
        None => text.to_owned(),
    }
}

/// The parser's messages for text that is not JSON, and ours.
const PARSER: [(&str, &str); 20] = [
    ("expected ident", VALUE),
    ("expected value", VALUE),
    (
        "EOF while parsing a value",
        "the text ends, expected a value",
    ),
    (
        "EOF while parsing a string",
        "the text ends inside a string, expected a closing quote",
    ),
    (
        "EOF while parsing an object",
        "the text ends inside an object, expected '}'",
    ),
    (
        "EOF while parsing a list",
        "the text ends inside a list, expected ']'",
    ),
    ("expected `:`", "expected ':' after a key"),
    ("expected `,` or `}`", "expected ',' or '}'"),
    ("expected `,` or `]`", "expected ',' or ']'"),
    ("expected `\"`", "expected a string in double quotes"),
    (
        "expected double quote",
        "expected a string in double quotes",
    ),
    ("key must be a string", "expected a key in double quotes"),
    (
        "trailing comma",
        "expected another value after the comma, or no comma",
    ),
    (
        "trailing characters",
        "more text after the end, expected one object",
    ),
    ("invalid number", "expected a number such as 3, 0.5 or 1e-3"),
    ("number out of range", "a number too large"),
    (
        "invalid escape",
        "an escape that JSON does not have, expected one such as \\n or \\u00e9",
    ),
    (
        "invalid unicode code point",
        "not UTF-8, or an escape of no character",
    ),
    (
        "control character (\\u0000-\\u001F) found while parsing a string",
        "a control character in a string, expected an escape such as \\n",
    ),
    (
        "recursion limit exceeded",
        "lists or objects nested too deeply",
    ),
];

/// The message for a missing value.
const VALUE: &str = "expected a value: a string in double quotes, a number, a list or an object";

/// Returns the name of a found value in plain words: `string "3"` becomes `the string "3"`.
fn noun(found: &str) -> String {
    let value = |start: &str| found.strip_prefix(start)?.strip_suffix('`');
    let number = value("integer `").or_else(|| value("floating point `"));
    if let Some(number) = number {
        return format!("the number {number}");
    }
    if let Some(truth) = value("boolean `") {
        return truth.to_owned();
    }
    match found {
        "map" => "an object".to_owned(),
        "sequence" => "a list".to_owned(),
        "unit value" => "null".to_owned(),
        _ => match found.strip_prefix("string ") {
            Some(text) => format!("the string {text}"),
            None => found.to_owned(),
        },
    }
}

/// Returns the name of an expected value in plain words; types have plain names, and other words stay as they are.
fn kind(expected: &str) -> &str {
    match expected {
        "f64" | "f32" => "a number",
        "u8" => "a whole number from 0 to 255",
        "u32" => "a whole number from 0 to 4294967295",
        "a nonzero u32" => "a whole number from 1 to 4294967295",
        "u16" | "u64" | "usize" => "a whole number, 0 or more",
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number",
        "a borrowed string" => "a string",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        "a map" => "an object",
        other if other.starts_with("struct ") => "an object",
        other => other,
    }
}

/// Reads an object. A type that serde derives would take a list, too, as its keys in the order of the source code.
///
/// # Errors
/// Returns the error of the parser if the text is not one object of this type.
pub fn object<'a, T: Deserialize<'a>>(text: &'a [u8]) -> serde_json::Result<T> {
    let mut parser = serde_json::Deserializer::from_slice(text);
    let object = T::deserialize(ObjectOnly(&mut parser))?;
    parser.end()?;
    Ok(object)
}

/// A parser, or the visitor of a type, for objects only.
struct ObjectOnly<T>(T);

impl<'de, D: Deserializer<'de>> Deserializer<'de> for ObjectOnly<D> {
    type Error = D::Error;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, D::Error> {
        self.0.deserialize_map(ObjectOnly(visitor))
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
        newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

impl<'de, V: Visitor<'de>> Visitor<'de> for ObjectOnly<V> {
    type Value = V::Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.expecting(f)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<V::Value, A::Error> {
        self.0.visit_map(map)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    #[test]
    fn messages_are_in_our_words() {
        let object = |text: &str| {
            let read = serde_json::from_str::<BTreeMap<String, f64>>(text);
            message(&read.expect_err("no object of numbers"))
        };
        for (text, expected) in [
            ("", "the text ends, expected a value"),
            ("nonsense", VALUE),
            ("{\"a\":nonsense}", VALUE),
            ("{\"a\":x}", VALUE),
            ("{", "the text ends inside an object, expected '}'"),
            (
                "{\"a",
                "the text ends inside a string, expected a closing quote",
            ),
            ("{\"a\" 1}", "expected ':' after a key"),
            ("{\"a\":1 2}", "expected ',' or '}'"),
            ("{1:2}", "expected a key in double quotes"),
            (
                "{\"a\":1,}",
                "expected another value after the comma, or no comma",
            ),
            ("{} {}", "more text after the end, expected one object"),
            ("{\"a\":1.}", "expected a number such as 3, 0.5 or 1e-3"),
            ("{\"a\":1e999}", "a number too large"),
            ("{\"a\":\"3\"}", "found the string \"3\", expected a number"),
            ("{\"a\":null}", "found null, expected a number"),
            ("{\"a\":true}", "found true, expected a number"),
            ("{\"a\":[1]}", "found a list, expected a number"),
            ("{\"a\":{}}", "found an object, expected a number"),
            ("3", "found the number 3, expected an object"),
            ("-3.5", "found the number -3.5, expected an object"),
            (
                "{\"a\n\":1}",
                "a control character in a string, expected an escape such as \\n",
            ),
            (
                "{\"a\\q\":1}",
                "an escape that JSON does not have, expected one such as \\n or \\u00e9",
            ),
        ] {
            assert_eq!(object(text), expected, "{text}");
        }
        let list = serde_json::from_str::<Vec<u8>>("[1").expect_err("no list");
        assert_eq!(message(&list), "the text ends inside a list, expected ']'");
        assert_eq!(
            plain("side: 99 is out of range"),
            "side: 99 is out of range"
        );
    }
    #[test]
    fn a_value_without_a_json_form_is_an_error_object() {
        let no_text_key = BTreeMap::from([((1, 2), 3)]);
        assert_eq!(text(&no_text_key), r#"{"error":"key must be a string"}"#);
        assert_eq!(text(&[1, 2]), "[1,2]");
    }

    #[test]
    fn a_list_is_not_an_object() {
        #[derive(Debug, PartialEq, Deserialize)]
        struct Keys {
            name: String,
        }
        let keys = |text: &str| object::<Keys>(text.as_bytes()).map_err(|error| message(&error));
        let name = "a".to_owned();
        assert_eq!(keys("{\"name\":\"a\"} "), Ok(Keys { name }));
        for (text, expected) in [
            ("[\"a\"]", "found a list, expected an object"),
            ("[]", "found a list, expected an object"),
            ("3", "found the number 3, expected an object"),
            ("{}", "name: missing"),
            (
                "{\"name\":\"a\"}]",
                "more text after the end, expected one object",
            ),
        ] {
            assert_eq!(keys(text), Err(expected.to_owned()), "{text}");
        }
    }
}
