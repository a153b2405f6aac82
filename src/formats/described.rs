//! An imprint with its descriptors as JSON: the answer of `taxel batch` and of `--json`.

use serde::ser::{Error, Serialize, SerializeMap, SerializeSeq, Serializer};

use crate::description::{DESCRIPTORS, Description, Value, each_region};
use crate::imprint::Imprint;

/// An imprint that serialises as `{"imprint":[…],"na":…,"regions":[{"kind":…,…},…]}`.
///
/// ```
/// use taxel::formats::DescribedImprint;
/// use taxel::prelude::*;
/// let one: Imprint = "..\n.#".parse().unwrap();
/// let json = serde_json::to_string(&DescribedImprint(&one)).unwrap();
/// assert!(json.starts_with(r#"{"imprint":["..",".#"],"na":1,"regions":[{"kind":"exterior","na":1,"nae":1,"ce":1,"#));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct DescribedImprint<'a>(pub &'a Imprint);

impl Serialize for DescribedImprint<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(3))?;
        map.serialize_entry("imprint", &Rows(self.0))?;
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

/// An imprint as a list of its rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rows<'a>(pub &'a Imprint);

impl Serialize for Rows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let columns = self.0.columns();
        let words = self.0.words().iter();
        serializer.collect_seq(words.map(|&word| ImprintRow { word, columns }))
    }
}

/// A row of an imprint as a text.
struct ImprintRow {
    word: u64,
    columns: u8,
}

impl Serialize for ImprintRow {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        /// Most rows of an imprint are empty, so their text is ready.
        const EMPTY: &str = "................................................................";
        let columns = usize::from(self.columns);
        if self.word == 0 {
            return serializer.serialize_str(&EMPTY[..columns]);
        }
        let mut row = [b'.'; EMPTY.len()];
        let row = &mut row[..columns];
        for (column, byte) in row.iter_mut().enumerate() {
            *byte = if self.word >> column & 1 == 1 {
                b'#'
            } else {
                b'.'
            };
        }
        serializer.serialize_str(str::from_utf8(row).map_err(S::Error::custom)?)
    }
}

/// A region as an object of its descriptors.
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

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match *self {
            Self::None => serializer.serialize_none(),
            Self::Count(count) => serializer.serialize_u32(count),
            Self::Number(number) => serializer.serialize_f64(number),
            Self::Point(point) => [point.x, point.y].serialize(serializer),
            Self::Pair(pair) => pair.serialize(serializer),
            Self::Rect(rect) => {
                let mut map = serializer.serialize_map(Some(4))?;
                map.serialize_entry("left", &rect.left)?;
                map.serialize_entry("top", &rect.top)?;
                map.serialize_entry("right", &rect.right)?;
                map.serialize_entry("bottom", &rect.bottom)?;
                map.end()
            }
        }
    }
}
