//! Tests of sweeps and tables through the public API, in one program with one module for each part.

mod run;
mod table;
