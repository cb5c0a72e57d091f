//! The uncertainty of a geometry that states no widths: how far catalogues, rulers and protractors usually
//! are from a muscle.
//!
//! A number without a stated width is known up to the usual width of such muscles. `+- 0` says that it is
//! exact.

use crate::muscle::Muscle;
use crate::parameter::Parameter;

/// A usual width, relative to the number or in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum UsualWidth {
    /// A fraction of the number.
    Relative(f64),
    /// In SI units.
    Absolute(f64),
}

/// Widths (one standard deviation) of numbers for which a muscle file states none.
///
/// - Length, 0.5 mm: a ruler between two fittings whose edges are rounded.
/// - Radius, 3 %: a hose is named by its bore, while its fibres lie in the wall (a bore of 19.5 mm and an
///   outside of 23.5 mm are "20 mm").
/// - Braid angle, 2 deg: read off a photograph or a protractor.
/// - Wall, 15 %: rubber tubes are drawn to a tolerance of a tenth, and a calliper presses them in.
pub const USUAL_WIDTHS: [(Parameter, UsualWidth); 4] = [
    (Parameter::Length, UsualWidth::Absolute(0.5e-3)),
    (Parameter::Radius, UsualWidth::Relative(0.03)),
    (Parameter::BraidAngle, UsualWidth::Absolute(2.0 * std::f64::consts::PI / 180.0)),
    (Parameter::Wall, UsualWidth::Relative(0.15)),
];

/// Thickness of the wall over the radius of a braid that states no wall: tubes of latex and silicone of 0.8
/// to 1.5 mm in braids of 8 to 12 mm.
const USUAL_WALL: f64 = 0.1;

impl Muscle {
    /// The same muscle with usual widths where none is stated, and the added widths in SI.
    ///
    /// A pleated muscle may have a radius at the fittings beside the stated one. That radius was found on the
    /// muscle and is no catalogue's, so it has no usual width.
    ///
    /// ```
    /// use bulge_muscles::{Parameter, from_toml};
    /// let file = "name = \"m\"\nkind = \"pleated\"\nlength = \"110 mm +- 0\"\nradius = \"16 mm\"\nfibres = 40\n";
    /// let (muscle, added) = from_toml(file, "m.toml")?.with_usual_widths();
    /// assert_eq!(added, [(Parameter::Radius, 0.03 * 0.016)]);
    /// assert_eq!(muscle.width(Parameter::Length), Some(0.0));
    /// # Ok::<(), bulge_muscles::FileError>(())
    /// ```
    #[must_use]
    pub fn with_usual_widths(mut self) -> (Self, Vec<(Parameter, f64)>) {
        let is_found = self.is_pleated() && self.is_stated(Parameter::FittingRadius);
        let mut added = Vec::new();
        for (parameter, width) in USUAL_WIDTHS {
            if self.width(parameter).is_some() || (is_found && parameter == Parameter::Radius) {
                continue;
            }
            let Some(value) = self.get(parameter).filter(|_| self.is_stated(parameter)) else { continue };
            let width = match width {
                UsualWidth::Relative(part) => part * value,
                UsualWidth::Absolute(width) => width,
            };
            if let Ok(doubted) = self.clone().with_width(parameter, width) {
                self = doubted;
                added.push((parameter, width));
            }
        }
        (self, added)
    }

    /// The same muscle with a wall of a tenth of the radius if it is a braid that states none, and that
    /// thickness \[m\]. Rubber can then be looked for: a force shows only its modulus times its thickness.
    #[must_use]
    pub fn with_usual_wall(self) -> (Self, Option<f64>) {
        if self.is_pleated() || self.wall().is_some() {
            return (self, None);
        }
        let wall = USUAL_WALL * self.radius().to_m();
        match self.with(Parameter::Wall, wall) {
            Ok(walled) => (walled, Some(wall)),
            Err(_) => (self, None),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Parameter, from_toml, to_toml};

    const BRAID: &str = "name = \"hose\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\n";

    #[test]
    fn numbers_without_a_width_get_the_usual_one() {
        let (muscle, added) =
            from_toml(&format!("{BRAID}wall = \"2 mm\"\n"), "m").unwrap().with_usual_widths();
        let expected = [
            (Parameter::Length, 5e-4),
            (Parameter::Radius, 3e-4),
            (Parameter::BraidAngle, 2.0_f64.to_radians()),
            (Parameter::Wall, 3e-4),
        ];
        assert_eq!(muscle.widths().len(), 4);
        for ((parameter, width), (wanted, sd)) in added.iter().zip(expected) {
            assert!(*parameter == wanted && (width / sd - 1.0).abs() < 1e-12, "{parameter:?}: {width}");
            assert_eq!(muscle.width(wanted), Some(*width));
        }
        assert_eq!(muscle.clone().with_usual_widths(), (muscle, Vec::new()));
    }

    #[test]
    fn what_is_stated_or_found_stays() {
        let file = BRAID.replace("250 mm", "250 mm +- 0").replace("25 deg", "25 deg +- 0.1 deg");
        let muscle = from_toml(&file, "m").unwrap();
        let (doubted, added) = muscle.clone().with_usual_widths();
        assert_eq!(added.len(), 1, "{added:?}");
        assert_eq!(doubted.width(Parameter::BraidAngle), muscle.width(Parameter::BraidAngle));
        let pleated = "name = \"p\"\nkind = \"pleated\"\nlength = \"110 mm +- 0\"\nradius = \"16 mm\"\nfibres = 40\n[effects.end-radius]\nradius = \"17 mm\"\n";
        assert!(from_toml(pleated, "p").unwrap().with_usual_widths().1.is_empty());
    }

    #[test]
    fn exact_numbers_are_written_as_such() {
        let file = format!(
            "{}wall = \"2 mm +- 0 %\"\n\n[effects.viscous-damping]\ndamping = \"40 N s +- 0\"\n",
            BRAID.replace("10 mm", "10 mm +- 0")
        );
        let muscle = from_toml(&file, "m").unwrap();
        assert_eq!(muscle.widths(), [(Parameter::Radius, 0.0), (Parameter::Wall, 0.0)]);
        let text = to_toml(&muscle);
        assert!(text.contains("radius = \"10 mm +- 0 mm\"") && text.contains("+- 0 N s"), "{text}");
        let back = from_toml(&text, "copy").unwrap();
        assert_eq!((&back, to_toml(&back)), (&muscle, text));
    }

    #[test]
    fn a_braid_without_wall_gets_one_to_look_for_rubber() {
        let (hose, wall) = from_toml(BRAID, "m").unwrap().with_usual_wall();
        assert_eq!((hose.get(Parameter::Wall), wall), (Some(0.001), Some(0.001)));
        assert_eq!(hose.clone().with_usual_wall(), (hose, None));
        let pleated = crate::preset("ppam-2-r16").unwrap();
        assert_eq!(pleated.clone().with_usual_wall(), (pleated, None));
    }
}
