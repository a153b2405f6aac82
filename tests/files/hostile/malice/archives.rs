//! Malicious atlases and models: zip entries that claim terabytes or unpack to huge arrays, endless headers.

use std::io::{Cursor, Read};

use zip::ZipArchive;

use super::packed::{Packing, Zip, zeros_after};
use super::{Malice, SIZE, filled};

/// A valid atlas and a valid model.
const SOUND: [&[u8]; 2] = [
    include_bytes!("../seeds/archive/ellipse.npz"),
    include_bytes!("../seeds/model/bar.npz"),
];

/// Returns both, with one array replaced.
fn with(name: &str, packing: Packing, content: &[u8], claimed: u64) -> [Zip; 2] {
    let first = || Zip::default().with(name, packing, content, claimed);
    SOUND.map(|sound| completed(first(), &[name], sound))
}

/// Arrays of these names, then the others of a sound archive.
fn completed(mut zip: Zip, names: &[&str], sound: &[u8]) -> Zip {
    let mut archive = ZipArchive::new(Cursor::new(sound)).expect("a sound archive");
    for index in 0..archive.len() {
        let mut file = archive.by_index(index).expect("an array");
        let own = file.name().expect("UTF-8").into_owned();
        if !names.contains(&own.as_str()) {
            let mut array = Vec::new();
            file.read_to_end(&mut array).expect("sound");
            zip = zip.with(&own, Packing::Stored, &array, array.len() as u64);
        }
    }
    zip
}

/// Returns a numpy array with this header.
fn array(kind: &str, shape: &str) -> Vec<u8> {
    let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}");
    [
        b"\x93NUMPY\x01\0\x76\0".to_vec(),
        format!("{header:<117}\n").into_bytes(),
    ]
    .concat()
}

/// Returns both with a JSON header that repeats a part.
fn header(start: &str, again: &str) -> [Zip; 2] {
    let json = filled(start, again, "");
    let json = &json[..SIZE - 20_000];
    let content = [&array("|u1", &format!("({},)", json.len())), json].concat();
    with(
        "header.npy",
        Packing::Stored,
        &content,
        content.len() as u64,
    )
}

/// Returns both with an array that begins with `start` and unpacks from almost a mebibyte to 158 times that size.
fn unpacking(name: &str, start: &[u8]) -> [Zip; 2] {
    let content = zeros_after(start, SIZE - 20_000);
    with(name, Packing::Deflated, &content, 1 << 26)
}

/// Keys of one taxel, as many as fit.
fn equal_keys() -> [Zip; 2] {
    let names = ["height.npy", "width.npy", "rows.npy"];
    let keys = (SIZE - 20_000) / names.len();
    SOUND.map(|sound| {
        let mut zip = Zip::default();
        for (name, shape) in names.into_iter().zip(["", "", "1"]) {
            let array = [array("|u1", &format!("({keys}, {shape})")), vec![1; keys]].concat();
            zip = zip.with(name, Packing::Stored, &array, array.len() as u64);
        }
        completed(zip, &names, sound)
    })
}

/// Malicious inputs for both, with a description each.
macro_rules! both {
    ($($what:literal => $zips:expr;)+) => {
        /// Inputs for atlases.
        pub(super) const ATLASES: &[Malice] = &[$(($what, || finished::<0>($zips))),+];

        /// Inputs for models.
        pub(super) const MODELS: &[Malice] = &[$(($what, || finished::<1>($zips))),+];
    };
}

/// Finishes the atlas (0) or the model (1).
fn finished<const WHICH: usize>(zips: [Zip; 2]) -> Vec<u8> {
    zips.into_iter().nth(WHICH).expect("there are two").finish()
}

both! {
    "a header of deep lists" => header("{\"format\":", "[");
    "a header of deep objects" => header("", "{\"format\":");
    "a header of one key" => header("{\"format\":\"taxel-model/1\"", ",\"format\":\"a\"");
    "a header of shapes" => header("{\"format\":\"taxel-model/1\",\"shapes\":[{}", ",{}");
    "a header of blanks" => header("{", " ");
    "rows that claim terabytes" => {
        let content = [array("<u8", "(1000000000000,)"), vec![0; SIZE - 20_000]].concat();
        with("rows.npy", Packing::Stored, &content, 8 << 40)
    };
    "rows that unpack to much" => unpacking("rows.npy", &array("<u8", "(20000000,)"));
    "rows that unpack to another array" => unpacking("rows.npy", b"no array");
    "keys that are all the same" => equal_keys();
    "a header that unpacks to much" => unpacking("header.npy", &array("|u1", "(160000000,)"));
    "another array that unpacks to much" => unpacking("other.npy", b"\x93NUMPY");
    "arrays that share their bytes" => {
        let one = zeros_after(b"\x93NUMPY", 50_000);
        with("other.npy", Packing::Deflated, &one, 8 << 20).map(|zip| zip.with_shared(9_000, &one))
    };
}
