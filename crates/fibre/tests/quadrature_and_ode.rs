//! Two independent ways to one equilibrium: `linearised` takes the meridian of inextensible fibres by quadrature, `follow` integrates the ODE.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use bulge_fibre::{Approach, Problem};
use bulge_muscles::{Length, LineStiffness, Muscle, Parameter, Pressure, Quantity, Unfolding, preset};

fn braid(length_mm: f64, angle_deg: f64) -> Muscle {
    let file = format!(
        "name = \"b\"\nkind = \"braided\"\nlength = \"{length_mm} mm\"\nradius = \"10 mm\"\nwall = \"1.8 mm\"\n\
         braid_angle = \"{angle_deg} deg\"\nends = \"clamped\"\n"
    );
    bulge_muscles::from_toml(&file, "braid").unwrap()
}

fn with(muscle: &Muscle, numbers: &[(Parameter, f64)]) -> Muscle {
    numbers.iter().fold(muscle.clone(), |muscle, (parameter, value)| muscle.with(*parameter, *value).unwrap())
}

#[test]
fn both_ways_give_the_same_equilibrium() {
    let bladder = [(Parameter::C10, 3e5), (Parameter::C01, 5e4)];
    let cloth = Unfolding::new(LineStiffness::from_si(8e4), Length::from_si(0.035)).unwrap();
    let pleated = preset("ppam-2-r16").unwrap();
    let muscles = [
        braid(300.0, 28.6),
        braid(1000.0, 45.0),
        with(&braid(300.0, 28.6), &bladder),
        with(&braid(40.0, 20.0), &bladder),
        with(
            &braid(200.0, 25.0),
            &[bladder[0], (Parameter::FittingRadius, 0.0085), (Parameter::GasWall, 1e-3)],
        ),
        with(&pleated, &[(Parameter::Misalignment, 0.1)]),
        pleated.clone().with_unfolding(cloth),
    ];
    let mut tried = 0;
    for muscle in &muscles {
        for bar in [1.0, 3.0, 6.0] {
            let problem = Problem::new(muscle, Pressure::bar(bar)).unwrap();
            for contraction in [-0.02, 0.0, 1e-6, 0.01, 0.05, 0.1, 0.2, 0.3] {
                let Ok(ode) = problem.follow(contraction, Approach::Shooting) else { continue };
                let found = problem.linearised(contraction, &[], Approach::Shooting).unwrap();
                let scale = 1e5 * bar * 1e-4;
                for (name, a, b, size) in [
                    ("force", ode.force_n, found.force_n.value, scale),
                    ("volume", ode.volume_polygon_m3, found.volume_polygon_m3.value, 0.0),
                    ("radius", ode.mid_radius_m, found.mid_radius_m.value, 0.0),
                ] {
                    let error = (a - b).abs() / (a.abs() + size);
                    // A muscle held far beyond its limit pushes with fibres that are nearly slack; the integration of the ODE loses digits there.
                    let most = if ode.force_n >= 0.0 { 3e-10 } else { 2e-7 };
                    assert!(error < most, "{name} {bar} bar {contraction} {a} {b} {error:e}: {muscle:?}");
                }
                tried += 1;
            }
        }
    }
    assert!(tried > 120, "{tried}");
}
