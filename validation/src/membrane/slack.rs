//! The contraction at which the fibres of a braid become slack on its rubber: by shooting and by elements.

use bulge_fibre::{Approach, FibreError, Problem};
use bulge_membrane::mesher::{Grading, revolved};
use bulge_membrane::{
    Cloth, Copies, Fitting, Inflation, Law, Load, Part, RingLayer, Sheet, Solver, Structure, Support, Thread,
    Tolerance,
};
use bulge_muscles::{Angle, Length, Parameter, Pressure};

use crate::check::{Check, Claim, Trouble};
use crate::specimen::braid;

/// Quadratic elements on half the length.
const ELEMENTS: usize = 160;
/// Number of fibres. Only their sum matters.
const FIBRES: f64 = 60.0;
/// Number of steps up to the border.
const STEPS: u32 = 8;
/// Distances before the border at which the tension is taken. A parabola extrapolates it to zero.
const BEFORE: [f64; 3] = [6e-4, 4e-4, 2e-4];

/// A clamped braid of 25 degrees, r0 = 10 mm, with a wall of 1 mm.
struct Braid {
    length_mm: f64,
    c10_mpa: f64,
    c01_mpa: f64,
    pressure_bar: f64,
}

impl Braid {
    /// The contraction from which on shooting finds no taut fibres.
    fn border(&self) -> Result<f64, Trouble> {
        let [c10, c01] = [self.c10_mpa, self.c01_mpa].map(|mpa| Pressure::mpa(mpa).to_pa());
        let rubber = [(Parameter::Wall, 0.001), (Parameter::C10, c10), (Parameter::C01, c01)];
        let muscle =
            braid(Length::mm(self.length_mm), Length::mm(10.0), Angle::deg(25.0))?.with_all(&rubber)?;
        let problem = Problem::new(&muscle, Pressure::bar(self.pressure_bar))?;
        let (mut taut, mut slack) = (problem.contraction_limit(Approach::Auto)?, 0.3);
        while slack - taut > 1e-9 {
            let middle = 0.5 * (taut + slack);
            match problem.follow(middle, Approach::Auto) {
                Ok(_) => taut = middle,
                Err(FibreError::Slack { .. } | FibreError::BeyondLimit { .. }) => slack = middle,
                Err(error) => return Err(error.into()),
            }
        }
        Ok(taut)
    }

    /// The smallest tension of the fibres at contractions, by elements \[N\].
    fn tensions(&self, contractions: &[f64]) -> Result<Vec<f64>, Trouble> {
        let (length, radius) = (1e-3 * self.length_mm, 0.01);
        let law = Law::MooneyRivlin { c1: 1e3 * self.c10_mpa, c2: 1e3 * self.c01_mpa };
        let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: false, residual: 0.0 };
        let threads =
            RingLayer::Threads { thread: Thread::Inextensible, count: FIBRES, angle: 25.0_f64.to_radians() };
        let layers = vec![threads, RingLayer::Sheet { sheet, fullness: 1.0 }];
        let mesh = revolved(|t| [radius, length * t], 2 * ELEMENTS, true, Grading::Ends(3.0));
        let supports = [("first", 0), ("last", 1)]
            .map(|(group, fitting)| (group.to_owned(), Support::Fitting { fitting }));
        let parts = [("wall".to_owned(), Part::Revolved { layers })];
        let structure = Structure::new(&mesh, &parts, &supports, &[Fitting::Placed; 2])?;
        let mut solver = Solver::new(structure, Copies::ONE, Tolerance::default())?;
        let load = |contraction: f64| Load {
            inflation: Inflation::Pressure(1e5 * self.pressure_bar),
            fittings: vec![0.0, -contraction * length],
        };
        let mut before = Load { inflation: Inflation::Pressure(0.0), fittings: vec![0.0; 2] };
        let mut state = solver.at_rest();
        let mut found = Vec::new();
        for contraction in contractions {
            let next = load(*contraction);
            state = solver.follow(&before, &state, &next, |_, _| ())?;
            let fields = solver.fields(&state);
            found.push(
                fields.groups[0].threads[0].iter().fold(f64::INFINITY, |least, at| least.min(at.tension)),
            );
            before = next;
        }
        Ok(found)
    }
}

/// The contraction at which fibres are reported slack is that at which their tension vanishes in the
/// elements.
pub(crate) fn border() -> Check {
    Claim {
        group: "membrane",
        name: "contraction at which the fibres of a braid become slack over its rubber",
        source: "membrane elements: their least tension, drawn on to nothing",
        tolerance: 2e-4,
        why: "a tension in 320 quadratic elements is 1e-4 N off, which is 1e-4 of contraction in the longest",
    }
    .run(|tally| {
        for braid in [
            Braid { length_mm: 60.0, c10_mpa: 0.3, c01_mpa: 0.0, pressure_bar: 0.5 },
            Braid { length_mm: 60.0, c10_mpa: 0.3, c01_mpa: 0.05, pressure_bar: 0.4 },
            Braid { length_mm: 80.0, c10_mpa: 0.35, c01_mpa: 0.0, pressure_bar: 0.5 },
        ] {
            let border = braid.border()?;
            // From rest in small steps.
            let way = (1..STEPS).map(|step| border * f64::from(step) / f64::from(STEPS));
            let places: Vec<f64> = way.chain(BEFORE.map(|before| border - before)).collect();
            let tensions = braid.tensions(&places)?;
            let tensions = &tensions[tensions.len() - 3..];
            let [a, b, c] = [0, 1, 2].map(|i| tensions[i]);
            // The parabola through three evenly spaced values, extrapolated from the last one, in steps.
            let (slope, bend) = (0.5 * (a - 4.0 * b + 3.0 * c), a - 2.0 * b + c);
            let steps = 2.0 * c / (-slope + (slope * slope - 2.0 * bend * c).sqrt());
            let off = (BEFORE[1] - BEFORE[2]) * steps - BEFORE[2];
            tally.add(off.abs(), || {
                format!(
                    "{} mm, {} bar: slack from {border:.6} on, tensions {tensions:?} N",
                    braid.length_mm, braid.pressure_bar
                )
            });
        }
        Ok(())
    })
}
