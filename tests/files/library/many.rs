//! Ten thousand shapes. The times are printed, not checked: a busy machine is not a failure.

use std::time::Instant;

use taxel::storage::Library;

use super::Scratch;
use super::shape;

#[test]
fn ten_thousand_shapes_are_listed_and_any_of_them_is_loaded() {
    let scratch = Scratch::new();
    let content = shape("any", 1).write();
    for number in 0..10_000 {
        scratch.put(&format!("shape {number:05}.json"), &content);
    }
    let start = Instant::now();
    let library = Library::open(scratch.folder.clone());
    let opened = start.elapsed();
    let start = Instant::now();
    let entries = library.list().expect("listed");
    let listed = start.elapsed();
    let shipped = taxel::storage::shipped::names().count();
    assert_eq!(entries.len(), 10_000 + shipped);
    assert_eq!(entries[0].name, "shape 00000");
    let start = Instant::now();
    let loaded = library.load("shape 07321").expect("loaded");
    let found = start.elapsed();
    assert_eq!(loaded.shape.name.as_str(), "shape 07321");
    let start = Instant::now();
    assert!(library.load("SHAPE 07321").is_ok());
    let searched = start.elapsed();
    eprintln!(
        "10,000 shapes: opened in {opened:?}, listed in {listed:?}, one loaded in {found:?}, in another case in \
         {searched:?}"
    );
}
