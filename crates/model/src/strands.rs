//! What strands and rubber of a muscle feel between two rows: how far the strands turned, also where the length is held.

use bulge_effects::{Jet, Moment};
use bulge_fibre::Parts;
use bulge_numerics::Real;

use crate::answer::Carried;

/// Numbers that are kept from row to row: radius, stretch, d(radius)/d(contraction).
pub(crate) const MEMORY: usize = 3;
/// Strain per force of all fibres together \[1/N\] where the muscle takes them for inextensible: 0.2 %/kN, as aramid in a braid of 20 mm has. No
/// fibre is rigid, and friction between strands builds up over micrometres: what is nothing to the force is all the motion there is at held length.
const USUAL_COMPLIANCE: f64 = 2e-6;
/// A radius that changes by less than this with the contraction \[m\] says nothing about the strands.
const LEAST_SLOPE: f64 = 1e-6;

/// The fibres of a muscle, as far as their turning goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Strands {
    /// sin(theta)/r of fibres that don't stretch \[1/m\]; 0 if pleated.
    sine_per_radius: f64,
    /// Strain per force of all fibres together \[1/N\].
    compliance: f64,
    /// Whether the equilibrium knows of the stretch.
    is_solved: bool,
}

impl Strands {
    /// Of a muscle.
    pub(crate) fn of(parts: &Parts) -> Self {
        let is_solved = parts.compliance != 0.0;
        Self {
            sine_per_radius: parts.angle.sin() / parts.radius,
            compliance: if is_solved { parts.compliance } else { USUAL_COMPLIANCE },
            is_solved,
        }
    }

    /// How far the strands turned at mid-length since the row before, as a contraction.
    ///
    /// ```text
    /// sin(theta) = k r/(1 + e),   e = c N/cos(theta),   k = sin(alpha0)/r0
    /// turn = d eps + d_p u/(du/d eps) + (1 - eps) de,   u = r/(1 + e),   d_p u = du - (du/d eps) d eps
    /// ```
    /// The last term is there only where the equilibrium takes the fibres for inextensible: at held length stretched fibres turn as if the
    /// muscle were shorter. du/d eps is the mean of both rows and carries no derivatives, like the slope of the force. Where the pressure is held the
    /// turn is the change of the contraction, to the bit.
    pub(crate) fn turn(
        &self,
        moment: &Moment,
        found: &Carried,
        contraction: Jet,
        memory: Option<&mut Vec<Jet>>,
    ) -> Jet {
        let step = Jet::from(moment.step);
        let Some(memory) = memory.filter(|memory| memory.len() == MEMORY) else { return step };
        let sine = (self.sine_per_radius * found.mid_radius.value()).min(0.999);
        let stretch = found.tension * (self.compliance / (1.0 - sine * sine).sqrt());
        let radius = if self.is_solved { found.mid_radius / (stretch + 1.0) } else { found.mid_radius };
        let now = [radius, stretch, Jet::from(found.slope[2])];
        let before = [memory[0], memory[1], memory[2]];
        memory.copy_from_slice(&now);
        if moment.pressure_step == 0.0 || moment.begins {
            return step;
        }
        let slope = 0.5 * (before[2].value() + found.slope[2]);
        let mut turn = step;
        if slope.abs() > LEAST_SLOPE {
            turn += (now[0] - before[0]) / slope - moment.step;
        }
        if !self.is_solved {
            turn += (now[1] - before[1]) * (-contraction + 1.0);
        }
        turn
    }
}
