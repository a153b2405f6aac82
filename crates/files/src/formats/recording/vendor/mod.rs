//! Reads the files of the makers of sensors, a format in each file.

pub(super) mod tekscan;

pub(super) mod xsensor;
