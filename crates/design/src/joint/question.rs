//! Questions about a joint, and the JSON documents of their answers.

use bulge_fibre::ADIABATIC;
use bulge_muscles::units::significant;
use serde::Serialize;

use super::{Joint, JointError, JointState, Outside, Readings};
use crate::question::{Lines, QuestionError};

/// Number of pressures of each muscle in the map.
const GRID: usize = 5;
/// Points of a drawn line.
const DRAWN: usize = 81;

/// What the gas of a closed muscle does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointGas {
    /// Slow: it keeps its temperature.
    Isothermal,
    /// Fast: it keeps its heat.
    Adiabatic,
}

/// What is known of a joint; what is asked follows from it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointParts {
    /// Gauge pressures \[Pa\].
    pub pressures_pa: Option<Vec<f64>>,
    /// Angle \[rad\].
    pub angle_rad: Option<f64>,
    /// Stiffness that is wanted at the angle \[N m/rad\].
    pub stiffness: Option<f64>,
    /// Torque from outside \[N m\].
    pub torque_nm: Option<f64>,
    /// Both valves are shut where the joint rests without the torque, which then acts.
    pub closed: Option<JointGas>,
    /// Dead volume of each closed muscle \[m^3\].
    pub dead_volume_m3: Option<f64>,
    /// Standard deviations of the readings, in the order pressure \[Pa\], angle \[rad\], force \[N\].
    pub readings: [Option<f64>; 3],
}

/// A question about a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointQuestion {
    /// Where it rests at two pressures under a torque from outside.
    Rest {
        /// Gauge pressures of agonist and antagonist \[Pa\].
        pressures_pa: [f64; 2],
        /// Torque from outside \[N m\].
        torque_nm: f64,
    },
    /// The same with valves that are shut before the torque acts.
    Shut {
        /// Gauge pressures of agonist and antagonist \[Pa\].
        pressures_pa: [f64; 2],
        /// Torque from outside \[N m\].
        torque_nm: f64,
        /// What the gas does.
        gas: JointGas,
        /// Dead volume of each muscle \[m^3\].
        dead_volume_m3: f64,
    },
    /// The torque from outside that holds it at an angle.
    Held {
        /// Gauge pressures of agonist and antagonist \[Pa\].
        pressures_pa: [f64; 2],
        /// Angle \[rad\].
        angle_rad: f64,
        /// Standard deviations of the readings.
        readings: Readings,
    },
    /// The pressures for an angle and a stiffness.
    Pressures {
        /// Angle \[rad\].
        angle_rad: f64,
        /// Stiffness \[N m/rad\].
        stiffness: f64,
        /// Torque from outside \[N m\].
        torque_nm: f64,
    },
    /// Its range over both pressures.
    Map {
        /// Torque from outside \[N m\].
        torque_nm: f64,
    },
}

/// An error of a joint, or of a part of a question.
type Refused = QuestionError<JointError>;

impl JointParts {
    /// The question.
    ///
    /// # Errors
    /// The parts make no question, or a number of them is impossible.
    pub fn question(&self) -> Result<JointQuestion, Refused> {
        let pressures = self.pressures()?;
        self.check(pressures.is_some())?;
        let torque_nm = self.torque_nm.unwrap_or(0.0);
        match (pressures, self.angle_rad, self.stiffness) {
            (Some(pressures_pa), None, _) => match self.closed {
                Some(gas) => {
                    let dead_volume_m3 = self.dead_volume_m3.unwrap_or(0.0);
                    if dead_volume_m3 < 0.0 {
                        return Refused::part("dead_volume", "a volume is 0 or more");
                    }
                    Ok(JointQuestion::Shut { pressures_pa, torque_nm, gas, dead_volume_m3 })
                }
                None => Ok(JointQuestion::Rest { pressures_pa, torque_nm }),
            },
            (Some(_), Some(_), _) if self.torque_nm.is_some() => Refused::part(
                "torque",
                "pressures and an angle give the torque from outside: leave one of the three out",
            ),
            (Some(pressures_pa), Some(angle_rad), _) => {
                Ok(JointQuestion::Held { pressures_pa, angle_rad, readings: self.readings()? })
            }
            (None, Some(angle_rad), Some(stiffness)) => {
                Ok(JointQuestion::Pressures { angle_rad, stiffness, torque_nm })
            }
            (None, Some(_), None) => Refused::part(
                "angle",
                "an angle alone is no question: add --stiffness for the pressures, or --pressure for the torque that holds it there",
            ),
            (None, None, _) => Ok(JointQuestion::Map { torque_nm }),
        }
    }

    fn pressures(&self) -> Result<Option<[f64; 2]>, Refused> {
        let Some(pressures) = &self.pressures_pa else { return Ok(None) };
        match pressures[..] {
            [one, other] if one > 0.0 && other > 0.0 => Ok(Some([one, other])),
            [_, _] => Refused::part("pressure", "both muscles need a gauge pressure above 0"),
            _ => Refused::part(
                "pressure",
                format!(
                    "{} pressures: write that of the agonist and that of the antagonist, such as \"2 bar,1.5 bar\"",
                    pressures.len()
                ),
            ),
        }
    }

    /// Refuses parts that would be left unheard.
    fn check(&self, has_pressures: bool) -> Result<(), Refused> {
        let has_angle = self.angle_rad.is_some();
        let is_closed = self.closed.is_some();
        let unheard = [
            (self.stiffness.is_some() && !has_angle, "stiffness", "it is wanted at an angle: add --angle"),
            (
                self.stiffness.is_some() && has_pressures,
                "stiffness",
                "pressures give the stiffness: leave one of the two out",
            ),
            (
                is_closed && (self.torque_nm.is_none() || !has_pressures || has_angle),
                "closed",
                "shut valves take --pressure and --torque, and no angle",
            ),
            (self.dead_volume_m3.is_some() && !is_closed, "dead_volume", "it counts with --closed alone"),
        ];
        if let Some((_, about, what)) = unheard.into_iter().find(|(is_so, ..)| *is_so) {
            return Refused::part(about, what);
        }
        let given = self.readings.iter().position(Option::is_some);
        match given.filter(|_| !(has_pressures && has_angle)) {
            Some(k) => Refused::part(READINGS[k], "it counts with --pressure and --angle alone"),
            None => Ok(()),
        }
    }

    fn readings(&self) -> Result<Readings, Refused> {
        let [pressure_pa, angle_rad, force_n] = self.readings.map(|sd| sd.unwrap_or(0.0));
        for (about, value) in READINGS.into_iter().zip([pressure_pa, angle_rad, force_n]) {
            if value < 0.0 {
                return Refused::part(about, "a standard deviation is 0 or more");
            }
        }
        Ok(Readings { pressure_pa, angle_rad, force_n })
    }
}

/// Names of the readings.
const READINGS: [&str; 3] = ["pressure_sd", "angle_sd", "force_sd"];

/// A place of the map: a state, or why there is none.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum MapPlace {
    /// Where the joint rests.
    Rest(Box<JointState>),
    /// No rest at these pressures.
    Refused {
        /// Gauge pressures of agonist and antagonist \[Pa\].
        pressures_pa: [f64; 2],
        /// The reason.
        why: String,
    },
}

/// The answer to a question.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub enum JointAnswer {
    /// Of [`JointQuestion::Shut`].
    Shut {
        /// At rest without the torque.
        before: Box<JointState>,
        /// At rest under the torque, with shut valves.
        stand: Box<JointState>,
        /// Stiffness of the shut joint before and after \[N m/rad\].
        shut_nm_per_rad: [f64; 2],
        /// Exponent of the gas.
        exponent: f64,
        /// Dead volume of each muscle \[m^3\].
        dead_volume_m3: f64,
    },
    /// Of [`JointQuestion::Held`].
    Held {
        /// The state.
        stand: Box<JointState>,
        /// The torque from outside, and how sure it is.
        outside: Outside,
        /// Standard deviations of the readings.
        readings: Readings,
    },
    /// Of [`JointQuestion::Rest`] and [`JointQuestion::Pressures`].
    Stand {
        /// The state.
        stand: Box<JointState>,
    },
    /// Of [`JointQuestion::Map`].
    Map {
        /// The pressures of the agonist in turn, and within those of the antagonist: see [`Joint::grid`].
        map: Vec<MapPlace>,
    },
}

/// The JSON document of an answer.
#[derive(Debug, Serialize)]
pub struct JointDocument<'a> {
    schema: &'static str,
    name: &'a str,
    outside_nm: f64,
    #[serde(flatten)]
    answer: &'a JointAnswer,
}

impl JointQuestion {
    /// Torque from outside that is given \[N m\].
    #[must_use]
    pub const fn torque_nm(&self) -> f64 {
        match self {
            Self::Rest { torque_nm, .. }
            | Self::Shut { torque_nm, .. }
            | Self::Pressures { torque_nm, .. }
            | Self::Map { torque_nm } => *torque_nm,
            Self::Held { .. } => 0.0,
        }
    }

    /// Whether it asks about single states, for which the joint needn't pull over all of its ranges.
    #[must_use]
    pub const fn is_point(&self) -> bool {
        !matches!(self, Self::Map { .. })
    }
}

impl Joint {
    /// Answers a question.
    ///
    /// # Errors
    /// The joint has no such state; a map has errors only if it has no state at all.
    pub fn answer(&self, question: &JointQuestion) -> Result<JointAnswer, JointError> {
        Ok(match *question {
            JointQuestion::Rest { pressures_pa, torque_nm } => {
                JointAnswer::Stand { stand: Box::new(self.rest(pressures_pa, torque_nm)?) }
            }
            JointQuestion::Shut { pressures_pa, torque_nm, gas, dead_volume_m3 } => {
                let exponent = if gas == JointGas::Adiabatic { ADIABATIC } else { 1.0 };
                let before = self.rest(pressures_pa, 0.0)?;
                let closed = self.closed(before.angle_rad, pressures_pa, exponent, [dead_volume_m3; 2])?;
                let stand = closed.rest(torque_nm)?;
                let shut_nm_per_rad =
                    [closed.stiffness(before.angle_rad)?, closed.stiffness(stand.angle_rad)?];
                let (before, stand) = (Box::new(before), Box::new(stand));
                JointAnswer::Shut { before, stand, shut_nm_per_rad, exponent, dead_volume_m3 }
            }
            JointQuestion::Held { pressures_pa, angle_rad, readings } => {
                let stand = Box::new(self.stand(angle_rad, pressures_pa)?);
                let outside = self.outside(angle_rad, pressures_pa, readings)?;
                JointAnswer::Held { stand, outside, readings }
            }
            JointQuestion::Pressures { angle_rad, stiffness, torque_nm } => {
                JointAnswer::Stand { stand: Box::new(self.pressures_for(angle_rad, stiffness, torque_nm)?) }
            }
            JointQuestion::Map { torque_nm } => JointAnswer::Map { map: self.map(torque_nm)? },
        })
    }

    /// The JSON document of an answer to a question.
    #[must_use]
    pub fn document<'a>(&'a self, question: &JointQuestion, answer: &'a JointAnswer) -> JointDocument<'a> {
        let outside_nm = question.torque_nm();
        JointDocument { schema: "bulge.joint/1", name: &self.name, outside_nm, answer }
    }

    /// Evenly spaced pressures over the joint's range \[Pa\].
    #[must_use]
    pub fn grid(&self) -> Vec<f64> {
        let [low, high] = self.pressure;
        (0..GRID).map(|k| low + (high - low) * k as f64 / (GRID - 1) as f64).collect()
    }

    fn map(&self, torque_nm: f64) -> Result<Vec<MapPlace>, JointError> {
        let grid = self.grid();
        let (mut map, mut refused) = (Vec::new(), None);
        for pressures_pa in grid.iter().flat_map(|one| grid.iter().map(move |other| [*one, *other])) {
            match self.rest(pressures_pa, torque_nm) {
                Ok(stand) => map.push(MapPlace::Rest(Box::new(stand))),
                Err(error) => {
                    map.push(MapPlace::Refused { pressures_pa, why: error.to_string() });
                    refused = Some(error);
                }
            }
        }
        // No pair of pressures has an equilibrium: the last reason is reported.
        match refused {
            Some(error) if map.iter().all(|at| matches!(at, MapPlace::Refused { .. })) => Err(error),
            _ => Ok(map),
        }
    }

    /// The torque of both muscles against the angle, for equal pressures and for opposite extremes.
    ///
    /// # Errors
    /// As [`Joint::torque`]: a drawing needs both muscles to pull over all of the joint's ranges.
    pub fn drawing(&self) -> Result<Lines, JointError> {
        let ([low, high], all) = (self.angle, self.grid());
        let bar = |pressure: f64| significant(1e-5 * pressure, 4);
        let pairs = all.iter().map(|p| [*p, *p]).chain([[all[GRID - 1], all[0]], [all[0], all[GRID - 1]]]);
        let mut lines = Vec::new();
        for [one, other] in pairs {
            let mut points = Vec::new();
            for k in 0..DRAWN {
                // Rounding must not lead out of the range.
                let angle = (low + (high - low) * k as f64 / (DRAWN - 1) as f64).min(high);
                points.push([angle.to_degrees(), self.torque(angle, one, other)?]);
            }
            lines.push((format!("{} | {} bar", bar(one), bar(other)), points));
        }
        let title = format!("{}: agonist | antagonist", self.name);
        Ok(Lines { title, axes: ["angle [deg]", "torque [N m]"], lines })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_follows_from_what_is_known() {
        let both = Some(vec![2e5, 1.5e5]);
        let rest = JointParts { pressures_pa: both.clone(), torque_nm: Some(3.0), ..JointParts::default() };
        let expected = JointQuestion::Rest { pressures_pa: [2e5, 1.5e5], torque_nm: 3.0 };
        assert_eq!(rest.question().unwrap(), expected);
        assert_eq!(JointParts::default().question().unwrap(), JointQuestion::Map { torque_nm: 0.0 });
        let shut = JointParts { closed: Some(JointGas::Adiabatic), ..rest.clone() };
        assert!(matches!(shut.question().unwrap(), JointQuestion::Shut { dead_volume_m3: 0.0, .. }));
        let held = JointParts { angle_rad: Some(0.1), torque_nm: None, ..rest.clone() };
        assert!(matches!(held.question().unwrap(), JointQuestion::Held { .. }));
    }

    #[test]
    fn parts_that_would_be_left_unheard_are_refused() {
        let pressures_pa = Some(vec![2e5, 1.5e5]);
        let some = JointParts { pressures_pa: pressures_pa.clone(), ..JointParts::default() };
        for (parts, says) in [
            (JointParts { angle_rad: Some(0.1), ..JointParts::default() }, "angle: an angle alone"),
            (JointParts { pressures_pa: Some(vec![2e5]), ..JointParts::default() }, "pressure: 1 pressures"),
            (JointParts { pressures_pa: Some(vec![2e5, 0.0]), ..JointParts::default() }, "pressure: both"),
            (JointParts { stiffness: Some(1.0), ..JointParts::default() }, "stiffness: it is wanted at"),
            (JointParts { closed: Some(JointGas::Isothermal), ..some.clone() }, "closed: shut valves"),
            (JointParts { dead_volume_m3: Some(1e-5), ..some.clone() }, "dead_volume: it counts"),
            (JointParts { readings: [None, None, Some(1.0)], ..some.clone() }, "force_sd: it counts"),
            (
                JointParts { readings: [Some(-1.0), None, None], angle_rad: Some(0.1), ..some.clone() },
                "pressure_sd: a standard deviation is 0 or more",
            ),
            (
                JointParts { torque_nm: Some(1.0), angle_rad: Some(0.1), ..some.clone() },
                "torque: pressures and an angle give",
            ),
        ] {
            let message = parts.question().unwrap_err().to_string();
            assert!(message.starts_with(says), "{message}");
        }
    }
}
