//! States of a joint: under a load, at an angle, for a wanted angle and stiffness, and with closed valves.

use bulge_fibre::Approach;
use bulge_muscles::Pressure;
use serde::Serialize;
use std::cell::Cell;

use super::{Joint, JointError, Side, TOLERANCE, root};
use crate::gas::{GasError, Inside, ShutGas, Surroundings, failed, pulling};

/// Steps in which a closed joint is followed to its rest.
const STEPS: u32 = 64;

/// State of one muscle of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SideState {
    /// Side of the joint.
    pub side: Side,
    /// Gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contraction.
    pub contraction: f64,
    /// Pull \[N\].
    pub force_n: f64,
    /// Contribution to the torque \[N m\]; negative for the antagonist.
    pub torque_nm: f64,
    /// Volume of its gas \[m^3\].
    pub volume_m3: f64,
}

/// State of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct JointState {
    /// Its angle \[rad\].
    pub angle_rad: f64,
    /// Torque of both muscles \[N m\]. The external torque that holds the joint is the negative of it.
    pub torque_nm: f64,
    /// -dM/dtheta at constant pressures \[N m/rad\].
    pub stiffness_nm_per_rad: f64,
    /// Stiffness with both valves closed, for slow (isothermal) motion \[N m/rad\].
    pub isothermal_nm_per_rad: f64,
    /// Stiffness with both valves closed, for fast (adiabatic, exponent 1.4) motion \[N m/rad\].
    pub adiabatic_nm_per_rad: f64,
    /// Agonist and antagonist.
    pub sides: [SideState; 2],
}

/// Standard deviations of the readings from which an external torque is computed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Readings {
    /// Standard deviation of each pressure \[Pa\].
    pub pressure_pa: f64,
    /// Standard deviation of the angle \[rad\].
    pub angle_rad: f64,
    /// Standard deviation of the modelled force of each muscle \[N\]: the residual of a fit.
    pub force_n: f64,
}

/// An external torque with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Outside {
    /// External torque on the joint \[N m\], positive if it turns the joint to positive angles.
    pub torque_nm: f64,
    /// Its standard deviation \[N m\].
    pub sd_nm: f64,
    /// Contributions of the pressures, the angle, the forces and the widths of learnt numbers to the standard
    /// deviation \[N m\].
    pub from_nm: [f64; 4],
}

/// A joint with closed valves.
#[derive(Debug, Clone)]
pub struct Closed<'a> {
    joint: &'a Joint,
    /// Angle at which the valves were closed.
    angle: f64,
    gas: [ShutGas; 2],
}

impl Joint {
    /// The state at an angle \[rad\] and the gauge pressures of agonist and antagonist \[Pa\].
    ///
    /// ```text
    /// K = sum over both of  K_l m^2 - F dm/dtheta        m = -dl/dtheta, K_l = dF/dl of the muscle: open, or closed with its gas
    /// ```
    ///
    /// # Errors
    /// As [`Joint::torque`].
    pub fn stand(&self, angle: f64, pressures: [f64; 2]) -> Result<JointState, JointError> {
        self.inside(angle)?;
        let mut stiffness = [0.0; 3];
        let mut sides = Vec::with_capacity(2);
        for (muscle, pressure) in self.muscles.iter().zip(pressures) {
            let found = muscle.response(angle, pressure)?;
            let reach = muscle.reach(angle);
            let along = [
                found.stiffness_n_per_m,
                found.stiffness_isothermal_n_per_m,
                found.stiffness_adiabatic_n_per_m,
            ];
            for (sum, along) in stiffness.iter_mut().zip(along) {
                *sum += along * reach.arm * reach.arm - found.force_n * reach.arm_by_angle;
            }
            sides.push(SideState {
                side: muscle.side,
                pressure_pa: pressure,
                contraction: muscle.contraction(angle),
                force_n: found.force_n,
                torque_nm: found.force_n * reach.arm,
                volume_m3: found.volume_m3,
            });
        }
        let [open, slow, fast] = stiffness;
        let sides = [sides[0], sides[1]];
        Ok(JointState {
            angle_rad: angle,
            torque_nm: sides[0].torque_nm + sides[1].torque_nm,
            stiffness_nm_per_rad: open,
            isothermal_nm_per_rad: slow,
            adiabatic_nm_per_rad: fast,
            sides,
        })
    }

    /// State of rest under an external torque \[N m\], which is positive if it turns the joint to positive
    /// angles.
    ///
    /// # Errors
    /// [`JointError::NoRest`] if the rest isn't within the range of angles, or [`JointError::Muscle`].
    pub fn rest(&self, pressures: [f64; 2], outside: f64) -> Result<JointState, JointError> {
        self.within(pressures)?;
        let torque = |angle: f64| Ok(self.moment(angle, pressures)? + outside);
        let (range @ [low, high], torques) = self.ends(torque, pressures)?;
        if !(torques[0] >= 0.0 && torques[1] <= 0.0) {
            return Err(JointError::NoRest { pressures, torques, range });
        }
        self.stand(root(torque, range, TOLERANCE * (high - low).abs())?, pressures)
    }

    /// Refuses pressures outside the range of the joint.
    fn within(&self, pressures: [f64; 2]) -> Result<(), JointError> {
        let [low, high] = self.pressure;
        let slack = 1e-9 * high;
        let is_out = |p: &f64| !(*p >= low - slack && *p <= high + slack);
        match [Side::Agonist, Side::Antagonist].into_iter().zip(pressures).find(|(_, p)| is_out(p)) {
            Some((side, pressure_pa)) => Err(JointError::Outside(format!(
                "the pressure of the {}, {:.4} bar, is outside the range of the joint, {:.4} to {:.4} bar",
                side.name(),
                1e-5 * pressure_pa,
                1e-5 * low,
                1e-5 * high
            ))),
            None => Ok(()),
        }
    }

    /// The external torque that holds the joint at an angle against both muscles, with its standard
    /// deviation. S1 (section 4.2) estimates the force of an operator from the pressures in this way:
    ///
    /// ```text
    /// M_out = -M(theta, p1, p2)     var M_out = sum (dM/dp_i s_p)^2 + (K s_theta)^2 + sum (m_i s_F)^2 + sum (m_i dF/dk s_k)^2
    /// ```
    /// The last sum is over the numbers k for which the muscle files state a width, such as those learnt by
    /// `bulge fit`, as if they were independent. s_F is the residual of the fit beyond them.
    ///
    /// # Errors
    /// As [`Joint::torque`].
    pub fn outside(&self, angle: f64, pressures: [f64; 2], sd: Readings) -> Result<Outside, JointError> {
        self.within(pressures)?;
        let stand = self.stand(angle, pressures)?;
        let (mut by_pressure, mut by_force, mut by_learnt) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (muscle, pressure) in self.muscles.iter().zip(pressures) {
            by_pressure = by_pressure.hypot(muscle.by_pressure(angle, pressure)? * sd.pressure_pa);
            let arm = muscle.reach(angle).arm;
            by_force = by_force.hypot(arm * sd.force_n);
            by_learnt = by_learnt.hypot(arm * muscle.unsure(angle, pressure)?);
        }
        let by_angle = (stand.stiffness_nm_per_rad * sd.angle_rad).abs();
        let from = [by_pressure, by_angle, by_force, by_learnt];
        let sd_nm = from.iter().map(|part| part * part).sum::<f64>().sqrt();
        Ok(Outside { torque_nm: -stand.torque_nm, sd_nm, from_nm: from })
    }

    /// The pressure of the antagonist that, with a pressure of the agonist, holds an angle under an external
    /// torque; an end of the range if none does.
    fn partner(&self, angle: f64, agonist: f64, outside: f64) -> Result<f64, JointError> {
        let (low, high) = (self.least_pressure(&self.muscles[1], angle)?, self.pressure[1]);
        root(|p| Ok(self.moment(angle, [agonist, p])? + outside), [low, high], TOLERANCE * high)
    }

    /// The pressures of agonist and antagonist that hold an angle \[rad\] under an external torque \[N m\]
    /// with a stiffness \[N m/rad\] at constant pressures. The difference of the pressures sets the angle,
    /// and their sum the stiffness (S1, section 4.1).
    ///
    /// # Errors
    /// [`JointError::Stiffness`] with the stiffnesses that are possible at this angle, or
    /// [`JointError::Held`] if no pressures hold it.
    pub fn pressures_for(&self, angle: f64, stiffness: f64, outside: f64) -> Result<JointState, JointError> {
        self.inside(angle)?;
        let range = self.agonists(angle, outside)?;
        let stand = |agonist: f64| self.stand(angle, [agonist, self.partner(angle, agonist, outside)?]);
        let ends = [stand(range[0])?.stiffness_nm_per_rad, stand(range[1])?.stiffness_nm_per_rad];
        let [least, most] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        // Rounding may put a stiffness at an end of the range slightly outside.
        let slack = 1e-9 * most.abs();
        if !(stiffness >= least - slack && stiffness <= most + slack) {
            return Err(JointError::Stiffness { angle, stiffness, range: [least, most] });
        }
        let missing = |p: f64| Ok(stand(p)?.stiffness_nm_per_rad - stiffness);
        let agonist = root(missing, range, TOLERANCE * range[1])?;
        stand(agonist)
    }

    /// The range of agonist pressures for which a pressure of the antagonist holds the angle.
    fn agonists(&self, angle: f64, outside: f64) -> Result<[f64; 2], JointError> {
        let high = self.pressure[1];
        let [one, other] = &self.muscles;
        let (low, lowest) = (self.least_pressure(one, angle)?, self.least_pressure(other, angle)?);
        let own = |p: f64| Ok::<_, JointError>(one.pull(angle, p)?.torque + outside);
        let against = |p: f64| Ok::<_, JointError>(-other.pull(angle, p)?.torque);
        // Both torques rise with p: a lower limit that the agonist must reach, and an upper one that it must
        // not exceed.
        let [weakest, strongest] = [against(lowest)?, against(high)?];
        let reached = |torque: f64| root(|p| Ok(own(p)? - torque), [low, high], TOLERANCE * high);
        if own(high)? < weakest || own(low)? > strongest {
            // Without the external torque; the torque that holds the joint is the negative.
            let held = [weakest - own(high)? + outside, strongest - own(low)? + outside];
            return Err(JointError::Held { angle, outside, range: held });
        }
        let from = if own(low)? >= weakest { low } else { reached(weakest)? };
        let to = if own(high)? <= strongest { high } else { reached(strongest)? };
        Ok([from, to])
    }

    /// Closes the valves of the joint in this state. Each muscle then keeps P (V + V_dead)^n, with n from 1
    /// (slow, isothermal) to 1.4 (fast, adiabatic) and the dead volume of the fittings and tubes of each
    /// muscle \[m^3\].
    ///
    /// # Errors
    /// As [`Joint::torque`].
    pub fn closed(
        &self,
        angle: f64,
        pressures: [f64; 2],
        exponent: f64,
        dead_m3: [f64; 2],
    ) -> Result<Closed<'_>, JointError> {
        let stand = self.stand(angle, pressures)?;
        let gas = [0, 1].map(|i: usize| {
            let SideState { pressure_pa, volume_m3, .. } = stand.sides[i];
            let surroundings = Surroundings { dead_volume_m3: dead_m3[i], ..Surroundings::STANDARD };
            ShutGas { surroundings, exponent, pressure_pa, volume_m3 }
        });
        Ok(Closed { joint: self, angle, gas })
    }
}

impl Closed<'_> {
    /// Gauge pressures of both muscles at an angle \[Pa\].
    ///
    /// # Errors
    /// [`JointError::Outside`] if a muscle has no gauge pressure left, or [`JointError::Muscle`].
    pub fn pressures(&self, angle: f64) -> Result<[f64; 2], JointError> {
        let mut pressures = [0.0; 2];
        for ((found, muscle), gas) in pressures.iter_mut().zip(&self.joint.muscles).zip(&self.gas) {
            let contraction = muscle.contraction(angle);
            let empty = Cell::new(None);
            let inside = |p: f64| {
                if p <= 0.0 {
                    empty.set(empty.get().or(Some(p)));
                }
                let found = pulling(&muscle.extended, p, contraction, Approach::Auto);
                let found = found.map_err(|error| failed(p, error))?;
                Ok(Inside::of(p, &found, &gas.surroundings))
            };
            let state = gas.state(inside, self.joint.pressure[1]).map_err(|error| match error {
                GasError::Muscle { pressure_pa, error } => muscle.failed(angle, pressure_pa, error),
                _ => JointError::Outside(format!(
                    "the closed {} has no pressure left at {:.4} deg: {:.4} below the air around it; fill it more",
                    muscle.side.name(),
                    angle.to_degrees(),
                    Pressure::pa(empty.get().unwrap_or_default())
                )),
            })?;
            *found = state.pressure_pa;
        }
        Ok(pressures)
    }

    /// State of rest under an external torque \[N m\].
    ///
    /// # Errors
    /// As [`Joint::rest`] and [`Closed::pressures`].
    pub fn rest(&self, outside: f64) -> Result<JointState, JointError> {
        let torque = |angle: f64| Ok(self.joint.moment(angle, self.pressures(angle)?)? + outside);
        // Search outwards from the closing angle: at an end of the range a muscle may have lost its pressure,
        // while the rest lies before it.
        let start = self.angle;
        let begun = torque(start)?;
        let end = self.joint.angle[usize::from(begun > 0.0)];
        let mut before = start;
        for k in 1..=STEPS {
            let next = start + (end - start) * f64::from(k) / f64::from(STEPS);
            if torque(next)? * begun <= 0.0 {
                let tolerance = TOLERANCE * (self.joint.angle[1] - self.joint.angle[0]);
                let angle = root(torque, [before.min(next), before.max(next)], tolerance)?;
                return self.joint.stand(angle, self.pressures(angle)?);
            }
            before = next;
        }
        let (pressures, range) = (self.gas.map(|gas| gas.pressure_pa), self.joint.angle);
        Err(JointError::NoRest { pressures, torques: [begun, torque(end)?], range })
    }

    /// -dM/dtheta with closed valves and the dead volume \[N m/rad\], by a difference of fourth order.
    ///
    /// # Errors
    /// As [`Closed::torque`].
    pub fn stiffness(&self, angle: f64) -> Result<f64, JointError> {
        let [low, high] = self.joint.angle;
        // The step keeps both sides within the range.
        let h = (1e-3 * (high - low)).min(0.4 * (angle - low)).min(0.4 * (high - angle));
        let at = |k: f64| self.torque(angle + k * h);
        Ok(-(8.0 * (at(1.0)? - at(-1.0)?) - (at(2.0)? - at(-2.0)?)) / (12.0 * h))
    }

    /// Torque of both muscles at an angle \[N m\].
    ///
    /// # Errors
    /// As [`Closed::pressures`].
    pub fn torque(&self, angle: f64) -> Result<f64, JointError> {
        self.joint.inside(angle)?;
        self.joint.moment(angle, self.pressures(angle)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::Checks;
    use crate::joint::tests::{LEVER, PULLEY, read as joint};

    const AMBIENT: f64 = bulge_fibre::AMBIENT_PRESSURE;
    const BRAIDS: &str = "muscle = \"dmsp-20-250\"\nkind = \"pulley\"\nradius = \"30 mm\"\ncontraction = \"12 %\"\nangle = \"-20 deg..20 deg\"\npressure = \"1 bar..6 bar\"\n";

    /// Torque and stiffness agree with the other functions; the torque of a pulley is the difference of the
    /// forces times its radius.
    #[test]
    fn a_stand_is_torque_and_stiffness() {
        for text in [PULLEY, LEVER, BRAIDS] {
            let joint = joint(text);
            for angle in [-0.2, 0.0, 0.15] {
                let stand = joint.stand(angle, [2e5, 1.5e5]).unwrap();
                let (torque, stiffness) =
                    (joint.torque(angle, 2e5, 1.5e5).unwrap(), joint.stiffness(angle, 2e5, 1.5e5).unwrap());
                assert!((stand.torque_nm - torque).abs() < 1e-9 * torque.abs().max(1.0));
                let off = (stand.stiffness_nm_per_rad - stiffness).abs() / stiffness;
                assert!(off < 1e-7, "{off:e}");
                if text == PULLEY {
                    let [one, other] = stand.sides.map(|side| side.force_n);
                    assert!((stand.torque_nm - 0.04 * (one - other)).abs() < 1e-9);
                }
            }
        }
    }

    #[test]
    fn a_load_turns_the_joint_until_the_muscles_hold_it() {
        for text in [PULLEY, LEVER, BRAIDS] {
            let joint = joint(text);
            let free = joint.rest([2e5, 2.1e5], 0.0).unwrap();
            let loaded = joint.rest([2e5, 2.1e5], 1.5).unwrap();
            assert!((loaded.torque_nm + 1.5).abs() < 1e-7 && loaded.angle_rad > free.angle_rad);
            // Under a small load it turns by load over stiffness.
            let small = joint.rest([2e5, 2.1e5], 1e-3).unwrap();
            let turned = (small.angle_rad - free.angle_rad) * free.stiffness_nm_per_rad / 1e-3;
            assert!((turned - 1.0).abs() < 1e-3, "{turned}");
            assert!(matches!(joint.rest([2e5, 2.1e5], 1e3), Err(JointError::NoRest { .. })));
        }
    }

    /// The inverse: from the angle and the stiffness of a state to its pressures.
    #[test]
    fn pressures_for_angle_and_stiffness() {
        for text in [PULLEY, LEVER, BRAIDS] {
            let joint = joint(text);
            for (pressures, outside) in [([2e5, 1.6e5], 0.0), ([1.8e5, 2.2e5], 0.0), ([2.2e5, 2e5], -1.0)] {
                let there = joint.rest(pressures, outside).unwrap();
                let found =
                    joint.pressures_for(there.angle_rad, there.stiffness_nm_per_rad, outside).unwrap();
                for (side, p) in found.sides.iter().zip(pressures) {
                    assert!((side.pressure_pa / p - 1.0).abs() < 1e-6, "{} {p}", side.pressure_pa);
                }
                let Err(JointError::Stiffness { range: [least, most], .. }) =
                    joint.pressures_for(there.angle_rad, 1e6, outside)
                else {
                    panic!("no joint is as stiff")
                };
                assert!(least < there.stiffness_nm_per_rad && there.stiffness_nm_per_rad < most);
                // Both ends of the range can be reached.
                for stiffness in [least, most] {
                    let end = joint.pressures_for(there.angle_rad, stiffness, outside).unwrap();
                    assert!((end.stiffness_nm_per_rad / stiffness - 1.0).abs() < 1e-6);
                    assert!((end.torque_nm + outside).abs() < 1e-5);
                }
            }
            let Err(JointError::Held { range: [least, most], .. }) = joint.pressures_for(0.0, 10.0, 1e4)
            else {
                panic!("nothing holds 10 kN m")
            };
            // The strongest pull of one muscle against the weakest of the other.
            let [low, high] = joint.pressure;
            let torque = |one: f64, other: f64| joint.torque(0.0, one, other).unwrap();
            assert!((least + torque(high, low)).abs() < 1e-6 && (most + torque(low, high)).abs() < 1e-6);
            assert!(matches!(joint.rest([2.0 * high, low], 0.0), Err(JointError::Outside(_))));
        }
    }

    /// The external torque that holds a state is recovered; its standard deviation is compared with many
    /// noisy readings.
    #[test]
    fn an_outside_torque_with_its_uncertainty() {
        let joint = joint(LEVER);
        let sd = Readings { pressure_pa: 800.0, angle_rad: 2e-3, force_n: 6.0 };
        let loaded = joint.rest([2e5, 1.6e5], 2.0).unwrap();
        let found = joint.outside(loaded.angle_rad, [2e5, 1.6e5], sd).unwrap();
        assert!((found.torque_nm - 2.0).abs() < 1e-6);
        let mut random = bulge_numerics::Random::new(3, 0);
        let (mut sum, mut squares) = (0.0, 0.0);
        let count = 4000;
        for _ in 0..count {
            let mut noise = |size: f64| size * random.normal();
            let pressures = [2e5 + noise(800.0), 1.6e5 + noise(800.0)];
            let angle = loaded.angle_rad + noise(2e-3);
            let stand = joint.stand(angle, pressures).unwrap();
            let arms = [Side::Agonist, Side::Antagonist].map(|side| joint.linkage.at(side, angle).arm);
            let torque = -stand.torque_nm + arms[0] * noise(6.0) + arms[1] * noise(6.0);
            sum += torque;
            squares += (torque - 2.0).powi(2);
        }
        let spread = (squares / f64::from(count)).sqrt();
        assert!((sum / f64::from(count) - 2.0).abs() < 0.1 * spread);
        assert!((spread / found.sd_nm - 1.0).abs() < 0.05, "{spread} {}", found.sd_nm);
        assert!(found.from_nm[3] == 0.0, "nothing has a width");
        let whole = found.from_nm.iter().map(|part| part * part).sum::<f64>().sqrt();
        assert!((whole / found.sd_nm - 1.0).abs() < 1e-12);
    }

    /// Widths of a muscle file, of the rubber and of an effect that adds to the force, against torques of
    /// muscles with other numbers.
    #[test]
    fn what_was_learnt_is_not_sure() {
        let muscle = |c10: f64, offset: f64, width: &str| {
            format!(
                "name = \"m\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10.725 mm\"\nbraid_angle = \"25 deg\"\nwall = \"2 mm\"\n\
                 [effects.bladder-elasticity]\nc10 = \"{c10} MPa{}\"\n[effects.pressure-threshold]\npressure = \"{offset} kPa{}\"\n",
                if width.is_empty() { "" } else { " +- 0.02 MPa" },
                if width.is_empty() { "" } else { " +- 1.5 kPa" },
            )
        };
        let folder = tempfile::tempdir().unwrap();
        let with = |c10: f64, offset: f64, width: &str| {
            std::fs::write(folder.path().join("m.toml"), muscle(c10, offset, width)).unwrap();
            let text = BRAIDS.replace("dmsp-20-250", "m.toml").replace("1 bar..6", "3 bar..6");
            let read = Joint::from_toml(&text, "j.toml", Some(folder.path()), Checks::Everywhere, |_| Ok(()));
            read.unwrap().0
        };
        let none = Readings { pressure_pa: 0.0, angle_rad: 0.0, force_n: 0.0 };
        let (angle, pressures) = (0.1, [4e5, 3e5]);
        let found = with(0.2, 12.0, "+-").outside(angle, pressures, none).unwrap();
        // Each muscle by itself: torques of joints with changed numbers, and the force of one side at a time.
        let sides = |c10: f64, offset: f64| {
            with(c10, offset, "").stand(angle, pressures).unwrap().sides.map(|side| side.torque_nm)
        };
        let (up, down) = (sides(0.21, 12.0), sides(0.19, 12.0));
        let (more, less) = (sides(0.2, 12.5), sides(0.2, 11.5));
        let mut square = 0.0;
        for i in 0..2 {
            square += (0.02 * (up[i] - down[i]) / 0.02).powi(2) + (1.5 * (more[i] - less[i])).powi(2);
        }
        assert!((found.sd_nm / square.sqrt() - 1.0).abs() < 1e-3, "{} {}", found.sd_nm, square.sqrt());
        assert!((found.from_nm[3] / found.sd_nm - 1.0).abs() < 1e-12 && found.sd_nm > 0.01);
        assert!(with(0.2, 12.0, "").outside(angle, pressures, none).unwrap().sd_nm == 0.0);
    }

    /// Closed valves: the stiffness is minus the slope of the closed torque, slow and fast. The amount of gas
    /// is constant. Dead volume makes the joint softer, and infinite dead volume as soft as open valves do.
    #[test]
    fn closed_muscles_are_stiffer() {
        for text in [PULLEY, LEVER, BRAIDS] {
            let joint = joint(text);
            let there = joint.rest([2e5, 1.8e5], 0.0).unwrap();
            let (angle, pressures) = (there.angle_rad, [2e5, 1.8e5]);
            for (exponent, stiffness) in
                [(1.0, there.isothermal_nm_per_rad), (1.4, there.adiabatic_nm_per_rad)]
            {
                let closed = joint.closed(angle, pressures, exponent, [0.0; 2]).unwrap();
                let found = closed.pressures(angle).unwrap();
                assert!(found.iter().zip(pressures).all(|(a, b)| (a / b - 1.0).abs() < 1e-9));
                let h = 1e-4;
                let slope =
                    -(closed.torque(angle + h).unwrap() - closed.torque(angle - h).unwrap()) / (2.0 * h);
                println!("{exponent}: {stiffness} {slope}");
                assert!((slope / stiffness - 1.0).abs() < 1e-6, "{slope} {stiffness}");
                assert!(stiffness > 1.05 * there.stiffness_nm_per_rad);
                let loaded = closed.rest(1.0).unwrap();
                assert!((loaded.torque_nm + 1.0).abs() < 1e-7);
                for (side, before) in loaded.sides.iter().zip(there.sides) {
                    let gas = |side: SideState| (side.pressure_pa + AMBIENT) * side.volume_m3.powf(exponent);
                    assert!((gas(*side) / gas(before) - 1.0).abs() < 1e-9);
                }
                let open = joint.rest(pressures, 1.0).unwrap();
                let roomy = joint.closed(angle, pressures, exponent, [1e-4; 2]).unwrap().rest(1.0).unwrap();
                assert!((closed.stiffness(angle).unwrap() / stiffness - 1.0).abs() < 1e-7);
                let far = joint.closed(angle, pressures, exponent, [1e3; 2]).unwrap();
                assert!((far.stiffness(angle).unwrap() / there.stiffness_nm_per_rad - 1.0).abs() < 1e-5);
                let endless = far.rest(1.0).unwrap();
                assert!(loaded.angle_rad < roomy.angle_rad && roomy.angle_rad < open.angle_rad);
                assert!((endless.angle_rad / open.angle_rad - 1.0).abs() < 1e-6);
            }
        }
    }
}
