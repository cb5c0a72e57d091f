//! Membranes against closed forms and other solvers, and the readers of meshes: one program of tests, one module for each part.

mod ends;
mod equilibria;
mod readers;
mod refusals;
