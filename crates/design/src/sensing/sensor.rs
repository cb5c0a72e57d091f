//! A winding on a muscle: its resistance at a contraction.

use bulge_fibre::{FibreError, Given, Problem, Response, Shape};
use bulge_model::MuscleWithEffects;
use bulge_muscles::{Pressure, Quantity as _};

use super::channel::{Channel, Totals};
use super::surface::Surface;
use super::winding::number;
use super::{ChannelPoint, Options, Reading, Reference, SensingError, Winding};

/// A muscle at a pressure with a channel of liquid metal around it.
///
/// ```
/// use bulge_design::sensing::{EGAIN_RESISTIVITY_OHM_M, Layer, Options, Range, Reference, Sensor, Winding};
/// use bulge_model::MuscleWithEffects;
/// use bulge_muscles::{Pressure, preset};
///
/// let muscle = MuscleWithEffects::new(&preset("ppam-2-r16")?, &[])?;
/// let winding = Winding {
///     start: 0.3,
///     end: 0.7,
///     turns: 20.0,
///     section_m2: 0.05e-6,
///     offset_m: 0.5e-3,
///     layer: Layer::Thinning,
///     resistivity_ohm_m: EGAIN_RESISTIVITY_OHM_M,
/// };
/// let sensor = Sensor::new(&muscle, Pressure::bar(1.0), winding, Reference::Rest, Options::default())?;
/// let curve = sensor.curve(Range { from: 0.05, to: 0.3, points: 51 })?;
/// let found = sensor.contraction(&curve, sensor.reading(0.2)?.resistance_ohm)?;
/// assert!((found - 0.2).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Sensor {
    muscle: MuscleWithEffects,
    problem: Problem,
    reference: Surface,
    winding: Winding,
    options: Options,
    /// Whole unstretched fibre length \[m\].
    fibre: f64,
    /// Length in the reference \[m\].
    length_0: f64,
}

/// A muscle at a contraction, independent of the winding.
#[derive(Debug, Clone)]
pub(super) struct Pose {
    response: Response,
    surface: Surface,
}

impl Sensor {
    /// A winding on a muscle with its effects, at a gauge pressure. A muscle without effects is
    /// `MuscleWithEffects::new(&muscle, &[])`.
    ///
    /// # Errors
    /// [`SensingError::Input`] for an impossible winding, or if the layer has no room there;
    /// [`SensingError::Equilibrium`] if the muscle has no equilibrium at the reference.
    pub fn new(
        muscle: &MuscleWithEffects,
        pressure: Pressure,
        winding: Winding,
        reference: Reference,
        options: Options,
    ) -> Result<Self, SensingError> {
        options.check()?;
        let own = muscle.parts();
        let sigma = own.angle.cos();
        let (r, fibre) = (own.radius, own.length / sigma);
        winding.check(r)?;
        let unsolved = SensingError::unsolved(pressure, 0.0);
        let problem = Problem::new(own, pressure).map_err(&unsolved)?;
        let reference = match reference {
            Reference::Rest => Surface::Cylinder { r, sigma, fibre },
            Reference::At { pressure, contraction } => {
                let other = problem.at_pressure(pressure).map_err(unsolved)?;
                pose(muscle, &other, &options, fibre, contraction)?.surface
            }
        };
        let muscle = muscle.clone();
        let sensor = Self { muscle, problem, reference, winding, options, fibre, length_0: 0.0 };
        sensor.rewound(winding)
    }

    /// The same muscle with another winding.
    ///
    /// # Errors
    /// As [`Sensor::new`] for the winding.
    pub fn rewound(&self, winding: Winding) -> Result<Self, SensingError> {
        winding.check(self.problem.parts().radius)?;
        let totals = self.reference_totals(&winding)?;
        Ok(Self { winding, length_0: totals.length, ..self.clone() })
    }

    /// The same winding, with the same reference, at another gauge pressure.
    ///
    /// # Errors
    /// [`SensingError::Equilibrium`] if the pressure isn't greater than 0.
    pub fn at_pressure(&self, pressure: Pressure) -> Result<Self, SensingError> {
        let problem = self.problem.at_pressure(pressure).map_err(SensingError::unsolved(pressure, 0.0))?;
        Ok(Self { problem, ..self.clone() })
    }

    /// The winding.
    #[must_use]
    pub const fn winding(&self) -> &Winding {
        &self.winding
    }

    /// Options of the computation.
    #[must_use]
    pub const fn options(&self) -> &Options {
        &self.options
    }

    /// Unpressurised length of the muscle \[m\], which turns a contraction into a shortening.
    #[must_use]
    pub fn muscle_length_m(&self) -> f64 {
        self.problem.parts().length
    }

    /// Gauge pressure \[Pa\].
    #[must_use]
    pub fn pressure_pa(&self) -> f64 {
        self.problem.pressure().si()
    }

    /// Length L0 of the channel in the reference \[m\].
    #[must_use]
    pub const fn reference_length_m(&self) -> f64 {
        self.length_0
    }

    /// Resistance R0 = rho_e L0/A0 in the reference \[ohm\].
    #[must_use]
    pub fn reference_resistance_ohm(&self) -> f64 {
        resistance_of(&self.winding, self.length_0)
    }

    /// The winding at a contraction.
    ///
    /// # Errors
    /// [`SensingError::Equilibrium`], [`SensingError::Input`] if the layer has no room, or
    /// [`SensingError::Overstrained`] beyond [`Options::max_strain`].
    pub fn reading(&self, contraction: f64) -> Result<Reading, SensingError> {
        self.bearable(self.read(&self.winding, self.length_0, &self.pose(contraction)?)?)
    }

    /// The winding on a meridian of the same muscle that was computed elsewhere.
    ///
    /// # Errors
    /// [`SensingError::Input`] if the meridian isn't of the same muscle or has fewer than 7 points; as
    /// [`Sensor::reading`].
    pub fn reading_of(&self, shape: &Shape) -> Result<Reading, SensingError> {
        let surface = Surface::of_shape(shape, self.fibre)?;
        self.bearable(self.read(&self.winding, self.length_0, &Pose { response: shape.response, surface })?)
    }

    /// The channel at a contraction as `count` points equally spaced in s, with stretch and section; from 2
    /// to 1e6 points.
    ///
    /// # Errors
    /// [`SensingError::Input`] for another count or a layer without room, [`SensingError::Equilibrium`].
    /// A strain beyond [`Options::max_strain`] is no error here: the points show where it occurs.
    pub fn channel(&self, contraction: f64, count: usize) -> Result<Vec<ChannelPoint>, SensingError> {
        check_count(count)?;
        self.wound(&self.winding, &self.pose(contraction)?.surface).points(count)
    }

    /// The channel in its reference, as [`Sensor::channel`].
    ///
    /// # Errors
    /// [`SensingError::Input`].
    pub fn reference_channel(&self, count: usize) -> Result<Vec<ChannelPoint>, SensingError> {
        check_count(count)?;
        self.wound(&self.winding, &self.reference).points(count)
    }

    pub(super) fn pose(&self, contraction: f64) -> Result<Pose, SensingError> {
        pose(&self.muscle, &self.problem, &self.options, self.fibre, contraction)
    }

    /// Integrals in the reference, where the stretch is 1; an error if there is no room for the turns.
    pub(super) fn reference_totals(&self, winding: &Winding) -> Result<Totals, SensingError> {
        let totals = self.wound(winding, &self.reference).totals()?;
        winding.check_pitch(totals.meridian_0)?;
        Ok(totals)
    }

    /// Evaluates a winding on a pose, with its length in the reference; the strain isn't limited.
    pub(super) fn read(
        &self,
        winding: &Winding,
        length_0: f64,
        pose: &Pose,
    ) -> Result<Reading, SensingError> {
        let totals = self.wound(winding, &pose.surface).totals()?;
        let resistance_ohm = resistance_of(winding, totals.stretched);
        let reference_ohm = resistance_of(winding, length_0);
        let mean_stretch = totals.length / length_0;
        let [largest, at] = totals.largest;
        Ok(Reading {
            pressure_pa: pose.response.pressure_pa,
            contraction: pose.response.contraction,
            muscle_length_m: pose.response.length_m,
            channel_length_m: totals.length,
            resistance_ohm,
            relative_change: resistance_ohm / reference_ohm - 1.0,
            uniform_resistance_ohm: reference_ohm * mean_stretch * mean_stretch,
            mean_stretch,
            largest_strain: largest - 1.0,
            largest_strain_at: at,
            smallest_strain: totals.smallest - 1.0,
            smallest_section_m2: winding.section_m2 / largest,
            liquid_m3: winding.section_m2 * totals.unstretched,
        })
    }

    /// An error if the strain exceeds what the elastomer can bear.
    pub(super) fn bearable(&self, reading: Reading) -> Result<Reading, SensingError> {
        let Reading { contraction, largest_strain: strain, largest_strain_at: at, .. } = reading;
        let allowed = self.options.max_strain;
        if strain > allowed {
            return Err(SensingError::Overstrained { contraction, strain, at, allowed });
        }
        Ok(reading)
    }

    fn wound<'a>(&'a self, winding: &'a Winding, surface: &'a Surface) -> Channel<'a> {
        Channel { winding, surface, reference: &self.reference, fibre: self.fibre }
    }
}

/// Refuses an impossible number of points of a channel.
fn check_count(count: usize) -> Result<(), SensingError> {
    number("number of points of the channel", count as f64, "from 2 to 1e6", |_| {
        (2..=1_000_000).contains(&count)
    })
}

/// Resistance \[ohm\] from the integral of lambda dL \[m\].
fn resistance_of(winding: &Winding, stretched_m: f64) -> f64 {
    winding.resistivity_ohm_m * stretched_m / winding.section_m2
}

/// The surface at a contraction relative to the stated length of the muscle.
fn pose(
    muscle: &MuscleWithEffects,
    problem: &Problem,
    options: &Options,
    fibre: f64,
    contraction: f64,
) -> Result<Pose, SensingError> {
    let unsolved = SensingError::unsolved(problem.pressure(), contraction);
    if !contraction.is_finite() {
        return Err(unsolved(FibreError::NotFinite { what: "contraction", value: contraction }));
    }
    let shape = problem
        .shape(muscle.given(Given::Contraction(contraction)), options.approach, options.points)
        .map_err(unsolved)?;
    let surface = Surface::of_shape(&shape, fibre)?;
    Ok(Pose { response: Response { contraction, ..shape.response }, surface })
}
