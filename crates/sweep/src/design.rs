//! The points of a sweep. Each is a pure function of its number, so any chunk can be computed on any machine,
//! and computed again with the same result.

use bulge_numerics::Random;
use std::f64::consts::FRAC_PI_2;

use crate::permutation::Permutation;
use crate::plan::{Design, End, Plan, Quantity, Range, Spacing};
use crate::sobol::Sobol;

/// Position of a point on an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    /// A value in SI.
    Value(f64),
    /// A position between a value in SI and the contraction at which the force of the muscle vanishes.
    OfLimit {
        /// The lower end.
        from: f64,
        /// Fraction of the way from the lower end, before spacing is applied: 0 at the lower end, 1 at the
        /// limit.
        fraction: f64,
        /// Spacing applied to the fraction.
        spacing: Spacing,
    },
}

impl Coordinate {
    /// The value in SI, given the contraction `limit` at which the force vanishes. A [`Coordinate::Value`]
    /// doesn't depend on it.
    ///
    /// The value is exactly `from` at the fraction 0, and exactly `limit` at 1. It is NaN for logarithmic
    /// spacing up to a limit <= 0.
    #[must_use]
    pub fn value(self, limit: f64) -> f64 {
        match self {
            Self::Value(value) => value,
            Self::OfLimit { from, fraction, spacing } => between([from, limit], spacing, fraction, 1.0),
        }
    }
}

impl Plan {
    /// Number of points of the design. It is 0 if only a table is wanted, or if an axis of a grid doesn't
    /// state its number of points. At most 2^128 - 1.
    #[must_use]
    pub fn points(&self) -> u128 {
        match self.design {
            None => 0,
            Some(Design::Grid) => {
                self.axes.iter().map(|axis| u128::from(count(&axis.range))).fold(1, u128::saturating_mul)
            }
            Some(
                Design::Random { points, .. }
                | Design::Sobol { points }
                | Design::LatinHypercube { points, .. },
            ) => points.into(),
        }
    }

    /// Number of chunks of the design; the last one may be shorter than the others. At most 2^64 - 1.
    #[must_use]
    pub fn chunks(&self) -> u64 {
        let chunks = self.points().div_ceil(self.chunk.max(1).into());
        u64::try_from(chunks).unwrap_or(u64::MAX)
    }
}

/// The points of a plan's design.
///
/// ```
/// use bulge_sweep::{Coordinate, Layout, Plan};
/// let text = "muscle = \"ppam-2-r16\"\n[axes.contraction]\nrange = \"5 %..15 %\"\npoints = 3\n[axes.slenderness]\nlist = [4, 8]";
/// let plan = Plan::from_toml(text, "sweep.toml", None)?;
/// let layout = Layout::new(&plan).unwrap();
/// let mut point = [Coordinate::Value(0.0); 2];
/// layout.place(4, &mut point);
/// assert_eq!((point, layout.member(4)), ([0.1, 8.0].map(Coordinate::Value), 1));
/// # Ok::<(), bulge_muscles::FileError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Layout {
    ranges: Vec<Range>,
    sampler: Sampler,
}

#[derive(Debug, Clone)]
enum Sampler {
    Grid {
        /// The axes from the fastest to the slowest, each with its number of values.
        order: Vec<(usize, u64)>,
        /// Number of consecutive points that differ only in the contraction.
        run: u64,
    },
    Random {
        seed: u64,
    },
    Sobol(Sobol),
    LatinHypercube {
        points: u64,
        seed: u64,
        /// One permutation of the layers for each axis.
        layers: Vec<Permutation>,
    },
}

impl Layout {
    /// The points of the plan's design; none if only a table is wanted.
    #[must_use]
    pub fn new(plan: &Plan) -> Option<Self> {
        let ranges: Vec<Range> = plan.axes.iter().map(|axis| axis.range.clone()).collect();
        let sampler = match plan.design? {
            Design::Grid => {
                let counted = |axis: usize| (axis, count(&ranges[axis]).max(1));
                let is_fast = |axis: &usize| plan.axes[*axis].quantity == Quantity::Contraction;
                let (fast, slow): (Vec<usize>, Vec<usize>) = (0..ranges.len()).rev().partition(is_fast);
                let run = fast.iter().map(|axis| counted(*axis).1).product();
                Sampler::Grid { order: fast.into_iter().chain(slow).map(counted).collect(), run }
            }
            Design::Random { seed, .. } => Sampler::Random { seed },
            Design::Sobol { .. } => Sampler::Sobol(Sobol::new(ranges.len())),
            Design::LatinHypercube { points, seed } => {
                let layers = (0..).zip(&ranges).map(|(axis, _)| Permutation::new(points, seed, axis));
                Sampler::LatinHypercube { points, seed, layers: layers.collect() }
            }
        };
        Some(Self { ranges, sampler })
    }

    /// Position on each axis, in the order of the plan, of the point number `index`. Numbers count from 0 to
    /// [`Plan::points`] - 1.
    ///
    /// Only as many axes are filled as `out` has elements.
    pub fn place(&self, index: u64, out: &mut [Coordinate]) {
        let mut fill = |fractions: &mut dyn Iterator<Item = f64>| {
            for ((place, range), fraction) in out.iter_mut().zip(&self.ranges).zip(fractions) {
                *place = at_fraction(range, fraction);
            }
        };
        match &self.sampler {
            Sampler::Grid { order, .. } => {
                let mut rest = index;
                for (axis, count) in order {
                    if let Some(place) = out.get_mut(*axis) {
                        *place = at_step(&self.ranges[*axis], rest % count, *count);
                    }
                    rest /= count;
                }
            }
            Sampler::Random { seed } => {
                let mut random = Random::new(*seed, index);
                fill(&mut std::iter::repeat_with(|| random.uniform()));
            }
            // The point 0 of the sequence is the corner; it is left out.
            Sampler::Sobol(sobol) => fill(&mut sobol.point(index.saturating_add(1))),
            Sampler::LatinHypercube { points, seed, layers } => {
                let mut random = Random::new(*seed, index);
                let layer = |layer: &Permutation| layer.of(index) as f64;
                fill(&mut layers.iter().map(|axis| (layer(axis) + random.uniform()) / *points as f64));
            }
        }
    }

    /// Number of the muscle and pressure at a point, that is, of the combination of all axes except the
    /// contraction. Neighbours on a grid share it.
    #[must_use]
    pub fn member(&self, index: u64) -> u64 {
        if let Sampler::Grid { run, .. } = &self.sampler { index / run } else { index }
    }
}

/// Number of values that a grid takes from an axis.
fn count(range: &Range) -> u64 {
    match range {
        Range::Between { points, .. } => points.unwrap_or(0),
        Range::List(values) => values.len() as u64,
    }
}

/// Value number `step` of the `count` values of an axis on a grid.
pub(crate) fn at_step(range: &Range, step: u64, count: u64) -> Coordinate {
    match range {
        Range::List(values) => {
            let value = usize::try_from(step).ok().and_then(|step| values.get(step));
            Coordinate::Value(value.copied().unwrap_or(f64::NAN))
        }
        Range::Between { from, to, spacing, .. } => {
            let (step, steps) = (step as f64, count.saturating_sub(1).max(1) as f64);
            match to {
                End::Value(to) => Coordinate::Value(between([*from, *to], *spacing, step, steps)),
                End::Limit => Coordinate::OfLimit { from: *from, fraction: step / steps, spacing: *spacing },
            }
        }
    }
}

/// Value at a fraction in \[0, 1) of an axis.
fn at_fraction(range: &Range, fraction: f64) -> Coordinate {
    match *range {
        Range::List(ref values) => {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "not negative")]
            let step = (fraction * values.len() as f64) as u64;
            at_step(range, step.min(values.len().saturating_sub(1) as u64), values.len() as u64)
        }
        Range::Between { from, to: End::Value(to), spacing, .. } => {
            Coordinate::Value(between([from, to], spacing, fraction, 1.0))
        }
        Range::Between { from, to: End::Limit, spacing, .. } => {
            Coordinate::OfLimit { from, fraction, spacing }
        }
    }
}

/// Value at t = step/steps of a range with the given spacing:
///
/// ```text
/// linear:     from + t (to - from)
/// log:        from (to/from)^t
/// chebyshev:  from + (1 - cos(pi t))/2 (to - from)
/// ```
/// The fraction is counted from the nearer end. Both ends are therefore exact, the points are symmetric, and
/// whole-number steps end on whole numbers.
fn between([from, to]: [f64; 2], spacing: Spacing, step: f64, steps: f64) -> f64 {
    if 2.0 * step <= steps {
        from_end(from, to, spacing, step, steps)
    } else {
        from_end(to, from, spacing, steps - step, steps)
    }
}

fn from_end(near: f64, far: f64, spacing: Spacing, step: f64, steps: f64) -> f64 {
    match spacing {
        Spacing::Linear => near + (far - near) * step / steps,
        Spacing::Log => near * (far / near).powf(step / steps),
        // (1 - cos(pi t))/2 without the cancellation.
        Spacing::Chebyshev => near + (far - near) * (FRAC_PI_2 * step / steps).sin().powi(2),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Axis;
    use bulge_fibre::Approach;
    use bulge_muscles::{Parameter, preset};

    fn axis(quantity: Quantity, range: Range) -> Axis {
        Axis { quantity, name: String::new(), unit: "1".to_owned(), range }
    }

    fn line(from: f64, to: f64, points: u64, spacing: Spacing) -> Range {
        Range::Between { from, to: End::Value(to), points: Some(points), spacing }
    }

    fn plan(axes: Vec<Axis>, design: Option<Design>) -> Plan {
        Plan {
            own_effects: None,
            name: "x".to_owned(),
            muscle: preset("ppam-2-r16").unwrap(),
            pressure_pa: 1e5,
            contraction: None,
            approach: Approach::Auto,
            axes,
            design,
            outputs: vec![],
            chunk: 10,
            table: None,
        }
    }

    /// Axes that share one range.
    fn equal(count: usize, range: &Range, design: Design) -> Plan {
        plan((0..count).map(|_| axis(Quantity::Pressure, range.clone())).collect(), Some(design))
    }

    fn values(layout: &Layout, index: u64, limit: f64) -> Vec<f64> {
        let mut out = vec![Coordinate::Value(f64::NAN); layout.ranges.len()];
        layout.place(index, &mut out);
        out.into_iter().map(|coordinate| coordinate.value(limit)).collect()
    }

    #[test]
    fn ends_are_exact_and_steps_rise_symmetrically() {
        for spacing in [Spacing::Linear, Spacing::Log, Spacing::Chebyshev] {
            for [from, to] in [[0.005, 0.37], [2.0, 100.0], [0.1, 0.3], [1e-9, 7e5]] {
                for count in [2, 3, 10, 101, 1000] {
                    let range = line(from, to, count, spacing);
                    let at = |step| at_step(&range, step, count).value(f64::NAN);
                    assert_eq!((at(0).to_bits(), at(count - 1).to_bits()), (from.to_bits(), to.to_bits()));
                    assert!(
                        (1..count).all(|step| at(step) > at(step - 1)),
                        "{spacing:?} {from} {to} {count}"
                    );
                    let to_limit = Range::Between { from, to: End::Limit, points: Some(count), spacing };
                    for step in 0..count {
                        let of_limit = at_step(&to_limit, step, count).value(to);
                        assert!((of_limit / at(step) - 1.0).abs() < 1e-12);
                    }
                    let end = |step| at_step(&to_limit, step, count).value(to).to_bits();
                    assert_eq!((end(0), end(count - 1)), (from.to_bits(), to.to_bits()));
                }
            }
        }
        let unit = line(-1.0, 1.0, 8, Spacing::Chebyshev);
        for step in 0..8 {
            let at = |step| at_step(&unit, step, 8).value(0.0);
            assert_eq!(at(step).to_bits() & !(1 << 63), at(7 - step).to_bits() & !(1 << 63));
            // Gauss-Lobatto: -cos(pi i/7).
            assert!((at(step) + (std::f64::consts::PI * step as f64 / 7.0).cos()).abs() < 1e-15);
        }
        let ratio = line(2.0, 32.0, 5, Spacing::Log);
        assert!((0..5).all(|step| {
            (at_step(&ratio, step, 5).value(0.0) / 2_f64.powi(i32::try_from(step).unwrap() + 1) - 1.0).abs()
                < 1e-15
        }));
        // 1/49 49 is not 1: whole steps must stay whole.
        let whole = line(3.0, 101.0, 99, Spacing::Linear);
        assert!((0..99).all(|step| at_step(&whole, step, 99) == Coordinate::Value(3.0 + step as f64)));
    }

    #[test]
    fn the_contraction_is_fastest_then_the_last_axis() {
        let list = |values: &[f64]| Range::List(values.to_vec());
        let to_limit =
            Range::Between { from: 0.1, to: End::Limit, points: Some(3), spacing: Spacing::Linear };
        let axes = vec![
            axis(Quantity::Pressure, list(&[1e5, 2e5])),
            axis(Quantity::Contraction, to_limit),
            axis(Quantity::Parameter(Parameter::Fibres), list(&[20.0, 40.0])),
        ];
        let mut plan = plan(axes, Some(Design::Grid));
        let layout = Layout::new(&plan).unwrap();
        let wanted = [
            [1e5, 0.1, 20.0],
            [1e5, 0.2, 20.0],
            [1e5, 0.3, 20.0],
            [1e5, 0.1, 40.0],
            [1e5, 0.2, 40.0],
            [1e5, 0.3, 40.0],
            [2e5, 0.1, 20.0],
        ];
        for (index, wanted) in (0..).zip(wanted) {
            assert_eq!(values(&layout, index, 0.3), wanted);
            assert_eq!(layout.member(index), index / 3);
        }
        assert_eq!(values(&layout, 11, 0.5), [2e5, 0.5, 40.0]);
        assert_eq!((plan.points(), plan.chunks()), (12, 2));
        let mut first = [Coordinate::Value(0.0)];
        layout.place(6, &mut first);
        assert_eq!(first, [Coordinate::Value(2e5)]);
        plan.axes.remove(1);
        let layout = Layout::new(&plan).unwrap();
        assert_eq!((values(&layout, 2, 0.0), layout.member(2)), (vec![2e5, 20.0], 2));
    }

    #[test]
    fn numbers_of_points_do_not_overflow() {
        let mut many = equal(16, &line(1.0, 2.0, 1_000_000_000, Spacing::Linear), Design::Grid);
        assert_eq!((many.points(), many.chunks()), (u128::MAX, u64::MAX));
        many.axes.truncate(3);
        assert_eq!((many.points(), many.chunks()), (10_u128.pow(27), u64::MAX));
        many.axes.truncate(2);
        many.chunk = 3;
        assert_eq!(many.chunks(), 333_333_333_333_333_334);
        let nowhere = Range::Between { from: 1.0, to: End::Limit, points: None, spacing: Spacing::Log };
        many.axes.push(axis(Quantity::Contraction, nowhere));
        assert_eq!((many.points(), many.chunks()), (0, 0));
        // Without points there is no place, but no panic either.
        assert_eq!(values(&Layout::new(&many).unwrap(), 7, 2.0)[2].to_bits(), 1_f64.to_bits());
        many.design = None;
        assert!(Layout::new(&many).is_none() && many.points() == 0);
        many.design = Some(Design::Sobol { points: 21 });
        many.chunk = 10;
        assert_eq!((many.points(), many.chunks()), (21, 3));
    }

    #[test]
    fn random_points_are_uniform_and_independent_of_their_order() {
        let range = line(-1.0, 3.0, 2, Spacing::Linear);
        let at = |seed, index| {
            let plan = equal(3, &range, Design::Random { points: 9, seed });
            values(&Layout::new(&plan).unwrap(), index, 0.0)
        };
        assert_eq!(at(5, 123), at(5, 123));
        assert!(at(5, 123) != at(5, 124) && at(5, 123) != at(6, 123));
        let plan = equal(3, &range, Design::Random { points: 9, seed: 1 });
        let layout = Layout::new(&plan).unwrap();
        let points: Vec<Vec<f64>> = (0..20_000).map(|index| values(&layout, index, 0.0)).collect();
        let mean = |of: &dyn Fn(&[f64]) -> f64| points.iter().map(|p| of(p)).sum::<f64>() / 20_000.0;
        for i in 0..3 {
            // Mean 1 and variance 16/12, within four standard errors.
            assert!((mean(&|p| p[i]) - 1.0).abs() < 4.0 * 1.155 / 141.0);
            assert!((mean(&|p| (p[i] - 1.0).powi(2)) - 4.0 / 3.0).abs() < 4.0 * 1.193 / 141.0);
            let j = (i + 1) % 3;
            assert!(mean(&|p| (p[i] - 1.0) * (p[j] - 1.0)).abs() < 4.0 * 1.333 / 141.0);
        }
        assert_eq!(layout.member(17), 17);
    }

    #[test]
    fn a_latin_hypercube_has_one_point_in_each_layer_of_each_axis() {
        for points in [1, 2, 3, 7, 100, 1023] {
            let range = line(0.0, points as f64, 2, Spacing::Linear);
            let plan = equal(4, &range, Design::LatinHypercube { points, seed: 11 });
            let layout = Layout::new(&plan).unwrap();
            let found: Vec<Vec<f64>> = (0..points).map(|index| values(&layout, index, 0.0)).collect();
            for i in 0..4 {
                let mut layers: Vec<f64> = found.iter().map(|point| point[i].floor()).collect();
                layers.sort_by(f64::total_cmp);
                let wanted: Vec<f64> = (0..points).map(|layer| layer as f64).collect();
                assert_eq!(layers, wanted);
            }
            if points > 50 {
                // The axes are permuted independently, and points lie anywhere within their layers.
                let n = points as f64;
                let centred = |point: &[f64], i: usize| (point[i] / n - 0.5) * 12_f64.sqrt();
                let product: f64 = found.iter().map(|p| centred(p, 0) * centred(p, 1)).sum::<f64>() / n;
                assert!(product.abs() < 4.0 / n.sqrt(), "{product}");
                let inside = found.iter().map(|point| point[2].fract()).sum::<f64>() / n;
                assert!((inside - 0.5).abs() < 4.0 * 0.289 / n.sqrt(), "{inside}");
                assert!(found.iter().any(|p| p[2].fract() < 0.1) && found.iter().any(|p| p[2].fract() > 0.9));
            }
        }
    }

    #[test]
    fn sobol_starts_in_the_middle_and_stays_inside() {
        let plan = equal(16, &line(2.0, 4.0, 2, Spacing::Linear), Design::Sobol { points: u64::MAX });
        let layout = Layout::new(&plan).unwrap();
        assert_eq!(values(&layout, 0, 0.0), [3.0; 16]);
        assert_eq!(values(&layout, 1, 0.0)[..2], [3.5, 2.5]);
        for index in (0..5000).chain([u64::MAX - 1, u64::MAX]) {
            let at = values(&layout, index, 0.0);
            assert!(at.iter().all(|x| (2.0..=4.0).contains(x)));
        }
        assert!((0..5000).all(|index| values(&layout, index, 0.0).iter().all(|x| *x > 2.0 && *x < 4.0)));
    }

    #[test]
    fn fractions_are_stretched_and_lists_are_drawn_from() {
        let spaced = |spacing| {
            let range = Range::Between { from: 0.01, to: End::Limit, points: None, spacing };
            let plan = equal(1, &range, Design::Sobol { points: 1023 });
            let layout = Layout::new(&plan).unwrap();
            let mut found: Vec<f64> = (0..1023).map(|index| values(&layout, index, 1.0)[0]).collect();
            found.sort_by(f64::total_cmp);
            (found[255], found[511])
        };
        let near = |(a, b): (f64, f64), (c, d): (f64, f64)| (a - c).abs() + (b - d).abs() < 1e-12;
        assert!(near(spaced(Spacing::Linear), (0.2575, 0.505)));
        assert!(near(spaced(Spacing::Log), (0.01_f64.powf(0.75), 0.1)));
        // The quarter of the arcsine density: (1 - cos(pi/4))/2.
        assert!(near(spaced(Spacing::Chebyshev), (0.01 + 0.99 * (0.5 - 0.125_f64.sqrt()), 0.505)));
        let plan = equal(1, &Range::List(vec![1.0, 2.0, 4.0]), Design::Random { points: 1, seed: 1 });
        let layout = Layout::new(&plan).unwrap();
        let drawn: Vec<f64> = (0..100).map(|index| values(&layout, index, 0.0)[0]).collect();
        assert!([1.0, 2.0, 4.0].iter().all(|value| drawn.contains(value)));
    }
}
