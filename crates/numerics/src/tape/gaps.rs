//! Where the branches of a formula with kinks change.

use super::{Builder, Function, Operator, Place, Step};

impl Builder {
    /// The gaps of a value: numbers whose signs decide which branches count in its functions with kinks, such as
    /// `a - b` for `max(a, b)`. Where one vanishes, derivatives of the value may jump.
    pub fn gaps(&mut self, of: Place) -> Vec<Place> {
        let mut needed = vec![false; of + 1];
        needed[of] = true;
        let mut pairs = Vec::new();
        for place in (0..=of).rev() {
            if !needed[place] {
                continue;
            }
            let step = self.steps[place];
            for operand in step.operands() {
                needed[operand] = true;
            }
            match step {
                Step::Compare(_, [a, b]) | Step::Call(Function::Min | Function::Max, [a, b, _]) => {
                    pairs.push((a, Some(b)));
                }
                Step::Call(Function::Abs | Function::Sign | Function::Step, [x, ..]) => pairs.push((x, None)),
                Step::Call(Function::Clamp, [x, low, high]) => {
                    pairs.extend([(x, Some(low)), (x, Some(high))]);
                }
                _ => {}
            }
        }
        let mut gaps = Vec::new();
        for (a, b) in pairs {
            let gap = b.map_or(a, |b| self.operate(Operator::Subtract, a, b));
            if self.constant_at(gap).is_none() {
                gaps.push(gap);
            }
        }
        gaps.sort_unstable();
        gaps.dedup();
        gaps
    }
}
