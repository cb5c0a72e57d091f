//! `bulge joint`: two antagonistic muscles on a joint: its equilibrium angle, its stiffness, and the
//! pressures it needs.

use bulge_design::joint::{Checks, JOINT_EXAMPLE, Joint, JointError, JointState, Outside, Readings};
use bulge_muscles::units::Quantity;
use bulge_muscles::{Angle, Force, Pressure, Volume};
use bulge_report::lines_svg;
use bulge_sweep::JointTable;
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{Json, in_unit, list, quantity};
use crate::failure::Failure;
use crate::files;
use crate::text::{shown, significant, table, with_units};

/// Number of pressures of each muscle in the map.
const GRID: usize = 5;
/// Points of a plotted line.
const DRAWN: usize = 81;

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
    #[arg(long, value_name = "FILE.svg")]
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
        let pressures = self.pressures()?;
        let angle = self.angle.as_deref().map(|text| quantity::<Angle>("--angle", text)).transpose()?;
        let angle = angle.map(Quantity::si);
        let torque = self.torque.as_deref().map_or(Ok(0.0), |text| in_unit("--torque", text, &TORQUE))?;
        let wrong = |option, what: &str| Err(Failure::Value { option, what: what.to_owned() });
        let (document, text) = match (pressures, angle, &self.stiffness) {
            (Some(pressures), None, _) if self.closed.is_some() => self.shut(&joint, pressures, torque)?,
            (Some(pressures), None, _) => {
                let stand = joint.rest(pressures, torque)?;
                (json!({ "stand": stand }), standing("rests", &stand, torque))
            }
            (Some(_), Some(_), _) if self.torque.is_some() => {
                return wrong(
                    "--torque",
                    "pressures and an angle give the torque from outside: leave one of the three out",
                );
            }
            (Some(pressures), Some(angle), _) => {
                let readings = self.readings()?;
                let (stand, outside) =
                    (joint.stand(angle, pressures)?, joint.outside(angle, pressures, readings)?);
                let text = standing("is held", &stand, outside.torque_nm) + &surely(&outside);
                (json!({ "stand": stand, "outside": outside, "readings": readings }), text)
            }
            (None, Some(angle), Some(stiffness)) => {
                let stiffness = in_unit("--stiffness", stiffness, &STIFFNESS)?;
                let stand = joint.pressures_for(angle, stiffness, torque)?;
                (json!({ "stand": stand }), standing("stands", &stand, torque))
            }
            (None, Some(_), None) => {
                return wrong(
                    "--angle",
                    "an angle alone is no question: add --stiffness for the pressures, or --pressure for the torque that holds it there",
                );
            }
            (None, None, _) => mapped(&joint, torque)?,
        };
        let mut wrote = String::new();
        if let Some(path) = &self.plot {
            files::write(path, drawn(&joint)?.as_bytes())?;
            let _ = writeln!(wrote, "\n  wrote {}", path.display());
        }
        let mut document = document;
        document["schema"] = "bulge.joint/1".into();
        document["name"] = joint.name.clone().into();
        document["outside_nm"] = torque.into();
        self.json.or(&document, || format!("{}\n\n{text}{wrote}", joint.name))
    }

    fn pressures(&self) -> Result<Option<[f64; 2]>, Failure> {
        let Some(text) = &self.pressure else { return Ok(None) };
        let pressures: Vec<Pressure> = list("--pressure", text)?;
        let pressures: Vec<f64> = pressures.into_iter().map(Quantity::si).collect();
        match pressures[..] {
            [one, other] if one > 0.0 && other > 0.0 => Ok(Some([one, other])),
            [_, _] => {
                let what = "both muscles need a gauge pressure above 0".to_owned();
                Err(Failure::Value { option: "--pressure", what })
            }
            _ => {
                let what = format!(
                    "{} pressures: write that of the agonist and that of the antagonist, such as \"2 bar,1.5 bar\"",
                    pressures.len()
                );
                Err(Failure::Value { option: "--pressure", what })
            }
        }
    }

    fn readings(&self) -> Result<Readings, Failure> {
        let readings = Readings {
            pressure_pa: quantity::<Pressure>("--pressure-sd", &self.pressure_sd)?.si(),
            angle_rad: quantity::<Angle>("--angle-sd", &self.angle_sd)?.si(),
            force_n: quantity::<Force>("--force-sd", &self.force_sd)?.si(),
        };
        for (option, value) in [
            ("--pressure-sd", readings.pressure_pa),
            ("--angle-sd", readings.angle_rad),
            ("--force-sd", readings.force_n),
        ] {
            if value < 0.0 {
                return Err(Failure::Value { option, what: "a standard deviation is 0 or more".to_owned() });
            }
        }
        Ok(readings)
    }

    /// The joint at rest without load, then with shut valves under load.
    fn shut(&self, joint: &Joint, pressures: [f64; 2], torque: f64) -> Result<(Value, String), Failure> {
        let dead = self.dead_volume.as_deref().map(|text| quantity::<Volume>("--dead-volume", text));
        let dead = dead.transpose()?.map_or(0.0, Quantity::si);
        if dead < 0.0 {
            let what = "a volume is 0 or more".to_owned();
            return Err(Failure::Value { option: "--dead-volume", what });
        }
        let exponent = if self.closed == Some(Gas::Adiabatic) { bulge_fibre::ADIABATIC } else { 1.0 };
        let before = joint.rest(pressures, 0.0)?;
        let closed = joint.closed(before.angle_rad, pressures, exponent, [dead; 2])?;
        let after = closed.rest(torque)?;
        let stiffness = [closed.stiffness(before.angle_rad)?, closed.stiffness(after.angle_rad)?];
        let text = format!(
            "{}\n{}\n  turned by {} deg with shut valves; stiffness of the shut joint with its dead volume {} N m/rad before, {} after\n",
            standing("rests, and the valves are shut,", &before, 0.0),
            standing("rests", &after, torque),
            degrees(after.angle_rad - before.angle_rad),
            significant(stiffness[0], 4),
            significant(stiffness[1], 4)
        );
        Ok((
            json!({ "before": before, "stand": after, "shut_nm_per_rad": stiffness, "exponent": exponent, "dead_volume_m3": dead }),
            text,
        ))
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

/// Evenly spaced pressures over the joint's range.
fn pressures(joint: &Joint) -> Vec<f64> {
    let [low, high] = joint.pressure;
    (0..GRID).map(|k| low + (high - low) * k as f64 / (GRID - 1) as f64).collect()
}

/// Equilibrium angles and stiffnesses over both pressures.
fn mapped(joint: &Joint, torque: f64) -> Result<(Value, String), Failure> {
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
    let pressures = pressures(joint);
    let mut rows = vec![vec!["agonist [bar]".to_owned()]];
    rows[0].extend(pressures.iter().map(|p| format!("antagonist {} bar", bar(*p))));
    let (mut map, mut refused) = (Vec::new(), None);
    for one in &pressures {
        let mut row = vec![bar(*one)];
        for other in &pressures {
            let at = [*one, *other];
            match joint.rest(at, torque) {
                Ok(stand) => {
                    row.push(format!(
                        "{}, {}",
                        degrees(stand.angle_rad),
                        significant(stand.stiffness_nm_per_rad, 3)
                    ));
                    map.push(json!(stand));
                }
                Err(error) => {
                    row.push("-".to_owned());
                    map.push(json!({ "pressures_pa": at, "why": error.to_string() }));
                    refused = Some(error);
                }
            }
        }
        rows.push(row);
    }
    // No pair of pressures has an equilibrium: the last reason is reported.
    if let (Some(error), true) = (refused, map.iter().all(|at| at.get("why").is_some())) {
        return Err(error.into());
    }
    text.push_str(&table(&rows));
    text.push_str("\n  -: no rest within the range of angles\n");
    Ok((json!({ "map": map }), text))
}

/// Plot of the torque of both muscles against the angle, for equal pressures and for opposite extremes.
fn drawn(joint: &Joint) -> Result<String, Failure> {
    let ([low, high], all) = (joint.angle, pressures(joint));
    let pairs = all.iter().map(|p| [*p, *p]).chain([[all[GRID - 1], all[0]], [all[0], all[GRID - 1]]]);
    let mut lines = Vec::new();
    for [one, other] in pairs {
        let mut points = Vec::new();
        for k in 0..DRAWN {
            // Rounding must not lead out of the range.
            let angle = (low + (high - low) * k as f64 / (DRAWN - 1) as f64).min(high);
            points.push([angle.to_degrees(), joint.torque(angle, one, other)?]);
        }
        lines.push((format!("{} | {} bar", bar(one), bar(other)), points));
    }
    let title = format!("{}: agonist | antagonist", joint.name);
    Ok(lines_svg(&title, ["angle [deg]", "torque [N m]"], &lines)?)
}
