//! The answer of a base law at one pressure and contraction, with its derivatives and their chain rule.

use bulge_effects::{Jet, LANES};
use bulge_numerics::Real;

/// The largest number of shape parameters that can be differentiated by at once.
pub(crate) const SHAPE: usize = LANES;

/// A number with its derivatives by pressure, contraction and the shape parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Graded {
    pub(crate) value: f64,
    pub(crate) by_pressure: f64,
    pub(crate) by_contraction: f64,
    pub(crate) by_shape: [f64; SHAPE],
}

impl Graded {
    /// Applies the chain rule. Pressure and contraction carry derivatives, and the shape parameter j is the
    /// variable of lane `lanes[j]`.
    pub(crate) fn carry(&self, pressure: Jet, contraction: Jet, lanes: &[Option<usize>]) -> Jet {
        let [p, e] = [pressure.gradient(), contraction.gradient()];
        let mut gradient: [f64; LANES] =
            std::array::from_fn(|i| self.by_pressure * p[i] + self.by_contraction * e[i]);
        for (j, lane) in lanes.iter().enumerate() {
            if let Some(lane) = lane {
                gradient[*lane] += self.by_shape[j];
            }
        }
        Jet::new(self.value, gradient)
    }
}

/// Force \[N\], meridional force at mid-length \[N\], radius there \[m\] and volume \[m^3\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Answer {
    pub(crate) force: Graded,
    pub(crate) tension: Graded,
    pub(crate) mid_radius: Graded,
    pub(crate) volume: Graded,
}

impl Answer {
    pub(crate) fn parts(&self) -> [&Graded; 4] {
        [&self.force, &self.tension, &self.mid_radius, &self.volume]
    }

    pub(crate) fn parts_mut(&mut self) -> [&mut Graded; 4] {
        [&mut self.force, &mut self.tension, &mut self.mid_radius, &mut self.volume]
    }
}

/// An [`Answer`] whose numbers carry the derivatives of one pass.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried {
    pub(crate) force: Jet,
    pub(crate) tension: Jet,
    pub(crate) mid_radius: Jet,
    pub(crate) volume: Jet,
    /// Derivatives of force, tension and radius by the contraction.
    pub(crate) slope: [f64; 3],
}

impl Carried {
    /// All four numbers and the slopes times a factor.
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self {
            force: self.force * factor,
            tension: self.tension * factor,
            mid_radius: self.mid_radius * factor,
            volume: self.volume * factor,
            slope: self.slope.map(|s| s * factor),
        }
    }

    /// The sums of all four numbers and of the slopes.
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            force: self.force + other.force,
            tension: self.tension + other.tension,
            mid_radius: self.mid_radius + other.mid_radius,
            volume: self.volume + other.volume,
            slope: std::array::from_fn(|i| self.slope[i] + other.slope[i]),
        }
    }

    /// Force and tension times a factor that carries derivatives.
    pub(crate) fn stiffened(self, wall: Jet) -> Self {
        Self {
            force: self.force * wall,
            tension: self.tension * wall,
            slope: [self.slope[0] * wall.value(), self.slope[1] * wall.value(), self.slope[2]],
            ..self
        }
    }
}
