//! The turn of the strands between two rows, which friction and rubber follow, also at held length.

use bulge_effects::{Jet, Moment};
use bulge_fibre::Parts;
use bulge_numerics::Real;

use crate::answer::Carried;

/// Numbers kept from row to row: radius, stretch, d(radius)/d(contraction).
pub(crate) const MEMORY: usize = 3;
/// Strain per total fibre force \[1/N\] for a muscle whose fibres are taken as inextensible: 0.2 %/kN, as
/// aramid has in a braid of 20 mm. No fibre is rigid, and friction between strands builds up over
/// micrometres. A stretch that is negligible for the force is the only motion at held length.
const USUAL_COMPLIANCE: f64 = 2e-6;
/// The least |d(radius)/d(contraction)| \[m\] from which the turn of the strands can be inferred.
const LEAST_SLOPE: f64 = 1e-6;

/// The properties of the fibres that determine their turn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Strands {
    /// sin(theta)/r of unstretched fibres \[1/m\]; 0 if pleated.
    sine_per_radius: f64,
    /// Strain per total fibre force \[1/N\].
    compliance: f64,
    /// Whether the equilibrium includes the stretch.
    is_solved: bool,
}

impl Strands {
    /// The strands of a muscle.
    pub(crate) fn of(parts: &Parts) -> Self {
        let is_solved = parts.compliance != 0.0;
        Self {
            sine_per_radius: parts.angle.sin() / parts.radius,
            compliance: if is_solved { parts.compliance } else { USUAL_COMPLIANCE },
            is_solved,
        }
    }

    /// The turn of the strands at mid-length since the previous row, expressed as a contraction.
    ///
    /// ```text
    /// sin(theta) = k r/(1 + e),   e = c N/cos(theta),   k = sin(alpha0)/r0
    /// turn = d eps + d_p u/(du/d eps) + (1 - eps) de,   u = r/(1 + e),   d_p u = du - (du/d eps) d eps
    /// ```
    /// The last term applies only if the equilibrium takes the fibres as inextensible: stretched fibres at
    /// held length turn as if the muscle were shorter. du/d eps is the mean of both rows and carries no
    /// derivatives, like the slope of the force. At held pressure the turn equals the change of the
    /// contraction, bit for bit.
    pub(crate) fn turn(
        &self,
        moment: &Moment,
        found: &Carried,
        contraction: Jet,
        memory: Option<&mut Vec<Jet>>,
    ) -> Jet {
        let step = Jet::from(moment.step);
        let Some(memory) = memory.filter(|memory| memory.len() == MEMORY) else { return step };
        // The limit keeps cos(theta) away from 0.
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
