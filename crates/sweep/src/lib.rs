//! Parallel parameter sweeps and certified tables.
