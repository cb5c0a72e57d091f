//! Limiting cases, and the orders with which they are approached.

use bulge_fibre::{Approach, Problem};
use bulge_muscles::{Length, Parameter, Pressure, Quantity};

use crate::check::{Check, Claim, Trouble};
use crate::difference::order;
use crate::specimen::{at, braid_25, cylinder_25, pleated, ppam, shot};

const PRESSURE: Pressure = Pressure::bar(3.0);

/// As its angle becomes small, a fibre net tends to the pleated muscle with the square of the angle.
pub(crate) fn small_angle() -> Check {
    Claim {
        group: "limits",
        name: "misaligned fibres -> straight fibres, order 2 in the angle",
        source: "theory: sin^2 of the angle is all that enters",
        tolerance: 0.01,
        why: "the next term is of fourth order; at mid-length 2 deg have grown to 6 deg, (0.1 rad)^2 = 0.01",
    }
    .run(|tally| {
        let straight = shot(&ppam()?, PRESSURE, 0.2)?;
        let mut last = None;
        for degrees in [4.0, 2.0, 1.0, 0.5, 0.25_f64] {
            let found = shot(&ppam()?.with(Parameter::Misalignment, degrees.to_radians())?, PRESSURE, 0.2)?;
            let gap = [found.force_n - straight.force_n, found.volume_m3 - straight.volume_m3];
            if let Some([force, volume]) = last.replace(gap).filter(|_| degrees <= 1.0) {
                tally.absolute(order(force, gap[0], 2.0), 2.0, || format!("force, {degrees} deg"));
                tally.absolute(order(volume, gap[1], 2.0), 2.0, || format!("volume, {degrees} deg"));
            }
        }
        Ok(())
    })
}

/// The influence of the clamps on the force decreases with the length.
pub(crate) fn long_braid() -> Check {
    Claim {
        group: "limits",
        name: "clamped braid -> cylinder formula, order 1 in r0/l0 (l0/r0 = 25, 50, 100)",
        source: "cylinder formula (S2 eq. 12, S5 eq. 11)",
        tolerance: 0.02,
        why: "the observed order departs from 1 as r0/l0, which one extrapolation removes; (r0/l0)^2 stays",
    }
    .run(|tally| {
        for contraction in [0.05, 0.15, 0.25] {
            let gap = |ratio: f64| {
                let length = Length::m(0.01 * ratio);
                let clamped = at(&braid_25(length)?, PRESSURE, contraction)?.force_n;
                let cylinder = at(&cylinder_25(length)?, PRESSURE, contraction)?.force_n;
                Ok::<_, Trouble>(clamped / cylinder - 1.0)
            };
            let gaps = [gap(25.0)?, gap(50.0)?, gap(100.0)?];
            let [coarse, fine] = [order(gaps[0], gaps[1], 2.0), order(gaps[1], gaps[2], 2.0)];
            let case =
                || format!("contraction {contraction}: orders {coarse:.4}, {fine:.4}, gap {:.5}", gaps[2]);
            tally.absolute(2.0 * fine - coarse, 1.0, case);
        }
        Ok(())
    })
}

/// Elastic fibres tend to inextensible ones.
pub(crate) fn stiff_fibres() -> Check {
    Claim {
        group: "limits",
        name: "stiff fibres -> inextensible fibres, order 1 in 1/EA",
        source: "theory: strain T/EA",
        tolerance: 0.01,
        why: "the next term is of second order: the strain itself, 1e-3",
    }
    .run(|tally| {
        for (name, muscle, approach) in [
            ("pleated, closed form", ppam()?, Approach::ClosedForm),
            ("pleated, shooting", ppam()?, Approach::Shooting),
            ("braid", braid_25(Length::mm(120.0))?.with(Parameter::Fibres, 40.0)?, Approach::Shooting),
        ] {
            let rigid = Problem::new(&muscle, PRESSURE)?.follow(0.2, approach)?;
            let mut last = None;
            for stiffness in [1e5, 1e6, 1e7] {
                let elastic = muscle.with(Parameter::FibreStiffness, stiffness)?;
                let found = Problem::new(&elastic, PRESSURE)?.follow(0.2, approach)?;
                let gap = [found.force_n - rigid.force_n, found.volume_m3 - rigid.volume_m3];
                if let Some([force, volume]) = last.replace(gap) {
                    tally.absolute(order(force, gap[0], 10.0), 1.0, || {
                        format!("force, {name}, EA = {stiffness} N")
                    });
                    tally.absolute(order(volume, gap[1], 10.0), 1.0, || {
                        format!("volume, {name}, EA = {stiffness} N")
                    });
                }
            }
        }
        Ok(())
    })
}

/// Many fibres tend to a continuous membrane.
pub(crate) fn many_fibres() -> Check {
    Claim {
        group: "limits",
        name: "n fibres -> continuous membrane, order 2 in 1/n, and the polygon's area at n = 3, 4, 6",
        source: "(n/2 pi) sin(2 pi/n) of the circle's area",
        tolerance: 1e-3,
        why: "the next term is (2 pi/n)^2/20 = 3e-4 at n = 80, divided by ln 2; areas are exact",
    }
    .run(|tally| {
        let (length, radius) = (Length::mm(110.0), Length::mm(16.0));
        let round = at(&pleated(length, radius, None)?, PRESSURE, 0.2)?;
        let mut last = None;
        for n in [80, 160, 320, 640] {
            let found = at(&pleated(length, radius, Some(n))?, PRESSURE, 0.2)?;
            let gap = [found.force_n - round.force_n, found.volume_polygon_m3 - round.volume_polygon_m3];
            if let Some([force, volume]) = last.replace(gap) {
                tally.absolute(order(force, gap[0], 2.0), 2.0, || format!("force, n = {n}"));
                tally.absolute(order(volume, gap[1], 2.0), 2.0, || format!("polygon volume, n = {n}"));
            }
            tally.relative(found.volume_m3, round.volume_m3, || format!("volume of the circle, n = {n}"));
        }
        // Areas of a triangle, a square and a hexagon in a unit circle: 3 sqrt(3)/4, 2, 3 sqrt(3)/2. Errors
        // are multiplied by a million.
        for (n, area) in [(3, 0.75 * 3.0_f64.sqrt()), (4, 2.0), (6, 1.5 * 3.0_f64.sqrt())] {
            for approach in [Approach::ClosedForm, Approach::Shooting] {
                let found =
                    Problem::new(&pleated(length, radius, Some(n))?, PRESSURE)?.follow(0.2, approach)?;
                let share = area / std::f64::consts::PI;
                tally.add(1e6 * (found.force_n / round.force_n / share - 1.0), || {
                    format!("force x 1e6, n = {n}")
                });
                tally.add(1e6 * (found.volume_polygon_m3 / round.volume_polygon_m3 / share - 1.0), || {
                    format!("polygon volume x 1e6, n = {n}")
                });
            }
        }
        Ok(())
    })
}

/// A slender pleated muscle without force is the Mylar balloon (Taylor's parachute).
pub(crate) fn mylar_balloon() -> Check {
    Claim {
        group: "limits",
        name: "slender pleated muscle -> Mylar balloon: limit, radius, volume",
        source: "exact: a/r = Gamma(1/4)^2/(4 sqrt(2 pi)), thickness and volume from it",
        tolerance: 1e-8,
        why: "Richardson extrapolation in R/l0 from 1/62.5 to 1/1000, four powers removed",
    }
    .run(|tally| {
        // Half the fibre length divided by the radius of the equator, and the volume divided by the cube of
        // half the fibre length.
        let (a_over_r, volume) = (1.311_028_777_146_059_9, 1.218_524_216_118_569_7);
        for approach in [Approach::ClosedForm, Approach::Shooting] {
            let mut levels = Vec::new();
            for ratio in [62.5, 125.0, 250.0, 500.0, 1000.0] {
                let muscle = pleated(Length::m(0.01 * ratio), Length::mm(10.0), None)?;
                let problem = Problem::new(&muscle, PRESSURE)?;
                let limit = problem.contraction_limit(approach)?;
                let found = problem.follow(limit, approach)?;
                let a = 0.5 * muscle.length().si();
                levels.push([limit, a / found.max_radius_m, found.volume_m3 / a.powi(3)]);
            }
            for (i, what, expected) in [
                (0, "contraction limit", 0.543_053_418_955_536_4),
                (1, "half fibre length over largest radius", a_over_r),
                (2, "volume", volume),
            ] {
                let column: Vec<f64> = levels.iter().map(|level| level[i]).collect();
                tally.relative(richardson(&column), expected, || format!("{what}, {approach:?}"));
            }
        }
        Ok(())
    })
}

/// Limit of values at R/l0 = ..., 4h, 2h, h, in which the terms h, h^2, ... are eliminated.
fn richardson(values: &[f64]) -> f64 {
    let mut row = values.to_vec();
    for power in 1..values.len() {
        let factor = 2.0_f64.powi(i32::try_from(power).unwrap_or(i32::MAX));
        row = row.windows(2).map(|w| (factor * w[1] - w[0]) / (factor - 1.0)).collect();
    }
    row.first().copied().unwrap_or(f64::NAN)
}

/// Elastic fibres make the force at zero contraction finite: `F(0) ~ p^(2/3) EA^(1/3)`.
pub(crate) fn force_at_rest() -> Check {
    Claim {
        group: "limits",
        name: "elastic fibres at zero contraction: F ~ p^(2/3) EA^(1/3)",
        source: "shallow arc: T^3 = EA (A' p)^2 l0^2/24 of one fibre",
        tolerance: 2e-3,
        why: "the next term is p R^2/T, 6e-4 at the smallest pressure",
    }
    .run(|tally| {
        for approach in [Approach::ClosedForm, Approach::Shooting] {
            let force = |pressure: f64, stiffness: f64| {
                let muscle = ppam()?.with(Parameter::FibreStiffness, stiffness)?;
                Ok::<_, Trouble>(
                    Problem::new(&muscle, Pressure::pa(pressure))?.follow(0.0, approach)?.force_n,
                )
            };
            let (p, stiffness) = (1.0, 1e6);
            let here = force(p, stiffness)?;
            tally.absolute(order(force(2.0 * p, stiffness)?, here, 2.0), 2.0 / 3.0, || {
                format!("p, {approach:?}")
            });
            tally.absolute(order(force(p, 2.0 * stiffness)?, here, 2.0), 1.0 / 3.0, || {
                format!("EA, {approach:?}")
            });
            // The prefactor: n T with the polygon's width per fibre, sin(2 pi/n) R.
            let (n, width) = (40.0, (std::f64::consts::TAU / 40.0).sin() * 0.016);
            let arc = n * (stiffness * (p * width * 0.11).powi(2) / 24.0).cbrt();
            tally.relative(here, arc, || format!("size, {approach:?}"));
        }
        Ok(())
    })
}
