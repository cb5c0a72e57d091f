//! Benchmarks of Bulge.
