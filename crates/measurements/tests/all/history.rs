//! Histories with known answers: loops, minor loops, dwells, isometric ramps; sweeps that are labelled or
//! found.

#![expect(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::cast_lossless,
    reason = "a test that cannot be set up fails; values are exact by construction"
)]

use bulge_measurements::{Columns, Data, FindingKind, Labels, QualityOptions, SweepKind, Trace};
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// Data of one specimen at constant pressure, 10 ms per row.
fn timed(contraction: Vec<f64>) -> Data {
    let rows = contraction.len();
    let mut columns = Columns::new(vec![2e5; rows], Trace::Contraction(contraction), vec![100.0; rows]);
    columns.time_s = Some((0..rows).map(|row| 0.01 * row as f64).collect());
    Data::from_columns(columns).unwrap()
}

/// Linear interpolation from corner to corner, with the given numbers of rows.
fn polyline(corners: &[(f64, usize)]) -> Vec<f64> {
    let mut values = vec![corners[0].0];
    for pair in corners.windows(2) {
        let ((from, _), (to, steps)) = (pair[0], pair[1]);
        values.extend((1..=steps).map(|i| from + (to - from) * i as f64 / steps as f64));
    }
    values
}

#[track_caller]
fn close(found: &[f64], expected: impl IntoIterator<Item = f64>, tolerance: f64) {
    let mut count = 0;
    for (row, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!((found - expected).abs() <= tolerance, "row {row}: {found} is not {expected}");
        count += 1;
    }
    assert_eq!(count, found.len());
}

fn kinds(data: &Data) -> Vec<SweepKind> {
    data.sweeps().iter().map(|sweep| sweep.kind).collect()
}

#[test]
fn a_sine_loop() {
    // 3 loops of 4 s: c = 0.1 (1 - cos), from the longest position.
    let omega = TAU / 4.0;
    let at = |row: usize| 0.01 * row as f64;
    let data = timed((0..=1200).map(|row| 0.1 - 0.1 * (omega * at(row)).cos()).collect());
    let history = data.history(1.0);
    assert!(history.is_path);
    assert_eq!(kinds(&data), [SweepKind::Loop]);
    for row in 0..=1200_usize {
        // A turning point belongs to the stretch that it ends.
        let half = row.saturating_sub(1) / 200;
        let direction = if half % 2 == 0 { 1.0 } else { -1.0 };
        assert_eq!((history.direction[row], history.branch[row] as usize), (direction, half), "{row}");
        assert_eq!((history.cycle[row], history.approach[row]), ((half / 2) as f64, direction), "{row}");
    }
    let rate = |row| 0.1 * omega * (omega * at(row)).sin();
    close(&history.rate, (0..=1200).map(rate), 2e-3 * 0.1 * omega);
    let turn = |row: usize| 200 * (row.saturating_sub(1) / 200);
    let since = |row: usize| 0.1 * ((omega * at(row)).cos() - (omega * at(turn(row))).cos()).abs();
    close(&history.since_reversal, (0..=1200).map(since), 1e-12);
    close(&history.time_since_reversal, (0..=1200).map(|row| at(row - turn(row))), 1e-9);
    close(&history.time, (0..=1200).map(at), 1e-12);
}

#[test]
fn triangles_with_minor_loops() {
    // The rate of a straight motion is exact, up to the turning points.
    let corners = [(0.0, 0), (0.2, 100), (0.14, 60), (0.17, 15), (0.0, 85)];
    let data = timed(polyline(&corners));
    let history = data.history(1.0);
    let expected = [(101, 0.2), (60, -0.1), (15, 0.2), (85, -0.2)];
    let rates = expected.iter().flat_map(|(rows, rate)| std::iter::repeat_n(*rate, *rows));
    close(&history.rate, rates, 1e-9);
    let ends = [(100, 0.2), (160, 0.06), (175, 0.03), (260, 0.17)];
    for (row, way) in ends {
        assert!((history.since_reversal[row] - way).abs() < 1e-12, "{row}");
    }
    assert_eq!([100, 101, 160, 161, 260].map(|row| history.cycle[row]), [0.0, 0.0, 0.0, 1.0, 1.0]);
    assert_eq!(history.branch[260], 3);
}

#[test]
fn dwells_between_ramps() {
    let corners = [(0.0, 0), (0.2, 101), (0.2, 50), (0.1, 37), (0.1, 40), (0.0, 53), (0.0, 60)];
    let history = timed(polyline(&corners)).history(1.0);
    let expected = [(102, 1.0), (50, 0.0), (37, -1.0), (40, 0.0), (53, -1.0), (60, 0.0)];
    let directions = expected.iter().flat_map(|(rows, direction)| std::iter::repeat_n(*direction, *rows));
    close(&history.direction, directions, 0.0);
    // A rest keeps the approach and the distance since the reversal; its rate is 0.
    assert_eq!([120, 210, 330].map(|row| history.approach[row]), [1.0, -1.0, -1.0]);
    assert_eq!([120, 210, 330].map(|row| history.rate[row]), [0.0; 3]);
    let since = [120, 210, 330].map(|row| history.since_reversal[row]);
    close(&since, [0.2, 0.1, 0.2], 1e-12);
    // The reversal is the last row of the dwell.
    assert!((history.time_since_reversal[210] - 0.01 * (210 - 151) as f64).abs() < 1e-9);
}

#[test]
fn lengths_become_contractions() {
    let contraction = polyline(&[(0.0, 0), (0.2, 130), (0.0, 170)]);
    let expected = timed(contraction.clone()).history(1.0);
    let lengths = contraction.iter().map(|c| 0.3 * (1.0 - c)).collect();
    let mut columns = Columns::new(vec![2e5; 301], Trace::Length(lengths), vec![1.0; 301]);
    columns.time_s = Some(expected.time.clone());
    let data = Data::from_columns(columns).unwrap();
    let found = data.history(0.3);
    assert_eq!((&found.direction, &found.branch), (&expected.direction, &expected.branch));
    close(&found.rate, expected.rate.iter().copied(), 1e-9);
    close(&found.since_reversal, expected.since_reversal.iter().copied(), 1e-12);
    close(&data.contraction(0.3), contraction, 1e-12);
}

#[test]
fn isometric_ramps_and_holds() {
    // The rig has a compliance of 0.05 % while the pressure rises.
    let rows = 200;
    let ramp = |row: usize| 1.5e3 * row as f64;
    let mut columns = Columns::new(
        (0..rows).map(ramp).chain(std::iter::repeat_n(ramp(rows - 1), rows)).collect(),
        Trace::Contraction(
            (0..rows).map(|row| 0.1 + 2.5e-6 * row as f64).chain(std::iter::repeat_n(0.1, rows)).collect(),
        ),
        vec![1.0; 2 * rows],
    );
    columns.sweep = Some((0..2 * rows).map(|row| if row < rows { "ramp" } else { "hold" }).collect());
    let data = Data::from_columns(columns).unwrap();
    assert_eq!(kinds(&data), [SweepKind::Isometric, SweepKind::Hold]);
    assert_eq!(data.sweeps()[0].name, "ramp");
    let history = data.history(1.0);
    assert_eq!((history.direction[300], history.rate[100], history.rate[300]), (0.0, 0.0, 0.0));
    // A path by its labels alone has no time.
    assert!(history.is_path && history.time.iter().all(|time| *time == 0.0));
}

#[test]
fn single_ramps_have_a_direction() {
    let mut columns = Columns::new(
        vec![1e5; 40],
        Trace::Length(
            (0..40)
                .map(|row| if row < 20 { 0.3 - 1e-3 * f64::from(row) } else { 0.26 + 1e-3 * f64::from(row) })
                .collect(),
        ),
        vec![1.0; 40],
    );
    columns.sweep = Some((0..40).map(|row| (row / 20).to_string()).collect());
    let data = Data::from_columns(columns).unwrap();
    assert_eq!(kinds(&data), [SweepKind::Shortening, SweepKind::Lengthening]);
}

#[test]
fn static_maps_have_no_motion() {
    let columns =
        || Columns::new(vec![1e5; 4], Trace::Contraction(vec![0.0, 0.1, 0.2, 0.1]), vec![4.0, 3.0, 2.0, 2.5]);
    let data = Data::from_columns(columns()).unwrap();
    let history = data.history(1.0);
    assert!(!history.is_path);
    assert_eq!(history.direction, [0.0; 4]);
    assert_eq!(history.rate, [0.0; 4]);
    assert_eq!((kinds(&data), data.sweeps()[0].rows.clone()), (vec![SweepKind::Static], 0..4));
    // Unless a direction is stated.
    let mut stated = columns();
    stated.direction = Some(vec![1, 1, 1, -1]);
    let history = Data::from_columns(stated).unwrap().history(1.0);
    assert_eq!((history.direction, history.branch), (vec![1.0, 1.0, 1.0, -1.0], vec![0, 0, 0, 1]));
    assert_eq!(history.rate, [0.0; 4]);
    // One sweep for each specimen.
    let mut two = columns();
    two.specimen = Some(Labels::from_iter(["a", "a", "b", "b"]));
    let data = Data::from_columns(two).unwrap();
    assert_eq!(
        data.sweeps().iter().map(|s| (s.rows.clone(), s.specimen)).collect::<Vec<_>>(),
        [(0..2, 0), (2..4, 1)]
    );
}

#[test]
fn stated_cycles_are_kept() {
    let mut columns =
        Columns::new(vec![1e5; 3], Trace::Contraction(vec![0.0, 0.1, 0.2]), vec![4.0, 3.0, 2.0]);
    columns.cycle = Some(vec![7, 7, 8]);
    assert_eq!(Data::from_columns(columns).unwrap().history(1.0).cycle, [7.0, 7.0, 8.0]);
}

#[test]
fn cycles_are_counted_over_the_sweeps_of_a_specimen() {
    // Shortening, shortening again from the start, lengthening; then another specimen.
    let up = polyline(&[(0.0, 0), (0.2, 20)]);
    let down: Vec<f64> = up.iter().rev().copied().collect();
    let contraction = [up.clone(), up.clone(), down, up].concat();
    let mut columns = Columns::new(vec![1e5; 84], Trace::Contraction(contraction), vec![1.0; 84]);
    columns.sweep = Some((0..84).map(|row| (row / 21).to_string()).collect());
    columns.specimen = Some((0..84).map(|row| if row < 63 { "a" } else { "b" }).collect());
    let history = Data::from_columns(columns).unwrap().history(1.0);
    assert_eq!(
        [0, 20, 21, 41, 42, 62, 63, 83].map(|row| history.cycle[row]),
        [0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0]
    );
}

#[test]
fn sweeps_are_found_in_time() {
    let row = |n: usize| (n % 50) as f64;
    let data = |time: &dyn Fn(usize) -> f64| {
        let mut columns = Columns::new(
            vec![1e5; 150],
            Trace::Contraction((0..150).map(|n| 0.004 * row(n)).collect()),
            vec![1.0; 150],
        );
        columns.time_s = Some((0..150).map(time).collect());
        Data::from_columns(columns).unwrap()
    };
    let starts = |data: &Data| data.sweeps().iter().map(|sweep| sweep.rows.start).collect::<Vec<_>>();
    // A clock that restarts, and a pause.
    let restarted = data(&|n| 0.1 * row(n));
    assert_eq!(starts(&restarted), [0, 50, 100]);
    assert_eq!(restarted.sweeps()[2].name, "3");
    let paused = |pause: f64| move |n: usize| 0.1 * n as f64 + if n < 50 { 0.0 } else { pause };
    assert_eq!(starts(&data(&paused(1.95))), [0, 50]);
    assert_eq!(starts(&data(&paused(1.85))), [0]);
}

/// A muscle's force: falls with contraction \[Pa, - -> N\].
fn force(pressure: f64, contraction: f64) -> f64 {
    2e-3 * pressure * (1.0 - 2.8 * contraction)
}

/// A continuous recording of states (pressure, contraction, force).
fn recorded(rows: usize, step_s: f64, state: &dyn Fn(usize) -> [f64; 3]) -> Data {
    let column = |i: usize| (0..rows).map(|row| state(row)[i]).collect::<Vec<f64>>();
    let mut columns = Columns::new(column(0), Trace::Contraction(column(1)), column(2));
    columns.time_s = Some((0..rows).map(|row| step_s * row as f64).collect());
    Data::from_columns(columns).unwrap()
}

fn ranges(data: &Data) -> Vec<std::ops::Range<usize>> {
    data.sweeps().iter().map(|sweep| sweep.rows.clone()).collect()
}

/// Pseudo-random, between -1 and 1.
fn jitter(row: usize) -> f64 {
    2.0 * (12.9898 * row as f64).sin().mul_add(43_758.545_3, 0.0).rem_euclid(1.0) - 1.0
}

#[test]
fn sweeps_are_found_where_an_isobar_ends() {
    // Half loops at three pressures in a continuous recording.
    let state = |row: usize| {
        let (level, part) = (row / 200, (row % 200) as f64 / 199.0);
        (1e5 * (1 + level) as f64, 0.1 - 0.1 * (PI * part).cos())
    };
    let with_force = |(p, c): (f64, f64)| [p, c, force(p, c)];
    let data = recorded(600, 0.01, &|row| with_force(state(row)));
    assert_eq!(ranges(&data), [0..200, 200..400, 400..600]);
    assert_eq!(kinds(&data), [SweepKind::Shortening; 3]);
    // Also if one reading has the wrong sign, wherever it stands.
    for wrong in [0, 90, 599] {
        let signed = |row: usize| with_force((state(row).0, if row == wrong { 1.9 } else { state(row).1 }));
        let found = ranges(&recorded(600, 0.01, &signed));
        assert_eq!(found, [0..200, 200..400, 400..600], "{wrong}");
    }
    // Also if the muscle starts short, and the length jumps in the direction of the pressure.
    let long = |row: usize| with_force((state(row).0, 0.2 - state(row).1));
    assert_eq!(kinds(&recorded(600, 0.01, &long)), [SweepKind::Lengthening; 3]);
    // Pressure steps under a weight are one run: the force hardly changes, however slowly the muscle follows.
    for slow in [1.0, 40.0] {
        let steps = |row: usize| {
            let follows = 1.0 - (-((row % 100) as f64) / slow).exp();
            [1e5 * (1 + row / 100) as f64, 0.05 * ((row / 100) as f64 + follows), 50.0 + 2.0 * jitter(row)]
        };
        assert_eq!(ranges(&recorded(400, 0.01, &steps)).len(), 1);
    }
}

#[test]
fn loops_at_four_pressures_in_one_recording_are_four_sweeps() {
    // Rows per level, rows of the ramp from each level to the next, droop, noise of pressure, time between rows.
    for (rows, ramp, droop, noise, step_s) in [
        (300, 0, 0.0, 0.0, 0.05),
        (300, 0, 0.03, 0.0, 0.05),
        (300, 0, 0.0, 0.01, 0.05),
        (300, 12, 0.02, 0.005, 0.05),
        (22, 0, 0.0, 0.0, 1.0),
        (24, 2, 0.01, 0.003, 1.0),
        (40_000, 900, 0.02, 0.005, 5e-4),
    ] {
        let all = rows + ramp;
        let state = |row: usize| {
            let (level, row_in) = (row / all, row % all);
            let turned = TAU * (row_in.saturating_sub(ramp)) as f64 / rows as f64;
            let c = 0.1 - 0.1 * turned.cos();
            let base = 1e5 * (1 + level) as f64;
            let before = if level == 0 { base } else { base - 1e5 };
            let part = if row_in < ramp { (row_in + 1) as f64 / (ramp + 1) as f64 } else { 1.0 };
            let p = before + part * (base - before) + 4e5 * (droop * turned.sin() + noise * jitter(row));
            [p, c, force(p, c)]
        };
        let data = recorded(4 * all, step_s, &state);
        let case = format!("{rows} {ramp} {droop} {noise}");
        assert_eq!(data.sweeps().len(), 4, "{case}: {:?}", ranges(&data));
        assert!(kinds(&data).iter().all(|kind| *kind == SweepKind::Loop), "{case}");
        for (level, sweep) in data.sweeps().iter().enumerate() {
            // The rows of a ramp belong to the next run, except for its last ones at the previous pressure.
            assert!(sweep.rows.start.abs_diff(level * all) <= ramp / 4, "{case}: {:?}", ranges(&data));
        }
        let between = data.between_isobars();
        // If the pressure droops and is noisy, a row or two of a run look like its steps.
        assert!(between.len() <= 3 * ramp + 2 && between.len() >= 3 * ramp / 2, "{case}: {}", between.len());
        assert!(between.iter().all(|row| (row + 2) % all < ramp + 4), "{case}");
    }
}

#[test]
fn droop_and_pressure_that_drives_split_nothing() {
    let loops = |row: usize| 0.1 - 0.1 * (TAU * row as f64 / 200.0).cos();
    // A regulator that droops by a tenth along a loop, at one pressure.
    let droop = |row: usize| {
        let p = 2e5 * (1.0 + 0.05 * (TAU * row as f64 / 200.0).sin());
        [p, loops(row), force(p, loops(row))]
    };
    assert_eq!(ranges(&recorded(800, 0.05, &droop)).len(), 1);
    // Filling and venting at held length; a pressure staircase there; pressure and length that move together.
    let fill = |row: usize| {
        let p = 3e5 * (1.0 - (2.0 * (row % 1000) as f64 / 1000.0 - 1.0).abs());
        [p, 0.1 + 1e-4 * jitter(row), force(p, 0.1)]
    };
    assert_eq!(ranges(&recorded(3000, 0.01, &fill)).len(), 1);
    let stairs = |row: usize| {
        let p = 5e4 * (row / 50) as f64;
        [p + 200.0 * jitter(row), 0.1 + 1e-4 * jitter(row + 7), force(p, 0.1) + 0.5 * jitter(row + 3)]
    };
    assert_eq!(ranges(&recorded(400, 0.1, &stairs)).len(), 1);
    let both = |row: usize| {
        let p = 2e5 + 1e5 * (TAU * row as f64 / 170.0).sin();
        [p, loops(row), force(p, loops(row))]
    };
    assert_eq!(ranges(&recorded(1200, 0.05, &both)).len(), 1);
}

#[test]
fn rows_at_which_the_specimen_changes_within_a_label() {
    let column = |value: f64| vec![value; 90];
    let mut columns = Columns::new(column(2e5), Trace::Contraction(column(0.1)), column(300.0));
    columns.time_s = Some((0..90).map(|row| 0.1 * f64::from(row)).collect());
    columns.sweep = Some((0..90).map(|row| if row < 45 { "one" } else { "two" }).collect());
    // The second specimen has a label of its own, but for ten rows of the first.
    columns.specimen =
        Some((0..90).map(|row| if (20..30).contains(&row) || row >= 45 { "b" } else { "a" }).collect());
    assert_eq!(Data::from_columns(columns).unwrap().specimen_changes(), [20, 30]);
}

#[test]
fn labels_that_contradict_their_rows_fall_apart() {
    let state = |row: usize| {
        let (p, c) = (1e5 * (1 + row / 100) as f64, 0.1 - 0.1 * (TAU * row as f64 / 100.0).cos());
        [p, c, force(p, c)]
    };
    let labelled = |change: &dyn Fn(&mut Columns)| {
        let column = |i: usize| (0..300).map(|row| state(row)[i]).collect::<Vec<f64>>();
        let mut columns = Columns::new(column(0), Trace::Contraction(column(1)), column(2));
        columns.time_s = Some((0..300).map(|row| 0.1 * row as f64).collect());
        columns.sweep = Some((0..300).map(|_| "all").collect());
        change(&mut columns);
        let data = Data::from_columns(columns).unwrap();
        let found = data.quality(&QualityOptions::default());
        let says: Vec<String> =
            found.of(FindingKind::SweepContradicted).map(|finding| finding.says.clone()).collect();
        assert!(found.of(FindingKind::SweepInterrupted).next().is_none(), "{found:?}");
        (ranges(&data), says.join("; "))
    };
    let (found, says) = labelled(&|_| ());
    assert_eq!(found, [0..100, 100..200, 200..300]);
    assert!(says.starts_with("the pressure steps") && says.contains("2 times"), "{says}");
    let (found, says) = labelled(&|columns| {
        columns.pressure_pa.fill(2e5);
        columns.time_s = Some((0..300).map(|row| 0.1 * (row % 150) as f64).collect());
    });
    assert_eq!(found, [0..150, 150..300]);
    assert!(says.starts_with("the time runs back"), "{says}");
    let (found, says) = labelled(&|columns| {
        columns.pressure_pa.fill(2e5);
        columns.specimen = Some((0..300).map(|row| if row < 150 { "a" } else { "b" }).collect());
    });
    assert_eq!(found, [0..150, 150..300]);
    assert!(says.starts_with("the specimen changes"), "{says}");
    // Labels of one run each are correct.
    let (found, says) = labelled(&|columns| {
        columns.sweep = Some((0..300).map(|row| (row / 100).to_string()).collect());
    });
    assert_eq!((found.len(), says.as_str()), (3, ""));
}

#[test]
fn the_direction_at_turning_points_is_in_doubt() {
    // A triangle along set points, the upper one of which is read twice.
    let way = [0.0, 0.05, 0.1, 0.15, 0.2, 0.2, 0.15, 0.1, 0.05, 0.0];
    assert_eq!(timed(way.to_vec()).direction_in_doubt(), [0, 4, 5]);
    // Dense and noisy rows: as far as the noise looks like motion. The direction of rows at rest in a long
    // hold isn't uncertain.
    let corners = [(0.0, 0), (0.2, 1000), (0.2, 400), (0.0, 1000)];
    let noisy: Vec<f64> =
        polyline(&corners).iter().enumerate().map(|(row, c)| c + 1e-4 * jitter(row)).collect();
    let found = timed(noisy).direction_in_doubt();
    assert!(found.contains(&0) && found.len() < 30, "{found:?}");
    assert!(found.iter().all(|row| *row < 10 || row.abs_diff(1000) < 10), "{found:?}");
    assert!(timed(vec![0.1; 50]).direction_in_doubt().is_empty());
}

#[test]
fn subsets_keep_the_structure() {
    let mut columns = Columns::new(
        vec![1e5; 60],
        Trace::Contraction((0..60).map(|row| 0.01 * f64::from(row % 20)).collect()),
        (0..60).map(f64::from).collect(),
    );
    columns.time_s = Some((0..60).map(f64::from).collect());
    columns.sweep = Some((0..60).map(|row| (row / 20).to_string()).collect());
    let data = Data::from_columns(columns).unwrap();
    let keep: Vec<bool> = (0..60).map(|row| row < 20 && row % 4 != 1 || row >= 45).collect();
    let part = data.subset(&keep);
    assert_eq!(
        part.sweeps().iter().map(|s| (s.name.as_str(), s.rows.clone())).collect::<Vec<_>>(),
        [("0", 0..15), ("2", 15..30)]
    );
    assert_eq!(part.force()[1], 2.0);
    assert_eq!((part.line(1), part.line(15), part.line(99)), ((0, 3), (0, 46), (0, 0)));
    assert_eq!((part.files()[0].rows, part.len(), part.specimens().len()), (30, 30, 1));
    assert_eq!(part.sha256(), data.sha256());
    let (whole, part) = (data.history(1.0), part.history(1.0));
    assert_eq!(whole.subset(&keep).direction, part.direction);
    close(&part.rate, whole.subset(&keep).rate, 1e-9);
    assert!(data.subset(&[]).is_empty());
    assert!(data.subset(&[]).history(1.0).direction.is_empty());
}

/// Filling and venting at one length: the pressure goes to and fro, the rig gives way by 0.1 mm, and the
/// muscle doesn't shorten.
#[test]
fn at_held_length_the_pressure_says_where_the_loop_turns() {
    let mut text = String::from("time [s], pressure [bar], length [mm], force [N]\n");
    for i in 0..=400 {
        let phase = f64::from(i % 200) / 100.0;
        let pressure = 1.0 + 5.0 * if phase < 1.0 { phase } else { 2.0 - phase };
        let length = 240.0 + 0.02 * pressure;
        let _ = writeln!(text, "{:.2},{pressure:.4},{length:.4},{:.1}", 0.1 * f64::from(i), 100.0 * pressure);
    }
    let data = Data::from_csv(&text, "iso.csv").unwrap();
    assert_eq!(data.sweeps().iter().map(|sweep| sweep.kind).collect::<Vec<_>>(), [SweepKind::Isometric]);
    let history = data.history(0.25);
    assert!(history.direction.iter().chain(&history.rate).all(|value| *value == 0.0));
    let at = |row: usize| [history.pressure_direction[row], history.approach[row], history.cycle[row]];
    assert_eq!(
        [at(50), at(150), at(250), at(350)],
        [[1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [1.0, 1.0, 1.0], [-1.0, -1.0, 1.0]]
    );
    // A turning point belongs to the stretch that it ends.
    assert_eq!([at(100)[0], at(101)[0]], [1.0, -1.0]);
    assert_eq!([history.branch[100], history.branch[101], history.branch[300]], [0, 1, 2]);
}

/// Filling and venting in triangles of 100 rows each way, with a given length and force.
fn driven_by_pressure(
    length_mm: impl Fn(f64, u32) -> f64,
    force: impl Fn(f64) -> f64,
    direction: bool,
) -> Data {
    let mut text = String::from("time [s], pressure [bar], length [mm], force [N]");
    text.push_str(if direction { ", direction\n" } else { "\n" });
    for i in 0..=400_u32 {
        let phase = f64::from(i % 200) / 100.0;
        let pressure = 1.0 + 5.0 * if phase < 1.0 { phase } else { 2.0 - phase };
        let (length, force) = (length_mm(pressure, i), force(pressure));
        let _ = write!(text, "{:.2},{pressure:.4},{length:.4},{force:.1}", 0.1 * f64::from(i));
        // A file that assigns the first three rows of each branch to the one before.
        let stated = if (i.max(3) - 3) % 200 < 100 { 1 } else { -1 };
        let _ = if direction { writeln!(text, ",{stated}") } else { writeln!(text) };
    }
    Data::from_csv(&text, "driven.csv").unwrap()
}

#[test]
fn under_a_weight_a_sweep_is_isotonic() {
    let lengthens = |pressure: f64, _| 250.0 - 8.0 * pressure;
    assert_eq!(kinds(&driven_by_pressure(lengthens, |_| 300.0, false)), [SweepKind::Isotonic]);
    // Friction of the guide makes no difference, but a force that follows the pressure does.
    assert_eq!(kinds(&driven_by_pressure(lengthens, |p| 300.0 + 5.0 * p, false)), [SweepKind::Isotonic]);
    assert_eq!(kinds(&driven_by_pressure(lengthens, |p| 100.0 * p, false)), [SweepKind::Loop]);
    let history = driven_by_pressure(lengthens, |_| 300.0, false).history(0.25);
    assert_eq!([history.direction[50], history.pressure_direction[50]], [1.0, 1.0]);
    assert_eq!([history.direction[150], history.pressure_direction[150]], [-1.0, -1.0]);
}

#[test]
fn a_held_length_that_drifts_is_held_and_told() {
    let drifts = |data: &Data| {
        let found = data.quality(&QualityOptions::default());
        found.of(FindingKind::HeldLengthDrifts).next().map(|finding| finding.says.clone())
    };
    // The frame gives way by 0.6 % of the length, and the clamp creeps by as much; a length driven to and fro
    // at each pressure is a motion.
    let pulls = |p: f64| 100.0 * p;
    let cases = [
        (driven_by_pressure(|p, _| 240.0 + 0.3 * (p - 1.0), pulls, false), SweepKind::Isometric),
        (driven_by_pressure(|_, i| 240.0 + 1.5 * f64::from(i) / 400.0, pulls, false), SweepKind::Isometric),
        (driven_by_pressure(|_, i| 240.0 + 0.75 * (0.4 * f64::from(i)).sin(), pulls, false), SweepKind::Loop),
    ];
    for (data, kind) in cases {
        assert_eq!(kinds(&data), [kind]);
        let says = drifts(&data);
        assert_eq!(says.is_some(), kind == SweepKind::Isometric, "{says:?}");
        assert!(says.is_none_or(|says| says.contains("0.62 %")));
    }
    assert_eq!(drifts(&driven_by_pressure(|p, _| 240.0 + 0.02 * p, |p| 100.0 * p, false)), None);
}

#[test]
fn stated_directions_are_taken_where_they_go_with_the_motion() {
    let held = driven_by_pressure(|_, _| 240.0, |p| 100.0 * p, true);
    let loops = driven_by_pressure(|p, _| 250.0 - 8.0 * p, |p| 100.0 * p, true);
    for (history, directions) in [
        (held.history(0.25), held.history(0.25).pressure_direction),
        (loops.history(0.25), loops.history(0.25).direction),
    ] {
        assert_eq!(
            [directions[101], directions[103], directions[201], directions[203]],
            [1.0, -1.0, -1.0, 1.0]
        );
        assert_eq!(history.approach[50], 1.0);
    }
    // Reversed labels aren't used.
    let mut columns = Columns::new(
        vec![2e5; 40],
        Trace::Contraction((0..40).map(|row| 0.005 * f64::from(row)).collect()),
        vec![100.0; 40],
    );
    columns.time_s = Some((0..40).map(f64::from).collect());
    columns.direction = Some(vec![-1; 40]);
    assert_eq!(Data::from_columns(columns).unwrap().history(1.0).direction[20], 1.0);
}

#[test]
fn at_held_length_the_direction_is_in_doubt_where_the_pressure_turns() {
    let data = driven_by_pressure(|_, _| 240.0, |p| 100.0 * p, false);
    assert_eq!(data.direction_in_doubt(), [0, 100, 200, 300]);
}
