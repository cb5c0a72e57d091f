//! What it costs to take in 10^5 rows: CSV, Parquet, quality gate, repeats, history.

#![expect(clippy::unwrap_used, reason = "a benchmark that can't be set up has nothing to measure")]

use bulge_benches::measured::{columns, csv};
use bulge_benches::parquet;
use bulge_measurements::{Data, QualityOptions};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;

const ROWS: usize = 100_000;

fn load(c: &mut Criterion) {
    let columns = columns(ROWS).unwrap();
    let text = csv(&columns);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("rows.parquet");
    std::fs::write(&path, parquet(&columns).unwrap()).unwrap();
    let data = Data::from_csv(&text, "rows.csv").unwrap();
    let mut group = c.benchmark_group("10^5 rows");
    group.throughput(Throughput::Elements(ROWS as u64));
    group.bench_function("CSV", |b| b.iter(|| Data::from_csv(black_box(&text), "rows.csv")));
    group.bench_function("Parquet", |b| b.iter(|| Data::read(&[black_box(&path)])));
    group.bench_function("quality", |b| b.iter(|| black_box(&data).quality(&QualityOptions::default())));
    group.bench_function("repeats", |b| b.iter(|| black_box(&data).repeats(0.11)));
    group.bench_function("history", |b| b.iter(|| black_box(&data).history(0.11)));
}

fn quick() -> Criterion {
    Criterion::default()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_secs(1))
        .sample_size(10)
        .nresamples(2000)
}

criterion_group! { name = rows; config = quick(); targets = load }
criterion_main!(rows);
