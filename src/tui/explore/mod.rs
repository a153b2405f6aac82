//! Explore: every imprint of a shape. A form of ranges, the sweep in progress, the pages of its results, their export.
//!
//! ```text
//! message    what is asked for, and what workers answer
//! ranges     the form                                     running: work in progress
//! results    what was found and what is looked at         column: what its list is sorted by
//! export  filter  mark       prompts: a file, a condition, a letter     prompts: what keys do in the last two
//! page       what the results know of a page of theirs    pages: the table of pages
//! imprints  statistics  histogram  map  scatter  angles   the pages           drawing: a page in a file
//! work       from the form to the results                 update: what keys do over the results
//! view       tabs, what was swept, and the page
//! ```

pub mod message;

pub mod ranges;

pub mod running;

pub mod column;

pub mod results;

pub mod drawing;

pub mod export;

pub mod filter;

pub mod mark;

pub mod page;

pub mod imprints;

pub mod statistics;

pub mod histogram;

pub mod map;

pub mod scatter;

pub mod angles;

pub mod pages;

pub mod view;

pub mod work;

pub mod prompts;

pub mod update;
