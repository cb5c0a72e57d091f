//! Shipped muscles: those of the papers against which the models are checked.

use crate::file::from_toml;
use crate::file_error::FileError;
use crate::muscle::Muscle;
use crate::settings::nearest;
use crate::shown::shortened;
use thiserror::Error;

/// A shipped muscle file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preset {
    /// The name under which it is found.
    pub name: &'static str,
    /// Its description, in one line.
    pub about: &'static str,
    /// The file itself, with its sources in comments.
    pub text: &'static str,
}

macro_rules! preset {
    ($name:literal, $about:literal) => {
        Preset { name: $name, about: $about, text: include_str!(concat!("../presets/", $name, ".toml")) }
    };
}

/// Every shipped muscle.
pub const PRESETS: &[Preset] = &[
    preset!("ppam-1", "first-generation pleated muscle: a membrane of fibres all round"),
    preset!("ppam-2-r11.5", "second-generation pleated muscle, at the radius where its fibres are laid"),
    preset!("ppam-2-r16", "second-generation pleated muscle, at the radius its fibres take under pressure"),
    preset!("dmsp-20-200", "Festo fluidic muscle, 20 mm inner diameter, 200 mm long"),
    preset!("dmsp-20-250", "Festo fluidic muscle, 20 mm nominal diameter, 250 mm long, geometry measured"),
    preset!("dmsp-20-400", "Festo fluidic muscle, 20 mm inner diameter, 400 mm long"),
];

/// Why there is no such muscle.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum PresetError {
    /// No preset has this name.
    #[error("no shipped muscle is called `{name}`: {instead}")]
    Unknown {
        /// The name asked for.
        name: String,
        /// The nearest name and the list.
        instead: String,
    },
    /// The shipped file is wrong.
    #[error(transparent)]
    File(#[from] FileError),
}

/// A shipped muscle by name.
///
/// ```
/// let muscle = bulge_muscles::preset("dmsp-20-250")?;
/// assert_eq!(muscle.length(), bulge_muscles::Length::mm(250.0));
/// # Ok::<(), bulge_muscles::PresetError>(())
/// ```
///
/// # Errors
/// If there is no preset of that name.
pub fn preset(name: &str) -> Result<Muscle, PresetError> {
    if let Some(preset) = PRESETS.iter().find(|preset| preset.name == name) {
        return Ok(from_toml(preset.text, preset.name)?);
    }
    let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
    let question = nearest(name, names.iter().copied())
        .map(|near| format!("did you mean `{near}`? otherwise "))
        .unwrap_or_default();
    let instead = format!("{question}there are {}", names.join(", "));
    Err(PresetError::Unknown { name: shortened(name), instead })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::construction::{Construction, FibreCount};
    use crate::quantity::Length;
    use crate::units::Quantity;

    #[test]
    fn every_preset_is_a_muscle() {
        for entry in PRESETS {
            let muscle = preset(entry.name).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(muscle.name(), entry.name);
            assert!(entry.text.starts_with("# Source: "), "{} states its source", entry.name);
        }
    }

    #[test]
    fn the_numbers_of_the_papers() {
        let ppam = preset("ppam-2-r11.5").unwrap();
        assert_eq!(
            (ppam.length(), ppam.radius(), ppam.fibres()),
            (Length::mm(110.0), Length::mm(11.5), Some(40))
        );
        assert_eq!(preset("ppam-2-r16").unwrap().radius(), Length::mm(16.0));
        let Construction::Pleated(first) = preset("ppam-1").unwrap().construction() else {
            panic!("pleated")
        };
        assert_eq!(first.fibres(), FibreCount::Continuous);
        assert_eq!(preset("dmsp-20-400").unwrap().length(), Length::mm(400.0));
    }

    #[test]
    fn the_braid_radius_follows_from_fibre_length_and_turns() {
        // Table 2 of "Experimental Analysis of Fluidic Muscles": b = 275.85 mm, N = 1.73 turns, l0 = 250 mm.
        let muscle = preset("dmsp-20-250").unwrap();
        let Construction::Braided(braid) = muscle.construction() else { panic!("braided") };
        let alpha0 = braid.braid_angle().to_rad();
        let radius = 275.85 * alpha0.sin() / (std::f64::consts::TAU * 1.73);
        // The file states five digits, the table two to five.
        assert!((braid.radius().to_mm() - radius).abs() < 5e-4, "{radius}");
        assert!((275.85 * alpha0.cos() - 250.0).abs() < 0.01);
        assert_eq!(muscle.wall().map(Quantity::si), Some(0.002));
    }

    #[test]
    fn an_unknown_name_is_answered() {
        let message = preset("dmsp-20-300").unwrap_err().to_string();
        assert!(
            message.contains("`dmsp-20-300`") && message.contains("did you mean `dmsp-20-200`?"),
            "{message}"
        );
        let message = preset("x").unwrap_err().to_string();
        assert!(message.contains("there are ppam-1, ppam-2-r11.5"), "{message}");
    }
}
