//! Muscle files with every key, one of a braid and one of a pleated muscle.

/// A file of a braided muscle with every key.
pub const BRAIDED_EXAMPLE: &str = "\
name = \"my braid\"
kind = \"braided\"
length = \"250 mm +- 0.5 mm\"     # unpressurised, between the end fittings; +- is one standard deviation, and may be left out
radius = \"10.7 mm\"              # of the fibres at rest: hose and braid measured by a calliper, or half of (bore + wall) where the fibres lie in the middle
braid_angle = \"25 deg\"          # between fibre and axis at rest: from a photograph, or arccos(length/fibre length)
ends = \"clamped\"                # held at the rest radius by the fittings, as built; \"cylinder\": the textbook formula, without ends
# fibres = 120                  # strands, both ways; only needed with [fibre]
wall = \"2 mm\"                   # thickness of the rubber at rest

# [fibre]                       # absent: fibres without stretch
# stiffness = \"12 kN\"           # EA of one fibre
# section = \"0.3 mm^2\"          # of one fibre, for its stress

# [effects.bladder-elasticity]  # what is known to act; a diagnosis looks for the rest
# c10 = \"0.2 MPa\"               # W = c10 (I1 - 3) + c01 (I2 - 3); without c01 Young's modulus is 6 c10
# c01 = \"0.05 MPa\"
# wall = \"2 mm\"                 # of the rubber, where it is not `wall`

# [effects.end-radius]
# radius = \"10 mm\"              # at the fittings, where it is not `radius`

# [effects.wall-thickness]
# thickness = \"1 mm\"            # by which the gas stays inside the fibres

# [effects.coulomb-friction]    # other effects have the numbers that `bulge effects NAME` lists
# force = \"14 N\"

[instruments]                   # what the data sheets leave open; each number may be left out
force = { noise = \"3 N\", zero = \"1 N\", gain = \"0.1 %\" }             # of single readings; zero and gain: one standard deviation
pressure = { noise = \"200 Pa\", zero = \"500 Pa\", gain = \"0.2 %\" }
length = { noise = \"0.05 mm\", zero = \"0.1 mm\", gain = \"0.05 %\" }

# [specimens.short]             # a second muscle of the same make, in a column `specimen`: what differs
# length = \"60 mm\"

# [data.columns]                # which column is which, where headings don't say it
# force = \"F1 [N]\"
# pressure = \"P1 [psi]\"
# displacement = \"-Weg [mm]\"    # counted the other way
";

/// A file of a pleated muscle with every key.
pub const PLEATED_EXAMPLE: &str = "\
name = \"my pleated muscle\"
kind = \"pleated\"
length = \"110 mm +- 0.2 mm\"     # unpressurised, between the end fittings; +- is one standard deviation, and may be left out
radius = \"16 mm\"                # of the fibres at the fittings
fibres = 40                     # or \"continuous\": so many that sections are circles

# [fibre]                       # absent: fibres without stretch
# stiffness = \"12 kN\"           # EA of one fibre
# section = \"0.3 mm^2\"          # of one fibre, for its stress

# [effects.pleat-depth]         # what is known to act; a diagnosis looks for the rest
# depth = \"4.5 mm\"              # of the pleats outside the fibres

# [effects.fibre-misalignment]
# angle = \"2 deg\"               # at which fibres leave the fittings, all to one side

# [effects.lobes]
# circumference = \"330 mm\"      # of the cloth, spread flat

# [effects.limited-unfolding]
# hoop_stiffness = \"81 kN/m\"    # of cloth that is unfolded
# unfolded_radius = \"52.6 mm\"

# [effects.end-radius]
# radius = \"16.5 mm\"            # at the fittings, where it is not `radius`

[instruments]                   # what the data sheets leave open; each number may be left out
force = { noise = \"3 N\", zero = \"1 N\", gain = \"0.1 %\" }             # of single readings; zero and gain: one standard deviation
pressure = { noise = \"200 Pa\", zero = \"500 Pa\", gain = \"0.2 %\" }
length = { noise = \"0.05 mm\", zero = \"0.1 mm\", gain = \"0.05 %\" }

# [specimens.short]             # a second muscle of the same make, in a column `specimen`: what differs
# length = \"60 mm\"

# [data.columns]                # which column is which, where headings don't say it
# force = \"F1 [N]\"
# pressure = \"P1 [psi]\"
# displacement = \"-Weg [mm]\"    # counted the other way
";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Kind, from_toml, keys};

    /// The example with the lines that it leaves to the reader.
    fn whole(example: &str) -> String {
        let of_reader = |line: &str| match line.strip_prefix("# ") {
            Some(rest) => rest.to_owned(),
            None => line.to_owned(),
        };
        example.lines().map(of_reader).collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn examples_are_muscle_files_and_hold_every_key_of_their_kind() {
        for (example, kind) in [(BRAIDED_EXAMPLE, Kind::Braided), (PLEATED_EXAMPLE, Kind::Pleated)] {
            for text in [example.to_owned(), whole(example)] {
                let found = from_toml(&text, "example.toml").unwrap();
                assert_eq!(found.kind(), kind);
            }
            let table: toml::Table = whole(example).parse().unwrap();
            for path in keys::paths() {
                // Written by a fit, or one of many like it.
                let is_open = ["fitted", "specimens", "data", "fibre.section"]
                    .iter()
                    .any(|open| path == *open || path.starts_with(&format!("{open}.")));
                // Its numbers are of every muscle, its card is of pleats.
                let is_of_pleats = path.starts_with("effects.limited-unfolding");
                let of_table = || keys::owner(path.rsplit_once('.')?.0);
                let owner =
                    if is_of_pleats { Some(Kind::Pleated) } else { keys::owner(&path).or_else(of_table) };
                let belongs = owner.is_none_or(|owner| owner == kind);
                let names: Vec<&str> = path.split('.').collect();
                let stated = names
                    .iter()
                    .try_fold(&toml::Value::Table(table.clone()), |at, name| at.get(name))
                    .is_some();
                assert!(stated || is_open || !belongs, "{kind:?}: {path}");
            }
        }
    }
}
