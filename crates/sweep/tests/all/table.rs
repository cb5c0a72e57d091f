//! Certified tables of muscles: gradients, errors at new points, edges, sizes, and the same bytes on any
//! number of threads.

#![expect(clippy::unwrap_used, reason = "a test that cannot go on has failed")]

use std::f64::consts::TAU;
use std::fmt::Write;

use bulge_fibre::{Approach, Problem};
use bulge_muscles::{Parameter, Pressure, Quantity as _};
use bulge_numerics::Random;
use bulge_sweep::plan::{TableForm, TableRequirements};
use bulge_sweep::{
    BuildError, Built, Family, Output, Plan, TableDescription, TabulateError, table_text, tabulate,
};
use bulge_table::{Form, Table};

const PPAM: &str = "muscle = \"ppam-2-r16\"\n[axes.contraction]\nrange = \"2 %..limit\"\n[axes.slenderness]\nrange = \"4..12\"\n\
    [table]\ntolerance = 1e-5\ngradient = 1e-3\n";

fn plan(text: &str) -> Plan {
    Plan::from_toml(text, "sweep.toml", None).unwrap()
}

/// A plan and its requirements with few checks; the number that a file must have would take too long here.
fn wished(text: &str, checks: u64) -> (Plan, TableRequirements) {
    let plan = plan(text);
    let wish = TableRequirements { checks, ..plan.table.clone().unwrap() };
    (plan, wish)
}

fn built(plan: &Plan, wish: &TableRequirements) -> Built {
    tabulate(plan, wish, &|_| ()).unwrap()
}

/// Values and gradients of two outputs over `A` axes.
fn look<const A: usize>(table: &Table<'_>, point: [f64; A]) -> Option<[(f64, [f64; A]); 2]> {
    let found = table.lookup::<A, 2>().unwrap().at(point)?;
    Some(found.map(|sample| (sample.value, sample.gradient)))
}

/// Relative difference. Small values are compared with a thousandth of the largest, as
/// `bulge_table::Certificate` defines it.
fn off(found: f64, exact: f64, scale: f64) -> f64 {
    (found - exact).abs() / exact.abs().max(1e-3 * scale)
}

/// A muscle, its axes with ranges, a point, and the expected accuracy of the gradients.
type Case<'a> = (&'a str, &'a [(&'a str, &'a str, f64)], f64);

#[test]
fn gradients_of_a_family_are_its_differences() {
    let cases: [Case<'_>; 13] = [
        ("ppam-2-r16", &[("contraction", "0.1..0.3", 0.2)], 1e-7),
        ("ppam-2-r16", &[("contraction", "0.1..0.3", 0.15), ("pressure", "1 bar..2 bar", 1.4e5)], 1e-7),
        ("ppam-2-r16", &[("slenderness", "4..8", 6.0), ("contraction", "0.1..0.3", 0.2)], 1e-7),
        ("ppam-2-r16", &[("slenderness", "4..8", 5.0), ("length", "0.1 m..0.2 m", 0.13)], 1e-7),
        ("ppam-2-r16", &[("length", "0.1 m..0.2 m", 0.13), ("slenderness", "4..8", 5.0)], 1e-7),
        ("ppam-2-r16", &[("length", "0.1 m..0.2 m", 0.13), ("radius", "10 mm..20 mm", 0.015)], 1e-7),
        ("ppam-2-r16", &[("fibre_stiffness", "2 kN..20 kN", 5e3), ("pressure", "1 bar..2 bar", 1.4e5)], 1e-7),
        ("ppam-2-r16", &[("elastic_group", "0.001..0.02", 0.01)], 1e-7),
        (
            "ppam-2-r16",
            &[
                ("elastic_group", "0.001..0.02", 0.01),
                ("pressure", "1 bar..2 bar", 1.4e5),
                ("slenderness", "4..8", 6.0),
            ],
            1e-7,
        ),
        (
            "ppam-2-r16",
            &[
                ("slenderness", "4..8", 6.0),
                ("length", "0.1 m..0.2 m", 0.13),
                ("elastic_group", "0.001..0.02", 0.01),
                ("contraction", "0.1..0.3", 0.18),
            ],
            1e-7,
        ),
        ("dmsp-20-250", &[("braid_angle", "22 deg..28 deg", 0.43), ("contraction", "0.05..0.2", 0.1)], 1e-6),
        ("dmsp-20-250", &[("length", "0.2 m..0.3 m", 0.26), ("pressure", "1 bar..6 bar", 3e5)], 1e-6),
        ("dmsp-20-250", &[("slenderness", "20..30", 24.0), ("length", "0.2 m..0.3 m", 0.26)], 1e-6),
    ];
    let outputs = [Output::ForceF, Output::VolumeV, Output::Force, Output::Volume];
    for (muscle, axes, within) in cases {
        let names: Vec<&str> = axes.iter().map(|(name, _, _)| *name).collect();
        let mut text = format!("muscle = \"{muscle}\"\n");
        for (name, fixed) in [("contraction", "0.2"), ("pressure", "\"2 bar\"")] {
            if !names.contains(&name) {
                writeln!(text, "{name} = {fixed}").unwrap();
            }
        }
        for (name, range, _) in axes {
            writeln!(text, "[axes.{name}]\nrange = \"{range}\"").unwrap();
        }
        text += "[table]\n";
        let plan = plan(&text);
        let family = Family::new(&plan).unwrap();
        let point: Vec<f64> = axes.iter().map(|(_, _, x)| *x).collect();
        let (mut values, mut gradients) = ([0.0; 4], vec![0.0; 4 * axes.len()]);
        family.gradients(&point, &outputs, &mut values, &mut gradients).unwrap();
        let at = |point: &[f64]| {
            let mut values = [0.0; 4];
            let member = family.member(point).unwrap();
            member.outputs(family.contraction(point), &outputs, &mut values).unwrap();
            values
        };
        assert_eq!(at(&point).map(f64::to_bits), values.map(f64::to_bits));
        for i in 0..point.len() {
            let step = 1e-3 * point[i];
            let beside = |times: f64| {
                let mut moved = point.clone();
                moved[i] += times * step;
                at(&moved)
            };
            let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(beside);
            for o in 0..4 {
                let difference = (a[o] - 8.0 * b[o] + 8.0 * c[o] - d[o]) / (12.0 * step);
                let size = difference.abs().max(values[o].abs() / point[i]);
                let error = (gradients[o * point.len() + i] - difference).abs() / size;
                assert!(
                    error < within,
                    "{muscle} {names:?}: d({})/d({}) is off by {error:e}",
                    outputs[o].name(),
                    names[i]
                );
            }
        }
    }
}

#[test]
fn a_family_with_whole_fibres_has_gradients_too() {
    // f, v and F continue between whole numbers of fibres, because they depend on n sin(2 pi/n).
    let plan = plan("muscle = \"ppam-2-r16\"\ncontraction = 0.2\n[axes.fibres]\nlist = [40]\n");
    let family = Family::new(&plan).unwrap();
    let outputs = [Output::ForceF, Output::Force];
    let (mut values, mut gradients) = ([0.0; 2], [0.0; 2]);
    family.gradients(&[40.0], &outputs, &mut values, &mut gradients).unwrap();
    let a = |n: f64| n / TAU * (TAU / n).sin();
    let growth = (a(40.001) - a(39.999)) / 0.002 / a(40.0);
    assert!((gradients[1] / values[1] - growth).abs() < 1e-8, "{}", gradients[1] / values[1] - growth);
    assert!(gradients[0].abs() < 1e-12 * values[0]);
}

/// Largest errors of values and gradients of f and v at random points of a table over (contraction,
/// slenderness), and the largest error of its edge.
fn fresh_errors(plan: &Plan, table: &Table<'_>, points: usize) -> ([[f64; 2]; 2], f64) {
    let family = Family::new(plan).unwrap();
    let scales = [0, 1].map(|o| table.output(o).unwrap().certificate.scale);
    let mut random = Random::new(20_260_101, 5);
    let (mut worst, mut edge) = ([[0.0_f64; 2]; 2], 0.0_f64);
    for k in 0..points {
        let slenderness = 4.0 + 8.0 * random.uniform();
        let high = table.upper_end(&[0.0, slenderness]).unwrap();
        let contraction = 0.02 + (high - 0.02) * random.uniform();
        let point = [contraction, slenderness];
        let (mut values, mut gradients) = ([0.0; 2], [0.0; 4]);
        family.gradients(&point, &[Output::ForceF, Output::VolumeV], &mut values, &mut gradients).unwrap();
        let found = look(table, point).unwrap();
        for o in 0..2 {
            worst[o][0] = worst[o][0].max(off(found[o].0, values[o], scales[o]));
            for i in 0..2 {
                let width = [high - 0.02, 8.0][i];
                let exact = gradients[2 * o + i];
                let size = exact.abs().max(values[o].abs().max(1e-3 * scales[o]) / width);
                worst[o][1] = worst[o][1].max((found[o].1[i] - exact).abs() / size);
            }
        }
        if k % 20 == 0 {
            let limit = family.member(&point).unwrap().contraction_limit().unwrap();
            edge = edge.max((limit - high).abs());
        }
    }
    (worst, edge)
}

#[test]
fn a_certified_table_keeps_its_promise_where_nobody_looked() {
    for form in [TableForm::Splines, TableForm::Chebyshev] {
        let (plan, wish) = wished(PPAM, 4096);
        let wish = TableRequirements { form, ..wish };
        let Built { bytes, is_met, certificates } = built(&plan, &wish);
        assert!(is_met && bytes.len() as u64 <= wish.max_bytes, "{form:?}: {certificates:?}");
        let table = Table::from_bytes(&bytes).unwrap();
        assert_eq!(table.form() == Form::Spline, form == TableForm::Splines);
        let (worst, edge) = fresh_errors(&plan, &table, 3000);
        for (o, [value, gradient]) in worst.into_iter().enumerate() {
            let promised = table.output(o).unwrap().certificate;
            assert_eq!(promised, certificates[o]);
            // Slightly more than the measured error may occur elsewhere, but not more than the tolerance or
            // the bound.
            assert!(
                value <= wish.tolerance && gradient <= wish.gradient,
                "{form:?} {o}: {value:e} {gradient:e}"
            );
            assert!(value <= 1.05 * promised.bound, "{form:?} {o}: {value:e} is above {promised:?}");
            assert!(promised.value_max <= wish.tolerance && promised.value_rms <= promised.value_max);
            assert!(promised.bound >= promised.value_max && promised.gradient_max <= wish.gradient);
            assert!(promised.value_max > 0.2 * value, "{promised:?} {value:e}");
        }
        assert!(edge < 1e-8, "{form:?}: the edge is off by {edge:e}");
        assert!(table.edge_error() < 1e-8 && table.checks()[0] == 4096);
    }
}

#[test]
fn force_and_volume_of_a_table_belong_together() {
    let (plan, wish) = wished(PPAM, 4096);
    let bytes = built(&plan, &wish).bytes;
    let table = Table::from_bytes(&bytes).unwrap();
    let muscle = &plan.muscle;
    let (length, n) = (muscle.length().si(), 40.0);
    let a = n / TAU * (TAU / n).sin();
    let mut worst = [0.0_f64; 3];
    for i in 0..200_u32 {
        let slenderness = 4.0 + 8.0 * f64::from(i % 20) / 19.0;
        let high = table.upper_end(&[0.0, slenderness]).unwrap();
        let contraction = 0.02 + (high - 0.021) * f64::from(i / 20) / 9.0;
        let radius = muscle.with(Parameter::Radius, length / slenderness).unwrap();
        let problem = Problem::new(&radius, Pressure::bar(1.0)).unwrap();
        let response = problem.follow(contraction, Approach::Auto).unwrap();
        let [(f, _), (v, by_v)] = look(&table, [contraction, slenderness]).unwrap();
        // F = p l0^2 a f, V = l0^3 v. The work of the gas equals that of the force, so f = dv/d(contraction).
        let scale = 1e5 * length * length * a;
        worst[0] = worst[0].max((scale * f - response.force_n).abs() / response.force_n.max(1e-3 * scale));
        worst[1] = worst[1].max((length.powi(3) * v / response.volume_m3 - 1.0).abs());
        worst[2] = worst[2].max((f - by_v[0]).abs() / f.max(0.02));
    }
    assert!(worst[0] < 1e-4 && worst[1] < 1e-5 && worst[2] < 1e-3, "{worst:?}");
}

#[test]
fn outside_there_is_nothing() {
    let (plan, wish) = wished(PPAM, 2048);
    let bytes = built(&plan, &wish).bytes;
    let table = Table::from_bytes(&bytes).unwrap();
    for slenderness in [4.0, 4.1, 6.875, 11.0, 12.0] {
        let high = table.upper_end(&[0.0, slenderness]).unwrap();
        assert!(look(&table, [high, slenderness]).is_some());
        assert!(look(&table, [0.02, slenderness]).is_some());
        for contraction in [high + 1e-12, high + 0.01, 0.02 - 1e-12, -0.1, f64::NAN, f64::INFINITY] {
            assert!(look(&table, [contraction, slenderness]).is_none(), "{contraction} {slenderness}");
        }
        // The force at the edge is that at the limit, which is zero.
        let [(f, _), (v, _)] = look(&table, [high, slenderness]).unwrap();
        assert!(f.abs() < 1e-9 && v > 0.0);
    }
    for slenderness in [4.0 - 1e-12, 12.0 + 1e-12, 0.0, f64::NAN] {
        assert!(look(&table, [0.1, slenderness]).is_none());
        assert!(table.upper_end(&[0.0, slenderness]).is_none());
    }
}

#[test]
fn the_same_bytes_on_any_number_of_threads() {
    let (plan, wish) = wished(PPAM, 2048);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| built(&plan, &wish))
    };
    let one = on(1);
    assert!(one == on(3));
}

#[test]
fn where_the_size_comes_first_the_error_is_honest() {
    let (plan, wish) = wished(&PPAM.replace("1e-5", "1e-8"), 4096);
    for max_bytes in [2500, 6000] {
        let wish = TableRequirements { max_bytes, form: TableForm::Splines, ..wish.clone() };
        let Built { bytes, is_met, certificates } = built(&plan, &wish);
        assert!(!is_met && bytes.len() as u64 <= max_bytes, "{} bytes", bytes.len());
        let table = Table::from_bytes(&bytes).unwrap();
        let (worst, _) = fresh_errors(&plan, &table, 1500);
        for (o, [value, gradient]) in worst.into_iter().enumerate() {
            let promised = certificates[o];
            assert!(value <= 1.1 * promised.value_max, "{value:e}: {promised:?}");
            assert!(gradient <= 1.1 * promised.gradient_max, "{gradient:e}: {promised:?}");
            assert!(value <= promised.bound);
        }
        assert!(certificates.iter().any(|c| c.value_max > wish.tolerance || c.gradient_max > wish.gradient));
    }
    let tiny = TableRequirements { max_bytes: 1100, ..wish };
    let error = tabulate(&plan, &tiny, &|_| ()).unwrap_err();
    assert!(matches!(error, TabulateError::Build(BuildError::TooSmall { limit: 1100, .. })), "{error}");
}

#[test]
fn a_table_says_where_it_comes_from() {
    let (plan, wish) = wished(PPAM, 2048);
    let bytes = built(&plan, &wish).bytes;
    let table = Table::from_bytes(&bytes).unwrap();
    assert_eq!(table.text(), table_text(&plan, &wish).unwrap());
    let description = TableDescription::of(&table).unwrap();
    assert_eq!(description.schema, "bulge.table/1");
    let axes: Vec<_> =
        description.axes.iter().map(|axis| (axis.name.as_str(), axis.is_fitted, axis.low)).collect();
    assert_eq!(axes, [("contraction", true, 0.02), ("slenderness", false, 4.0)]);
    assert_eq!((description.bytes, description.checks), (bytes.len(), 2048));
    assert_eq!(description.from["name"], "ppam-2-r16");
    let names: Vec<_> = description.outputs.iter().map(|output| output.name.as_str()).collect();
    assert_eq!(names, ["force_f", "volume_v"]);
    // A different table has a different text: other outputs, other checks, another tolerance.
    let others = [
        TableRequirements { outputs: vec![Output::Force, Output::Volume], ..wish.clone() },
        TableRequirements { checks: 4096, ..wish.clone() },
        TableRequirements { tolerance: 2e-5, ..wish.clone() },
        TableRequirements { form: TableForm::Smallest, ..wish.clone() },
    ];
    for other in others {
        assert_ne!(table_text(&plan, &other).unwrap(), table.text(), "{other:?}");
    }
    let [force, stiffness] = [Output::Force, Output::Stiffness].map(|output| {
        table_text(&plan, &TableRequirements { outputs: vec![output], ..wish.clone() }).unwrap()
    });
    assert_ne!(force, stiffness);
}

#[test]
fn a_braid_has_a_table() {
    let text = "muscle = \"dmsp-20-250\"\npressure = \"3 bar\"\n[axes.contraction]\nrange = \"8 %..16 %\"\n\
        [axes.length]\nrange = \"0.24 m..0.26 m\"\n[table]\noutputs = [\"force\", \"volume\"]\ntolerance = 1e-3\ngradient = 1e-2\n";
    let (plan, wish) = wished(text, 64);
    let Built { bytes, is_met, .. } = built(&plan, &wish);
    assert!(is_met);
    let table = Table::from_bytes(&bytes).unwrap();
    assert!(!table.is_fitted());
    for (contraction, length) in [(0.081, 0.241), (0.1, 0.25), (0.13, 0.259), (0.16, 0.24)] {
        let muscle = plan.muscle.with(Parameter::Length, length).unwrap();
        let problem = Problem::new(&muscle, Pressure::bar(3.0)).unwrap();
        let response = problem.follow(contraction, Approach::Auto).unwrap();
        let [(force, by_force), (volume, _)] = look(&table, [contraction, length]).unwrap();
        assert!((force / response.force_n - 1.0).abs() < 1e-3, "{force} {}", response.force_n);
        assert!((volume / response.volume_m3 - 1.0).abs() < 1e-3);
        let slope = -response.stiffness_n_per_m * length;
        assert!((by_force[0] / slope - 1.0).abs() < 1e-2, "{} {slope}", by_force[0]);
    }
    assert!(look(&table, [0.16 + 1e-9, 0.25]).is_none());
}

#[test]
fn three_axes_have_a_table() {
    // The contraction comes first in a table, wherever it is in the file.
    let text = "muscle = \"ppam-2-r16\"\n[axes.elastic_group]\nrange = \"0.005..0.01\"\n[axes.contraction]\nrange = \"5 %..limit\"\n\
        [axes.slenderness]\nrange = \"6..7\"\n[table]\ntolerance = 1e-3\ngradient = 1e-2\n";
    let (plan, wish) = wished(text, 512);
    let Built { bytes, is_met, .. } = built(&plan, &wish);
    assert!(is_met);
    let table = Table::from_bytes(&bytes).unwrap();
    let names: Vec<&str> = (0..3).map(|i| table.axis(i).unwrap().name).collect();
    assert_eq!(names, ["contraction", "elastic_group", "slenderness"]);
    let scale = table.output(0).unwrap().certificate.scale;
    let family = Family::new(&plan).unwrap();
    let mut random = Random::new(3, 3);
    for _ in 0..200 {
        let [group, slenderness] = [0.005 + 0.005 * random.uniform(), 6.0 + random.uniform()];
        let high = table.upper_end(&[0.0, group, slenderness]).unwrap();
        let contraction = 0.05 + (high - 0.05) * random.uniform();
        let mut values = [0.0; 2];
        let member = family.member(&[group, contraction, slenderness]).unwrap();
        member.outputs(contraction, &[Output::ForceF, Output::VolumeV], &mut values).unwrap();
        let found = look(&table, [contraction, group, slenderness]).unwrap();
        assert!(off(found[0].0, values[0], scale) < 1e-3 && (found[1].0 / values[1] - 1.0).abs() < 1e-3);
        let limit = member.contraction_limit().unwrap();
        assert!((limit - high).abs() < 1e-6, "{limit} {high}");
    }
}
