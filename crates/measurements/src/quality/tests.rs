//! Each fault planted in clean loops is found in the right place, and nothing else is found.

use super::*;
use crate::MeasurementError;
use crate::columns::{Columns, Trace};
use crate::simulated::{LOOP, Noise, clean_loops, force};

mod sensors;

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

/// Requires a finding about the data as a whole.
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
    for seed in 0..12 {
        for loops in [1, 2, 5] {
            let columns = clean_loops(loops, seed);
            let found = quality(columns.clone());
            assert_eq!(found.findings, [], "{seed}");
            // Labels or none, lengths and the muscle's size make no difference.
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
    // The same without labels.
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

#[test]
fn a_slack_muscle() {
    let columns = |c_max: f64, seed: u64| {
        // The muscle contracts beyond its free contraction of 1/2.8 = 35.7 %.
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
        // Rows near zero on both sides are within the resolution.
        assert!(rows.len() <= beyond.len() + 4, "{found:#?}");
        // Up to the free contraction there is a note at most.
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
    // Repeats, some of which are equal by chance.
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
    assert!(says(|columns| columns.force_n[3] = 2e6).contains("such as 2000000 N"));
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
    assert!(matches!(data.motion(), Trace::Length(_)));
    let json = serde_json::to_value(&found).unwrap();
    assert_eq!(json["findings"][1]["kind"], "impossible-value");
    assert_eq!(json["findings"][1]["severity"], "error");
    assert_eq!(json["findings"][1]["rows"][0]["first"], 5);
    assert_eq!(Data::from_csv("", "a.csv").unwrap_err(), MeasurementError::empty("a.csv"));
}
