//! Each fault planted in clean loops is found, where it is, and nothing else is.

use super::*;
use crate::columns::{Columns, Trace};
use crate::simulated::{LOOP, Noise, clean_loops, force};
use crate::{MeasurementError, Motion};

const SWEEP: usize = 2 * LOOP + 1;

fn quality(columns: Columns) -> Quality {
    Data::from_columns(columns).unwrap().quality(&QualityOptions::default())
}

/// All lines of the findings of a kind that are at least a warning.
fn lines(quality: &Quality, kind: FindingKind) -> Vec<usize> {
    let severe = quality.of(kind).filter(|finding| finding.severity >= Severity::Warning);
    severe.flat_map(|finding| &finding.rows).flat_map(|range| range.first..=range.last).collect()
}

/// Plants a fault in clean loops: the kind is found at exactly these rows (from 0), and no other kind gives a warning.
#[track_caller]
fn plants(kind: FindingKind, rows: &[usize], fault: impl Fn(&mut Columns)) {
    for seed in 1..4 {
        let mut columns = clean_loops(2, seed);
        fault(&mut columns);
        let found = quality(columns);
        let expected: Vec<usize> = rows.iter().map(|row| row + 1).collect();
        assert_eq!(lines(&found, kind), expected, "{found:#?}");
        for finding in found.findings.iter().filter(|finding| finding.severity > Severity::Note) {
            assert_eq!(finding.kind, kind, "{finding:#?}");
            assert!(!finding.instead.is_empty());
        }
    }
}

/// A kind that is about the data as a whole.
#[track_caller]
fn has(quality: &Quality, kind: FindingKind, severity: Severity) -> String {
    let found = quality.of(kind).find(|finding| finding.severity == severity);
    found.unwrap_or_else(|| panic!("no {kind:?} in {quality:#?}")).says.clone()
}

fn motion(columns: &mut Columns) -> &mut Vec<f64> {
    let Trace::Contraction(values) = &mut columns.motion else { unreachable!() };
    values
}

#[test]
fn clean_loops_are_clean() {
    for seed in 0..30 {
        for loops in [1, 2, 5] {
            let columns = clean_loops(loops, seed);
            let found = quality(columns.clone());
            assert_eq!(found.findings, [], "{seed}");
            // Neither labels nor their absence, nor lengths, nor the muscle's size matter.
            let mut lengths = columns.clone();
            lengths.sweep = None;
            lengths.motion = Trace::Length(columns.motion.values().iter().map(|c| 0.3 * (1.0 - c)).collect());
            let options = QualityOptions { l0_m: Some(0.3), radius_m: Some(0.01) };
            let found = Data::from_columns(lengths).unwrap().quality(&options);
            assert!(found.worst() <= Some(Severity::Note), "{seed}: {found:#?}");
        }
    }
}

#[test]
fn clean_ramps_holds_and_steps_of_pressure_are_clean() {
    for seed in 0..20 {
        let mut noise = Noise::new(seed);
        let (mut p, mut c, mut f) = (Vec::new(), Vec::new(), Vec::new());
        // Pressure steps at fixed lengths, then ramps with holds at one pressure.
        for i in 0..600_u32 {
            let (pressure, contraction) = match i {
                0..200 => (1e5 * f64::from(1 + i / 50), 0.05),
                200..300 => (3e5, 0.05 + 1e-3 * f64::from(i - 200)),
                300..400 => (3e5, 0.15),
                400..500 => (3e5, 0.15 - 1e-3 * f64::from(i - 400)),
                _ => (3e5, 0.05),
            };
            let direction = f64::from(i32::from((200..400).contains(&i)) - i32::from(i >= 400));
            p.push(pressure + 50.0 * noise.normal());
            c.push(contraction + 1e-5 * noise.normal());
            f.push(force(pressure, contraction, direction) + noise.normal());
        }
        let mut columns = Columns::new(p, Trace::Contraction(c), f);
        columns.time_s = Some((0..600).map(|i| 0.1 * f64::from(i)).collect());
        let found = quality(columns);
        assert!(found.worst() <= Some(Severity::Note), "{seed}: {found:#?}");
    }
}

#[test]
fn time_that_goes_back_or_stands_still() {
    plants(FindingKind::TimeNotMonotone, &[101, 500], |columns| {
        let time = columns.time_s.as_mut().unwrap();
        time.swap(100, 101);
        time[500] = time[499];
    });
    // Without labels as well.
    let mut columns = clean_loops(2, 1);
    columns.sweep = None;
    columns.time_s.as_mut().unwrap().swap(100, 101);
    assert_eq!(lines(&quality(columns), FindingKind::TimeNotMonotone), [102]);
}

#[test]
fn a_clock_that_is_restarted_is_no_fault() {
    let mut columns = clean_loops(2, 1);
    columns.sweep = None;
    for (row, time) in columns.time_s.as_mut().unwrap().iter_mut().enumerate() {
        *time = 0.01 * (row % SWEEP) as f64;
    }
    let found = quality(columns);
    assert!(found.worst() <= Some(Severity::Note), "{found:#?}");
}

#[test]
fn pauses_within_a_run() {
    plants(FindingKind::TimeGap, &[300], |columns| {
        columns.time_s.as_mut().unwrap()[300..SWEEP].iter_mut().for_each(|time| *time += 0.3);
    });
    let mut columns = clean_loops(2, 1);
    columns.sweep = None;
    let says = has(&quality(columns), FindingKind::TimeGap, Severity::Note);
    assert!(says.starts_with("2 pauses"), "{says}");
}

/// Readings on a grid.
fn on_grid(values: &mut [f64], step: f64) {
    for value in values {
        *value = (*value / step).round() * step;
    }
}

#[test]
fn coarse_sensors() {
    type Column = fn(&mut Columns) -> &mut Vec<f64>;
    let sensors: [(&str, Column, f64, f64); 3] = [
        ("force", |columns| &mut columns.force_n, 1.0, 20.0),
        ("contraction", motion, 5e-4, 5e-3),
        ("pressure", |columns| &mut columns.pressure_pa, 500.0, 5000.0),
    ];
    for (name, column, fine, rough) in sensors {
        for (step, severity) in [(fine, Severity::Note), (rough, Severity::Warning)] {
            let mut columns = clean_loops(2, 1);
            // A regulator that hunts.
            for (row, pressure) in columns.pressure_pa.iter_mut().enumerate() {
                *pressure += 1e4 * (0.05 * row as f64).sin();
            }
            on_grid(column(&mut columns), step);
            let (low, high) = crate::resolution::bounds(column(&mut columns));
            let says = has(&quality(columns), FindingKind::Quantised, severity);
            let levels = format!("{} levels", ((high - low) / step).round() + 1.0);
            assert!(
                says.contains(name)
                    && says.contains(&levels)
                    && says.contains(&super::quantisation::four(step)),
                "{says}"
            );
        }
    }
    // What is held is judged by its size: 300 N in steps of 1 N are 308 levels, whatever the noise.
    let mut held = clean_loops(2, 1);
    let mut noise = Noise::new(4);
    held.force_n = held.force_n.iter().map(|_| (300.0 + 2.0 * noise.normal()).round()).collect();
    let largest = crate::resolution::bounds(&held.force_n).1;
    let says = has(&quality(held), FindingKind::Quantised, Severity::Note);
    assert!(says.contains(&format!("{} levels up to", largest + 1.0)), "{says}");
    // Set points aren't readings.
    let mut columns = clean_loops(2, 1);
    on_grid(&mut columns.pressure_pa, 1e5);
    assert_eq!(quality(columns).findings, []);
}

#[test]
fn a_force_that_is_clipped() {
    let limit = 500.0;
    let columns = clean_loops(2, 1);
    let over: Vec<usize> = (0..columns.force_n.len()).filter(|row| columns.force_n[*row] > limit).collect();
    let mut clipped = columns;
    clipped.force_n.iter_mut().for_each(|f| *f = f.min(limit));
    let found = lines(&quality(clipped), FindingKind::Clipped);
    assert!(found.iter().all(|line| over.contains(&(line - 1))), "rows that were not clipped");
    assert!(found.len() + 10 > over.len() && over.len() > 100, "{} of {}", found.len(), over.len());
}

#[test]
fn a_length_and_a_pressure_that_are_clipped() {
    let columns = clean_loops(2, 1);
    let over: Vec<usize> = (0..SWEEP).filter(|row| columns.motion.values()[*row] > 0.18).collect();
    let mut clipped = columns;
    for c in motion(&mut clipped) {
        *c = c.min(0.18);
    }
    let found = lines(&quality(clipped), FindingKind::Clipped);
    let of_first: Vec<usize> = found.iter().map(|line| line - 1).filter(|row| *row < SWEEP).collect();
    assert_eq!(of_first, over);

    // A pressure ramp at fixed length.
    let mut noise = Noise::new(2);
    let p: Vec<f64> = (0..400).map(|i| 1e3 * f64::from(i) + 30.0 * noise.normal()).collect();
    let f: Vec<f64> = p.iter().map(|p| force(*p, 0.1, 0.0) + 0.5 * noise.normal()).collect();
    let c = (0..400).map(|_| 0.1 + 1e-6 * noise.normal()).collect();
    let mut columns = Columns::new(p.iter().map(|p| p.min(3e5)).collect(), Trace::Contraction(c), f);
    columns.time_s = Some((0..400).map(f64::from).collect());
    let over: Vec<usize> = (0..400).filter(|row| p[*row] > 3e5).map(|row| row + 1).collect();
    let found = lines(&quality(columns), FindingKind::Clipped);
    assert!(found.len() + 2 > over.len() && found.iter().all(|line| over.contains(line)), "{found:?}");
}

#[test]
fn tops_of_few_rows_are_clipped_together() {
    // Triangles of pressure at one length, 8 rows each way; the amplifier ends at 560 N, where each top has two or three rows.
    let mut noise = Noise::new(7);
    let bar = |i: usize| 1.0 + 0.6 * (if i % 16 < 8 { i % 16 } else { 16 - i % 16 }) as f64;
    let rows = 160;
    let force: Vec<f64> = (0..rows).map(|i| (108.0 * bar(i) + 0.5 * noise.normal()).min(560.0)).collect();
    let over: Vec<usize> = (0..rows).filter(|row| force[*row] >= 560.0).map(|row| row + 1).collect();
    let pressure = (0..rows).map(|i| 1e5 * bar(i) + 100.0 * noise.normal()).collect();
    let length = (0..rows).map(|_| 0.1 + 1e-5 * noise.normal()).collect();
    let mut columns = Columns::new(pressure, Trace::Contraction(length), force.clone());
    columns.time_s = Some((0..rows).map(|row| row as f64).collect());
    assert_eq!(lines(&quality(columns.clone()), FindingKind::Clipped), over);
    columns.force_n = (0..rows).map(|i| 108.0 * bar(i) + 0.5 * noise.normal()).collect();
    assert_eq!(quality(columns).of(FindingKind::Clipped).count(), 0);
}

#[test]
fn a_recording_that_stands_still() {
    let rows: Vec<usize> = (301..340).collect();
    plants(FindingKind::Frozen, &rows, |columns| {
        columns.force_n[300..340].fill(333.3);
        columns.pressure_pa[300..340].fill(100_010.0);
        motion(columns)[300..340].fill(0.1765);
    });
    // A load cell that stood still while the muscle moved on.
    plants(FindingKind::Frozen, &rows, |columns| columns.force_n[300..340].fill(333.3));
    plants(FindingKind::Frozen, &rows[..7], |columns| columns.force_n[300..308].fill(333.3));
    // One that shows full newtons, at the turning points of a slow loop, doesn't.
    let mut columns = clean_loops(1, 1);
    columns.force_n.iter_mut().for_each(|force| *force = (*force / 5.0).round() * 5.0);
    assert_eq!(quality(columns).of(FindingKind::Frozen).count(), 0);
    // At rest, readings without noise are equal.
    let mut columns = clean_loops(1, 1);
    let rows = columns.force_n.len();
    columns.force_n = (0..rows).map(|row| 300.0 - ((row / 50) as f64)).collect();
    columns.pressure_pa.fill(2e5);
    *motion(&mut columns) = (0..rows).map(|row| 0.02 + 0.005 * ((row / 50) as f64)).collect();
    assert_eq!(quality(columns).of(FindingKind::Frozen).count(), 0);
}

#[test]
fn spikes_in_each_column() {
    plants(FindingKind::Spike, &[150], |columns| columns.force_n[150] += 40.0);
    plants(FindingKind::Spike, &[150, 151, 900, 901, 902], |columns| {
        columns.force_n[150..152].iter_mut().for_each(|f| *f -= 30.0);
        columns.force_n[900..903].iter_mut().for_each(|f| *f += 30.0);
    });
    plants(FindingKind::Spike, &[250], |columns| columns.pressure_pa[250] += 2e4);
    plants(FindingKind::Spike, &[350], |columns| motion(columns)[350] += 0.02);
}

/// Triangles with Coulomb's friction of this size, so many rows for each of three pressures.
fn friction_loops(rows: usize, friction: f64, noise_n: f64, seed: u64) -> Columns {
    let mut noise = Noise::new(seed);
    let (mut p, mut c, mut f) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..3 * rows {
        let part = (i % rows) as f64 / rows as f64 * 4.0;
        let (up, way) = (part % 2.0 <= 1.0, 1.0 - (part % 2.0 - 1.0).abs());
        p.push(1e5 * (1 + i / rows) as f64 + 30.0 * noise.normal());
        c.push(0.02 + 0.2 * way + 1e-5 * noise.normal());
        let sign = if up { 1.0 } else { -1.0 };
        f.push(force(p[i], c[i], 0.0) - friction * sign + noise_n * noise.normal());
    }
    let mut columns = Columns::new(p, Trace::Contraction(c), f);
    columns.time_s = Some((0..3 * rows).map(|i| 0.05 * i as f64).collect());
    columns
}

#[test]
fn clean_rows_are_no_spikes() {
    let (mut rows, mut called) = (0, 0);
    for seed in 0..20 {
        for (size, friction, noise_n) in
            [(40, 20.0, 1.0), (100, 0.0, 0.5), (400, 30.0, 0.2), (2000, 12.0, 2.0)]
        {
            let data = Data::from_columns(friction_loops(size, friction, noise_n, seed)).unwrap();
            rows += data.len();
            called += data.spikes(data.force()).len();
        }
        let loops = Data::from_columns(clean_loops(2, seed)).unwrap();
        rows += loops.len();
        called += loops.spikes(loops.force()).len();
    }
    assert!(1000 * called < rows, "{called} of {rows}");
}

#[test]
fn spikes_of_20_sigma_in_two_per_cent_of_the_rows() {
    let (mut planted, mut found, mut wrong) = (0, 0, 0);
    for seed in 0..10 {
        let mut columns = friction_loops(400, 6.0, 0.5, seed);
        let mut noise = Noise::new(100 + seed);
        let mut spiked = std::collections::BTreeSet::new();
        while spiked.len() < 24 {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a row")]
            let row = (noise.uniform() * 1200.0) as usize;
            if spiked.insert(row) {
                columns.force_n[row] += if noise.normal() > 0.0 { 10.0 } else { -10.0 };
            }
        }
        let data = Data::from_columns(columns).unwrap();
        // As a model sees them: what it leaves along the path.
        let left: Vec<f64> = (0..1200)
            .map(|row| data.force()[row] - force(data.pressure()[row], data.contraction(1.0)[row], 0.0))
            .collect();
        let rows = data.spikes(&left);
        planted += 24;
        found += rows.iter().filter(|row| spiked.contains(row)).count();
        wrong += rows.iter().filter(|row| !spiked.contains(row)).count();
    }
    assert!(found * 10 > planted * 8 && wrong * 50 < planted, "{found} of {planted}, {wrong} wrong");
}

#[test]
fn heavy_tails_are_hardly_spikes() {
    let mut called = 0;
    for seed in 0..10 {
        let mut columns = friction_loops(400, 6.0, 0.0, seed);
        let mut noise = Noise::new(200 + seed);
        for value in &mut columns.force_n {
            let chi: f64 = (0..3).map(|_| noise.normal().powi(2)).sum();
            *value += 0.5 * noise.normal() / (chi / 3.0).sqrt();
        }
        called += Data::from_columns(columns).map(|data| data.spikes(data.force()).len()).unwrap();
    }
    // Student's t with 3 degrees of freedom is beyond 11 in one of 600 rows.
    assert!(called < 60, "{called} of 12000");
}

#[test]
fn a_slack_muscle() {
    let columns = |c_max: f64, seed: u64| {
        // Contracts beyond its free contraction of 1/2.8 = 35.7 %.
        let mut noise = Noise::new(seed);
        let c: Vec<f64> = (0..=200)
            .map(|i| c_max * 0.5 * (1.0 - (std::f64::consts::TAU * f64::from(i) / 200.0).cos()))
            .collect();
        let f = c.iter().map(|c| force(2e5, *c, 0.0).max(0.0) + 0.3 * noise.normal()).collect();
        let mut columns = Columns::new(vec![2e5; c.len()], Trace::Contraction(c), f);
        columns.time_s = Some((0..=200).map(f64::from).collect());
        columns
    };
    for seed in 0..10 {
        let slack = columns(0.42, seed);
        let beyond: Vec<usize> =
            (0..=200).filter(|row| slack.motion.values()[*row] > 1.0 / 2.8).map(|row| row + 1).collect();
        let found = quality(slack);
        let rows = lines(&found, FindingKind::Slack);
        assert!(beyond.iter().all(|line| rows.contains(line)), "{found:#?}");
        // Rows near zero on both sides are within its resolution.
        assert!(rows.len() <= beyond.len() + 4, "{found:#?}");
        // Up to the free contraction: a note at most.
        let found = quality(columns(1.0 / 2.8, seed));
        assert!(found.worst() <= Some(Severity::Note), "{found:#?}");
    }
    // In a static map each row is a candidate.
    let mut map = Columns::new(
        vec![1e5; 12],
        Trace::Contraction((0..12).map(|i| 0.03 * f64::from(i)).collect()),
        Vec::new(),
    );
    map.force_n = map.motion.values().iter().map(|c| force(1e5, *c, 0.0)).collect();
    map.force_n[11] = 0.0;
    let found = quality(map);
    let rows: Vec<_> = found.of(FindingKind::Slack).flat_map(|finding| &finding.rows).collect();
    assert_eq!(rows, [&LineRange { file: 0, first: 12, last: 12 }]);
    assert_eq!(found.worst(), Some(Severity::Note));
}

#[test]
fn a_pushing_force() {
    plants(FindingKind::NegativeForce, &(0..10).map(|i| 2000 + i).collect::<Vec<_>>(), |columns| {
        columns.force_n[2000..2010].iter_mut().for_each(|f| *f = -*f);
    });
}

#[test]
fn repeats_that_drift() {
    let rows: Vec<usize> = (SWEEP..2 * SWEEP).collect();
    for seed in 0..5 {
        let mut columns = clean_loops(2, seed);
        let first = columns.clone();
        let time: Vec<f64> = first.time_s.as_ref().unwrap()[..SWEEP].iter().map(|t| t + 100.0).collect();
        columns.time_s.as_mut().unwrap()[rows.clone()[0]..2 * SWEEP].copy_from_slice(&time);
        let other = clean_loops(2, seed + 100);
        columns.pressure_pa[SWEEP..2 * SWEEP].copy_from_slice(&other.pressure_pa[..SWEEP]);
        columns.force_n[SWEEP..2 * SWEEP].copy_from_slice(&other.force_n[..SWEEP]);
        let found = quality(columns.clone());
        assert_eq!(lines(&found, FindingKind::RepeatDrift), [] as [usize; 0], "{found:#?}");
        columns.force_n[SWEEP..2 * SWEEP].iter_mut().for_each(|f| *f += 2.0);
        let found = quality(columns);
        let lines = lines(&found, FindingKind::RepeatDrift);
        // Both loops of the second sweep repeat those of the first.
        assert_eq!((lines.first(), lines.len()), (Some(&(SWEEP + 1)), SWEEP), "{found:#?}");
        let says = has(&found, FindingKind::RepeatDrift, Severity::Warning);
        assert!(says.contains("up to 2.0") || says.contains("up to 1.9"), "{says}");
    }
}

#[test]
fn directions_against_the_motion() {
    let state = |columns: &mut Columns| {
        let directions = Data::from_columns(columns.clone()).unwrap().history(1.0).direction;
        #[expect(clippy::cast_possible_truncation, reason = "-1, 0 or 1")]
        let stated = directions.iter().map(|direction| *direction as i8).collect();
        columns.direction = Some(stated);
    };
    let wrong: Vec<usize> = (40..60).collect();
    plants(FindingKind::DirectionContradicted, &wrong, |columns| {
        state(columns);
        columns.direction.as_mut().unwrap()[40..60].fill(-1);
    });
    let mut columns = clean_loops(2, 1);
    state(&mut columns);
    columns.direction.as_mut().unwrap().iter_mut().for_each(|direction| *direction = -*direction);
    let found = quality(columns);
    assert!(found.findings[0].instead.contains("turn the labels over"), "{found:#?}");
}

#[test]
fn rows_that_are_there_twice() {
    let mut columns = clean_loops(1, 1);
    // Ten rows of the second run again, as a run of their own.
    let rows: Vec<usize> = (0..columns.force_n.len()).chain(500..510).collect();
    columns.filter(&rows);
    let labels = columns.sweep.as_ref().unwrap();
    let names = labels.rows().iter().enumerate().map(|(row, label)| match row {
        0..1203 => labels.names()[*label as usize].clone(),
        _ => "again".to_owned(),
    });
    columns.sweep = Some(names.collect());
    let found = quality(columns);
    assert_eq!(lines(&found, FindingKind::DuplicateRow), (1204..=1213).collect::<Vec<_>>());
    let mut map = Columns::new(
        vec![1e5; 10],
        Trace::Length((0..10).map(|i| 0.3 - 0.01 * f64::from(i)).collect()),
        vec![50.0; 10],
    );
    map.filter(&[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 3]);
    assert_eq!(lines(&quality(map.clone()), FindingKind::DuplicateRow), [11]);
    // Repeats of which some are equal by chance.
    map.filter(&(0..30).map(|row| row % 10).collect::<Vec<_>>());
    for (row, force) in map.force_n.iter_mut().enumerate().skip(10).filter(|(row, _)| row % 10 != 7) {
        *force += row as f64;
    }
    let found = quality(map);
    assert!(has(&found, FindingKind::DuplicateRow, Severity::Note).starts_with("2 rows equal"), "{found:#?}");
    assert_eq!(lines(&found, FindingKind::DuplicateRow), [] as [usize; 0]);
}

#[test]
fn labels_that_return() {
    plants(FindingKind::SweepInterrupted, &[2 * SWEEP], |columns| {
        let label = |row| if (SWEEP..2 * SWEEP).contains(&row) { "b" } else { "a" };
        columns.sweep = Some((0..3 * SWEEP).map(label).collect());
    });
}

#[test]
fn values_of_no_muscle() {
    plants(FindingKind::ImpossibleValue, &[7], |columns| {
        columns.temperature_k = Some(vec![293.0; columns.force_n.len()]);
        columns.temperature_k.as_mut().unwrap()[7] = 20.0;
    });
    let says = |change: fn(&mut Columns)| {
        let mut columns = clean_loops(1, 1);
        change(&mut columns);
        has(&quality(columns), FindingKind::ImpossibleValue, Severity::Error)
    };
    assert!(
        says(|columns| columns.pressure_pa[3] = -1.2e5)
            .contains("1 row with a gauge pressure below a vacuum")
    );
    assert!(says(|columns| columns.pressure_pa.iter_mut().for_each(|p| *p *= 1e3)).contains("150 bar"));
    assert!(says(|columns| columns.pressure_pa.iter_mut().for_each(|p| *p *= 1e-5)).contains("below 20 Pa"));
    assert!(
        says(|columns| motion(columns).iter_mut().for_each(|c| *c *= 100.0)).contains("outside -1 to 0.6")
    );
    assert!(says(|columns| columns.force_n[3] = 2e6).contains("2000000.0"));
    assert!(says(|columns| columns.volume_m3 = Some(vec![0.0; columns.force_n.len()])).contains("1203 rows"));
    let lengths = Columns::new(vec![1e5; 3], Trace::Length(vec![0.3, -0.3, 0.3]), vec![1.0, 2.0, 20_000.0]);
    let options = QualityOptions { l0_m: Some(0.3), radius_m: Some(0.01) };
    let found = Data::from_columns(lengths).unwrap().quality(&options);
    let wrong: Vec<_> =
        found.of(FindingKind::ImpossibleValue).map(|f| (f.says.as_str(), f.rows[0].first)).collect();
    assert_eq!(wrong.len(), 2, "{wrong:?}");
    assert!(wrong.iter().any(|(says, line)| says.contains("length of 0 or less") && *line == 2));
    assert!(wrong.iter().any(|(says, line)| says.contains("outside -1") && *line == 2), "{wrong:?}");
}

#[test]
fn forces_are_judged_by_the_size() {
    // 1000 pi r^2 p with r = 10 mm and 1 bar is 31.4 kN.
    let of = |force| Columns::new(vec![1e5; 2], Trace::Contraction(vec![0.0, 0.1]), vec![force, 1.0]);
    let options = QualityOptions { l0_m: None, radius_m: Some(0.01) };
    let count = |force| {
        let found = Data::from_columns(of(force)).unwrap().quality(&options);
        found.of(FindingKind::ImpossibleValue).count()
    };
    assert_eq!((count(31_300.0), count(31_500.0)), (0, 1));
}

#[test]
fn little_or_nothing() {
    let constant =
        |rows: usize| Columns::new(vec![1e5; rows], Trace::Contraction(vec![0.1; rows]), vec![5.0; rows]);
    let one = quality(constant(1));
    assert!(has(&one, FindingKind::TooFewRows, Severity::Warning).contains("one row"));
    assert_eq!(one.findings.len(), 1);
    let same = quality(constant(20));
    assert!(has(&same, FindingKind::AllRowsIdentical, Severity::Error).contains("all 20 rows"));
    let mut columns = constant(20);
    columns.force_n[3] = 6.0;
    let held = quality(columns.clone());
    has(&held, FindingKind::ContractionConstant, Severity::Warning);
    has(&held, FindingKind::OnePressureLevel, Severity::Note);
    columns.pressure_pa[3] = 2e5;
    has(&quality(columns), FindingKind::ContractionConstant, Severity::Note);
    let data = Data::from_columns(constant(3)).unwrap().subset(&[]);
    assert!(data.is_empty() && data.quality(&QualityOptions::default()).findings.is_empty());
}

#[test]
fn temperature_together_with_something_else() {
    let with = |temperature: fn(usize, f64) -> f64| {
        let mut columns = clean_loops(1, 1);
        let values = columns.pressure_pa.iter().enumerate().map(|(row, p)| temperature(row, *p)).collect();
        columns.temperature_k = Some(values);
        quality(columns)
    };
    assert!(with(|row, _| 293.0 + (row % 7) as f64 * 0.1).findings.is_empty());
    let noted = with(|row, _| 293.0 + ((row / 100) % 4) as f64);
    assert!(has(&noted, FindingKind::TemperatureChanges, Severity::Note).contains("3.0 K"), "{noted:#?}");
    let says = has(&with(|_, p| 290.0 + 2e-5 * p), FindingKind::TemperatureChanges, Severity::Warning);
    assert!(says.contains("together with the pressure"), "{says}");
}

#[test]
fn lines_are_those_of_the_files() {
    let text = "# comment\npressure [bar],length [mm],force [N]\n1,300,50\n# comment\n1,-3,40\n1,-4,40\n";
    let data = Data::from_csv(text, "a.csv").unwrap();
    let found = data.quality(&QualityOptions::default());
    assert_eq!(lines(&found, FindingKind::ImpossibleValue), [5, 6]);
    assert!(matches!(data.motion(), Motion::Length(_)));
    let json = serde_json::to_value(&found).unwrap();
    assert_eq!(json["findings"][1]["kind"], "impossible-value");
    assert_eq!(json["findings"][1]["severity"], "error");
    assert_eq!(json["findings"][1]["rows"][0]["first"], 5);
    assert_eq!(
        Data::from_csv("", "a.csv").unwrap_err(),
        MeasurementError::Empty { file: "a.csv".to_owned() }
    );
}
