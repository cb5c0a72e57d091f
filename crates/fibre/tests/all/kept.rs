//! Equilibria of very different muscles, their values to nine digits and what they cost, as kept in `kept.tsv`.
//! The values are those of the independent checks of `bulge validate`; a change that moves one of them, or
//! takes more evaluations, is seen here.
//!
//! `BULGE_KEEP=1 cargo test -p bulge-fibre --test all kept` writes the file anew.

#![expect(clippy::unwrap_used, reason = "a test that cannot be set up fails")]

use bulge_fibre::{Approach, Convergence, Given, Parts, Problem, Response};
use bulge_muscles::{Muscle, Parameter, Pressure, from_toml};
use std::fmt::Write;

/// Names with keys of muscle files.
const MUSCLES: [(&str, &str); 19] = [
    ("pleated", "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n"),
    (
        "pleated elastic",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\nfibre = { stiffness = \"6 kN\" }\n",
    ),
    (
        "pleated slender",
        "kind = \"pleated\"\nlength = \"300 mm\"\nradius = \"12 mm\"\nfibres = 24\nfibre = { stiffness = \"25 kN\" }\n",
    ),
    (
        "pleated smooth",
        "kind = \"pleated\"\nlength = \"60 mm\"\nradius = \"25 mm\"\nfibres = \"continuous\"\n",
    ),
    (
        "cylinder",
        "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n",
    ),
    (
        "cylinder rubber",
        "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\nwall = \"2 mm\"\n\
         fibres = 60\nfibre = { stiffness = \"9 kN\" }\neffects = { bladder-elasticity = { c10 = \"0.25 MPa\", c01 = \"0.02 MPa\" } }\n",
    ),
    (
        "braid",
        "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\n",
    ),
    (
        "braid short",
        "kind = \"braided\"\nlength = \"60 mm\"\nradius = \"12 mm\"\nbraid_angle = \"28 deg\"\nends = \"clamped\"\n",
    ),
    (
        "braid narrow ends",
        "kind = \"braided\"\nlength = \"120 mm\"\nradius = \"12 mm\"\nbraid_angle = \"24 deg\"\nends = \"clamped\"\neffects = { end-radius = { radius = \"7 mm\" } }\n",
    ),
    (
        "braid wide ends",
        "kind = \"braided\"\nlength = \"150 mm\"\nradius = \"10 mm\"\nbraid_angle = \"24 deg\"\nends = \"clamped\"\neffects = { end-radius = { radius = \"12 mm\" } }\n",
    ),
    (
        "braid rubber",
        "kind = \"braided\"\nlength = \"200 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\nwall = \"2 mm\"\n\
         effects = { bladder-elasticity = { c10 = \"0.3 MPa\" } }\n",
    ),
    (
        "braid stiff rubber",
        "kind = \"braided\"\nlength = \"90 mm\"\nradius = \"9 mm\"\nbraid_angle = \"30 deg\"\nends = \"clamped\"\nwall = \"2.5 mm\"\n\
         effects = { bladder-elasticity = { c10 = \"0.9 MPa\", c01 = \"0.1 MPa\" } }\n",
    ),
    (
        "braid elastic",
        "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\nfibres = 60\n\
         fibre = { stiffness = \"9 kN\" }\n",
    ),
    (
        "braid elastic rubber",
        "kind = \"braided\"\nlength = \"140 mm\"\nradius = \"10 mm\"\nbraid_angle = \"27 deg\"\nends = \"clamped\"\nwall = \"1.5 mm\"\n\
         fibres = 60\nfibre = { stiffness = \"9 kN\" }\neffects = { bladder-elasticity = { c10 = \"0.3 MPa\" } }\n",
    ),
    (
        "braid gas inside",
        "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\nwall = \"2 mm\"\n\
         effects = { wall-thickness = { thickness = \"1 mm\" }, bladder-elasticity = { c10 = \"0.2 MPa\" } }\n",
    ),
    (
        "pleated pleats",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\nfibre = { stiffness = \"12.5 kN\" }\n\
         effects = { pleat-depth = { depth = \"2 mm\" } }\n",
    ),
    (
        "pleated cloth",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\nfibre = { stiffness = \"12.5 kN\" }\n\
         effects = { limited-unfolding = { hoop_stiffness = \"81 kN/m\", unfolded_radius = \"28 mm\" } }\n",
    ),
    (
        "pleated lobes",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 12\neffects = { lobes = { circumference = \"330 mm\" } }\n",
    ),
    (
        "pleated twist",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\neffects = { fibre-misalignment = { angle = \"4 deg\" } }\n",
    ),
];
const BARS: [f64; 2] = [0.8, 3.5];
const CONTRACTIONS: [f64; 5] = [0.003, 0.02, 0.08, 0.15, 0.22];
/// Relative accuracy of kept values: ten times what other processors' elementary functions differ by.
const CLOSE: f64 = 1e-9;
/// More evaluations than kept that are no change: one step of an integration.
const MORE: f64 = 1.02;

fn muscle(keys: &str) -> Muscle {
    from_toml(&format!("name = \"m\"\n{keys}"), "m.toml").unwrap()
}

/// A line: what was asked, values, evaluations. `scale` is of the values whose zero means nothing.
struct Line {
    asked: String,
    values: Vec<f64>,
    evaluations: u32,
}

impl Line {
    fn of(asked: String, found: &Response) -> Self {
        let Response { force_n, length_m, volume_m3, volume_polygon_m3, max_radius_m, .. } = *found;
        let values = vec![
            force_n,
            length_m,
            volume_m3,
            volume_polygon_m3,
            max_radius_m,
            found.mid_radius_m,
            found.fibre_tension_n,
            found.fibre_strain,
            found.stiffness_n_per_m,
            found.volume_slope_m2,
            found.stiffness_isothermal_n_per_m,
            found.stiffness_adiabatic_n_per_m,
            found.end_slope_rad,
        ];
        let Convergence { iterations, evaluations, residual, first_integral, .. } = found.convergence;
        assert!(residual < 1e-8 && first_integral < 1e-8, "{asked}: {residual:e} {first_integral:e}");
        let evaluations = evaluations + iterations;
        Self { asked, values, evaluations }
    }

    fn without(asked: &str, error: &bulge_fibre::FibreError) -> Self {
        // The kind of the error, without its numbers.
        let kind = format!("{error:?}");
        let kind = kind.split([' ', '(']).next().unwrap_or_default().to_owned();
        Self { asked: format!("{asked}: {kind}"), values: Vec::new(), evaluations: 0 }
    }
}

/// All that is asked about a muscle at a pressure.
fn lines(name: &str, keys: &str, bar: f64) -> Vec<Line> {
    let muscle = muscle(keys);
    let problem = Problem::new(&muscle, Pressure::bar(bar)).unwrap();
    let mut lines = Vec::new();
    let mut add = |what: String, found: Result<Response, bulge_fibre::FibreError>| {
        let asked = format!("{name}, {bar} bar, {what}");
        lines.push(match &found {
            Ok(found) => Line::of(asked, found),
            Err(error) => Line::without(&asked, error),
        });
        found.ok()
    };
    for contraction in CONTRACTIONS {
        let found = add(format!("contraction {contraction}"), problem.follow(contraction, Approach::Auto));
        let Some(found) = found.filter(|found| found.force_n > 0.0) else { continue };
        // Half way to the next one, so that nothing is solved before it is asked.
        add(
            format!("force of {contraction}"),
            problem.solve(Given::Force(0.9 * found.force_n), Approach::Auto),
        );
        add(
            format!("volume of {contraction}"),
            problem.solve(Given::Volume(1.02 * found.volume_m3), Approach::Auto),
        );
    }
    add("no force".to_owned(), problem.solve(Given::Force(0.0), Approach::Auto));
    add("shooting".to_owned(), problem.follow(0.1, Approach::Shooting));
    if let Ok(limit) = problem.contraction_limit(Approach::Auto) {
        let asked = format!("{name}, {bar} bar, end");
        lines.push(Line {
            asked,
            values: vec![limit, problem.range_end(Approach::Auto).unwrap().contraction()],
            evaluations: 0,
        });
    }
    if let Ok(isobar) = problem.isobar(&[-0.02, 0.01, 0.05, 0.1, 0.2, 0.3], Approach::Auto) {
        let values =
            isobar.points.iter().flat_map(|point| [point.contraction, point.force_n, point.volume_m3]);
        let evaluations = isobar.points.iter().map(|point| point.convergence.evaluations).sum();
        let asked = format!("{name}, {bar} bar, isobar without {}", isobar.without.len());
        lines.push(Line { asked, values: values.collect(), evaluations });
    }
    if let Ok(gradient) = problem.gradient(0.08, Approach::Auto) {
        let by_part = gradient.by_part.iter().flat_map(|(_, by)| *by);
        let values = gradient.by_contraction.into_iter().chain(gradient.by_pressure).chain(by_part);
        lines.push(Line {
            asked: format!("{name}, {bar} bar, gradient"),
            values: values.collect(),
            evaluations: 0,
        });
    }
    let moving = Parts::seeded(&muscle, &[Parameter::Length, Parameter::Radius]);
    if let Ok(found) = problem.linearised(0.08, &moving, Approach::Auto) {
        let linear = [found.force_n, found.equator_force_n, found.mid_radius_m, found.volume_polygon_m3];
        let values = linear
            .iter()
            .flat_map(|l| [l.value, l.by_contraction, l.by_pressure, l.by_lane[0], l.by_lane[1]]);
        lines.push(Line {
            asked: format!("{name}, {bar} bar, linearised"),
            values: values.collect(),
            evaluations: found.convergence.evaluations,
        });
    }
    if let Ok(shape) = problem.shape(Given::Contraction(0.08), Approach::Auto, 9) {
        let values = shape
            .meridian
            .iter()
            .flat_map(|point| [point.x_m, point.r_m, point.slope_rad, point.braid_angle_rad]);
        let mut values: Vec<f64> = values.collect();
        if let Some(numbers) = problem.pleated_numbers(&shape.response) {
            values.extend([numbers.m, numbers.phi_r, numbers.force_f, numbers.volume_v]);
        }
        lines.push(Line { asked: format!("{name}, {bar} bar, shape"), values, evaluations: 0 });
    }
    lines
}

#[test]
fn kept_equilibria_and_their_cost() {
    let found: Vec<Line> =
        MUSCLES.iter().flat_map(|(name, keys)| BARS.map(|bar| lines(name, keys, bar))).flatten().collect();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/all/kept.tsv");
    if std::env::var_os("BULGE_KEEP").is_some() {
        let mut text = String::new();
        for line in &found {
            let values: Vec<String> = line.values.iter().map(|value| format!("{value:.10e}")).collect();
            writeln!(text, "{}\t{}\t{}", line.asked, line.evaluations, values.join(" ")).unwrap();
        }
        std::fs::write(path, text).unwrap();
    }
    let kept = std::fs::read_to_string(path).unwrap();
    assert_eq!(kept.lines().count(), found.len());
    let mut differ = Vec::new();
    for (line, kept) in found.iter().zip(kept.lines()) {
        let mut parts = kept.split('\t');
        let mut next = || parts.next().unwrap_or_default();
        let (asked, evaluations) = (next(), next().parse::<f64>().unwrap());
        let values: Vec<f64> = next().split_whitespace().map(|value| value.parse().unwrap()).collect();
        // Values near zero are differences of larger ones, which are as exact as the largest beside them.
        let off = line
            .values
            .iter()
            .zip(&values)
            .map(|(a, b)| (a - b).abs() / (b.abs() + 1e-6))
            .fold(0.0, f64::max);
        let same = line.asked == asked && line.values.len() == values.len() && off < CLOSE;
        if !same || f64::from(line.evaluations) > MORE * evaluations + 1.0 {
            differ.push(format!(
                "{asked}: {off:e}, {} of {evaluations} evaluations; found {}",
                line.evaluations, line.asked
            ));
        }
    }
    assert!(differ.is_empty(), "{} differ:\n{}", differ.len(), differ[..differ.len().min(20)].join("\n"));
}
