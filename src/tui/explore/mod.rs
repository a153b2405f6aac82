//! Explore: every imprint of a shape. Here are the form of ranges, the sweep in progress, the pages of its results,
//! and their export.
//!
//! ```text
//! message    requests by keys and commands, and findings of a sweep
//! ranges     the form                                     running: work in progress
//! results    the findings, and what is shown of them      column: the columns to sort the list by
//! export  filter  mark       the prompts for a file name, a condition and a letter
//! prompts    handles messages in filter and mark
//! page       the type of a page of the results            pages: the table of pages
//! imprints  statistics  histogram  map  scatter  angles   the pages
//! work       from the form to the results                 update: what keys do over the results
//! view       tabs, summary, and the page
//! ```

pub mod message;

pub mod ranges;

pub mod running;

pub mod column;

pub mod results;

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
