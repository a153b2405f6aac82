//! The bodies of the property tests, compiled once for all targets.

#[path = "../../tests/files/hostile/bodies/mod.rs"]
#[allow(dead_code, unused_imports, reason = "the property tests use more of it")]
mod bodies;

/// Passes bytes to the body with this name.
///
/// # Panics
/// Panics if there is no such body, or if a property does not hold.
pub fn run(name: &str, bytes: &[u8]) {
    bodies::body(name)(bytes);
}
