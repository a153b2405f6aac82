//! Compares answers with those of independent software. The file with these answers is not part of the project.
//!
//! `TAXEL_REFERENCE` names the file, which must then exist. Otherwise a file beside the project's folder is read, if
//! there is one.

use std::path::PathBuf;

use serde_json::Value;
use taxel_core::sensor::Sensor;
use taxel_core::touch::Plane;
use taxel_files::formats::{DescribedImprint, Job};

use crate::skip::skipped;

#[test]
fn every_reference_pose_has_the_same_answer() {
    let given = std::env::var_os("TAXEL_REFERENCE").map(PathBuf::from);
    let must = given.is_some();
    let beside = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../shared/reference/poses.jsonl"
    );
    let path = given.unwrap_or_else(|| PathBuf::from(beside));
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) => {
            assert!(!must, "TAXEL_REFERENCE: {}: {error}", path.display());
            skipped(&format!(
                "there are no reference poses at {}",
                path.display()
            ));
            return;
        }
    };
    let mut plane = Plane::new(Sensor::default());
    let mut differing = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let case: Value = serde_json::from_str(line).expect("a reference line is JSON");
        let job = case["job"].to_string();
        let read = Job::read(job.as_bytes(), Sensor::default(), None, &|_| {
            Err("no names here".to_owned())
        });
        let imprint = read.expect("a reference job is valid").imprint(&mut plane);
        let answer = serde_json::to_value(DescribedImprint(&imprint)).expect("an answer is JSON");
        if let Some(difference) = difference(&answer, &case["answer"]) {
            differing.push(format!("line {}: {job}: {difference}", number + 1));
        }
    }
    assert!(
        differing.is_empty(),
        "{} differ\n{}",
        differing.len(),
        differing.join("\n")
    );
    assert!(
        text.lines().count() >= 600,
        "the file of reference poses is cut short"
    );
}

/// Describes how two answers differ: numbers with a fraction may differ by 1e-9, everything else must be equal.
fn difference(found: &Value, expected: &Value) -> Option<String> {
    match (found, expected) {
        (Value::Number(a), Value::Number(b)) if a.is_f64() || b.is_f64() => {
            let (a, b) = (a.as_f64()?, b.as_f64()?);
            ((a - b).abs() > 1e-9).then(|| format!("{a} instead of {b}"))
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => a
            .iter()
            .zip(b)
            .enumerate()
            .find_map(|(i, (a, b))| difference(a, b).map(|text| format!("[{i}] {text}"))),
        (Value::Object(a), Value::Object(b)) if a.keys().eq(b.keys()) => a
            .iter()
            .zip(b)
            .find_map(|((key, a), (_, b))| difference(a, b).map(|text| format!("{key}: {text}"))),
        (a, b) => (a != b).then(|| format!("{a} instead of {b}")),
    }
}
