//! Properties of air, and the closures of the heat model: Nusselt numbers, stirring by the jet, axial mixing.

pub(super) use crate::gas::{CP_AIR as CP, CV_AIR as CV, GAMMA, R_AIR as R};

use super::Closures;

/// Prandtl number of air.
pub(super) const PRANDTL: f64 = 0.71;

/// Standard gravity \[m/s2\].
const GRAVITY: f64 = 9.806_65;
/// End of laminar flow, and start of turbulent flow, after Gnielinski 2013.
const TRANSITION: [f64; 2] = [2300.0, 4000.0];
/// Nusselt number of developed laminar flow at a constant wall temperature.
const LAMINAR: f64 = 3.66;

/// Dynamic viscosity of air \[Pa s\] at a temperature \[K\]: Sutherland's law.
pub(super) fn viscosity(temperature: f64) -> f64 {
    let ratio = temperature / 273.15;
    1.716e-5 * ratio * ratio.sqrt() * (273.15 + 110.4) / (temperature + 110.4)
}

/// Conductivity of air \[W/(m K)\]: mu cp/Pr.
pub(super) fn conductivity(temperature: f64) -> f64 {
    viscosity(temperature) * CP / PRANDTL
}

/// Correlation of Gnielinski 1976 with the friction factor of a smooth tube after Konakov.
fn gnielinski(reynolds: f64) -> f64 {
    let friction = (1.8 * reynolds.log10() - 1.5).powi(-2);
    let root = (friction / 8.0).sqrt();
    friction / 8.0 * (reynolds - 1000.0) * PRANDTL / (1.0 + 12.7 * root * (PRANDTL.powf(2.0 / 3.0) - 1.0))
}

/// Degree of turbulence: 0 below the transition, 1 above, linear between.
pub(super) fn turbulence(reynolds: f64) -> f64 {
    ((reynolds - TRANSITION[0]) / (TRANSITION[1] - TRANSITION[0])).clamp(0.0, 1.0)
}

/// Nusselt number at a Reynolds and a Rayleigh number: 3.66 up to 2300, then linear to Gnielinski's value at
/// 4000, then Gnielinski. It is never below the value of gas at rest, which is the floor or `c_n Ra^(1/4)`.
pub(super) fn nusselt(reynolds: f64, rayleigh: f64, closures: &Closures) -> f64 {
    let part = turbulence(reynolds);
    let flow = if part == 0.0 {
        LAMINAR
    } else {
        (1.0 - part) * LAMINAR + part * gnielinski(reynolds.max(TRANSITION[1]))
    };
    let rest = closures.natural_convection * rayleigh.sqrt().sqrt();
    closures.nusselt_factor * flow.max(rest).max(closures.nusselt_floor)
}

/// A jet into the muscle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Jet {
    /// Position of its nozzle \[m\].
    pub position: f64,
    /// Its speed u0 \[m/s\]; 0 when air flows out.
    pub speed: f64,
    /// Diameter of the nozzle over that of the muscle.
    pub contraction: f64,
}

impl Jet {
    /// Stirring velocity w \[m/s\] at x \[m\] in a muscle of diameter `diameter` \[m\].
    pub(super) fn stirring(&self, x: f64, diameter: f64, closures: &Closures) -> f64 {
        let ahead = x - self.position;
        let reach = if ahead >= 0.0 { closures.jet_reach } else { closures.jet_back };
        closures.jet_strength * self.speed * self.contraction * (-ahead.abs() / (reach * diameter)).exp()
    }
}

/// Effect of a flow: heat transfer coefficient \[W/(m2 K)\] and axial diffusivity \[m2/s\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Convection {
    pub transfer: f64,
    pub diffusivity: f64,
}

/// Gas in a passage.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passage {
    /// Hydraulic diameter \[m\].
    pub hydraulic: f64,
    /// Speed \[m/s\].
    pub speed: f64,
    /// Density of the gas \[kg/m3\].
    pub density: f64,
    /// Temperature of the gas \[K\].
    pub gas: f64,
    /// Temperature of the wall \[K\].
    pub wall: f64,
}

impl Passage {
    /// Rayleigh number g |T - T_w| D^3 Pr/(T nu^2).
    fn rayleigh(&self) -> f64 {
        let kinematic = viscosity(self.gas) / self.density;
        GRAVITY * (self.gas - self.wall).abs() * self.hydraulic.powi(3) * PRANDTL
            / (self.gas * kinematic * kinematic)
    }

    /// Its heat transfer coefficient and axial diffusivity.
    pub(super) fn convection(&self, closures: &Closures) -> Convection {
        let (mu, k) = (viscosity(self.gas), conductivity(self.gas));
        let reynolds = self.density * self.speed * self.hydraulic / mu;
        let eddies = closures.mixing * turbulence(reynolds) * self.speed * self.hydraulic;
        Convection {
            transfer: nusselt(reynolds, self.rayleigh(), closures) * k / self.hydraulic,
            diffusivity: k / (self.density * CP) + eddies,
        }
    }
}
