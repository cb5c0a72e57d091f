//! The catalogue of effects and expressions: one program of tests, one module for each part.

mod catalogue;
mod expression_fuzz;
