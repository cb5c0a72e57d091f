//! The flow of a valve, an orifice or a fitting according to ISO 6358.
//!
//! ```text
//! m' = C P1 rho0 sqrt(T0/T1)                                        P2/P1 <= b    (choked)
//! m' = C P1 rho0 sqrt(T0/T1) sqrt(1 - ((P2/P1 - b)/(1 - b))^2)      P2/P1 >  b    (subsonic)
//! ```
//! P1 and T1 are upstream, P2 downstream; both pressures are absolute. C is the sonic conductance \[m^3/(s
//! Pa)\] (1 l/(s bar) = 1e-8), and b the critical pressure ratio, 0 <= b < 1. The reference atmosphere (ANR,
//! ISO 8778) has rho0 = 1.185 kg/m^3 and T0 = 293.15 K (air of 65 % humidity; dry air at 100 kPa has 1.1884
//! kg/m^3).
//!
//! Source: ISO 6358-1:2013 with a subsonic index of 0.5 (the ellipse of ISO 6358:1989). Neglected: other
//! indices and a cracking pressure.
//!
//! The derivative of m' with respect to P2 is infinite at P2 = P1. Nothing is smoothed here;
//! [`Filling`](super::Filling) integrates in a variable in which the end is regular.

use std::f64::consts::PI;

use serde::Serialize;

use super::{GAMMA, GasError, R_AIR, positive};

/// Density of the reference atmosphere \[kg/m^3\].
pub const REFERENCE_DENSITY: f64 = 1.185;
/// Temperature of the reference atmosphere \[K\].
pub const REFERENCE_TEMPERATURE_K: f64 = 293.15;

/// A flow resistance according to ISO 6358.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Orifice {
    conductance_m3_per_s_pa: f64,
    critical_ratio: f64,
}

impl Orifice {
    /// An orifice with the sonic conductance C \[m^3/(s Pa)\] and the critical pressure ratio b of a data
    /// sheet.
    ///
    /// # Errors
    /// [`GasError::Number`] unless C > 0 and 0 <= b < 1.
    pub fn new(conductance_m3_per_s_pa: f64, critical_ratio: f64) -> Result<Self, GasError> {
        positive("the sonic conductance [m^3/(s Pa)]", conductance_m3_per_s_pa)?;
        if !(0.0..1.0).contains(&critical_ratio) {
            return Err(GasError::number(
                "the critical pressure ratio b",
                critical_ratio,
                "give a number from 0 to below 1 (0.2 to 0.5 for valves)",
            ));
        }
        Ok(Self { conductance_m3_per_s_pa, critical_ratio })
    }

    /// A well-rounded nozzle with the narrowest section `area_m2`. Isentropic flow is multiplied by a
    /// discharge coefficient (1 for an ideal nozzle).
    ///
    /// ```text
    /// b = (2/(gamma + 1))^(gamma/(gamma - 1)) = 0.528
    /// C = cd A sqrt(gamma/(R T0)) (2/(gamma + 1))^((gamma + 1)/(2 (gamma - 1)))/rho0
    /// ```
    ///
    /// # Errors
    /// [`GasError::Number`] unless both numbers are positive and the coefficient is at most 1.
    pub fn nozzle(area_m2: f64, discharge_coefficient: f64) -> Result<Self, GasError> {
        positive("the area of the nozzle [m^2]", area_m2)?;
        if !(discharge_coefficient > 0.0 && discharge_coefficient <= 1.0) {
            return Err(GasError::number(
                "the discharge coefficient",
                discharge_coefficient,
                "give a number above 0 and up to 1 (1 for a nozzle without losses)",
            ));
        }
        let base = 2.0 / (GAMMA + 1.0);
        let choked = (GAMMA / (R_AIR * REFERENCE_TEMPERATURE_K)).sqrt()
            * base.powf(0.5 * (GAMMA + 1.0) / (GAMMA - 1.0));
        Self::new(
            discharge_coefficient * area_m2 * choked / REFERENCE_DENSITY,
            base.powf(GAMMA / (GAMMA - 1.0)),
        )
    }

    /// A sharp-edged hole of this diameter \[m\]: [`Orifice::nozzle`] with a discharge coefficient of 0.8, a
    /// rough guess if there is no data sheet.
    ///
    /// # Errors
    /// [`GasError::Number`] unless the diameter is positive.
    pub fn hole(diameter_m: f64) -> Result<Self, GasError> {
        Self::nozzle(0.25 * PI * positive("the diameter of the hole [m]", diameter_m)?.powi(2), 0.8)
    }

    /// Sonic conductance C \[m^3/(s Pa)\].
    #[must_use]
    pub const fn conductance_m3_per_s_pa(&self) -> f64 {
        self.conductance_m3_per_s_pa
    }

    /// Critical pressure ratio b.
    #[must_use]
    pub const fn critical_ratio(&self) -> f64 {
        self.critical_ratio
    }

    /// Choked mass flow \[kg/s\] at an upstream absolute pressure \[Pa\] and temperature \[K\].
    #[must_use]
    pub fn choked_flow(&self, upstream_pa: f64, upstream_k: f64) -> f64 {
        self.conductance_m3_per_s_pa
            * upstream_pa
            * REFERENCE_DENSITY
            * (REFERENCE_TEMPERATURE_K / upstream_k).sqrt()
    }

    /// x = (P2/P1 - b)/(1 - b) of a pressure ratio. The flow is choked below 0 and ends at 1.
    pub(super) fn opening(&self, ratio: f64) -> f64 {
        (ratio - self.critical_ratio) / (1.0 - self.critical_ratio)
    }

    /// Mass flow from side 1 to side 2 \[kg/s\], negative in the other direction. Pressures are absolute
    /// \[Pa\], >= 0 and not both 0; temperatures \[K\] are > 0.
    ///
    /// # Errors
    /// [`GasError::Number`] outside these ranges.
    pub fn flow(&self, [p1, t1]: [f64; 2], [p2, t2]: [f64; 2]) -> Result<f64, GasError> {
        for pressure in [p1, p2] {
            super::at_least("an absolute pressure [Pa]", pressure, 0.0, "give a finite number from 0 on")?;
        }
        positive("the temperature of side 1 [K]", t1)?;
        positive("the temperature of side 2 [K]", t2)?;
        let (sign, up, temperature, down) = if p1 >= p2 { (1.0, p1, t1, p2) } else { (-1.0, p2, t2, p1) };
        if up == 0.0 {
            return Ok(0.0);
        }
        let x = self.opening(down / up).max(0.0);
        // (1 - x)(1 + x) keeps its digits near x = 1.
        Ok(sign * self.choked_flow(up, temperature) * ((1.0 - x) * (1.0 + x)).max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 l/(s bar), b = 0.3.
    fn valve() -> Orifice {
        Orifice::new(2e-8, 0.3).unwrap()
    }

    #[test]
    fn flow_of_a_data_sheet() {
        // C is the volume at the reference atmosphere per time and upstream pressure: 2 l/(s bar) at 7 bar
        // absolute and 20 C gives 14 l/s ANR.
        let flow = valve().flow([7e5, 293.15], [1e5, 293.15]).unwrap();
        assert!((flow / 1.185 - 14e-3).abs() < 1e-15);
        // Hotter air is less dense: the factor is sqrt(T0/T1).
        let hot = valve().flow([7e5, 4.0 * 293.15], [1e5, 293.15]).unwrap();
        assert!((hot / flow - 0.5).abs() < 1e-15);
        // Half-way between b and 1 the factor is sqrt(1 - 1/4). From 6 to 5 bar gauge at b = 0.3, a nominal
        // flow as stated in data sheets, by hand: x = (6.01325/7.01325 - 0.3)/0.7 = 0.7963..., C P1 sqrt(1 -
        // x^2) = 8.486 l/s.
        let half = valve().flow([7e5, 293.15], [0.65 * 7e5, 293.15]).unwrap();
        assert!((half / flow - 0.75_f64.sqrt()).abs() < 1e-14);
        let nominal = valve().flow([701_325.0, 293.15], [601_325.0, 293.15]).unwrap();
        assert!((nominal / 1.185 - 8.486e-3).abs() < 2e-6, "{}", nominal / 1.185);
    }

    #[test]
    fn both_ways_and_nothing_at_equal_pressures() {
        let (one, two) = ([5e5, 300.0], [3e5, 280.0]);
        let there = valve().flow(one, two).unwrap();
        assert!((valve().flow(two, one).unwrap() + there).abs() < 1e-18 && there > 0.0);
        assert_eq!(valve().flow(one, [5e5, 250.0]).unwrap().to_bits(), 0);
        assert_eq!(valve().flow([0.0, 300.0], [0.0, 300.0]).unwrap().to_bits(), 0);
        // Near equal pressures m' grows like the root of the difference: sqrt(2 (1 - r)/(1 - b)), to order (1
        // - r).
        for gap in [1e-6, 1e-8] {
            let flow = valve().flow([5e5, 293.15], [5e5 * (1.0 - gap), 293.15]).unwrap();
            let root = valve().choked_flow(5e5, 293.15) * (2.0 * gap / 0.7_f64).sqrt();
            assert!((flow / root - 1.0).abs() < 2.0 * gap + 1e-8);
        }
    }

    /// The law of de Saint-Venant and Wantzel for a nozzle, which the ellipse of the standard approximates.
    #[test]
    fn a_nozzle_follows_isentropic_flow() {
        let nozzle = Orifice::nozzle(1e-6, 1.0).unwrap();
        assert!((nozzle.critical_ratio() - 0.528_282).abs() < 1e-6);
        let [p, t] = [6e5, 320.0];
        for ratio in [0.1_f64, 0.5, 0.6, 0.8, 0.9, 0.97] {
            let r = ratio.max(nozzle.critical_ratio());
            let term = r.powf(2.0 / GAMMA) - r.powf((GAMMA + 1.0) / GAMMA);
            let exact = 1e-6 * p * (2.0 * GAMMA / ((GAMMA - 1.0) * R_AIR * t) * term).sqrt();
            let flow = nozzle.flow([p, t], [ratio * p, t]).unwrap();
            let bound = if ratio < 0.528 { 1e-12 } else { 6e-3 };
            assert!((flow / exact - 1.0).abs() < bound, "{ratio}: {}", flow / exact);
        }
        // The usual factor: 0.0404 A P/sqrt(T).
        assert!((nozzle.choked_flow(1e5, 300.0) * 300_f64.sqrt() / 0.1 - 0.0404).abs() < 1e-4);
        let hole = Orifice::hole(2e-3).unwrap();
        let ratio = hole.conductance_m3_per_s_pa() / nozzle.conductance_m3_per_s_pa();
        assert!((ratio - 0.8 * PI).abs() < 1e-12);
    }

    #[test]
    fn wrong_numbers_are_named() {
        for (c, b) in [(0.0, 0.3), (-1e-8, 0.3), (f64::NAN, 0.3), (1e-8, 1.0), (1e-8, -0.1), (1e-8, f64::NAN)]
        {
            assert!(matches!(Orifice::new(c, b), Err(GasError::Number { .. })));
        }
        assert!(Orifice::nozzle(1e-6, 1.1).is_err() && Orifice::nozzle(0.0, 1.0).is_err());
        assert!(Orifice::hole(f64::INFINITY).is_err());
        let good = [1e5, 300.0];
        for bad in [[-1.0, 300.0], [f64::NAN, 300.0], [1e5, 0.0], [1e5, f64::NAN]] {
            assert!(valve().flow(bad, good).is_err() && valve().flow(good, bad).is_err());
        }
    }
}
