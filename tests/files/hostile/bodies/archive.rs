//! Archives of an atlas, which `taxel merge` reads: any bytes, and valid archives with changed arrays.

use std::cell::LazyCell;
use std::io::{Cursor, Read, Write};

use taxel_core::figure::{Figure, FigureKind};
use taxel_core::imprint::Imprint;
use taxel_core::picture::Picture;
use taxel_core::pose::{Anchor, Axis, PoseGrid, Ranges};
use taxel_core::sensor::Sensor;
use taxel_core::source::Source;
use taxel_core::sweep::{Shard, Sweep, SweepMerge, SweepResult};
use taxel_files::formats::atlas::{read, write, write_csv, write_jsonl};
use taxel_files::formats::numpy::{Header, Number, header};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::{is_short, refused};

/// Reads any bytes.
pub(crate) fn archive(bytes: &[u8]) -> bool {
    match read(Cursor::new(bytes)) {
        Ok(result) => {
            is_sound(result);
            true
        }
        Err(error) => refused(&error.to_string()),
    }
}

/// Checks a result that was read: it can be written in every format, and it is the same when it is read again.
fn is_sound(result: SweepResult) {
    let written = bytes_of(&result);
    let again = read(Cursor::new(&written)).expect("what was read can be read again");
    assert_eq!(again.grid, result.grid);
    assert_eq!(again.shard, result.shard);
    assert_eq!(bytes_of(&again), written);
    for statistic in &result.statistics {
        let all = [
            statistic.min,
            statistic.mean,
            statistic.max,
            statistic.sd,
            statistic.cv,
            statistic.sd_position,
            statistic.sd_angle,
        ];
        assert!(
            all.into_iter().flatten().all(f64::is_finite),
            "{}: {all:?}",
            statistic.feature.key
        );
    }
    let classes = result.atlas.distinct_classes();
    assert!(classes.up_to_symmetry <= classes.up_to_shifts);
    assert!(classes.up_to_shifts <= result.atlas.len());
    let mut lines = Vec::new();
    write_jsonl(&result, &mut lines).expect("it goes into memory");
    for line in lines.split(|&byte| byte == b'\n') {
        let line: Result<serde_json::Value, _> = serde_json::from_slice(line);
        assert!(line.is_ok_and(|line| line.is_object()) || lines.ends_with(b"\n"));
    }
    let mut table = Vec::new();
    write_csv(&result, &mut table).expect("it goes into memory");
    let table = String::from_utf8(table).expect("it is a text");
    assert_eq!(table.lines().count(), result.atlas.len() + 1);
    assert!(!table.contains("NaN") && !table.contains("inf"));
    let mut merge = SweepMerge::default();
    if let Err(error) = merge.add(result).and_then(|()| merge.finish()) {
        is_short(&error.to_string());
    }
}

fn bytes_of(result: &SweepResult) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    write(result, &mut bytes).expect("it goes into memory");
    bytes.into_inner()
}

/// Replaces some bytes in the arrays of a valid archive. The first byte chooses the archive. Each change is a byte for
/// the array, two for the place, one for the number of bytes to remove, one for the number of bytes to insert, and
/// these bytes.
///
/// The checksums of the archive are those of its contents, so that the arrays are read.
pub(crate) fn arrays(bytes: &[u8]) -> bool {
    thread_local! {
        static SOUND: LazyCell<Vec<Arrays>> = const { LazyCell::new(sound) };
    }
    let changed = SOUND.with(|sound| changed(sound, bytes));
    changed.is_some_and(|changed| archive(&changed))
}

/// Returns one of the archives with other bytes in its arrays, as described at [`arrays`]; None without a first byte.
pub(super) fn changed(sound: &[Arrays], bytes: &[u8]) -> Option<Vec<u8>> {
    let (&choice, mut rest) = bytes.split_first()?;
    let mut arrays = sound[usize::from(choice) % sound.len()].clone();
    while let [which, low, high, gone, come, more @ ..] = rest {
        let (new, more) = more.split_at(more.len().min((*come).into()));
        let index = usize::from(*which) % arrays.len();
        let content = &mut arrays[index].1;
        let at = usize::from(u16::from_le_bytes([*low, *high])) % (content.len() + 1);
        let end = (at + usize::from(*gone)).min(content.len());
        content.splice(at..end, new.iter().copied());
        rest = more;
    }
    Some(packed(&arrays))
}

/// Returns one of the valid archives, after `change` has changed the words of its last array, the sums.
pub(crate) fn with_spread(choice: usize, change: impl FnOnce(&mut Vec<u64>)) -> Vec<u8> {
    let mut arrays = sound().swap_remove(choice);
    let (_, content) = arrays.last_mut().expect("the sums are the last array");
    let mut numbers = &content[..];
    Header::read(&mut numbers).expect("an array");
    let word = |bytes: &[u8; 8]| u64::from_le_bytes(*bytes);
    let mut words: Vec<u64> = numbers.as_chunks().0.iter().map(word).collect();
    change(&mut words);
    let length = u64::try_from(words.len()).expect("it is in memory");
    *content = header(Number::U64, &[length]);
    content.extend(words.into_iter().flat_map(u64::to_le_bytes));
    packed(&arrays)
}

/// The arrays of an archive, with their names.
pub(super) type Arrays = Vec<(String, Vec<u8>)>;

/// The arrays that are read; the others are meant for people.
const READ: [&str; 5] = [
    "header.npy",
    "rows.npy",
    "count.npy",
    "first_pose.npy",
    "spread.npy",
];

/// Archives of a figure's whole grid, of a shard of it with incomplete turns, and of a shard of a picture's grid.
fn sound() -> Vec<Arrays> {
    let sensor = Sensor::new(5, 4).expect("a sensor in range");
    let range = |text: &str| text.parse().expect("a range");
    let ranges = Ranges::default()
        .with(Axis::X0, range("0:1:0.25"))
        .with(Axis::Y0, range("0.5:1:0.5"))
        .with(Axis::Angle, range("0:90:45"));
    let rectangle = Figure::new(FigureKind::Rectangle, &sensor, |parameter| {
        Some(match parameter.row().key {
            "length" => 3.0,
            "width" => 2.0,
            "thickness" => 0.5,
            _ => 0.0,
        })
    });
    let rectangle = Source::Figure(rectangle.expect("a rectangle in range"));
    let picture = Imprint::from_rows(["##", "#."]).expect("rows of # and .");
    let picture = Source::Picture(Picture::at_home(picture));
    let grid = |source: &Source, anchor| {
        PoseGrid::new(source.clone(), sensor, anchor, ranges).expect("a grid in range")
    };
    let figures = grid(&rectangle, Anchor::Corner);
    let pictures = grid(&picture, Anchor::Centre);
    let part = Shard::new(1, 4).expect("a shard");
    [
        (&figures, Shard::WHOLE),
        (&figures, part),
        (&pictures, part),
    ]
    .map(|(grid, shard)| unpacked(&bytes_of(&Sweep::new(grid).with_shard(shard).run()), &READ))
    .to_vec()
}

pub(super) fn unpacked(bytes: &[u8], names: &[&str]) -> Arrays {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).expect("a sound archive");
    let mut array = |name: &str| {
        let mut content = Vec::new();
        let mut file = archive.by_name(name).expect("it is there");
        file.read_to_end(&mut content).expect("it can be read");
        (name.to_owned(), content)
    };
    names.iter().map(|name| array(name)).collect()
}

fn packed(arrays: &Arrays) -> Vec<u8> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, content) in arrays {
        archive
            .start_file(name, options)
            .expect("it goes into memory");
        archive.write_all(content).expect("it goes into memory");
    }
    archive.finish().expect("it goes into memory").into_inner()
}
