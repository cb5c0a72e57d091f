//! Comparisons, fits, noise laws and diagnoses through the public API: one program of tests, one module for each part.

mod asked;
mod diagnose;
mod fits;
mod hidden_effects;
mod kept;
mod ladder;
mod noise_law;
mod papers;
mod simulation;
mod support;
