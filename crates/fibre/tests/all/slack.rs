//! A braid whose rubber alone carries the pressure has no equilibrium with taut fibres, and the answer says
//! so.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use bulge_fibre::{Approach, FibreError, Given, Problem, RangeEnd};
use bulge_muscles::{
    Angle, Braided, Construction, Fibre, Force, Length, Muscle, Parameter, Pressure, from_toml, preset,
};

#[test]
fn rubber_that_carries_the_pressure_leaves_the_fibres_slack() {
    let text = "name = \"x\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n\
                wall = \"2 mm\"\n[effects.bladder-elasticity]\nc10 = \"0.29 MPa\"\n";
    let muscle = from_toml(text, "m.toml").unwrap();
    let at = |bar: f64, e: f64| {
        let problem = Problem::new(&muscle, Pressure::bar(bar)).unwrap();
        problem.linearised(e, &problem.parts().still(), Approach::Auto)
    };
    assert!(
        matches!(at(1.0, 0.2), Err(FibreError::Slack { contraction, .. }) if contraction.to_bits() == 0.2_f64.to_bits())
    );
    // The hoop of a tube without fibres: p = (2 t/r0) W_2/(l1 l2), which the fibres take over as soon as p is
    // larger.
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

/// Where the fibres become slack, the rubber of the middle carries its whole meridional force, N = 2 pi
/// r0 t W_1/cos(alpha0). All messages about contractions beyond the limit name the same limit, at which the
/// muscle ceases to pull before its fibres are slack.
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
    let found = problem.linearised(taut, &problem.parts().still(), Approach::Auto).unwrap();
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

/// A braid of 60 fibres: length, radius and that of the fittings in mm, degrees.
fn braid(length: f64, radius: f64, fitting: f64, degrees: f64) -> Muscle {
    let braid = Braided::new(Length::mm(radius), Angle::deg(degrees)).unwrap().with_fibres(60).unwrap();
    let muscle = Muscle::new("braid", Length::mm(length), Construction::Braided(braid)).unwrap();
    muscle.with(Parameter::FittingRadius, Length::mm(fitting).to_m()).unwrap()
}

fn rubber(muscle: &Muscle, c10_kpa: f64, c01_kpa: f64, wall: f64) -> Muscle {
    let [c10, c01] = [c10_kpa, c01_kpa].map(|kpa| Pressure::kpa(kpa).to_pa());
    let wall = (Parameter::Wall, Length::mm(wall).to_m());
    muscle.with_all(&[wall, (Parameter::C10, c10), (Parameter::C01, c01)]).unwrap()
}

fn elastic(muscle: &Muscle, newton: f64) -> Muscle {
    muscle.clone().with_fibre(Fibre::new(Force::n(newton)).unwrap()).unwrap()
}

/// A volume that the muscle holds at a contraction at which it pulls is answered with an equilibrium, and a
/// larger one with the limit. This holds where the fibres become slack before the force vanishes (stiff
/// rubber on wide fittings, gas far inside), where stretched fibres give way and the volume falls before the
/// limit, and where a short muscle that is drawn out holds more again.
#[test]
fn a_volume_that_a_muscle_holds_is_found() {
    let wide = rubber(&braid(972.0, 11.58, 22.33, 15.4), 87.0, 0.0, 2.96);
    let inside = rubber(&elastic(&braid(46.9, 2.017, 2.017, 15.9), 16.2), 1328.0, 498.0, 0.0435);
    let inside = inside.with_gas_wall(Some(Length::mm(0.516))).unwrap();
    let soft = elastic(&preset("ppam-2-r16").unwrap(), 600.0);
    let short = elastic(&braid(20.0, 15.0, 15.0, 30.0), 300.0);
    for (muscle, kpa, ends_slack) in
        [(wide, 4.75, true), (inside, 16.3, true), (soft, 200.0, false), (short, 300.0, false)]
    {
        let problem = Problem::new(&muscle, Pressure::kpa(kpa)).unwrap();
        let end = problem.range_end(Approach::Auto).unwrap();
        assert_eq!(matches!(end, RangeEnd::FibresSlacken(_)), ends_slack, "{end:?}: {muscle:?}");
        let mut most: f64 = 0.0;
        for part in [1e-7, 1e-3, 3e-3, 0.01, 0.02, 0.05, 0.1] {
            let at = Given::Contraction(end.contraction() - part);
            let Ok(held) = problem.solve(at, Approach::Auto) else { continue };
            let found = problem.solve(Given::Volume(held.volume_m3), Approach::Auto);
            let found = found.unwrap_or_else(|error| panic!("{part} before {end:?}: {error}"));
            assert!((found.volume_m3 / held.volume_m3 - 1.0).abs() < 1e-9 && found.force_n > -1e-9);
            most = most.max(held.volume_m3);
        }
        let error = problem.solve(Given::Volume(2.0 * most), Approach::Auto).unwrap_err();
        let FibreError::VolumeTooLarge { high_m3, contraction, .. } = error else { panic!("{error}") };
        assert!(high_m3 >= most * (1.0 - 1e-9) && contraction <= end.contraction(), "{error}: {most}");
    }
}

/// Stiff rubber on narrow fittings stretches the fibres by 30.4 % at the muscle's length at rest, more than
/// the 30 % that drawing out may. Rounding of the length doesn't cause a refusal, and the range ends where
/// the force vanishes.
#[test]
fn stretched_at_rest_is_not_drawn_out() {
    let cloth = [(Parameter::HoopStiffness, 401.0), (Parameter::UnfoldedRadius, 7.026e-3)];
    let muscle = rubber(&elastic(&braid(160.73, 12.3614, 6.0022, 33.244), 64.483), 25_790.0, 0.0, 1.3977);
    let problem = Problem::new(&muscle.with_all(&cloth).unwrap(), Pressure::kpa(31.103)).unwrap();
    let at_rest = problem.solve(Given::Contraction(0.0), Approach::Auto).unwrap();
    assert!(at_rest.fibre_strain > bulge_fibre::MOST_STRAIN, "{}", at_rest.fibre_strain);
    let beside = problem.solve(Given::Length(0.160_73 * (1.0 + 1e-15)), Approach::Auto).unwrap();
    assert!((beside.force_n / at_rest.force_n - 1.0).abs() < 1e-9);
    let drawn = problem.solve(Given::Contraction(-1e-6), Approach::Auto).unwrap_err();
    assert!(matches!(drawn, FibreError::Overstretched { .. }), "{drawn}");
    let limit = problem.contraction_limit(Approach::Auto).unwrap();
    assert!(limit > 0.05 && limit < 0.06, "{limit}");
    let beyond = problem.solve(Given::Contraction(0.34), Approach::Auto).unwrap_err();
    assert!(matches!(beyond, FibreError::BeyondLimit { .. }), "{beyond}");
}
