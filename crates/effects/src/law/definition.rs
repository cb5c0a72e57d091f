//! A force law: its equation, coefficients, range and source, and its force with exact derivatives.

use super::coefficient::{Coefficient, CoefficientTable, Role};
use super::point::{LawGeometry, LawPoint};
use super::{chou_hannaford, cylinder, exponential, hildebrandt, pleated_polynomial, sarosi};
use super::{designation, list::LAWS};
use crate::Evidence;
use bulge_muscles::Kind;
use bulge_numerics::Real;
use serde::Serialize;

/// The closed set of equations. Each is a function of its module.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    PleatedPolynomial,
    Cylinder,
    TonduLopez,
    Kerscher,
    Sarosi6,
    Sarosi5,
    Sarosi5Branch,
    Isobaric,
    Eight,
    ChouHannaford,
    Hildebrandt,
}

/// A force law F(p, kappa) of the papers, an alternative to the equilibrium model.
///
/// Forces are in N, with tension positive. Coefficients keep the units in which they are printed; pressure
/// and contraction are in SI. [`LAWS`] holds all laws, and `Display` describes one for a reader.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Law {
    /// The name, such as `sarosi-6`.
    pub name: &'static str,
    /// Other names of the same law.
    pub aliases: &'static [&'static str],
    /// A short description.
    pub title: &'static str,
    /// Paper and equation. The titles of the papers are in [`PAPERS`](super::PAPERS).
    pub source: &'static str,
    /// The reliability of the equation. [`Evidence::Paper`] means printed, with the errata corrected; see the
    /// notes.
    pub evidence: Evidence,
    /// The equations in plain text, one per line.
    pub equation: &'static str,
    /// The kind of muscle it is for; none if for both.
    pub kind: Option<Kind>,
    /// Whether it distinguishes shortening from lengthening.
    pub directional: bool,
    /// The range of validity.
    pub range: &'static str,
    /// Coefficients, in order.
    pub coefficients: &'static [Coefficient],
    /// Sets of coefficients, printed or derived.
    pub tables: &'static [CoefficientTable],
    /// Errata and cautions.
    pub notes: &'static [&'static str],
    #[serde(skip)]
    pub(super) form: Form,
}

impl Law {
    /// The largest number of coefficients of a law.
    pub const MOST_COEFFICIENTS: usize = 10;

    /// The law with this name or alias; case doesn't matter.
    ///
    /// ```
    /// use bulge_effects::law::Law;
    /// assert_eq!(Law::find("s3-cylinder").map(|law| law.name), Some("s2-cylinder"));
    /// ```
    #[must_use]
    pub fn find(name: &str) -> Option<&'static Self> {
        let is = |other: &str| other.eq_ignore_ascii_case(name);
        LAWS.iter().find(|law| is(law.name) || law.aliases.iter().any(|alias| is(alias)))
    }

    /// Force F \[N\] at a point, with the derivatives that `D` carries.
    ///
    /// Coefficients are in the order and the units of [`Law::coefficients`]. Trailing ones that are left out
    /// take [`Coefficient::start`], so that `&[]` gives the typical law with the muscle's own measures.
    /// Surplus ones are ignored. The force is finite where [`Law::is_defined_at`] holds, for muscles that the
    /// law [`suits`](Law::suits).
    ///
    /// ```
    /// use bulge_effects::law::{Law, LawGeometry, LawPoint};
    /// let law = Law::find("sarosi-6").unwrap();
    /// let table = law.table("DMSP-20-400N, S4").unwrap();
    /// let geometry = LawGeometry { length: 0.4, radius: 0.01, braid_angle: 0.436, fibres: None };
    /// let force = law.force(LawPoint::mean(4e5, 0.125), &geometry, table.values);
    /// assert_eq!(force.round(), 489.0);
    /// ```
    #[must_use]
    pub fn force<D: Real>(&self, at: LawPoint<D>, geometry: &LawGeometry, coefficients: &[D]) -> D {
        let all: [D; Self::MOST_COEFFICIENTS] = std::array::from_fn(|i| {
            let start = || self.coefficients.get(i).map_or(0.0, |coefficient| coefficient.start(geometry));
            coefficients.get(i).copied().unwrap_or_else(|| D::from(start()))
        });
        match self.form {
            Form::PleatedPolynomial => pleated_polynomial::force(at, geometry.length, all),
            Form::Cylinder => cylinder::force(at, all),
            Form::TonduLopez => cylinder::tondu_lopez(at, all),
            Form::Kerscher => cylinder::kerscher(at, all),
            Form::Sarosi6 => sarosi::six(at, all),
            Form::Sarosi5 => sarosi::five(at, all),
            Form::Sarosi5Branch => sarosi::branch(at, all),
            Form::Isobaric => exponential::isobaric(at, all),
            Form::Eight => exponential::eight(at, all),
            Form::ChouHannaford => chou_hannaford::force(at, geometry.length, all),
            Form::Hildebrandt => hildebrandt::force(at, all),
        }
    }

    /// Whether the force is finite at a point. This holds everywhere, except that the pleated polynomial
    /// needs a contraction above 0.
    #[must_use]
    pub fn is_defined_at(&self, at: LawPoint<f64>) -> bool {
        let is_finite = at.pressure.is_finite() && at.contraction.is_finite() && at.direction.is_finite();
        is_finite && (self.form != Form::PleatedPolynomial || at.contraction > 0.0)
    }

    /// Whether its coefficients apply to a single pressure only.
    #[must_use]
    pub fn is_isobaric(&self) -> bool {
        self.form == Form::Isobaric
    }

    /// Whether the law is for muscles of this kind.
    #[must_use]
    pub fn suits(&self, kind: Kind) -> bool {
        self.kind.is_none_or(|own| own == kind)
    }

    /// Whether the force is linear in every coefficient.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        self.coefficients.iter().all(|coefficient| coefficient.linear)
    }

    /// The table with this name; case doesn't matter.
    #[must_use]
    pub fn table(&self, name: &str) -> Option<&'static CoefficientTable> {
        self.tables.iter().find(|table| table.name.eq_ignore_ascii_case(name))
    }

    /// The table for a muscle's name such as "DMSP-20-300": same type and diameter, nearest length, and the
    /// first of equally near ones.
    ///
    /// None if there is no table for that type and diameter.
    #[must_use]
    pub fn table_for(&self, muscle: &str) -> Option<&'static CoefficientTable> {
        let distance =
            |table: &'static CoefficientTable| Some((designation::distance(muscle, table.muscle?)?, table));
        let nearest = self.tables.iter().filter_map(distance).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map(|(_, table)| table)
    }

    /// A start of a fit for every coefficient: the table's value, or else [`Coefficient::start`].
    #[must_use]
    pub fn start(&self, geometry: &LawGeometry, table: Option<&CoefficientTable>) -> Vec<f64> {
        let values = table.map_or(&[][..], |table| table.values);
        let own = |(i, coefficient): (usize, &Coefficient)| {
            values.get(i).copied().unwrap_or_else(|| coefficient.start(geometry))
        };
        self.coefficients.iter().enumerate().map(own).collect()
    }

    /// Indices of the coefficients that a fit changes.
    pub fn fitted(&self) -> impl Iterator<Item = usize> + use<> {
        let coefficients = self.coefficients;
        (0..coefficients.len()).filter(move |i| coefficients[*i].role == Role::Fitted)
    }
}
