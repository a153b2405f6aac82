//! Tests of `taxel frames`: lists of recordings, and their frames as imprints.

use serde_json::Value;

use super::model::Place;
use super::{Run, misused, taxel};

/// Returns the path of a sample from the tests of recordings.
fn sample(name: &str) -> String {
    format!(
        "{}/tests/files/frames/samples/{name}",
        env!("CARGO_MANIFEST_DIR")
    )
}

fn frames(name: &str, flags: &str) -> Run {
    taxel(&format!("frames {} {flags}", sample(name)), "")
}

fn answers(run: &Run) -> Vec<Value> {
    let lines = run.stdout.lines();
    lines
        .map(|line| serde_json::from_str(line).expect(line))
        .collect()
}

/// Returns the answers of a run that must print no message.
fn answered(name: &str, flags: &str) -> Vec<Value> {
    let run = frames(name, flags);
    assert_eq!(
        (run.status, run.stderr.as_str()),
        (Some(0), ""),
        "{name} {flags}"
    );
    answers(&run)
}

/// Checks that a run exits with status 1 and a message that contains `message`.
fn unanswered(name: &str, flags: &str, message: &str) {
    let run = frames(name, flags);
    assert_eq!((run.status, run.stdout.as_str()), (Some(1), ""), "{flags}");
    assert!(run.stderr.contains(message), "{flags}: {}", run.stderr);
}

#[test]
fn a_list_shows_what_the_recording_says_about_itself() {
    let found = answered("tekscan.asf", "--json");
    let expected = r#"{"format":"tekscan","channels":[{"name":null,"frames":3,"rows":4,"columns":5,"cells":18,
        "unit":"raw","start":"1/2/2024 3:04:05.06PM","seconds_per_frame":0.05,"pitch_mm":[2.5,2.5],"threshold":null,
        "peak":1}]}"#;
    assert_eq!(
        found[0],
        serde_json::from_str::<Value>(expected).expect("JSON")
    );
    let text = frames("xsensor.csv", "").stdout;
    assert!(
        text.starts_with("xsensor, 2 channels\n\nchannel   left\nframes    3\n"),
        "{text}"
    );
    assert!(
        text.contains("pitch     2.5 mm across, 3 mm down\n"),
        "{text}"
    );
}

#[test]
fn a_list_shows_the_times_of_frames_and_where_they_go_back() {
    let time = |times: [&str; 3]| {
        let lines = times.map(|time| format!("{time},1,2,3,4\n"));
        let run = taxel(
            "frames -",
            format!("time,r0c0,r0c1,r1c0,r1c1\n{}", lines.concat()),
        );
        let mut lines = run.stdout.lines();
        lines
            .find_map(|line| Some(line.strip_prefix("time      ")?.to_owned()))
            .expect("a line of times")
    };
    assert_eq!(time(["0.5", "1", "1.25"]), "0 to 0.75 s");
    assert_eq!(time(["0", "2", "1.5"]), "0 to 1.5 s, goes back at frame 2");
    assert_eq!(time(["0", "-1", "5"]), "0 to 5 s, goes back at frame 1");
    let untimed = taxel("frames -", "r0c0,r0c1\n1,2\n3,4\n");
    assert!(!untimed.stdout.contains("time"), "{}", untimed.stdout);
}

#[test]
fn frames_are_chosen_by_number_label_or_sum() {
    let rule = "--at-least 9 --json";
    let peak = answered("tekscan.asf", &format!("--peak {rule}"));
    assert_eq!(peak.len(), 1);
    let expected = r#"{"frame":1,"label":2,"time":0.05,"channel":null,"sum":67,"max":20,
        "rule":{"at_least":9,"from":"flag"},"imprint":[".....","..#..",".###.","....."],"na":4}"#;
    let expected: Value = serde_json::from_str(expected).expect("JSON");
    for (key, value) in expected.as_object().expect("an object") {
        assert_eq!(&peak[0][key], value, "{key}");
    }
    assert_eq!(peak[0]["regions"][0]["nae"], 4);
    assert_eq!(answered("tekscan.asf", &format!("--frame 1 {rule}")), peak);
    assert_eq!(answered("tekscan.asf", &format!("--label 2 {rule}")), peak);
    let all = answered("tekscan.asf", &format!("--all {rule}"));
    let numbers: Vec<_> = all.iter().map(|answer| answer["frame"].clone()).collect();
    assert_eq!(numbers, [0, 1, 2]);
    unanswered(
        "tekscan.asf",
        "--frame 3 --at-least 9",
        "no frame 3, expected 0 to 2",
    );
    let run = taxel(
        "frames - --frame 99 --at-least 9",
        "{\"frame\":[[1,2],[3,4]]}\n",
    );
    let expected = "error: standard input: no frame 99; the recording has only frame 0\n";
    assert_eq!((run.status, run.stderr.as_str()), (Some(1), expected));
    unanswered(
        "tekscan.asf",
        "--label 0 --at-least 9",
        "no frame is labelled 0",
    );
}

#[test]
fn the_rule_comes_from_flags_or_from_the_recording() {
    let imprint =
        |flags: &str| answered("tekscan.asf", &format!("--frame 2 --json {flags}"))[0].clone();
    let rows = |flags: &str| imprint(flags)["imprint"].clone();
    assert_eq!(
        rows("--percent 50"),
        serde_json::json!([".....", "..#..", ".##..", "....#"])
    );
    assert_eq!(
        rows("--low 4 --high 13"),
        serde_json::json!([".....", ".##..", ".###.", "....#"])
    );
    assert_eq!(
        rows("--at-least 7 --min-taxels 4"),
        serde_json::json!([".....", ".....", ".....", "....."])
    );
    // The median of 3, 5 and 4 is 4, and of 9, 14 and 10 is 10.
    let tared = imprint("--tare 3 --at-least 0.5");
    assert_eq!(
        tared["imprint"],
        serde_json::json!([".#...", ".....", ".....", "....#"])
    );
    assert_eq!(
        (&tared["sum"], &tared["max"], &tared["tare"]),
        (&50.into(), &13.into(), &3.into())
    );
    unanswered(
        "tekscan.asf",
        "--peak",
        "--at-least, --percent, --low and --high, or --deviations",
    );
    unanswered(
        "tekscan.asf",
        "--peak --at-least 1 --tare 4",
        "the tare needs 4 frames, but there are only 3",
    );
    let own = answered("xsensor.csv", "--channel left --frame 0 --json");
    assert_eq!(
        own[0]["rule"],
        serde_json::json!({"at_least": 10, "from": "file"})
    );
    misused(
        &format!("frames {} --peak --low 3", sample("u2.npy")),
        "the following required",
    );
    misused(
        &format!("frames {} --peak --deviations 3", sample("u2.npy")),
        "the following required",
    );
    misused(
        &format!("frames {} --peak --all", sample("u2.npy")),
        "the argument '--peak'",
    );
}

#[test]
fn one_of_several_channels_must_be_named() {
    unanswered(
        "xsensor.csv",
        "--peak --at-least 9",
        "2 channels, choose one with --channel: left, right",
    );
    let unknown = "no channel named \"top\"; channels: left, right\n";
    unanswered("xsensor.csv", "--peak --channel top", unknown);
    unanswered("xsensor.csv", "--channel top", unknown);
    let text = frames("xsensor.csv", "--channel right");
    let begins = "xsensor, 1 channel\n\nchannel   right\n";
    assert!(text.stdout.starts_with(begins), "{}", text.stdout);
    assert!(!text.stdout.contains("left"), "{}", text.stdout);
    let listed = &answered("xsensor.csv", "--channel right --json")[0]["channels"];
    assert_eq!(
        (&listed[0]["name"], &listed[1]),
        (&"right".into(), &Value::Null)
    );
    let right = answered("xsensor.csv", "--channel right --peak --at-least 18 --json");
    assert_eq!(
        (&right[0]["channel"], &right[0]["label"]),
        (&"right".into(), &101.into())
    );
}

#[test]
fn missing_rows_and_columns_are_asked_for_and_a_crop_must_fit() {
    unanswered("plain.csv", "", "--rows and --columns");
    unanswered(
        "topics.mcap",
        "--all --channel /state#tip --at-least 1 --rows 7 --columns 11",
        "found 3 values a frame, expected 77: 7 rows of 11\n",
    );
    unanswered(
        "plain.csv",
        "--rows 4 --columns 4",
        "22 numbers a line, expected 16 (or 4 for a row): which is the time? --time-column N",
    );
    let columns = "--rows 4 --columns 5 --label-column 21 --time-column 22:ms";
    let list = &answered("plain.csv", &format!("{columns} --json"))[0]["channels"][0];
    assert_eq!((&list["rows"], &list["columns"]), (&4.into(), &5.into()));
    let crop = "--frame 0 --at-least 9 --json --crop 1,1,2x2 --turn 90";
    assert_eq!(
        answered("u2.npy", crop)[0]["imprint"],
        serde_json::json!(["..", "##"])
    );
    for choice in ["--frame 0 --at-least 9", ""] {
        let beyond = format!("{choice} --crop 3,0,3x1");
        unanswered("u2.npy", &beyond, "the crop reaches beyond");
    }
    let negative = taxel(&format!("frames {} --crop -1,0,3x3", sample("u2.npy")), "");
    assert_eq!(negative.status, Some(2));
    let said = "expected the first column and row, then columns x rows";
    assert!(negative.stderr.contains(said), "{}", negative.stderr);
    // A listing describes the cropped frames.
    let list = &answered("u2.npy", "--crop 1,1,2x3 --json")[0]["channels"][0];
    let size = ["rows", "columns", "cells"].map(|key| list[key].as_u64());
    assert_eq!(size, [Some(3), Some(2), Some(6)]);
    let run = taxel(&format!("frames {} --crop 1,1,2x3", sample("u2.npy")), "");
    let size = "size      3 rows × 2 columns of 4 × 5, 6 cells";
    assert!(run.stdout.contains(size), "{}", run.stdout);
}

#[test]
fn whole_frames_before_damage_are_answered_then_the_damage_is_reported() {
    let whole = std::fs::read_to_string(sample("tekscan.asf")).expect("a text");
    let torn = whole.replace("0,4,10,0,0", "0,4,?,0,0");
    let run = taxel("frames - --all --at-least 9 --json", torn);
    assert_eq!((run.status, answers(&run).len()), (Some(1), 2));
    assert_eq!(
        run.stderr,
        "error: standard input: line 32, column 3: found \"?\", expected a number\n"
    );
    // The frames for the tare are missing because of the damage.
    let torn = whole.replace("0,4,10,0,0", "0,4,?,0,0");
    let run = taxel("frames - --all --tare 3 --at-least 9", torn);
    assert_eq!((run.status, run.stdout.as_str()), (Some(1), ""));
    assert!(run.stderr.contains("line 32, column 3"), "{}", run.stderr);
    let wrong = whole.replace("Raw Sum=,,67", "Raw Sum=,,68");
    let run = taxel("frames - --json", wrong);
    assert_eq!(run.status, Some(0));
    assert_eq!(
        run.stderr,
        "warning: standard input: frame 1 (label 2): Raw Sum should be 68, but the values give 67\n"
    );
}

#[test]
fn values_are_shown_as_shades_above_the_imprint() {
    let run = frames("tekscan.asf", "--all --at-least 9 --heat");
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""));
    for part in [
        "0 ░▒▓█ 20 raw\n",
        "tekscan.asf, frame 1 (label 2), 0.05 s\n",
    ] {
        assert!(run.stdout.contains(part), "{}", run.stdout);
    }
}

#[test]
fn all_frames_of_a_label_are_answered() {
    let labelled = "label,s0,s1,s2,s3\n7,1,0,0,0\n7,1,1,0,0\n8,1,1,1,0\n";
    let line = "frames - --rows 2 --columns 2 --at-least 1 --json --label 7";
    assert_eq!(answers(&taxel(line, labelled)).len(), 2);
}

#[test]
fn cells_that_are_not_square_have_no_lengths_in_mm() {
    let run = frames("xsensor.csv", "--channel left --peak --at-least 9");
    assert!(
        run.stdout.contains("cells of 2.5 × 3 mm are not square"),
        "{}",
        run.stdout
    );
    assert!(!run.stdout.contains("in mm"), "{}", run.stdout);
    unanswered(
        "xsensor.csv",
        "--channel left --peak --pitch 2",
        "--pitch: cells of 2.5 × 3 mm",
    );
    let square = frames("tekscan.asf", "--peak --at-least 9").stdout;
    assert!(square.contains("in mm"), "{square}");
}

/// The taxels of a recording that flip, and those that are stuck, with the mask of the stuck ones.
#[test]
fn the_noise_of_a_recording_is_reported() {
    // 30 frames of 5 × 5: one taxel is always on, one flips in every tenth frame.
    let frame = |number: u32| {
        let mut values = [0; 25];
        values[24] = 9;
        if number % 10 == 5 {
            values[6] = 9;
        }
        let rows = values.chunks(5).map(|row| format!("{row:?}"));
        format!("{{\"frame\":[{}]}}\n", rows.collect::<Vec<_>>().join(","))
    };
    let text: String = (0..30).map(frame).collect();
    let run = taxel("frames - --noise-report --at-least 5 --json", text.clone());
    let answer = &answers(&run)[0];
    assert_eq!(
        (
            &answer["frames"],
            &answer["cells"],
            &answer["flips"],
            &answer["repeated"]
        ),
        (&30.into(), &25.into(), &3.into(), &694.into())
    );
    let noise = answer["noise"].as_f64().expect("a number");
    let share = noise * (1.0 - noise);
    assert!(
        (share / (1.0 - 2.0 * share) - 3.0 / 694.0).abs() < 1e-12,
        "{noise}"
    );
    assert_eq!(answer["stuck_on"], serde_json::json!([[4, 4]]));
    assert_eq!(answer["stuck_off"], serde_json::json!([]));
    assert_eq!(
        answer["mask"],
        serde_json::json!([".....", ".....", ".....", ".....", "....#"])
    );
    let run = taxel("frames - --noise-report --at-least 5", text);
    assert!(run.stdout.contains("stuck on: 4,4\n"), "{}", run.stdout);
    let flips = ": a taxel changed for a single frame in 3 of 694 cases\n";
    assert!(run.stdout.contains(flips), "{}", run.stdout);
    // Flags that have no meaning for many frames are refused, not ignored.
    for flag in ["--model figures", "--heat", "--pitch 2"] {
        let line = format!("frames - --noise-report --at-least 5 {flag}");
        misused(&line, "the argument '--noise-report' cannot be used with");
    }
}

#[test]
fn a_gain_and_a_mask_change_the_imprint() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("touch.jsonl");
    std::fs::write(&path, "{\"frame\":[[5,5],[5,1]]}\n").expect("written");
    let path = path.to_str().expect("UTF-8");
    let run = |line: &str, input: &str| taxel(&format!("{line} {path} --at-least 3"), input);
    for line in ["frames --all --json", "watch --once"] {
        let imprint = |flags: &str, input: &str| {
            let run = run(&format!("{line} {flags}"), input);
            assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""), "{flags}");
            answers(&run)[0]["imprint"].clone()
        };
        let rows = |rows: [&str; 2]| serde_json::json!(rows);
        assert_eq!(imprint("--mask -", "#.\n..\n"), rows([".#", "#."]));
        for gain in ["1,1\n0,3\n", "1;1\n0;3", "# factors\n1 1\n0 3\n\n"] {
            assert_eq!(imprint("--gain -", gain), rows(["##", ".#"]));
        }
        let answer = &answers(&run(&format!("{line} --gain -"), "1,1\n0,3\n"))[0];
        assert_eq!((&answer["gain"], &answer["max"]), (&true.into(), &5.into()));
        for (gain, message) in [
            ("1,2,3\n", "the gain has 3 columns and 1 row"),
            (
                "1,2\n3,x\n",
                "line 2, column 2: found \"x\", expected a number",
            ),
            (
                "{\"frame\":[[1,1]]}\n{\"frame\":[[1,1]]}\n",
                "a recording of several frames",
            ),
        ] {
            let run = run(&format!("{line} --gain -"), gain);
            assert_eq!((run.status, run.stdout.as_str()), (Some(1), ""));
            assert!(run.stderr.contains(message), "{gain:?}: {}", run.stderr);
        }
    }
    let text = run("frames --all --gain - --tare 1", "1,1\n0,3\n").stdout;
    assert!(
        text.contains("raw max 5, tare of 1 frame, gain applied\nforce 0\n"),
        "{text}"
    );
    let missing = run("frames --all --mask nowhere", "");
    assert!(
        missing
            .stderr
            .starts_with("error: --mask nowhere: cannot read: ")
    );
    let both = "standard input can be read only once, so only one argument can be '-'\n";
    misused(&format!("frames {path} --all --mask - --gain -"), both);
}

/// A sensor that is tared by its driver rests at exactly 0, so its step is unknown.
#[test]
fn deviations_without_noise_or_a_step_are_warned_about() {
    for (second, last, na) in [("0", "0.9", 0), ("0", "1", 1), ("0.5", "0.9", 1)] {
        let rest = format!("{{\"frame\":[[0,{second}]]}}\n").repeat(3);
        let lines = rest + &format!("{{\"frame\":[[{last},{second}]]}}\n");
        let run = taxel("frames - --frame 3 --tare 3 --deviations 2 --json", lines);
        assert_eq!(answers(&run)[0]["na"], na, "{last}");
        let warned = run
            .stderr
            .contains("all values of the tare are equal, so their step is unknown");
        assert_eq!(warned, second == "0", "{}", run.stderr);
    }
}

#[test]
fn flags_out_of_range_or_without_effect_are_refused() {
    for (flags, message) in [
        (
            "--percent 200",
            "error: --percent 200 is out of range (allowed: above 0, up to 100)\n",
        ),
        ("--low 5 --high 3", "error: --low 5 is above --high 3\n"),
        (
            "--low 5 --high 1e301",
            "error: --high 1e301 is out of range (allowed: -1e300 to 1e300)\n",
        ),
    ] {
        unanswered("tekscan.asf", &format!("--all {flags}"), message);
    }
    // A listing shows values as they are.
    for flags in ["--at-least 10", "--tare 2", "--gain gain.csv", "--turn 90"] {
        let line = format!("frames {} {flags}", sample("tekscan.asf"));
        misused(&line, "the following required arguments were not provided:");
    }
    let run = frames("tekscan.asf", "--rows 2 --columns 2");
    let expected = "it states 4 rows and 5 columns; --rows and --columns have no effect\n";
    assert!(run.stderr.ends_with(expected), "{}", run.stderr);
}

/// The input has no end, so an error at its beginning must be enough.
#[test]
fn frames_without_values_have_no_peak() {
    let none = "{\"frame\":[[null,null]]}\n".repeat(3);
    let run = taxel("frames - --peak --at-least 0 --json", none);
    let message = "standard input: no frame has a cell with a value, so none is the peak";
    super::refused(&run, 1, message);
}

/// Labels may be texts, force is that of the active cells after the tare, and what does not exist is empty.
#[test]
fn a_table_has_force_contact_and_descriptors_of_each_frame() {
    let lines = "{\"frame\":[[1,1],[1,1]],\"label\":7,\"t\":1}\n\
                 {\"frame\":[[1,4],[2,10]],\"label\":\"cup,large\",\"t\":1.5,\"channel\":null}\n";
    let header = "frame,label,time,channel,sum,max,force,contact,cop_x,cop_y,na,nae,ce,num_x,num_y,cg_x,cg_y,p,f,roundness,\
                  rect_left,rect_top,rect_right,rect_bottom,cd_x,cd_y,area,diagonals_1,diagonals_2,side_ratio,filling,cg_cd,\
                  cg_cd_direction\n";
    let rest = format!("0,7,0,,4,1,0,0,,{}\n", ",".repeat(23));
    let touch = "1,\"cup,large\",0.5,,17,10,12,2,1.5,1.25,2,2,2,3,2,1.5,1,2,2,6.283185307179586,1,0,2,2,1.5,1,2,\
                 63.43494882292201,116.56505117707799,2,1,0,\n";
    let run = taxel("frames - --csv --tare 1 --at-least 3", lines);
    assert_eq!(run.stderr, "");
    assert_eq!(run.stdout, [header, &rest, touch].concat());
    let flags = "--csv --tare 1 --at-least 3 --label cup,large";
    let run = taxel(&format!("frames - {flags}"), lines);
    assert_eq!(run.stdout, [header, touch].concat());
    // Without a threshold, all values above 0 count, and there are no descriptors.
    let run = taxel("frames - --csv --label 7", lines);
    let all = format!("0,7,0,,4,1,4,4,1,1{}\n", ",".repeat(23));
    assert_eq!(run.stdout, [header, &all].concat());
}

/// Tables as people have them, rebuilt after public reports, with the frames that must come out.
#[test]
fn public_tables_are_read_as_expected_or_refused() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/reference/tables");
    let Ok(cases) = std::fs::read_to_string(format!("{folder}/tables.json")) else {
        super::skip::skipped(&format!("there are no tables at {folder}"));
        return;
    };
    let cases: Vec<Value> = serde_json::from_str(&cases).expect("JSON");
    assert!(cases.len() > 20, "the file is cut short");
    for case in &cases {
        let file = case["file"].as_str().expect("a name");
        let words = |key: &str| -> Vec<&str> {
            let words = case[key].as_array().into_iter().flatten();
            words.map(|word| word.as_str().expect("a text")).collect()
        };
        let flags = words("args").join(" ");
        let run = taxel(
            &format!("frames {folder}/{file} --all --at-least 5 --json {flags}"),
            "",
        );
        let refused = [words("refused"), words("or_refused")].concat();
        if !refused.is_empty() && run.status == Some(1) {
            let says = |word: &&str| run.stderr.contains(word);
            assert!(refused.iter().all(says), "{file}: {}", run.stderr);
            continue;
        }
        assert_eq!(run.status, Some(0), "{file} {flags}: {}", run.stderr);
        let found = answers(&run);
        let Some(expected) = case["frames"].as_array() else {
            assert!(words("refused").is_empty() && !found.is_empty(), "{file}");
            continue;
        };
        assert_eq!(found.len(), expected.len(), "{file} {flags}");
        for (index, (found, expected)) in found.iter().zip(expected).enumerate() {
            for (key, value) in expected.as_object().expect("an object") {
                // 0,5 + 0,7 + 0,5 + 0,5 + 9,7 + 0,5 are 12.4, not the 12.6 in the file.
                if key == "sum" && file != "tab-decimal-comma.txt" {
                    let [own, value] = [&found[key], value].map(|sum| sum.as_f64().expect("a sum"));
                    assert!((own - value).abs() < 1e-9, "{file} {flags}: {own}");
                } else if key != "sum" {
                    assert_eq!(&found[key], value, "{file} {flags}, frame {index}");
                }
            }
            if let Some(times) = case["time"].as_array() {
                let close = |time: f64| (found["time"].as_f64().unwrap_or(f64::NAN) - time).abs();
                assert!(
                    close(times[index].as_f64().expect("a time")) < 1e-9,
                    "{file}"
                );
            }
        }
    }
}

/// Touches of the rectangles of the model, of one that it does not have, and frames that are left out.
#[test]
fn answers_are_counted_against_the_labels_of_a_recording() {
    let place = Place::with_model();
    let rectangle = |length, width, angle| {
        format!(
            "{{\"figure\":\"rectangle\",\"length\":{length},\"width\":{width},\"x0\":4.13,\"y0\":5.47,\"angle\":{angle}}}\n"
        )
    };
    let touches = [
        ("D", rectangle(4.2, 4.2, 33.3)),
        ("d", rectangle(4.2, 4.2, 71.9)),
        ("c", rectangle(6.2, 3.0, 8.6)),
        // Not what it says, and not in the model.
        ("a", rectangle(4.2, 4.2, 12.1)),
        ("plate", rectangle(9.0, 7.0, 40.4)),
        ("", rectangle(4.2, 4.2, 12.1)),
    ];
    let lines: String = touches.iter().map(|(_, line)| line.as_str()).collect();
    let cells = (0..16).flat_map(|row| (0..16).map(move |column| format!(",r{row}c{column}")));
    let mut table = format!("label{}\n", cells.collect::<String>());
    for ((label, _), answer) in touches.iter().zip(answers(&place.run("batch", &lines))) {
        let rows = answer["imprint"].as_array().expect("rows").iter();
        let text: String = rows.map(|row| row.as_str().expect("a row")).collect();
        let values = text
            .chars()
            .map(|taxel| if taxel == '#' { ",9" } else { ",0" });
        table += &format!("{label}{}\n", values.collect::<String>());
    }
    table += &format!("d{}\n", ",0".repeat(256));
    place.write("labelled.csv", &table);
    let named = "labelled.csv --all --at-least 5 --model r --expect-labels";
    let lines = [
        named,
        &format!("{named} --json"),
        &format!("{named} --csv"),
        &format!("{named} --least 200"),
    ];
    insta::assert_snapshot!("labels", place.transcript("frames", &lines));
}
