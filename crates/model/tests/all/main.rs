//! Models against closed forms, shooting and finite differences: one test program with one module for each
//! topic.

mod closed_form;
mod derivatives;
mod held;
mod shooting;
