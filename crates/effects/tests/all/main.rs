//! The catalogue of effects and expressions: one test program with one module for each topic.

mod catalogue;
mod expression_fuzz;
