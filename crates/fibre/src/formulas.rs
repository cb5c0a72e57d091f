//! A user's own formulas in a net: the energy of its wall and the area on which the pressure acts, each with
//! its derivatives on one tape.

use bulge_numerics::Real;
use bulge_numerics::tape::Tape;
use std::sync::Arc;

use crate::lobes::Section;
use crate::net::{EVEN_POWERS, Wall};

/// Largest number of parameters of one formula.
pub const MOST_PARAMETERS: usize = 6;

/// Largest number of gaps of one formula.
pub const MOST_GAPS: usize = 8;

/// A formula of one quantity, with its parameters.
///
/// The tape takes the inputs in the order of [`FormulaInput`], then the parameters. For an energy it gives W,
/// dW/dl1, dW/dl2, d2W/dl1^2, d2W/dl1 dl2 and d2W/dl2^2 (the derivatives by l2 move r = l2 r0 along). For an
/// area it gives A, dA/dr and d2A/dr^2, and for a twist its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Formula<D = f64> {
    /// The tape that computes it.
    pub tape: Arc<Tape>,
    /// For an energy that is a sum of [`EVEN_POWERS`] of the stretches: the tape that computes their factors
    /// \[N/m\], which depend on neither stretch nor radius. Such an energy is solved with in closed form.
    pub even: Option<Arc<Tape>>,
    /// For a formula with kinks: the tape of its gaps, at most [`MOST_GAPS`]. Where one vanishes, derivatives
    /// of the formula may jump.
    pub gaps: Option<Arc<Tape>>,
    /// Its parameters in SI, at most [`MOST_PARAMETERS`].
    pub parameters: Vec<D>,
}

/// The inputs on which a formula of the shape may depend, in their order on the tape.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FormulaInput {
    /// Stretch along the meridian.
    AlongMeridian,
    /// Stretch around the axis, r/r0.
    AroundAxis,
    /// Radius of the fibres \[m\].
    Radius,
    /// Reference radius r0 \[m\].
    ReferenceRadius,
    /// Gauge pressure \[Pa\].
    Pressure,
    /// Angle between fibre and axis at rest \[rad\].
    Angle,
    /// Length at rest \[m\].
    Length,
}

/// Number of [`FormulaInput`]s.
const INPUTS: usize = 7;

impl<D: Real> Formula<D> {
    /// The outputs for the values of all inputs that are not parameters.
    pub(crate) fn run<const OUTPUTS: usize>(&self, inputs: [D; INPUTS]) -> [D; OUTPUTS] {
        self.run_at(|index| inputs.get(index).map(|input| [*input])).map(|[output]| output)
    }

    /// The factors of the even powers, if it is a sum of these.
    pub(crate) fn even_powers(&self, inputs: [D; INPUTS]) -> Option<[D; EVEN_POWERS.len()]> {
        let tape = self.even.as_ref()?;
        Some(tape.run_on(|index| inputs.get(index).copied().unwrap_or_else(|| self.parameter(index))))
    }

    /// The gaps, those that it has; the others are not numbers.
    fn gaps(&self, inputs: [D; INPUTS]) -> [D; MOST_GAPS] {
        let input = |index: usize| inputs.get(index).copied().unwrap_or_else(|| self.parameter(index));
        self.gaps.as_ref().map_or([D::from(f64::NAN); MOST_GAPS], |tape| tape.run_on(input))
    }

    /// The parameter at a place of the tape.
    fn parameter(&self, index: usize) -> D {
        self.parameters.get(index - INPUTS).copied().unwrap_or(D::from(f64::NAN))
    }

    /// The same at `L` points.
    fn run_at<const OUTPUTS: usize, const L: usize>(
        &self,
        input: impl Fn(usize) -> Option<[D; L]>,
    ) -> [[D; L]; OUTPUTS] {
        self.tape.run_at(|index| input(index).unwrap_or_else(|| [self.parameter(index); L]))
    }

    /// The same for another scalar. Each parameter has its name.
    pub(crate) fn map_named<E>(
        &self,
        names: &[&'static str; MOST_PARAMETERS],
        mut f: impl FnMut(&'static str, D) -> E,
    ) -> Formula<E> {
        let mut names = names.iter();
        self.map(|number| f(names.next().unwrap_or(&""), number))
    }

    /// The same for another scalar.
    pub(crate) fn map<E>(&self, f: impl FnMut(D) -> E) -> Formula<E> {
        Formula {
            tape: Arc::clone(&self.tape),
            even: self.even.clone(),
            gaps: self.gaps.clone(),
            parameters: self.parameters.iter().copied().map(f).collect(),
        }
    }
}

/// The formulas that act at every radius of a dimensionless net, and the numbers of the muscle that they need
/// \[SI\].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Formulas<D> {
    /// Energy W of the wall per area at rest \[N/m\], as a function of the stretches.
    pub(crate) energy: Option<Formula<D>>,
    /// Area A(r) on which the pressure acts \[m^2\].
    pub(crate) area: Option<Formula<D>>,
    /// Energy scale per unstretched fibre length: 2 pi cos(alpha0)/(p R).
    pub(crate) scale: D,
    pub(crate) radius: D,
    pub(crate) pressure: D,
    pub(crate) angle: D,
    pub(crate) length: D,
}

impl<D> Formulas<D> {
    /// Largest count of numbers in both formulas together.
    pub(crate) const NUMBERS: usize = 5 + 2 * MOST_PARAMETERS;
}

impl<D: Real> Formulas<D> {
    fn inputs(&self, l1: D, l2: D) -> [D; INPUTS] {
        [l1, l2, l2 * self.radius, self.radius, self.pressure, self.angle, self.length]
    }

    /// The gaps of the energy and those of the area.
    pub(crate) fn gaps(&self, sigma: D, r: D, cos_rest: D) -> [D; 2 * MOST_GAPS] {
        let of = |formula: &Option<Formula<D>>, l1: D| {
            formula.as_ref().map(|formula| formula.gaps(self.inputs(l1, r)))
        };
        let mut all = [D::from(f64::NAN); 2 * MOST_GAPS];
        let both = [of(&self.energy, sigma / cos_rest), of(&self.area, D::from(1.0))];
        for (all, gaps) in all.chunks_mut(MOST_GAPS).zip(both) {
            all.iter_mut().zip(gaps.into_iter().flatten()).for_each(|(all, gap)| *all = gap);
        }
        all
    }

    /// Whether one of them has kinks.
    pub(crate) fn have_branches(&self) -> bool {
        [&self.energy, &self.area].into_iter().flatten().any(|formula| formula.gaps.is_some())
    }

    /// The energy of the wall at a radius, if a formula gives it.
    ///
    /// It is returned and not added in place: a reference to the sum of all parts would keep that in memory, also
    /// in nets without formulas, which spend most of their time there.
    #[cold]
    #[inline(never)]
    pub(crate) fn wall(&self, sigma: D, r: D, cos_rest: D) -> Option<Wall<D>> {
        self.walls([sigma], [r], cos_rest).map(|[wall]| wall)
    }

    /// The same at `L` radii.
    pub(crate) fn walls<const L: usize>(
        &self,
        sigma: [D; L],
        r: [D; L],
        cos_rest: D,
    ) -> Option<[Wall<D>; L]> {
        let per_cos = D::from(1.0) / cos_rest;
        let along = self.scale * per_cos;
        let scales = [self.scale, along, self.scale, along * per_cos, along, self.scale];
        let outputs = self.energies(sigma, r, per_cos)?;
        Some(std::array::from_fn(|i| {
            let [w, w_1, w_2, w_11, w_12, w_22] = std::array::from_fn(|k| scales[k] * outputs[k][i]);
            Wall { w, w_1, w_2, w_11, w_12, w_22 }
        }))
    }

    /// W' and W'' by the radius along fibres that don't stretch, for sigma^2 = 1 - q^2 r^2.
    pub(crate) fn slopes<const L: usize>(&self, turn: D, r: [D; L], cos_rest: D) -> Option<[[D; 2]; L]> {
        let q2 = turn * turn;
        let per_cos = D::from(1.0) / cos_rest;
        let sigma = r.map(|r| (-(q2 * r * r) + 1.0).sqrt());
        let [_, w_1, w_2, w_11, w_12, w_22] = self.energies(sigma, r, per_cos)?;
        Some(std::array::from_fn(|i| {
            let per_sigma = D::from(1.0) / sigma[i];
            let unit = -(q2 * per_cos * per_sigma);
            // l1 = sigma/cos(alpha0) by the radius.
            let (first, second) = (unit * r[i], unit * per_sigma * per_sigma);
            let bend = (w_11[i] * first + w_12[i] * 2.0) * first + w_22[i] + w_1[i] * second;
            [(w_1[i] * first + w_2[i]) * self.scale, bend * self.scale]
        }))
    }

    /// The energy of the formula with its derivatives \[N/m\].
    #[inline]
    fn energies<const L: usize>(&self, sigma: [D; L], r: [D; L], per_cos: D) -> Option<[[D; L]; 6]> {
        let energy = self.energy.as_ref()?;
        let inputs: [[D; INPUTS]; L] = std::array::from_fn(|i| self.inputs(sigma[i] * per_cos, r[i]));
        let mut outputs: [[D; L]; 6] =
            energy.run_at(|index| (index < INPUTS).then(|| inputs.map(|inputs| inputs[index])));
        // The slope of ln(x) is finite where x is negative and the energy has no value.
        for i in 0..L {
            if !outputs[0][i].value().is_finite() {
                for output in &mut outputs {
                    output[i] = D::from(f64::NAN);
                }
            }
        }
        Some(outputs)
    }

    /// The cross-section over R^2, if a formula gives it.
    #[cold]
    #[inline(never)]
    pub(crate) fn section(&self, r: D) -> Option<Section<D>> {
        let area = self.area.as_ref()?;
        let [area, mut area_r, area_rr]: [D; 3] = area.run(self.inputs(D::from(1.0), r));
        if !area.value().is_finite() {
            area_r = area;
        }
        let per_radius = D::from(1.0) / self.radius;
        Some(Section { area: area * per_radius * per_radius, area_r: area_r * per_radius, area_rr })
    }

    /// The same for another scalar. Each number has its place.
    pub(crate) fn map<E>(&self, mut f: impl FnMut(usize, D) -> E) -> Formulas<E> {
        let mut of = |formula: &Option<Formula<D>>, first: usize| {
            let mut place = first;
            formula.as_ref().map(|formula| {
                formula.map(|number| {
                    place += 1;
                    f(place - 1, number)
                })
            })
        };
        let (energy, area) = (of(&self.energy, 5), of(&self.area, 5 + MOST_PARAMETERS));
        Formulas {
            energy,
            area,
            scale: f(0, self.scale),
            radius: f(1, self.radius),
            pressure: f(2, self.pressure),
            angle: f(3, self.angle),
            length: f(4, self.length),
        }
    }
}

impl Formulas<f64> {
    /// The same with a fraction of the energy.
    pub(crate) fn with_part(&self, part: f64) -> Self {
        Self { scale: part * self.scale, ..self.clone() }
    }
}
