//! Equilibria and numerical methods through the public API: one program of tests, one module for each part.

mod closed_form;
mod cloth_energy;
mod elastic_waist;
mod found_again;
mod quadrature_and_ode;
mod slack;
