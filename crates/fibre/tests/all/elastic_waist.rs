//! Elastic braids drawn out to a waist: the tension at mid-length is an unknown of its own, since two
//! tensions can have one curvature.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use bulge_fibre::{Approach, FibreError, Problem};
use bulge_muscles::{Angle, Braided, Construction, Fibre, Force, Length, Muscle, Pressure};

/// A clamped braid of 60 elastic fibres: length and radius in mm, angle in degrees, stiffness EA of a fibre in N.
fn braid([length, radius, angle, stiffness]: [f64; 4], pressure: f64) -> Problem {
    let braid = Braided::new(Length::mm(radius), Angle::deg(angle)).unwrap().with_fibres(60).unwrap();
    let muscle = Muscle::new("braid", Length::mm(length), Construction::Braided(braid)).unwrap();
    let muscle = muscle.with_fibre(Fibre::new(Force::n(stiffness)).unwrap()).unwrap();
    Problem::new(&muscle, Pressure::pa(pressure)).unwrap()
}

/// The stiffness EA at which such a braid has the group 2 pi p r0^2/(n EA sin^2(alpha0)).
fn stiffness([radius, angle]: [f64; 2], pressure: f64, group: f64) -> f64 {
    let part = 1e-3 * radius / angle.to_radians().sin();
    std::f64::consts::TAU * pressure * part * part / (60.0 * group)
}

/// Forces of a braid of l0 = 55.8 mm, r0 = 10 mm, 7.22 degrees, 60 fibres of EA = 11 840 N at 32 676 Pa, from
/// an independent integration of the equilibrium in Hamiltonian form from the fitting inwards (SciPy,
/// relative tolerance 3e-13), 8 digits.
#[test]
fn force_agrees_with_an_independent_integration() {
    let problem = braid([55.8, 10.0, 7.22, 11_840.0], 32_676.0);
    for (contraction, force) in [(-0.0022, 1461.5701), (-0.0025, 1635.6432)] {
        let found = problem.follow(contraction, Approach::Auto).unwrap();
        assert!(found.mid_radius_m < 0.01, "no waist: {} m", found.mid_radius_m);
        assert!((found.force_n / force - 1.0).abs() < 1e-7, "{} N instead of {force} N", found.force_n);
    }
}

/// A braid whose fibres are too soft to carry the pressure as a cylinder between its fittings (group above 1/4) bulges, and
/// pulls. Forces and stiffnesses EA at a given radius at mid-length, from an independent integration of the equilibrium in
/// the arc length at rest (SciPy, relative tolerance 1e-9). Beyond r0/sin(alpha0) = 0.02366 m a fibre must stretch to get
/// there.
#[test]
fn soft_fibres_bulge_where_no_cylinder_carries_the_pressure() {
    for (radius, force, stiffness) in [
        (0.0215, 324.537, 75.9108),
        (0.0225, 291.045, 68.7674),
        (0.0235, 257.391, 63.0976),
        (0.0260, 173.095, 53.170),
        (0.0300, 41.677, 44.3871),
    ] {
        let found = braid([200.0, 10.0, 25.0, stiffness], 3e5).follow(0.05, Approach::Auto).unwrap();
        assert!((found.mid_radius_m / radius - 1.0).abs() < 1e-5, "{} m", found.mid_radius_m);
        assert!((found.force_n - force).abs() < 2e-3, "{} N instead of {force} N", found.force_n);
    }
}

/// The middle of a long braid is a cylinder wider than unstretched fibres allow. The equilibrium ODE finds what the
/// quadrature does, and the dimensionless group is all that counts: here 0.32.
#[test]
fn a_long_braid_of_soft_fibres_is_a_cylinder_between_its_ends() {
    let (angle, pressure): (f64, f64) = (20.0, 3e5);
    for (slenderness, contraction) in [(20.0, 0.1), (100.0, 0.0), (100.0, 0.15)] {
        let radius = 200.0 / slenderness;
        let problem = braid([200.0, radius, angle, stiffness([radius, angle], pressure, 0.32)], pressure);
        let [by_quadrature, by_ode] =
            [Approach::Auto, Approach::Shooting].map(|way| problem.follow(contraction, way).unwrap());
        let reach = 1e-3 * radius / angle.to_radians().sin();
        assert!(by_quadrature.mid_radius_m > reach, "{} m", by_quadrature.mid_radius_m);
        assert!((by_ode.force_n / by_quadrature.force_n - 1.0).abs() < 1e-9, "{slenderness} {contraction}");
        assert!(
            (by_ode.volume_m3 / by_quadrature.volume_m3 - 1.0).abs() < 1e-9,
            "{slenderness} {contraction}"
        );
    }
}

/// Fibres that would be stretched to twice their length balloon: no yarn bears that, although there is an equilibrium.
#[test]
fn fibres_stretched_to_twice_their_length_balloon() {
    let found = |group: f64| {
        let stiffness = stiffness([10.0, 15.4], 5e5, group);
        braid([205.0, 10.0, 15.4, stiffness], 5e5).follow(0.01, Approach::Auto)
    };
    let strain = |group: f64| found(group).unwrap().fibre_strain;
    assert!(strain(0.40) < strain(0.45) && strain(0.45) > 0.7 && strain(0.45) < 1.0);
    assert!(matches!(found(0.48), Err(FibreError::TooSoft { .. })), "{:?}", found(0.48));
}

/// Soft braids that no start leads to: where a cylinder at the fitting has just ceased to be (just above the group 7/27), and
/// between fittings wider than at rest, where stiff fibres have a waist. Forces from an independent integration (SciPy, DOP853,
/// residuals below 1e-12). Beyond the limit it is the limit that is told.
#[test]
fn soft_braids_are_walked_to() {
    let of = |length: &str, angle: &str, stiffness: &str, more: &str| {
        let text = format!(
            "name = \"soft\"\nkind = \"braided\"\nlength = \"{length} mm\"\nradius = \"10 mm\"\nbraid_angle = \"{angle} deg\"\n\
             fibres = 60\nfibre = {{ stiffness = \"{stiffness} N\" }}\nends = \"clamped\"\n{more}"
        );
        Problem::new(&bulge_muscles::from_toml(&text, "soft.toml").unwrap(), Pressure::bar(3.0)).unwrap()
    };
    let asked = |problem: &Problem, contraction: f64| {
        problem.solve(bulge_fibre::Given::Contraction(contraction), Approach::Auto)
    };
    let narrow = of("100", "40", "28.855875773070295", "");
    for (contraction, force) in [(0.055, 8.856), (0.07, 0.769)] {
        let found = asked(&narrow, contraction).unwrap();
        assert!((found.force_n - force).abs() < 1e-3, "{} N instead of {force} N", found.force_n);
    }
    let beyond = asked(&narrow, 0.2).unwrap_err();
    assert!(
        matches!(beyond, FibreError::BeyondLimit { limit, .. } if (limit - 0.071_44).abs() < 1e-5),
        "{beyond}"
    );
    let wide = of(
        "72.66734293143807",
        "31.15418077004014",
        "41.74546549218538",
        "[effects.end-radius]\nradius = \"15 mm\"\n",
    );
    let found = asked(&wide, 0.027_389_171_209_554_097).unwrap();
    assert!((found.force_n - 120.0).abs() < 1e-6, "{} N", found.force_n);
}

/// Gas inside a thick wall on narrow fittings: two cylinders have one tension, and the wider one is the middle of the muscle.
/// The limits are those that a reviewer's own search of the zero gave.
#[test]
fn soft_braids_with_gas_inside_their_fibres_are_found() {
    for (fitting, wall, group, limit) in
        [(5.0, 2.0, 0.35, 0.248), (3.0, 2.0, 0.30, 0.296), (7.0, 4.0, 0.40, 0.261)]
    {
        let stiffness = stiffness([10.0, 25.0], 3e5, group);
        let text = format!(
            "name = \"soft\"\nkind = \"braided\"\nlength = \"200 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nfibres = 60\n\
             fibre = {{ stiffness = \"{stiffness} N\" }}\nends = \"clamped\"\n\
             effects = {{ end-radius = {{ radius = \"{fitting} mm\" }}, wall-thickness = {{ thickness = \"{wall} mm\" }} }}\n"
        );
        let problem =
            Problem::new(&bulge_muscles::from_toml(&text, "soft.toml").unwrap(), Pressure::bar(3.0)).unwrap();
        let found = problem.contraction_limit(Approach::Auto).unwrap();
        assert!((found - limit).abs() < 6e-4, "{fitting} {wall}: limit {found}");
        let mut last = f64::INFINITY;
        for contraction in [0.0, 0.05, 0.1, 0.15, 0.2] {
            let [a, b] =
                [Approach::Auto, Approach::Shooting].map(|way| problem.follow(contraction, way).unwrap());
            assert!(
                (a.force_n / b.force_n - 1.0).abs() < 1e-8 && a.force_n < last,
                "{fitting} {contraction}"
            );
            last = a.force_n;
        }
    }
}
