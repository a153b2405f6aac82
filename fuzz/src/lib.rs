//! The bodies of the property tests, compiled once for all targets.

#[path = "../../tests/files/hostile/bodies/mod.rs"]
#[allow(dead_code, unused_imports, reason = "the property tests use more of it")]
mod bodies;

/// Gives bytes to the body of that name.
///
/// # Panics
/// If there is none, or if something does not hold that should.
pub fn run(name: &str, bytes: &[u8]) {
    bodies::body(name)(bytes);
}
