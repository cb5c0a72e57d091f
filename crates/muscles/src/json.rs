//! A muscle in JSON documents: its numbers in groups, as the parts of a muscle, with null for those it lacks.

use crate::construction::{Braided, Construction, Pleated};
use crate::muscle::Muscle;
use crate::parameter::Parameter;
use crate::quantity::Length;
use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;

type Numbers = BTreeMap<&'static str, Option<f64>>;

/// A construction with the numbers of the effects that change its shape.
#[derive(Serialize)]
struct With<T> {
    #[serde(flatten)]
    built: T,
    #[serde(flatten)]
    effects: Numbers,
}

#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
enum Built {
    Pleated(With<Pleated>),
    Braided(With<Braided>),
}

/// Where the gas acts in the wall of a braid.
#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
enum GasWall {
    Inner,
    At(f64),
}

impl Serialize for Muscle {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let stated = |(name, parameter)| (name, self.stated(parameter));
        let construction = match self.construction() {
            Construction::Pleated(pleated) => {
                let radius = self.stated(Parameter::Radius).map_or(pleated.radius, Length::m);
                let effects = [
                    ("end_radius", Parameter::FittingRadius),
                    ("pleat_depth", Parameter::PleatDepth),
                    ("misalignment", Parameter::Misalignment),
                    ("cloth_circumference", Parameter::ClothCircumference),
                ];
                let built = Pleated { radius, ..pleated };
                Built::Pleated(With { built, effects: effects.map(stated).into() })
            }
            Construction::Braided(built) => {
                let effects = [("fitting_radius", Parameter::FittingRadius)];
                Built::Braided(With { built, effects: effects.map(stated).into() })
            }
        };
        let [c10, c01] = [("c10", Parameter::C10), ("c01", Parameter::C01)].map(stated);
        let bladder = self.bladder_wall().map(|wall| Numbers::from([c10, c01, ("wall", Some(wall.to_m()))]));
        let cloth =
            [("hoop_stiffness", Parameter::HoopStiffness), ("unfolded_radius", Parameter::UnfoldedRadius)];
        let unfolding = self.stated(Parameter::HoopStiffness).map(|_| Numbers::from(cloth.map(stated)));
        let own_gas = self.stated(Parameter::GasWall).map(GasWall::At);
        let mut all = serializer.serialize_struct("Muscle", 13)?;
        all.serialize_field("name", self.name())?;
        all.serialize_field("length", &self.length())?;
        all.serialize_field("construction", &construction)?;
        all.serialize_field("fibre", &self.fibre())?;
        all.serialize_field("bladder", &bladder)?;
        all.serialize_field("unfolding", &unfolding)?;
        all.serialize_field("gas_wall", &own_gas.or(self.get(Parameter::GasWall).map(|_| GasWall::Inner)))?;
        all.serialize_field("learnt", &self.learnt)?;
        all.serialize_field("instruments", &self.instruments)?;
        all.serialize_field("widths", self.widths())?;
        if !self.specimens.is_empty() {
            all.serialize_field("specimens", &self.specimens)?;
        }
        all.serialize_field("data_columns", &self.data_columns)?;
        if let Some(fitted) = &self.fitted {
            all.serialize_field("fitted", fitted)?;
        }
        all.end()
    }
}

#[cfg(test)]
mod tests {
    use crate::from_toml;
    use serde_json::{Value, json, to_value};

    fn part(text: &str, name: &str) -> Value {
        to_value(from_toml(text, "m.toml").unwrap()).unwrap()[name].take()
    }

    /// Descriptions of tables hold muscles in this form.
    #[test]
    fn numbers_stand_in_groups() {
        let pleated = "name = \"p\"\nkind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n\
            effects.end-radius.radius = \"15 mm\"\neffects.pleat-depth.depth = \"1 mm\"\n\
            effects.limited-unfolding = { hoop_stiffness = \"81 kN/m\", unfolded_radius = \"50 mm\" }\n";
        let built = json!({ "radius": 0.016, "end_radius": 0.015, "fibres": { "discrete": 40 }, "pleat_depth": 0.001,
            "misalignment": 0.0, "cloth_circumference": null });
        assert_eq!(part(pleated, "construction"), json!({ "pleated": built }));
        let cloth = json!({ "hoop_stiffness": 81e3, "unfolded_radius": 0.05 });
        assert_eq!((part(pleated, "unfolding"), part(pleated, "bladder")), (cloth, Value::Null));
        let braided = "name = \"b\"\nkind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"0.5 rad\"\n\
            wall = \"2 mm\"\neffects.bladder-elasticity.c10 = \"1 MPa\"\neffects.wall-thickness = {}\n";
        let built = json!({ "radius": 0.01, "braid_angle": 0.5, "fitting_radius": null, "fibres": null, "ends": "clamped", "wall": 0.002 });
        assert_eq!(part(braided, "construction"), json!({ "braided": built }));
        assert_eq!(part(braided, "bladder"), json!({ "c10": 1e6, "c01": 0.0, "wall": 0.002 }));
        assert_eq!(part(braided, "gas_wall"), json!("inner"));
        let own = braided.replace("thickness = {}", "thickness.thickness = \"1 mm\"");
        assert_eq!(part(&own, "gas_wall"), json!({ "at": 0.001 }));
        assert_eq!((part(&own, "length"), part(&own, "widths")), (json!(0.25), json!([])));
    }
}
