//! The base law at one pressure and contraction: the equilibrium of the reshaped muscle, with derivatives by
//! the parameters that reshape it.

use bulge_fibre::{FibreError, Jet, Linear, Linearised, Parts, Problem, Repeated, Start};
use bulge_muscles::Pressure;

use crate::answer::{Answer, Graded};

/// The parts of a muscle whose equilibrium is to be solved, with derivatives by the parameters that change
/// the shape, each in its lane.
#[derive(Debug, Clone)]
pub(crate) struct Shaped {
    pub(crate) parts: Parts<Jet>,
    /// Lanes in which `parts` has no derivatives, with the parts at a parameter value slightly further on (a
    /// very small fraction of the parameter's usual size), if those differ. This happens at 0, where the part
    /// doesn't exist yet or the force is even in the parameter.
    pub(crate) beside: Vec<(usize, Parts<Jet>)>,
}

/// The equilibrium problem of a muscle, with the parameters by which its answers are differentiated.
#[derive(Debug, Clone)]
pub(crate) struct Equilibrium {
    here: Repeated,
    beside: Vec<(usize, Repeated)>,
}

impl Equilibrium {
    pub(crate) fn new(shaped: Shaped) -> Result<Self, FibreError> {
        let here = Repeated::new(shaped.parts)?;
        let beside = shaped.beside.into_iter().map(|(lane, parts)| Ok((lane, Repeated::new(parts)?)));
        Ok(Self { here, beside: beside.collect::<Result<_, FibreError>>()? })
    }

    fn all(&self) -> impl Iterator<Item = &Repeated> {
        std::iter::once(&self.here).chain(self.beside.iter().map(|(_, there)| there))
    }

    /// Whether force/p, shape and volume, and their derivatives, are independent of the pressure.
    pub(crate) fn is_scale_free(&self) -> bool {
        self.all().map(Repeated::problem).all(Problem::is_scale_free)
    }

    /// Whether each answer takes shooting, so that a lattice can pay off.
    pub(crate) fn is_costly(&self) -> bool {
        self.all().map(Repeated::problem).any(Problem::shoots)
    }

    /// Whether the force grows without bound towards contraction 0.
    pub(crate) fn is_singular(&self) -> bool {
        self.here.problem().is_singular()
    }

    /// The answer at a pressure \[Pa\] and a contraction, and a start for the search for a similar
    /// equilibrium.
    pub(crate) fn answer(
        &self,
        pressure: f64,
        contraction: f64,
        from: Option<&Start>,
    ) -> Result<(Answer, Option<Start>), FibreError> {
        let pressure = Pressure::pa(pressure);
        let found = self.here.linearised_from(from, pressure, contraction)?;
        let mut answer = Answer::of(&found);
        for (lane, there) in &self.beside {
            let there = Answer::of(&there.linearised_from(found.start(), pressure, contraction)?);
            for (here, there) in answer.parts_mut().into_iter().zip(there.parts()) {
                here.by_shape[*lane] = there.by_shape[*lane];
            }
        }
        Ok((answer, found.into_start()))
    }
}

impl Answer {
    #[inline]
    fn of(found: &Linearised) -> Self {
        let graded = |linear: &Linear| Graded {
            value: linear.value,
            by_pressure: linear.by_pressure,
            by_contraction: linear.by_contraction,
            by_shape: linear.by_lane,
        };
        Self {
            force: graded(&found.force_n),
            tension: graded(&found.equator_force_n),
            mid_radius: graded(&found.mid_radius_m),
            volume: graded(&found.volume_polygon_m3),
        }
    }
}
