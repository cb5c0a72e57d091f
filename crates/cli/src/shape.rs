//! `bulge shape`: one equilibrium.

use bulge_design::elements::{self, ElementsError};
use bulge_fibre::{Given, MeridianPoint, Problem, Shape};
use bulge_model::{Equilibrium, MuscleWithEffects};
use bulge_muscles::units::Quantity;
use bulge_muscles::{Force, Length, Muscle, Pressure, Ratio, Volume};
use bulge_vtk::{Bulge, Style, vtp_bytes, write_vtp};
use clap::{ArgGroup, Args, ValueEnum};
use std::fmt::Write;
use std::path::PathBuf;

use crate::arguments::{Json, MethodArgument, about, about_extended, extended, pretty, quantity};
use crate::failure::Failure;
use crate::files;
use crate::sketch::sketch;
use crate::text::significant;

/// Most meridian points: more would make a file of over 100 MB, which must be a mistake.
const MAX_POINTS: usize = 100_001;

/// One equilibrium: force, length, volume, fibre tension, stiffness, meridian.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("given").required(true).args(["contraction", "length", "force", "volume"])))]
pub(crate) struct ShapeCommand {
    /// Muscle file, or name of a shipped muscle
    muscle: String,
    /// Gauge pressure, such as "2 bar"
    #[arg(long, allow_hyphen_values = true)]
    pressure: String,
    /// Contraction (l0 - l)/l0, such as "20 %"
    #[arg(long, allow_hyphen_values = true)]
    contraction: Option<String>,
    /// Distance between the fittings, such as "88 mm"
    #[arg(long, allow_hyphen_values = true)]
    length: Option<String>,
    /// Axial force, such as "500 N"
    #[arg(long, allow_hyphen_values = true)]
    force: Option<String>,
    /// Enclosed volume (circular cross-sections), such as "300 ml"
    #[arg(long, allow_hyphen_values = true)]
    volume: Option<String>,
    #[arg(long, value_enum, default_value_t)]
    method: MethodArgument,
    /// Number of meridian points (an even number is raised by one: the middle is a point)
    #[arg(long, default_value_t = 101)]
    points: usize,
    /// Write the bulge as a VTK file (.vtp) for ParaView ("-": to standard output)
    #[arg(long, value_name = "FILE.vtp")]
    vtk: Option<PathBuf>,
    /// Surface in the VTK file: pleats between the fibres, or a surface of revolution [default: pleats for pleated muscles]
    #[arg(long, value_enum, requires = "vtk")]
    surface: Option<Surface>,
    /// Circumference of the unfolded cloth for the pleats, such as "300 mm" [default: just unfolded at the largest radius]
    #[arg(long, requires = "vtk")]
    cloth: Option<String>,
    /// Specimen of the muscle file, where `[specimens.NAME]` gives it numbers of its own
    #[arg(long, value_name = "NAME")]
    specimen: Option<String>,
    /// Your own effects, where the muscle file states them
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
    /// The meridian as CSV on standard output
    #[arg(long, conflicts_with = "json")]
    csv: bool,
}

/// The surface drawn in VTK files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Surface {
    /// Pleats between the fibres
    Pleats,
    /// Surface of revolution
    Revolution,
}

impl ShapeCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let (stated, extended) = extended(&self.muscle, self.effects.as_deref(), self.specimen.as_deref())?;
        let muscle = extended.muscle().clone();
        let pressure: Pressure = quantity("--pressure", &self.pressure)?;
        let given = self.given()?;
        if !(3..=MAX_POINTS).contains(&self.points) {
            let what = format!("{} points: give 3 to {MAX_POINTS}", self.points);
            return Err(Failure::Value { option: "--points", what });
        }
        let cloth = self.cloth.as_deref().map(|text| quantity::<Length>("--cloth", text)).transpose()?;
        let problem = Problem::new(extended.parts(), pressure).map_err(about(&muscle, pressure))?;
        let approach = self.method.approach();
        let found = if self.method == MethodArgument::Membrane {
            let shape = elements::shape(&extended, pressure, given, self.points);
            let shape = shape.map_err(|error| match error {
                ElementsError::Unknown(_) => {
                    let what = format!("{error}: leave the method out, or write a case for `bulge membrane`");
                    Failure::Value { option: "--method", what }
                }
                ElementsError::Equilibrium(error) => about(&muscle, pressure)(error),
                ElementsError::Elements(_) => {
                    Failure::NotConverged(format!("{error}; leave `--method membrane` out"))
                }
            })?;
            Equilibrium::of(&extended, &problem, shape, None, approach)
        } else {
            Equilibrium::new(&extended, pressure, given, approach, self.points)
                .map_err(about_extended(&stated, pressure))?
        };
        let shape = &found.shape;
        if let Some(path) = &self.vtk {
            let drawn = bulge(&muscle, shape, self.surface, cloth);
            if files::is_stdout(path) {
                files::write(path, &vtp_bytes(&drawn)?)?;
            } else {
                files::is_not_read(path)?;
                write_vtp(path, &drawn)?;
            }
        }
        if self.json.wanted {
            return pretty(&found.document());
        }
        if self.csv {
            return Ok(meridian_csv(&shape.meridian));
        }
        let mut text = self.text(&muscle, &found);
        text.push_str(&effects_text(&extended, found.equilibrium_force_n));
        Ok(text)
    }

    fn given(&self) -> Result<Given, Failure> {
        if let Some(text) = &self.contraction {
            Ok(Given::Contraction(quantity::<Ratio>("--contraction", text)?.si()))
        } else if let Some(text) = &self.length {
            Ok(Given::Length(quantity::<Length>("--length", text)?.si()))
        } else if let Some(text) = &self.force {
            Ok(Given::Force(quantity::<Force>("--force", text)?.si()))
        } else {
            // The argument group makes clap reject a command line without any of the four.
            let text = self.volume.as_deref().unwrap_or_default();
            Ok(Given::Volume(quantity::<Volume>("--volume", text)?.si()))
        }
    }

    fn text(&self, muscle: &Muscle, found: &Equilibrium) -> String {
        let Equilibrium { shape, contraction_limit: limit, fibre_stress_pa: stress, .. } = found;
        let r = &shape.response;
        let mut text = String::new();
        let mut line = |name: &str, value: String| {
            let _ = writeln!(text, "{}", format!("  {name:<17} {value}").trim_end());
        };
        line("force", format!("{} N", significant(r.force_n, 6)));
        line(
            "contraction",
            format!(
                "{} %   ({})",
                significant(100.0 * r.contraction, 5),
                limit.map_or("limit not found".to_owned(), |limit| format!(
                    "limit {} %{}",
                    significant(100.0 * limit, 5),
                    if found.ends_slack { ", where the fibres slacken" } else { "" }
                ))
            ),
        );
        line("volume", format!("{} ml", significant(1e6 * r.volume_m3, 5)));
        line("", String::new());
        line("length", format!("{} mm", significant(1e3 * r.length_m, 5)));
        line("largest radius", format!("{} mm", significant(1e3 * r.max_radius_m, 5)));
        if r.volume_polygon_m3.to_bits() != r.volume_m3.to_bits() {
            line(
                "",
                format!("(volume with polygonal sections {} ml)", significant(1e6 * r.volume_polygon_m3, 5)),
            );
        }
        let count =
            muscle.fibres().map_or("all fibres together".to_owned(), |n| format!("each of {n} fibres"));
        line("fibre tension", format!("{} N   ({count}, at most)", significant(r.fibre_tension_n, 5)));
        let strain = if muscle.fibre().is_some() {
            format!("{} %", significant(100.0 * r.fibre_strain, 4))
        } else {
            "0 (inextensible: no `fibre.stiffness` in the muscle file)".to_owned()
        };
        line("fibre strain", strain);
        if let Some(stress) = *stress {
            line("fibre stress", format!("{} MPa", significant(1e-6 * stress, 4)));
        }
        if let Some(largest) = largest_angle(&shape.meridian) {
            line("braid angle", format!("{} deg at most", significant(largest.to_degrees(), 4)));
        }
        line("slope at fittings", format!("{} deg", significant(r.end_slope_rad.to_degrees(), 4)));
        let stiffness = [r.stiffness_n_per_m, r.stiffness_isothermal_n_per_m, r.stiffness_adiabatic_n_per_m]
            .map(|k| significant(1e-3 * k, 4));
        line(
            "stiffness dF/dl",
            format!(
                "{} N/mm at constant pressure; gas enclosed: {} isothermal, {} adiabatic",
                stiffness[0], stiffness[1], stiffness[2]
            ),
        );
        if let Some(numbers) = &found.pleated {
            let [m, phi, f, v] =
                [numbers.m, numbers.phi_r, numbers.force_f, numbers.volume_v].map(|x| significant(x, 6));
            line("dimensionless", format!("m {m}, phi_R {phi}, f {f}, v {v}"));
        }
        let c = &r.convergence;
        line(
            "method",
            format!(
                "{}: {} iterations, {} evaluations, residual {:.0e}, first integral kept to {:.0e}",
                r.method, c.iterations, c.evaluations, c.residual, c.first_integral
            ),
        );
        let pressure = Pressure::pa(r.pressure_pa);
        let drawn = sketch(&shape.meridian, 64);
        let vtk = self.vtk.as_ref().map_or(String::new(), |path| format!("\n  wrote {}\n", path.display()));
        format!("{} at {pressure}\n\n{text}\n{drawn}{vtk}", muscle.name())
    }
}

fn largest_angle(meridian: &[MeridianPoint]) -> Option<f64> {
    let largest = meridian.iter().map(|point| point.braid_angle_rad).fold(0.0, f64::max);
    (largest > 0.0).then_some(largest)
}

/// The bulge to be drawn.
pub(crate) fn bulge<'a>(
    muscle: &Muscle,
    shape: &'a Shape,
    surface: Option<Surface>,
    cloth: Option<Length>,
) -> Bulge<'a> {
    let cloth = cloth.map(Length::si);
    let style = match surface {
        Some(Surface::Revolution) => Style::Revolution,
        Some(Surface::Pleats) => Style::Pleats { cloth_circumference: cloth },
        None => Style::natural(muscle, shape, cloth),
    };
    Bulge::of(muscle, shape, style)
}

/// Contribution of the effects in the muscle file, as text.
fn effects_text(extended: &MuscleWithEffects, alone: Option<f64>) -> String {
    let mut text = String::new();
    if let Some(alone) = alone {
        let used = extended.used().join(", ");
        let _ = writeln!(
            text,
            "\n  With the effects {used}, at rest; without loads {} N.",
            significant(alone, 6)
        );
    }
    if !extended.left_out().is_empty() {
        let left_out = extended.left_out().join(", ");
        let _ = writeln!(text, "  Left out, as no part of the muscle: {left_out}.");
    }
    text
}

fn meridian_csv(meridian: &[MeridianPoint]) -> String {
    let mut text = String::from(
        "x [m],r [m],slope [rad],braid_angle [rad],fibre_tension [N],fibre_strain [-],membrane_force [N/m],fibre_length [m],turn [rad]\n",
    );
    for p in meridian {
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{}",
            p.x_m,
            p.r_m,
            p.slope_rad,
            p.braid_angle_rad,
            p.fibre_tension_n,
            p.fibre_strain,
            p.membrane_force_n_per_m,
            p.fibre_length_m,
            p.turn_rad
        );
    }
    text
}
