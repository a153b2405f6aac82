//! Reads a JSON object as a type that serde derives.

use std::fmt;

use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, forward_to_deserialize_any};

/// Reads an object. A type that serde derives would take a list, too, as its keys in the order of the source code.
///
/// # Errors
/// Returns the error of the parser if the text is not one object of this type.
pub fn read<'a, T: Deserialize<'a>>(text: &'a [u8]) -> serde_json::Result<T> {
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
    use crate::formats::json::message;

    #[test]
    fn a_list_is_not_an_object() {
        #[derive(Debug, PartialEq, Deserialize)]
        struct Keys {
            name: String,
        }
        let keys = |text: &str| read::<Keys>(text.as_bytes()).map_err(|error| message(&error));
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
