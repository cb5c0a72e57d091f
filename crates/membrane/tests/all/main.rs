//! Membranes against closed forms and other solvers, and the mesh readers: one test program, one module for
//! each part.

mod bending;
mod ends;
mod equilibria;
mod readers;
mod refusals;
