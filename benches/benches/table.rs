//! What a lookup costs, beside the solution that it stands for: force f and volume v of a pleated muscle with their gradients, at random
//! points of the two-parameter table that the tour ships.

#![expect(clippy::unwrap_used, reason = "a benchmark that can't be set up has nothing to measure")]

use bulge_benches::random_points;
use bulge_fibre::closed_form;
use bulge_sweep::{Plan, tabulate};
use bulge_table::Table;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;

const FAMILY: &str = include_str!("../../crates/cli/data/family.toml");
/// Points of the loop.
const POINTS: usize = 4096;

fn lookups(c: &mut Criterion) {
    let mut group = c.benchmark_group("force, volume and gradients");
    for form in ["splines", "chebyshev"] {
        let text = format!("{FAMILY}form = \"{form}\"\n");
        let plan = Plan::from_toml(&text, "family.toml", None).unwrap();
        let built = tabulate(&plan, plan.table.as_ref().unwrap(), &|_| ()).unwrap();
        let table = Table::from_bytes(&built.bytes).unwrap();
        let lookup = table.lookup::<2, 2>().unwrap();
        let points = random_points(&lookup, POINTS);
        let mut next = points.iter().cycle();
        group.bench_function(format!("lookup, {form} ({} bytes)", built.bytes.len()), |b| {
            b.iter(|| lookup.at(black_box(*next.next().unwrap())));
        });
        if form == "splines" {
            let mut found = vec![None; POINTS];
            group.throughput(Throughput::Elements(POINTS as u64));
            group.bench_function("lookup, splines, all points in one call", |b| {
                b.iter(|| lookup.at_each(black_box(&points), black_box(&mut found)));
            });
            group.throughput(Throughput::Elements(1));
            // What a controller of one muscle does.
            let curve = lookup.curve::<96>([0.0, 6.875]).unwrap();
            let mut next = points.iter().cycle();
            group.bench_function("lookup, splines, one slenderness", |b| {
                b.iter(|| curve.at(black_box(0.75 * next.next().unwrap()[0])));
            });
            let mut next = points.iter().cycle();
            group.bench_function("closed form", |b| {
                b.iter(|| {
                    let [contraction, slenderness] = black_box(*next.next().unwrap());
                    closed_form::solve(contraction, slenderness, 0.0)
                });
            });
        }
    }
    group.finish();
}

fn building(c: &mut Criterion) {
    let plan = Plan::from_toml(FAMILY, "family.toml", None).unwrap();
    let mut group = c.benchmark_group("table");
    group.sample_size(10);
    group.bench_function("build and certify, 131072 checks", |b| {
        b.iter(|| tabulate(&plan, plan.table.as_ref().unwrap(), &|_| ()).unwrap().bytes.len());
    });
    group.finish();
}

fn quick() -> Criterion {
    Criterion::default().warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(2))
}

criterion_group! { name = benches; config = quick(); targets = lookups, building }
criterion_main!(benches);
