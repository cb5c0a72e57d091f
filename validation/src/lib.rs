//! Verification of Bulge: every check with its error and its tolerance.
//!
//! A check compares results of the crates with a closed form, an independent method, an identity of
//! mechanics, the order of an error, or a published number. Run all checks as a table with `bulge validate`,
//! or as tests with `cargo test -p bulge-validation`.

mod braid;
mod check;
mod closed_form;
pub mod decisions;
mod derivative;
mod design;
mod difference;
pub mod domain;
mod energy;
mod fluidic_muscle;
mod force_laws;
pub mod integrals;
mod isobars;
mod limits;
mod lobes;
mod lobes_and_wall;
mod membrane;
mod meridian;
mod nist;
mod pleated_ladder;
mod published;
mod reference;
pub mod sample;
mod section;
mod shooting;
mod specimen;
mod tables;

pub use check::Check;

/// All checks in the order of the table, from exact solutions to published numbers.
pub const CHECKS: &[fn() -> Check] = &[
    nist::nonlinear_regression,
    closed_form::elliptic_integrals,
    closed_form::inelastic,
    closed_form::elastic,
    shooting::inextensible,
    shooting::elastic,
    shooting::along_the_fibre,
    shooting::pleats,
    braid::clamped_net,
    braid::tensions,
    braid::limits,
    braid::bladder,
    braid::misaligned,
    lobes_and_wall::gas_wall,
    lobes::touching,
    lobes::quadrature,
    lobes_and_wall::lobes,
    energy::virtual_work,
    energy::maxwell,
    energy::potential,
    derivative::gradients,
    derivative::gradients_by_shooting,
    derivative::linearised,
    derivative::stiffness,
    isobars::one_by_one,
    domain::sample,
    domain::by_integrals,
    membrane::spheres::sphere,
    membrane::spheres::limit_points,
    membrane::spheres::triangles,
    membrane::spheres::orders,
    membrane::spheres::gas,
    membrane::tubes::cylinders,
    membrane::tubes::clamped_tube,
    membrane::tubes::limit_point,
    membrane::tubes::orders,
    membrane::discs::hencky,
    membrane::discs::rubber_discs,
    membrane::discs::mylar,
    membrane::discs::mylar_of_triangles,
    membrane::discs::order_of_mylar,
    membrane::muscles::pleated,
    membrane::muscles::braided,
    membrane::muscles::braided_with_bladder,
    membrane::muscles::gas,
    membrane::slack::border,
    membrane::muscles::virtual_work,
    membrane::cloth::facets,
    membrane::cloth::facets_order,
    membrane::cloth::sectors,
    membrane::cloth::airbag,
    membrane::cloth::airbag_stress,
    membrane::cloth::wrinkled_panel,
    membrane::cloth::wrinkled_panel_order,
    membrane::plates::rectangles,
    membrane::plates::orders,
    tables::lookups,
    tables::gradients,
    meridian::first_integral,
    meridian::fibre_length,
    meridian::consistency,
    limits::small_angle,
    limits::long_braid,
    limits::stiff_fibres,
    limits::many_fibres,
    limits::mylar_balloon,
    lobes_and_wall::many_lobes,
    lobes_and_wall::thin_and_thick_wall,
    limits::force_at_rest,
    published::second_generation,
    published::contraction_limits,
    published::clamped_braids,
    published::cylinder_formula,
    published::inner_wall,
    published::measured_force,
    published::computed_volume,
    pleated_ladder::stated_radii,
    pleated_ladder::fits,
    fluidic_muscle::fibre_length_and_turns,
    fluidic_muscle::shipped_muscle,
    fluidic_muscle::drawn_out,
    force_laws::printed_functions,
    force_laws::sizing_examples,
    force_laws::correlation,
    force_laws::half_widths,
    force_laws::efficiencies,
    design::sizes,
    design::closed,
    design::filling,
    design::held,
];

/// Runs every check.
#[must_use]
pub fn all() -> Vec<Check> {
    CHECKS.iter().map(|check| check()).collect()
}
