//! The command as seen by a user: one test program, one module for each part.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

mod commands;
mod compare;
mod design;
mod diagnose;
mod faults;
mod hostile;
mod joint;
mod membrane;
mod next;
mod plan;
mod schema;
mod schemas;
mod simulate;
mod size;
mod support;
mod sweep;
