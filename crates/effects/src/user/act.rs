//! User-defined effects as effects of the catalogue. A force formula is evaluated as a load, with exact
//! derivatives.

use crate::card::{Card, Evidence, Group, Needs, ParameterCard, Parity, Signature};
use crate::effect::{Action, Balance, Effect, Jet, LoadEffect, Moment, Row, Setting, ShapeEffect};
use crate::expression::{VARIABLES, variable_index};
use crate::user::{ShapeFormula, ShapeQuantity, UserEffect, UserFormula, UserParameter};
use bulge_fibre::{FormulaInput, Parts};
use bulge_muscles::MuscleError;

/// The data that a variable needs.
const NEEDS: &[(&str, Needs)] = &[
    ("direction", Needs::Path),
    ("max_eps", Needs::Path),
    ("rate", Needs::Time),
    ("time", Needs::Time),
    ("cycle", Needs::Cycles),
    ("temperature", Needs::Temperature),
];

impl UserEffect {
    fn uses(&self, name: &str) -> bool {
        match &self.formula {
            UserFormula::Force(force) => variable_index(name).is_some_and(|i| force.uses_variable(i)),
            UserFormula::Shape(_) => false,
        }
    }

    /// How the force follows the pressure, as cards say it.
    fn power_of_pressure(&self) -> &'static str {
        let UserFormula::Shape(shape) = &self.formula else {
            return if self.uses("p") { "1" } else { "0" };
        };
        match shape.quantity {
            _ if shape.expression.uses_variable(FormulaInput::Pressure as usize) => "any",
            ShapeQuantity::Energy => "0",
            ShapeQuantity::Area | ShapeQuantity::Twist => "1",
        }
    }
}

/// The values of the variables of an expression, in the order of [`VARIABLES`].
fn variables(moment: &Moment, setting: &Setting, balance: &Balance) -> Vec<Jet> {
    let of = |name: &str| match name {
        "p" => balance.pressure,
        "eps" => balance.contraction,
        "length" => (-balance.contraction + 1.0) * setting.length,
        "l0" => Jet::from(setting.length),
        "radius" => Jet::from(setting.radius),
        "mid_radius" => balance.mid_radius,
        "direction" => Jet::from(moment.direction),
        "rate" => Jet::from(moment.rate),
        "time" => Jet::from(moment.time),
        "temperature" => Jet::from(moment.temperature),
        "force" => balance.force,
        "cycle" => Jet::from(moment.cycle),
        "max_eps" => Jet::from(moment.largest),
        "tension" => balance.tension,
        "fibres" => Jet::from(setting.fibres.map_or(f64::NAN, f64::from)),
        "braid_angle" => Jet::from(setting.braid_angle),
        // A test keeps the list and this match consistent.
        _ => Jet::from(f64::NAN),
    };
    VARIABLES.iter().map(|variable| of(variable.name)).collect()
}

impl Effect for UserEffect {
    fn card(&self) -> Card<'_> {
        let odd = self.uses("direction") || self.uses("rate");
        Card {
            name: &self.name,
            family: self.family.as_deref().unwrap_or(&self.name),
            mechanism: self.mechanism,
            form: self.form,
            title: &self.title,
            about: self.about.as_deref().unwrap_or("An effect of your own."),
            equation: self.formula.expression().text(),
            source: self.source.as_deref().unwrap_or("your own file"),
            evidence: Evidence::User,
            group: match &self.formula {
                UserFormula::Force(_) => Group::Load,
                UserFormula::Shape(ShapeFormula { quantity: ShapeQuantity::Energy, .. }) => Group::Material,
                UserFormula::Shape(_) => Group::Geometry,
            },
            kind: None,
            signature: Signature {
                pressure: self.power_of_pressure(),
                parity: if odd { Parity::Odd } else { Parity::Even },
                shape: "as its expression",
            },
            twins: &[],
            separate: "not stated",
            needs: NEEDS.iter().find(|(name, _)| self.uses(name)).map_or(Needs::Nothing, |(_, needs)| *needs),
        }
    }

    fn parameters(&self) -> Vec<ParameterCard<'_>> {
        self.parameters.iter().map(card_of).collect()
    }

    fn action(&self) -> Action<'_> {
        match self.formula {
            UserFormula::Force(_) => Action::Load(self),
            UserFormula::Shape(_) => Action::Shape(self),
        }
    }
}

impl ShapeEffect for UserEffect {
    fn reshape(&self, theta: &[Jet], parts: &mut Parts<Jet>) -> Result<(), MuscleError> {
        match &self.formula {
            UserFormula::Shape(formula) => formula.reshape(theta, parts),
            UserFormula::Force(_) => Ok(()),
        }
    }
}

impl LoadEffect for UserEffect {
    fn act(&self, Row { moment, setting, theta, .. }: Row<'_>, balance: &Balance, force: &mut Jet) {
        if let UserFormula::Force(formula) = &self.formula {
            *force += formula.evaluate(&variables(moment, setting, balance), theta);
        }
    }
}

/// The card of a parameter. Its bounds and values are already in SI.
fn card_of(parameter: &UserParameter) -> ParameterCard<'_> {
    let about = parameter.about.as_deref().unwrap_or("");
    let card =
        ParameterCard::new(&parameter.name, (&parameter.unit, parameter.factor), (0.0, 0.0), 0.0, about);
    ParameterCard {
        low: parameter.low,
        high: parameter.high,
        typical: parameter.typical,
        off: 0.0_f64.clamp(parameter.low, parameter.high),
        prior: parameter.prior,
        ..card
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::probe::{SETTING, balance, load};
    use crate::user::from_toml;
    use crate::{Catalogue, user};

    #[test]
    fn every_variable_has_a_value() {
        let setting = Setting { fibres: Some(40), ..SETTING };
        let values = variables(&Moment::at_rest(2e5, 0.1), &setting, &balance(0.1));
        for (variable, value) in VARIABLES.iter().zip(values) {
            assert!(bulge_numerics::Real::value(value).is_finite(), "{}", variable.name);
        }
    }

    #[test]
    fn an_expression_is_an_effect() {
        let effects = from_toml(user::EXAMPLE, "own.toml").unwrap();
        let effect = effects[0].clone();
        // -k (eps - eps_free) at 10 %.
        let force = load(&effect, &[50.0, 0.04], |_| {});
        assert!((force + 50.0 * 0.06).abs() < 1e-12, "{force}");
        let catalogue = Catalogue::builtin().with(effect).unwrap();
        assert!((catalogue.find("hose-stiffness").unwrap().parameters()[0].high - 500.0).abs() < 1e-9);
        // Without an effect a parameter is 0, or as near to it as its range allows: walls begin at 0.5 mm.
        let shape = from_toml(user::SHAPE_EXAMPLE, "own.toml").unwrap();
        let off: Vec<f64> = shape[0].parameters().iter().map(|card| card.off).collect();
        assert_eq!(off, [0.0, 5e-4]);
    }
}
