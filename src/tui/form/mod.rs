//! The forms of Figure, Picture and the sensor.

pub mod fields;

pub mod state;

pub mod layout;

pub mod view;

pub mod update;
