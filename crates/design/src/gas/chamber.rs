//! The chamber of the gas: a muscle on its load with the dead volume of its tubes, or a rigid vessel.
//!
//! ```text
//! F(p, e) = load(e)              gives e(p) of a muscle on a load, quasi-static
//! F(p, e) <= load(e), e = e1     on a support at e1: this carries the rest of the load
//! P (V(p, e(p)) + Vd)^n = exp(z) gives p: one root, since V grows with p as long as the muscle pulls
//! ```

use bulge_fibre::{Approach, Given, Response};
use bulge_model::MuscleWithEffects;
use bulge_muscles::Pressure;
use bulge_numerics::root::{RootError, newton_bracketed};
use serde::Serialize;

use super::muscle::{Lowest, failed, follow, is_scale_free, load_at};
use super::surroundings::Surroundings;
use super::{GasError, at_least, finite, positive};

/// Least gauge pressure \[Pa\] at which a muscle is solved, because there is no equilibrium at zero pressure.
/// Below it, the shape is that at this pressure.
///
/// The force is proportional to the pressure if nothing but the pressure shapes the muscle, and otherwise
/// that at this pressure.
pub const LEAST_PRESSURE_PA: f64 = 100.0;

/// Tolerance of a Newton step of the contraction. The error after the step is of the order of its square.
const CONTRACTION_TOLERANCE: f64 = 1e-9;
/// Most solves for a load that decreases with the contraction.
const MOST_SOLVES: u32 = 300;
/// Most pressures without equilibrium that a search for the pressure may meet.
const MOST_FAILURES: u32 = 16;

/// Load of a muscle.
#[derive(Clone, Copy)]
pub enum Load<'a> {
    /// The muscle is held at this contraction.
    Held(f64),
    /// A constant force \[N\].
    Force(f64),
    /// A spring that the muscle stretches: preload + rate l0 (e - from).
    Spring {
        /// Force at the contraction `from` \[N\].
        preload_n: f64,
        /// Spring rate \[N/m\].
        rate_n_per_m: f64,
        /// Contraction at which the preload acts.
        from: f64,
    },
    /// Any force \[N\] as a function of the contraction.
    Law(&'a dyn Fn(f64) -> f64),
}

impl std::fmt::Debug for Load<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Held(contraction) => write!(f, "Held({contraction})"),
            Self::Force(force) => write!(f, "Force({force})"),
            Self::Spring { preload_n, rate_n_per_m, from } => {
                write!(f, "Spring({preload_n} N + {rate_n_per_m} N/m from {from})")
            }
            Self::Law(_) => f.write_str("Law(..)"),
        }
    }
}

/// A state of a chamber.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Inside {
    /// Gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Contraction; 0 for a vessel.
    pub contraction: f64,
    /// Pull of the muscle \[N\]; 0 for a vessel.
    pub force_n: f64,
    /// Volume of the muscle, or of the vessel \[m^3\].
    pub volume_m3: f64,
    /// This volume and the dead volume \[m^3\].
    pub gas_volume_m3: f64,
}

impl Inside {
    pub(crate) const fn of(pressure_pa: f64, found: &Response, around: &Surroundings) -> Self {
        let Response { contraction, force_n, volume_m3, .. } = *found;
        Self { pressure_pa, contraction, force_n, volume_m3, gas_volume_m3: around.gas_volume(volume_m3) }
    }
}

#[derive(Debug, Clone, Copy)]
enum Body<'a> {
    Vessel(f64),
    Muscle { muscle: &'a MuscleWithEffects, load: Load<'a>, support: Option<f64> },
}

/// Chamber of the gas.
#[derive(Debug, Clone, Copy)]
pub struct Chamber<'a> {
    body: Body<'a>,
    surroundings: Surroundings,
    approach: Approach,
    /// For a muscle with a bladder that is held or supported: the lowest pressure at which its fibres are
    /// taut.
    lowest: Option<Lowest>,
}

impl<'a> Chamber<'a> {
    /// A rigid vessel.
    ///
    /// # Errors
    /// [`GasError::Number`] unless the volume \[m^3\] is positive.
    pub fn vessel(volume_m3: f64) -> Result<Self, GasError> {
        positive("the volume of the vessel [m^3]", volume_m3)?;
        Ok(Self::of(Body::Vessel(volume_m3)))
    }

    /// A muscle on a load, with no dead volume.
    ///
    /// # Errors
    /// [`GasError::Number`] if a number of the load is not finite.
    pub fn muscle(muscle: &'a MuscleWithEffects, load: Load<'a>) -> Result<Self, GasError> {
        let numbers = match load {
            Load::Held(value) | Load::Force(value) => [value, 0.0, 0.0],
            Load::Spring { preload_n, rate_n_per_m, from } => [preload_n, rate_n_per_m, from],
            Load::Law(_) => [0.0; 3],
        };
        for value in numbers {
            finite("a number of the load", value)?;
        }
        Ok(Self::of(Body::Muscle { muscle, load, support: None }).looked_at())
    }

    const fn of(body: Body<'a>) -> Self {
        Self { body, surroundings: Surroundings::STANDARD, approach: Approach::Auto, lowest: None }
    }

    /// Looks up the lowest pressure with taut fibres at the contraction at which the muscle is held.
    fn looked_at(mut self) -> Self {
        let held = match self.body {
            Body::Muscle { muscle, load: Load::Held(contraction), .. }
            | Body::Muscle { muscle, support: Some(contraction), .. } => Some((muscle, contraction)),
            _ => None,
        };
        self.lowest = held.and_then(|(muscle, contraction)| Lowest::of(muscle, contraction, self.approach));
        self
    }

    /// The chamber with the dead volume \[m^3\] of tubes and fittings.
    ///
    /// # Errors
    /// [`GasError::Number`] unless it is finite and not negative.
    pub fn with_dead_volume(mut self, volume_m3: f64) -> Result<Self, GasError> {
        self.surroundings = self.surroundings.with_dead_volume(volume_m3)?;
        Ok(self)
    }

    /// The chamber at another ambient pressure \[Pa\], absolute.
    ///
    /// # Errors
    /// [`GasError::Number`] unless it is positive.
    pub fn with_ambient(mut self, pressure_pa: f64) -> Result<Self, GasError> {
        self.surroundings = self.surroundings.with_ambient(pressure_pa)?;
        Ok(self)
    }

    /// The chamber with the given surroundings, which have been checked.
    pub(super) const fn within(mut self, surroundings: Surroundings) -> Self {
        self.surroundings = surroundings;
        self
    }

    /// Puts the load on a support at this contraction until the muscle lifts it. A vessel or a held muscle is
    /// not changed.
    ///
    /// # Errors
    /// [`GasError::Number`] unless it is finite and below 1.
    pub fn on_support(mut self, contraction: f64) -> Result<Self, GasError> {
        if !(contraction.is_finite() && contraction < 1.0) {
            return Err(GasError::number(
                "the contraction of the support [%]",
                contraction,
                "give a finite number below 1",
            ));
        }
        if let Body::Muscle { support, load, .. } = &mut self.body
            && !matches!(load, Load::Held(_))
        {
            *support = Some(contraction);
        }
        Ok(self.looked_at())
    }

    /// The chamber with another solution method.
    #[must_use]
    pub fn solved_by(mut self, approach: Approach) -> Self {
        self.approach = approach;
        self.looked_at()
    }

    /// Ambient pressure \[Pa\].
    #[must_use]
    pub const fn ambient_pa(&self) -> f64 {
        self.surroundings.ambient_pa
    }

    pub(super) const fn support(&self) -> Option<f64> {
        match self.body {
            Body::Muscle { support, .. } => support,
            Body::Vessel(_) => None,
        }
    }

    pub(super) const fn dead_volume_m3(&self) -> f64 {
        self.surroundings.dead_volume_m3
    }

    pub(super) const fn is_vessel(&self) -> bool {
        matches!(self.body, Body::Vessel(_))
    }

    /// Load on the support \[N\]. The muscle lifts it when it pulls more. None without a support.
    pub(super) fn load_on_support(&self) -> Option<f64> {
        let Body::Muscle { load, muscle, support } = &self.body else { return None };
        support.map(|support| load_at(load, muscle, support))
    }

    /// The state at a gauge pressure \[Pa\], which must be >= 0 for a muscle and above minus the ambient
    /// pressure for a vessel.
    ///
    /// # Errors
    /// [`GasError::Number`], [`GasError::Muscle`] if there is no equilibrium, or [`GasError::NoBalance`].
    pub fn at(&self, pressure_pa: f64) -> Result<Inside, GasError> {
        let low = if self.is_vessel() { -self.ambient_pa() } else { 0.0 };
        at_least(
            "the gauge pressure [Pa]",
            pressure_pa,
            low,
            "give one from 0 on (a vessel: an absolute one)",
        )?;
        self.inside(pressure_pa, self.rests(pressure_pa)?, None)
    }

    /// Whether the load stands on its support.
    pub(super) fn rests(&self, pressure_pa: f64) -> Result<bool, GasError> {
        let Some(load) = self.load_on_support() else { return Ok(false) };
        Ok(self.inside(pressure_pa, true, None)?.force_n < load)
    }

    /// The state on the support or off it, off it optionally near a known contraction. A search may try
    /// slightly negative pressures; they count as zero.
    pub(super) fn inside(
        &self,
        pressure_pa: f64,
        resting: bool,
        near: Option<f64>,
    ) -> Result<Inside, GasError> {
        let Body::Muscle { muscle, load, support } = self.body else {
            let Body::Vessel(volume_m3) = self.body else { return Err(unreal(pressure_pa)) };
            if pressure_pa <= -self.ambient_pa() || pressure_pa.is_nan() {
                return Err(unreal(pressure_pa));
            }
            let gas_volume_m3 = self.surroundings.gas_volume(volume_m3);
            return Ok(Inside { pressure_pa, contraction: 0.0, force_n: 0.0, volume_m3, gas_volume_m3 });
        };
        if pressure_pa.is_nan() || pressure_pa < -LEAST_PRESSURE_PA {
            return Err(unreal(pressure_pa));
        }
        let found = match (load, support) {
            (Load::Held(contraction), _) => self.held(muscle, pressure_pa, contraction)?,
            (_, Some(support)) if resting => self.held(muscle, pressure_pa, support)?,
            _ => self.balance(muscle, &load, pressure_pa.max(LEAST_PRESSURE_PA), near)?,
        };
        Ok(Inside::of(pressure_pa, &found, &self.surroundings))
    }

    /// The state at a prescribed contraction, where a muscle with a bladder may push.
    fn held(
        &self,
        muscle: &MuscleWithEffects,
        pressure_pa: f64,
        contraction: f64,
    ) -> Result<Response, GasError> {
        let pressure = pressure_pa.max(LEAST_PRESSURE_PA);
        if let Some(lowest) = self.lowest.filter(|lowest| lowest.is_above(pressure)) {
            return Ok(lowest.down_to(pressure));
        }
        let mut found = follow(muscle, pressure, contraction, self.approach)?;
        if pressure_pa < pressure && is_scale_free(muscle)? {
            found.force_n *= pressure_pa.max(0.0) / pressure;
        }
        Ok(found)
    }

    /// The state in which pull and load are equal, by Newton's method from a known contraction or without
    /// one.
    fn balance(
        &self,
        muscle: &MuscleWithEffects,
        load: &Load<'_>,
        pressure_pa: f64,
        near: Option<f64>,
    ) -> Result<Response, GasError> {
        let solve = |given| {
            muscle
                .solve(Pressure::pa(pressure_pa), given, self.approach)
                .map_err(|error| failed(pressure_pa, error))
        };
        let excess = |e: f64| {
            let (found, h) = (solve(Given::Contraction(e))?, 1e-6);
            let l0 = found.length_m / (1.0 - found.contraction);
            let slope = (load_at(load, muscle, e + h) - load_at(load, muscle, e - h)) / (2.0 * h);
            Ok::<_, GasError>((
                found.force_n - load_at(load, muscle, e),
                -found.stiffness_n_per_m * l0 - slope,
            ))
        };
        // If Newton's method leaves the neighbourhood, the general search below takes over.
        if let Some(mut e) = near {
            for _ in 0..8 {
                let Ok((value, slope)) = excess(e) else { break };
                let step = -value / slope;
                if slope >= 0.0 || step.abs() > 0.05 || !step.is_finite() {
                    break;
                }
                e += step;
                if step.abs() < CONTRACTION_TOLERANCE {
                    return solve(Given::Contraction(e));
                }
            }
        }
        if let Load::Force(force) = load {
            return solve(Given::Force(*force));
        }
        let no_balance = |e: f64| {
            GasError::NoBalance(format!(
                "at the gauge pressure {} the pull equals the load at no contraction (last tried: {:.4} %, load {} N): give the load a support, or one that the muscle can carry",
                Pressure::pa(pressure_pa),
                100.0 * e,
                load_at(load, muscle, e)
            ))
        };
        // No muscle pulls beyond its limit, so the load exceeds the pull there, and the balance lies at a
        // smaller contraction.
        let limit = solve(Given::Force(0.0))?.contraction;
        let load_n = load_at(load, muscle, limit);
        if !(load_n >= 0.0 && load_n.is_finite()) {
            return Err(no_balance(limit));
        }
        let mut found = solve(Given::Force(load_n))?;
        if found.force_n - load_at(load, muscle, found.contraction) < 0.0 {
            // For a load that decreases with the contraction, search downwards from the limit to the first
            // balance.
            for _ in 0..MOST_SOLVES {
                let last = found.contraction;
                found = solve(Given::Force(load_at(load, muscle, last)))?;
                if (found.contraction - last).abs() < 1e-12 {
                    return Ok(found);
                }
            }
            return Err(no_balance(found.contraction));
        }
        let low = found.contraction;
        match newton_bracketed(excess, low, limit, low, [CONTRACTION_TOLERANCE, 0.0]) {
            Ok(e) => solve(Given::Contraction(e)),
            Err(RootError::Function(error)) => Err(error),
            Err(RootError::Budget { at, .. }) => Err(no_balance(at)),
        }
    }
}

/// The state whose gas has z = ln P + n ln(V + Vd). The search starts from a gauge pressure \[Pa\].
///
/// With u = ln P and g(u) = u + n ln(V + Vd) - z, the root lies between u and u - g(u), because the slope of
/// g is at least 1. Secants are taken inside this bracket.
pub(super) fn with_gas(
    inside: impl Fn(f64) -> Result<Inside, GasError>,
    ambient_pa: f64,
    [z, n]: [f64; 2],
    start_pa: f64,
) -> Result<Inside, GasError> {
    let value = |u: f64| {
        let inside = inside(u.exp() - ambient_pa)?;
        Ok::<_, GasError>((u + n * inside.gas_volume_m3.ln() - z, inside))
    };
    let mut u = (start_pa + ambient_pa).ln();
    let (mut g, mut inside) = value(u)?;
    let mut other: Option<(f64, f64)> = None;
    let mut step = -g;
    let mut reason = "no end".to_owned();
    let mut failures = 0;
    for _ in 0..100 {
        if step.abs() < 1e-12 {
            // The step has been halved until it vanished: the root lies where there is no equilibrium.
            if g.abs() > 1e-9 {
                break;
            }
            return Ok(inside);
        }
        match value(u + step) {
            Ok((next, found)) => {
                // Illinois method: the function value at an end of the bracket is halved if that end stays.
                other = match other {
                    Some((v, gv)) if next * g > 0.0 && gv * g < 0.0 => Some((v, 0.5 * gv)),
                    _ => Some((u, g)),
                };
                (u, g, inside) = (u + step, next, found);
                let flat = if let Some((v, gv)) = other { (u - v) / (g - gv) } else { 1.0 };
                step = -g * if flat.is_finite() { flat } else { 1.0 };
            }
            Err(error) => {
                reason = error.to_string();
                failures += 1;
                step *= 0.5;
            }
        }
        if !g.is_finite() || failures > MOST_FAILURES {
            break;
        }
    }
    if g.abs() < 1e-11 {
        return Ok(inside);
    }
    let pressure_pa = (u + step).exp() - ambient_pa;
    Err(GasError::NoBalance(format!(
        "no gauge pressure above 0 satisfies the law of the enclosed gas (last tried: {}): start with a higher pressure, or ask for a contraction nearer to that of the filling ({reason})",
        Pressure::pa(pressure_pa)
    )))
}

fn unreal(value: f64) -> GasError {
    GasError::number("the gauge pressure [Pa]", value, "a muscle holds none below the ambient")
}
