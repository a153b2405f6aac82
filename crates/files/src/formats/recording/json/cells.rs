//! Reads the cells of a frame from a JSON list.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, SeqAccess, Visitor};

use crate::formats::job::too_large;
use crate::frame::{LARGEST_VALUE, MAX_FRAME_CELLS};
use crate::parameter::number::counted;

/// Reads a list of rows or of cells. Lists inside it are rows only if there is a counter of rows.
pub(super) struct CellsSeed<'a>(
    pub(super) &'a mut Vec<f64>,
    pub(super) Option<&'a mut usize>,
);

impl<'de> DeserializeSeed<'de> for CellsSeed<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for CellsSeed<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of numbers, or of rows of them")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let Self(values, mut rows) = self;
        let (mut width, mut cells) = (None, false);
        loop {
            let before = values.len();
            let Some(is_row) = list.next_element_seed(CellSeed(values, rows.is_some()))? else {
                return Ok(());
            };
            // Before it takes memory.
            if values.len() > MAX_FRAME_CELLS {
                return Err(A::Error::custom("more than 512 × 512 cells"));
            }
            cells |= !is_row;
            let Some(rows) = rows.as_mut().filter(|_| is_row) else {
                if width.is_some() {
                    return Err(A::Error::custom("rows and numbers in one list"));
                }
                continue;
            };
            **rows += 1;
            let found = values.len() - before;
            let expected = *width.get_or_insert(found);
            if found != expected || cells {
                let row = **rows;
                let found = counted(found as u64, "value");
                let message = format!("row {row} has {found}, expected {expected}");
                return Err(A::Error::custom(message));
            }
        }
    }
}

/// Reads a number, null, or a row of these; returns true for a row.
struct CellSeed<'a>(&'a mut Vec<f64>, bool);

impl<'de> DeserializeSeed<'de> for CellSeed<'_> {
    type Value = bool;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<bool, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for CellSeed<'_> {
    type Value = bool;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or null")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<bool, E> {
        if value.abs() > LARGEST_VALUE {
            return Err(E::custom(too_large(value)));
        }
        self.0.push(value);
        Ok(false)
    }

    #[expect(clippy::cast_precision_loss, reason = "the nearest float")]
    fn visit_u64<E: Error>(self, value: u64) -> Result<bool, E> {
        self.0.push(value as f64);
        Ok(false)
    }

    #[expect(clippy::cast_precision_loss, reason = "the nearest float")]
    fn visit_i64<E: Error>(self, value: i64) -> Result<bool, E> {
        self.0.push(value as f64);
        Ok(false)
    }

    fn visit_unit<E: Error>(self) -> Result<bool, E> {
        self.0.push(f64::NAN);
        Ok(false)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<bool, A::Error> {
        if !self.1 {
            return Err(A::Error::custom(
                "a list inside a row, expected a number or null",
            ));
        }
        CellsSeed(self.0, None).visit_seq(list)?;
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formats::json;

    /// Returns the cells and the number of rows of a list, or the error.
    fn cells(text: &str) -> Result<(Vec<f64>, usize), String> {
        let (mut values, mut rows) = (Vec::new(), 0);
        let mut list = serde_json::Deserializer::from_str(text);
        CellsSeed(&mut values, Some(&mut rows))
            .deserialize(&mut list)
            .map_err(|error| json::message(&error))?;
        Ok((values, rows))
    }

    #[test]
    fn a_list_has_rows_or_cells() {
        assert_eq!(cells("[1,2.5,-3]"), Ok((vec![1.0, 2.5, -3.0], 0)));
        assert_eq!(cells("[[1,2],[3,4]]"), Ok((vec![1.0, 2.0, 3.0, 4.0], 2)));
        assert!(cells("[null]").expect("a cell").0[0].is_nan());
        for (text, error) in [
            ("[[1,2],[3]]", "row 2 has 1 value, expected 2"),
            ("[[1],2]", "rows and numbers in one list"),
            ("[1,[2]]", "row 1 has 1 value, expected 1"),
            ("[[[1]]]", "a list inside a row, expected a number or null"),
            (
                "[\"1\"]",
                "invalid type: string \"1\", expected a number or null",
            ),
        ] {
            assert_eq!(cells(text), Err(error.to_owned()), "{text}");
        }
    }

    #[test]
    fn a_frame_has_at_most_512_rows_of_512_cells() {
        let list = |count: usize| format!("[{}0]", "0,".repeat(count - 1));
        assert!(cells(&list(MAX_FRAME_CELLS)).is_ok());
        let error = cells(&list(MAX_FRAME_CELLS + 1));
        assert_eq!(error, Err("more than 512 × 512 cells".to_owned()));
    }
}
