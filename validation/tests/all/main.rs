//! The verification tables, properties of the physics, and the rules that sources keep to: one program of tests, one module for each part.

mod new_effect;
mod properties;
mod tidy;
mod verification;
