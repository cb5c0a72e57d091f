//! One row of a model: input effects, equilibrium, load effects and load cell.

use bulge_effects::law::LawPoint;
use bulge_effects::{Action, Balance, Give, Input, Jet, Moment, Stage};
use bulge_fibre::Start;
use bulge_numerics::{Dual, Real};

use crate::answer::Carried;
use crate::base::Equilibrium;
use crate::evaluate::Run;
use crate::failure::RowError;
use crate::lattice;
use crate::model::Base;
use crate::pass::Pass;
use crate::warm::{Answered, known};

/// The largest number of Newton steps for a contraction that depends on the force.
const MOST_GIVE_STEPS: usize = 50;
/// The part of a contraction that a step may have beyond which no other answer is asked for. It leaves out its square, and
/// forces grow at most with the inverse of the contraction.
const SHORT_STEP: f64 = 3e-8;
/// Nodes and weights of the Gauss-Hermite rule of degree 5 for a standard normal number.
pub(crate) const NORMAL: [(f64, f64); 3] =
    [(0.0, 2.0 / 3.0), (1.732_050_807_568_877_2, 1.0 / 6.0), (-1.732_050_807_568_877_2, 1.0 / 6.0)];

/// Where a row keeps what it found.
pub(crate) struct Place<'a> {
    /// Its row in the record.
    pub(crate) row: usize,
    /// The start of its search, and then the end.
    pub(crate) start: &'a mut Option<Start>,
    /// Its last answer; passes and evaluations with the same question need no search.
    pub(crate) answered: &'a mut Answered,
    /// By how much the row before it, and then this one, contracts further than its reading.
    pub(crate) give: &'a mut f64,
}

/// The force of one row at three stages.
pub(crate) struct Row {
    pub(crate) equilibrium: Jet,
    pub(crate) force: Jet,
    pub(crate) reading: Jet,
}

impl Run<'_> {
    /// The force of one row. The search for its equilibrium starts from `place` and leaves its end there.
    pub(crate) fn row(
        &self,
        moment: &Moment,
        pass: &Pass,
        memory: &mut [Vec<Jet>],
        place: &mut Place<'_>,
    ) -> Result<Row, RowError> {
        let input = self.input(moment, pass, memory);
        let (found, contraction) = self.balance(moment, &input, pass, place)?;
        let balance = Balance {
            pressure: input.pressure,
            contraction,
            force: found.force,
            tension: found.tension,
            mid_radius: found.mid_radius,
            volume: found.volume,
            slope: found.slope[0],
            turn: self.strands.turn(moment, &found, contraction, memory.last_mut()),
        };
        let mut load = Jet::from(0.0);
        for (action, row) in self.actions(&[Stage::Load], moment, pass, memory) {
            if let Action::Load(effect) = action {
                effect.act(row, &balance, &mut load);
            }
        }
        let force = found.force + load;
        let mut reading = force;
        for (action, row) in self.actions(&[Stage::Output], moment, pass, memory) {
            if let Action::Output(effect) = action {
                effect.act(row, &balance, &mut reading);
            }
        }
        let is_finite = reading.value().is_finite() && reading.gradient().iter().all(|g| g.is_finite());
        if is_finite {
            Ok(Row { equilibrium: found.force, force, reading })
        } else {
            Err(RowError::NotFinite)
        }
    }

    /// The equilibrium that belongs to an input, and its contraction.
    ///
    /// ```text
    /// e = contraction + give_force(F(e)) + give_tension(N(e))
    /// ```
    fn balance(
        &self,
        moment: &Moment,
        input: &Input,
        pass: &Pass,
        place: &mut Place<'_>,
    ) -> Result<(Carried, Jet), RowError> {
        if [input.give_force, input.give_tension].iter().all(Give::is_none) {
            let e = input.contraction;
            let pressure = input.pressure * input.area / input.wall;
            return Ok((self.averaged(moment, [pressure, e], e.value(), input, pass, place)?, e));
        }
        let stated = input.contraction.value();
        // Outside a fit a row's last digits depend on nothing but the row.
        let near = if self.within_fit { self.last_contraction(input, place) } else { stated };
        let found = match self.given(moment, near, input, pass, place) {
            Err(_) if near.total_cmp(&stated).is_ne() => self.given(moment, stated, input, pass, place),
            found => found,
        };
        *place.give = found.as_ref().map_or(0.0, |(_, e)| e.value() - stated);
        found
    }

    /// A contraction under load near that of a row: the one at which it was asked last, or what the row before gave
    /// beside its reading.
    fn last_contraction(&self, input: &Input, place: &Place<'_>) -> f64 {
        let pressure = (input.pressure * input.area / input.wall).value();
        let kept = self.answers.as_ref().and_then(|answers| answers.rows.get(place.row));
        let asked = [Some(&*place.answered), kept].into_iter().flatten().flatten();
        let same = asked.map(|(at, _)| at).find(|at| at[0].to_bits() == pressure.to_bits());
        same.map_or(input.contraction.value() + *place.give, |at| at[1])
    }

    /// The equilibrium under load and its contraction, by Newton's method from a contraction. The last step carries
    /// the derivatives, and is too short to ask for another answer.
    fn given(
        &self,
        moment: &Moment,
        from: f64,
        input: &Input,
        pass: &Pass,
        place: &mut Place<'_>,
    ) -> Result<(Carried, Jet), RowError> {
        let pressure = input.pressure * input.area / input.wall;
        let gives = [input.give_force, input.give_tension];
        let (mut at, mut e) = (from, Jet::from(from));
        for _ in 0..MOST_GIVE_STEPS {
            let found = self.averaged(moment, [pressure, Jet::from(at)], at, input, pass, place)?;
            let loads = [found.force, found.tension];
            let mut gap = Jet::from(at) - input.contraction;
            let mut slope = 1.0;
            for ((give, load), by_contraction) in gives.iter().zip(loads).zip(found.slope) {
                gap = gap - give.under(load);
                slope -= give.slope(load.value()) * by_contraction;
            }
            // This carries derivatives: those of the gap at fixed e, divided by the slope.
            e = Jet::from(at) - gap / slope;
            if (e.value() - at).abs() <= 1e-14 + SHORT_STEP * at.abs() {
                break;
            }
            at = e.value();
        }
        Ok((self.averaged(moment, [pressure, e], at, input, pass, place)?, e))
    }

    /// The equilibrium averaged over fibres of unequal length, to first order from a contraction `at`.
    fn averaged(
        &self,
        moment: &Moment,
        [pressure, e]: [Jet; 2],
        at: f64,
        input: &Input,
        pass: &Pass,
        place: &mut Place<'_>,
    ) -> Result<Carried, RowError> {
        let spread = input.spread;
        if spread.value() == 0.0 {
            let mut found = self.base(moment, [pressure, e], at, pass, place)?;
            found.stiffen(input.wall);
            return Ok(found);
        }
        let mut sum: Option<Carried> = None;
        for (z, weight) in NORMAL {
            let at = at + spread.value() * z;
            let part = self.base(moment, [pressure, e + spread * z], at, pass, place)?.scaled(weight);
            sum = Some(sum.map_or(part, |sum| sum.plus(part)));
        }
        let mut found = sum.ok_or(RowError::NotFinite)?;
        found.stiffen(input.wall);
        Ok(found)
    }

    /// The equilibrium, to first order from a contraction `at`, or the force law.
    fn base(
        &self,
        moment: &Moment,
        [pressure, e]: [Jet; 2],
        at: f64,
        pass: &Pass,
        place: &mut Place<'_>,
    ) -> Result<Carried, RowError> {
        match (&self.model.base, &self.equilibrium) {
            (Base::Law { law }, _) => {
                let geometry = &self.model.bodies[self.body].geometry;
                let point = LawPoint { pressure, contraction: e, direction: moment.direction };
                let count = law.coefficients.len();
                let force = law.force(point, geometry, &pass.theta[..count]);
                // Laws have no shape. A cylinder of the muscle's radius stands in for it.
                let radius = Jet::from(geometry.radius);
                let area = std::f64::consts::PI * geometry.radius * geometry.radius;
                let slope = self.law_slope(moment, pressure.value(), e.value());
                Ok(Carried {
                    force,
                    tension: force + pressure * area,
                    mid_radius: radius,
                    volume: (-e + 1.0) * (area * geometry.length),
                    slope: [slope, slope, 0.0],
                })
            }
            (Base::Equilibrium, Some(equilibrium)) => {
                let (at, further) = ([pressure.value(), at], e.value() - at);
                let kept = self.answers.as_ref().and_then(|answers| answers.rows.get(place.row));
                let kept = known(kept, at);
                if kept.is_none() && known(Some(place.answered), at).is_none() {
                    self.answer(equilibrium, at, place)?;
                }
                let Some(answer) = kept.or_else(|| known(Some(place.answered), at)) else {
                    return Err(RowError::NotFinite);
                };
                let lanes = &pass.shape_lanes;
                Ok(Carried {
                    force: answer.force.carry(pressure, e, further, lanes),
                    tension: answer.tension.carry(pressure, e, further, lanes),
                    mid_radius: answer.mid_radius.carry(pressure, e, further, lanes),
                    volume: answer.volume.carry(pressure, e, further, lanes),
                    slope: [
                        answer.force.by_contraction,
                        answer.tension.by_contraction,
                        answer.mid_radius.by_contraction,
                    ],
                })
            }
            (Base::Equilibrium, None) => Err(RowError::NotFinite),
        }
    }

    /// Leaves the answer at a pressure and a contraction in its place, by the lattice or by a search.
    fn answer(
        &self,
        equilibrium: &Equilibrium,
        [pressure, contraction]: [f64; 2],
        place: &mut Place<'_>,
    ) -> Result<(), RowError> {
        // An equilibrium in closed form that starts from another one has derivatives that are good enough for a fit
        // only.
        let mut none = None;
        let start = if self.within_fit || equilibrium.is_costly() { &mut *place.start } else { &mut none };
        let answer = lattice::answer(
            self.lattice.as_deref(),
            equilibrium,
            [pressure, contraction],
            start,
            &self.alone,
        )
        .map_err(|source| RowError::Solver { pressure, contraction, source })?;
        *place.answered = Some(([pressure, contraction], answer));
        Ok(())
    }

    fn law_slope(&self, moment: &Moment, pressure: f64, e: f64) -> f64 {
        let Base::Law { law } = &self.model.base else { return 0.0 };
        let geometry = &self.model.bodies[self.body].geometry;
        let constant = |v: f64| Dual::<1>::from(v);
        let point = LawPoint {
            pressure: constant(pressure),
            contraction: Dual::<1>::variable(e, 0),
            direction: moment.direction,
        };
        let coefficients: Vec<_> =
            self.theta[..law.coefficients.len()].iter().map(|v| constant(*v)).collect();
        law.force(point, geometry, &coefficients).gradient()[0]
    }
}
