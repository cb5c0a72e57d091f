//! Sweeps and tables through the public API: one program of tests, one module for each part.

mod run;
mod table;
