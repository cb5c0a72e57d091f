//! The muscles of the domain map: 15 kinds over the supported ranges.

use bulge_fibre::{BRAID_ANGLE, BRAIDED_SLENDERNESS, PLEATED_SLENDERNESS};
use bulge_muscles::{
    Angle, Braided, Construction, Ends, Fibre, FibreCount, Force, Length, Muscle, MuscleError, Parameter,
    Pleated, Quantity,
};

use crate::sample::Sampler;

/// Range of the gauge pressure \[Pa\].
const PRESSURE: [f64; 2] = [1e3, 1.5e6];
/// Range of the strain of the fibres due to pressure: about p R l0/(n EA), or 2 pi p r0^2/(n EA
/// sin^2(alpha0)) for a braid.
const STRETCH: [f64; 2] = [1e-6, 5e-2];
/// Range of K/(p R) of the cloth in a pleated muscle and in a braid.
const CLOTH: [[f64; 2]; 2] = [[1e-2, 1e6], [1e-2, 1e3]];
/// Range of c10 t/(p r0) of the bladder.
const RUBBER: [f64; 2] = [1e-4, 1e2];
/// A kind of muscle.
pub(super) type Kind = (&'static str, fn(&mut Sampler) -> Result<Muscle, MuscleError>);

/// The kinds of muscles, by name.
pub(super) const KINDS: [Kind; 15] = [
    ("pleated", |s| pleated(s, &[])),
    ("pleated, elastic", |s| pleated(s, &[Extra::Elastic])),
    ("pleated, deep pleats", |s| pleated(s, &[Extra::Depth])),
    ("pleated, cloth", |s| pleated(s, &[Extra::Cloth])),
    ("pleated, misaligned", |s| pleated(s, &[Extra::Misaligned])),
    ("pleated, lobes", lobes),
    ("pleated, anything", anything_pleated),
    ("braid", |s| braid(s, &[])),
    ("braid, other fittings", |s| braid(s, &[Extra::Fitting])),
    ("braid, elastic", |s| braid(s, &[Extra::Elastic])),
    ("braid, bladder", |s| braid(s, &[Extra::Rubber])),
    ("braid, gas on the inner wall", |s| braid(s, &[Extra::Depth])),
    ("braid, cloth", |s| braid(s, &[Extra::Cloth])),
    ("braid, anything", anything_braided),
    ("cylinder", cylinder),
];

/// Features of a muscle besides its fibres.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Extra {
    Elastic,
    Depth,
    Cloth,
    Misaligned,
    Rubber,
    Fitting,
}

/// The pressure \[Pa\] at which a muscle is evaluated. It is stored in the name, because ratios of stiffness
/// to pressure are drawn.
pub(super) fn reference(muscle: &Muscle) -> f64 {
    muscle.name().parse().unwrap_or(1e5)
}

fn pleated(sampler: &mut Sampler, extras: &[Extra]) -> Result<Muscle, MuscleError> {
    let has = |extra| extras.contains(&extra);
    let pressure = sampler.log_between(PRESSURE[0], PRESSURE[1]);
    let radius = sampler.log_between(0.002, 0.05);
    let [low, high] = PLEATED_SLENDERNESS;
    let most = if has(Extra::Misaligned) { BRAIDED_SLENDERNESS[1] } else { high };
    let length = radius * sampler.log_between(low, most);
    let count = sampler.one_of(&[Some(3), Some(12), Some(40), None]);
    let count = count.map_or(FibreCount::Continuous, FibreCount::Discrete);
    let construction = Construction::Pleated(Pleated::new(Length::m(radius), count)?);
    let mut muscle = Muscle::new(pressure.to_string(), Length::m(length), construction)?;
    if has(Extra::Depth) {
        muscle = muscle.with(Parameter::PleatDepth, radius * sampler.log_between(1e-3, 2.0))?;
    }
    if has(Extra::Misaligned) {
        let most = (0.9 * radius / (radius + 0.4 * length)).asin();
        muscle = muscle.with(Parameter::Misalignment, most * sampler.between(0.02, 1.0))?;
    }
    finished(sampler, muscle, extras, 0.4 * length)
}

fn lobes(sampler: &mut Sampler) -> Result<Muscle, MuscleError> {
    lobed(sampler, &[])
}

/// Cloth from slightly wider than the fibres at the fittings to plenty.
fn lobed(sampler: &mut Sampler, extras: &[Extra]) -> Result<Muscle, MuscleError> {
    let pressure = sampler.log_between(PRESSURE[0], PRESSURE[1]);
    let radius = sampler.log_between(0.002, 0.05);
    let fibres = sampler.log_between(3.0, 300.0).round();
    let open = radius * sampler.log_between(1.02, 6.0);
    let most = (PLEATED_SLENDERNESS[1] * radius).min(600.0 * open / fibres);
    let length = sampler.log_between(PLEATED_SLENDERNESS[0] * radius, most.max(0.6 * radius));
    let construction = Construction::Pleated(Pleated::new(Length::m(radius), FibreCount::Discrete(3))?);
    let muscle = Muscle::new(pressure.to_string(), Length::m(length), construction)?
        .with(Parameter::Fibres, fibres)?
        .with(Parameter::ClothCircumference, std::f64::consts::TAU * open)?;
    finished(sampler, muscle, extras, open - radius)
}

fn anything_pleated(sampler: &mut Sampler) -> Result<Muscle, MuscleError> {
    let lobes = sampler.chance(0.3);
    let extras = some(sampler, &[Extra::Elastic, Extra::Depth, Extra::Cloth, Extra::Misaligned]);
    if lobes { lobed(sampler, &extras) } else { pleated(sampler, &extras) }
}

fn anything_braided(sampler: &mut Sampler) -> Result<Muscle, MuscleError> {
    let extras = some(sampler, &[Extra::Elastic, Extra::Depth, Extra::Cloth, Extra::Rubber, Extra::Fitting]);
    braid(sampler, &extras)
}

/// Selects each with a probability of one half.
fn some(sampler: &mut Sampler, all: &[Extra]) -> Vec<Extra> {
    all.iter().copied().filter(|_| sampler.chance(0.5)).collect()
}

fn braid(sampler: &mut Sampler, extras: &[Extra]) -> Result<Muscle, MuscleError> {
    let has = |extra| extras.contains(&extra);
    let pressure = sampler.log_between(PRESSURE[0], PRESSURE[1]);
    let radius = sampler.log_between(0.002, 0.03);
    let length = radius * sampler.log_between(BRAIDED_SLENDERNESS[0], BRAIDED_SLENDERNESS[1]);
    let angle = Angle::deg(sampler.between(BRAID_ANGLE[0], BRAID_ANGLE[1]));
    let braided = Braided::new(Length::m(radius), angle)?.with_fibres(60)?;
    let fitting = if has(Extra::Fitting) { radius * sampler.between(0.2, 2.0) } else { radius };
    let mut muscle = Muscle::new(pressure.to_string(), Length::m(length), Construction::Braided(braided))?;
    if has(Extra::Fitting) {
        muscle = muscle.with(Parameter::FittingRadius, fitting)?;
    }
    if has(Extra::Depth) {
        let depth = radius.min(fitting) * sampler.between(0.01, 0.3);
        muscle = muscle.with_gas_wall(Some(Length::m(depth)))?;
    }
    finished(sampler, muscle, extras, 0.5 * radius)
}

fn cylinder(sampler: &mut Sampler) -> Result<Muscle, MuscleError> {
    let extras = some(sampler, &[Extra::Elastic, Extra::Rubber]);
    let pressure = sampler.log_between(PRESSURE[0], PRESSURE[1]);
    let radius = sampler.log_between(0.002, 0.03);
    let angle = Angle::deg(sampler.between(BRAID_ANGLE[0], BRAID_ANGLE[1]));
    let braided = Braided::new(Length::m(radius), angle)?.with_fibres(60)?.with_ends(Ends::Cylinder);
    let length = Length::m(radius * sampler.log_between(1.0, 100.0));
    let muscle = Muscle::new(pressure.to_string(), length, Construction::Braided(braided))?;
    finished(sampler, muscle, &extras, 0.5 * radius)
}

/// Adds the features with a stiffness: elastic fibres, a bladder, and cloth that comes taut within twice the
/// `room`.
fn finished(
    sampler: &mut Sampler,
    mut muscle: Muscle,
    extras: &[Extra],
    room: f64,
) -> Result<Muscle, MuscleError> {
    let (pressure, radius, length) = (reference(&muscle), muscle.radius().si(), muscle.length().si());
    if extras.contains(&Extra::Elastic) {
        let pull = match muscle.construction() {
            Construction::Braided(braided) => {
                std::f64::consts::TAU * (radius / braided.braid_angle().si().sin()).powi(2)
            }
            Construction::Pleated(_) => radius * length,
        } * pressure;
        let total = pull / sampler.log_between(STRETCH[0], STRETCH[1]);
        let each = total / muscle.fibres().map_or(1.0, f64::from);
        muscle = muscle.with_fibre(Fibre::new(Force::n(each))?)?;
    }
    if extras.contains(&Extra::Rubber) {
        let wall = radius * sampler.log_between(0.01, 0.3);
        let c10 = pressure * radius / wall * sampler.log_between(RUBBER[0], RUBBER[1]);
        let second = if sampler.chance(0.5) { sampler.between(0.0, 0.5) } else { 0.0 };
        let rubber = [(Parameter::Wall, wall), (Parameter::C10, c10), (Parameter::C01, second * c10)];
        muscle = muscle.with_all(&rubber)?;
    }
    if extras.contains(&Extra::Cloth) {
        let unfolded = muscle.end_radius().si() + room * sampler.log_between(1e-3, 2.0);
        let [low, high] = CLOTH[usize::from(!muscle.is_pleated())];
        let stiffness = pressure * radius * sampler.log_between(low, high);
        let cloth = [(Parameter::HoopStiffness, stiffness), (Parameter::UnfoldedRadius, unfolded)];
        muscle = muscle.with_all(&cloth)?;
    }
    Ok(muscle)
}
