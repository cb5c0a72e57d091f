//! S4's worked examples, consistency of both directions, and similarity.

use bulge_effects::law::Law;
use bulge_fibre::closed_form;
use bulge_muscles::preset;

use super::*;

const KILOGRAM: f64 = 10.0; // S4 takes 500 N for 50 kg

fn dmsp_20() -> Family {
    let law = Law::find("sarosi-6").unwrap();
    let muscle = preset("dmsp-20-400").unwrap();
    Family::of_law("DMSP-20", law, law.table("DMSP-20-400N, S4"), &muscle, Limits::FLUIDIC).unwrap()
}

fn pleated() -> Family {
    Family::of_muscle(&preset("ppam-2-r16").unwrap(), Vec::new(), Limits::PLEATED).unwrap()
}

fn braided() -> Family {
    Family::of_muscle(&preset("dmsp-20-250").unwrap(), Vec::new(), Limits::FLUIDIC).unwrap()
}

fn wish(pressures_pa: &[f64], lengths_m: &[f64]) -> Requirements {
    Requirements {
        pressures_pa: pressures_pa.to_vec(),
        lengths_m: lengths_m.to_vec(),
        margin: 0.0,
        step_m: 0.0,
        weights: None,
    }
}

fn only(family: &Family, load: &LoadCase, wish: &Requirements) -> Choice {
    let found = size(std::slice::from_ref(family), load, wish).unwrap();
    assert!(found.infeasible.is_empty(), "{:?}", found.infeasible);
    found.choices[0].clone()
}

/// Values read from S4's figure 4, to half a per cent of contraction.
#[test]
fn the_worked_examples_of_s4() {
    let family = dmsp_20();
    let mut worst = [0.0_f64; 2];
    for (kilograms, bar, percent) in [
        (50.0, 4.5, 14.5),
        (50.0, 4.0, 12.5),
        (30.0, 4.0, 17.5),
        (70.0, 4.0, 7.5),
        (50.0, 3.0, 6.5),
        (50.0, 5.0, 16.5),
        (30.0, 3.0, 12.5),
        (70.0, 5.0, 12.5),
    ] {
        let load = LoadCase::lift(0.05, 0.0, KILOGRAM * kilograms).unwrap();
        let choice = only(&family, &load, &wish(&[1e5 * bar], &[]));
        let off = 100.0 * choice.contraction[1] - percent;
        println!("{kilograms} kg at {bar} bar: {:.2} %, {:.1} mm", percent + off, 1e3 * choice.length_m);
        worst[0] = worst[0].max(off.abs());
        // The reverse: the pressure for the length that follows from S4's contraction.
        let other = only(&family, &load, &wish(&[], &[0.05 / (0.01 * percent)]));
        worst[1] = worst[1].max((1e-5 * other.pressure_pa - bar).abs());
    }
    println!("largest differences: {:.2} % of contraction, {:.3} bar", worst[0], worst[1]);
    assert!(worst[0] < 0.5 && worst[1] < 0.12, "{worst:?}");
    let lift = |bar: f64| only(&family, &LoadCase::lift(0.05, 0.0, 500.0).unwrap(), &wish(&[1e5 * bar], &[]));
    assert!((lift(4.5).length_m - 0.345).abs() < 0.002, "S4: 345 mm at 4.5 bar");
    assert!((lift(4.0).length_m - 0.400).abs() < 0.012, "S4: 400 mm at 4 bar");
}

/// For laws and for equilibria: the shortest muscle at a pressure needs exactly this pressure, and pulls
/// exactly the required force.
#[test]
fn both_directions_agree() {
    for (family, stroke, force, pressure) in
        [(dmsp_20(), 0.05, 500.0, 4e5), (pleated(), 0.02, 900.0, 2e5), (braided(), 0.03, 700.0, 5e5)]
    {
        let load = LoadCase::lift(stroke, 0.1 * force, force).unwrap();
        let short = only(&family, &load, &wish(&[pressure], &[]));
        let back = only(&family, &load, &wish(&[], &[short.length_m]));
        let (off, force_off) =
            (back.pressure_pa / pressure - 1.0, short.points[1].available_n.unwrap() / force - 1.0);
        println!(
            "{}: {:.3} mm, pressure {off:.1e}, force {force_off:.1e}",
            family.name(),
            1e3 * short.length_m
        );
        assert!(off.abs() < 1e-7 && force_off.abs() < 1e-8);
        assert!((short.force_margin - force_off).abs() < 1e-12);
        assert!((short.points[1].holding_pressure_pa / pressure - 1.0).abs() < 1e-7);
        assert!(short.points[0].holding_pressure_pa < 0.5 * pressure);
        let strain = (0.5
            * ((pressure / family.limits().pressure_pa).powi(2)
                + (short.contraction[1] / family.limits().contraction[1]).powi(2)))
        .sqrt();
        assert!((short.strain - strain).abs() < 1e-12);
    }
}

/// The pleated muscle against its closed form: p l^2 f(e, l/R) with 40 fibres.
#[test]
fn a_pleated_muscle_of_another_length_is_another_slenderness() {
    let load = LoadCase::lift(0.02, 0.0, 900.0).unwrap();
    let choice = only(&pleated(), &load, &wish(&[2e5], &[]));
    let l = choice.length_m;
    assert!((choice.contraction[1] - (0.05 + 0.02 / l)).abs() < 1e-12);
    let angle = std::f64::consts::TAU / 40.0;
    let f = closed_form::solve(choice.contraction[1], l / 0.016, 0.0).unwrap().force.value;
    assert!((2e5 * l * l * f * angle.sin() / angle / 900.0 - 1.0).abs() < 1e-8);
}

/// Twice the length and the radius give four times the force at the same pressure and contraction.
#[test]
fn pleated_muscles_alike_in_their_slenderness() {
    let family = pleated().similar();
    assert!(family.basis().contains("in proportion"));
    let [one, two] = [0.11, 0.22].map(|l| family.at(l).unwrap());
    assert!(
        (two.diameter_m() / one.diameter_m() - 2.0).abs() < 1e-12 && (one.diameter_m() - 0.032).abs() < 1e-12
    );
    for contraction in [0.06, 0.2, 0.33] {
        let ratio = two.force_n(2e5, contraction).unwrap() / one.force_n(2e5, contraction).unwrap();
        assert!((ratio - 4.0).abs() < 1e-9, "{ratio}");
    }
    // With constant slenderness, the length follows from p l^2 f(e).
    let load = LoadCase::lift(0.02, 0.0, 900.0).unwrap();
    let choice = only(&family, &load, &wish(&[2e5], &[]));
    let angle = std::f64::consts::TAU / 40.0;
    let f = closed_form::solve(choice.contraction[1], 6.875, 0.0).unwrap().force.value;
    assert!((2e5 * choice.length_m.powi(2) * f * angle.sin() / angle / 900.0 - 1.0).abs() < 1e-8);
    assert!((choice.diameter_m - 2.0 * choice.length_m / 6.875).abs() < 1e-12);
}

/// Twice the diameter carries four times the load at the same length and pressure.
#[test]
fn muscles_alike_in_their_cross_section() {
    let load = |force: f64| LoadCase::lift(0.05, 0.0, force).unwrap();
    let one = only(&dmsp_20(), &load(500.0), &wish(&[4e5], &[]));
    let large = dmsp_20().scaled("DMSP-40", 0.04);
    let four = only(&large, &load(2000.0), &wish(&[4e5], &[]));
    assert!((one.length_m / four.length_m - 1.0).abs() < 1e-9);
    assert_eq!((four.family.as_str(), four.diameter_m), ("DMSP-40", 0.04));
    assert!(four.basis.contains("scaled from 20 mm"), "{}", four.basis);
    assert!((large.limits().force_n - 6000.0).abs() < 1e-9, "the maker's 6000 N");
}

#[test]
fn a_margin_is_a_larger_load() {
    let with = Requirements { margin: 0.1, ..wish(&[4e5], &[0.4]) };
    let [a, b] = [(500.0, &with), (550.0, &wish(&[4e5], &[0.4]))].map(|(force, wish)| {
        size(&[dmsp_20()], &LoadCase::lift(0.05, 0.0, force).unwrap(), wish).unwrap().choices
    });
    for (a, b) in a.iter().zip(&b) {
        assert!((a.length_m - b.length_m).abs() < 1e-9 && (a.pressure_pa - b.pressure_pa).abs() < 1.0);
        assert!((a.force_margin - 0.1).abs() < 1e-6 && b.force_margin.abs() < 1e-6);
    }
}

/// An isobar sags between its ends, so a load that falls along the chord would be dropped halfway.
#[test]
fn the_load_is_carried_between_its_points() {
    let family = dmsp_20();
    let p = 4e5;
    let muscle = family.at(0.4).unwrap();
    let forces = [0.0, 0.05].map(|x| muscle.force_n(p, x / 0.4).unwrap());
    let load = LoadCase::lift(0.05, forces[0], forces[1]).unwrap();
    let choice = only(&family, &load, &wish(&[p], &[]));
    assert!(choice.length_m > 0.41, "{}", choice.length_m);
    assert!(choice.force_margin > -1e-8 && choice.force_margin < 1e-6);
}

#[test]
fn lengths_are_rounded_up() {
    let load = LoadCase::lift(0.05, 0.0, 500.0).unwrap();
    let exact = only(&dmsp_20(), &load, &wish(&[4e5], &[])).length_m;
    let rounded = only(&dmsp_20(), &load, &Requirements { step_m: 0.01, ..wish(&[4e5], &[]) });
    assert!(rounded.length_m >= exact && rounded.length_m < exact + 0.01);
    assert!((rounded.length_m / 0.01).fract().min(1.0 - (rounded.length_m / 0.01).fract()) < 1e-9);
    assert!(rounded.force_margin > 0.0);
}

/// If only the length counts, the result is the shortest; if it doesn't count, the longest. Between them, no
/// neighbour has a smaller weighted sum.
#[test]
fn a_compromise_weighs_least() {
    let load = LoadCase::lift(0.05, 0.0, 500.0).unwrap();
    let family = dmsp_20().with_limits(Limits { length_m: [0.04, 1.0], ..Limits::FLUIDIC }).unwrap();
    let by = |pressure, contraction, length| {
        let weights = Some(Weights { pressure, contraction, length });
        only(&family, &load, &Requirements { weights, ..wish(&[], &[]) })
    };
    let shortest = only(&family, &load, &wish(&[6e5], &[])).length_m;
    assert!((by(0.0, 0.0, 1.0).length_m / shortest - 1.0).abs() < 1e-9);
    assert!((by(1.0, 1.0, 0.0).length_m - 1.0).abs() < 1e-9);
    let best = by(1.0, 1.0, 0.25);
    let cost = |length: f64| {
        let at = only(&family, &load, &wish(&[], &[length]));
        (at.pressure_pa / 6e5).powi(2)
            + (at.contraction[1] / 0.25).powi(2)
            + 0.25 * (length / shortest).powi(2)
    };
    println!(
        "compromise: {:.1} mm at {:.3} bar (shortest {:.1} mm)",
        1e3 * best.length_m,
        1e-5 * best.pressure_pa,
        1e3 * shortest
    );
    assert!(best.length_m > 1.2 * shortest && best.length_m < 3.0 * shortest);
    let here = cost(best.length_m);
    assert!(here < cost(0.98 * best.length_m) && here < cost(1.02 * best.length_m));
}

#[test]
fn what_does_not_carry_says_why() {
    let why = |family: &Family, load: &LoadCase, wish: &Requirements| {
        let found = size(std::slice::from_ref(family), load, wish).unwrap();
        assert!(found.choices.is_empty());
        found.infeasible[0].why.clone()
    };
    let lift = |stroke, force| LoadCase::lift(stroke, 0.0, force).unwrap();
    let heavy = why(&dmsp_20(), &lift(0.05, 1400.0), &wish(&[4e5], &[]));
    assert!(heavy.contains("at 4 bar") && heavy.contains("1400.0 N are needed"), "{heavy}");
    assert!(why(&dmsp_20(), &lift(0.05, 1600.0), &wish(&[4e5], &[])).contains("may carry 1500 N"));
    assert!(why(&dmsp_20(), &lift(0.05, 500.0), &wish(&[7e5], &[])).contains("highest pressure is 6 bar"));
    assert!(why(&dmsp_20(), &lift(0.05, 500.0), &wish(&[], &[0.1])).contains("contraction of 50.0 %"));
    assert!(why(&dmsp_20(), &lift(0.05, 500.0), &wish(&[], &[10.0])).contains("40 to 9000 mm"));
    assert!(why(&dmsp_20(), &lift(5.0, 500.0), &wish(&[4e5], &[])).contains("20000 mm of it at least"));
    assert!(why(&pleated(), &lift(0.02, 2900.0), &wish(&[], &[0.1])).contains("pulls"));
}

#[test]
fn nonsense_is_refused() {
    let load = LoadCase::lift(0.05, 0.0, 500.0).unwrap();
    let refused = |wish: Requirements| size(&[dmsp_20()], &load, &wish).unwrap_err().to_string();
    assert!(refused(wish(&[-2e5], &[])).contains("pressure is -2 bar"));
    assert!(refused(wish(&[], &[f64::NAN])).contains("length is NaN"));
    assert!(
        refused(Requirements { margin: -0.1, ..wish(&[], &[]) })
            .contains("margin is -10 %: it must be 0 or more")
    );
    assert!(refused(Requirements { step_m: -1.0, ..wish(&[], &[]) }).contains("0 or more"));
    let weights = Some(Weights { pressure: 0.0, contraction: 0.0, length: 0.0 });
    assert!(refused(Requirements { weights, ..wish(&[], &[]) }).contains("sum of the weights"));
    for limits in [
        Limits { pressure_pa: 0.0, ..Limits::FLUIDIC },
        Limits { contraction: [0.3, 0.2], ..Limits::FLUIDIC },
        Limits { contraction: [-2.0, 0.2], ..Limits::FLUIDIC },
        Limits { length_m: [0.0, 1.0], ..Limits::FLUIDIC },
        Limits { length_m: [2.0, 1.0], ..Limits::FLUIDIC },
        Limits { force_n: 0.0, ..Limits::FLUIDIC },
    ] {
        assert!(dmsp_20().with_limits(limits).is_err(), "{limits:?}");
    }
}

/// The result doesn't depend on the order of the muscles or on the threads.
#[test]
fn the_kindest_comes_first() {
    let load = LoadCase::lift(0.03, 0.0, 400.0).unwrap();
    let families = [dmsp_20(), pleated(), braided(), dmsp_20().scaled("DMSP-40", 0.04)];
    let wish = Requirements { weights: Some(Weights::default()), ..wish(&[2e5, 3e5, 4e5], &[0.2]) };
    let found = size(&families, &load, &wish).unwrap();
    assert!(found.choices.len() + found.infeasible.len() == 20 && found.choices.len() > 8);
    assert!(found.choices.windows(2).all(|pair| pair[0].strain <= pair[1].strain));
    assert!(found.choices.iter().all(|choice| choice.force_margin > -1e-7 && choice.strain <= 1.0 + 1e-9));
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(found, alone.install(|| size(&families, &load, &wish)).unwrap());
}
