//! Whatever the muscle and the question, also at the edges of the ranges: an equilibrium with a small residual, or an error with a number.

#![expect(clippy::unwrap_used, reason = "a test that can't be set up fails")]

use bulge_fibre::{Approach, FibreError, Given, Problem, Response};
use bulge_muscles::{
    Angle, Braided, Construction, FibreCount, Length, Muscle, Parameter, Pleated, Pressure, Quantity,
};
use bulge_validation::sample::Sampler;

/// What was seen, and what should not have been.
#[derive(Default)]
struct Log {
    solved: usize,
    refused: usize,
    not_converged: Vec<String>,
    violations: Vec<String>,
}

impl Log {
    fn check(
        &mut self,
        problem: &Problem,
        what: &str,
        outcome: Result<Response, FibreError>,
    ) -> Option<Response> {
        let case = || format!("{what}: {:?}", problem.parts());
        match outcome {
            Ok(found) => {
                self.solved += 1;
                if let Some(wrong) = wrong_with(&found) {
                    self.violations.push(format!("{wrong}; {}", case()));
                }
                Some(found)
            }
            Err(error) => {
                let text = error.to_string();
                if !text.contains(|c: char| c.is_ascii_digit()) || text.contains("NaN") {
                    self.violations.push(format!("an error without a number, `{text}`; {}", case()));
                }
                if matches!(error, FibreError::NotConverged { .. }) {
                    self.not_converged.push(format!("{text}; {}", case()));
                } else {
                    self.refused += 1;
                }
                None
            }
        }
    }

    fn finish(self, name: &str, most_not_converged: f64) {
        let all = self.solved + self.refused + self.not_converged.len();
        let (solved, refused, lost) = (self.solved, self.refused, self.not_converged.len());
        println!("{name}: {all} questions, {solved} solved, {refused} refused, {lost} not converged");
        for text in self.not_converged.iter().chain(&self.violations) {
            println!("  {text}");
        }
        assert!(
            self.violations.is_empty(),
            "{} violations:\n{}",
            self.violations.len(),
            self.violations.join("\n")
        );
        let share = lost as f64 / all as f64;
        assert!(
            share <= most_not_converged,
            "{lost} of {all} did not converge:\n{}",
            self.not_converged.join("\n")
        );
    }
}

fn wrong_with(r: &Response) -> Option<String> {
    let numbers = [
        ("pressure", r.pressure_pa),
        ("force", r.force_n),
        ("length", r.length_m),
        ("contraction", r.contraction),
        ("volume", r.volume_m3),
        ("polygon volume", r.volume_polygon_m3),
        ("largest radius", r.max_radius_m),
        ("mid radius", r.mid_radius_m),
        ("tension", r.fibre_tension_n),
        ("strain", r.fibre_strain),
        ("stiffness", r.stiffness_n_per_m),
        ("volume slope", r.volume_slope_m2),
        ("isothermal stiffness", r.stiffness_isothermal_n_per_m),
        ("adiabatic stiffness", r.stiffness_adiabatic_n_per_m),
        ("end slope", r.end_slope_rad),
        ("residual", r.convergence.residual),
        ("first integral", r.convergence.first_integral),
    ];
    if let Some((name, value)) = numbers.iter().find(|(_, value)| !value.is_finite()) {
        return Some(format!("{name} is {value}"));
    }
    let positive =
        [r.volume_m3, r.volume_polygon_m3, r.max_radius_m, r.mid_radius_m, r.fibre_tension_n, r.length_m];
    if positive.iter().any(|value| *value <= 0.0) {
        return Some(format!("volume, radius, tension and length must be positive: {positive:?}"));
    }
    if r.convergence.first_integral > 1e-9 {
        return Some(format!("first integral {:e}", r.convergence.first_integral));
    }
    // The last Newton step, which is applied after this residual was taken, squares it.
    (r.convergence.residual > 1e-6).then(|| format!("residual {:e}", r.convergence.residual))
}

/// Contractions over the range of a muscle and just inside and outside its ends.
fn contractions(problem: &Problem, log: &mut Log) -> Vec<f64> {
    // Elastic nets drawn far out are slow to refuse: they have no limit there.
    let far = if problem.parts().compliance > 0.0 { -0.02 } else { -0.3 };
    let mut asked = vec![far, -0.01, -1e-6, -1e-12, 0.0, 1e-15, 1e-12, 1e-9, 1e-6, 0.7, 1.0, 1.5];
    match problem.contraction_limit(Approach::Auto) {
        Ok(limit) => {
            asked.extend([0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99].map(|part| part * limit));
            asked.extend([-1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-6].map(|step| limit + step));
            if !limit.is_finite() {
                log.violations.push(format!("limit {limit}; {:?}", problem.parts()));
            }
        }
        Err(error) => {
            log.check(problem, "limit", Err(error));
        }
    }
    asked
}

#[test]
fn random_muscles() {
    let mut log = Log::default();
    let mut sampler = Sampler::new(2026);
    for i in 0..80 {
        let (muscle, pressure) = (sampler.muscle().unwrap(), sampler.pressure());
        let problem = Problem::new(&muscle, pressure).unwrap();
        for contraction in contractions(&problem, &mut log) {
            let outcome = problem.solve(Given::Contraction(contraction), Approach::Auto);
            log.check(&problem, &format!("number {i}, {pressure}, contraction {contraction:e}"), outcome);
        }
    }
    log.finish("random muscles", 0.02);
}

/// Cloth from just wider than the fibres at the fittings to plenty, between 3 and 300 fibres, with anything besides.
#[test]
fn random_lobes() {
    let mut log = Log::default();
    let mut sampler = Sampler::new(77);
    let mut asked = 0;
    while asked < 25 {
        let radius = sampler.log_between(0.002, 0.05);
        let fibres = sampler.log_between(3.0, 300.0).round();
        let open = radius * sampler.log_between(1.02, 6.0);
        let length = (radius * sampler.log_between(0.5, 1000.0)).min(600.0 * open / fibres);
        let mut muscle = pleated(length, radius).with(Parameter::Fibres, fibres).unwrap();
        muscle = muscle.with(Parameter::ClothCircumference, std::f64::consts::TAU * open).unwrap();
        if sampler.chance(0.3) {
            let total = 8e5 * length * length / sampler.log_between(1e-5, 1e-2);
            muscle = muscle.with(Parameter::FibreStiffness, total / fibres).unwrap();
        }
        if sampler.chance(0.2) {
            muscle = muscle.with(Parameter::PleatDepth, 0.5 * (open - radius)).unwrap();
        }
        if sampler.chance(0.2) {
            let stiffness = radius * 1e5 * sampler.log_between(0.1, 10.0);
            muscle = with_cloth(&muscle, stiffness, radius + 0.7 * (open - radius));
        }
        let pressure = sampler.pressure();
        // What is too soft or too slender is refused at once or along the way.
        let Ok(problem) = Problem::new(&muscle, pressure) else { continue };
        asked += 1;
        for contraction in contractions(&problem, &mut log) {
            let outcome = problem.solve(Given::Contraction(contraction), Approach::Auto);
            log.check(&problem, &format!("number {asked}, {pressure}, contraction {contraction:e}"), outcome);
        }
    }
    log.finish("random lobes", 0.02);
}

/// Inverse questions give back what they were asked with.
#[test]
fn force_length_and_volume_lead_back() {
    let mut log = Log::default();
    let mut sampler = Sampler::new(11);
    for i in 0..60 {
        let (muscle, pressure) = (sampler.muscle().unwrap(), sampler.pressure());
        let part = sampler.between(0.05, 0.95);
        let problem = Problem::new(&muscle, pressure).unwrap();
        let Ok(limit) = problem.contraction_limit(Approach::Auto) else { continue };
        if limit <= 0.0 {
            continue;
        }
        let what = format!("number {i}, {pressure}, {part} of the limit {limit}");
        let outcome = problem.solve(Given::Contraction(part * limit), Approach::Auto);
        let Some(there) = log.check(&problem, &what, outcome) else { continue };
        for given in
            [Given::Force(there.force_n), Given::Length(there.length_m), Given::Volume(there.volume_m3)]
        {
            // A waisted muscle has the same volume at two contractions; an elastic net searches its whole range for the smallest one.
            let is_volume = matches!(given, Given::Volume(_));
            if is_volume && (there.volume_slope_m2 >= 0.0 || muscle.fibre().is_some()) {
                continue;
            }
            let outcome = problem.solve(given, Approach::Auto);
            let Some(back) = log.check(&problem, &format!("{what}, {given:?}"), outcome) else { continue };
            let tolerance = 1e-8;
            if (back.contraction - there.contraction).abs() > tolerance {
                let [from, to] = [there.contraction, back.contraction];
                log.violations.push(format!("{what}, {given:?}: from {from} back to {to}; {muscle:?}"));
            }
        }
    }
    log.finish("inverse questions", 0.02);
}

/// Drawn points are finite, in order, and symmetric.
#[test]
fn meridians() {
    let mut sampler = Sampler::new(5);
    let mut drawn = 0;
    for i in 0..40 {
        let (muscle, pressure) = (sampler.muscle().unwrap(), sampler.pressure());
        let problem = Problem::new(&muscle, pressure).unwrap();
        let Ok(limit) = problem.contraction_limit(Approach::Auto) else { continue };
        for points in [3, 4, 50, 101] {
            let given = Given::Contraction(if limit > 0.0 { 0.6 * limit } else { 1.4 * limit });
            let Ok(shape) = problem.shape(given, Approach::Auto, points) else { continue };
            drawn += 1;
            let m = &shape.meridian;
            assert!(m.len() >= points && m.len() % 2 == 1, "number {i}: {} points", m.len());
            for (a, b) in m.iter().zip(m.iter().rev()) {
                let numbers = [a.x_m, a.r_m, a.slope_rad, a.braid_angle_rad, a.fibre_tension_n, a.turn_rad];
                assert!(numbers.iter().all(|v| v.is_finite()), "number {i}: {a:?}");
                assert!((a.r_m - b.r_m).abs() < 1e-15 && (a.slope_rad + b.slope_rad).abs() < 1e-15);
                assert!(
                    (a.x_m + b.x_m - shape.response.length_m).abs()
                        < 1e-12 * shape.response.length_m.max(1e-3)
                );
            }
            assert!(
                m.windows(2).all(|w| w[1].fibre_length_m > w[0].fibre_length_m),
                "number {i}: {muscle:?}"
            );
        }
    }
    println!("meridians: {drawn} drawn");
    assert!(drawn > 140, "only {drawn} of 160 meridians");
}

fn pleated(length: f64, radius: f64) -> Muscle {
    let pleated = Pleated::new(Length::m(radius), FibreCount::Discrete(40)).unwrap();
    Muscle::new("pleated", Length::m(length), Construction::Pleated(pleated)).unwrap()
}

fn braid(length: f64, radius: f64, degrees: f64, fitting: Option<f64>) -> Muscle {
    let braided = Braided::new(Length::m(radius), Angle::deg(degrees)).unwrap().with_fibres(60).unwrap();
    let muscle = Muscle::new("braid", Length::m(length), Construction::Braided(braided)).unwrap();
    fitting.map_or(muscle.clone(), |fitting| muscle.with(Parameter::FittingRadius, fitting).unwrap())
}

/// Cloth of a hoop stiffness \[N/m\] that is taut beyond a radius \[m\].
fn with_cloth(muscle: &Muscle, stiffness: f64, radius: f64) -> Muscle {
    let limit = [(Parameter::HoopStiffness, stiffness), (Parameter::UnfoldedRadius, radius)];
    muscle.with_all(&limit).unwrap()
}

/// Muscles at the edges of the ranges, and with two numbers nearly equal.
fn edges() -> Vec<Muscle> {
    let r = 0.01;
    let near = [-1e-3, -1e-6, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-6, 1e-3];
    let mut muscles = Vec::new();
    for slenderness in [0.5, 0.5 * (1.0 + 1e-12), 1.0, 1000.0 * (1.0 - 1e-12), 1000.0] {
        muscles.push(pleated(slenderness * r, r));
        muscles.push(pleated(slenderness * r, r).with(Parameter::FibreStiffness, 1e6).unwrap());
        muscles.push(pleated(slenderness * r, r).with(Parameter::FibreStiffness, 1e15).unwrap());
        muscles.push(pleated(slenderness * r, r).with(Parameter::PleatDepth, 1e-15).unwrap());
    }
    for degrees in [5.0, 5.0 + 1e-12, 25.0, 50.0 - 1e-12, 50.0] {
        for slenderness in [1.0, 1.0 + 1e-12, 10.0, 100.0 - 1e-10, 100.0] {
            muscles.push(braid(slenderness * r, r, degrees, None));
        }
    }
    for step in near {
        muscles.push(braid(0.12, r, 25.0, Some(r * (1.0 + step))));
        // Cloth that becomes taut at the fitting's radius and at the largest one (23.13 mm at 10 %).
        for radius in [r, 0.023_134_545_911_4] {
            muscles.push(with_cloth(&pleated(0.06875, r), 8e3, radius * (1.0 + step)));
        }
        let braid = braid(0.12, r, 25.0, None);
        let widest =
            Problem::new(&braid, PRESSURE).unwrap().follow(0.1, Approach::Auto).unwrap().max_radius_m;
        muscles.push(with_cloth(&braid, 8e3, widest * (1.0 + step)));
    }
    for misalignment in [1e-12, 1e-9, 1e-6, -1e-6, 1e-3] {
        muscles.push(pleated(0.06875, r).with(Parameter::Misalignment, misalignment).unwrap());
    }
    muscles
}

const PRESSURE: Pressure = Pressure::bar(2.0);

#[test]
fn nearly_equal_inputs() {
    let mut log = Log::default();
    for muscle in edges() {
        let problem = match Problem::new(&muscle, PRESSURE) {
            // Cloth a hair narrower than the fittings.
            Err(FibreError::ClothTooNarrow { .. }) => continue,
            other => other.unwrap(),
        };
        let mut asked = contractions(&problem, &mut log);
        asked.push(0.1);
        // Where the meridian is straight at the fitting's radius: a cylinder of inextensible fibres.
        if let Construction::Braided(braided) = muscle.construction() {
            let sin = braided.braid_angle().si().sin() * muscle.end_radius().si() / muscle.radius().si();
            let straight = 1.0 - (1.0 - sin * sin).sqrt() / braided.braid_angle().si().cos();
            asked.extend(
                [-1e-4, -1e-7, -1e-8, -1e-12, 0.0, 1e-15, 1e-8, 1e-7, 1e-4].map(|step| straight + step),
            );
        }
        for contraction in asked {
            let outcome = problem.solve(Given::Contraction(contraction), Approach::Auto);
            log.check(&problem, &format!("contraction {contraction:e}"), outcome);
            let Some(below) = problem.follow(contraction.min(0.9), Approach::Auto).ok() else { continue };
            log.check(&problem, &format!("followed to {contraction:e}"), Ok(below));
        }
    }
    log.finish("nearly equal inputs", 0.02);
}

/// Through the straight braid the force is continuous and the stiffness is its slope: no branch of the solver shows.
#[test]
fn no_jump_at_the_straight_braid() {
    let mut jumps = Vec::new();
    for (degrees, ratio) in [(5.0, 10.0), (25.0, 1.0), (25.0, 25.0), (50.0, 5.0), (50.0, 100.0)] {
        let muscle = braid(0.01 * ratio, 0.01, degrees, None);
        let problem = Problem::new(&muscle, PRESSURE).unwrap();
        let steps = [
            -1e-6, -4e-7, -2e-7, -1.01e-7, -0.99e-7, -1e-8, -1e-12, 0.0, 1e-12, 1e-8, 0.99e-7, 1.01e-7, 2e-7,
        ];
        let found = steps.map(|step| problem.follow(step, Approach::Auto).unwrap());
        for pair in found.windows(2) {
            let slope = 0.5 * (pair[0].stiffness_n_per_m + pair[1].stiffness_n_per_m);
            let expected = slope * (pair[1].length_m - pair[0].length_m);
            let jump = (pair[1].force_n - pair[0].force_n - expected) / pair[0].force_n;
            if jump.abs() > 1e-8 {
                let [from, to] = [pair[0].contraction, pair[1].contraction];
                jumps.push(format!(
                    "{degrees} deg, l0/r0 = {ratio}, from {from:e} to {to:e}: {jump:e} of the force"
                ));
            }
        }
    }
    assert!(jumps.is_empty(), "{}", jumps.join("\n"));
}

/// Questions that have no answer are refused with what was asked, not answered.
#[test]
fn questions_that_are_not_numbers() {
    let problem = Problem::new(&pleated(0.11, 0.016), PRESSURE).unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0] {
        for given in [Given::Contraction(bad), Given::Length(bad), Given::Force(bad), Given::Volume(bad)] {
            let error = problem.solve(given, Approach::Auto).unwrap_err().to_string();
            let says_it = error.contains(|c: char| c.is_ascii_digit()) || error.contains(&bad.to_string());
            assert!(says_it, "{given:?}: {error}");
        }
        assert!(Problem::new(&pleated(0.11, 0.016), Pressure::pa(bad)).is_err(), "a pressure of {bad} Pa");
    }
    assert!(Problem::new(&pleated(0.11, 0.016), Pressure::pa(0.0)).is_err());
}

/// A force is met, however large: inextensible fibres pull without bound as the contraction vanishes.
#[test]
fn large_forces_are_met() {
    let problem = Problem::new(&pleated(0.11, 0.016), PRESSURE).unwrap();
    for force in [1e3, 1e4, 1e5, 1e6, 1e7, 1e9, 1e12] {
        match problem.solve(Given::Force(force), Approach::Auto) {
            Ok(found) => assert!(
                (found.force_n / force - 1.0).abs() < 1e-6,
                "asked {force:e} N, got {:e} N",
                found.force_n
            ),
            Err(error) => assert!(error.to_string().contains(|c: char| c.is_ascii_digit()), "{error}"),
        }
    }
}

/// The force of a slender muscle is met near the limit, where it is small against p l0^2.
#[test]
fn small_forces_are_met() {
    for ratio in [5.0, 50.0, 130.0, 500.0, 1000.0] {
        let problem = Problem::new(&pleated(0.02 * ratio, 0.02), PRESSURE).unwrap();
        for force in [0.0, 1.0, 10.0] {
            let found = problem.solve(Given::Force(force), Approach::Auto).unwrap();
            let scale = PRESSURE.si() * (0.02 * ratio).powi(2);
            let gap = (found.force_n - force).abs() / scale;
            assert!(
                gap < 1e-11,
                "l0/R = {ratio}: asked {force} N, got {} N, {gap:e} of p l0^2",
                found.force_n
            );
        }
    }
}

/// No muscle is shorter than nothing.
#[test]
fn a_length_of_zero_is_refused() {
    for muscle in [pleated(0.11, 0.016), braid(0.01, 0.01, 5.0, None), braid(0.25, 0.01, 25.0, None)] {
        let problem = Problem::new(&muscle, PRESSURE).unwrap();
        for contraction in [1.0, 1.5] {
            let refused = problem.solve(Given::Contraction(contraction), Approach::Auto).unwrap_err();
            let otherwise = [
                problem.follow(contraction, Approach::Auto).unwrap_err(),
                problem.linearised(contraction, &problem.parts().still(), Approach::Auto).unwrap_err(),
                problem.gradient(contraction, Approach::Auto).unwrap_err(),
                problem.shape(Given::Contraction(contraction), Approach::Auto, 11).unwrap_err(),
                problem.isobar(&[contraction], Approach::Auto).unwrap_err(),
            ];
            for error in otherwise {
                let told = matches!(error, FibreError::BeyondLimit { .. }) || error == refused;
                assert!(told, "contraction {contraction}: {error}, not {refused}");
            }
        }
    }
}

/// Inextensible fibres drawn beyond their length: the error says where the limit lies.
#[test]
fn drawn_out_too_far_is_told() {
    let wide = braid(0.155_023_218_7, 0.007_173_099_24, 22.314_9, None);
    let nearly_straight = pleated(0.068_75, 0.01).with(Parameter::Misalignment, 1e-6).unwrap();
    for muscle in [wide, nearly_straight] {
        let problem = Problem::new(&muscle, PRESSURE).unwrap();
        for contraction in [-0.15, -0.3] {
            let error = problem.solve(Given::Contraction(contraction), Approach::Auto).unwrap_err();
            assert!(matches!(error, FibreError::TooLong { .. }), "contraction {contraction}: {error}");
        }
    }
}
