//! Triangles: strains, rotations, patterns and known forces.

use super::*;

/// Stretched in its plane, the first stretch at `angle` to x, then rotated and displaced in space.
fn spread<const N: usize>(reference: &[Vector; N], [l1, l2]: [f64; 2], angle: f64) -> [Vector; N] {
    let (sin, cos) = angle.sin_cos();
    reference.map(|[x, y, z]| {
        let (u, v) = (l1 * (cos * x + sin * y), l2 * (cos * y - sin * x));
        add(rotated([cos * u - sin * v, sin * u + cos * v, z], 0.8), [0.6, -0.4, 0.2])
    })
}

fn triangles_of<const N: usize>(flat: &[Vector; N], curved: Option<&[Vector; N]>) {
    for sheet in sheets() {
        let element = Triangle::<N>::new(flat, WARP, Some(sheet)).unwrap();
        for (stretch, tension) in states(&sheet.cloth) {
            let is_woven = matches!(sheet.cloth, Cloth::Orthotropic(_));
            for angle in [0.0, 0.37, 1.9] {
                let x = spread(flat, stretch, angle);
                let what = format!("{N} {sheet:?} {stretch:?} {angle}");
                check(&element, &x, &what);
                // The border of woven cloth is only known along the warp.
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
    // A facet only transmits the pressure.
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
    // Rotating the reference in space together with its warp gives the same element.
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
                // The axes of woven cloth are aligned with the stretches, with the warp along the first one.
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
                    // Per current length across.
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
    // Uniaxial neo-Hooke: sigma = mu (l^2 - 1/l) over the current thickness h/sqrt(l); equibiaxial: mu (l^2 -
    // 1/l^4) over h/l^2.
    let sheet = |law| Sheet { cloth: Cloth::Isotropic(law), wrinkles: true, residual: 0.0 };
    let carried = |law, stretch| {
        let element = Triangle::<3>::new(&FLAT, WARP, Some(sheet(law))).unwrap();
        element.carried(&spread(&FLAT, stretch, 0.3)).unwrap()
    };
    let rubber = Law::NeoHooke { shear: 1.3 };
    let l = 1.44;
    let strip = carried(rubber, [l, 0.7]);
    // Wrinkled: the force acts over the current width 0.7 of the wrinkled strip instead of its natural width
    // 1/sqrt(l).
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
    // Uniaxial Hencky: sigma = Y ln l over a current section l^(-2 nu): per current width Y ln l/(l l^-nu).
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
    // The principal direction varies slightly over the element, around any angle.
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
