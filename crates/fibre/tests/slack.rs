//! A braid whose rubber alone carries the pressure has no equilibrium with taut fibres, and the answer says so.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use bulge_fibre::{Approach, FibreError, Given, Problem};
use bulge_muscles::{Muscle, Pressure, from_toml};

#[test]
fn rubber_that_carries_the_pressure_leaves_the_fibres_slack() {
    let text = "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n\
                wall = \"2 mm\"\n[effects.bladder-elasticity]\nc10 = \"0.29 MPa\"\n";
    let muscle = from_toml(text, "m.toml").unwrap();
    let at = |bar: f64, e: f64| {
        Problem::new(&muscle, Pressure::bar(bar)).unwrap().linearised(e, &[], Approach::Auto)
    };
    assert!(
        matches!(at(1.0, 0.2), Err(FibreError::Slack { contraction, .. }) if contraction.to_bits() == 0.2_f64.to_bits())
    );
    // The hoop of a tube without fibres: p = (2 t/r0) W_2/(l1 l2), which the fibres take over as soon as p is larger.
    let (l1, cos): (f64, f64) = (0.8, 25.0_f64.to_radians().cos());
    let l2 = (1.0 - (l1 * cos).powi(2)).sqrt() / 25.0_f64.to_radians().sin();
    let carried = 2e-3 / 0.01 * 2.0 * 0.29 * (l2 - 1.0 / (l2.powi(3) * l1 * l1)) / (l1 * l2) * 10.0;
    assert!(matches!(at(0.99 * carried, 0.2), Err(FibreError::Slack { .. })), "{carried} bar");
    assert!(at(1.01 * carried, 0.2).is_ok(), "{carried} bar");
}

/// 250 mm, r0 = 9.75 mm, 25 degrees, clamped, 2 mm of neo-Hookean rubber.
fn clamped() -> Muscle {
    let text = "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"9.75 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\n\
                wall = \"2 mm\"\n[effects.bladder-elasticity]\nc10 = \"0.3 MPa\"\n";
    from_toml(text, "m.toml").unwrap()
}

/// Where the fibres become slack, the rubber of the middle carries its whole meridional force, N = 2 pi r0 t W_1/cos(alpha0), and what
/// is said of contractions beyond the limit is one thing: the limit, at which the muscle ceases to pull before its fibres are slack.
#[test]
fn fibres_become_slack_where_the_rubber_carries_all() {
    let problem = Problem::new(&clamped(), Pressure::bar(0.5)).unwrap();
    let limit = problem.contraction_limit(Approach::Auto).unwrap();
    let (mut taut, mut slack) = (limit, 0.06);
    assert!(matches!(problem.follow(slack, Approach::Auto), Err(FibreError::Slack { .. })));
    while slack - taut > 1e-10 {
        let middle = 0.5 * (taut + slack);
        match problem.follow(middle, Approach::Auto) {
            Ok(_) => taut = middle,
            Err(FibreError::Slack { .. }) => slack = middle,
            Err(error) => panic!("{middle}: {error}"),
        }
    }
    let found = problem.linearised(taut, &[], Approach::Auto).unwrap();
    let (sin, cos) = 25.0_f64.to_radians().sin_cos();
    let (r0, wall, c10) = (9.75e-3, 2e-3, 0.3e6);
    let l2 = found.mid_radius_m.value / r0;
    let l1 = (1.0 - (l2 * sin).powi(2)).sqrt() / cos;
    let rubber = 2.0 * std::f64::consts::PI * r0 * wall * 2.0 * c10 * (l1 - 1.0 / (l1.powi(3) * l2 * l2));
    let share = rubber / found.equator_force_n.value - 1.0;
    assert!(share.abs() < 1e-6, "the fibres still carry {share:e} of the force");
    assert!(found.force_n.value < 0.0);
    for contraction in [0.05, 0.1695, 0.3] {
        let error = problem.solve(Given::Contraction(contraction), Approach::Auto).unwrap_err();
        let named = matches!(error, FibreError::BeyondLimit { limit: named, .. } if named.to_bits() == limit.to_bits());
        assert!(named, "{error}");
    }
}
