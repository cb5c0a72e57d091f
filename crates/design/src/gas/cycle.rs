//! Air consumption and efficiency of a cycle: filling on the support, lifting a constant load, venting.
//!
//! ```text
//! air        m = P2 (V2 + Vd)/(R T0) - p0 (V1' + Vd)/(R T0)        from the supply per cycle; V1' at e1 without pressure
//! in         E = m R T0 ln(Ps/p0)                                  exergy of that air: the work of an isothermal compressor
//! out        W = load (l1 - l2)
//! efficiency = W/E
//! E = W + not passed on + throttled + vented
//!     gas work    W_g = integral of p dV (gauge)                   not passed on = W_g - W
//!     vented      B2 = P2 (V2 + Vd)(ln(P2/p0) - 1 + p0/P2)         exergy of the charge at the end of the lift
//!     throttled   E - B2 - W_g = R T0 integral of ln(Ps/P) dm      between the supply and the muscle
//! ```
//! All changes are slow, at the ambient temperature T0. The pull F is that of the gauge pressure. The work p0
//! dV with which the muscle displaces the atmosphere is returned on venting. It is neither in W nor in W_g,
//! and E counts only the work that air can do above the ambient. The part *not passed on* consists of pull
//! beyond the load (`Lift::Isobaric`), of energy in stretched parts, of friction, and, between n fibres, of
//! the fraction 1 - a of the gas work (see [the module](super)). The losses of a real compressor are not
//! counted.

use bulge_fibre::{Approach, Response};
use bulge_model::MuscleWithEffects;
use bulge_numerics::gauss::SIX;
use serde::Serialize;

use super::chamber::{Chamber, LEAST_PRESSURE_PA, Load};
use super::muscle::{failed, follow, pulling};
use super::orifice::REFERENCE_DENSITY;
use super::surroundings::Surroundings;
use super::{AMBIENT_TEMPERATURE_K, GasError, R_AIR, finite, positive};

/// Panels for the gas work, each with six Gauss points.
const PANELS: u32 = 6;

/// Mode of lifting the load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Lift {
    /// The pressure rises until the muscle carries the load, and further until the load is up: F(p, e) = load
    /// throughout.
    PressureRise,
    /// The muscle is held while it is filled to this gauge pressure \[Pa\], and then moves at that pressure.
    /// Its pull beyond the load is lost.
    Isobaric {
        /// Gauge pressure \[Pa\].
        pressure_pa: f64,
    },
}

/// A cycle: the muscle is filled at the contraction `from`, lifts the load to `to`, is vented, and returns
/// without the load.
#[derive(Debug, Clone, Copy)]
pub struct Stroke<'a> {
    /// The muscle.
    pub muscle: &'a MuscleWithEffects,
    /// Load \[N\] > 0.
    pub load_n: f64,
    /// Contraction at which the load stands on its support.
    pub from: f64,
    /// Contraction at which the load is up.
    pub to: f64,
    /// Mode of lifting.
    pub lift: Lift,
    /// Gauge pressure of the supply \[Pa\].
    pub supply_pressure_pa: f64,
    /// Dead volume of tubes and fittings \[m^3\].
    pub dead_volume_m3: f64,
    /// Ambient pressure \[Pa\].
    pub ambient_pa: f64,
    /// Temperature T0 of air, supply and ambient \[K\].
    pub temperature_k: f64,
}

/// Consumption and work of a cycle.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct CycleResult {
    /// Gauge pressure at which the load leaves its support \[Pa\].
    pub start_pressure_pa: f64,
    /// Gauge pressure when the load is up \[Pa\].
    pub end_pressure_pa: f64,
    /// Travel of the load \[m\].
    pub stroke_m: f64,
    /// Air from the supply \[kg\].
    pub air_kg: f64,
    /// The same air in normal litres (ANR, 1.185 kg/m^3) \[l\].
    pub air_litres_anr: f64,
    /// Exergy of that air, E \[J\].
    pub exergy_j: f64,
    /// Work on the load, W \[J\].
    pub work_j: f64,
    /// W/E.
    pub efficiency: f64,
    /// Work of the gas that doesn't reach the load \[J\].
    pub not_passed_on_j: f64,
    /// Exergy lost between supply and muscle \[J\].
    pub throttled_j: f64,
    /// Exergy of the vented air \[J\].
    pub vented_j: f64,
}

impl<'a> Stroke<'a> {
    /// A stroke without dead volume, in the standard atmosphere at 293.15 K.
    #[must_use]
    pub const fn new(
        muscle: &'a MuscleWithEffects,
        load_n: f64,
        [from, to]: [f64; 2],
        lift: Lift,
        supply_pressure_pa: f64,
    ) -> Self {
        Self {
            muscle,
            load_n,
            from,
            to,
            lift,
            supply_pressure_pa,
            dead_volume_m3: 0.0,
            ambient_pa: bulge_fibre::AMBIENT_PRESSURE,
            temperature_k: AMBIENT_TEMPERATURE_K,
        }
    }

    /// Air, energies and efficiency of the cycle.
    ///
    /// # Errors
    /// [`GasError::Number`] for impossible numbers (including a pressure above that of the supply),
    /// [`GasError::Muscle`] if the muscle can't lift the load.
    pub fn cycle(&self) -> Result<CycleResult, GasError> {
        self.check()?;
        let [start, end] = match self.lift {
            Lift::PressureRise => [self.pressure_for(self.from)?, self.pressure_for(self.to)?],
            Lift::Isobaric { pressure_pa } => [pressure_pa; 2],
        };
        if end > self.supply_pressure_pa || start > self.supply_pressure_pa {
            return Err(GasError::number(
                "the gauge pressure that the lift needs [Pa]",
                end.max(start),
                "it is above that of the supply: take a higher supply pressure, a smaller load or a shorter way",
            ));
        }
        let [below, above] = [self.pulling(start, self.from)?, self.pulling(end, self.to)?];
        if above.force_n < self.load_n * (1.0 - 1e-9) {
            return Err(GasError::number(
                "the pull at the end of the way [N]",
                above.force_n,
                "it is less than the load: take a higher pressure, a smaller load or a shorter way",
            ));
        }
        // The ambient air that the muscle holds without pressure is not taken from the supply.
        let slack = follow(self.muscle, LEAST_PRESSURE_PA, self.from, Approach::Auto)?;
        let heat = R_AIR * self.temperature_k;
        let gas =
            |pressure: f64, volume: f64| (pressure + self.ambient_pa) * (volume + self.dead_volume_m3) / heat;
        let charge = gas(end, above.volume_m3);
        let air_kg = charge - gas(0.0, slack.volume_m3);
        let exergy_j = air_kg * heat * (self.supply_pressure_pa / self.ambient_pa).ln_1p();
        let stroke_m = below.length_m - above.length_m;
        let work_j = self.load_n * stroke_m;
        let gas_work_j = self.gas_work([start, end], &slack, [&below, &above])?;
        let vented_j =
            charge * heat * (end / self.ambient_pa).ln_1p() - end * (above.volume_m3 + self.dead_volume_m3);
        Ok(CycleResult {
            start_pressure_pa: start,
            end_pressure_pa: end,
            stroke_m,
            air_kg,
            air_litres_anr: 1e3 * air_kg / REFERENCE_DENSITY,
            exergy_j,
            work_j,
            efficiency: work_j / exergy_j,
            not_passed_on_j: gas_work_j - work_j,
            throttled_j: exergy_j - vented_j - gas_work_j,
            vented_j,
        })
    }

    fn check(&self) -> Result<(), GasError> {
        positive("the load [N]", self.load_n)?;
        positive("the gauge pressure of the supply [Pa]", self.supply_pressure_pa)?;
        Surroundings::STANDARD.with_ambient(self.ambient_pa)?.with_dead_volume(self.dead_volume_m3)?;
        positive("the temperature [K]", self.temperature_k)?;
        if let Lift::Isobaric { pressure_pa } = self.lift {
            positive("the gauge pressure of the lift [Pa]", pressure_pa)?;
        }
        for value in [self.from, self.to] {
            finite("a contraction [%]", value)?;
        }
        if self.to <= self.from {
            return Err(GasError::number(
                "the contraction at the end of the way [%]",
                self.to,
                "give a larger one than at its start: a muscle lifts by contracting",
            ));
        }
        Ok(())
    }

    fn pulling(&self, pressure_pa: f64, contraction: f64) -> Result<Response, GasError> {
        pulling(self.muscle, pressure_pa, contraction, Approach::Auto)
            .map_err(|error| failed(pressure_pa, error))
    }

    /// The pressure at which the muscle carries the load at a contraction. Secants start from the supply
    /// pressure and stay inside the bracket.
    fn pressure_for(&self, contraction: f64) -> Result<f64, GasError> {
        let excess = |p: f64| {
            Ok::<_, GasError>(
                follow(self.muscle, p, contraction, Approach::Auto)?.force_n / self.load_n - 1.0,
            )
        };
        let most = self.supply_pressure_pa;
        let at_most = excess(most)?;
        if at_most < 0.0 {
            let pull = (1.0 + at_most) * self.load_n;
            return Err(GasError::number(
                "the pull at the pressure of the supply [N]",
                pull,
                "it is less than the load: take a higher supply pressure, a smaller load or a shorter way",
            ));
        }
        // The excess is proportional to the pressure if nothing but the pressure shapes the muscle. The first
        // secant then gives the root.
        let (mut low, mut high, mut at_low, mut at_high) = (0.0, most, -1.0, at_most);
        let mut p = most;
        for _ in 0..100 {
            let next = (low * at_high - high * at_low) / (at_high - at_low);
            if (next - p).abs() <= 1e-13 * p {
                return Ok(next);
            }
            p = next;
            let here = excess(p)?;
            if here == 0.0 {
                return Ok(p);
            }
            if here > 0.0 {
                (high, at_high, at_low) = (p, here, 0.5 * at_low);
            } else {
                (low, at_low, at_high) = (p, here, 0.5 * at_high);
            }
        }
        Ok(p)
    }

    /// Integral of p dV from zero pressure at the start to the end of the lift \[J\], computed as p2 V2 minus
    /// the integral of V dp.
    fn gas_work(
        &self,
        [start, end]: [f64; 2],
        slack: &Response,
        [below, above]: [&Response; 2],
    ) -> Result<f64, GasError> {
        let mut work = end * above.volume_m3;
        // While the muscle is held, its volume grows only if something stretches.
        let held =
            |p: f64| Ok(follow(self.muscle, p.max(LEAST_PRESSURE_PA), self.from, Approach::Auto)?.volume_m3);
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-13 * b;
        work -= if same(slack.volume_m3, below.volume_m3) {
            start * below.volume_m3
        } else {
            integral([0.0, start], held)?
        };
        if self.lift == Lift::PressureRise {
            let chamber = Chamber::muscle(self.muscle, Load::Force(self.load_n))?;
            work -= integral([start, end], |p| Ok(chamber.at(p)?.volume_m3))?;
        }
        Ok(work)
    }
}

fn integral([from, to]: [f64; 2], f: impl Fn(f64) -> Result<f64, GasError>) -> Result<f64, GasError> {
    let width = (to - from) / f64::from(PANELS);
    let mut sum = 0.0;
    for panel in 0..PANELS {
        for (at, weight) in SIX {
            sum += weight * width * f(from + width * (f64::from(panel) + at))?;
        }
    }
    Ok(sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gas::examples::{braid, forty, learnt, pleated, soft};
    use bulge_fibre::Given;
    use bulge_muscles::Pressure;

    fn stroke(muscle: &MuscleWithEffects, load_n: f64) -> Stroke<'_> {
        Stroke::new(muscle, load_n, [0.05, 0.2], Lift::PressureRise, 6e5)
    }

    #[test]
    fn the_parts_add_up_and_the_gas_gives_what_the_load_takes() {
        // Inextensible, continuous fibres: all gas work reaches the load.
        for muscle in [pleated(), braid()] {
            let found = stroke(&muscle, 200.0).cycle().unwrap();
            assert!(found.not_passed_on_j.abs() < 1e-8 * found.work_j, "{found:?}");
            let sum = found.work_j + found.not_passed_on_j + found.throttled_j + found.vented_j;
            assert!((sum / found.exergy_j - 1.0).abs() < 1e-12);
            assert!(found.efficiency > 0.0 && found.efficiency < 1.0);
            assert!(found.throttled_j > 0.0 && found.vented_j > 0.0);
        }
        // Between 40 fibres the fraction 1 - a doesn't reach the load.
        let found = stroke(&forty(), 200.0).cycle().unwrap();
        let a = 40.0 / (2.0 * std::f64::consts::PI) * (2.0 * std::f64::consts::PI / 40.0).sin();
        let lost = found.not_passed_on_j / (found.work_j + found.not_passed_on_j);
        assert!((lost - (1.0 - a)).abs() < 1e-8, "{lost}");
    }

    /// The throttling loss, computed as a remainder, against its own integral R T0 ln(Ps/P) dm.
    #[test]
    fn throttling_is_its_integral() {
        for muscle in [pleated(), soft()] {
            let mut stroke = stroke(&muscle, 250.0);
            stroke.dead_volume_m3 = 2e-5;
            let found = stroke.cycle().unwrap();
            let [p0, ps] = [stroke.ambient_pa, 6e5 + stroke.ambient_pa];
            let chamber = Chamber::muscle(&muscle, Load::Force(250.0)).unwrap();
            let chamber = chamber.on_support(0.05).unwrap().with_dead_volume(2e-5).unwrap();
            let gas = |p: f64| (p + p0) * chamber.at(p).unwrap().gas_volume_m3;
            let mut sum = 0.0;
            let ends = [0.0, found.start_pressure_pa, found.end_pressure_pa];
            for part in ends.windows(2) {
                let n = 600;
                let at = |i: f64| part[0] + (part[1] - part[0]) * i / f64::from(n);
                sum += (0..n)
                    .map(|i| {
                        let i = f64::from(i);
                        (ps / (at(i + 0.5) + p0)).ln() * (gas(at(i + 1.0)) - gas(at(i)))
                    })
                    .sum::<f64>();
            }
            assert!((found.throttled_j / sum - 1.0).abs() < 2e-5, "{} {sum}", found.throttled_j);
        }
    }

    #[test]
    fn air_by_hand() {
        // At constant pressure: gas work p dV, mass from the volumes, normal litres at 1.185 kg/m^3.
        let muscle = braid();
        let lift = Lift::Isobaric { pressure_pa: 3e5 };
        let mut stroke = Stroke::new(&muscle, 250.0, [0.05, 0.2], lift, 6e5);
        stroke.dead_volume_m3 = 1e-5;
        let found = stroke.cycle().unwrap();
        let (sin, cos) = 25_f64.to_radians().sin_cos();
        let volume = |e: f64| {
            let l = 0.25 * (1.0 - e);
            std::f64::consts::PI * 1e-4 * l * (1.0 - (cos * (1.0 - e)).powi(2)) / (sin * sin)
        };
        let [v1, v2] = [volume(0.05), volume(0.2)];
        let mass = (401_325.0 * (v2 + 1e-5) - 101_325.0 * (v1 + 1e-5)) / (287.05 * 293.15);
        assert!((found.air_kg / mass - 1.0).abs() < 1e-10);
        assert!((found.air_litres_anr / (mass / 1.185e-3) - 1.0).abs() < 1e-10);
        let exergy = mass * 287.05 * 293.15 * (701_325.0_f64 / 101_325.0).ln();
        assert!((found.exergy_j / exergy - 1.0).abs() < 1e-10);
        assert!((found.work_j - 250.0 * 0.15 * 0.25).abs() < 1e-10);
        assert!((found.efficiency - found.work_j / exergy).abs() < 1e-12);
        assert!((found.work_j + found.not_passed_on_j - 3e5 * (v2 - v1)).abs() < 1e-9);
        assert_eq!(found.start_pressure_pa.to_bits(), found.end_pressure_pa.to_bits());
        let b2 = 401_325.0 * (v2 + 1e-5) * ((401_325.0_f64 / 101_325.0).ln() - 1.0 + 101_325.0 / 401_325.0);
        assert!((found.vented_j / b2 - 1.0).abs() < 1e-10);
    }

    #[test]
    fn dead_volume_and_needless_pressure_cost() {
        for muscle in [pleated(), soft(), learnt()] {
            let efficiency = |dead: f64, supply: f64| {
                let mut stroke = stroke(&muscle, 150.0);
                (stroke.dead_volume_m3, stroke.supply_pressure_pa) = (dead, supply);
                let found = stroke.cycle().unwrap();
                assert!(found.efficiency > 0.0 && found.efficiency < 1.0);
                found.efficiency
            };
            let falling = [0.0, 1e-5, 1e-4, 1e-3].map(|dead| efficiency(dead, 6e5));
            assert!(falling.windows(2).all(|pair| pair[1] < pair[0]), "{falling:?}");
            assert!(efficiency(0.0, 8e5) < efficiency(0.0, 6e5));
            // A rising pressure consumes what the load needs. A higher constant pressure consumes more air
            // for the same work.
            let rise = stroke(&muscle, 150.0).cycle().unwrap();
            let lift = Lift::Isobaric { pressure_pa: 1.3 * rise.end_pressure_pa };
            let constant = Stroke { lift, ..stroke(&muscle, 150.0) }.cycle().unwrap();
            assert!(constant.air_kg > rise.air_kg && constant.efficiency < rise.efficiency);
            assert!(constant.not_passed_on_j > rise.not_passed_on_j);
            assert!((constant.work_j - rise.work_j).abs() < 1e-9);
        }
    }

    #[test]
    fn the_pressures_carry_the_load() {
        for muscle in [pleated(), soft(), learnt()] {
            let found = stroke(&muscle, 150.0).cycle().unwrap();
            for (p, e) in [(found.start_pressure_pa, 0.05), (found.end_pressure_pa, 0.2)] {
                let pull = muscle.solve(Pressure::pa(p), Given::Contraction(e), Approach::Auto).unwrap();
                assert!((pull.force_n / 150.0 - 1.0).abs() < 1e-9, "{}", pull.force_n);
            }
        }
    }

    #[test]
    fn what_cannot_be_lifted_is_said() {
        let muscle = pleated();
        let good = stroke(&muscle, 200.0);
        for bad in [
            Stroke { load_n: 0.0, ..good },
            Stroke { load_n: f64::NAN, ..good },
            Stroke { load_n: 1e5, ..good },
            Stroke { to: 0.04, ..good },
            Stroke { from: f64::NAN, ..good },
            Stroke { supply_pressure_pa: -1.0, ..good },
            Stroke { dead_volume_m3: -1.0, ..good },
            Stroke { temperature_k: 0.0, ..good },
            Stroke { lift: Lift::Isobaric { pressure_pa: 7e5 }, ..good },
            Stroke { lift: Lift::Isobaric { pressure_pa: 1e3 }, ..good },
            Stroke { lift: Lift::Isobaric { pressure_pa: f64::NAN }, ..good },
        ] {
            assert!(matches!(bad.cycle(), Err(GasError::Number { .. })), "{bad:?}");
        }
        assert!(matches!(
            Stroke { to: 0.7, ..good }.cycle(),
            Err(GasError::Muscle { .. } | GasError::Number { .. })
        ));
        assert!(matches!(Stroke { from: -0.1, ..good }.cycle(), Err(GasError::Muscle { .. })));
    }
}
