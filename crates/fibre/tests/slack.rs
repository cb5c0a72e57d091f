//! A braid whose rubber alone carries the pressure has no equilibrium with taut fibres, and the answer says so.

use bulge_fibre::{Approach, FibreError, Problem};
use bulge_muscles::{Pressure, from_toml};

#[test]
fn rubber_that_carries_the_pressure_leaves_the_fibres_slack() {
    let text = "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n\
                wall = \"2 mm\"\n[effects.bladder-elasticity]\nc10 = \"0.29 MPa\"\n";
    let muscle = from_toml(text, "m.toml").unwrap();
    let at = |bar: f64, e: f64| {
        Problem::new(&muscle, Pressure::bar(bar)).unwrap().linearised(e, &[], Approach::Auto)
    };
    assert!(
        matches!(at(1.0, 0.2), Err(FibreError::Slack { contraction }) if contraction.to_bits() == 0.2_f64.to_bits())
    );
    // The hoop of a tube without fibres: p = (2 t/r0) W_2/(l1 l2), which the fibres take over as soon as p is larger.
    let (l1, cos): (f64, f64) = (0.8, 25.0_f64.to_radians().cos());
    let l2 = (1.0 - (l1 * cos).powi(2)).sqrt() / 25.0_f64.to_radians().sin();
    let carried = 2e-3 / 0.01 * 2.0 * 0.29 * (l2 - 1.0 / (l2.powi(3) * l1 * l1)) / (l1 * l2) * 10.0;
    assert!(matches!(at(0.99 * carried, 0.2), Err(FibreError::Slack { .. })), "{carried} bar");
    assert!(at(1.01 * carried, 0.2).is_ok(), "{carried} bar");
}
