//! The question of a sensor: a winding, a range of contractions, and the noise of the reading. Its answer is
//! a JSON document.

use bulge_model::MuscleWithEffects;
use bulge_muscles::Pressure;
use serde::Serialize;
use std::f64::consts::PI;

use super::{
    Curve, EGAIN_RESISTIVITY_OHM_M, Goal, Layer, Options, Place, Placement, Range, Reference, Resolution,
    Search, SensingError, Sensor, Winding,
};
use crate::question::Lines;

/// Units of a resistance, in ohm.
pub const RESISTANCE_UNITS: [(&str, f64); 4] = [("ohm", 1.0), ("mohm", 1e-3), ("uohm", 1e-6), ("kohm", 1e3)];
/// Centres in the search for the best zone.
const CENTRES: usize = 81;

/// A channel of liquid metal wound around a muscle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SenseQuestion {
    /// Gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contractions to measure.
    pub range: Range,
    /// Turns of the channel.
    pub turns: f64,
    /// Where it is wound, from a fitting, in parts of the fibre's length.
    pub zone: [f64; 2],
    /// Diameter of the channel, round, as it is made \[m\].
    pub channel_m: f64,
    /// How far its centre lies outside the fibres \[m\].
    pub offset_m: f64,
    /// Standard deviation of the resistance that is read \[ohm\].
    pub noise_ohm: f64,
    /// Width of a zone whose best place is sought.
    pub best: Option<f64>,
    /// Gauge factor of at least so much, and as straight as can be; otherwise the most sensitive place.
    pub least_gauge_factor: Option<f64>,
}

/// Answer to a [`SenseQuestion`].
#[derive(Debug, Clone)]
pub struct SenseAnswer {
    /// Name of the muscle.
    pub muscle: String,
    /// The sensor, in the best place if that was sought.
    pub sensor: Sensor,
    /// Its characteristic.
    pub curve: Curve,
    /// What the noise makes of the contraction.
    pub resolution: Resolution,
    /// The search for the best place.
    pub placed: Option<Placement>,
}

/// The JSON document of an answer.
#[derive(Debug, Serialize)]
pub struct SenseDocument<'a> {
    schema: &'static str,
    muscle: &'a str,
    winding: &'a Winding,
    curve: &'a Curve,
    resolution: &'a Resolution,
    scanned: Option<&'a [Place]>,
}

impl SenseQuestion {
    /// Answers it for a muscle.
    ///
    /// # Errors
    /// [`SensingError`].
    pub fn answer(&self, muscle: &MuscleWithEffects) -> Result<SenseAnswer, SensingError> {
        let pressure = Pressure::pa(self.pressure_pa);
        let sensor = Sensor::new(muscle, pressure, self.winding(), Reference::Rest, Options::default())?;
        let placed = self.best.map(|width| sensor.best_place(&self.search(width))).transpose()?;
        let sensor = match &placed {
            Some(placed) => sensor.rewound(placed.winding)?,
            None => sensor,
        };
        let curve = sensor.curve(self.range)?;
        let resolution = curve.resolution(self.noise_ohm)?;
        Ok(SenseAnswer { muscle: muscle.muscle().name().to_owned(), sensor, curve, resolution, placed })
    }

    fn winding(&self) -> Winding {
        let [start, end] = self.zone;
        Winding {
            start,
            end,
            turns: self.turns,
            section_m2: 0.25 * PI * self.channel_m * self.channel_m.abs(),
            offset_m: self.offset_m,
            layer: Layer::Thinning,
            resistivity_ohm_m: EGAIN_RESISTIVITY_OHM_M,
        }
    }

    fn search(&self, width: f64) -> Search {
        let goal = match self.least_gauge_factor {
            Some(least_sensitivity) => Goal::MostLinear { least_sensitivity },
            None => Goal::MostSensitive,
        };
        Search { range: self.range, widths: [width; 2], width_steps: 1, centres: CENTRES, goal }
    }
}

impl SenseAnswer {
    /// The JSON document.
    #[must_use]
    pub fn document(&self) -> SenseDocument<'_> {
        SenseDocument {
            schema: "bulge.sensing/1",
            muscle: &self.muscle,
            winding: self.sensor.winding(),
            curve: &self.curve,
            resolution: &self.resolution,
            scanned: self.placed.as_ref().map(|placed| &placed.scanned[..]),
        }
    }

    /// The curve and the best straight line.
    #[must_use]
    pub fn drawing(&self) -> Lines {
        let read: Vec<[f64; 2]> =
            self.curve.readings.iter().map(|at| [100.0 * at.contraction, at.resistance_ohm]).collect();
        let mut lines = Vec::new();
        if let Some(line) = &self.curve.linearity {
            let ends = [read.first(), read.last()].into_iter().flatten();
            let points = ends.map(|[x, _]| [*x, line.intercept_ohm + line.slope_ohm * x / 100.0]).collect();
            lines.push(("best straight line".to_owned(), points));
        }
        lines.push(("channel".to_owned(), read));
        Lines { title: self.muscle.clone(), axes: ["contraction [%]", "resistance [ohm]"], lines }
    }
}
