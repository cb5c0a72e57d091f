//! A joint with the table that its file requests, and the joint as a field over the angle and both pressures.

use bulge_design::joint::{Checks, Joint, JointError, Pull};
use bulge_muscles::FileError;
use bulge_muscles::settings::Settings;
use serde::Serialize;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Mutex;

use super::{Field, FieldAxis, FieldOutput, NoValue};
use crate::file::outputs::{listed, unknown};
use crate::file::wish;
use crate::plan::TableRequirements;

/// Most equilibria that are cached for each muscle.
const MOST_KEPT: usize = 1 << 16;

/// Outputs that a table of a joint may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum JointOutput {
    /// Torque of both muscles \[N m\].
    Torque,
    /// -d(torque)/d(angle) at constant pressures \[N m/rad\].
    Stiffness,
    /// Torque of the agonist \[N m\], >= 0.
    TorqueAgonist,
    /// Torque of the antagonist \[N m\], <= 0.
    TorqueAntagonist,
    /// Contraction of the agonist \[-\].
    ContractionAgonist,
    /// Contraction of the antagonist \[-\].
    ContractionAntagonist,
}

impl JointOutput {
    /// All outputs.
    pub const ALL: [Self; 6] = [
        Self::Torque,
        Self::Stiffness,
        Self::TorqueAgonist,
        Self::TorqueAntagonist,
        Self::ContractionAgonist,
        Self::ContractionAntagonist,
    ];

    /// Its name; its index among torque, slope of the torque, and contraction; and the weights of both
    /// muscles.
    const fn parts(self) -> (&'static str, usize, [f64; 2]) {
        match self {
            Self::Torque => ("torque", 0, [1.0, 1.0]),
            Self::Stiffness => ("stiffness", 1, [-1.0, -1.0]),
            Self::TorqueAgonist => ("torque_agonist", 0, [1.0, 0.0]),
            Self::TorqueAntagonist => ("torque_antagonist", 0, [0.0, 1.0]),
            Self::ContractionAgonist => ("contraction_agonist", 2, [1.0, 0.0]),
            Self::ContractionAntagonist => ("contraction_antagonist", 2, [0.0, 1.0]),
        }
    }

    /// Its name in files and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.parts().0
    }

    /// Its unit; "1" for a pure number.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        ["N m", "N m/rad", "1"][self.parts().1]
    }
}

/// A joint and the outputs that are to be tabulated.
#[derive(Debug, Clone, Serialize)]
pub struct JointTable {
    /// The joint.
    #[serde(flatten)]
    pub joint: Joint,
    /// Outputs of the table.
    pub outputs: Vec<JointOutput>,
    /// Requirements on the table, if one is requested. Its outputs are those above; the requirements
    /// themselves hold none.
    pub table: Option<TableRequirements>,
}

impl JointTable {
    /// Reads a joint file as [`Joint::read`] does, and also its outputs and its table.
    ///
    /// # Errors
    /// As [`Joint::read`].
    pub fn read(path: impl AsRef<Path>, checks: Checks) -> Result<Self, FileError> {
        let (joint, (outputs, table)) = Joint::read(path.as_ref(), checks, wanted)?;
        Ok(Self { joint, outputs, table })
    }

    /// The same from TOML text; see [`Joint::from_toml`].
    ///
    /// # Errors
    /// As [`Joint::from_toml`].
    pub fn from_toml(
        text: &str,
        origin: &str,
        folder: Option<&Path>,
        checks: Checks,
    ) -> Result<Self, FileError> {
        let (joint, (outputs, table)) = Joint::from_toml(text, origin, folder, checks, wanted)?;
        Ok(Self { joint, outputs, table })
    }
}

/// The outputs that a joint file names, and its table.
fn wanted(settings: &Settings<'_>) -> Result<(Vec<JointOutput>, Option<TableRequirements>), FileError> {
    let table = wish::without_outputs(settings)?;
    let outputs = listed(settings, |item, name| {
        let names = JointOutput::ALL.map(JointOutput::name);
        let found = JointOutput::ALL.into_iter().find(|output| output.name() == name);
        found.ok_or_else(|| unknown(settings, item, name, names.into_iter(), &names.join(", ")))
    })?;
    Ok((outputs.unwrap_or_else(|| vec![JointOutput::Torque, JointOutput::Stiffness]), table))
}

/// Cached equilibria of a muscle. The keys are the bits of angle and pressure.
type Kept = Mutex<HashMap<[u64; 2], Pull>>;

/// A joint as a field: angle \[rad\], pressure of the agonist and of the antagonist \[Pa\].
#[derive(Debug)]
pub struct JointField<'a> {
    table: &'a JointTable,
    axes: Vec<FieldAxis>,
    outputs: Vec<FieldOutput>,
    /// On a grid the equilibria of each muscle recur at every pressure of the other muscle.
    kept: [Kept; 2],
}

impl<'a> JointField<'a> {
    /// The field of a joint with its outputs.
    #[must_use]
    pub fn new(table: &'a JointTable) -> Self {
        let axis = |name: &str, unit: &str, [low, high]: [f64; 2]| FieldAxis {
            name: name.to_owned(),
            unit: unit.to_owned(),
            low,
            high: Some(high),
        };
        let output = |output: &JointOutput| FieldOutput {
            name: output.name().to_owned(),
            unit: output.unit().to_owned(),
            is_singular: false,
            vanishes: false,
        };
        Self {
            table,
            axes: vec![
                axis("angle", "rad", table.joint.angle),
                axis("pressure_agonist", "Pa", table.joint.pressure),
                axis("pressure_antagonist", "Pa", table.joint.pressure),
            ],
            outputs: table.outputs.iter().map(output).collect(),
            kept: [Mutex::default(), Mutex::default()],
        }
    }

    /// The pull of a muscle, from the cache if it is there.
    fn pull(&self, which: usize, angle: f64, pressure: f64) -> Result<Pull, JointError> {
        let key = [angle.to_bits(), pressure.to_bits()];
        // A poisoned lock only costs speed.
        if let Ok(kept) = self.kept[which].lock()
            && let Some(pull) = kept.get(&key)
        {
            return Ok(*pull);
        }
        let pull = self.table.joint.muscles()[which].pull(angle, pressure)?;
        if let Ok(mut kept) = self.kept[which].lock()
            && kept.len() < MOST_KEPT
        {
            kept.insert(key, pull);
        }
        Ok(pull)
    }

    fn filled(&self, pulls: &[Pull; 2], values: &mut [f64]) {
        let [one, other] = pulls.map(|pull| [pull.torque, pull.by_angle, pull.contraction]);
        for (value, output) in values.iter_mut().zip(&self.table.outputs) {
            let (_, k, [a, b]) = output.parts();
            *value = a * one[k] + b * other[k];
        }
    }

    fn both(&self, angle: f64, [agonist, antagonist]: [f64; 2]) -> Result<[Pull; 2], JointError> {
        Ok([self.pull(0, angle, agonist)?, self.pull(1, angle, antagonist)?])
    }

    fn graded(
        &self,
        angle: f64,
        pressures: [f64; 2],
        values: &mut [f64],
        gradients: &mut [f64],
    ) -> Result<(), JointError> {
        let JointTable { joint, outputs, .. } = self.table;
        let [low, high] = joint.angle;
        let pulls = self.both(angle, pressures)?;
        self.filled(&pulls, values);
        let needs = |k: usize| outputs.iter().any(|output| output.parts().1 == k);
        // Derivatives by the angle and by the muscle's own pressure.
        let mut slopes = pulls.map(|pull| [[pull.by_angle, 0.0], [0.0; 2], [pull.contraction_by_angle, 0.0]]);
        for ((slopes, muscle), pressure) in slopes.iter_mut().zip(joint.muscles()).zip(pressures) {
            if needs(0) {
                slopes[0][1] = muscle.by_pressure(angle, pressure)?;
            }
            if needs(1) {
                slopes[1] = muscle.bend(high - low, angle, pressure)?;
            }
        }
        let [one, other] = slopes;
        for (gradient, output) in gradients.chunks_exact_mut(3).zip(outputs) {
            let (_, k, [a, b]) = output.parts();
            gradient.copy_from_slice(&[a * one[k][0] + b * other[k][0], a * one[k][1], b * other[k][1]]);
        }
        Ok(())
    }
}

/// Angle and pressures at a point of the field.
fn parts(point: &[f64]) -> Result<(f64, [f64; 2]), NoValue> {
    match point {
        [angle, agonist, antagonist] => Ok((*angle, [*agonist, *antagonist])),
        _ => Err(NoValue(format!("a joint has 3 axes, not {}", point.len()))),
    }
}

#[expect(clippy::needless_pass_by_value, reason = "taken by map_err")]
fn none(error: JointError) -> NoValue {
    NoValue(error.to_string())
}

impl Field for JointField<'_> {
    fn axes(&self) -> &[FieldAxis] {
        &self.axes
    }

    fn outputs(&self) -> &[FieldOutput] {
        &self.outputs
    }

    fn upper_end(&self, _: &[f64]) -> Result<f64, NoValue> {
        Ok(self.table.joint.angle[1])
    }

    fn values(&self, point: &[f64], values: &mut [f64]) -> Result<(), NoValue> {
        let (angle, pressures) = parts(point)?;
        let pulls = self.both(angle, pressures).map_err(none)?;
        self.filled(&pulls, values);
        Ok(())
    }

    fn gradients(&self, point: &[f64], values: &mut [f64], gradients: &mut [f64]) -> Result<(), NoValue> {
        let (angle, pressures) = parts(point)?;
        self.graded(angle, pressures, values, gradients).map_err(none)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::TableForm;
    use crate::{Requirements, build};
    use bulge_design::joint::JOINT_EXAMPLE;
    use bulge_table::Table;

    const LEVER: &str = "muscle = \"ppam-2-r16\"\nkind = \"lever\"\narm = \"40 mm\"\nbase = \"150 mm\"\nlever_angle = \"80 deg\"\ncontraction = \"20 %\"\nangle = \"-25..20 deg\"\npressure = \"0.5..3 bar\"\n";

    fn from(text: &str) -> Result<JointTable, FileError> {
        let (joint, (outputs, table)) = Joint::from_toml(text, "j.toml", None, Checks::Everywhere, wanted)?;
        Ok(JointTable { joint, outputs, table })
    }

    #[test]
    fn every_key_is_read() {
        let JointTable { outputs, table, .. } = from(JOINT_EXAMPLE).unwrap();
        assert_eq!(outputs, [JointOutput::Torque, JointOutput::Stiffness]);
        let table = table.unwrap();
        assert_eq!(
            (table.tolerance, table.gradient, table.max_bytes, table.checks),
            (1e-4, 1e-2, 1 << 20, 131_072)
        );
        assert!(table.outputs.is_empty() && from(LEVER).unwrap().table.is_none());
        for (text, old, new, parts) in [
            (LEVER, "kind", "outputs = [\"torqe\"]\nkind", &["j.toml:2:12", "did you mean `torque`?"][..]),
            (LEVER, "kind", "outputs = [\"torque\", \"torque\"]\nkind", &["named twice"]),
            (LEVER, "kind", "outputs = []\nkind", &["at least one output"]),
            (LEVER, "kind", "outputs = \"torque\"\nkind", &["a list of names"]),
            (JOINT_EXAMPLE, "tolerance", "tolerence", &["did you mean `tolerance`?"]),
            (JOINT_EXAMPLE, "max_size", "outputs = []\nmax_size", &["unknown key `outputs`"]),
            (JOINT_EXAMPLE, "1e-4", "2", &["`tolerance` is 2"]),
        ] {
            let message = from(&text.replace(old, new)).unwrap_err().to_string();
            assert!(parts.iter().all(|part| message.contains(part)), "{message:?} does not say {parts:?}");
        }
    }

    #[test]
    fn gradients_of_the_field_are_slopes() {
        let all = "[\"torque\", \"stiffness\", \"torque_agonist\", \"torque_antagonist\", \"contraction_agonist\", \"contraction_antagonist\"]";
        let pulley = JOINT_EXAMPLE.replace("[\"torque\", \"stiffness\"]", all);
        let lever = format!("outputs = {all}\n{LEVER}");
        let braids = lever
            .replace("ppam-2-r16", "dmsp-20-250")
            .replace("20 %", "8 %")
            .replace("-25..20", "-10..10")
            .replace("150", "300");
        for text in [pulley, lever, braids] {
            let joint = from(&text).unwrap();
            let field = JointField::new(&joint);
            assert_eq!((field.axes().len(), field.outputs()[1].unit.as_str()), (3, "N m/rad"));
            let point = [0.11, 1.2e5, 2.1e5];
            let (mut values, mut gradients) = ([0.0; 6], [0.0; 18]);
            field.gradients(&point, &mut values, &mut gradients).unwrap();
            for (i, step) in [1e-3, 1e2, 1e2].into_iter().enumerate() {
                let at = |times: f64| {
                    let mut point = point;
                    point[i] += times * step;
                    let mut values = [0.0; 6];
                    field.values(&point, &mut values).unwrap();
                    values
                };
                let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(at);
                for o in 0..6 {
                    let slope = (8.0 * (c[o] - b[o]) - (d[o] - a[o])) / (12.0 * step);
                    let size = values[o].abs() / [0.3, 1e5, 1e5][i];
                    assert!(
                        (gradients[3 * o + i] - slope).abs() < 1e-6 * size,
                        "{o} {i}: {} {slope}",
                        gradients[3 * o + i]
                    );
                }
            }
            assert!((values[0] - values[2] - values[3]).abs() < 1e-12 && values[2] > 0.0 && values[3] < 0.0);
        }
    }

    #[test]
    fn a_certified_table() {
        let joint = from(&JOINT_EXAMPLE.replace("-25 deg..25 deg", "-20 deg..20 deg")).unwrap();
        let field = JointField::new(&joint);
        let wish = Requirements {
            tolerance: 1e-4,
            gradient: 1e-2,
            max_bytes: 1 << 20,
            form: TableForm::Chebyshev,
            checks: 4000,
            text: "{}".to_owned(),
        };
        let built = build(&field, &wish, &|_| {}).unwrap();
        assert!(built.is_met);
        for certificate in &built.certificates {
            assert!(certificate.value_max <= 1e-4 && certificate.gradient_max <= 1e-2, "{certificate:?}");
        }
        let table = Table::from_bytes(&built.bytes).unwrap();
        // Torque is linear in the pressures: few coefficients.
        assert!(built.bytes.len() < 1500, "{} bytes", built.bytes.len());
        let [torque, stiffness] = table.lookup::<3, 2>().unwrap().at([0.1, 2e5, 1e5]).unwrap();
        let exact = joint.joint.torque(0.1, 2e5, 1e5).unwrap();
        assert!((torque.value / exact - 1.0).abs() < 1e-4, "{} {exact}", torque.value);
        let exact = joint.joint.stiffness(0.1, 2e5, 1e5).unwrap();
        assert!(
            (stiffness.value / exact - 1.0).abs() < 1e-4 && (torque.gradient[0] / exact + 1.0).abs() < 1e-2
        );
    }
}
