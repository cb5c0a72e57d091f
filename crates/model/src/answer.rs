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
    /// The number at a contraction that is larger by `further`, to first order. Applies the chain rule: pressure and
    /// contraction carry derivatives, and the shape parameter j is the variable of lane `lanes[j]`.
    #[inline]
    pub(crate) fn carry(
        &self,
        pressure: Jet,
        contraction: Jet,
        further: f64,
        lanes: &[Option<usize>],
    ) -> Jet {
        let [p, e] = [pressure.gradient(), contraction.gradient()];
        let mut gradient: [f64; LANES] =
            std::array::from_fn(|i| self.by_pressure * p[i] + self.by_contraction * e[i]);
        for (j, lane) in lanes.iter().enumerate() {
            if let Some(lane) = lane {
                gradient[*lane] += self.by_shape[j];
            }
        }
        Jet::new(self.value + self.by_contraction * further, gradient)
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

    /// Multiplies force and tension by a factor that carries derivatives.
    pub(crate) fn stiffen(&mut self, wall: Jet) {
        self.force = self.force * wall;
        self.tension = self.tension * wall;
        for slope in &mut self.slope[..2] {
            *slope *= wall.value();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_numerics::Real;

    fn carried(first: f64) -> Carried {
        let number = |i: f64| Jet::variable(first + i, 0);
        Carried {
            force: number(0.0),
            tension: number(1.0),
            mid_radius: number(2.0),
            volume: number(3.0),
            slope: [first + 4.0, first + 5.0, first + 6.0],
        }
    }

    fn numbers(of: &Carried) -> [f64; 7] {
        let [a, b, c] = of.slope;
        [of.force.value(), of.tension.value(), of.mid_radius.value(), of.volume.value(), a, b, c]
    }

    /// What an average of unequal fibres is made of; a wall carries a part of the force and the tension, not of the shape.
    #[test]
    #[expect(clippy::float_cmp, reason = "small whole numbers")]
    fn all_numbers_are_added_and_scaled_and_loads_alone_stiffened() {
        let (one, other) = (carried(1.0), carried(10.0));
        assert_eq!(numbers(&one.scaled(2.0)), [2.0, 4.0, 6.0, 8.0, 10.0, 12.0, 14.0]);
        assert_eq!(numbers(&one.plus(other)), [11.0, 13.0, 15.0, 17.0, 19.0, 21.0, 23.0]);
        let mut stiffened = one;
        stiffened.stiffen(Jet::variable(3.0, 1));
        assert_eq!(numbers(&stiffened), [3.0, 6.0, 3.0, 4.0, 15.0, 18.0, 7.0]);
        // (F w)' = F' w + F w'.
        assert_eq!(stiffened.force.gradient()[..2], [3.0, 1.0]);
    }
}
