//! An imprint with its descriptors as JSON: the answer of `taxel batch` and of `--json`.

use serde::ser::{Serialize, SerializeMap, SerializeSeq, Serializer};

use crate::description::{DESCRIPTORS, Description, each_region};
use crate::imprint::Imprint;

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
