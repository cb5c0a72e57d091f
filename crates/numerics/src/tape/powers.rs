//! A value multiplied out: a sum of whole powers of some inputs.

use super::{Builder, Operator, Place, Step};

/// Terms that a sum may have while it is multiplied out, and the largest power of a sum.
const MOST_TERMS: usize = 64;
const MOST_POWER: i32 = 8;

/// Terms with the exponents of the inputs and the place of the factor, each product of powers once.
type Terms<const N: usize> = Vec<([i32; N], Place)>;

impl Builder {
    /// A value as a sum of products of whole powers of these inputs, with factors that don't depend on them. `None` if it is no such sum, or a long one.
    ///
    /// ```
    /// use bulge_numerics::tape::{Builder, Operator};
    ///
    /// // k (x + y)^2 = k x^2 + 2 k x y + k y^2
    /// let mut tape = Builder::default();
    /// let (x, y, k) = (tape.input(0), tape.input(1), tape.input(2));
    /// let sum = tape.operate(Operator::Add, x, y);
    /// let square = tape.whole_power(sum, 2);
    /// let value = tape.operate(Operator::Multiply, k, square);
    /// let terms = tape.powers(value, [0, 1]).ok_or("no powers")?;
    /// assert_eq!(terms.iter().map(|(powers, _)| *powers).collect::<Vec<_>>(), [[2, 0], [1, 1], [0, 2]]);
    /// # Ok::<(), &str>(())
    /// ```
    pub fn powers<const N: usize>(
        &mut self,
        of: Place,
        inputs: [usize; N],
    ) -> Option<Vec<([i32; N], Place)>> {
        let mut found: Vec<Option<Terms<N>>> = Vec::with_capacity(of + 1);
        for place in 0..=of {
            let step = self.steps[place];
            let terms = self.multiplied_out(step, place, &found, inputs);
            found.push(terms);
        }
        found.pop()?
    }

    fn multiplied_out<const N: usize>(
        &mut self,
        step: Step,
        place: Place,
        found: &[Option<Terms<N>>],
        inputs: [usize; N],
    ) -> Option<Terms<N>> {
        let one = self.constant(1.0);
        if let Step::Input(index) = step
            && let Some(which) = inputs.iter().position(|input| *input == index)
        {
            return Some(vec![(std::array::from_fn(|i| i32::from(i == which)), one)]);
        }
        let of = |operand: Place| found[operand].as_ref();
        let is_factor = |operand: &Place| of(*operand).is_some_and(|terms| is_factor(terms));
        if step.operands().iter().all(is_factor) {
            let is_zero = self.constant_at(place) == Some(0.0);
            return Some(if is_zero { Vec::new() } else { vec![([0; N], place)] });
        }
        match step {
            Step::Negate(a) => {
                Some(of(a)?.iter().map(|(powers, factor)| (*powers, self.negate(*factor))).collect())
            }
            Step::Operate(operator @ (Operator::Add | Operator::Subtract), [a, b]) => {
                let mut sum = of(a)?.clone();
                of(b)?.iter().try_for_each(|term| self.add(&mut sum, operator, *term))?;
                Some(sum)
            }
            Step::Operate(Operator::Multiply, [a, b]) => self.product(of(a)?, of(b)?),
            Step::Operate(Operator::Divide, [a, b]) => {
                let inverse = self.raised(of(b)?, -1)?;
                self.product(of(a)?, &inverse)
            }
            Step::WholePower(a, exponent) => self.raised(of(a)?, exponent),
            _ => None,
        }
    }

    fn add<const N: usize>(
        &mut self,
        sum: &mut Terms<N>,
        operator: Operator,
        (powers, factor): ([i32; N], Place),
    ) -> Option<()> {
        match sum.iter().position(|(others, _)| *others == powers) {
            Some(k) => {
                sum[k].1 = self.operate(operator, sum[k].1, factor);
                if self.constant_at(sum[k].1) == Some(0.0) {
                    sum.remove(k);
                }
            }
            None if sum.len() >= MOST_TERMS => return None,
            None => {
                let zero = self.constant(0.0);
                let term = self.operate(operator, zero, factor);
                sum.push((powers, term));
            }
        }
        Some(())
    }

    fn product<const N: usize>(&mut self, left: &Terms<N>, right: &Terms<N>) -> Option<Terms<N>> {
        let mut sum = Vec::new();
        for (a, by) in left {
            for (b, factor) in right {
                let mut powers = *a;
                for (power, more) in powers.iter_mut().zip(b) {
                    *power = power.checked_add(*more)?;
                }
                let factor = self.operate(Operator::Multiply, *by, *factor);
                self.add(&mut sum, Operator::Add, (powers, factor))?;
            }
        }
        Some(sum)
    }

    fn raised<const N: usize>(&mut self, terms: &Terms<N>, exponent: i32) -> Option<Terms<N>> {
        if let [(powers, factor)] = terms.as_slice() {
            let mut by = *powers;
            for power in &mut by {
                *power = power.checked_mul(exponent)?;
            }
            return Some(vec![(by, self.whole_power(*factor, exponent))]);
        }
        // One over a sum is no sum.
        if !(1..=MOST_POWER).contains(&exponent) {
            return None;
        }
        (1..exponent).try_fold(terms.clone(), |power, _| self.product(&power, terms))
    }
}

/// Whether nothing but a factor is there.
fn is_factor<const N: usize>(terms: &[([i32; N], Place)]) -> bool {
    terms.iter().all(|(powers, _)| *powers == [0; N])
}

#[cfg(test)]
mod tests {
    use super::super::Function;
    use super::*;
    use crate::Random;

    /// A sum of powers is computed by its terms as by the formula; what is none is refused.
    #[test]
    fn terms_make_the_value() {
        use Operator::{Add, Divide, Multiply, Subtract};
        let mut tape = Builder::default();
        let (x, y, k, two) = (tape.input(0), tape.input(1), tape.input(2), tape.constant(2.0));
        let product = tape.operate(Multiply, x, y);
        let inverse = tape.whole_power(product, -2);
        let root = tape.call(Function::Sqrt, &[k]);
        let scaled = tape.operate(Divide, inverse, root);
        let (less, negative) = (tape.operate(Subtract, x, two), tape.negate(y));
        let sum = tape.operate(Add, less, negative);
        let cube = tape.whole_power(sum, 3);
        let over = tape.operate(Divide, cube, product);
        let value = tape.operate(Subtract, over, scaled);
        let terms = tape.powers(value, [0, 1]).unwrap();
        // (x - 2 - y)^3 has ten terms.
        assert_eq!(terms.len(), 11);
        let places: Vec<Place> = terms.iter().map(|(_, factor)| *factor).chain([value]).collect();
        let tape_of_all = tape.finish(&places).unwrap();
        let mut random = Random::new(1, 0);
        for _ in 0..20 {
            let at = [random.between(0.5, 2.0), random.between(0.5, 2.0), random.between(0.1, 3.0)];
            let found: [f64; 12] = tape_of_all.run(&at);
            let of_term =
                |(powers, factor): (&[i32; 2], f64)| factor * at[0].powi(powers[0]) * at[1].powi(powers[1]);
            let sum: f64 = terms.iter().map(|(powers, _)| powers).zip(found).map(of_term).sum();
            assert!((sum - found[11]).abs() < 1e-12 * (1.0 + sum.abs()), "{sum} {}", found[11]);
        }
        // What cancels is no term.
        let none = tape.operate(Subtract, product, product);
        assert_eq!(tape.powers(none, [0, 1]).unwrap(), []);
        // Factors depend on nothing else.
        let sine = tape.call(Function::Sin, &[x]);
        let of_sum = tape.operate(Divide, x, sum);
        let high = tape.whole_power(sum, 20);
        for place in [sine, of_sum, high] {
            assert!(tape.powers(place, [0, 1]).is_none());
        }
        assert_eq!(tape.powers(sine, [1]).unwrap().len(), 1);
        let wide = tape.whole_power(x, i32::MAX);
        let wider = tape.whole_power(wide, 2);
        assert!(tape.powers(wide, [0]).is_some() && tape.powers(wider, [0]).is_none());
    }
}
