//! What is done with hostile bytes: by property tests here, by the fuzz targets in `fuzz/`. Each must end without a
//! panic, whatever the bytes are; and what is read must come back the same when it is written and read again.

use taxel::formats::answer::Answer;
use taxel::formats::job::Job;
use taxel::formats::shape::Shape;
use taxel::imprint::Imprint;
use taxel::sensor::Sensor;
use taxel::touch::Plane;
use taxel::tui::key::parse;

/// No message is longer, however long the input that it quotes.
const LONGEST_MESSAGE: usize = 1000;

fn is_short(message: &str) {
    let length = message.chars().count();
    assert!(
        length <= LONGEST_MESSAGE,
        "a message of {length} characters"
    );
}

/// A file of the library.
pub(crate) fn shape(bytes: &[u8]) {
    match Shape::read(bytes) {
        Ok(shape) => {
            let again = Shape::read(shape.write().as_bytes());
            assert_eq!(again.as_ref(), Ok(&shape));
        }
        Err(error) => is_short(&error.to_string()),
    }
}

/// A line of `taxel batch`.
pub(crate) fn job(bytes: &[u8]) {
    let lookup = |name: &str| match name {
        "washer" => Ok(Imprint::empty(16, 16)),
        _ => Err("no shape is called so".to_owned()),
    };
    match Job::read(bytes, Sensor::default(), &lookup) {
        Ok(job) => {
            let mut plane = Plane::new(Sensor::default());
            let imprint = job.imprint(&mut plane);
            let answer = serde_json::to_string(&Answer(&imprint)).expect("every number is finite");
            assert!(!answer.contains('\n'));
        }
        Err(error) => is_short(&error.to_string()),
    }
}

/// An imprint as text.
pub(crate) fn imprint(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else {
        return;
    };
    match text.parse::<Imprint>() {
        Ok(imprint) => assert_eq!(imprint.to_string().parse(), Ok(imprint)),
        Err(error) => is_short(&error.to_string()),
    }
}

/// Keys in notation.
pub(crate) fn keys(bytes: &[u8]) {
    let Ok(text) = str::from_utf8(bytes) else {
        return;
    };
    match parse(text) {
        // The way back takes longer, and is no other where there are more.
        Ok(keys) if keys.len() > 10_000 => {}
        Ok(keys) => {
            let written: String = keys.iter().map(ToString::to_string).collect();
            assert_eq!(parse(&written).as_ref(), Ok(&keys), "{written:?}");
        }
        Err(error) => is_short(&error.to_string()),
    }
}
