//! Reading files of measurements, analysing them, and surviving bad ones: one test program, one module for
//! each part.

mod asked;
mod files;
mod history;
mod robustness;
