//! The columns of measurements: names, dimensions, and the parsing of headings such as `length [mm]`.

use crate::cell;
use crate::dimension::{Scale, Temperature};
use crate::names;
use bulge_muscles::units::{UnitError, Wanted};
use bulge_muscles::{Force, Length, Pressure, Ratio, Time, Volume};

/// A column of measurements.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Field {
    Pressure,
    Contraction,
    Length,
    /// Shortening relative to the rest length, as a length.
    Displacement,
    Force,
    Time,
    Sweep,
    Specimen,
    Cycle,
    Direction,
    Temperature,
    Diameter,
    Volume,
    ForceSd,
}

impl Field {
    pub(crate) const ALL: [Self; 14] = [
        Self::Pressure,
        Self::Contraction,
        Self::Length,
        Self::Displacement,
        Self::Force,
        Self::Time,
        Self::Sweep,
        Self::Specimen,
        Self::Cycle,
        Self::Direction,
        Self::Temperature,
        Self::Diameter,
        Self::Volume,
        Self::ForceSd,
    ];

    /// A correct heading with a common unit.
    pub(crate) const fn example(self) -> &'static str {
        match self {
            Self::Pressure => "pressure [bar]",
            Self::Contraction => "contraction [%]",
            Self::Length => "length [mm]",
            Self::Displacement => "displacement [mm]",
            Self::Force => "force [N]",
            Self::Time => "time [s]",
            Self::Sweep => "sweep",
            Self::Specimen => "specimen",
            Self::Cycle => "cycle",
            Self::Direction => "direction",
            Self::Temperature => "temperature [degC]",
            Self::Diameter => "diameter [mm]",
            Self::Volume => "volume [ml]",
            Self::ForceSd => "force_sd [N]",
        }
    }

    /// What its cells hold.
    const fn about(self) -> &'static str {
        match self {
            Self::Pressure => "gauge pressure",
            Self::Contraction => "shortening over the length without pressure",
            Self::Length => "length between the end fittings",
            Self::Displacement => "shortening from the length without pressure",
            Self::Force => "pull of the muscle",
            Self::Time => "time since any start, or a date with a time",
            Self::Sweep => "label of the run; else runs are found by the time and the motion",
            Self::Specimen => "name of the muscle under test, as in the muscle file",
            Self::Cycle => "number of the cycle within its run",
            Self::Direction => "whether the muscle shortens or lengthens",
            Self::Temperature => "of the muscle or of the room",
            Self::Diameter => "largest outer diameter",
            Self::Volume => "volume of the gas",
            Self::ForceSd => "standard deviation of the force reading",
        }
    }

    /// The name without the unit.
    pub(crate) fn name(self) -> &'static str {
        self.example().split(' ').next().unwrap_or_default()
    }

    /// What its numbers are; none for labels and counts.
    fn wanted(self) -> Option<&'static Wanted> {
        Some(match self {
            Self::Pressure => Wanted::of::<Pressure>(),
            Self::Contraction => Wanted::of::<Ratio>(),
            Self::Length | Self::Displacement | Self::Diameter => Wanted::of::<Length>(),
            Self::Force | Self::ForceSd => Wanted::of::<Force>(),
            Self::Time => Wanted::of::<Time>(),
            Self::Temperature => Wanted::of::<Temperature>(),
            Self::Volume => Wanted::of::<Volume>(),
            Self::Sweep | Self::Specimen | Self::Cycle | Self::Direction => return None,
        })
    }

    /// The scale of a unit; none for labels and counts.
    pub(crate) fn scale(self, unit: &str) -> Option<Result<Scale, UnitError>> {
        Some(Scale::of(self.wanted()?, unit))
    }

    /// Whether it holds labels or counts, which have no unit.
    pub(crate) const fn is_label(self) -> bool {
        matches!(self, Self::Sweep | Self::Specimen | Self::Cycle | Self::Direction)
    }

    /// Whether it describes the motion of the muscle.
    pub(crate) const fn is_motion(self) -> bool {
        matches!(self, Self::Contraction | Self::Length | Self::Displacement)
    }

    /// Whether an analysis works without it. Time and run aren't optional: without them the rows are no path.
    pub(crate) const fn is_optional(self) -> bool {
        !(self.is_motion()
            || matches!(self, Self::Pressure | Self::Force | Self::Time | Self::Sweep | Self::Specimen))
    }

    /// The symbols of its units.
    pub(crate) fn symbols(self) -> impl Iterator<Item = &'static str> {
        let units = self.wanted().map_or(&[][..], |wanted| wanted.known);
        units.iter().map(|(symbol, _)| *symbol).filter(|symbol| !symbol.is_empty())
    }
}

/// A parsed heading.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Heading {
    pub(crate) field: Field,
    pub(crate) scale: Scale,
    /// The text as written.
    pub(crate) text: String,
    /// For a displacement: whether it grows when the muscle lengthens, as its name says.
    pub(crate) is_lengthening: bool,
    /// Whether the sign is correct because the user stated it.
    pub(crate) is_settled: bool,
    /// Line of the header if no unit is written and none is assumed, so that the readings have to show it.
    pub(crate) open_unit: Option<usize>,
}

impl Heading {
    /// A field with a unit of its own, as a number in SI.
    pub(crate) fn with_unit_inside(&self, text: &str) -> Option<f64> {
        let (number, symbol) = cell::with_unit(text)?;
        Some(crate::unit::unit(self.field, symbol)?.scale.si(number))
    }
}

/// All headings, for messages.
pub(crate) fn known() -> String {
    Field::ALL.map(Field::example).join(", ")
}

/// A column that is read, and how it is recognised.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RecognisedColumn {
    /// The standard heading with a common unit: `pressure [bar]`.
    pub heading: &'static str,
    /// What its cells hold.
    pub about: &'static str,
    /// Units; empty for labels and counts.
    pub units: Vec<&'static str>,
    /// Words of headings that stand for it, in any case and with any unit.
    pub words: Vec<&'static str>,
}

/// All columns that are read, the necessary ones first.
#[must_use]
pub fn recognised_columns() -> Vec<RecognisedColumn> {
    let one = |field: Field| RecognisedColumn {
        heading: field.example(),
        about: field.about(),
        units: field.symbols().collect(),
        words: names::words_for(field).collect(),
    };
    Field::ALL.map(one).to_vec()
}
