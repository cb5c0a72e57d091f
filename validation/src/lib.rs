//! Verification of Bulge: every check with its error and its tolerance.
