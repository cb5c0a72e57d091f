//! The reports through the public API: one test program, one module per kind, and the samples of both.

mod comparison;
mod diagnosed;
mod diagnosis;
mod page;
mod sample;
