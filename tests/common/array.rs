//! Recordings as numpy arrays: builds small ones, and reads the header of those that the program has written.
#![allow(dead_code, reason = "every test file uses its own part of this one")]

/// Returns the bytes of a `.npy` file of f64 values. `shape` is written as in Python, such as `(1, 1, 2)`; with
/// `fortran`, the first axis varies fastest.
pub(crate) fn array(shape: &str, fortran: bool, values: &[f64]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let header = format!("{{'descr': '<f8', 'fortran_order': {order}, 'shape': {shape}, }}");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend(118_u16.to_le_bytes());
    bytes.extend(format!("{header:<117}\n").bytes());
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// Returns where the records of an array begin; None if the file is too short to say.
pub(crate) fn start(array: &[u8]) -> Option<usize> {
    let length = array.get(8..10)?.try_into().ok()?;
    Some(10 + usize::from(u16::from_le_bytes(length)))
}

/// Returns the number of records that the header of a recording gives; None if the file has no header.
pub(crate) fn records(array: &[u8]) -> Option<usize> {
    let header = String::from_utf8_lossy(array.get(..start(array)?)?).into_owned();
    let (_, shape) = header.split_once("'shape': (")?;
    shape.split(',').next()?.parse().ok()
}
