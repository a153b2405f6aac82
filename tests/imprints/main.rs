//! From a shape to its imprint, regions and descriptors: by hand, by a second method, and over whole grids of poses.

#![expect(
    clippy::disallowed_methods,
    reason = "second methods may use the system's mathematics: what they give is compared within a tolerance"
)]

#[path = "../common/mod.rs"]
mod common;

#[path = "../common/paper.rs"]
mod paper;

#[path = "../common/property.rs"]
mod property;

#[path = "../common/skip.rs"]
mod skip;

mod arithmetic;

mod border_following;

mod coverage;

mod regions;

mod second_method;

mod ties;

mod properties;

mod answers;

mod recognition;

mod noise;

mod outlines;

mod reference;

mod sweep;

mod drawings;
