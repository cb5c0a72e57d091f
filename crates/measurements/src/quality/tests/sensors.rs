//! Disturbed readings: coarse, clipped, frozen, spikes.

use super::*;

/// Readings on a grid.
fn on_grid(values: &mut [f64], step: f64) {
    for value in values {
        *value = (*value / step).round() * step;
    }
}

#[test]
fn coarse_sensors() {
    type Column = fn(&mut Columns) -> &mut Vec<f64>;
    // Steps are reported in N, % and kPa.
    let sensors: [(&str, Column, [f64; 2], [&str; 2]); 3] = [
        ("force", |columns| &mut columns.force_n, [1.0, 20.0], ["1 N", "20 N"]),
        ("contraction", motion, [5e-4, 5e-3], ["0.05 %", "0.5 %"]),
        ("pressure", |columns| &mut columns.pressure_pa, [500.0, 5000.0], ["0.5 kPa", "5 kPa"]),
    ];
    for (name, column, [fine, rough], said) in sensors {
        for (step, said, severity) in [(fine, said[0], Severity::Note), (rough, said[1], Severity::Warning)] {
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
                says.contains(name) && says.contains(&levels) && says.contains(&format!("steps of {said}:")),
                "{says}"
            );
        }
    }
    // A held quantity is judged by its size: 300 N in steps of 1 N are 308 levels, whatever the noise.
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
    // Triangles of pressure at one length, 8 rows each way; the amplifier saturates at 560 N, where each top
    // has two or three rows.
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
fn a_top_that_is_read_again_and_again_is_clipped_wherever_it_is() {
    // Random set points: neighbours in the file are unrelated.
    let mut noise = Noise::new(11);
    let rows = 400;
    let (mut bar, mut length) = (Vec::new(), Vec::new());
    for row in 0..rows {
        bar.push(1.0 + 5.0 * (0.618_034 * row as f64).fract());
        length.push(0.02 + 0.2 * (0.414_214 * row as f64).fract());
    }
    let force: Vec<f64> =
        (0..rows).map(|i| force(1e5 * bar[i], length[i], 0.0) + 0.5 * noise.normal()).collect();
    let mut sorted = force.clone();
    sorted.sort_by(f64::total_cmp);
    let limit = sorted[rows - 12];
    let over: Vec<usize> = (0..rows).filter(|row| force[*row] >= limit).map(|row| row + 1).collect();
    let pressure = bar.iter().map(|bar| 1e5 * bar).collect();
    let mut columns = Columns::new(pressure, Trace::Contraction(length), force.clone());
    columns.time_s = Some((0..rows).map(|row| 4.0 * row as f64).collect());
    assert_eq!(quality(columns.clone()).of(FindingKind::Clipped).count(), 0);
    columns.force_n.iter_mut().for_each(|f| *f = f.min(limit));
    assert_eq!(lines(&quality(columns), FindingKind::Clipped), over);
    // Coarse readings of a sine are frequent at its top: 2.4 times as frequent as the next.
    let bar: Vec<f64> = (0..rows).map(|i| 3.0 + 2.0 * (0.0157 * i as f64).sin()).collect();
    let force = bar.iter().map(|bar| (20.0 * bar).round()).collect();
    let pressure = bar.iter().map(|bar| 1e5 * bar).collect();
    let mut sine = Columns::new(pressure, Trace::Contraction(vec![0.1; rows]), force);
    sine.time_s = Some((0..rows).map(|row| row as f64).collect());
    assert_eq!(quality(sine).of(FindingKind::Clipped).count(), 0);
}

#[test]
fn a_recording_that_stands_still() {
    let rows: Vec<usize> = (301..340).collect();
    plants(FindingKind::Frozen, &rows, |columns| {
        columns.force_n[300..340].fill(333.3);
        columns.pressure_pa[300..340].fill(100_010.0);
        motion(columns)[300..340].fill(0.1765);
    });
    // A load cell that is frozen while the muscle moves on.
    plants(FindingKind::Frozen, &rows, |columns| columns.force_n[300..340].fill(333.3));
    plants(FindingKind::Frozen, &rows[..7], |columns| columns.force_n[300..308].fill(333.3));
    // One of the other channels, or a gap that was interpolated.
    plants(FindingKind::Frozen, &rows, |columns| columns.pressure_pa[300..340].fill(1.0001e5));
    plants(FindingKind::Frozen, &rows, |columns| {
        let last = motion(columns)[300];
        motion(columns)[300..340].fill(last);
    });
    for channel in 0..3 {
        plants(FindingKind::Frozen, &rows, |columns| {
            let values = match channel {
                0 => &mut columns.force_n,
                1 => &mut columns.pressure_pa,
                _ => motion(columns),
            };
            let [from, to] = [values[300], values[340]];
            for (step, value) in values[301..340].iter_mut().enumerate() {
                *value = from + (to - from) * (step + 1) as f64 / 40.0;
            }
        });
    }
    // Two gaps near each other: neither is usual for this sensor because of the other.
    let near: Vec<usize> = (301..310).chain(320..329).collect();
    plants(FindingKind::Frozen, &near, |columns| {
        for gap in [300..311, 319..330] {
            let from = columns.pressure_pa[gap.start];
            for (step, row) in gap.enumerate() {
                columns.pressure_pa[row] = from + 123.4 * step as f64;
            }
        }
    });
    // A plateau with flickers, and a ramp whose slope is corrected now and then, were read so.
    for every in [10, 12, 15, 20] {
        let mut columns = clean_loops(1, 1);
        for row in 300..360 {
            columns.pressure_pa[row] = 1.0001e5 + if row % every == 0 { 20.0 } else { 0.0 };
        }
        assert_eq!(quality(columns).of(FindingKind::Frozen).count(), 0, "{every}");
        let mut columns = clean_loops(1, 1);
        let mut pressure = columns.pressure_pa[300];
        for row in 300..360 {
            pressure += if row / every % 2 == 0 { 200.0 } else { 230.0 };
            columns.pressure_pa[row] = pressure;
        }
        assert_eq!(quality(columns).of(FindingKind::Frozen).count(), 0, "{every}");
    }
    // A load cell that shows full newtons, at the turning points of a slow loop, isn't frozen.
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
    // An encoder without noise that dwells at the ends of each stroke wasn't frozen, nor did anybody draw the
    // straight ramps between.
    let mut columns = clean_loops(2, 1);
    for (row, contraction) in motion(&mut columns).iter_mut().enumerate() {
        let part = (row % SWEEP % LOOP) as f64 / LOOP as f64;
        *contraction = 0.02 + 0.2 * (1.2 * (1.0 - (2.0 * part - 1.0).abs()) - 0.1).clamp(0.0, 1.0);
    }
    assert_eq!(quality(columns).of(FindingKind::Frozen).count(), 0);
}

#[test]
fn a_coarse_reading_that_was_held() {
    let rows: Vec<usize> = (302..341).collect();
    // A coarse encoder that was held leaps to where it should have been; one that rests before it goes on doesn't.
    let coarse = |value: f64| (value / 2e-4).round() * 2e-4;
    let held = |columns: &mut Columns| {
        for value in motion(columns).iter_mut() {
            *value = coarse(*value);
        }
        let last = motion(columns)[300];
        motion(columns)[300..340].fill(last);
    };
    let mut columns = clean_loops(1, 1);
    held(&mut columns);
    assert_eq!(lines(&quality(columns.clone()), FindingKind::Frozen), rows);
    let rest = motion(&mut columns)[300] - coarse(clean_loops(1, 1).motion.values()[340]);
    motion(&mut columns)[340..].iter_mut().for_each(|value| *value += rest);
    assert_eq!(quality(columns).of(FindingKind::Frozen).count(), 0);
}

/// Every so many rows of a channel are readings; the others are filled in, and don't count.
#[test]
fn a_channel_that_is_read_more_slowly_than_the_others() {
    let fill = |values: &mut [f64], every: usize, is_drawn: bool| {
        let read = values.to_vec();
        for (row, value) in values.iter_mut().enumerate() {
            let (before, after) = (row / every * every, (row / every + 1) * every);
            let part = if is_drawn { (row % every) as f64 / every as f64 } else { 0.0 };
            let after = read.get(after).copied().unwrap_or(read[before]);
            *value = read[before] + (after - read[before]) * part;
        }
    };
    for (every, is_drawn) in [(4, false), (12, false), (4, true), (12, true)] {
        for channel in 0..2 {
            let mut columns = clean_loops(2, 1);
            let values = if channel == 0 { &mut columns.force_n } else { motion(&mut columns) };
            fill(values, every, is_drawn);
            let whole = values.len() / every * every;
            let found = lines(&quality(columns), FindingKind::Frozen);
            let filled: Vec<usize> = (1..whole).filter(|row| row % every != 0).map(|row| row + 1).collect();
            let missed = filled.iter().filter(|row| !found.contains(row)).count();
            let wrong = found.iter().filter(|line| (*line - 1) % every == 0).count();
            assert!(
                missed + wrong <= found.len() / 100,
                "{every} {is_drawn} {channel}: {missed} {wrong} of {}",
                found.len()
            );
        }
    }
    // A drive of straight lines that turns at most of its corners is none, and a force of such lines is.
    let corner = |index: usize| 0.02 + 0.01 * [0.0, 1.0, 3.0][index % 3] + 1e-3 * (index as f64).sin();
    let line = |row: usize| {
        let (index, part) = (row / 12, (row % 12) as f64 / 12.0);
        corner(index) + (corner(index + 1) - corner(index)) * part
    };
    for is_force in [false, true] {
        let mut columns = clean_loops(2, 1);
        let scale = if is_force { 1e4 } else { 1.0 };
        let values = if is_force { &mut columns.force_n } else { motion(&mut columns) };
        values.iter_mut().enumerate().for_each(|(row, value)| *value = scale * line(row));
        assert_eq!(quality(columns).of(FindingKind::Frozen).count() > 0, is_force);
    }
    // Stairs: all channels rest and jump together, and the force creeps on each step.
    let mut columns = clean_loops(2, 1);
    let mut noise = Noise::new(5);
    let step = |row: usize| [0_usize, 1, 2, 3, 4, 5, 4, 3, 2, 1][row / 20 % 10] as f64;
    for (row, contraction) in motion(&mut columns).iter_mut().enumerate() {
        *contraction = 0.02 + 0.03 * step(row);
    }
    for (row, force) in columns.force_n.iter_mut().enumerate() {
        *force = 800.0 - 100.0 * step(row) - 5.0 * ((row % 20 + 1) as f64).ln() + 0.01 * noise.normal();
    }
    assert_eq!(quality(columns).of(FindingKind::Frozen).count(), 0);
}

/// A test that was repeated: set points, and a force that is read in steps of three times its noise.
#[test]
fn repeated_set_points_are_no_copies() {
    for seed in 0..8 {
        let mut noise = Noise::new(seed);
        let level = |i: usize| (i % 24).min(24 - i % 24);
        let pressure = |i: usize| (100.0 + 100.0 * level(i) as f64 / 3.0).round() * 1e3;
        let held = |i: usize| 0.02 + 0.04 * ((i / 72) % 4) as f64;
        let pulls = |i: usize| 270e-5 * pressure(i) * (1.0 - held(i)) + 3.0 * noise.normal();
        let mut forces: Vec<f64> = (0..576).map(pulls).collect();
        on_grid(&mut forces, 9.0);
        let motion = Trace::Contraction((0..576).map(held).collect());
        let mut repeated = Columns::new((0..576).map(pressure).collect(), motion, forces);
        repeated.time_s = Some((0..576).map(f64::from).collect());
        assert_eq!(quality(repeated).of(FindingKind::DuplicateRow).count(), 0, "{seed}");
    }
}

#[test]
fn copied_blocks() {
    let copied: Vec<usize> = (700..760).collect();
    plants(FindingKind::DuplicateRow, &copied, |columns| {
        columns.force_n.copy_within(200..260, 700);
        columns.pressure_pa.copy_within(200..260, 700);
        motion(columns).copy_within(200..260, 700);
    });
    // On coarse grids, of which no column is noisy, a long block is needed.
    let coarse = |columns: &mut Columns, rows: usize| {
        on_grid(&mut columns.force_n, 0.5);
        on_grid(&mut columns.pressure_pa, 500.0);
        on_grid(motion(columns), 2e-4);
        columns.force_n.copy_within(200..200 + rows, 700);
        columns.pressure_pa.copy_within(200..200 + rows, 700);
        motion(columns).copy_within(200..200 + rows, 700);
    };
    plants(FindingKind::DuplicateRow, &copied, |columns| coarse(columns, 60));
    let mut short = clean_loops(2, 1);
    coarse(&mut short, 9);
    assert_eq!(quality(short).of(FindingKind::DuplicateRow).count(), 0);
    // Of one channel alone nobody knows which block was measured.
    let both: Vec<usize> = (200..260).chain(700..760).collect();
    plants(FindingKind::DuplicateRow, &both, |columns| columns.force_n.copy_within(200..260, 700));
    plants(FindingKind::DuplicateRow, &both, |columns| motion(columns).copy_within(200..260, 700));
    // A simulated loop repeats itself, and so does a drive that is told where to go.
    let mut columns = clean_loops(2, 1);
    for (row, contraction) in motion(&mut columns).iter_mut().enumerate() {
        let phase = (row % (4 * LOOP + 1) % LOOP) as f64 / LOOP as f64;
        *contraction = 0.12 - 0.10 * (std::f64::consts::TAU * phase).cos();
    }
    assert_eq!(quality(columns.clone()).of(FindingKind::DuplicateRow).count(), 0);
    // The first sweep and the last one, of a drive whose steps look like noise.
    let mut far = clean_loops(1, 1);
    for row in 0..=LOOP {
        let again = (row * 7919) % 1009;
        motion(&mut far)[row] += 1e-5 * again as f64 / 1009.0;
    }
    let first = motion(&mut far)[..=LOOP].to_vec();
    let end = far.force_n.len();
    motion(&mut far)[end - LOOP - 1..].copy_from_slice(&first);
    assert_eq!(quality(far).of(FindingKind::DuplicateRow).count(), 0);
    let (pressure, motion) = (columns.pressure_pa.clone(), columns.motion.values().to_vec());
    columns.pressure_pa = pressure.iter().map(|p| (p / 1e5).round() * 1e5).collect();
    columns.force_n = (0..motion.len()).map(|i| force(columns.pressure_pa[i], motion[i], 0.0)).collect();
    assert_eq!(quality(columns).of(FindingKind::DuplicateRow).count(), 0);
}

#[test]
fn spikes_in_each_column() {
    plants(FindingKind::Spike, &[150], |columns| columns.force_n[150] += 40.0);
    plants(FindingKind::Spike, &[150, 151, 900, 901, 902], |columns| {
        columns.force_n[150..152].iter_mut().for_each(|f| *f -= 30.0);
        columns.force_n[900..903].iter_mut().for_each(|f| *f += 30.0);
    });
    // A pair, one to each side.
    plants(FindingKind::Spike, &[150, 151], |columns| {
        columns.force_n[150] += 40.0;
        columns.force_n[151] -= 30.0;
    });
    plants(FindingKind::Spike, &[250], |columns| columns.pressure_pa[250] += 2e4);
    plants(FindingKind::Spike, &[350], |columns| motion(columns)[350] += 0.02);
}

#[test]
fn spikes_at_the_ends_of_a_sweep() {
    let last = clean_loops(2, 1).force_n.len() - 1;
    let wild = |columns: &mut Columns, rows: &[usize]| {
        for row in rows {
            columns.force_n[*row] = 9000.0;
        }
    };
    for rows in [vec![0], vec![1], vec![0, 1], vec![2], vec![last - 1, last], vec![SWEEP], vec![SWEEP - 1]] {
        plants(FindingKind::Spike, &rows, |columns| wild(columns, &rows));
    }
    // Beyond all others, which reach 580 N, by more than a fifth of them.
    plants(FindingKind::Spike, &[0], |columns| columns.force_n[0] = 720.0);
    // At both ends of one sweep.
    plants(FindingKind::Spike, &[0, SWEEP - 1], |columns| wild(columns, &[0, SWEEP - 1]));
    plants(FindingKind::Spike, &[last], |columns| motion(columns)[last] = 0.5);
    plants(FindingKind::Spike, &[SWEEP], |columns| columns.pressure_pa[SWEEP] = -8e4);
    // Beside one that is found from both sides.
    plants(FindingKind::Spike, &[0, 40], |columns| wild(columns, &[0, 40]));
    // A row from before all of them moved on, what every sweep begins with, and a reversal of friction.
    let none = |change: &dyn Fn(&mut Columns)| {
        let mut columns = clean_loops(2, 1);
        change(&mut columns);
        assert_eq!(quality(columns).of(FindingKind::Spike).count(), 0);
    };
    none(&|columns| {
        columns.force_n[0] = 0.0;
        columns.pressure_pa[0] = 0.0;
    });
    none(&|columns| (0..3).for_each(|sweep| columns.force_n[sweep * SWEEP] = 0.0));
    none(&|columns| columns.force_n[0] += 20.0);
    // What has filled only half, or lies less far beyond.
    none(&|columns| columns.force_n[0] *= 0.5);
    none(&|columns| columns.pressure_pa[0] *= 0.5);
    none(&|columns| columns.force_n[0] = 650.0);
}

#[test]
fn spikes_are_quoted_with_row_and_unit() {
    let mut columns = clean_loops(2, 1);
    for row in [150, 300, 450, 600] {
        columns.force_n[row] = 512.0;
    }
    let says = has(&quality(columns), FindingKind::Spike, Severity::Warning);
    let expected = "the force of 4 rows lies far from the rows around (row 151: force 512 N, row 301: force 512 N, row 451: force 512 N and 1 more)";
    assert_eq!(says, expected);
}

/// Triangles with Coulomb friction of this size, `rows` rows at each of three pressures.
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
fn spikes_of_what_a_model_leaves_are_found_where_paths_are_cut() {
    // Successive set points of pressure: each is a run of its own, but the residuals of a model go on.
    let mut noise = Noise::new(5);
    let rows = 240;
    let pressure: Vec<f64> =
        (0..rows).map(|i| 1e5 * (1 + i / 40 % 3) as f64 + 30.0 * noise.normal()).collect();
    let length: Vec<f64> = (0..rows).map(|i| 0.02 + 0.001 * (i % 40) as f64).collect();
    let forces = (0..rows).map(|i| force(pressure[i], length[i], 0.0) + 0.5 * noise.normal()).collect();
    let mut columns = Columns::new(pressure, Trace::Contraction(length), forces);
    columns.time_s = Some((0..rows).map(|i| 0.2 * i as f64).collect());
    columns.sweep = Some((0..rows).map(|i| (i / 40).to_string()).collect());
    let data = Data::from_columns(columns).unwrap();
    assert!(data.sweeps().len() > 1);
    let start = data.sweeps()[1].rows.start;
    let mut left: Vec<f64> = (0..rows).map(|_| 0.5 * noise.normal()).collect();
    assert_eq!(data.spikes(&left), [0; 0]);
    for row in [start, start + 38, 100] {
        left[row] += 15.0;
    }
    assert_eq!(data.spikes(&left), [start, start + 38, 100]);
    // A step of the residuals from one run to the next isn't a spike.
    let mut stepped: Vec<f64> = (0..rows).map(|_| 0.5 * noise.normal()).collect();
    stepped[start + 40..start + 80].iter_mut().for_each(|value| *value += 15.0);
    assert_eq!(data.spikes(&stepped), [0; 0]);
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
        // Residuals of a model along the path.
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
    // Student's t with 3 degrees of freedom exceeds 11 in one of 600 rows.
    assert!(called < 60, "{called} of 12000");
}

/// Weights on a muscle that is filled and emptied twice: the lightest is lifted from the lowest pressure on, as a square root,
/// so that a cusp stands at one turning point of many. A disturbed reading there stands out of it.
#[test]
fn the_cusp_of_one_sweep_is_no_spike() {
    let lifted = |disturbed: Option<usize>| {
        let mut noise = Noise::new(5);
        let (mut p, mut c, mut f) = (Vec::new(), Vec::new(), Vec::new());
        for i in 0..480 {
            let (weight, part) = (i / 120, f64::from(i % 120) / 60.0);
            let way = 1.0 - (2.0 * (part % 1.0) - 1.0).abs();
            let from = if weight == 0 { 0.0 } else { -0.5 * f64::from(weight) };
            p.push(0.2e5 + 3.6e5 * way);
            c.push(0.25 * ((way - from) / (1.0 - from)).sqrt() + 1e-5 * noise.normal());
            f.push(50.0 * f64::from(1 + weight) + 0.3 * noise.normal());
        }
        if let Some(row) = disturbed {
            c[row] += 0.2;
        }
        let mut columns = Columns::new(p, Trace::Contraction(c), f);
        columns.time_s = Some((0..480).map(|i| 0.5 * f64::from(i) + 60.0 * f64::from(i / 120)).collect());
        let data = Data::from_columns(columns).unwrap();
        let spikes: Vec<usize> = data
            .disturbed()
            .iter()
            .filter(|found| found.why.contains("spike"))
            .flat_map(|found| found.rows.clone())
            .collect();
        spikes
    };
    assert_eq!(lifted(None), [0_usize; 0]);
    assert_eq!(lifted(Some(180)), [180]);
    assert_eq!(lifted(Some(60)), [60]);
}

#[test]
fn tips_of_loops_are_no_spikes_and_spikes_beside_them_are() {
    let mut noise = Noise::new(5);
    let (mut c, mut f) = (Vec::new(), Vec::new());
    for row in 0..2000_u32 {
        // Triangles of 100 rows. Friction drops where the muscle turns, and one row shows it.
        let way = f64::from(row % 100) / 50.0;
        let x = if way <= 1.0 { way } else { 2.0 - way };
        let tip = if row % 50 == 0 && row > 0 { 30.0 } else { 0.0 };
        c.push(0.02 + 0.2 * x);
        f.push(300.0 - 400.0 * x + tip + 0.5 * noise.normal());
    }
    f[530] += 30.0;
    f[1275] -= 30.0;
    let mut columns = Columns::new(vec![2e5; c.len()], Trace::Contraction(c), f);
    columns.time_s = Some((0..2000).map(|row| 0.01 * f64::from(row)).collect());
    let data = Data::from_columns(columns).unwrap();
    assert_eq!(data.spikes(data.force()), [530, 1275]);
    // A disturbed reading at one turning point of many is a spike as elsewhere.
    let mut once: Vec<f64> = data.force().to_vec();
    for row in (50..2000).step_by(50).filter(|row| *row != 600) {
        once[row] -= 30.0;
    }
    assert_eq!(data.spikes(&once), [530, 600, 1275]);
}
