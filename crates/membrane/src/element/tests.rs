//! Elements against differences of their energies, against rotations, and against closed forms.

use super::shape::triangle;
use super::*;
use crate::material::{Cloth, Law, Orthotropic, Sheet, Tension, Thread};
use crate::set::Element;
use core::f64::consts::PI;

const PENALTY: f64 = 40.0;
const PRESSURE: f64 = 0.7;

const LAWS: [Law; 5] = [
    Law::Hencky { stiffness: 3.0, poisson: 0.3 },
    Law::SaintVenantKirchhoff { stiffness: 3.0, poisson: 0.4 },
    Law::NeoHooke { shear: 1.3 },
    Law::MooneyRivlin { c1: 0.6, c2: 0.2 },
    Law::Gent { shear: 1.3, limit: 30.0 },
];
const WOVEN: Orthotropic = Orthotropic { warp: 4.0, weft: 2.5, poisson: 0.35, shear: 0.4 };

/// Every cloth, wrinkling or not; the residual is large enough to be seen.
fn sheets() -> Vec<Sheet> {
    let cloths = LAWS.into_iter().map(Cloth::Isotropic).chain([Cloth::Orthotropic(WOVEN)]);
    cloths
        .flat_map(|cloth| {
            [(false, 0.0), (true, 0.0), (true, 0.02)].map(|(wrinkles, residual)| Sheet {
                cloth,
                wrinkles,
                residual,
            })
        })
        .collect()
}

/// dW/dl1 and dW/dl2 over the stretches themselves, by hand.
fn by_hand(cloth: &Cloth, l1: f64, l2: f64) -> [f64; 2] {
    let volume = 1.0 / (l1 * l2).powi(2);
    match *cloth {
        Cloth::Isotropic(Law::Hencky { stiffness, poisson }) => {
            let y = stiffness / (1.0 - poisson * poisson);
            [y * (l1.ln() + poisson * l2.ln()) / l1, y * (l2.ln() + poisson * l1.ln()) / l2]
        }
        Cloth::Isotropic(Law::SaintVenantKirchhoff { stiffness, poisson }) => {
            let y = 0.5 * stiffness / (1.0 - poisson * poisson);
            let (a, b) = (l1 * l1 - 1.0, l2 * l2 - 1.0);
            [l1 * y * (a + poisson * b), l2 * y * (b + poisson * a)]
        }
        Cloth::Isotropic(Law::NeoHooke { shear }) => [shear * (l1 - volume / l1), shear * (l2 - volume / l2)],
        Cloth::Isotropic(Law::MooneyRivlin { c1, c2 }) => [
            2.0 * c1 * (l1 - volume / l1) + 2.0 * c2 * (l1 * l2 * l2 - l1.powi(-3)),
            2.0 * c1 * (l2 - volume / l2) + 2.0 * c2 * (l2 * l1 * l1 - l2.powi(-3)),
        ],
        Cloth::Isotropic(Law::Gent { shear, limit }) => {
            let harder = shear * limit / (limit - (l1 * l1 + l2 * l2 + volume - 3.0));
            [harder * (l1 - volume / l1), harder * (l2 - volume / l2)]
        }
        Cloth::Orthotropic(Orthotropic { warp, weft, poisson, .. }) => {
            let below = 1.0 - poisson * poisson * weft / warp;
            let (a, b) = (0.5 * (l1 * l1 - 1.0), 0.5 * (l2 * l2 - 1.0));
            [l1 * (warp * a + poisson * weft * b) / below, l2 * weft * (b + poisson * a) / below]
        }
    }
}

/// Stretch of a strip across its pull along the first axis, by hand.
fn natural(cloth: &Cloth, l: f64) -> f64 {
    match *cloth {
        Cloth::Isotropic(Law::Hencky { poisson, .. }) => l.powf(-poisson),
        Cloth::Isotropic(Law::SaintVenantKirchhoff { poisson, .. })
        | Cloth::Orthotropic(Orthotropic { poisson, .. }) => (1.0 - poisson * (l * l - 1.0)).sqrt(),
        Cloth::Isotropic(_) => 1.0 / l.sqrt(),
    }
}

/// Pairs of stretches with what a wrinkling sheet does there: inside each state, and 1e-3 to either side of each border.
fn states(cloth: &Cloth) -> Vec<([f64; 2], Tension)> {
    let n = natural(cloth, 1.2);
    vec![
        ([1.3, 1.15], Tension::Taut),
        ([1.2, n + 1e-3], Tension::Taut),
        ([1.2, n - 1e-3], Tension::Wrinkled),
        ([1.25, 0.6], Tension::Wrinkled),
        ([1.0 + 1e-3, 0.8], Tension::Wrinkled),
        ([1.0 - 1e-3, 0.8], Tension::Slack),
        ([0.9, 0.7], Tension::Slack),
    ]
}

/// Step of the differences: two of them stay on one side of a border that is 1e-3 away.
const STEP: f64 = 1e-4;

/// Numbers between -1 and 1 without order.
fn noise(seed: usize) -> f64 {
    let x = (seed as f64 * 12.9898 + 4.1414).sin() * 43_758.545_3;
    2.0 * (x - x.floor()) - 1.0
}

fn shaken<const N: usize>(x: &[Vector; N], by: f64) -> [Vector; N] {
    let mut out = *x;
    for (a, x) in out.iter_mut().enumerate() {
        for (i, x) in x.iter_mut().enumerate() {
            *x += by * noise(3 * a + i);
        }
    }
    out
}

/// A rotation about an axis that is none of the coordinate ones.
fn rotated(v: Vector, angle: f64) -> Vector {
    let axis = scaled([2.0, -1.0, 1.5], 1.0 / norm([2.0, -1.0, 1.5]));
    let (sin, cos) = angle.sin_cos();
    add(add(scaled(v, cos), scaled(cross(axis, v), sin)), scaled(axis, dot(axis, v) * (1.0 - cos)))
}

/// Force, sweep and stiffness against differences of fourth order, and the symmetry of what is stored.
fn check<E: Element<N>, const N: usize>(element: &E, x: &[Vector; N], what: &str) {
    let rule = E::rule();
    let now = element.local(x, PENALTY, PRESSURE, &rule);
    let measured = element.measure(x, PENALTY, &rule);
    assert!((measured[0] - now.energy).abs() < 1e-13 && (measured[1] - now.volume).abs() < 1e-13, "{what}");
    let largest = now.stiffness.as_flattened().as_flattened().as_flattened();
    let largest = largest.iter().fold(1e-6_f64, |a, b| a.max(b.abs()));
    for a in 0..N {
        for i in 0..3 {
            for j in 0..3 {
                let skew = now.stiffness[a][a][i][j] - now.stiffness[a][a][j][i];
                assert!(skew.abs() < 1e-14 * largest, "{what}: skew {skew:e} of {largest:e}");
            }
        }
    }
    for b in 0..N {
        for j in 0..3 {
            let moved = |steps: f64| {
                let mut x = *x;
                x[b][j] += steps * STEP;
                x
            };
            let places = [-2.0, -1.0, 1.0, 2.0].map(moved);
            let slope = |f: [f64; 4]| (8.0 * (f[2] - f[1]) - (f[3] - f[0])) / (12.0 * STEP);
            let measures = places.map(|x| element.measure(&x, PENALTY, &rule));
            let (force, sweep) = (slope(measures.map(|m| m[0])), slope(measures.map(|m| m[1])));
            let (own_force, own_sweep) = (now.force[b][j], now.sweep[b][j]);
            assert!((force - own_force).abs() < 2e-10 * largest, "{what}: force {b} {j} {own_force} {force}");
            assert!((sweep - own_sweep).abs() < 1e-10, "{what}: sweep {b} {j} {own_sweep} {sweep}");
            let locals = places.map(|x| element.local(&x, PENALTY, PRESSURE, &rule));
            for a in 0..N {
                for i in 0..3 {
                    let expected = slope(core::array::from_fn(|k| {
                        locals[k].force[a][i] - PRESSURE * locals[k].sweep[a][i]
                    }));
                    let given = if a <= b { now.stiffness[a][b][i][j] } else { now.stiffness[b][a][j][i] };
                    assert!(
                        (given - expected).abs() < 1e-9 * largest,
                        "{what}: stiffness {a} {i} by {b} {j}: {given} {expected}"
                    );
                }
            }
        }
    }
}

// ---- cables

/// At these stretches of the whole, straight or bent.
fn cable<const N: usize>(reference: &[Vector; N], stretch: f64, bend: f64) -> [Vector; N] {
    shaken(reference, bend).map(|x| add(rotated(scaled(x, stretch), 1.1), [0.3, 0.2, -0.5]))
}

const STRAIGHT: [Vector; 3] = [[0.2, 0.1, 0.3], [1.0, 0.5, -0.4], [0.6, 0.3, -0.05]];
const BENT: [Vector; 3] = [[0.2, 0.1, 0.3], [1.0, 0.5, -0.4], [0.55, 0.42, 0.0]];

fn cables_of<const N: usize>(reference: &[Vector; N]) {
    for thread in [Thread::Elastic { stiffness: 25.0 }, Thread::Inextensible] {
        let fresh = Cable::new(reference, thread, 0.5).unwrap();
        let mut held = fresh.clone();
        // T0 = 40 x 0.03, and less where it is taken at a bent place.
        held.hold(&cable(reference, 1.03, 0.0), PENALTY);
        let mut uneven = fresh.clone();
        uneven.hold(&cable(reference, 1.05, 0.02), PENALTY);
        for (name, element) in [("fresh", &fresh), ("held", &held), ("uneven", &uneven)] {
            for stretch in [1.2, 1.001, 0.999, 0.971, 0.969, 0.8] {
                for bend in [0.0, 0.03] {
                    // Bent ones may straddle the border; only the whole stretches keep away from it.
                    let x = cable(reference, stretch, if (stretch - 1.0).abs() < 0.1 { 0.0 } else { bend });
                    check::<_, N>(element, &x, &format!("{thread:?} {name} {stretch} {bend}"));
                }
            }
        }
    }
}

#[test]
fn cables_follow_their_energy() {
    cables_of::<2>(&[STRAIGHT[0], STRAIGHT[1]]);
    cables_of::<3>(&STRAIGHT);
    cables_of::<3>(&BENT);
}

#[test]
fn a_cable_pulls_with_its_strain() {
    // T = EA (l - 1), energy = L T (l - 1)/2.
    let reference = [[0.0, 0.0, 0.0], [0.0, 3.0, 4.0]];
    let element = Cable::<2>::new(&reference, Thread::Elastic { stiffness: 25.0 }, 0.5).unwrap();
    let x = reference.map(|x| scaled(x, 1.2));
    let local = element.local(&x, PENALTY);
    assert!((local.energy - 0.5 * 5.0 * 0.5 * 25.0 * 0.04).abs() < 1e-14);
    assert!(
        (local.force[1][2] - 0.5 * 5.0 * 0.8).abs() < 1e-14
            && (local.force[1][1] - 0.5 * 5.0 * 0.6).abs() < 1e-14
    );
    let (tension, stretch) = element.tension(&x, PENALTY);
    assert!((tension - 5.0).abs() < 1e-13 && (stretch - 1.2).abs() < 1e-15);
    // Held: T0 = EA (l - 1) is the tension at l = 1, and what is measured is the error of the length.
    let mut element = Cable::<2>::new(&reference, Thread::Inextensible, 1.0).unwrap();
    let worst = element.hold(&x, PENALTY);
    assert!((worst - 0.2).abs() < 1e-15);
    let (tension, _) = element.tension(&reference, PENALTY);
    assert!((tension - 8.0).abs() < 1e-13);
    assert!((norm(element.local(&reference, PENALTY).force[1]) - 8.0).abs() < 1e-13);
    // Slack: T0 falls to nothing.
    assert!(element.hold(&reference.map(|x| scaled(x, 0.7)), PENALTY).abs() < 1e-15);
    let (tension, _) = element.tension(&reference, PENALTY);
    assert!(tension.abs() < 1e-15);
}

// ---- membranes of revolution

/// A cylinder, a cone, and a bent meridian with its middle node aside; each ends in its radius.
const CYLINDER: [Vector; 3] = [[1.4, 0.0, 0.2], [1.4, 0.0, 1.3], [1.4, 0.0, 0.75]];
const MERIDIAN: [Vector; 3] = [[0.9, 0.0, 0.1], [1.5, 0.0, 1.1], [1.3, 0.0, 0.5]];

fn cut<const N: usize>(places: &[Vector; 3]) -> [Vector; N] {
    core::array::from_fn(|i| places[i])
}

fn revolved_at<const N: usize>(
    reference: &[Vector; N],
    [along, around]: [f64; 2],
    shake: f64,
) -> [Vector; N] {
    shaken(reference, shake).map(|[r, _, z]| [around * r, 0.0, along * z + 0.3])
}

fn rings_of<const N: usize>() {
    for sheet in sheets() {
        for fullness in [1.0, 1.3] {
            let layers = [RingLayer::Sheet { sheet, fullness }];
            for (stretch, tension) in states(&sheet.cloth) {
                let around = [stretch[0], stretch[1] * fullness];
                let x = revolved_at(&cut::<N>(&CYLINDER), around, 0.0);
                let element = Ring::<N>::new(&cut(&CYLINDER), &layers).unwrap();
                let what = format!("{N} {sheet:?} {fullness} {stretch:?}");
                check(&element, &x, &what);
                let CarriedByRing::Sheet { tension: found, .. } = element.carried(&x, PENALTY)[0] else {
                    panic!("{what}")
                };
                assert!(!sheet.wrinkles || found == tension, "{what}: {found:?}");
                // The other way round: wrinkles along the meridian.
                let isotropic = matches!(sheet.cloth, Cloth::Isotropic(_));
                let x = revolved_at(&cut::<N>(&CYLINDER), [stretch[1], stretch[0] * fullness], 0.0);
                check(&element, &x, &format!("turned {what}"));
                let CarriedByRing::Sheet { tension: found, .. } = element.carried(&x, PENALTY)[0] else {
                    panic!("{what}")
                };
                assert!(!sheet.wrinkles || !isotropic || found == tension, "{what}: {found:?}");
                // A bent meridian in the midst of each state.
                if [1.3, 1.25, 0.9].contains(&stretch[0]) {
                    let element = Ring::<N>::new(&cut(&MERIDIAN), &layers).unwrap();
                    check(
                        &element,
                        &revolved_at(&cut::<N>(&MERIDIAN), around, 0.01),
                        &format!("bent {what}"),
                    );
                }
            }
        }
    }
}

#[test]
fn sheets_of_revolution_follow_their_energy() {
    rings_of::<2>();
    rings_of::<3>();
}

fn threads_of<const N: usize>() {
    let angle = 0.5_f64;
    let elastic =
        |angle| RingLayer::Threads { thread: Thread::Elastic { stiffness: 3.0 }, count: 7.0, angle };
    let net = |angle| RingLayer::Threads { thread: Thread::Inextensible, count: 5.0, angle };
    let rubber = Sheet { cloth: Cloth::Isotropic(LAWS[2]), wrinkles: true, residual: 0.02 };
    let all = [elastic(angle), net(0.0), RingLayer::Sheet { sheet: rubber, fullness: 1.1 }, net(angle)];
    for layers in [&all[..1], &all[1..2], &all[3..], &all[..]] {
        let mut element = Ring::<N>::new(&cut(&CYLINDER), layers).unwrap();
        let mut bent = Ring::<N>::new(&cut(&MERIDIAN), layers).unwrap();
        for is_held in [false, true] {
            // Whole stretches in both directions stretch every family alike: taut, and close to where T0 = 0 or T0 = 40 x 0.03 ends.
            for stretch in [1.2, 1.001, 0.999, 0.971, 0.969, 0.8] {
                let x = revolved_at(&cut::<N>(&CYLINDER), [stretch; 2], 0.0);
                check(&element, &x, &format!("{N} {layers:?} {is_held} {stretch}"));
            }
            for stretch in [[1.2, 1.3], [1.2, 0.9], [0.8, 0.7]] {
                let x = revolved_at(&cut::<N>(&MERIDIAN), stretch, 0.01);
                check(&bent, &x, &format!("{N} bent {layers:?} {is_held} {stretch:?}"));
            }
            element.hold(&revolved_at(&cut::<N>(&CYLINDER), [1.03; 2], 0.0), PENALTY);
            bent.hold(&revolved_at(&cut::<N>(&MERIDIAN), [1.03; 2], 0.02), PENALTY);
        }
    }
}

#[test]
fn threads_of_revolution_follow_their_energy() {
    threads_of::<2>();
    threads_of::<3>();
}

#[test]
fn a_cylinder_of_rubber_holds_its_pressure() {
    // Closed form: p R/(mu H) = (1 - 1/(l^4 lz^2))/lz and the axial force 2 pi R mu H (lz - 1/(lz^3 l^2)).
    let (radius, shear) = (1.4, 1.3);
    let sheet = Sheet { cloth: Cloth::Isotropic(Law::NeoHooke { shear }), wrinkles: false, residual: 0.0 };
    let rule = Ring::<3>::volume_rule();
    let element = Ring::<3>::new(&CYLINDER, &[RingLayer::Sheet { sheet, fullness: 1.0 }]).unwrap();
    for (l, lz, expected) in [
        (1.1, 1.0, 0.316_986_544_635),
        (1.25, 1.0, 0.5904),
        (1.5, 1.0, 0.802_469_135_802),
        (2.0, 1.0, 0.9375),
        (1.3, 1.054_154_188_464, 0.649_735_909_791),
        (1.5, 1.138_601_389_019, 0.744_450_856_695),
    ] {
        let x = revolved_at(&CYLINDER, [lz, l], 0.0);
        let local = element.local(&x, PENALTY, 0.0, &rule);
        let radial = |v: [Vector; 3]| v.iter().map(|v| v[0]).sum::<f64>();
        let pressure = radial(local.force) / radial(local.sweep) * radius / shear;
        assert!((pressure / expected - 1.0).abs() < 1e-11, "{l} {lz}: {pressure}");
        let axial = 2.0 * PI * radius * shear * (lz - 1.0 / (lz.powi(3) * l * l));
        assert!((local.force[1][2] / axial - 1.0).abs() < 1e-13, "{l} {lz}");
        assert!((local.force[0][2] / axial + 1.0).abs() < 1e-13, "{l} {lz}");
        // pi r^2 h.
        assert!((local.volume / (PI * (l * radius).powi(2) * lz * 1.1) - 1.0).abs() < 1e-14);
        // W = mu/2 (I1 - 3) over 2 pi R h.
        let energy = 0.5 * shear * (l * l + lz * lz + (l * lz).powi(-2) - 3.0) * 2.0 * PI * radius * 1.1;
        assert!((local.energy / energy - 1.0).abs() < 1e-13);
    }
    assert!((element.area() - 2.0 * PI * radius * 1.1).abs() < 1e-14);
}

#[test]
fn a_cone_holds_its_volume_and_area() {
    // pi h (a^2 + a b + b^2)/3 and pi (a + b) s.
    let cone = [[0.9, 0.0, 0.1], [1.5, 0.0, 1.1]];
    let volume = PI * (0.81 + 1.35 + 2.25) / 3.0;
    assert!((Ring::<2>::volume(&cone, &Ring::<2>::volume_rule()) / volume - 1.0).abs() < 1e-14);
    let middle = [cone[0], cone[1], scaled(add(cone[0], cone[1]), 0.5)];
    assert!((Ring::<3>::volume(&middle, &Ring::<3>::volume_rule()) / volume - 1.0).abs() < 1e-14);
    let area = PI * 2.4 * (0.36_f64 + 1.0).sqrt();
    assert!((Ring::<2>::new(&cone, &[]).unwrap().area() / area - 1.0).abs() < 1e-14);
    assert!((Ring::<3>::new(&middle, &[]).unwrap().area() / area - 1.0).abs() < 1e-14);
}

#[test]
fn what_a_membrane_of_revolution_carries() {
    let angle = 0.5_f64;
    for sheet in sheets().into_iter().filter(|sheet| !sheet.wrinkles) {
        for fullness in [1.0, 1.3] {
            let threads =
                RingLayer::Threads { thread: Thread::Elastic { stiffness: 3.0 }, count: 7.0, angle };
            let layers = [RingLayer::Sheet { sheet, fullness }, threads];
            let element = Ring::<3>::new(&CYLINDER, &layers).unwrap();
            for [l1, l2] in [[1.3, 1.15], [1.3, 1.3], [1.4, 0.8]] {
                let x = revolved_at(&CYLINDER, [l1, l2 * fullness], 0.0);
                let carried = element.carried(&x, PENALTY);
                let [w1, w2] = by_hand(&sheet.cloth, l1, l2);
                let CarriedByRing::Sheet { force, stretch, .. } = carried[0] else { panic!() };
                let what = format!("{sheet:?} {l1} {l2}: {force:?}");
                assert!((force[0] - w1 / l2).abs() < 1e-12 && (force[1] - w2 / l1).abs() < 1e-12, "{what}");
                assert!((stretch[0] - l1).abs() < 1e-14 && (stretch[1] - l2).abs() < 1e-14, "{what}");
                let CarriedByRing::Threads { tension, stretch, angle: now } = carried[1] else { panic!() };
                let (across, along) = (l2 * fullness * angle.sin(), l1 * angle.cos());
                assert!(
                    (stretch - across.hypot(along)).abs() < 1e-14
                        && (now - across.atan2(along)).abs() < 1e-14
                );
                assert!((tension - 3.0 * (stretch - 1.0).max(0.0)).abs() < 1e-13);
            }
        }
    }
}

#[test]
fn threads_carry_what_a_braid_does() {
    // n threads at the present angle b on a cylinder of radius r pull with n T cos b along it.
    let angle = 0.5_f64;
    let threads = RingLayer::Threads { thread: Thread::Elastic { stiffness: 3.0 }, count: 7.0, angle };
    let element = Ring::<2>::new(&cut(&CYLINDER), &[threads]).unwrap();
    let (along, around) = (1.3, 1.15);
    let x = revolved_at(&cut::<2>(&CYLINDER), [along, around], 0.0);
    let local = element.local(&x, PENALTY, 0.0, &Ring::<2>::volume_rule());
    let (a, b) = (along * angle.cos(), around * angle.sin());
    let stretch = a.hypot(b);
    let tension = 3.0 * (stretch - 1.0);
    assert!((local.force[1][2] - 7.0 * tension * a / stretch).abs() < 1e-13);
    // Each is h/cos a long.
    assert!((local.energy - 7.0 * 0.5 * tension * (stretch - 1.0) * 1.1 / angle.cos()).abs() < 1e-13);
    // Hoop: the work of dr is n T dl_f L.
    let hoop = 7.0 * tension * 1.1 / angle.cos() * b * angle.sin() / stretch / 1.4;
    assert!((local.force[0][0] + local.force[1][0] - hoop).abs() < 1e-13);
}

#[test]
fn membranes_of_revolution_move_along_their_axis() {
    let sheet = Sheet { cloth: Cloth::Isotropic(LAWS[3]), wrinkles: true, residual: 0.0 };
    let element = Ring::<3>::new(&MERIDIAN, &[RingLayer::Sheet { sheet, fullness: 1.1 }]).unwrap();
    let rule = Ring::<3>::volume_rule();
    let x = revolved_at(&MERIDIAN, [1.2, 1.4], 0.02);
    let (a, b) = (
        element.local(&x, PENALTY, PRESSURE, &rule),
        element.local(&x.map(|x| add(x, [0.0, 0.0, 7.0])), PENALTY, PRESSURE, &rule),
    );
    assert!(
        (a.energy - b.energy).abs() < 1e-14 * a.energy.abs() * 10.0 && (a.volume - b.volume).abs() < 1e-13
    );
    for i in 0..3 {
        assert!(norm(sub(a.force[i], b.force[i])) < 1e-13 && norm(sub(a.sweep[i], b.sweep[i])) < 1e-13);
    }
    // No force along the axis on the whole.
    assert!(a.force.iter().map(|f| f[2]).sum::<f64>().abs() < 1e-13);
}

// ---- triangles

const FLAT: [Vector; 3] = [[0.1, 0.2, 0.0], [1.3, 0.1, 0.0], [0.4, 1.1, 0.0]];

/// Six nodes from three corners, the middles moved by `bulge`.
fn six(corners: [Vector; 3], bulge: f64) -> [Vector; 6] {
    let middle = |i: usize, j: usize| {
        let at = scaled(add(corners[i], corners[j]), 0.5);
        add(at, scaled([noise(i + 50), noise(i + 60), noise(i + 70)], bulge))
    };
    [corners[0], corners[1], corners[2], middle(0, 1), middle(1, 2), middle(2, 0)]
}

/// Stretched in its plane, the first stretch at `angle` to x, then turned and moved in space.
fn spread<const N: usize>(reference: &[Vector; N], [l1, l2]: [f64; 2], angle: f64) -> [Vector; N] {
    let (sin, cos) = angle.sin_cos();
    reference.map(|[x, y, z]| {
        let (u, v) = (l1 * (cos * x + sin * y), l2 * (cos * y - sin * x));
        add(rotated([cos * u - sin * v, sin * u + cos * v, z], 0.8), [0.6, -0.4, 0.2])
    })
}

const WARP: Vector = [1.0, 0.0, 0.0];

fn triangles_of<const N: usize>(flat: &[Vector; N], curved: Option<&[Vector; N]>) {
    for sheet in sheets() {
        let element = Triangle::<N>::new(flat, WARP, Some(sheet)).unwrap();
        for (stretch, tension) in states(&sheet.cloth) {
            let is_woven = matches!(sheet.cloth, Cloth::Orthotropic(_));
            for angle in [0.0, 0.37, 1.9] {
                let x = spread(flat, stretch, angle);
                let what = format!("{N} {sheet:?} {stretch:?} {angle}");
                check(&element, &x, &what);
                // The border of woven cloth is known along the warp only.
                if sheet.wrinkles && (!is_woven || angle == 0.0) {
                    let found = element.carried(&x).unwrap().tension;
                    assert_eq!(found, tension, "{what}");
                }
                if [1.3, 1.25, 0.9].contains(&stretch[0]) {
                    check(&element, &shaken(&x, 0.01), &format!("shaken {what}"));
                    if let Some(curved) = curved {
                        let element = Triangle::<N>::new(curved, WARP, Some(sheet)).unwrap();
                        check(&element, &spread(curved, stretch, angle), &format!("curved {what}"));
                    }
                }
            }
        }
    }
    // A facet only hands the pressure on.
    let facet = Triangle::<N>::new(flat, WARP, None).unwrap();
    check(&facet, &shaken(&spread(flat, [1.2, 1.1], 0.4), 0.1), "facet");
    assert!(facet.carried(flat).is_none() && facet.energy(flat) == 0.0);
}

#[test]
fn triangles_with_three_nodes_follow_their_energy() {
    triangles_of::<3>(&FLAT, None);
}

#[test]
fn triangles_with_six_nodes_follow_their_energy() {
    triangles_of::<6>(&six(FLAT, 0.0), Some(&six(FLAT, 0.06)));
}

fn objective<const N: usize>(reference: &[Vector; N]) {
    let rule = Triangle::<N>::volume_rule();
    for sheet in sheets() {
        let element = Triangle::<N>::new(reference, WARP, Some(sheet)).unwrap();
        for stretch in [[1.3, 1.15], [1.25, 0.6], [0.9, 0.7]] {
            let x = shaken(&spread(reference, stretch, 0.4), 0.02);
            let moved = x.map(|x| add(rotated(x, 2.1), [3.0, -2.0, 5.0]));
            let (a, b) = (element.local(&x, 0.0, &rule), element.local(&moved, 0.0, &rule));
            assert!((a.energy - b.energy).abs() < 1e-13, "{sheet:?} {stretch:?}");
            let mut sum = [0.0; 3];
            let mut moment = [0.0; 3];
            for i in 0..N {
                assert!(norm(sub(rotated(a.force[i], 2.1), b.force[i])) < 1e-12, "{sheet:?} {stretch:?}");
                sum = add(sum, a.force[i]);
                moment = add(moment, cross(x[i], a.force[i]));
            }
            assert!(norm(sum) < 1e-13 && norm(moment) < 1e-13, "{sheet:?} {stretch:?}");
            let (a, b) = (element.carried(&x).unwrap(), element.carried(&moved).unwrap());
            assert!((a.force[0] - b.force[0]).abs() < 1e-12 && (a.force[1] - b.force[1]).abs() < 1e-12);
        }
    }
}

#[test]
fn triangles_dont_see_rotations() {
    objective(&FLAT);
    objective(&six(FLAT, 0.06));
}

#[test]
fn a_pattern_in_any_plane_is_the_same_pattern() {
    // The reference turned in space with its warp: the same element.
    for sheet in sheets() {
        let x = spread(&FLAT, [1.2, 0.9], 0.7);
        let turned = FLAT.map(|x| add(rotated(x, 1.3), [1.0, 2.0, 3.0]));
        let (a, b) = (
            Triangle::<3>::new(&FLAT, WARP, Some(sheet)).unwrap(),
            Triangle::<3>::new(&turned, rotated(WARP, 1.3), Some(sheet)).unwrap(),
        );
        assert!((a.energy(&x) - b.energy(&x)).abs() < 1e-13, "{sheet:?}");
        assert!(
            (a.area() - 0.5 * (1.2 * 0.9 + 0.1 * 0.3)).abs() < 1e-15 && (a.area() - b.area()).abs() < 1e-15
        );
    }
}

#[test]
fn what_a_triangle_carries() {
    for sheet in sheets().into_iter().filter(|sheet| !sheet.wrinkles) {
        for (flat, is_six) in [(six(FLAT, 0.0), true), (six(FLAT, 0.0), false)] {
            for stretch in [[1.3, 1.15], [1.4, natural(&sheet.cloth, 1.4)], [1.5, 0.7]] {
                // Woven cloth has its axes in the directions of the stretches: warp along the first one.
                for angle in [0.0, 0.37, 0.785, 1.2, 1.9, 2.35, 2.6] {
                    let warp = [f64::cos(angle), f64::sin(angle), 0.0];
                    let x = spread(&flat, stretch, angle);
                    let carried = if is_six {
                        Triangle::<6>::new(&flat, warp, Some(sheet)).unwrap().carried(&x)
                    } else {
                        let x = core::array::from_fn(|i| x[i]);
                        Triangle::<3>::new(&FLAT, warp, Some(sheet)).unwrap().carried(&x)
                    };
                    let carried = carried.unwrap();
                    let [w1, w2] = by_hand(&sheet.cloth, stretch[0], stretch[1]);
                    // Per present length across.
                    let expected = [w1 / stretch[1], w2 / stretch[0]];
                    let what = format!("{is_six} {sheet:?} {stretch:?} {angle}: {carried:?} {expected:?}");
                    for i in 0..2 {
                        assert!((carried.force[i] - expected[i]).abs() < 1e-12, "{what}");
                        assert!((carried.stretch[i] - stretch[i]).abs() < 1e-13, "{what}");
                    }
                    let direction = rotated(warp, 0.8);
                    assert!((dot(direction, carried.direction).abs() - 1.0).abs() < 1e-9, "{what}");
                }
            }
        }
    }
}

#[test]
fn known_forces_of_a_strip_and_of_a_balloon() {
    // Uniaxial neo-Hooke: sigma = mu (l^2 - 1/l) over the present thickness h/sqrt(l); equibiaxial: mu (l^2 - 1/l^4) over h/l^2.
    let sheet = |law| Sheet { cloth: Cloth::Isotropic(law), wrinkles: true, residual: 0.0 };
    let carried = |law, stretch| {
        let element = Triangle::<3>::new(&FLAT, WARP, Some(sheet(law))).unwrap();
        element.carried(&spread(&FLAT, stretch, 0.3)).unwrap()
    };
    let rubber = Law::NeoHooke { shear: 1.3 };
    let l = 1.44;
    let strip = carried(rubber, [l, 0.7]);
    // Wrinkled: the force is spread over the present width of the wrinkled strip, 0.7, of what it was at its natural width 1/sqrt(l).
    let force = 1.3 * (l * l - 1.0 / l) / l.sqrt() / l.sqrt() / 0.7;
    assert!((strip.force[0] - force).abs() < 1e-13 && strip.force[1].abs() < 1e-14, "{strip:?}");
    assert_eq!(strip.tension, Tension::Wrinkled);
    let balloon = carried(rubber, [l, l]);
    let force = 1.3 * (l * l - l.powi(-4)) / (l * l);
    assert!((balloon.force[0] - force).abs() < 1e-13 && (balloon.force[1] - force).abs() < 1e-13);
    // Mooney-Rivlin, equibiaxial: sigma = 2 (c1 + c2 l^2)(l^2 - 1/l^4).
    let balloon = carried(Law::MooneyRivlin { c1: 0.6, c2: 0.2 }, [l, l]);
    let force = 2.0 * (0.6 + 0.2 * l * l) * (1.0 - l.powi(-6));
    assert!((balloon.force[0] - force).abs() < 1e-13);
    // Uniaxial Hencky: sigma = Y ln l of a present section l^(-2 nu): per present width Y ln l/(l l^-nu).
    let strip = carried(Law::Hencky { stiffness: 3.0, poisson: 0.3 }, [l, l.powf(-0.3)]);
    assert!((strip.force[0] - 3.0 * l.ln() / l.powf(0.7)).abs() < 1e-13);
    // Uniaxial St Venant-Kirchhoff: S = Y E, force over reference width l Y E.
    let strip = carried(Law::SaintVenantKirchhoff { stiffness: 3.0, poisson: 0.4 }, [1.2, 0.5]);
    assert!((strip.force[0] - 1.2 * 3.0 * 0.22 / 0.5).abs() < 1e-13);
}

#[test]
fn woven_cloth_pulled_off_its_axes() {
    // Strain e along x only; warp at 0.6 rad: S along x is D rotated, (c^4 D11 + 2 c^2 s^2 D12 + s^4 D22 + 4 c^2 s^2 G) e.
    let sheet = Sheet { cloth: Cloth::Orthotropic(WOVEN), wrinkles: false, residual: 0.0 };
    let (s, c) = 0.6_f64.sin_cos();
    let element = Triangle::<3>::new(&FLAT, [c, s, 0.0], Some(sheet)).unwrap();
    let l = 1.1_f64;
    let e = 0.5 * (l * l - 1.0);
    let below = 1.0 - 0.35 * 0.35 * 2.5 / 4.0;
    let (d11, d12, d22) = (4.0 / below, 0.35 * 2.5 / below, 2.5 / below);
    let along = c.powi(4) * d11 + 2.0 * c * c * s * s * d12 + s.powi(4) * d22 + 4.0 * c * c * s * s * 0.4;
    let x = FLAT.map(|[x, y, z]| [l * x, y, z]);
    assert!((element.energy(&x) - element.area() * 0.5 * along * e * e).abs() < 1e-15);
}

#[test]
fn the_direction_of_six_nodes_is_a_unit_vector() {
    // The principal direction varies a little over the element about any angle.
    let flat = six(FLAT, 0.0);
    let sheet = Sheet { cloth: Cloth::Isotropic(LAWS[2]), wrinkles: true, residual: 0.0 };
    let element = Triangle::<6>::new(&flat, WARP, Some(sheet)).unwrap();
    for i in 0..90 {
        let angle = f64::from(i) * 2.0_f64.to_radians();
        let x = shaken(&spread(&flat, [1.3, 0.8], angle), 0.01);
        let direction = element.carried(&x).unwrap().direction;
        let expected = rotated([angle.cos(), angle.sin(), 0.0], 0.8);
        assert!((norm(direction) - 1.0).abs() < 1e-12, "{i}: {direction:?}");
        assert!(dot(direction, expected).abs() > 0.99, "{i}: {direction:?}");
    }
}

// ---- volumes

/// The corners and faces of an icosahedron of edge 2, outwards.
fn icosahedron() -> (Vec<Vector>, Vec<[usize; 3]>) {
    let g = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for a in [1.0, -1.0] {
        for b in [g, -g] {
            corners.extend([[0.0, a, b], [a, b, 0.0], [b, 0.0, a]]);
        }
    }
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in j + 1..12 {
                let is_edge = |i: usize, j: usize| (norm(sub(corners[i], corners[j])) - 2.0).abs() < 1e-9;
                if is_edge(i, j) && is_edge(j, k) && is_edge(k, i) {
                    let normal = cross(sub(corners[j], corners[i]), sub(corners[k], corners[i]));
                    faces.push(if dot(normal, corners[i]) > 0.0 { [i, j, k] } else { [i, k, j] });
                }
            }
        }
    }
    assert_eq!(faces.len(), 20);
    (corners, faces)
}

/// About z, and along it.
fn turned_about_z(x: Vector) -> Vector {
    let (sin, cos) = 0.7_f64.sin_cos();
    [cos * x[0] - sin * x[1], sin * x[0] + cos * x[1], x[2] + 4.0]
}

#[test]
fn a_closed_surface_of_facets() {
    let (corners, faces) = icosahedron();
    let rule = Triangle::<3>::volume_rule();
    let volume = |places: &[Vector]| -> f64 {
        faces.iter().map(|face| Triangle::<3>::volume(&face.map(|i| places[i]), &rule)).sum()
    };
    // 5 (3 + sqrt 5) a^3/12.
    let exact = 5.0 * (3.0 + 5.0_f64.sqrt()) * 8.0 / 12.0;
    // A closed surface may be turned and moved in any way.
    let anyhow = |x: &Vector| add(rotated(*x, 1.2), [2.0, -3.0, 1.0]);
    let places: Vec<Vector> = corners.iter().map(anyhow).collect();
    assert!((volume(&corners) - exact).abs() < 1e-13 && (volume(&places) - exact).abs() < 1e-12);
    let turned: Vec<Vector> = places.iter().map(|x| turned_about_z(*x)).collect();
    assert!((volume(&turned) - exact).abs() < 1e-12);
    // Each open piece may be turned about z and moved along it.
    for face in &faces {
        let x = face.map(|i| places[i]);
        let difference =
            Triangle::<3>::volume(&x, &rule) - Triangle::<3>::volume(&x.map(turned_about_z), &rule);
        assert!(difference.abs() < 1e-13);
    }
    // The force of the pressure on a corner: a third of each facet that meets there, along its normal.
    let mut swept = vec![[0.0; 3]; 12];
    let mut flux = swept.clone();
    for face in &faces {
        let x = face.map(|i| places[i]);
        let local = Triangle::<3>::new(&x, WARP, None).unwrap().local(&x, PRESSURE, &rule);
        let area = scaled(cross(sub(x[1], x[0]), sub(x[2], x[0])), 0.5);
        for (i, sweep) in face.iter().zip(local.sweep) {
            swept[*i] = add(swept[*i], sweep);
            flux[*i] = add(flux[*i], scaled(area, 1.0 / 3.0));
        }
    }
    for (swept, flux) in swept.iter().zip(&flux) {
        assert!(norm(sub(*swept, *flux)) < 1e-12);
    }
}

/// A quarter of each half of the unit sphere in n x n curved triangles with nodes on it.
fn octants(n: usize) -> Vec<[Vector; 6]> {
    let on = |v: Vector| scaled(v, 1.0 / norm(v));
    let at = |i: usize, j: usize, x: f64, y: f64, z: f64| {
        let (a, b) = (i as f64 / (2 * n) as f64, j as f64 / (2 * n) as f64);
        on([x * (1.0 - a - b), y * a, z * b])
    };
    let mut out = Vec::new();
    for (x, y, z) in [1.0, -1.0]
        .into_iter()
        .flat_map(|x| [1.0, -1.0].map(|y| (x, y)))
        .flat_map(|(x, y)| [1.0, -1.0].map(|z| (x, y, z)))
    {
        let mut push = |corners: [[usize; 2]; 3]| {
            let middle = |a: usize, b: usize| [0, 1].map(|k| usize::midpoint(corners[a][k], corners[b][k]));
            let all = [corners[0], corners[1], corners[2], middle(0, 1), middle(1, 2), middle(2, 0)];
            let mut places = all.map(|[i, j]| at(i, j, x, y, z));
            if x * y * z < 0.0 {
                places.swap(1, 2);
                places.swap(3, 5);
            }
            out.push(places);
        };
        for i in 0..n {
            for j in 0..n - i {
                let (i, j) = (2 * i, 2 * j);
                push([[i, j], [i + 2, j], [i, j + 2]]);
                if i + j + 4 <= 2 * n {
                    push([[i + 2, j], [i + 2, j + 2], [i, j + 2]]);
                }
            }
        }
    }
    out
}

#[test]
fn a_closed_surface_of_curved_triangles() {
    let rule = Triangle::<6>::volume_rule();
    let volume = |all: &[[Vector; 6]]| -> f64 { all.iter().map(|x| Triangle::<6>::volume(x, &rule)).sum() };
    let exact = 4.0 / 3.0 * PI;
    let errors = [4, 8, 16].map(|n| {
        let error = volume(&octants(n)) / exact - 1.0;
        println!("sphere of {n}: {error:e}");
        error
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        println!("order {order}");
        assert!((3.8..4.2).contains(&order), "{order}");
    }
    let all = octants(2);
    let turned: Vec<_> = all.iter().map(|x| x.map(|x| add(rotated(x, 0.9), [3.0, 1.0, -2.0]))).collect();
    assert!((volume(&all) - volume(&turned)).abs() < 1e-12);
    // The volume by another formula, of x.n/3, and the force of the pressure as the integral of N n dA, both at points of
    // their own: a square of Gauss points drawn together into the triangle.
    let gauss = [
        (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
        (0.339_981_043_584_856_3, 0.652_145_154_862_546_1),
    ];
    let gauss: Vec<(f64, f64)> = gauss
        .into_iter()
        .flat_map(|(x, w)| [(0.5 * (1.0 - x), 0.5 * w), (0.5 * (1.0 + x), 0.5 * w)])
        .collect();
    let mut cone = 0.0;
    let mut nodes: Vec<(Vector, Vector, Vector)> = Vec::new();
    for x in &all {
        let local = Triangle::<6>::new(x, WARP, None).unwrap().local(x, PRESSURE, &rule);
        let mut flux = [[0.0; 3]; 6];
        for (u, wu) in &gauss {
            for (v, wv) in &gauss {
                let (n, d) = triangle::<6>(*u, v * (1.0 - u));
                let weight = wu * wv * (1.0 - u);
                let normal = scaled(cross(mixed(x, &d[0]), mixed(x, &d[1])), weight);
                cone += dot(mixed(x, &n), normal) / 3.0;
                for (flux, n) in flux.iter_mut().zip(n) {
                    *flux = add(*flux, scaled(normal, n));
                }
            }
        }
        for i in 0..6 {
            let found = nodes.iter_mut().find(|(place, _, _)| norm(sub(*place, x[i])) < 1e-9);
            if let Some((_, swept, flown)) = found {
                *swept = add(*swept, local.sweep[i]);
                *flown = add(*flown, flux[i]);
            } else {
                nodes.push((x[i], local.sweep[i], flux[i]));
            }
        }
    }
    assert!((cone - volume(&all)).abs() < 1e-13);
    assert_eq!(nodes.len(), 66);
    for (_, swept, flown) in &nodes {
        assert!(norm(sub(*swept, *flown)) < 1e-14, "{swept:?} {flown:?}");
    }
}

#[test]
fn a_sphere_of_revolution_sweeps_its_area() {
    // The force of the pressure on a ring between two open ends: 2 pi r N (dz, -dr) and the discs' share along z.
    let x = MERIDIAN;
    let rule = Ring::<3>::volume_rule();
    let local = Ring::<3>::new(&x, &[]).unwrap().local(&x, PENALTY, PRESSURE, &rule);
    let mut flux = [[0.0; 3]; 3];
    // Gauss points of degree 9.
    for (xi, w) in [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683, 0.478_628_670_499_366_5),
        (-0.538_469_310_105_683, 0.478_628_670_499_366_5),
        (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    ] {
        let (n, d) = super::shape::line::<3>(xi);
        let (r, dr, dz) = (mixed(&x, &n)[0], mixed(&x, &d)[0], mixed(&x, &d)[2]);
        for (flux, n) in flux.iter_mut().zip(n) {
            flux[0] += w * 2.0 * PI * r * dz * n;
            flux[2] -= w * 2.0 * PI * r * dr * n;
        }
    }
    // pi r^2 at the ends: what a disc there would take.
    flux[0][2] -= PI * x[0][0].powi(2);
    flux[1][2] += PI * x[1][0].powi(2);
    for (swept, flux) in local.sweep.iter().zip(&flux) {
        assert!(norm(sub(*swept, *flux)) < 1e-13, "{swept:?} {flux:?}");
    }
}

#[test]
fn elements_without_size_are_refused() {
    let cloth = Sheet { cloth: Cloth::Isotropic(LAWS[0]), wrinkles: true, residual: 0.0 };
    assert!(Triangle::<3>::new(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], WARP, Some(cloth)).is_none());
    let mut folded = six(FLAT, 0.0);
    folded[3] = folded[2];
    assert!(Triangle::<6>::new(&folded, WARP, Some(cloth)).is_none());
    assert!(Cable::<2>::new(&[[1.0; 3]; 2], Thread::Inextensible, 1.0).is_none());
    assert!(Ring::<2>::new(&[[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]], &[]).is_none());
    assert!(Ring::<2>::new(&[[1.0, 0.0, 1.0], [1.0, 0.0, 1.0]], &[]).is_none());
    // A warp that stands upright on the element: some direction in its plane is taken.
    assert!(Triangle::<3>::new(&FLAT, [0.0, 0.0, 1.0], Some(cloth)).is_some());
}
