//! The shapes that come with the program, compiled in. They were made with the program itself, by `library/make`.

use crate::formats::{Name, StoredShape};

macro_rules! shapes {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../../../library/", $name, ".json")))),*]
    };
}

const SHIPPED: [(&str, &str); 28] = shapes![
    "arrow",
    "bar",
    "bracket",
    "button",
    "clover",
    "cross",
    "dice five",
    "disc",
    "flange",
    "frame",
    "gear",
    "hexagon bar",
    "key",
    "letter A",
    "letter B",
    "letter C",
    "letter E",
    "nut",
    "oval ring",
    "pentagon",
    "ring and dot",
    "saltire",
    "slot plate",
    "smile",
    "star",
    "triangle ring",
    "two pins",
    "washer",
];

/// Iterates over their names, in alphabetical order.
pub fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|&(name, _)| name)
}

/// The name, as its file has it, and the content of the shape of that name, regardless of case; None if no shape of that
/// name comes with the program.
pub(crate) fn text(name: &Name) -> Option<(&'static str, &'static str)> {
    SHIPPED.into_iter().find(|(shipped, _)| name.same(shipped))
}

/// The shape of that name, regardless of case; None if no shape of that name comes with the program.
///
/// ```
/// use taxel_files::storage::shipped;
///
/// let washer = shipped::get("Washer").expect("it is shipped");
/// assert_eq!(washer.name.as_str(), "washer");
/// assert!(shipped::get("wrench").is_none());
/// ```
pub fn get(name: &str) -> Option<StoredShape> {
    let (_, text) = text(&Name::new(name).ok()?)?;
    StoredShape::read(text.as_bytes()).ok()
}

/// Iterates over all shapes, by name.
pub fn all() -> impl Iterator<Item = StoredShape> {
    names().filter_map(get)
}
