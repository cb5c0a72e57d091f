//! Questions about the air in a muscle, and the JSON documents of their answers.

use bulge_fibre::{Approach, Given};
use bulge_model::MuscleWithEffects;
use bulge_muscles::{Pressure, Quantity};
use serde::Serialize;

use super::{
    AMBIENT_TEMPERATURE_K, Chamber, ClosedMuscle, ClosedState, CycleResult, Filling, GasError, GasModel,
    History, Lift, Load, Orifice, Sample, StiffnessSplit, Stroke, Supply,
};
use crate::question::{Lines, QuestionError, millimetres};

/// Contractions of a closed muscle.
const PLACES: usize = 11;
/// Contractions about the one where it is shut, if none are given.
const ABOUT: f64 = 0.05;
/// Output times of a filling.
const SAMPLES: usize = 200;
/// Points of the drawing of a rising load.
const RISING: u32 = 40;

/// The valve shut: pressure, force and stiffness against contraction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShutQuestion {
    /// Gauge pressure when it is shut \[Pa\].
    pub pressure_pa: f64,
    /// Contraction when it is shut.
    pub contraction: f64,
    /// Contractions to look at; by default 5 % about that.
    pub range: Option<[f64; 2]>,
    /// From 1 (slow: isothermal) to 1.4 (fast: adiabatic).
    pub exponent: f64,
    /// Also the contraction under a force \[N\].
    pub force_n: Option<f64>,
    /// Dead volume of fittings and tubes \[m^3\].
    pub dead_volume_m3: f64,
}

/// A state of a closed muscle with the parts of its stiffness.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct ShutState {
    /// The state.
    pub state: ClosedState,
    /// Its stiffness.
    pub stiffness: StiffnessSplit,
}

/// Answer to a [`ShutQuestion`]; it serialises as its JSON document.
#[derive(Debug, Clone, Serialize)]
pub struct ShutAnswer {
    schema: &'static str,
    /// Name of the muscle.
    pub muscle: String,
    /// Mass of the air \[kg\].
    pub mass_kg: f64,
    /// Exponent of the gas.
    pub exponent: f64,
    /// States over the range of contractions.
    pub states: Vec<ShutState>,
    /// State under the force, if one is asked for.
    pub under_force: Option<ClosedState>,
}

impl ShutQuestion {
    /// Answers it for a muscle.
    ///
    /// # Errors
    /// A number is impossible, or the muscle has no equilibrium in one of the states.
    pub fn answer(&self, muscle: &MuscleWithEffects) -> Result<ShutAnswer, GasError> {
        let closed = ClosedMuscle::new(muscle, self.pressure_pa, self.contraction, self.exponent)?
            .with_dead_volume(self.dead_volume_m3)?;
        let [from, to] = self.range.unwrap_or([self.contraction - ABOUT, self.contraction + ABOUT]);
        let mut states = Vec::new();
        for k in 0..PLACES {
            let at = from + (to - from) * k as f64 / (PLACES - 1) as f64;
            match closed.at_contraction(at) {
                Ok(state) => states.push(ShutState { state, stiffness: closed.split(&state)? }),
                // Contractions of the default range may lie outside the range of the muscle.
                Err(_) if self.range.is_none() && k != PLACES / 2 => (),
                Err(error) => return Err(error),
            }
        }
        let under_force = self.force_n.map(|force| closed.under_force(force)).transpose()?;
        Ok(ShutAnswer {
            schema: "bulge.air/1",
            muscle: muscle.muscle().name().to_owned(),
            mass_kg: closed.mass_kg(),
            exponent: self.exponent,
            states,
            under_force,
        })
    }
}

impl ShutAnswer {
    /// The force with the valve shut, and open at the pressure of the filling.
    ///
    /// # Errors
    /// There is no equilibrium with the valve open.
    pub fn drawing(&self, muscle: &MuscleWithEffects, pressure_pa: f64) -> Result<Lines, GasError> {
        let percent = |at: &ShutState| 100.0 * at.state.contraction;
        let shut = self.states.iter().map(|at| [percent(at), at.state.force_n]).collect();
        let mut open = Vec::new();
        for at in &self.states {
            let given = Given::Contraction(at.state.contraction);
            let found = muscle
                .solve(Pressure::pa(pressure_pa), given, Approach::Auto)
                .map_err(|error| GasError::Muscle { pressure_pa, error: Box::new(error) })?;
            open.push([percent(at), found.force_n]);
        }
        let lines = vec![("valve open".to_owned(), open), ("valve shut".to_owned(), shut)];
        Ok(Lines { title: self.muscle.clone(), axes: ["contraction [%]", "force [N]"], lines })
    }
}

/// The valve of a filling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Valve {
    /// By its data sheet, after ISO 6358.
    Sheet {
        /// Sonic conductance \[m^3/(s Pa)\].
        conductance: f64,
        /// Critical pressure ratio.
        critical_ratio: f64,
    },
    /// A sharp hole of this diameter \[m\], which must fit into the end of the muscle.
    Hole(f64),
}

/// What the muscle of a filling moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Moves {
    /// Nothing: it is held at this contraction.
    Held(f64),
    /// A force.
    Lifts {
        /// The force \[N\].
        force_n: f64,
        /// From a support at this contraction; by default at 0 for a braid, and none for a pleated muscle.
        support: Option<f64>,
    },
}

/// Filling or venting over time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FillQuestion {
    /// Gauge pressure of the supply \[Pa\]; 0 vents to the ambient.
    pub supply_pa: f64,
    /// Volume of the supply's vessel \[m^3\], if it is none with a constant pressure.
    pub vessel_m3: Option<f64>,
    /// Gauge pressure in the muscle at the start \[Pa\].
    pub start_pa: f64,
    /// The valve.
    pub valve: Valve,
    /// What the muscle moves.
    pub moves: Moves,
    /// The gas keeps its heat; otherwise its temperature.
    pub is_adiabatic: bool,
    /// The longest time \[s\].
    pub longest_s: f64,
    /// Dead volume of fittings and tubes \[m^3\].
    pub dead_volume_m3: f64,
}

/// Answer to a [`FillQuestion`]; it serialises as its JSON document.
#[derive(Debug, Clone, Serialize)]
pub struct FillAnswer {
    schema: &'static str,
    /// Name of the muscle.
    pub muscle: String,
    /// The filling over time.
    pub filling: History,
}

impl FillQuestion {
    /// Answers it for a muscle.
    ///
    /// # Errors
    /// A number is impossible, the hole is wider than the muscle, or the filling stops.
    pub fn answer(&self, muscle: &MuscleWithEffects) -> Result<FillAnswer, QuestionError<GasError>> {
        let temperature_k = AMBIENT_TEMPERATURE_K;
        let pressure_pa = self.supply_pa;
        let supply = match self.vessel_m3 {
            Some(volume_m3) => Supply::Vessel { pressure_pa, temperature_k, volume_m3 },
            None => Supply::Constant { pressure_pa, temperature_k },
        };
        let orifice = match self.valve {
            Valve::Hole(diameter) => hole(muscle, diameter)?,
            Valve::Sheet { conductance, critical_ratio } => Orifice::new(conductance, critical_ratio)?,
        };
        let (load, support) = match self.moves {
            Moves::Held(contraction) => (Load::Held(contraction), None),
            // A braid without pressure carries nothing: its load stands on a support where the muscle has
            // its rest length.
            Moves::Lifts { force_n, support } => {
                (Load::Force(force_n), support.or((!muscle.muscle().is_pleated()).then_some(0.0)))
            }
        };
        let mut chamber = Chamber::muscle(muscle, load)?.with_dead_volume(self.dead_volume_m3)?;
        if let Some(support) = support {
            chamber = chamber.on_support(support)?;
        }
        let filling = Filling {
            chamber,
            orifice,
            supply,
            gas: if self.is_adiabatic { GasModel::adiabatic() } else { GasModel::Isothermal },
            start_pressure_pa: self.start_pa,
            start_temperature_k: temperature_k,
            longest_s: self.longest_s,
            samples: SAMPLES,
        };
        let muscle = muscle.muscle().name().to_owned();
        Ok(FillAnswer { schema: "bulge.filling/1", muscle, filling: filling.run()? })
    }
}

/// A hole, which must fit into the end of the muscle.
fn hole(muscle: &MuscleWithEffects, diameter: f64) -> Result<Orifice, QuestionError<GasError>> {
    let most = 2.0 * muscle.muscle().end_radius().si();
    if diameter > most {
        let what = format!(
            "a hole of {} is wider than the end of {}, {}: give its diameter, such as \"2 mm\"",
            millimetres(diameter),
            muscle.muscle().name(),
            millimetres(most)
        );
        return QuestionError::part("hole", what);
    }
    Ok(Orifice::hole(diameter)?)
}

impl FillAnswer {
    /// The pressure in bar and the contraction in 10 % on one axis.
    #[must_use]
    pub fn drawing(&self) -> Lines {
        let line = |name: &str, read: &dyn Fn(&Sample) -> f64| {
            (name.to_owned(), self.filling.samples.iter().map(|at| [at.time_s, read(at)]).collect())
        };
        let lines = vec![
            line("contraction [10 %]", &|at| 10.0 * at.contraction),
            line("pressure [bar]", &|at| 1e-5 * at.pressure_pa),
        ];
        let axes = ["time [s]", "pressure [bar], contraction [10 %]"];
        Lines { title: self.muscle.clone(), axes, lines }
    }
}

/// Air, energy and efficiency of a stroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrokeQuestion {
    /// Load that is lifted \[N\].
    pub load_n: f64,
    /// From which contraction to which.
    pub stroke: [f64; 2],
    /// Gauge pressure of the supply \[Pa\].
    pub supply_pa: f64,
    /// Filled to this gauge pressure \[Pa\] while held, and moved at it; otherwise the pressure rises with
    /// the load.
    pub pressure_pa: Option<f64>,
    /// Dead volume of fittings and tubes \[m^3\].
    pub dead_volume_m3: f64,
}

/// Answer to a [`StrokeQuestion`]; it serialises as its JSON document.
#[derive(Debug, Clone, Serialize)]
pub struct StrokeAnswer {
    schema: &'static str,
    /// Name of the muscle.
    pub muscle: String,
    /// The cycle.
    pub cycle: CycleResult,
}

impl StrokeQuestion {
    fn on<'a>(&self, muscle: &'a MuscleWithEffects) -> Stroke<'a> {
        let lift = match self.pressure_pa {
            Some(pressure_pa) => Lift::Isobaric { pressure_pa },
            None => Lift::PressureRise,
        };
        let stroke = Stroke::new(muscle, self.load_n, self.stroke, lift, self.supply_pa);
        Stroke { dead_volume_m3: self.dead_volume_m3, ..stroke }
    }

    /// Answers it for a muscle.
    ///
    /// # Errors
    /// As [`Stroke::cycle`].
    pub fn answer(&self, muscle: &MuscleWithEffects) -> Result<StrokeAnswer, GasError> {
        let cycle = self.on(muscle).cycle()?;
        Ok(StrokeAnswer { schema: "bulge.stroke/1", muscle: muscle.muscle().name().to_owned(), cycle })
    }

    /// The pressure as the load rises: the pressures at the end of strokes of increasing length.
    ///
    /// # Errors
    /// As [`Stroke::cycle`].
    pub fn drawing(&self, muscle: &MuscleWithEffects, answer: &StrokeAnswer) -> Result<Lines, GasError> {
        let stroke = self.on(muscle);
        let mut points = vec![[100.0 * stroke.from, 1e-5 * answer.cycle.start_pressure_pa]];
        for k in 1..=RISING {
            let to = stroke.from + (stroke.to - stroke.from) * f64::from(k) / f64::from(RISING);
            points.push([100.0 * to, 1e-5 * Stroke { to, ..stroke }.cycle()?.end_pressure_pa]);
        }
        let lines = vec![("with the load".to_owned(), points)];
        Ok(Lines { title: answer.muscle.clone(), axes: ["contraction [%]", "pressure [bar]"], lines })
    }
}
