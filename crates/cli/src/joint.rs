//! `bulge joint`: two antagonistic muscles on a joint: its equilibrium angle, its stiffness, and the
//! pressures it needs.

use bulge_design::joint::{
    Checks, JOINT_EXAMPLE, Joint, JointAnswer, JointError, JointGas, JointParts, JointState, MapPlace,
    Outside,
};
use bulge_muscles::units::Quantity;
use bulge_muscles::{Angle, Force, Pressure, Volume};
use bulge_report::lines_svg;
use bulge_sweep::JointTable;
use clap::{Args, ValueEnum};
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{Json, in_unit, list, quantity};
use crate::failure::Failure;
use crate::files;
use crate::text::{shown, significant, table, with_units};

/// What the gas of a closed muscle does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Gas {
    /// Slow: it keeps its temperature
    Isothermal,
    /// Fast: it keeps its heat
    Adiabatic,
}

/// Two antagonistic muscles on a joint: where it stands, how stiff it is, and which pressures it needs.
///
/// With two pressures: the angle at which it rests, under `--torque` from outside, and its stiffness with open and with shut valves. With two pressures and an
/// angle: the torque from outside that holds it there, and how sure that is. With an angle and a stiffness: the pressures. Without any: its range over both pressures.
#[derive(Debug, Args)]
#[command(after_long_help = shown("A joint file", JOINT_EXAMPLE))]
pub(crate) struct JointCommand {
    /// A joint file (`bulge joint --help` shows one with every key)
    joint: PathBuf,
    /// Gauge pressures of agonist and antagonist, such as "2 bar,1.5 bar"
    #[arg(long, allow_hyphen_values = true)]
    pressure: Option<String>,
    /// Angle of the joint, such as "10 deg"
    #[arg(long, allow_hyphen_values = true)]
    angle: Option<String>,
    /// Stiffness that is wanted at the angle, such as "200 N m/rad"
    #[arg(long, allow_hyphen_values = true, requires = "angle", conflicts_with = "pressure")]
    stiffness: Option<String>,
    /// Torque from outside, such as "2 N m": positive where it turns the joint to positive angles
    #[arg(long, allow_hyphen_values = true)]
    torque: Option<String>,
    /// Shut both valves where the joint rests without the torque, and then let it act
    #[arg(long, value_enum, requires = "torque", requires = "pressure", conflicts_with = "angle")]
    closed: Option<Gas>,
    /// Dead volume of fittings and tubes of each closed muscle, such as "20 ml"
    #[arg(long, requires = "closed", allow_hyphen_values = true)]
    dead_volume: Option<String>,
    /// Standard deviation of each pressure reading
    #[arg(long, default_value = "0 Pa", requires_all = ["angle", "pressure"], allow_hyphen_values = true)]
    pressure_sd: String,
    /// Standard deviation of the angle reading
    #[arg(long, default_value = "0 deg", requires_all = ["angle", "pressure"], allow_hyphen_values = true)]
    angle_sd: String,
    /// Standard deviation of the model's force: what `bulge fit` leaves; the widths of what it has learnt count by themselves
    #[arg(long, default_value = "0 N", requires_all = ["angle", "pressure"], allow_hyphen_values = true)]
    force_sd: String,
    /// Draw the torque against the angle at several pairs of pressures
    #[arg(long, value_name = "FILE.svg", value_parser = files::picture)]
    plot: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl JointCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        // Maps and plots need the whole range of the joint; a single state doesn't.
        let is_point = self.plot.is_none() && (self.pressure.is_some() || self.angle.is_some());
        let checks = if is_point { Checks::Linkage } else { Checks::Everywhere };
        let joint = JointTable::read(&self.joint, checks)?.joint;
        let question = self.parts()?.question()?;
        let answer = joint.answer(&question)?;
        let mut wrote = String::new();
        if let Some(path) = &self.plot {
            let drawing = joint.drawing()?;
            let svg = lines_svg(&drawing.title, drawing.axes, &drawing.lines)?;
            files::write(path, svg.as_bytes())?;
            let _ = writeln!(wrote, "\n  wrote {}", path.display());
        }
        let document = serde_json::to_value(joint.document(&question, &answer))?;
        let torque = question.torque_nm();
        self.json.or(&document, || format!("{}\n\n{}{wrote}", joint.name, self.text(&joint, &answer, torque)))
    }

    fn parts(&self) -> Result<JointParts, Failure> {
        let pressures =
            self.pressure.as_deref().map(|text| list::<Pressure>("--pressure", text)).transpose()?;
        let angle = self.angle.as_deref().map(|text| quantity::<Angle>("--angle", text)).transpose()?;
        let readings = [
            quantity::<Pressure>("--pressure-sd", &self.pressure_sd)?.si(),
            quantity::<Angle>("--angle-sd", &self.angle_sd)?.si(),
            quantity::<Force>("--force-sd", &self.force_sd)?.si(),
        ];
        let is_held = self.pressure.is_some() && self.angle.is_some();
        let dead = self.dead_volume.as_deref().map(|text| quantity::<Volume>("--dead-volume", text));
        let unit = |option, text: &Option<String>, units| -> Result<Option<f64>, Failure> {
            text.as_deref().map(|text| in_unit(option, text, units)).transpose()
        };
        Ok(JointParts {
            pressures_pa: pressures.map(|all| all.into_iter().map(Quantity::si).collect()),
            angle_rad: angle.map(Quantity::si),
            torque_nm: unit("--torque", &self.torque, &TORQUE)?,
            stiffness: unit("--stiffness", &self.stiffness, &STIFFNESS)?,
            closed: self.closed.map(|gas| match gas {
                Gas::Isothermal => JointGas::Isothermal,
                Gas::Adiabatic => JointGas::Adiabatic,
            }),
            dead_volume_m3: dead.transpose()?.map(Quantity::si),
            // Their defaults count where they are asked for alone.
            readings: readings.map(|sd| is_held.then_some(sd)),
        })
    }

    fn text(&self, joint: &Joint, answer: &JointAnswer, torque: f64) -> String {
        match answer {
            JointAnswer::Shut { before, stand, shut_nm_per_rad: [stiff, after], .. } => format!(
                "{}\n{}\n  turned by {} deg with shut valves; stiffness of the shut joint with its dead volume {} N m/rad before, {} after\n",
                standing("rests, and the valves are shut,", before, 0.0),
                standing("rests", stand, torque),
                degrees(stand.angle_rad - before.angle_rad),
                significant(*stiff, 4),
                significant(*after, 4)
            ),
            JointAnswer::Held { stand, outside, .. } => {
                standing("is held", stand, outside.torque_nm) + &surely(outside)
            }
            JointAnswer::Stand { stand } => {
                let how = if self.stiffness.is_some() { "stands" } else { "rests" };
                standing(how, stand, torque)
            }
            JointAnswer::Map { map } => mapped(joint, map, torque),
        }
    }
}

impl From<JointError> for Failure {
    fn from(error: JointError) -> Self {
        Self::Outside(error.to_string())
    }
}

/// Units of a torque and of a stiffness.
const TORQUE: [(&str, f64); 4] = [("N m", 1.0), ("Nm", 1.0), ("N mm", 1e-3), ("Nmm", 1e-3)];
const STIFFNESS: [(&str, f64); 4] = [
    ("N m/rad", 1.0),
    ("Nm/rad", 1.0),
    ("N m/deg", 57.295_779_513_082_32),
    ("Nm/deg", 57.295_779_513_082_32),
];

fn degrees(angle: f64) -> String {
    // A tiny angle at rest is rounding.
    if angle.abs() < 1e-9 { "0".to_owned() } else { significant(angle.to_degrees(), 4) }
}

fn bar(pressure: f64) -> String {
    significant(1e-5 * pressure, 4)
}

/// A state of the joint in words and numbers.
fn standing(how: &str, stand: &JointState, outside: f64) -> String {
    let under = if outside == 0.0 {
        String::new()
    } else {
        format!(" under {} N m from outside", significant(outside, 4))
    };
    let mut text = format!("  it {how} at {} deg{under}\n", degrees(stand.angle_rad));
    let _ = writeln!(
        text,
        "  stiffness {} N m/rad; with shut valves, without dead volume, {} (slow) and {} (fast)\n",
        significant(stand.stiffness_nm_per_rad, 4),
        significant(stand.isothermal_nm_per_rad, 4),
        significant(stand.adiabatic_nm_per_rad, 4)
    );
    let heading = ["muscle", "pressure", "contraction", "force", "torque", "volume"];
    let units = ["", "bar", "%", "N", "N m", "ml"];
    let rows = stand.sides.map(|side| {
        [
            side.side.name().to_owned(),
            bar(side.pressure_pa),
            significant(100.0 * side.contraction, 4),
            significant(side.force_n, 4),
            significant(side.torque_nm, 4),
            significant(1e6 * side.volume_m3, 4),
        ]
    });
    text + &with_units(heading, units, rows)
}

/// Uncertainty of an external torque.
fn surely(outside: &Outside) -> String {
    let [pressure, angle, force, learnt] = outside.from_nm.map(|part| significant(part, 2));
    if outside.sd_nm == 0.0 {
        return "\n  how sure that is: say what the readings scatter by, with --pressure-sd, --angle-sd and --force-sd, or in the muscle's file\n".to_owned();
    }
    format!(
        "\n  {} +- {} N m from outside (one standard deviation: pressures {pressure}, angle {angle}, forces {force}, what was learnt {learnt})\n",
        significant(outside.torque_nm, 4),
        significant(outside.sd_nm, 2)
    )
}

/// Equilibrium angles and stiffnesses over both pressures.
fn mapped(joint: &Joint, map: &[MapPlace], torque: f64) -> String {
    let [low, high] = joint.angle;
    let mut text = format!(
        "  from {} to {} deg; angle [deg] and stiffness [N m/rad] over both pressures",
        degrees(low),
        degrees(high)
    );
    if torque != 0.0 {
        let _ = write!(text, ", under {} N m from outside", significant(torque, 4));
    }
    text.push_str("\n\n");
    let pressures = joint.grid();
    let mut rows = vec![vec!["agonist [bar]".to_owned()]];
    rows[0].extend(pressures.iter().map(|p| format!("antagonist {} bar", bar(*p))));
    for (one, places) in pressures.iter().zip(map.chunks(pressures.len())) {
        let cell = |place: &MapPlace| match place {
            MapPlace::Rest(stand) => {
                format!("{}, {}", degrees(stand.angle_rad), significant(stand.stiffness_nm_per_rad, 3))
            }
            MapPlace::Refused { .. } => "-".to_owned(),
        };
        rows.push(std::iter::once(bar(*one)).chain(places.iter().map(cell)).collect());
    }
    text.push_str(&table(&rows));
    text.push_str("\n  -: no rest within the range of angles\n");
    text
}
