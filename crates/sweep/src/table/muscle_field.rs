//! A family of muscles as a field. The contraction is the first axis and ends at its limit.

use super::{Field, FieldAxis, FieldOutput, NoValue};
use crate::family::Family;
use crate::family_error::FamilyError;
use crate::output::Output;
use crate::plan::{Axis, End, Plan, Quantity, Range, TableRequirements};

/// The field of the family of a plan, with the outputs of its table.
#[derive(Debug)]
pub struct MuscleField {
    family: Family,
    /// Index in the plan of each axis of the field.
    places: Vec<usize>,
    axes: Vec<FieldAxis>,
    outputs: Vec<FieldOutput>,
    kinds: Vec<Output>,
}

impl MuscleField {
    /// The field of a plan whose axes all have ranges.
    ///
    /// # Errors
    /// If the family has no muscle in the middle of its axes.
    pub fn new(plan: &Plan, wish: &TableRequirements) -> Result<Self, FamilyError> {
        let family = Family::new(plan)?;
        let mut places: Vec<usize> = (0..plan.axes.len()).collect();
        // The contraction comes first; the order of the other axes stays.
        places.sort_by_key(|i| plan.axes[*i].quantity != Quantity::Contraction);
        let ends = |axis: &Axis| match &axis.range {
            Range::Between { from, to: End::Value(to), .. } => (*from, Some(*to)),
            Range::Between { from, to: End::Limit, .. } => (*from, None),
            Range::List(values) => {
                (values.first().copied().unwrap_or(0.0), Some(values.last().copied().unwrap_or(0.0)))
            }
        };
        let axes: Vec<FieldAxis> = places
            .iter()
            .map(|i| {
                let axis = &plan.axes[*i];
                let (low, high) = ends(axis);
                FieldAxis { name: axis.name.clone(), unit: axis.unit.clone(), low, high }
            })
            .collect();
        let middle: Vec<f64> = plan
            .axes
            .iter()
            .map(|axis| {
                let (low, high) = ends(axis);
                0.5 * (low + high.unwrap_or(low))
            })
            .collect();
        let starts_at_zero = plan.axes[places[0]].quantity == Quantity::Contraction && axes[0].low == 0.0;
        let is_singular = starts_at_zero && family.member(&middle)?.problem().is_singular();
        let is_exact = |output: &&Output| {
            matches!(output, Output::ForceF | Output::VolumeV | Output::Force | Output::Volume)
        };
        if let Some(steep) = wish.outputs.iter().find(|output| is_singular && !is_exact(output)) {
            let output = steep.name();
            return Err(FamilyError::Input(format!(
                "a table of `{output}` can't begin at a contraction of 0, where the force of inextensible fibres is infinite: begin at \"0.5 %..limit\", say, or leave `{output}` out"
            )));
        }
        let to_limit = axes[0].high.is_none();
        if let (Quantity::Contraction, Some(high)) = (&plan.axes[places[0]].quantity, axes[0].high) {
            ends_before_limit(&family, plan, high)?;
        }
        let output = |output: &Output| FieldOutput {
            name: output.name(),
            unit: output.unit(),
            is_singular: is_singular
                && matches!(output, Output::ForceF | Output::Force | Output::FibreTension),
            vanishes: to_limit && matches!(output, Output::ForceF | Output::Force),
        };
        let outputs = wish.outputs.iter().map(output).collect();
        Ok(Self { family, places, axes, outputs, kinds: wish.outputs.clone() })
    }

    /// Values in the order of the axes of the plan.
    fn planned(&self, point: &[f64]) -> Vec<f64> {
        let mut planned = vec![0.0; point.len()];
        for (place, value) in self.places.iter().zip(point) {
            planned[*place] = *value;
        }
        planned
    }
}

/// Refuses a contraction beyond the limit of any muscle in the corners and middles of the other axes, because
/// a tabulated muscle must not push.
fn ends_before_limit(family: &Family, plan: &Plan, contraction: f64) -> Result<(), FamilyError> {
    let count = plan.axes.len();
    for corner in 0..3_usize.pow(u32::try_from(count).unwrap_or(0)) {
        let mut rest = corner;
        let mut point = vec![0.0; count];
        for (x, axis) in point.iter_mut().zip(&plan.axes) {
            if let Range::Between { from, to: End::Value(to), .. } = axis.range {
                *x = from + (to - from) * (rest % 3) as f64 / 2.0;
            }
            rest /= 3;
        }
        let end = family.member(&point)?.range_end()?;
        if contraction > end.contraction() {
            return Err(end.beyond(contraction).into());
        }
    }
    Ok(())
}

fn none(what: &str, planned: &[f64]) -> impl Fn(FamilyError) -> NoValue {
    let at: Vec<String> = planned.iter().map(|x| format!("{x:.6}")).collect();
    let what = format!("{what} at ({})", at.join(", "));
    move |error| NoValue(format!("{what}: {error}"))
}

impl Field for MuscleField {
    fn axes(&self) -> &[FieldAxis] {
        &self.axes
    }

    fn outputs(&self) -> &[FieldOutput] {
        &self.outputs
    }

    fn upper_end(&self, others: &[f64]) -> Result<f64, NoValue> {
        let mut point = vec![self.axes[0].low];
        point.extend_from_slice(others);
        let planned = self.planned(&point);
        let limit = self.family.member(&planned).and_then(|member| member.contraction_limit());
        limit
            .map_err(none("no contraction at which the force vanishes, where this table is to end", &planned))
    }

    fn values(&self, point: &[f64], values: &mut [f64]) -> Result<(), NoValue> {
        let planned = self.planned(point);
        let contraction = self.family.contraction(&planned);
        self.family
            .member(&planned)
            .and_then(|member| member.outputs(contraction, &self.kinds, values))
            .map_err(none("no equilibrium", &planned))
    }

    fn gradients(&self, point: &[f64], values: &mut [f64], gradients: &mut [f64]) -> Result<(), NoValue> {
        let planned = self.planned(point);
        let mut found = vec![0.0; gradients.len()];
        let asked = self.family.gradients(&planned, &self.kinds, values, &mut found);
        asked.map_err(none("no derivatives", &planned))?;
        let axes = point.len();
        for o in 0..self.kinds.len() {
            for (i, place) in self.places.iter().enumerate() {
                gradients[o * axes + i] = found[o * axes + place];
            }
        }
        Ok(())
    }
}
