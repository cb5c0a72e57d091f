//! The loads of a case.

use bulge_muscles::settings::{Keys, Settings};
use bulge_muscles::shown::listed;
use bulge_muscles::{Dimension, FileError};

use super::read::{in_range, positive};
use super::source::Source;
use super::{Ends, Filling, Step};
use crate::structure::Fitting;

const KEYS: Keys = &[
    ("pressure", "pressure = \"3 bar\""),
    ("volume", "volume = \"34 ml\""),
    ("gas", "gas = \"isothermal\""),
    ("ambient", "ambient = \"1.013 bar\""),
    ("places", "places = { top = \"-5 mm\" }"),
    ("forces", "forces = { top = \"-1 N\" }"),
    ("contraction", "contraction = \"10 %\""),
    ("states", "states = 4"),
    ("restart", "restart = true"),
];

const GASES: &[(&str, f64)] = &[("isothermal", 1.0), ("adiabatic", 1.4)];
/// Default ambient pressure, Pa.
const AMBIENT: f64 = 101_325.0;
/// Most states of a step.
const MOST_STATES: u32 = 100_000;

pub(super) fn read(
    settings: &Settings<'_>,
    source: &Source,
    fittings: &[(String, Fitting)],
    ends: Option<Ends>,
) -> Result<Vec<Step>, FileError> {
    let tables = settings.tables("step", "a `[[step]]`", KEYS)?.unwrap_or_default();
    if tables.is_empty() {
        return Err(settings.missing("step"));
    }
    let mut steps: Vec<Step> = Vec::new();
    let mut places = vec![0.0; fittings.len()];
    for table in &tables {
        table.check_keys()?;
        let step = step(table, source, fittings, ends, steps.last())?;
        if step.is_restart {
            places.fill(0.0);
        }
        for (place, now) in places.iter_mut().zip(&step.fittings) {
            *place = now.unwrap_or(*place);
        }
        if let Some(ends) = ends {
            are_apart(table, ends, fittings, &places)?;
            if let (Some(contraction), Some(length)) = (step.contraction, source.length) {
                places[ends.moving] = ends.place(contraction, length, source.copies, &places);
            }
        }
        steps.push(step);
    }
    Ok(steps)
}

/// Checks that the ends don't pass each other.
fn are_apart(
    table: &Settings<'_>,
    ends: Ends,
    fittings: &[(String, Fitting)],
    places: &[f64],
) -> Result<(), FileError> {
    let is_placed = |fitting: usize| fittings[fitting].1 == Fitting::Placed;
    if !is_placed(ends.moving) || ends.other.is_some_and(|other| !is_placed(other)) {
        return Ok(());
    }
    let left = ends.distance + ends.apart(places);
    if left > 0.0 || table.get("places").is_none() {
        return Ok(());
    }
    let what = format!(
        "the ends would stand {:.6} mm past each other: in the mesh they are {:.6} mm apart",
        -1e3 * left,
        1e3 * ends.distance
    );
    Err(table.error(
        table.value_span("places"),
        what,
        "write how far each goes from its place in the mesh along z",
    ))
}

fn step(
    table: &Settings<'_>,
    source: &Source,
    fittings: &[(String, Fitting)],
    ends: Option<Ends>,
    before: Option<&Step>,
) -> Result<Step, FileError> {
    let states = match table.count::<u32>("states")? {
        None => 1,
        Some(states) if (1..=MOST_STATES).contains(&states) => states as usize,
        Some(states) => {
            let what = format!("{states} states are not possible: 1 to {MOST_STATES} are");
            return Err(table.error(table.value_span("states"), what, "write such as `states = 10`"));
        }
    };
    let is_restart = table.flag("restart")?.unwrap_or(false);
    // After a restart there is no enclosed gas, and nothing is taken from the previous step.
    let filling = filling(table, before.filter(|_| !is_restart))?;
    let held = held(table, fittings)?;
    let contraction = contraction(table, source, fittings, ends, &held)?;
    Ok(Step { is_restart, filling, fittings: held, contraction, states })
}

fn filling(table: &Settings<'_>, before: Option<&Step>) -> Result<Filling, FileError> {
    let keys = ["pressure", "volume", "gas"];
    let given: Vec<&str> = keys.into_iter().filter(|key| table.get(key).is_some()).collect();
    if table.get("ambient").is_some() && given != ["gas"] {
        let what = "`ambient` is the pressure around a closed amount of gas";
        return Err(table.error(
            table.key_span("ambient"),
            what,
            "leave it out, or write `gas = \"isothermal\"`",
        ));
    }
    match given[..] {
        ["pressure"] => {
            let at = in_range(
                table,
                "pressure",
                Dimension::PRESSURE,
                |p| p >= 0.0,
                "at least 0 (a gauge pressure)",
            )?;
            Ok(Filling::Pressure(at.unwrap_or_default()))
        }
        ["volume"] => Ok(Filling::Volume(positive(table, "volume", Dimension::VOLUME)?.unwrap_or_default())),
        ["gas"] => {
            let gamma = table.word("gas", GASES)?.unwrap_or(1.0);
            if before.is_none() {
                let what = "the first step has no gas in it yet";
                return Err(table.error(
                    table.key_span("gas"),
                    what,
                    "write a step with a `pressure` before it",
                ));
            }
            let ambient = in_range(table, "ambient", Dimension::PRESSURE, |p| p >= 0.0, "at least 0")?;
            Ok(Filling::Closed { gamma, ambient: ambient.unwrap_or(AMBIENT) })
        }
        [] => match before {
            // Unchanged, with other fittings.
            Some(step) => Ok(step.filling),
            None => Err(table.missing("pressure")),
        },
        [first, second, ..] => {
            let what = format!("a step can't prescribe `{first}` and `{second}`");
            Err(table.error(table.key_span(second), what, "keep one of them"))
        }
        [_] => Err(table.missing("pressure")),
    }
}

/// The motion of each fitting.
fn held(table: &Settings<'_>, fittings: &[(String, Fitting)]) -> Result<Vec<Option<f64>>, FileError> {
    let mut held = vec![None; fittings.len()];
    for (key, kind, dimension) in
        [("places", Fitting::Placed, Dimension::LENGTH), ("forces", Fitting::Loaded, Dimension::FORCE)]
    {
        let Some(value) = table.get(key) else { continue };
        let entries = value.entries().ok_or_else(|| table.wrong_type(key, value, "a table of fittings"))?;
        for (name, value) in entries {
            let Some(fitting) = fittings.iter().position(|(known, _)| known == name) else {
                let known: Vec<&str> = fittings.iter().map(|(name, _)| name.as_str()).collect();
                let instead = if known.is_empty() {
                    "add a support of the kind `fitting`".to_owned()
                } else {
                    format!("there is {}", listed(20, "", known))
                };
                return Err(table.error(value.span(), format!("there is no fitting `{name}`"), instead));
            };
            if fittings[fitting].1 != kind {
                let (what, instead) = match kind {
                    Fitting::Placed => (
                        "the force on this fitting is prescribed, not its place",
                        "write `forces`, or `motion = \"placed\"` at its support",
                    ),
                    Fitting::Loaded => (
                        "the place of this fitting is prescribed, not its force",
                        "write `places`, or `motion = \"loaded\"` at its support",
                    ),
                };
                return Err(table.error(value.span(), what, instead));
            }
            held[fitting] = Some(table.quantity_of(key, value, dimension)?);
        }
    }
    Ok(held)
}

/// Approach of the ends relative to the length.
fn contraction(
    table: &Settings<'_>,
    source: &Source,
    fittings: &[(String, Fitting)],
    ends: Option<Ends>,
    held: &[Option<f64>],
) -> Result<Option<f64>, FileError> {
    let Some(contraction) = table.quantity("contraction", Dimension::NONE)? else { return Ok(None) };
    let refused = |what: &str, instead: &str| Err(table.error(table.key_span("contraction"), what, instead));
    if source.length.is_none() {
        return refused(
            "a contraction needs the length between the fittings",
            "add `length` to `[scale]`, or write `places`",
        );
    }
    let Some(ends) = ends else {
        return refused(
            "a contraction needs a fitting whose place is prescribed",
            "add a support of the kind `fitting`",
        );
    };
    if [Some(ends.moving), ends.other].into_iter().flatten().any(|end| fittings[end].1 == Fitting::Loaded) {
        return refused(
            "a contraction can't be prescribed where the force on an end is",
            "write `forces`, or `motion = \"placed\"` at the support of that end",
        );
    }
    if held[ends.moving].is_some() {
        return refused(
            "a step can't prescribe the place of a fitting and a contraction",
            "keep one of them",
        );
    }
    if !(-1.0..1.0).contains(&contraction) {
        let what = "the contraction is not possible: it must be above -100 % and below 100 %";
        let span = table.value_span("contraction");
        return Err(table.error(span, what, "write such as `contraction = \"20 %\"`"));
    }
    Ok(Some(contraction))
}
