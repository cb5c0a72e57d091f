//! Elements against finite differences of their energies, rotations, and closed forms.

mod cables;
mod rings;
mod triangles;
mod volumes;

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

/// Every cloth, with and without wrinkling; the residual is large enough to show.
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

/// dW/dl1 and dW/dl2 with respect to the stretches themselves, by hand.
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

/// Transverse stretch of a strip pulled along the first axis, by hand.
fn natural(cloth: &Cloth, l: f64) -> f64 {
    match *cloth {
        Cloth::Isotropic(Law::Hencky { poisson, .. }) => l.powf(-poisson),
        Cloth::Isotropic(Law::SaintVenantKirchhoff { poisson, .. })
        | Cloth::Orthotropic(Orthotropic { poisson, .. }) => (1.0 - poisson * (l * l - 1.0)).sqrt(),
        Cloth::Isotropic(_) => 1.0 / l.sqrt(),
    }
}

/// Pairs of stretches with the state of a wrinkling sheet: inside each state, and 1e-3 to either side of each
/// border.
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

/// Step of the differences; two steps stay on one side of a border 1e-3 away.
const STEP: f64 = 1e-4;

/// Pseudo-random numbers between -1 and 1.
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

/// A rotation about an axis that isn't a coordinate axis.
fn rotated(v: Vector, angle: f64) -> Vector {
    let axis = scaled([2.0, -1.0, 1.5], 1.0 / norm([2.0, -1.0, 1.5]));
    let (sin, cos) = angle.sin_cos();
    add(add(scaled(v, cos), scaled(cross(axis, v), sin)), scaled(axis, dot(axis, v) * (1.0 - cos)))
}

/// Force, sweep and stiffness against fourth-order differences, and the symmetry of the stored entries.
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

const FLAT: [Vector; 3] = [[0.1, 0.2, 0.0], [1.3, 0.1, 0.0], [0.4, 1.1, 0.0]];

const WARP: Vector = [1.0, 0.0, 0.0];

const MERIDIAN: [Vector; 3] = [[0.9, 0.0, 0.1], [1.5, 0.0, 1.1], [1.3, 0.0, 0.5]];

/// Six nodes from three corners, with the midpoints displaced by `bulge`.
fn six(corners: [Vector; 3], bulge: f64) -> [Vector; 6] {
    let middle = |i: usize, j: usize| {
        let at = scaled(add(corners[i], corners[j]), 0.5);
        add(at, scaled([noise(i + 50), noise(i + 60), noise(i + 70)], bulge))
    };
    [corners[0], corners[1], corners[2], middle(0, 1), middle(1, 2), middle(2, 0)]
}
