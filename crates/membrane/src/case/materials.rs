//! The materials of a case.

use bulge_muscles::settings::{Keys, Settings};
use bulge_muscles::{Dimension, FileError};

use super::read::{in_range, name, needed, number, positive};
use crate::material::{Cloth, Law, Orthotropic, Sheet};

const KEYS: Keys = &[
    ("name", "name = \"rubber\""),
    ("law", "law = \"neo-hooke\""),
    ("thickness", "thickness = \"1 mm\""),
    ("young", "young = \"0.5 MPa\""),
    ("weft", "weft = \"0.2 MPa\""),
    ("poisson", "poisson = 0.3"),
    ("shear", "shear = \"0.4 MPa\""),
    ("c1", "c1 = \"0.2 MPa\""),
    ("c2", "c2 = \"0.02 MPa\""),
    ("limit", "limit = 50.0"),
    ("wrinkles", "wrinkles = true"),
    ("residual", "residual = 1e-6"),
    ("bending", "bending = true"),
];

#[derive(Debug, Clone, Copy)]
enum Kind {
    NeoHooke,
    MooneyRivlin,
    Gent,
    Hencky,
    SaintVenant,
    Orthotropic,
}

const KINDS: &[(&str, Kind)] = &[
    ("neo-hooke", Kind::NeoHooke),
    ("mooney-rivlin", Kind::MooneyRivlin),
    ("gent", Kind::Gent),
    ("hencky", Kind::Hencky),
    ("st-venant", Kind::SaintVenant),
    ("orthotropic", Kind::Orthotropic),
];

/// Fraction of the stiffness that a wrinkled sheet keeps.
const RESIDUAL: f64 = 1e-6;

/// The sheets by name, and the bending stiffness D \[N m\] of those that resist bending.
pub(super) struct Materials {
    pub(super) sheets: Vec<(String, Sheet)>,
    pub(super) bending: Vec<(String, f64)>,
}

pub(super) fn read(settings: &Settings<'_>) -> Result<Materials, FileError> {
    let mut found: Vec<(String, Sheet)> = Vec::new();
    let mut bending = Vec::new();
    for table in settings.tables("material", "a `[[material]]`", KEYS)?.unwrap_or_default() {
        table.check_keys()?;
        let name = name(&table, "name")?;
        if found.iter().any(|(known, _)| known == name) {
            let what = format!("there are two materials called `{name}`");
            return Err(table.error(table.value_span("name"), what, "give each its own name"));
        }
        let sheet = sheet(&table)?;
        if table.flag("bending")?.unwrap_or(false) {
            let Cloth::Isotropic(
                Law::Hencky { stiffness, poisson } | Law::SaintVenantKirchhoff { stiffness, poisson },
            ) = sheet.cloth
            else {
                let what = "only foil that stretches little resists bending here: rubber gets thinner as it stretches, and woven cloth is stiffer one way";
                let instead = "leave `bending` out, or take `law = \"st-venant\"`";
                return Err(table.error(table.key_span("bending"), what, instead));
            };
            let h = needed(&table, "thickness", Dimension::LENGTH)?;
            bending.push((name.to_owned(), stiffness * h * h / (12.0 * (1.0 - poisson * poisson))));
        }
        found.push((name.to_owned(), sheet));
    }
    Ok(Materials { sheets: found, bending })
}

fn sheet(table: &Settings<'_>) -> Result<Sheet, FileError> {
    let kind = table.word("law", KINDS)?.ok_or_else(|| table.missing("law"))?;
    let used: &[&str] = match kind {
        Kind::NeoHooke => &["shear"],
        Kind::MooneyRivlin => &["c1", "c2"],
        Kind::Gent => &["shear", "limit"],
        Kind::Hencky | Kind::SaintVenant => &["young", "poisson"],
        Kind::Orthotropic => &["young", "weft", "poisson", "shear"],
    };
    for key in ["young", "weft", "poisson", "shear", "c1", "c2", "limit"] {
        if table.get(key).is_some() && !used.contains(&key) {
            let what = format!("this law has no `{key}`");
            return Err(table.error(table.key_span(key), what, format!("it has {}", used.join(", "))));
        }
    }
    let h = needed(table, "thickness", Dimension::LENGTH)?;
    let modulus = |key: &str| Ok::<f64, FileError>(h * needed(table, key, Dimension::PRESSURE)?);
    let poisson = || -> Result<f64, FileError> {
        let value = number(table, "poisson", |nu| nu > -1.0 && nu < 1.0, "between -1 and 1 (of a sheet)")?;
        value.ok_or_else(|| table.missing("poisson"))
    };
    let cloth = match kind {
        Kind::NeoHooke => Cloth::Isotropic(Law::NeoHooke { shear: modulus("shear")? }),
        Kind::MooneyRivlin => {
            let c1 =
                h * in_range(table, "c1", Dimension::PRESSURE, |c| c >= 0.0, "at least 0")?.unwrap_or(0.0);
            let c2 =
                h * in_range(table, "c2", Dimension::PRESSURE, |c| c >= 0.0, "at least 0")?.unwrap_or(0.0);
            if c1 + c2 <= 0.0 {
                return Err(table.missing("c1"));
            }
            Cloth::Isotropic(Law::MooneyRivlin { c1, c2 })
        }
        Kind::Gent => {
            let limit = positive(table, "limit", Dimension::NONE)?.ok_or_else(|| table.missing("limit"))?;
            Cloth::Isotropic(Law::Gent { shear: modulus("shear")?, limit })
        }
        Kind::Hencky => Cloth::Isotropic(Law::Hencky { stiffness: modulus("young")?, poisson: poisson()? }),
        Kind::SaintVenant => {
            Cloth::Isotropic(Law::SaintVenantKirchhoff { stiffness: modulus("young")?, poisson: poisson()? })
        }
        Kind::Orthotropic => {
            let cloth = Orthotropic {
                warp: modulus("young")?,
                weft: modulus("weft")?,
                poisson: poisson()?,
                shear: modulus("shear")?,
            };
            if cloth.poisson * cloth.poisson * cloth.weft >= cloth.warp {
                let what = "this cloth would give off energy: poisson^2 weft must be < young";
                let instead = "poisson is the contraction along the weft per stretch along the warp";
                return Err(table.error(table.value_span("poisson"), what, instead));
            }
            Cloth::Orthotropic(cloth)
        }
    };
    let is_cloth = matches!(kind, Kind::Hencky | Kind::SaintVenant | Kind::Orthotropic);
    let wrinkles = table.flag("wrinkles")?.unwrap_or(is_cloth);
    let residual = number(table, "residual", |x| (0.0..=0.1).contains(&x), "from 0 to 0.1")?;
    Ok(Sheet { cloth, wrinkles, residual: residual.unwrap_or(RESIDUAL) })
}
