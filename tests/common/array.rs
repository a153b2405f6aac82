//! Recordings as arrays of numpy: small ones made here, and what the header of one says that the program has written.
#![allow(dead_code, reason = "every test file uses its own part of this one")]

/// An array of numbers in a file, given its shape as Python writes it, such as `(1, 1, 2)`. `fortran` if the first axis
/// counts up first.
pub(crate) fn array(shape: &str, fortran: bool, values: &[f64]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': '<f8', 'fortran_order': {order}, 'shape': {shape}, }}");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(118_u16.to_le_bytes());
    bytes.extend(format!("{header:<117}\n").bytes());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// Where the records of an array begin; None in a file that is too short to say.
pub(crate) fn start(array: &[u8]) -> Option<usize> {
    let length = array.get(8..10)?.try_into().ok()?;
    Some(10 + usize::from(u16::from_le_bytes(length)))
}

/// How many records a recording has, as its header says; None of a file without one.
pub(crate) fn records(array: &[u8]) -> Option<usize> {
    let header = String::from_utf8_lossy(array.get(..start(array)?)?).into_owned();
    let (_, shape) = header.split_once("'shape': (")?;
    shape.split(',').next()?.parse().ok()
}
