//! Parameters of effects in written form, such as "0.31 MPa": they are read within the bounds of the card and
//! shown in its unit.

use bulge_muscles::{Dimension, units};

use crate::card::ParameterCard;

impl ParameterCard<'_> {
    /// Reads a parameter of `effect` from text \[SI\].
    ///
    /// # Errors
    /// A sentence with an example, if the text is no quantity of the parameter's dimension or lies outside
    /// its bounds.
    pub fn read(&self, effect: &str, text: &str) -> Result<f64, String> {
        let example = format!("write such as `{effect}.{}={}`", self.key, self.shown(self.usual()));
        let found = units::any(text).map_err(|error| format!("`{effect}`: {error}; {example}"))?;
        let dimension = self.known_dimension().unwrap_or(found.dimension);
        if found.dimension != dimension {
            let (is, must) = (found.dimension.describe(), dimension.describe());
            return Err(format!("`{}` of `{effect}` is {must}, but `{text}` is {is}; {example}", self.key));
        }
        self.within(found.si).ok_or_else(|| {
            format!(
                "`{text}` is out of the bounds of `{effect}`: `{}` lies between {} and {}",
                self.key,
                self.shown(self.low),
                self.shown(self.high)
            )
        })
    }

    /// Reads both bounds of a parameter of `effect` from text \[SI\], such as "5..20 N". A lower bound
    /// without a unit takes that of the upper one.
    ///
    /// # Errors
    /// As [`ParameterCard::read`]; also if the text is no range, or the lower bound isn't below the upper
    /// one.
    pub fn read_range(&self, effect: &str, text: &str) -> Result<[f64; 2], String> {
        let no_range = || {
            let (low, high) = (self.shown(self.low), self.shown(self.high));
            format!(
                "`{text}` is no range; write such as `{effect}.{}={low}..{high}`, the lower bound first",
                self.key
            )
        };
        let (from, to) = text.split_once("..").ok_or_else(no_range)?;
        let high = self.read(effect, to)?;
        let unit = units::any(to).map(|to| to.unit).unwrap_or_default();
        let is_bare = from.trim().parse::<f64>().is_ok();
        let low = self.read(effect, &if is_bare { format!("{from} {unit}") } else { from.to_owned() })?;
        if low < high { Ok([low, high]) } else { Err(no_range()) }
    }

    /// The value \[SI\] if it lies within the bounds. A fit may leave a value beyond its bound by rounding;
    /// such a value is clamped.
    pub(crate) fn within(&self, si: f64) -> Option<f64> {
        let slack = 1e-12 * (self.high - self.low).abs();
        (self.low - slack..=self.high + slack).contains(&si).then(|| si.clamp(self.low, self.high))
    }

    /// A usual value at which the effect does something: the typical one, or the prior mean plus one standard
    /// deviation if the typical value is `off`.
    #[must_use]
    pub fn usual(&self) -> f64 {
        let does_nothing = self.typical.total_cmp(&self.off).is_eq();
        let beside = self.prior.map(|(mean, sd)| (mean + sd).clamp(self.low, self.high));
        beside.filter(|_| does_nothing).unwrap_or(self.typical)
    }

    /// A value \[SI\] as text in the unit of the card.
    #[must_use]
    pub fn shown(&self, si: f64) -> String {
        // Twelve digits hide the rounding error of the conversion.
        format!("{} {}", units::rounded(si / self.factor, 12), self.unit).trim_end().to_owned()
    }

    /// The dimension of the unit. An unknown unit has none.
    #[must_use]
    pub fn dimension(&self) -> Dimension {
        self.known_dimension().unwrap_or(Dimension::NONE)
    }

    fn known_dimension(&self) -> Option<Dimension> {
        units::unit(self.unit).ok().map(|(_, dimension)| dimension)
    }
}
