//! Models against closed forms, shooting and finite differences: one program of tests, one module for each part.

mod closed_form;
mod derivatives;
mod held;
mod shooting;
