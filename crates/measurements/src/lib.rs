//! Measured force maps and histories: CSV and Parquet in, sweeps, directions, repeats and a quality gate.
