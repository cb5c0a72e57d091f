//! Membranes against closed forms and other solvers, and the mesh readers: one test program, one module for
//! each part.

mod ends;
mod readers;
mod refusals;
mod triangles;
mod verification;
