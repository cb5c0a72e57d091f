//! `bulge sense`: a channel of liquid metal wound around a muscle, whose resistance gives the contraction.

use bulge_design::sensing::{
    Curve, Linearity, Placement, RESISTANCE_UNITS, Range, SenseQuestion, Sensor, Winding,
};
use bulge_muscles::units::Quantity;
use bulge_muscles::{Length, Pressure, Ratio};
use bulge_report::lines_svg;
use clap::Args;
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{Json, extended, in_unit, pretty, quantity, range};
use crate::failure::Failure;
use crate::files;
use crate::text::{significant, with_units};

/// Rows of the table.
const ROWS: usize = 11;
/// A channel of liquid metal wound round a muscle, whose resistance tells the contraction (S3, section 5).
///
/// The channel lies in an elastomer outside the fibres and goes with them: as the muscle bulges, it gets longer and thinner. Resistance against contraction, how
/// straight that is, what a noise of the resistance makes of the contraction, and where on the muscle to wind.
#[derive(Debug, Args)]
pub(crate) struct SenseCommand {
    /// Muscle file, or name of a shipped muscle
    muscle: String,
    /// Gauge pressure
    #[arg(long, default_value = "1 bar", allow_hyphen_values = true)]
    pressure: String,
    /// Range of contractions
    #[arg(long, default_value = "5 %..30 %", allow_hyphen_values = true)]
    contraction: String,
    /// Points of the range, 11 or more
    #[arg(long, default_value_t = 101)]
    points: usize,
    /// Turns of the channel
    #[arg(long, default_value_t = 20.0, allow_hyphen_values = true)]
    turns: f64,
    /// Where it is wound, from a fitting, in parts of the fibre's length
    #[arg(long, default_value = "30 %..70 %", allow_hyphen_values = true, conflicts_with = "best")]
    zone: String,
    /// Diameter of the channel, round, as it is made
    #[arg(long, default_value = "0.25 mm", allow_hyphen_values = true)]
    channel: String,
    /// How far its centre lies outside the fibres
    #[arg(long, default_value = "0.5 mm", allow_hyphen_values = true)]
    offset: String,
    /// Standard deviation of the resistance that is read
    #[arg(long, default_value = "1 mohm", allow_hyphen_values = true)]
    noise: String,
    /// Seek the best place for a zone of this width, such as "40 %"
    #[arg(long, allow_hyphen_values = true)]
    best: Option<String>,
    /// What is best: a gauge factor of at least so much, and as straight as can be; without it the most sensitive place
    #[arg(long, requires = "best")]
    least_gauge_factor: Option<f64>,
    /// Write all points as CSV ("-": to standard output)
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// Draw the resistance against the contraction
    #[arg(long, value_name = "FILE.svg", value_parser = files::picture)]
    plot: Option<PathBuf>,
    /// Your own effects, where the muscle file states them
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl SenseCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let (muscle, extended) = extended(&self.muscle, self.effects.as_deref(), None)?;
        let question = self.question()?;
        let found = question.answer(&extended)?;
        let wanted = [self.csv.as_deref(), self.plot.as_deref()];
        let wrote = files::wrote_both(
            wanted,
            || csv(&found.curve),
            || {
                let drawing = found.drawing();
                Ok(lines_svg(&drawing.title, drawing.axes, &drawing.lines)?)
            },
        )?;
        if self.json.wanted {
            return pretty(&serde_json::to_value(found.document())?);
        }
        let pressure = Pressure::pa(question.pressure_pa);
        let heading = format!("{} at {pressure}\n\n", muscle.name());
        let resolution = found.resolution;
        let worst = format!(
            "  {} {} of noise are {} % of contraction at worst, {} mm (at {} %)\n",
            significant(1e3 * question.noise_ohm, 3),
            "mohm",
            significant(100.0 * resolution.worst, 2),
            significant(1e3 * resolution.worst_m, 2),
            significant(100.0 * resolution.worst_at, 3)
        );
        Ok(heading
            + &wound(found.sensor.winding(), &found.sensor)
            + &rows(&found.curve)
            + &straight(&found.curve)
            + &worst
            + &best(found.placed.as_ref())
            + &wrote)
    }

    fn question(&self) -> Result<SenseQuestion, Failure> {
        let pressure_pa = quantity::<Pressure>("--pressure", &self.pressure)?.si();
        let [from, to] = range::<Ratio>("--contraction", &self.contraction)?;
        let noise_ohm = in_unit("--noise", &self.noise, &RESISTANCE_UNITS)?;
        let best = self.best.as_deref().map(|width| quantity::<Ratio>("--best", width)).transpose()?;
        Ok(SenseQuestion {
            pressure_pa,
            range: Range { from, to, points: self.points },
            turns: self.turns,
            zone: range::<Ratio>("--zone", &self.zone)?,
            channel_m: quantity::<Length>("--channel", &self.channel)?.si(),
            offset_m: quantity::<Length>("--offset", &self.offset)?.si(),
            noise_ohm,
            best: best.map(Quantity::si),
            least_gauge_factor: self.least_gauge_factor,
        })
    }
}

fn wound(winding: &Winding, sensor: &Sensor) -> String {
    format!(
        "  {} turns of a channel {} mm wide, {} mm outside the fibres, from {} to {} % of them: {} mm, {} ohm at rest\n\n",
        significant(winding.turns, 4),
        significant(1e3 * winding.diameter_m(), 3),
        significant(1e3 * winding.offset_m, 3),
        significant(100.0 * winding.start, 3),
        significant(100.0 * winding.end, 3),
        significant(1e3 * sensor.reference_length_m(), 4),
        significant(sensor.reference_resistance_ohm(), 4)
    )
}

fn rows(curve: &Curve) -> String {
    let heading = ["contraction", "resistance", "change", "gauge factor", "largest strain"];
    let units = ["%", "ohm", "%", "", "%"];
    let every = (curve.readings.len() - 1).div_ceil(ROWS - 1).max(1);
    let shown = curve.readings.iter().zip(&curve.sensitivity).step_by(every);
    let rows = shown.map(|(reading, slope)| {
        [
            significant(100.0 * reading.contraction, 4),
            significant(reading.resistance_ohm, 5),
            significant(100.0 * reading.relative_change, 4),
            significant(*slope, 4),
            significant(100.0 * reading.largest_strain, 3),
        ]
    });
    with_units(heading, units, rows)
}

fn straight(curve: &Curve) -> String {
    let Some(Linearity { mean_sensitivity, best_fit_percent, terminal_percent, .. }) = curve.linearity else {
        return "\n  the resistance doesn't change\n".to_owned();
    };
    format!(
        "\n  gauge factor {} in the mean; off the best straight line by {} % of full scale, off that through both ends by {} %\n",
        significant(mean_sensitivity, 4),
        significant(best_fit_percent, 3),
        significant(terminal_percent, 3)
    )
}

fn best(placed: Option<&Placement>) -> String {
    let Some(placed) = placed else { return String::new() };
    format!(
        "  the best of {} places: the middle of the zone at {} % of the fibres\n",
        placed.scanned.len(),
        significant(100.0 * placed.best.centre, 4)
    )
}

fn csv(curve: &Curve) -> String {
    let mut text = "contraction [-],resistance [ohm],change [-],gauge_factor [-],channel_length [m],largest_strain [-]\n".to_owned();
    for (reading, slope) in curve.readings.iter().zip(&curve.sensitivity) {
        let _ = writeln!(
            text,
            "{},{},{},{slope},{},{}",
            reading.contraction,
            reading.resistance_ohm,
            reading.relative_change,
            reading.channel_length_m,
            reading.largest_strain
        );
    }
    text
}
