//! The public trait of an effect, and the states that effects read and change along a measured history.

use bulge_fibre::Parts;
pub use bulge_fibre::{Jet, LANES};
use bulge_muscles::{Kind, Muscle, MuscleError, Parameter, Quantity};
use bulge_numerics::Real;
use std::fmt::Debug;

use crate::card::{Card, ParameterCard, Stage};

/// One measured moment: the readings of a row and its history, before any model is evaluated. In SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Gauge pressure reading \[Pa\].
    pub pressure: f64,
    /// Contraction reading \[-\].
    pub contraction: f64,
    /// +1 while shortening, -1 while lengthening, 0 at rest, at held length or in a static map. Friction
    /// outside the muscle follows it.
    pub direction: f64,
    /// +1 while the pressure rises, -1 while it falls, 0 while it is held.
    pub pressure_direction: f64,
    /// d(contraction)/dt \[1/s\]; 0 without time.
    pub rate: f64,
    /// d(pressure)/dt \[Pa/s\]; 0 without time.
    pub pressure_rate: f64,
    /// Time since the sweep began \[s\]; 0 without time.
    pub time: f64,
    /// Time since the first row of the file \[s\]; 0 without time.
    pub clock: f64,
    /// Time since the previous row \[s\]; 0 for the first row of a sweep and without time.
    pub since: f64,
    /// Change of the contraction since the previous row; 0 for the first row of a sweep.
    pub step: f64,
    /// Change of the pressure since the previous row \[Pa\]; 0 for the first row of a sweep and while the
    /// pressure is held.
    pub pressure_step: f64,
    /// Temperature above that of the first row \[K\]; 0 without a temperature column.
    pub temperature: f64,
    /// Number of loops so far, from 0, including the completed part of the current one: half a loop at the
    /// far end.
    pub cycle: f64,
    /// Largest contraction so far in the sweep, including this row.
    pub largest: f64,
    /// Whether the row begins a sweep, where memory is reset.
    pub begins: bool,
    /// Index of the specimen, from 0.
    pub specimen: u32,
}

impl Moment {
    /// A moment at rest, such as a point of a static map.
    #[must_use]
    pub const fn at_rest(pressure: f64, contraction: f64) -> Self {
        Self {
            pressure,
            contraction,
            direction: 0.0,
            pressure_direction: 0.0,
            rate: 0.0,
            pressure_rate: 0.0,
            time: 0.0,
            clock: 0.0,
            since: 0.0,
            step: 0.0,
            pressure_step: 0.0,
            temperature: 0.0,
            cycle: 0.0,
            largest: contraction,
            begins: true,
            specimen: 0,
        }
    }

    /// The branch of a loop: the direction of the length, or that of the pressure if the length is held.
    #[must_use]
    pub fn branch(&self) -> f64 {
        if self.direction == 0.0 { self.pressure_direction } else { self.direction }
    }
}

/// The muscle's numbers that effects need. In SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Family of the muscle.
    pub kind: Kind,
    /// Unpressurised length l0 \[m\].
    pub length: f64,
    /// Pleated: fibre radius at the fittings; braided: braid radius r0 \[m\].
    pub radius: f64,
    /// Braid angle alpha0 \[rad\]; 0 if pleated.
    pub braid_angle: f64,
    /// Number of fibres, if known.
    pub fibres: Option<u32>,
    /// Whether the equilibrium includes a bladder or a user's own wall energy.
    pub has_bladder: bool,
}

impl Setting {
    /// The setting of a muscle.
    #[must_use]
    pub fn of(muscle: &Muscle) -> Self {
        Self {
            kind: muscle.kind(),
            length: muscle.length().si(),
            radius: muscle.radius().si(),
            braid_angle: muscle.get(Parameter::BraidAngle).unwrap_or(0.0),
            fibres: muscle.fibres(),
            has_bladder: muscle.bladder_wall().is_some(),
        }
    }

    /// Whether the muscle is pleated.
    #[must_use]
    pub fn is_pleated(&self) -> bool {
        self.kind.is_pleated()
    }

    /// The setting with the fibres and the bladder of parts that effects have changed.
    #[must_use]
    pub fn with(self, parts: &Parts) -> Self {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of at least 3")]
        let fibres = parts.fibres.map(|count| count.round() as u32);
        Self { fibres, has_bladder: parts.rubber.is_some() || parts.energy.is_some(), ..self }
    }
}

/// The input of the muscle. Input effects change it before the equilibrium is solved.
///
/// ```text
/// F = wall B(pressure area/wall, e),    e = contraction + give_force(F) + give_tension(N),    averaged over e + spread z
/// ```
/// Here B is the base law, N the meridional force at mid-length and z a standard normal number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// True gauge pressure in the muscle \[Pa\].
    pub pressure: Jet,
    /// True contraction \[-\].
    pub contraction: Jet,
    /// Factor on the area on which the pressure acts. Without effects it is 1.
    pub area: Jet,
    /// Factor on the moduli of bladder and cloth (and of fibres that stretch). Without effects it is 1.
    pub wall: Jet,
    /// Standard deviation of the fibre lengths over l0. Without effects it is 0.
    pub spread: Jet,
    /// Contraction under the force that the displacement sensor doesn't see. Without effects there is none.
    pub give_force: Give,
    /// Contraction of the muscle under the meridional force at mid-length. Without effects there is none.
    pub give_tension: Give,
}

/// Contraction under a load L \[N\].
///
/// ```text
/// give(L) = linear L + joint L (|L|/1 kN)^(power - 1)
/// ```
/// Below [`Give::SEATED`] a joint has the stiffness it has there. A power below one would otherwise leave it
/// without stiffness at zero load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Give {
    /// Compliance of the parts that give in proportion to the load \[1/N\].
    pub linear: Jet,
    /// Secant compliance of a joint at 1 kN \[1/N\].
    pub joint: Jet,
    /// Power of the load with which the joint gives. Without effects it is 1.
    pub power: Jet,
}

impl Give {
    /// The load at which a joint's compliance is stated \[N\].
    pub const REFERENCE: f64 = 1e3;
    /// The load from which a joint counts as seated \[N\], about that of its own weight and a hand-tight
    /// screw.
    pub const SEATED: f64 = 1.0;

    /// No compliance.
    #[inline]
    #[must_use]
    pub fn none() -> Self {
        let [zero, power] = [0.0, 1.0].map(Jet::from);
        Self { linear: zero, joint: zero, power }
    }

    /// Whether there is no compliance and no derivative of it.
    #[inline]
    #[must_use]
    pub fn is_none(&self) -> bool {
        let still = |x: &Jet| x.value() == 0.0 && x.gradient().iter().all(|d| *d == 0.0);
        still(&self.linear) && still(&self.joint)
    }

    /// The contraction under a load \[N\].
    #[must_use]
    pub fn under(&self, load: Jet) -> Jet {
        let seated = (load.squared() + Self::SEATED * Self::SEATED) / (Self::REFERENCE * Self::REFERENCE);
        load * (self.linear + self.joint * ((self.power - 1.0) * 0.5 * seated.ln()).exp())
    }

    /// The derivative of the contraction by the load \[1/N\].
    #[must_use]
    pub fn slope(&self, load: f64) -> f64 {
        let (squared, bend) = (load * load + Self::SEATED * Self::SEATED, self.power.value() - 1.0);
        let secant = self.joint.value() * (squared.sqrt() / Self::REFERENCE).powf(bend);
        self.linear.value() + secant * (1.0 + bend * load * load / squared)
    }
}

impl Input {
    /// The input that equals the readings.
    #[inline]
    #[must_use]
    pub fn of(pressure: Jet, contraction: Jet) -> Self {
        let [zero, one] = [0.0, 1.0].map(Jet::from);
        Self {
            pressure,
            contraction,
            area: one,
            wall: one,
            spread: zero,
            give_force: Give::none(),
            give_tension: Give::none(),
        }
    }

    /// Multiplies the force of the equilibrium. Since `F = wall B(pressure area/wall, e)`, this multiplies
    /// both factors.
    pub fn multiply_force(&mut self, factor: Jet) {
        self.wall = self.wall * factor;
        self.area = self.area * factor;
    }

    /// Multiplies the modulus of the bladder, or the force if the equilibrium has no bladder.
    pub fn multiply_modulus(&mut self, factor: Jet, setting: &Setting) {
        if setting.has_bladder {
            self.wall = self.wall * factor;
        } else {
            self.multiply_force(factor);
        }
    }
}

/// The equilibrium at the input. Load effects read it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// True gauge pressure in the muscle \[Pa\].
    pub pressure: Jet,
    /// True contraction \[-\].
    pub contraction: Jet,
    /// Axial force of the equilibrium \[N\].
    pub force: Jet,
    /// Meridional force at mid-length, F + p A(r) \[N\].
    pub tension: Jet,
    /// Radius at mid-length \[m\].
    pub mid_radius: Jet,
    /// Enclosed volume \[m^3\].
    pub volume: Jet,
    /// dF/d(contraction) of the equilibrium \[N\]. It carries no derivatives.
    pub slope: f64,
    /// Turn of the strands at mid-length since the previous row, as the contraction that turns them by the
    /// same angle \[-\].
    ///
    /// At held pressure it is the change of the contraction. At held length the strands turn because fibres
    /// stretch and because the bladder bears a smaller part of a higher pressure. A net of rigid fibres
    /// without a bladder doesn't turn at all.
    pub turn: Jet,
}

/// The inputs of an effect for one row, and its memory.
#[derive(Debug)]
pub struct Row<'a> {
    /// The readings of the row and its history.
    pub moment: &'a Moment,
    /// The muscle's numbers.
    pub setting: &'a Setting,
    /// The parameters of the effect, in SI.
    pub theta: &'a [Jet],
    /// The [`Effect::memory`] numbers that the effect carries from row to row. They are 0 at the beginning of
    /// a sweep.
    pub memory: &'a mut [Jet],
}

/// The action of an effect, by its place in the chain from the set values to the readings.
#[derive(Debug, Clone, Copy)]
pub enum Action<'a> {
    /// Changes the muscle whose equilibrium is solved.
    Shape(&'a dyn ShapeEffect),
    /// Changes the input of that muscle.
    Input(&'a dyn InputEffect),
    /// Adds a force to that of the equilibrium.
    Load(&'a dyn LoadEffect),
    /// Changes the reading of the load cell.
    Output(&'a dyn OutputEffect),
}

impl Action<'_> {
    /// The place in the chain.
    #[must_use]
    pub const fn stage(&self) -> Stage {
        match self {
            Self::Shape(_) => Stage::Shape,
            Self::Input(_) => Stage::Input,
            Self::Load(_) => Stage::Load,
            Self::Output(_) => Stage::Output,
        }
    }
}

/// An effect that changes the parts of the muscle whose equilibrium is solved.
pub trait ShapeEffect: Debug + Sync {
    /// Changes the parts. `theta` are the parameters of the effect in SI, and numbers that depend on them
    /// carry their derivatives.
    ///
    /// At the parameters `off` the parts must stay unchanged, whatever they state. Any other value replaces the
    /// stated one (a depth), or is added to it (an error of a stated number). An effect without parameters has
    /// no `off`: it is either present or absent.
    ///
    /// If a part is absent when the effect is off (the rubber of a bladder), the effect may add it with size
    /// 0 when `theta` carries derivatives. If no part depends on a parameter at `off` to first order because
    /// the force is even in it (an angle), callers take the derivative at a small value beside `off`. A
    /// parameter that is absent at 0 and has no small values either (a circumference) starts at its `typical`
    /// value.
    ///
    /// # Errors
    /// If the effect doesn't fit the muscle, or not with these values.
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError>;

    /// Changes the input if the change of shape affects it: contractions, for example, refer to the length.
    /// By default it does nothing.
    fn act(&self, row: Row<'_>, input: &mut Input) {
        let _ = (row, input);
    }
}

/// An effect that changes the input of the muscle.
pub trait InputEffect: Debug + Sync {
    /// Changes the input of a row. Each row comes once, in order. At the parameters `off` nothing may change,
    /// bit for bit.
    fn act(&self, row: Row<'_>, input: &mut Input);
}

/// An effect that adds a force.
pub trait LoadEffect: Debug + Sync {
    /// Adds its force to those of the other effects \[N\]. Each row comes once, in order. At the parameters
    /// `off` nothing may change, bit for bit.
    fn act(&self, row: Row<'_>, balance: &Balance, force: &mut Jet);
}

/// An effect that changes the reading of the load cell.
pub trait OutputEffect: Debug + Sync {
    /// Changes the reading \[N\]. Each row comes once, in order. At the parameters `off` nothing may change,
    /// bit for bit.
    fn act(&self, row: Row<'_>, balance: &Balance, reading: &mut Jet);
}

/// A physical effect.
///
/// Each built-in effect is one file in this crate. Any other Rust type can be an effect too and enters the
/// same list ([`crate::Catalogue::with`]), so that help, fits, rankings and reports treat it alike.
///
/// ```
/// use bulge_effects::{Action, Balance, Card, Catalogue, Effect, Evidence, Form, Group, Jet, LoadEffect, Mechanism, Needs, ParameterCard, Parity, Row, Signature};
///
/// /// A hose that pulls like a spring.
/// #[derive(Debug)]
/// struct Hose;
///
/// impl Effect for Hose {
///     fn card(&self) -> Card<'_> {
///         Card {
///             name: "hose",
///             family: "hose",
///             mechanism: Mechanism::GiveOfTheRig,
///             form: Form::Loose,
///             title: "A hose that pulls like a spring",
///             about: "The supply hose is stretched when the muscle shortens.",
///             equation: "dF = -k eps",
///             source: "our rig",
///             evidence: Evidence::User,
///             group: Group::Rig,
///             kind: None,
///             signature: Signature { pressure: "0", parity: Parity::Even, shape: "-eps" },
///             twins: &[],
///             separate: "take the hose off",
///             needs: Needs::Nothing,
///         }
///     }
///     fn parameters(&self) -> Vec<ParameterCard<'_>> {
///         vec![ParameterCard::new("stiffness", ("N", 1.0), (0.0, 500.0), 50.0, "force per unit contraction")]
///     }
///     fn action(&self) -> Action<'_> {
///         Action::Load(self)
///     }
/// }
///
/// impl LoadEffect for Hose {
///     fn act(&self, row: Row<'_>, balance: &Balance, force: &mut Jet) {
///         *force = *force - row.theta[0] * balance.contraction;
///     }
/// }
///
/// let catalogue = Catalogue::builtin().with(Hose)?;
/// assert_eq!(catalogue.find("hose")?.card().title, "A hose that pulls like a spring");
/// # Ok::<(), bulge_effects::CatalogueError>(())
/// ```
pub trait Effect: Debug + Send + Sync {
    /// The card.
    fn card(&self) -> Card<'_>;

    /// The parameters of the effect, in the order of `theta`.
    fn parameters(&self) -> Vec<ParameterCard<'_>>;

    /// The action: `Action::Load(self)` for a type that is a [`LoadEffect`], and so on.
    fn action(&self) -> Action<'_>;

    /// Whether the effect changes with each mounting, like the zero of an instrument. Specimens that differ
    /// then have their own parameters.
    fn is_of_mounting(&self) -> bool {
        false
    }

    /// The number of values that it remembers along a sweep.
    fn memory(&self) -> usize {
        0
    }
}

impl dyn Effect + '_ {
    /// The place in the chain from the set values to the readings.
    #[must_use]
    pub fn stage(&self) -> Stage {
        self.action().stage()
    }

    /// Changes the parts of a muscle, if the effect acts on its shape.
    ///
    /// # Errors
    /// If the effect belongs to the other kind of muscle, and as [`ShapeEffect::reshape`]. The parts may then
    /// be partly changed.
    pub fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        let Action::Shape(shape) = self.action() else { return Ok(()) };
        let card = self.card();
        if let Some(owner) = card.kind.filter(|owner| *owner != parts.kind) {
            let (effect, kind) = (card.name.to_owned(), parts.kind);
            return Err(MuscleError::EffectOfOtherKind { effect, kind, owner });
        }
        shape.reshape(theta, parts)?;
        parts.values().check()
    }

    /// The parts of a muscle as changed by the effect with these parameters \[SI\].
    ///
    /// # Errors
    /// As [`ShapeEffect::reshape`].
    pub fn reshaped(&self, theta: &[f64], parts: impl Into<Parts>) -> Result<Parts, MuscleError> {
        let theta: Vec<Jet> = theta.iter().copied().map(Jet::from).collect();
        let mut changed = parts.into().still();
        self.reshape(&theta, &mut changed)?;
        Ok(changed.values())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 1 kN a joint gives as stated; the slope is that of [`Give::under`], which is odd in the load.
    #[test]
    fn a_joint_gives_with_a_power_of_the_load() {
        let [linear, joint, power] = [2e-6, 3e-6, 0.6].map(Jet::from);
        let give = Give { linear, joint, power };
        let under = |load: f64| give.under(Jet::from(load)).value();
        assert!((under(1e3) - 5e-3).abs() < 1e-8 && (under(-1e3) + under(1e3)).abs() < 1e-18);
        for load in [-300.0_f64, -1.0, 0.0, 0.5, 40.0, 1e3] {
            let step = 1e-4 * load.abs().max(1.0);
            let slope = (under(load + step) - under(load - step)) / (2.0 * step);
            assert!((give.slope(load) / slope - 1.0).abs() < 1e-6, "{load}: {} {slope}", give.slope(load));
        }
        let [alone, seated] =
            [Give { joint: Jet::from(0.0), ..give }, Give { linear: Jet::from(0.0), ..give }];
        assert!(!give.is_none() && !alone.is_none() && !seated.is_none() && Give::none().is_none());
    }
}
