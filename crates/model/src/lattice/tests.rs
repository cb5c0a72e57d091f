//! Interpolation is exact to its degree. Rows beyond the end of equilibria leave the others unchanged.

use super::*;
use crate::base::Shaped;
use bulge_fibre::Parts;
use bulge_muscles::{Angle, Braided, Construction, Length, Muscle, Parameter};

/// A braid of 25 degrees with a rubber bladder; its radius is in mm and c10 in Pa.
pub(crate) fn braid(radius: f64, c10: f64) -> (Parts, Equilibrium) {
    let braided = Braided::new(Length::mm(radius), Angle::deg(25.0)).unwrap();
    let muscle = Muscle::new("b", Length::mm(120.0), Construction::Braided(braided)).unwrap();
    let rubber = [(Parameter::Wall, 0.0015), (Parameter::C10, c10)];
    let parts = Parts::of(&muscle.with_all(&rubber).unwrap());
    let equilibrium = Equilibrium::new(Shaped { parts: parts.still(), beside: Vec::new() }).unwrap();
    (parts, equilibrium)
}

/// Nodes for rows around a pressure, from 1 % to a contraction.
pub(crate) fn lattice(equilibrium: &Equilibrium, pressure: f64, most: f64) -> Lattice {
    let empty = Lattice::unsolved(equilibrium, 0, 1.0, false);
    let spans = [0.9, 1.0, 1.1].map(|part| empty.span(part * pressure, [0.01, most]).unwrap());
    empty.around(&spans)
}

fn force(lattice: &Lattice, contraction: f64) -> Option<f64> {
    lattice.answer(2e5, contraction).map(|answer| answer.force.value)
}

/// Rows far beyond the end of equilibria change nothing before it, bit for bit. Rows up to the zero of the
/// force have complete stencils. Beyond the end the error is that of a direct search.
#[test]
fn rows_beyond_the_end_change_nothing_before_it() {
    let equilibrium = braid(10.0, 3e5).1;
    let at = |contraction: f64| equilibrium.answer(2e5, contraction, None).map(|found| found.0.force.value);
    let (mut pulls, mut pushes) = (0.02, 0.6);
    while pushes - pulls > 1e-6 {
        let middle = 0.5 * (pulls + pushes);
        if at(middle).is_ok_and(|force| force > 0.0) { pulls = middle } else { pushes = middle }
    }
    let solved = |most: f64| lattice(&equilibrium, 2e5, most).solved(&equilibrium, &Starts::default()).0;
    let (near, far) = (solved(pulls), solved(0.7));
    for i in 1..60 {
        let contraction = 0.01 + (pulls - 0.01) * f64::from(i) / 60.0;
        let (one, other) = (force(&near, contraction).unwrap(), force(&far, contraction).unwrap());
        assert_eq!(one.to_bits(), other.to_bits(), "{contraction}");
        let alone = at(contraction).unwrap();
        assert!((one - alone).abs() < 1e-4 * at(0.02).unwrap(), "{contraction}: {one} {alone}");
    }
    assert!(force(&far, pulls).is_some(), "no whole stencil at {pulls}");
    // A row without a stencil is solved directly, until equilibria are known to have ended.
    let rows =
        |contraction| answer(Some(&far), &equilibrium, [2e5, contraction], &mut None, &AtomicUsize::new(0));
    let mut ended = None;
    for i in 0..100 {
        let contraction = pulls + (0.69 - pulls) * f64::from(i) / 100.0;
        match (rows(contraction), at(contraction)) {
            (Ok(found), Ok(alone)) => {
                assert!(ended.is_none() && (found.force.value - alone).abs() < 1e-3 * at(0.02).unwrap());
            }
            (Err(one), Err(other)) => {
                ended = Some(contraction);
                assert_eq!(std::mem::discriminant(&one), std::mem::discriminant(&other), "{one}; {other}");
            }
            (one, other) => panic!("{contraction}: {one:?}, {other:?}"),
        }
    }
    assert!(ended.is_some());
}

/// Largest error over the force at 2 %, away from the end of equilibria: 1e-6, 1e-4 on the coarser lattice of
/// a search, and sixth order between them. With rows at levels of pressure it is third order in the pressure.
#[test]
fn errors_fall_with_the_power_of_the_step() {
    let equilibrium = braid(10.0, 1e5).1;
    let exact = |p: f64, contraction: f64| equilibrium.answer(p, contraction, None).unwrap().0.force.value;
    let error = |refinement: f64, levels: bool| {
        let empty = Lattice::unsolved(&equilibrium, 0, refinement, levels);
        let pressures = (0..40).map(|i| 1.5e5 + 3.7e3 * f64::from(i));
        let rows: Vec<(f64, f64)> =
            pressures.zip((0..40).map(|i| 0.01 + 0.0035 * f64::from((7 * i) % 40))).collect();
        let spans: Vec<Span> = rows.iter().map(|(p, _)| empty.span(*p, [0.01, 0.15]).unwrap()).collect();
        let lattice = empty.around(&spans).solved(&equilibrium, &Starts::default()).0;
        rows.iter()
            .map(|(p, e)| {
                (lattice.answer(*p, *e).unwrap().force.value - exact(*p, *e)).abs() / exact(*p, 0.02)
            })
            .fold(0.0, f64::max)
    };
    for (levels, order) in [(false, 16.0..256.0), (true, 4.0..256.0)] {
        let [coarse, usual] = [0.5, 1.0].map(|refinement| error(refinement, levels));
        println!("{levels} {coarse:e} {usual:e}");
        assert!(usual < 1e-6 && coarse < 1e-4, "{levels}: {usual:e} {coarse:e}");
        assert!(order.contains(&(coarse / usual)), "{levels}: {usual:e} {coarse:e}");
    }
}

#[test]
fn weights_are_exact_to_their_degree() {
    for t in [2.0, 2.3, 2.9, 3.0] {
        let (w, d) = weights(t);
        let f = |x: f64| ((x - 1.3) * x + 2.0) * x.powi(3) - 4.0;
        let f_t = |x: f64| 5.0 * x.powi(4) - 4.0 * 1.3 * x.powi(3) + 6.0 * x * x;
        let value: f64 = (0..WIDTH).map(|k| w[k] * f(k as f64)).sum();
        let slope: f64 = (0..WIDTH).map(|k| d[k] * f(k as f64)).sum();
        assert!((value - f(t)).abs() < 1e-11 * f(t).abs() && (slope - f_t(t)).abs() < 1e-11 * f_t(t));
        let (w, d) = parabola(t);
        let square = |k: usize| (k as f64 - 1.3) * k as f64 + 2.0;
        let [value, slope] = [w, d].map(|weights| (0..WIDTH).map(|k| weights[k] * square(k)).sum::<f64>());
        assert!((value - ((t - 1.3) * t + 2.0)).abs() < 1e-12 && (slope - (2.0 * t - 1.3)).abs() < 1e-12);
    }
}

/// The steps follow the logarithm of the contraction where the force is infinite at contraction 0, which has no node there.
#[test]
fn a_singular_muscle_has_nodes_above_zero() {
    let preset = bulge_muscles::preset("ppam-2-r16").unwrap();
    let parts = Parts::of(&preset).still();
    let pleated = Equilibrium::new(Shaped { parts, beside: Vec::new() }).unwrap();
    let spans = |equilibrium: &Equilibrium| {
        let lattice = Lattice::unsolved(equilibrium, 0, 1.0, false);
        [-0.01, 0.0, 0.05].map(|e| lattice.span(2e5, [e, e]).is_some())
    };
    assert_eq!(spans(&pleated), [false, false, true]);
    assert_eq!(spans(&braid(10.0, 1e5).1), [true; 3]);
}

/// Places of negative, tiny and large contractions are the inverse of those of the nodes.
#[test]
fn places_lead_back_to_contractions() {
    let lattice = Lattice::unsolved(&braid(10.0, 1e5).1, 0, 1.0, false);
    for e in [-0.3, -0.02, -1e-9, 0.0, 1e-12, 1e-3, 0.02, 0.2, 0.9] {
        let back = BEND * lattice.contraction_axis(e).unwrap().sinh();
        assert!((back - e).abs() < 2e-15 * (1.0 + e.abs()), "{e}: {back}");
    }
    assert_eq!(lattice.contraction_axis(f64::INFINITY), None);
}

/// Nodes of both lattices are called by their place on the finer one, so that one starts from the other.
#[test]
fn a_node_has_one_name() {
    let equilibrium = braid(10.0, 1e5).1;
    for levels in [false, true] {
        let empty = Lattice::unsolved(&equilibrium, 0, 1.0, levels);
        let spans = [2e5, 2.2e5].map(|p| empty.span(p, [0.01, 0.1]).unwrap());
        let lattice = empty.around(&spans);
        let fine = STEP[0] / LEVEL_STEPS as f64;
        for (row, column) in [(0, 0), (1, 3), (2, 5)] {
            let [of_pressure, of_contraction] = lattice.key(row, column);
            let ln_p = (lattice.low[0] as f64 + row as f64) * lattice.steps[0];
            assert!((of_pressure as f64 * fine - ln_p).abs() < 1e-9, "{levels}: {of_pressure} {ln_p}");
            assert_eq!(of_contraction, lattice.low[1] + i64::try_from(column).unwrap());
        }
    }
}

/// A row has no equilibrium for sure only if they have ended at the pressures on both sides.
#[test]
fn equilibria_end_at_both_neighbouring_pressures() {
    let equilibrium = braid(10.0, 1e6).1;
    let empty = Lattice::unsolved(&equilibrium, 0, 1.0, false);
    let spans: Vec<Span> = (0..8).map(|i| empty.span(6e4 * 1.1_f64.powi(i), [0.01, 0.4]).unwrap()).collect();
    let lattice = empty.around(&spans).solved(&equilibrium, &Starts::default()).0;
    let (mut both, mut one) = (0, 0);
    for line in 0..lattice.count[0] - 1 {
        let ends = [line, line + 1].map(|line| lattice.ends[line].as_ref().map(|(end, _)| *end));
        let [Some(below), Some(above)] = ends else { continue };
        let pressure = ((lattice.low[0] as f64 + line as f64 + 0.5) * lattice.steps[0]).exp();
        for column in below.min(above).saturating_sub(1)..below.max(above) + 3 {
            let contraction = 0.5 * (lattice.contraction(column) + lattice.contraction(column + 1));
            let is_beyond = column > below && column > above;
            assert_eq!(
                lattice.beyond(pressure, contraction).is_some(),
                is_beyond,
                "{line} {column} {ends:?}"
            );
            both += usize::from(is_beyond);
            one += usize::from(!is_beyond && (column > below || column > above));
        }
    }
    assert!(both > 0 && one > 0, "{both} {one}");
}
