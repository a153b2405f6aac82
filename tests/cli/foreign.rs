//! Exchange of files with other programs: numpy, Pillow, mcap and netpbm, where they are installed.
//!
//! With `TAXEL_NUMPY` set, Python must have its packages; with `TAXEL_CI` set, netpbm must be installed.

use std::path::Path;
use std::process::{Command, Stdio};

use tempfile::TempDir;

use super::finish;
use super::program;
use super::python_has;
use super::skip::lacking;

/// Returns the washer as rows of `#` and `.`, and a folder with its files.
fn washer() -> (String, TempDir) {
    let folder = tempfile::tempdir().expect("there is a folder for temporary files");
    for name in [
        "a.txt",
        "a.npy",
        "a.csv",
        "a.pbm",
        "a.svg",
        "plain.pbm --format pbm-plain",
    ] {
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

/// Runs another program in a folder; None if it is not installed.
fn others(folder: &Path, name: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(name)
        .args(arguments)
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .ok()?;
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let wrong = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        output.status.success(),
        "{name} {arguments:?}: {said}{wrong}"
    );
    Some(said)
}

#[test]
fn files_are_exchanged_with_numpy() {
    if !python_has("numpy") {
        return;
    }
    let (text, folder) = washer();
    let script = "
import numpy as np
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
    let said = others(folder.path(), "python3", &["-c", script]);
    assert_eq!(said.as_ref(), Some(&text));
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

#[test]
fn files_are_exchanged_with_pillow() {
    if !python_has("PIL.Image") {
        return;
    }
    let (text, folder) = washer();
    // Black is an active taxel; in Pillow's own bitmaps, 0 is black.
    let script = "
from PIL import Image
a, b = Image.open('a.pbm'), Image.open('plain.pbm')
assert a.mode == b.mode == '1' and a.size == (16, 16)
assert a.tobytes() == b.tobytes()
a.save('pillow.pbm')
for y in range(16):
    print(''.join('.' if a.getpixel((x, y)) else '#' for x in range(16)))
";
    let said = others(folder.path(), "python3", &["-c", script]);
    assert_eq!(said.as_ref(), Some(&text));
    export(folder.path(), "pillow.pbm back.txt");
    let back = std::fs::read_to_string(folder.path().join("back.txt"));
    assert_eq!(back.expect("written"), text);
}

#[test]
fn python_parses_the_drawing_as_xml() {
    if !python_has("xml.dom.minidom") {
        return;
    }
    let (_, folder) = washer();
    let script = "
import xml.dom.minidom
page = xml.dom.minidom.parse('a.svg').documentElement
print(page.tagName, page.namespaceURI, len(page.getElementsByTagName('path')) > 5)
";
    let said = others(folder.path(), "python3", &["-c", script]);
    assert_eq!(
        said.as_deref(),
        Some("svg http://www.w3.org/2000/svg True\n")
    );
}

#[test]
fn files_are_exchanged_with_netpbm() {
    let (text, folder) = washer();
    let path = folder.path();
    if others(path, "pamfile", &["a.pbm"]).is_none() {
        lacking("netpbm");
        return;
    }
    let plain = others(path, "pnmtoplainpnm", &["a.pbm"]);
    let plain = plain.or_else(|| others(path, "pamtopnm", &["-plain", "a.pbm"]));
    std::fs::write(path.join("theirs.pbm"), plain.expect("one of the two")).expect("written");
    for name in ["theirs.pbm", "plain.pbm"] {
        export(path, &format!("{name} back.txt --force"));
        let back = std::fs::read_to_string(path.join("back.txt"));
        assert_eq!(back.expect("written"), text, "{name}");
    }
    let compared = others(path, "pamfile", &["plain.pbm"]).expect("it is there");
    assert!(compared.contains("16 by 16"), "{compared}");
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

# A camera beside the sensor: colours, and an image larger than any frame.
def image(encoding, width, height, step):
    text = encoding + b'\\0' * (4 - len(encoding) % 4)
    head = struct.pack('<III', 0, 0, 1) + b'\\0' * 4 + struct.pack('<II', height, width)
    head += struct.pack('<I', len(encoding) + 1) + text + struct.pack('<I', step)
    return b'\\0\\1\\0\\0' + head + struct.pack('<I', step * height) + bytes(step * height)

for name, packing in [('none', CompressionType.NONE), ('lz4', CompressionType.LZ4), ('zstd', CompressionType.ZSTD)]:
    with open(name + '.mcap', 'wb') as file:
        writer = Writer(file, compression=packing, chunk_size=500)
        writer.start('ros2', 'test')
        schema = writer.register_schema('std_msgs/msg/UInt16MultiArray', 'ros2msg', b'')
        channel = writer.register_channel('/pad', 'cdr', schema)
        schema = writer.register_schema('sensor_msgs/msg/Image', 'ros2msg', b'')
        camera = writer.register_channel('/cam', 'cdr', schema)
        for data in [image(b'rgb8', 4, 4, 12), image(b'mono8', 640, 480, 640)]:
            writer.add_message(camera, log_time=0, data=data, publish_time=0)
        schema = writer.register_schema('sensor_msgs/msg/PointCloud2', 'ros2msg', b'')
        cloud = writer.register_channel('/cloud', 'cdr', schema)
        for channel_id in [camera, cloud] if name == 'none' else []:
            writer.add_message(channel_id, log_time=0, data=bytes(17 << 20), publish_time=0)
        for frame in range(40):
            values = [100 * (index % 12 == frame % 12) + frame for index in range(12)]
            writer.add_message(channel, log_time=frame * 10_000_000, data=message(values), publish_time=0)
        writer.finish()
";
    others(folder.path(), "python3", &["-c", script]).expect("Python is there");
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
