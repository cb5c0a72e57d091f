//! Membranes of revolution: sheets and threads against hand formulas.

use super::*;

/// A cylinder, a cone, and a bent meridian with an off-centre middle node; each ends at its radius.
const CYLINDER: [Vector; 3] = [[1.4, 0.0, 0.2], [1.4, 0.0, 1.3], [1.4, 0.0, 0.75]];

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
                // Reversed: wrinkles along the meridian.
                let isotropic = matches!(sheet.cloth, Cloth::Isotropic(_));
                let x = revolved_at(&cut::<N>(&CYLINDER), [stretch[1], stretch[0] * fullness], 0.0);
                check(&element, &x, &format!("turned {what}"));
                let CarriedByRing::Sheet { tension: found, .. } = element.carried(&x, PENALTY)[0] else {
                    panic!("{what}")
                };
                assert!(!sheet.wrinkles || !isotropic || found == tension, "{what}: {found:?}");
                // A bent meridian well inside each state.
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
            // Equal stretches in both directions stretch every family equally: taut, and close to the ends of
            // T0 = 0 and T0 = 40 x 0.03.
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
    // n threads at the current angle b on a cylinder of radius r pull with n T cos b along it.
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
    // Hoop direction: the work of dr is n T dl_f L.
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
    // No total force along the axis.
    assert!(a.force.iter().map(|f| f[2]).sum::<f64>().abs() < 1e-13);
}
