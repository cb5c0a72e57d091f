//! What one equilibrium costs, by method and muscle; and what surrounds it: curve, gradient, meridian, elliptic integrals.
//!
//! Results vary little with the contraction, so each benchmark takes one in the middle of the range unless its name says another.

#![expect(clippy::unwrap_used, reason = "a benchmark that can't be set up has nothing to measure")]

use bulge_benches::{SLENDERNESS, bladder, braid, cylinder, pleated, rubber_as_formula, solve};
use bulge_fibre::{Approach, Given, Problem, closed_form};
use bulge_numerics::elliptic;
use criterion::{BenchmarkGroup, Criterion, criterion_group, criterion_main, measurement::WallTime};
use std::hint::black_box;
use std::time::Duration;

type Group<'a> = BenchmarkGroup<'a, WallTime>;

/// Pressure times area over stiffness of one fibre, p sin(2 pi/n) R^2/(4 EA), of 40 fibres of 12 kN at 1 bar.
const ELASTIC_GROUP: f64 = 8.34e-5;

fn one(group: &mut Group, name: &str, problem: &Problem, approach: Approach, contraction: f64) {
    group.bench_function(name, |b| b.iter(|| solve(black_box(problem), black_box(contraction), approach)));
}

fn closed_form_alone(c: &mut Criterion) {
    let mut group = c.benchmark_group("closed form");
    for (name, contraction, elastic) in [
        ("degenerate, 1e-6", 1e-6, 0.0),
        ("inelastic, 20 %", 0.2, 0.0),
        ("inelastic, near the limit", 0.4184, 0.0),
        ("elastic, -0.05 %", -0.0005, ELASTIC_GROUP),
        ("elastic, 20 %", 0.2, ELASTIC_GROUP),
    ] {
        let solve = || closed_form::solve(black_box(contraction), black_box(SLENDERNESS), black_box(elastic));
        group.bench_function(name, |b| b.iter(solve));
    }
    let (t, m) = (2.0, 0.3);
    group.bench_function("one pair of elliptic integrals", |b| {
        b.iter(|| elliptic::incomplete(black_box(t), black_box(m)));
    });
}

fn through_problem(c: &mut Criterion) {
    let mut group = c.benchmark_group("Problem::solve, closed form");
    let (inelastic, elastic) = (pleated(None).unwrap(), pleated(Some(12e3)).unwrap());
    one(&mut group, "degenerate, 1e-6", &inelastic, Approach::ClosedForm, 1e-6);
    one(&mut group, "inelastic, 20 %", &inelastic, Approach::ClosedForm, 0.2);
    one(&mut group, "inelastic, near the limit", &inelastic, Approach::ClosedForm, 0.4184);
    one(&mut group, "elastic, 20 %", &elastic, Approach::ClosedForm, 0.2);
    one(&mut group, "cylinder, 20 %", &cylinder().unwrap(), Approach::Auto, 0.2);
}

fn shooting(c: &mut Criterion) {
    let mut group = c.benchmark_group("Problem::solve, shooting");
    let inelastic = pleated(None).unwrap();
    for contraction in [1e-6, 0.05, 0.2, 0.4] {
        let name = format!("pleated, {:.4} %", 100.0 * contraction);
        one(&mut group, &name, &inelastic, Approach::Shooting, contraction);
    }
    one(&mut group, "pleated elastic, 20 %", &pleated(Some(12e3)).unwrap(), Approach::Shooting, 0.2);
    one(&mut group, "braid l0/r0 = 3, 20 %", &braid(3.0).unwrap(), Approach::Shooting, 0.2);
    let usual = braid(25.0).unwrap();
    for contraction in [0.02, 0.2, 0.3] {
        let name = format!("braid l0/r0 = 25, {} %", 100.0 * contraction);
        one(&mut group, &name, &usual, Approach::Shooting, contraction);
    }
    one(&mut group, "braid l0/r0 = 100, 20 %", &braid(100.0).unwrap(), Approach::Shooting, 0.2);
    one(&mut group, "braid l0/r0 = 25 by quadrature, 20 %", &usual, Approach::Auto, 0.2);
    let (shipped, formula) = (bladder().unwrap(), rubber_as_formula().unwrap());
    for (name, problem) in [("bladder", &shipped), ("rubber as a formula", &formula)] {
        one(&mut group, &format!("braid l0/r0 = 25 + {name}, 20 %"), problem, Approach::Shooting, 0.2);
        one(&mut group, &format!("{name} by quadrature, 20 %"), problem, Approach::Auto, 0.2);
        // As a fit asks for it.
        let moving = problem.parts().still();
        group.bench_function(format!("linearised, {name}, 20 %"), |b| {
            b.iter(|| problem.linearised(black_box(0.2), &moving, Approach::Auto));
        });
    }
}

fn around(c: &mut Criterion) {
    let mut group = c.benchmark_group("around an equilibrium");
    let (inelastic, usual) = (pleated(None).unwrap(), braid(25.0).unwrap());
    let grid: Vec<f64> = (0..1001).map(|i| 0.02 + 0.28 * f64::from(i) / 1000.0).collect();
    group.bench_function("isobar of 1001, pleated", |b| b.iter(|| inelastic.isobar(&grid, Approach::Auto)));
    group.bench_function("isobar of 1001, braid", |b| b.iter(|| usual.isobar(&grid, Approach::Auto)));
    for (name, problem) in [("pleated", &inelastic), ("braid", &usual)] {
        group.bench_function(format!("gradient, {name}"), |b| {
            b.iter(|| problem.gradient(black_box(0.2), Approach::Auto));
        });
        group.bench_function(format!("meridian of 101, {name}"), |b| {
            b.iter(|| problem.shape(Given::Contraction(black_box(0.2)), Approach::Auto, 101));
        });
        group.bench_function(format!("contraction limit, {name}"), |b| {
            b.iter(|| problem.contraction_limit(black_box(Approach::Auto)));
        });
        group.bench_function(format!("given a force, {name}"), |b| {
            b.iter(|| problem.solve(Given::Force(black_box(200.0)), Approach::Auto));
        });
    }
}

fn quick() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(700))
        .sample_size(30)
        .nresamples(2000)
}

criterion_group! { name = equilibrium; config = quick(); targets = closed_form_alone, through_problem, shooting, around }
criterion_main!(equilibrium);
