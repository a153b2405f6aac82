//! Exchange of files with numpy and mcap, where they are installed; with `TAXEL_NUMPY` set, they must be.

use std::path::Path;
use std::process::Command;

use tempfile::TempDir;

use super::finish;
use super::program;
use super::python_has;

/// Returns the washer as rows of `#` and `.`, and a folder with its files.
fn washer() -> (String, TempDir) {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    for name in ["a.txt", "a.npy", "a.csv", "a.svg"] {
        export(folder.path(), &format!("washer {name}"));
    }
    let text = std::fs::read_to_string(folder.path().join("a.txt")).expect("written");
    (text, folder)
}

fn export(folder: &Path, line: &str) {
    let arguments: Vec<&str> = "export".split(' ').chain(line.split(' ')).collect();
    let mut command = program(&arguments, "C.UTF-8");
    let child = command.current_dir(folder).spawn();
    let run = finish(child.expect("the program starts"), b"");
    assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""), "{line}");
}

/// Runs a program of Python in a folder, and returns what it prints.
fn others(folder: &Path, script: &str) -> String {
    let mut python = Command::new("python3");
    let run = python.args(["-c", script]).current_dir(folder).output();
    let run = run.expect("Python is there");
    let wrong = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{wrong}");
    String::from_utf8_lossy(&run.stdout).into_owned()
}

#[test]
fn files_are_exchanged_with_numpy() {
    if !python_has("numpy") {
        return;
    }
    let (text, folder) = washer();
    let script = "
import xml.dom.minidom
import numpy as np
page = xml.dom.minidom.parse('a.svg').documentElement
assert page.tagName == 'svg' and len(page.getElementsByTagName('path')) > 5
a = np.load('a.npy')
assert a.dtype == bool and a.shape == (16, 16), (a.dtype, a.shape)
b = np.loadtxt('a.csv', delimiter=',')
assert (a == b).all()
np.save('int.npy', a.astype('>i4'))
np.save('fortran.npy', np.asfortranarray(a.astype('<f8')))
np.savetxt('default.csv', a, delimiter=',')
np.savetxt('short.csv', a, delimiter=';', fmt='%d')
np.savetxt('spaces.dat', a)
np.savetxt('headed.csv', a, delimiter=',', fmt='%g', header='sixteen columns')
np.save('half.npy', a.astype('<f2'))
np.save('mask.npy', a.astype('u1') * 255)
for row in a:
    print(''.join('#' if cell else '.' for cell in row))
";
    let said = others(folder.path(), script);
    assert_eq!(said, text);
    for name in [
        "int.npy",
        "fortran.npy",
        "half.npy",
        "mask.npy",
        "default.csv",
        "short.csv",
        "spaces.dat",
        "headed.csv",
    ] {
        export(folder.path(), &format!("{name} back.txt --force"));
        let back = std::fs::read_to_string(folder.path().join("back.txt"));
        assert_eq!(back.expect("written"), text, "{name}");
    }
}

/// The package of the format's authors writes chunks with each compression.
#[test]
fn recordings_of_the_mcap_package_are_read() {
    if !python_has("mcap, lz4, zstandard") {
        return;
    }
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    let script = "
import struct
from mcap.writer import CompressionType, Writer

def message(values):
    def sequence(size, label, stride):
        return struct.pack('<I', len(label) + 1) + label + b'\\0' * (1 + -(len(label) + 1) % 4) + struct.pack('<II', size, stride)
    layout = struct.pack('<I', 2) + sequence(3, b'row', 12) + sequence(4, b'col', 4) + struct.pack('<I', 0)
    data = struct.pack('<I', len(values)) + struct.pack('<%dH' % len(values), *values)
    return b'\\0\\1\\0\\0' + layout + data

for name, packing in [('none', CompressionType.NONE), ('lz4', CompressionType.LZ4), ('zstd', CompressionType.ZSTD)]:
    with open(name + '.mcap', 'wb') as file:
        writer = Writer(file, compression=packing, chunk_size=500)
        writer.start('ros2', 'test')
        schema = writer.register_schema('std_msgs/msg/UInt16MultiArray', 'ros2msg', b'')
        channel = writer.register_channel('/pad', 'cdr', schema)
        for frame in range(40):
            values = [100 * (index % 12 == frame % 12) + frame for index in range(12)]
            writer.add_message(channel, log_time=frame * 10_000_000, data=message(values), publish_time=0)
        writer.finish()
";
    others(folder.path(), script);
    for name in ["none", "lz4", "zstd"] {
        let file = format!("{name}.mcap");
        let arguments = ["frames", &file, "--all", "--at-least", "100", "--json"];
        let mut command = program(&arguments, "C.UTF-8");
        let child = command.current_dir(folder.path()).spawn();
        let run = finish(child.expect("the program starts"), b"");
        assert_eq!((run.status, run.stderr.as_str()), (Some(0), ""), "{name}");
        let lines: Vec<serde_json::Value> = (run.stdout.lines())
            .map(|line| serde_json::from_str(line).expect("a line of JSON"))
            .collect();
        assert_eq!(lines.len(), 40, "{name}");
        for (frame, line) in lines.iter().enumerate() {
            let mut rows = vec![vec!['.'; 4]; 3];
            rows[frame % 12 / 4][frame % 12 % 4] = '#';
            let rows: Vec<String> = rows.into_iter().map(String::from_iter).collect();
            assert_eq!(
                line["imprint"],
                serde_json::json!(rows),
                "{name}, frame {frame}"
            );
        }
    }
}
