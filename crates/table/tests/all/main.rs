//! Lookups and damaged tables: one test program, one module for each part, and a writer of tables that both
//! use.

mod damage;
mod lookup;
mod writer;
