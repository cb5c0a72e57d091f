//! Parallel, resumable parameter sweeps of pneumatic muscles, and certified tables from them.

mod output;
pub mod plan;

pub use output::Output;
