//! Compares frames of real sensors with the answers of independent software, if these files are available; they are
//! not part of the project.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde_json::Value;
use taxel_core::frame::{Crop, FrameError, Label, Peak, Processing, Rule, TareFrames};
use taxel_files::formats::DescribedImprint;
use taxel_files::formats::recording::{ReadOptions, RecordingNote};

use super::{Recorded, frame_size, recorded, recorded_with};
use crate::skip::skipped;

/// Returns the folder of these files; reports the test as skipped if it is missing.
fn folder() -> Option<PathBuf> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/reference"));
    if folder.join("frames.jsonl").is_file() {
        return Some(folder);
    }
    skipped(&format!("there are no recordings at {}", folder.display()));
    None
}

/// Reads a recording to its end; it must have no error.
fn whole(name: &str, shape: Option<(u16, u16)>) -> Option<Recorded> {
    let bytes = std::fs::read(folder()?.join(name)).expect("a file of the reference");
    let mut options = ReadOptions {
        size: shape.map(|(rows, columns)| frame_size(rows, columns)),
        ..ReadOptions::default()
    };
    if name.ends_with("matsense.csv") {
        options.label_column = "785".parse().ok();
        options.time_column = "786:ms".parse().ok();
    }
    let found = recorded_with(&bytes, &options);
    assert!(found.error.is_none(), "{name}: {:?}", found.error);
    Some(found)
}

fn rule(case: &Value) -> Result<(Rule, u32), FrameError> {
    let number = |key: &str| case["rule"][key].as_f64();
    let rule = match (number("at_least"), number("percent")) {
        (Some(threshold), _) => Rule::at_least(threshold),
        (_, Some(percent)) => Rule::percent(percent),
        _ => Rule::hysteresis(
            number("low").expect("a rule"),
            number("high").expect("a rule"),
        ),
    };
    let least = case["rule"]["least"].as_u64().unwrap_or(0);
    Ok((rule?, u32::try_from(least).expect("few")))
}

#[test]
fn every_reference_frame_has_the_same_answer() {
    let Some(folder) = folder() else {
        return;
    };
    let text = std::fs::read_to_string(folder.join("frames.jsonl")).expect("it is a file");
    let mut files = BTreeMap::new();
    for line in text.lines() {
        let case: Value = serde_json::from_str(line).expect("JSON");
        let name = case["file"].as_str().expect("a name").to_owned();
        // The cases of zebris and PoPu remain in the file, but these forms are not read any more.
        if name.contains("/zebris/") || name.contains("/popu/") {
            continue;
        }
        let found = files
            .entry(name.clone())
            .or_insert_with(|| whole(&name, None).expect("it is there"));
        assert_eq!(found.frames.len() as u64, case["frames"], "{name}");
        let mut processing = Processing::default();
        let (rule, least) = rule(&case).expect("in range");
        (processing.rule, processing.least) = (Some(rule), least);
        let tare = case["tare"].as_u64().expect("a number");
        if tare > 0 {
            let mut frames = TareFrames::new(tare);
            for frame in &found.frames {
                frames.add(frame, &processing.view).expect("it fits");
            }
            processing.tare = Some(frames.finish().expect("enough frames"));
        }
        let mut peak = Peak::default();
        for frame in &found.frames {
            let processed = processing.run(frame).expect("it fits");
            peak.add(frame.number, processed.tared_sum);
        }
        assert_eq!(peak.number(), case["peak"].as_u64(), "{name}");
        let index = case["index"].as_u64().expect("a number");
        let frame = &found.frames[usize::try_from(index).expect("small")];
        assert_eq!(
            frame.label.as_ref().and_then(Label::number),
            case["label"].as_i64(),
            "{name}"
        );
        let processed = processing.run(frame).expect("it fits");
        let of = |key: &str| case[key].as_f64().expect(key);
        let cells = processed.raw.values().iter().filter(|own| !own.is_nan());
        assert_eq!(cells.count() as u64, case["cells"], "{name}");
        assert!((processed.sum - of("sum")).abs() < 1e-9, "{name}");
        assert_eq!(processed.max, case["max"].as_f64(), "{name}");
        assert_eq!(
            (
                f64::from(processed.raw.rows()),
                f64::from(processed.raw.columns())
            ),
            (of("rows"), of("columns")),
            "{name}"
        );
        let imprint = processed.imprint.expect("a rule");
        let answer = serde_json::to_value(DescribedImprint(&imprint)).expect("JSON");
        assert!(same(&answer, &case["answer"]), "{line}\n{answer}");
    }
    assert!(text.lines().count() >= 12, "the file is cut short");
}

/// Returns true if two answers are equal; numbers with a fraction may differ by 1e-9.
fn same(found: &Value, expected: &Value) -> bool {
    match (found, expected) {
        (Value::Number(a), Value::Number(b)) => {
            let (a, b) = (a.as_f64(), b.as_f64());
            a.zip(b).is_some_and(|(a, b)| (a - b).abs() <= 1e-9)
        }
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            let key =
                |(key, value): (&String, &Value)| a.get(key).is_some_and(|own| same(own, value));
            a.len() == b.len() && b.iter().all(key)
        }
        (a, b) => a == b,
    }
}

#[test]
fn the_sums_that_tekscan_states_are_right() {
    let Some(found) = whole("data/pressuRe/iscan_test.csv", None) else {
        return;
    };
    // Each frame states its sum, so a reader that misreads a value reports a note.
    assert_eq!((found.frames.len(), found.notes), (309, Vec::new()));
    let info = &found.channels[0];
    assert_eq!(info.unit.as_deref(), Some("raw"));
    assert_eq!(info.pitch_mm, Some([1.27, 1.27]));
    assert_eq!(info.seconds_per_frame, Some(0.1));
    assert_eq!((info.threshold, found.format), (None, Some("tekscan")));
    assert_eq!(found.frames[4].time, Some(0.4));
}

#[test]
fn a_wrong_sum_is_reported_with_the_number_of_its_frame() {
    let Some(folder) = folder() else {
        return;
    };
    let file = folder.join("data/pressuRe/iscan_test.csv");
    let text = std::fs::read_to_string(file).expect("text");
    let found = recorded(
        text.replacen("Raw Sum=,,308", "Raw Sum=,,309", 1)
            .as_bytes(),
        None,
    );
    assert_eq!(found.frames.len(), 309);
    let said = "frame 2 (label 3): Raw Sum should be 309, but the values give 308";
    assert_eq!(found.notes, [RecordingNote::Oddity(said.to_owned())]);
}

#[test]
fn the_peaks_and_means_that_xsensor_states_are_right() {
    let Some(found) = whole("data/xsensor/xsensor_3frames.csv", None) else {
        return;
    };
    let text = std::fs::read(
        folder()
            .expect("it is there")
            .join("data/xsensor/xsensor_3frames.csv"),
    );
    let text = String::from_utf8(text.expect("a file")).expect("UTF-8");
    // Frames of sensors come before those of groups, which have no rows.
    let mut stated = Vec::new();
    for block in text.split("SENSOR,").skip(1) {
        let value = |key: &str| -> f64 {
            let rest = block.split_once(key).expect(key).1;
            rest.split(',')
                .nth(1)
                .expect("a value")
                .parse()
                .expect("a number")
        };
        stated.push((value("Average Pressure"), value("Peak Pressure")));
    }
    assert_eq!(
        (stated.len(), found.frames.len(), found.channels.len()),
        (6, 6, 2)
    );
    for (frame, (mean, peak)) in found.frames.iter().zip(stated) {
        let loaded: Vec<f64> = frame
            .values()
            .iter()
            .copied()
            .filter(|&value| value > 0.0)
            .collect();
        let sum: f64 = loaded.iter().sum();
        let count = f64::from(u32::try_from(loaded.len()).expect("few"));
        assert_eq!(loaded.iter().copied().fold(0.0, f64::max), peak);
        assert!((sum / count - mean).abs() <= 0.005_001, "{mean}");
        assert_eq!((frame.rows(), frame.columns()), (31, 11));
    }
    let channel = &found.channels[1];
    assert_eq!(
        channel.name.as_deref(),
        Some("HX210.11.31.M11-DFM-RF S0073")
    );
    assert_eq!(channel.threshold, Some(51.72));
    assert_eq!(channel.unit.as_deref(), Some("mmHg"));
    let times: Vec<_> = found.frames.iter().map(|frame| frame.time).collect();
    assert_eq!(times[..2], [Some(0.0); 2]);
    assert!(times[2] > Some(0.0), "{times:?}");
}

/// Checks the topics of the MCAP file that contain the whole matrix.
fn mcap(iscan: &Recorded) {
    let found = whole("data/made/frames.mcap", Some((28, 28))).expect("it is there");
    let names: Vec<_> = found
        .channels
        .iter()
        .filter_map(|info| info.name.clone())
        .collect();
    assert_eq!(names.len(), 4, "{names:?}");
    let mut processing = Processing::default();
    processing.rule = Some(Rule::at_least(10.0).expect("a number"));
    for (channel, name) in names.iter().enumerate() {
        let frames = found.frames.iter().filter(|frame| frame.channel == channel);
        assert_eq!(frames.clone().count(), 12, "{name}");
        if name.ends_with("#thumb") {
            continue;
        }
        for (index, frame) in frames.enumerate() {
            let own = processing.run(frame).expect("it fits").imprint;
            let theirs = processing
                .run(&iscan.frames[60 + index])
                .expect("it fits")
                .imprint;
            assert_eq!(own, theirs, "{name}, frame {index}");
            assert_eq!(frame.number, index as u64);
        }
    }
    let bytes = std::fs::read(folder().expect("there").join("data/made/frames.mcap"));
    let cut = recorded(&bytes.expect("a file")[..60_000], Some((28, 28)));
    assert!(
        cut.frames.len() > 8
            && cut
                .error
                .is_some_and(|error| error.to_string().contains("footer"))
    );
}

/// Frames 61 to 72 of the I-Scan file in other formats, with the rows and columns that must be given.
#[test]
fn the_same_frames_in_other_formats_give_the_same_imprints() {
    let Some(iscan) = whole("data/pressuRe/iscan_test.csv", None) else {
        return;
    };
    let shape = Some((28, 28));
    for (name, named, times) in [
        ("frames_u2.npy", None, false),
        ("frames_f4_nan.npy", None, false),
        ("frames.npz", None, true),
        ("wide.csv", None, true),
        ("matsense.csv", shape, true),
        ("frames.jsonl", None, true),
        ("ros2_echo_field.txt", shape, false),
    ] {
        let found = whole(&format!("data/made/{name}"), named).expect("it is there");
        assert_eq!(
            (found.frames.len(), found.channels.len()),
            (12, 1),
            "{name}"
        );
        let rule = Rule::at_least(10.0).expect("a number");
        let mut processing = Processing::default();
        processing.rule = Some(rule);
        for (index, frame) in found.frames.iter().enumerate() {
            let own = processing.run(frame).expect("it fits").imprint;
            let theirs = processing
                .run(&iscan.frames[60 + index])
                .expect("it fits")
                .imprint;
            assert_eq!(own, theirs, "{name}, frame {index}");
            assert_eq!(frame.number, index as u64);
            let tenths = f64::from(u32::try_from(index).expect("few"));
            let close = |time: f64| (time * 10.0 - tenths).abs() < 1e-6;
            assert_eq!(
                frame.time.is_some_and(close),
                times,
                "{name}: {:?}",
                frame.time
            );
        }
    }
    mcap(&iscan);
    for (name, named) in [
        ("flexitac16.ascii", None),
        ("flexitac16.bin", Some((16, 16))),
    ] {
        let found = whole(&format!("data/made/{name}"), named).expect("it is there");
        assert_eq!((found.frames.len(), found.notes.len()), (12, 0), "{name}");
        let mut window = Processing::default();
        window.rule = Some(Rule::at_least(10.0).expect("a number"));
        let mut whole_frame = window.clone();
        whole_frame.view.crop = Some(Crop {
            left: 12,
            top: 12,
            columns: 16,
            rows: 16,
        });
        for (index, frame) in found.frames.iter().enumerate() {
            let own = window.run(frame).expect("it fits").imprint;
            let theirs = whole_frame
                .run(&iscan.frames[60 + index])
                .expect("it fits")
                .imprint;
            assert_eq!(own, theirs, "{name}, frame {index}");
        }
    }
    for name in ["matsense.csv", "ros2_echo_field.txt", "flexitac16.bin"] {
        let bytes = std::fs::read(folder().expect("there").join("data/made").join(name));
        let error = recorded(&bytes.expect("a file"), None)
            .error
            .expect("no shape");
        let message = error.to_string();
        assert!(message.contains("rows and columns"), "{message}");
    }
}
