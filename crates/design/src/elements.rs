//! The equilibrium of a muscle by membrane finite elements of revolution.
//!
//! Fibres are threads on a line of quadratic elements, a bladder is a sheet of rubber on the same line. A
//! pleated muscle of n fibres is treated as one of revolution under the pressure p sin(2 pi/n)/(2 pi/n), the
//! ratio of the area of the polygon to that of the circle.

use bulge_fibre::{
    ADIABATIC, AMBIENT_PRESSURE, Approach, Convergence, FibreError, Given, MeridianPoint, Method, Parts,
    Problem, Response, Shape,
};
use bulge_membrane::mesher::{Grading, revolved};
use bulge_membrane::{
    Cloth, Copies, Fitting, Inflation, Law, Load, MembraneError, Part, RingLayer, Sheet, Solver, State,
    Structure, Support, Thread, Tolerance,
};
use bulge_model::MuscleWithEffects;
use bulge_muscles::{Ends, Pressure, Quantity};
use std::f64::consts::{PI, TAU};

/// Least number of elements.
const ELEMENTS: usize = 200;
/// Step of contraction. A long braid has more than one equilibrium, and small steps stay on the first branch.
const STEP: f64 = 0.025;
/// Step of contraction for central differences.
const DIFFERENCE: f64 = 1e-4;

/// Why elements give no shape of a muscle.
#[derive(Debug, thiserror::Error)]
pub enum ElementsError {
    /// A property that elements of revolution can't model.
    #[error("membrane elements of revolution know no {0}")]
    Unknown(&'static str),
    /// An error of the meridian, which decides what is possible.
    #[error(transparent)]
    Equilibrium(#[from] FibreError),
    /// An error of the elements.
    #[error("membrane elements: {0}")]
    Elements(#[from] MembraneError),
}

/// The mesh and the solver of a muscle.
struct Elements {
    solver: Solver,
    /// Effective pressure \[Pa\], and the ratio of the polygon's area to that of the circle.
    pressure: f64,
    share: f64,
    length: f64,
    radius: f64,
    /// sin(alpha0), number of threads, and mesh nodes per point of the meridian.
    sine: f64,
    threads: f64,
    every: usize,
}

/// The equilibrium of a muscle at a gauge pressure, with this many points of the meridian. No shape effects
/// are included other than those of the kind, the ends, the fibres and the bladder.
///
/// # Errors
/// [`ElementsError`].
pub fn shape(
    extended: &MuscleWithEffects,
    pressure: Pressure,
    given: Given,
    points: usize,
) -> Result<Shape, ElementsError> {
    check(extended)?;
    let parts = extended.parts();
    // The meridian decides what is possible. For a given force or volume it also gives the approximate
    // contraction, which is corrected below.
    let near = Problem::new(parts, pressure)?.solve(given, Approach::Auto)?.contraction;
    let mut elements = Elements::new(parts, pressure, points)?;
    let contraction = match given {
        Given::Contraction(contraction) => contraction,
        Given::Length(length) => 1.0 - length / elements.length,
        Given::Force(_) | Given::Volume(_) => near,
    };
    let mut state = elements.at(contraction)?;
    let mut slopes = elements.slopes(contraction, &state)?;
    // The two solutions are so close that one Newton step suffices.
    let off = match given {
        Given::Force(force) => (force - state.forces[1]) / (-elements.length * slopes[0]),
        Given::Volume(volume) => (volume - state.volume) / (-elements.length * slopes[1]),
        Given::Contraction(_) | Given::Length(_) => 0.0,
    };
    let contraction = contraction + off;
    if off != 0.0 {
        state = elements.at(contraction)?;
        slopes = elements.slopes(contraction, &state)?;
    }
    Ok(elements.drawn(contraction, &state, slopes, pressure.si()))
}

fn check(extended: &MuscleWithEffects) -> Result<(), ElementsError> {
    let parts = extended.parts();
    let strange = [
        (extended.adds_force() || !extended.used().is_empty(), "effects"),
        (parts.cloth.is_some(), "limited unfolding"),
        (parts.lobes.is_some(), "lobes"),
        (parts.depth > 0.0, "pleat depth"),
        (parts.is_pleated() && parts.angle != 0.0, "misaligned fibres"),
        (parts.ends == Ends::Cylinder, "cylinder without ends"),
        (
            parts.fitting.is_some_and(|fitting| (fitting - parts.radius).abs() > 0.0),
            "fittings of another radius",
        ),
        (parts.depth < 0.0, "gas inside a thick wall"),
    ];
    match strange.into_iter().find(|(is_there, _)| *is_there) {
        Some((_, what)) => Err(ElementsError::Unknown(what)),
        None => Ok(()),
    }
}

/// Slope of the meridian at a node, from the parabola of its element. Where two elements meet, it is the mean
/// of both.
fn slope(places: &[[f64; 3]], node: usize) -> f64 {
    let of = |element: usize, xi: f64| {
        let [a, m, b] = [0, 1, 2].map(|k| places[2 * element + k]);
        let d = |i: usize| (xi - 0.5) * a[i] - 2.0 * xi * m[i] + (xi + 0.5) * b[i];
        d(0).atan2(d(2))
    };
    match (node % 2, node / 2) {
        (1, element) => of(element, 0.0),
        (_, 0) => of(0, -1.0),
        (_, element) if node + 1 == places.len() => of(element - 1, 1.0),
        (_, element) => 0.5 * (of(element - 1, 1.0) + of(element, -1.0)),
    }
}

impl Elements {
    fn new(parts: &Parts, pressure: Pressure, points: usize) -> Result<Self, ElementsError> {
        let Parts { length, radius, angle, .. } = *parts;
        let of_polygon = |n: f64| (TAU / n).sin() / (TAU / n);
        let share = parts.fibres.filter(|_| parts.is_polygon).map_or(1.0, of_polygon);
        let threads = parts.fibres.unwrap_or(1.0);
        let thread = if parts.compliance > 0.0 {
            Thread::Elastic { stiffness: 1.0 / (parts.compliance * threads) }
        } else {
            Thread::Inextensible
        };
        let mut layers = vec![RingLayer::Threads { thread, count: threads, angle }];
        if let Some(rubber) = parts.rubber {
            let law = Law::MooneyRivlin { c1: rubber.wall * rubber.c10, c2: rubber.wall * rubber.c01 };
            let sheet = Sheet { cloth: Cloth::Isotropic(law), wrinkles: false, residual: 0.0 };
            layers.push(RingLayer::Sheet { sheet, fullness: 1.0 });
        }
        // The number of elements makes every point of the meridian a node.
        let halves = points.div_ceil(2).max(2) - usize::from(points % 2 == 1);
        let every = ELEMENTS.div_ceil(halves);
        let mesh = revolved(|t| [radius, length * t], halves * every, true, Grading::Ends(3.0));
        let ends = [("first", 0), ("last", 1)];
        let supports = ends.map(|(group, fitting)| (group.to_owned(), Support::Fitting { fitting }));
        let walls = [("wall".to_owned(), Part::Revolved { layers })];
        let structure = Structure::new(&mesh, &walls, &supports, &[Fitting::Placed; 2])?;
        let solver = Solver::new(structure, Copies::ONE, Tolerance::default())?;
        let pressure = pressure.si() * share;
        Ok(Self { solver, pressure, share, length, radius, sine: angle.sin(), threads, every })
    }

    fn load(&self, contraction: f64) -> Load {
        let fittings = vec![0.0, -contraction * self.length];
        Load { inflation: Inflation::Pressure(self.pressure), fittings }
    }

    /// Moves from rest to a contraction in small steps.
    fn at(&mut self, contraction: f64) -> Result<State, ElementsError> {
        let mut state = self.solver.at_rest();
        let mut before = Load { inflation: Inflation::Pressure(0.0), fittings: vec![0.0; 2] };
        let first = contraction.min(STEP);
        let mut steps = vec![first];
        while steps.last().is_some_and(|last| contraction - last > 1e-12) {
            steps.push((first + steps.len() as f64 * STEP).min(contraction));
        }
        for step in steps {
            let load = self.load(step);
            state = self.solver.follow(&before, &state, &load, |_, _| ())?;
            before = load;
        }
        Ok(state)
    }

    /// dF/dl, dV/dl and dF/dp (for enclosed gas) at a state.
    fn slopes(&mut self, contraction: f64, state: &State) -> Result<[f64; 3], ElementsError> {
        let mut ends = Vec::new();
        for sign in [-1.0, 1.0] {
            let load = self.load(contraction + sign * DIFFERENCE);
            ends.push(self.solver.follow(&self.load(contraction), state, &load, |_, _| ())?);
        }
        let over = -1.0 / (2.0 * DIFFERENCE * self.length);
        let slope = |of: &dyn Fn(&State) -> f64| over * (of(&ends[1]) - of(&ends[0]));
        let mut stiffer = self.load(contraction);
        let more = 1e-4 * self.pressure;
        stiffer.inflation = Inflation::Pressure(self.pressure + more);
        let pressed = self.solver.follow(&self.load(contraction), state, &stiffer, |_, _| ())?;
        Ok([slope(&|s| s.forces[1]), slope(&|s| s.volume), (pressed.volume - state.volume) / more])
    }

    fn drawn(&mut self, contraction: f64, state: &State, slopes: [f64; 3], pressure: f64) -> Shape {
        let fields = self.solver.fields(state);
        let threads = &fields.groups[0].threads[0];
        let rubber = fields.groups[0].sheets.first();
        let places = &fields.places;
        let force = state.forces[1];
        let cosine = (1.0 - self.sine * self.sine).sqrt();
        let mut departure = 0.0_f64;
        let last = places.len() - 1;
        let near = |node: usize| [node.saturating_sub(1) / 2, (node / 2).min(threads.len() - 1)];
        let point = |node: usize| {
            let [x, _, z] = places[node];
            let mean = |of: &dyn Fn(usize) -> f64| 0.5 * near(node).map(of).iter().sum::<f64>();
            let strain = mean(&|e| threads[e].stretch) - 1.0;
            let slope = slope(places, node);
            let carried = force + self.pressure * PI * x * x;
            MeridianPoint {
                x_m: z,
                r_m: x,
                slope_rad: slope,
                braid_angle_rad: (x * self.sine / (self.radius * (1.0 + strain))).asin(),
                fibre_tension_n: mean(&|e| threads[e].tension),
                fibre_strain: strain,
                membrane_force_n_per_m: carried / slope.cos() / (TAU * x),
                // The material keeps its azimuth, and the mesh is the muscle at rest, a tube.
                fibre_length_m: (z - fields.displacements[node][2]) / cosine,
                turn_rad: (z - fields.displacements[node][2]) * self.sine / (cosine * self.radius),
            }
        };
        let meridian: Vec<MeridianPoint> = (0..=last).step_by(self.every).map(point).collect();
        // Equilibrium in the middle of every element: N cos(psi) = F + p A.
        for (e, thread) in threads.iter().enumerate() {
            let at = point(2 * e + 1);
            let sheet = rubber.map_or(0.0, |sheet| sheet[e].force[0] * TAU * at.r_m);
            let net = self.threads * thread.tension * thread.angle.cos() + sheet;
            let carried = force + self.pressure * PI * at.r_m * at.r_m;
            let scale = carried.abs().max(self.pressure * PI * self.radius * self.radius);
            departure = departure.max((net * at.slope_rad.cos() - carried).abs() / scale);
        }
        let [stiffness, volume_slope, swelling] = slopes;
        // The pressure of enclosed gas falls as the volume grows: dp/dl = -g p_abs dV/dl/(V + g p_abs dV/dp).
        let enclosed = |exponent: f64| {
            let absolute = exponent * (pressure + AMBIENT_PRESSURE);
            let (v, dv, swelling) =
                (self.share * state.volume, self.share * volume_slope, self.share * swelling * self.share);
            // dF/dp = -dV/dl at constant length (Maxwell), for the volume of the polygon.
            stiffness + dv * absolute * dv / (v + absolute * swelling)
        };
        let largest = meridian.iter().fold(0.0_f64, |a, at| a.max(at.r_m));
        let middle = meridian[meridian.len() / 2].r_m;
        Shape {
            response: Response {
                pressure_pa: pressure,
                force_n: force,
                length_m: self.length * (1.0 - contraction),
                contraction,
                volume_m3: state.volume,
                volume_polygon_m3: self.share * state.volume,
                max_radius_m: largest,
                mid_radius_m: middle,
                fibre_tension_n: threads.iter().fold(0.0_f64, |a, t| a.max(t.tension)),
                fibre_strain: threads.iter().fold(0.0_f64, |a, t| a.max(t.stretch - 1.0)),
                stiffness_n_per_m: stiffness,
                volume_slope_m2: self.share * volume_slope,
                stiffness_isothermal_n_per_m: enclosed(1.0),
                stiffness_adiabatic_n_per_m: enclosed(ADIABATIC),
                end_slope_rad: meridian.first().map_or(0.0, |at| at.slope_rad),
                method: Method::Membrane,
                convergence: Convergence {
                    iterations: u32::try_from(self.solver.effort().iterations).unwrap_or(u32::MAX),
                    evaluations: u32::try_from(self.solver.effort().factorisations).unwrap_or(u32::MAX),
                    steps: 0,
                    residual: state.residual,
                    first_integral: departure,
                },
            },
            meridian,
        }
    }
}
