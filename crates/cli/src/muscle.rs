//! `bulge muscle`: the shipped muscles.

use bulge_muscles::units::significant;
use bulge_muscles::{PRESETS, Parameter, USUAL_WIDTHS, UsualWidth, preset};
use clap::Args;
use serde_json::json;
use std::fmt::Write;

use crate::arguments::{Json, pretty};
use crate::failure::Failure;

/// Shipped muscles: list them, or print one as a file to start from.
#[derive(Debug, Args)]
pub(crate) struct MuscleCommand {
    /// Name of a shipped muscle; its file is printed
    name: Option<String>,
    #[command(flatten)]
    json: Json,
}

impl MuscleCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let Some(name) = &self.name else { return self.list() };
        let muscle = preset(name)?;
        let Some(shipped) = PRESETS.iter().find(|shipped| shipped.name == name) else {
            return Ok(bulge_muscles::to_toml(&muscle));
        };
        let document =
            json!({"schema": "bulge.muscle/1", "name": name, "about": shipped.about, "toml": shipped.text});
        self.json.or(&document, || shipped.text.to_owned())
    }

    fn list(&self) -> Result<String, Failure> {
        if self.json.wanted {
            let muscles: Vec<_> = PRESETS.iter().map(|p| json!({"name": p.name, "about": p.about})).collect();
            let document = json!({"schema": "bulge.muscles/1", "muscles": muscles});
            return pretty(&document);
        }
        let mut text = String::from(
            "Shipped muscles (`bulge muscle NAME > my-muscle.toml` gives a file to start from):\n\n",
        );
        let width = PRESETS.iter().map(|p| p.name.len()).max().unwrap_or(0);
        for shipped in PRESETS {
            let _ = writeln!(text, "  {:<width$}  {}", shipped.name, shipped.about);
        }
        let usual: Vec<String> = USUAL_WIDTHS.iter().map(usual).collect();
        let _ = write!(
            text,
            "\nA number may have a width, one standard deviation: \"110 mm +- 0.2 mm\". Where none is stated, a diagnosis takes the\n\
             geometry as known up to what such muscles have: {};\n`+- 0` says that a number is exact.\n",
            usual.join(", ")
        );
        Ok(text)
    }
}

/// A usual width in words.
fn usual((parameter, width): &(Parameter, UsualWidth)) -> String {
    let size = match (width, parameter) {
        (UsualWidth::Relative(part), _) => format!("{} %", significant(100.0 * part, 2)),
        (UsualWidth::Absolute(angle), Parameter::BraidAngle) => {
            format!("{} deg", significant(angle.to_degrees(), 2))
        }
        (UsualWidth::Absolute(length), _) => format!("{} mm", significant(1e3 * length, 2)),
    };
    format!("{} {size}", parameter.name())
}
