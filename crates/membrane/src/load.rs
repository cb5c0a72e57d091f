//! Loads: gas in the membrane, and prescribed motions or forces of the end fittings.

use serde::Serialize;

/// What fills the membrane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub enum Inflation {
    /// A gauge pressure, Pa.
    Pressure(f64),
    /// A volume, m^3; the pressure is a result. Passes limit points, where the pressure falls as the membrane
    /// grows.
    Volume(f64),
    /// A closed amount of gas.
    Gas(Gas),
}

/// A closed amount of gas: (p + ambient) V^gamma = constant.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gas {
    /// (p + ambient) V^gamma, in Pa and m^3.
    pub constant: f64,
    /// 1 at constant temperature; 1.4 for air without heat exchange.
    pub gamma: f64,
    /// Ambient pressure, Pa.
    pub ambient: f64,
}

impl Gas {
    /// The gas that fills `volume`, m^3, at the gauge pressure `pressure`, Pa.
    #[must_use]
    pub fn filling(volume: f64, pressure: f64, ambient: f64, gamma: f64) -> Self {
        Self { constant: (pressure + ambient) * volume.powf(gamma), gamma, ambient }
    }

    /// Gauge pressure in a volume, and its derivative by the volume.
    pub(crate) fn pressure(&self, volume: f64) -> (f64, f64) {
        let absolute = self.constant * volume.powf(-self.gamma);
        (absolute - self.ambient, -self.gamma * absolute / volume)
    }

    /// Work done by the gas in growing to a volume, with a negative sign: minus the integral of its gauge
    /// pressure.
    pub(crate) fn energy(&self, volume: f64) -> f64 {
        let work = if (self.gamma - 1.0).abs() < 1e-12 {
            self.constant * volume.ln()
        } else {
            self.constant * volume.powf(1.0 - self.gamma) / (1.0 - self.gamma)
        };
        self.ambient * volume - work
    }
}

/// All loads on the structure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Load {
    /// What fills it.
    pub inflation: Inflation,
    /// For each fitting its displacement along z from its position in the mesh, m, or the force on it along
    /// z, N.
    pub fittings: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pressure_is_minus_the_slope_of_the_energy() {
        for gamma in [1.0, 1.4] {
            let gas = Gas::filling(2e-3, 3e5, 1e5, gamma);
            assert!((gas.pressure(2e-3).0 / 3e5 - 1.0).abs() < 1e-14);
            for v in [1e-3, 2e-3, 5e-3] {
                let h = 1e-7;
                let slope = (gas.energy(v + h) - gas.energy(v - h)) / (2.0 * h);
                assert!((slope + gas.pressure(v).0).abs() < 1.0, "{gamma} {v}");
                let bend = (gas.pressure(v + h).0 - gas.pressure(v - h).0) / (2.0 * h);
                assert!((bend / gas.pressure(v).1 - 1.0).abs() < 1e-6, "{gamma} {v}");
            }
        }
    }
}
